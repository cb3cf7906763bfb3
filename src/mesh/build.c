/* From the cells, vertices and groups of a mesh file on one rank to a DMPlex with labels. */
#include "meshimpl.h"

typedef struct {
  MeshFile *file;
  DM        dm;
} Labelling;

/* An error handler that keeps the message of the first error in `ctx` */
static PetscErrorCode KeepMessage(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code, PetscErrorType type,
                                  const char *message, void *ctx)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  if (type == PETSC_ERROR_INITIAL && message) (void)PetscStrncpy((char *)ctx, message, 1024);
  return code;
}

/* Calls a function on one rank alone. An error there becomes an error on all ranks, with `where` before its message. */
PetscErrorCode MeshOnRank(MPI_Comm comm, PetscMPIInt rank, PetscErrorCode (*work)(void *), void *ctx, const char where[])
{
  char        message[1024] = "unknown error";
  int         code          = 0;
  PetscMPIInt mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &mine));
  if (mine == rank) {
    PetscCall(PetscPushErrorHandler(KeepMessage, message));
    code = (int)(*work)(ctx);
    PetscCall(PetscPopErrorHandler());
  }
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, rank, comm));
  if (!code) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(message, sizeof(message), MPI_CHAR, rank, comm));
  SETERRQ(comm, (PetscErrorCode)code, "%s: %s", where, message);
}

static PetscErrorCode LabelGroups(void *ctx)
{
  Labelling *labelling = (Labelling *)ctx;

  PetscFunctionBegin;
  PetscCall(MeshFileFindEdges(labelling->file, labelling->dm));
  PetscCall(MeshFileLabel(labelling->file, labelling->dm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What DMPlexCreateFromCellListPetsc() does of cells that are on the first rank, of a given dimension and number of corners on all ranks */
static PetscErrorCode CreatePlex(MPI_Comm comm, const PetscInt sizes[2], const MeshFile *file, DM *dm)
{
  DM cells, plex;

  PetscFunctionBegin;
  PetscCall(DMCreate(comm, &cells));
  PetscCall(DMSetType(cells, DMPLEX));
  PetscCall(DMSetDimension(cells, sizes[0]));
  PetscCall(DMPlexBuildFromCellList(cells, file->n_cells, file->n_vertices, sizes[1], file->cells));
  PetscCall(DMPlexInterpolate(cells, &plex));
  PetscCall(DMDestroy(&cells));
  PetscCall(DMPlexBuildCoordinatesFromCellList(plex, sizes[0], file->vertices));
  *dm = plex;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A DMPlex, all on the rank of the file that a reader has filled; and the nodes mid-edge, if any. Frees the file's arrays. */
PetscErrorCode MeshBuild(MPI_Comm comm, MeshFile *file, const char where[], DM *dm, MeshMiddles *middles)
{
  PetscInt    sizes[2];
  Labelling   labelling;
  PetscMPIInt mine;

  PetscFunctionBegin;
  PetscCall(MeshOnRank(comm, file->rank, MeshFileSelect, file, where));
  PetscCallMPI(MPI_Comm_rank(comm, &mine));
  if (mine == file->rank && file->path) PetscCall(MeshFileDoubt(file, where));
  sizes[0] = file->dim;
  sizes[1] = file->corners;
  PetscCallMPI(MPI_Bcast(sizes, 2, MPIU_INT, file->rank, comm));
  for (PetscInt c = 0; c < file->n_cells; c++)
    PetscCall(DMPlexInvertCell(file->shape, file->cells + c * file->corners)); /* DMPLEX numbers the base of a cell as seen from outside */
  PetscCall(CreatePlex(comm, sizes, file, dm));
  PetscCall(PetscFree(file->cells));
  PetscCall(PetscFree(file->vertices));
  labelling.file = file;
  labelling.dm   = *dm;
  PetscCall(MeshOnRank(comm, file->rank, LabelGroups, &labelling, where));
  if (middles) PetscCall(MeshFileGetMiddles(file, *dm, middles));
  PetscCall(PetscFree(file->coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The label with the name of a group; NULL if the group has no name */
static PetscErrorCode NameLabel(DM dm, const MeshGroup *group, DMLabel *label)
{
  const char *const reserved[] = {"depth", "celltype", "Cell Sets", "Face Sets", "Vertex Sets", MESH_COMPOSITE};
  PetscBool         same;

  PetscFunctionBegin;
  *label = NULL;
  if (!group->name[0]) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(reserved); i++) {
    PetscCall(PetscStrcasecmp(group->name, reserved[i], &same));
    PetscCheck(!same, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "group %" PetscInt_FMT " is named '%s', a word that PETSc or Impakt uses itself: rename it", group->number, group->name);
  }
  PetscCall(DMCreateLabel(dm, group->name));
  PetscCall(DMGetLabel(dm, group->name, label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The label of the edges that have nodes of node sets in their middle */
static PetscErrorCode MiddlesLabel(DM dm, const char of[], DMLabel *label)
{
  char name[MESH_NAME_LENGTH + 32];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), MESH_MIDDLES "%s", of));
  PetscCall(DMCreateLabel(dm, name));
  PetscCall(DMGetLabel(dm, name, label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The face of the body that has these nodes; -1 if there is none */
static PetscErrorCode FindFace(const MeshFile *file, DM dm, PetscInt vstart, PetscInt n, const PetscInt nodes[], PetscInt *face)
{
  PetscInt        vertices[4], n_joins;
  const PetscInt *join;

  PetscFunctionBegin;
  *face = -1;
  for (PetscInt k = 0; k < n; k++) {
    if (file->vertex_of_node[nodes[k]] < 0) PetscFunctionReturn(PETSC_SUCCESS);
    vertices[k] = vstart + file->vertex_of_node[nodes[k]];
  }
  if (n == 1) {
    *face = vertices[0];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(DMPlexGetFullJoin(dm, n, vertices, &n_joins, &join));
  if (n_joins == 1) {
    PetscInt fstart, fend;

    PetscCall(DMPlexGetHeightStratum(dm, 1, &fstart, &fend));
    if (join[0] >= fstart && join[0] < fend) *face = join[0];
  }
  PetscCall(DMPlexRestoreJoin(dm, n, vertices, &n_joins, &join));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the elements of a run in the labels of one of its groups. `first_cell` is the first cell of the run, if its elements are cells. */
static PetscErrorCode LabelRun(const MeshFile *file, DM dm, const MeshRun *run, const MeshGroup *group, PetscInt first_cell,
                               DMLabel numbers, DMLabel name, DMLabel middles[2])
{
  PetscInt vstart;

  PetscFunctionBegin;
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, NULL));
  for (PetscInt e = 0; e < run->n; e++) {
    const PetscInt *nodes = file->element_nodes + run->first_node + e * run->nodes;
    PetscInt        point;

    switch (group->kind) {
    case MESH_BLOCK:
      if (!run->chosen) continue;
      point = first_cell + e;
      break;
    case MESH_SIDE_SET:
      PetscCall(FindFace(file, dm, vstart, run->corners, nodes, &point));
      PetscCheck(point >= 0 || file->n_wanted, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                 "element %" PetscInt_FMT " (%s) of surface '%s' (%" PetscInt_FMT
                 ") is not a face of an element of dimension %" PetscInt_FMT,
                 file->numbers[run->first + e], DMPolytopeTypes[run->shape], group->name, group->number, file->dim);
      if (point < 0) continue;
      break;
    default:
      for (PetscInt k = 0; k < run->nodes; k++) {
        if (file->edge_of_node && file->edge_of_node[nodes[k]] >= 0) {
          PetscCall(DMLabelSetValue(middles[0], file->edge_of_node[nodes[k]], group->number));
          if (name) PetscCall(DMLabelSetValue(middles[1], file->edge_of_node[nodes[k]], 1));
        }
        if (file->vertex_of_node[nodes[k]] < 0) continue;
        point = vstart + file->vertex_of_node[nodes[k]];
        PetscCall(DMLabelSetValue(numbers, point, group->number));
        if (name) PetscCall(DMLabelSetValue(name, point, 1));
      }
      continue;
    }
    PetscCall(DMLabelSetValue(numbers, point, group->number));
    if (name) PetscCall(DMLabelSetValue(name, point, 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the labels of all groups: their numbers in "Cell Sets", "Face Sets" and "Vertex Sets", and for each name a label with the value 1.
   If groups of different kinds have the same name, its label has points of several dimensions. */
PetscErrorCode MeshFileLabel(const MeshFile *file, DM dm)
{
  const char *const sets[] = {"Cell Sets", "Face Sets", "Vertex Sets"};
  PetscInt          cell   = 0;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < file->n_runs; r++) {
    const MeshRun *run = &file->runs[r];

    for (PetscInt g = 0; g < run->n_groups; g++) {
      const MeshGroup *group = &file->groups[file->run_groups[run->first_group + g]];
      DMLabel          numbers, name, middles[2] = {NULL, NULL};

      if (group->kind == MESH_BLOCK && !run->chosen) continue;
      PetscCall(DMCreateLabel(dm, sets[group->kind]));
      PetscCall(DMGetLabel(dm, sets[group->kind], &numbers));
      PetscCall(NameLabel(dm, group, &name));
      if (file->edge_of_node && group->kind == MESH_NODE_SET) {
        PetscCall(MiddlesLabel(dm, sets[group->kind], &middles[0]));
        if (name) PetscCall(MiddlesLabel(dm, group->name, &middles[1]));
      }
      PetscCall(LabelRun(file, dm, run, group, cell, numbers, name, middles));
    }
    if (run->chosen) cell += run->n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
