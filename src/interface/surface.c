/* Faces of a body's boundary and their nodes, on the ranks that have them. */
#include "interfaceimpl.h"
#include <impakt/private/mesh.h>

/* Numbers the nodes of this rank, owned ones first. `marks` become these numbers, and -1 at all other points. */
static PetscErrorCode NumberNodes(Surface surface, PetscInt marks[])
{
  SurfaceData *data = &surface->data;
  PetscSection section;
  PetscInt     start, end, vstart, vend;

  PetscFunctionBegin;
  PetscCall(DMGetGlobalSection(surface->dm, &section));
  PetscCall(DMPlexGetChart(surface->dm, &start, &end));
  PetscCall(DMPlexGetDepthStratum(surface->dm, 0, &vstart, &vend));
  data->n_nodes = 0;
  for (PetscInt v = vstart; v < vend; v++) data->n_nodes += marks[v - start] ? 1 : 0;
  PetscCall(PetscMalloc4(data->n_nodes, &data->vertices, data->n_nodes, &data->dofs, data->n_nodes, &surface->owner_index, data->n_nodes,
                         &surface->owner_rank));
  data->n_nodes = 0;
  for (PetscInt ghosts = 0; ghosts < 2; ghosts++) {
    for (PetscInt v = vstart; v < vend; v++) {
      PetscInt offset;

      PetscCall(PetscSectionGetOffset(section, v, &offset));
      if ((offset < 0) != (ghosts == 1) || marks[v - start] != 1) continue;
      data->vertices[data->n_nodes] = v;
      data->dofs[data->n_nodes++]   = offset < 0 ? -(offset + 1) : offset;
    }
    if (!ghosts) data->n_owned = data->n_nodes;
  }
  for (PetscInt p = 0; p < end - start; p++) marks[p] = -1;
  for (PetscInt i = 0; i < data->n_nodes; i++) marks[data->vertices[i] - start] = i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the rank that owns each node, and makes the star forests from owned nodes to ghosts */
static PetscErrorCode ConnectNodes(Surface surface, PetscSF points, PetscInt numbers[])
{
  int                divided;
  MPI_Comm           comm = PetscObjectComm((PetscObject)surface->dm);
  SurfaceData       *data = &surface->data;
  PetscInt           start, n_leaves = 0, n_ghosts = 0, *ghosts;
  const PetscInt    *leaves = NULL;
  const PetscSFNode *roots  = NULL;
  PetscSFNode       *owners;
  PetscMPIInt        rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (points) PetscCall(PetscSFGetGraph(points, NULL, &n_leaves, NULL, NULL));
  divided = n_leaves > 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &divided, 1, MPI_INT, MPI_MAX, comm));
  surface->divided = (PetscBool)divided;
  PetscCall(DMPlexGetChart(surface->dm, &start, NULL));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    surface->owner_index[i] = i;
    surface->owner_rank[i]  = rank;
  }
  if (points) {
    PetscInt *mine;

    PetscCall(PetscSFGetGraph(points, NULL, &n_leaves, &leaves, &roots));
    PetscCall(PetscMalloc1(n_leaves, &mine));
    for (PetscInt l = 0; l < n_leaves; l++) mine[l] = numbers[(leaves ? leaves[l] : l)];
    PetscCall(PetscSFBcastBegin(points, MPIU_INT, numbers, numbers, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(points, MPIU_INT, numbers, numbers, MPI_REPLACE));
    for (PetscInt l = 0; l < n_leaves; l++) {
      if (mine[l] < 0) continue;
      surface->owner_index[mine[l]]   = numbers[leaves ? leaves[l] : l];
      surface->owner_rank[mine[l]]    = (PetscMPIInt)roots[l].rank;
      numbers[leaves ? leaves[l] : l] = mine[l];
    }
    PetscCall(PetscFree(mine));
  }
  n_ghosts = data->n_nodes - data->n_owned;
  PetscCall(PetscMalloc1(n_ghosts, &ghosts));
  PetscCall(PetscMalloc1(n_ghosts, &owners));
  for (PetscInt i = 0; i < n_ghosts; i++) {
    ghosts[i]       = data->n_owned + i;
    owners[i].rank  = surface->owner_rank[data->n_owned + i];
    owners[i].index = surface->owner_index[data->n_owned + i];
  }
  PetscCall(CreateVectorForest(comm, data->n_owned, n_ghosts, ghosts, owners, &surface->vectors));
  PetscCall(PetscSFCreate(comm, &surface->sf));
  PetscCall(PetscSFSetGraph(surface->sf, data->n_owned, n_ghosts, ghosts, PETSC_OWN_POINTER, owners, PETSC_OWN_POINTER));
  /* while all ranks are here: later one may use them alone */
  PetscCall(PetscSFSetUp(surface->sf));
  PetscCall(PetscSFSetUp(surface->vectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reference position of a vertex [m] */
static PetscErrorCode GetPosition(DM dm, PetscInt vertex, const PetscScalar coordinates[], PetscInt dim, PetscReal x[])
{
  PetscSection section;
  PetscInt     offset;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateSection(dm, &section));
  PetscCall(PetscSectionGetOffset(section, vertex, &offset));
  for (PetscInt d = 0; d < 3; d++) x[d] = d < dim ? PetscRealPart(coordinates[offset + d]) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the nodes of a face in the order in which its normal points away from its cell */
static PetscErrorCode OrientFace(Surface surface, PetscInt f, const PetscInt numbers[], PetscInt start, const PetscScalar coordinates[])
{
  SurfaceData    *data = &surface->data;
  const PetscInt  n    = data->face_nodes;
  const PetscInt *support;
  PetscInt        n_vertices, vertices[8] = {0};
  PetscReal       x[4][3], normal[3], area, out = 0, outward[3] = {0};

  PetscFunctionBegin;
  PetscCall(DMPlexGetSupport(surface->dm, surface->points[f], &support));
  PetscCall(SurfaceListVertices(surface->dm, support[0], &n_vertices, vertices));
  for (PetscInt k = 0; k < n_vertices; k++) {
    PetscReal position[3];

    PetscCall(GetPosition(surface->dm, vertices[k], coordinates, data->dim, position));
    for (PetscInt d = 0; d < 3; d++) outward[d] -= position[d] / n_vertices;
  }
  PetscCall(SurfaceListVertices(surface->dm, surface->points[f], &n_vertices, vertices));
  for (PetscInt k = 0; k < n; k++) {
    PetscCall(GetPosition(surface->dm, vertices[k], coordinates, data->dim, x[k]));
    data->faces[f * n + k] = numbers[vertices[k] - start];
    for (PetscInt d = 0; d < 3; d++) outward[d] += x[k][d] / n;
  }
  if (data->dim == 1) {
    data->face_normals[3 * f] = outward[0] < 0 ? -1 : 1; /* for ever */
  } else {
    FaceNormal(n, x, normal, &area);
    out = Dot(normal, outward);
    for (PetscInt k = 0; k < n / 2 && out < 0; k++) {
      const PetscInt swap = data->faces[f * n + k];

      data->faces[f * n + k]         = data->faces[f * n + n - 1 - k];
      data->faces[f * n + n - 1 - k] = swap;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUpFaces(Surface surface, const PetscInt numbers[])
{
  SurfaceData       *data = &surface->data;
  const PetscScalar *coordinates;
  PetscInt           start, n = 0, vertices[8];
  Vec                local;

  PetscFunctionBegin;
  if (data->n_faces) PetscCall(SurfaceListVertices(surface->dm, surface->points[0], &n, vertices));
  PetscCallMPI(MPIU_Allreduce(&n, &data->face_nodes, 1, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)surface->dm)));
  n = data->face_nodes;
  PetscCall(PetscCalloc3(data->n_faces * n, &data->faces, 3 * data->n_faces, &data->face_normals, data->n_faces, &data->face_areas));
  PetscCall(PetscMalloc5(3 * data->n_nodes, &data->reference, 3 * data->n_nodes, &data->positions, 3 * data->n_nodes, &data->normals,
                         data->n_nodes, &data->areas, data->n_nodes, &data->sizes));
  PetscCall(DMPlexGetChart(surface->dm, &start, NULL));
  PetscCall(DMGetCoordinatesLocal(surface->dm, &local));
  PetscCall(VecGetArrayRead(local, &coordinates));
  for (PetscInt f = 0; f < data->n_faces; f++) PetscCall(OrientFace(surface, f, numbers, start, coordinates));
  for (PetscInt i = 0; i < data->n_nodes; i++)
    PetscCall(GetPosition(surface->dm, data->vertices[i], coordinates, data->dim, data->reference + 3 * i));
  PetscCall(VecRestoreArrayRead(local, &coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets up nodes, faces and communication from surface->points */
PetscErrorCode SurfaceSetUpNodes(Surface surface)
{
  PetscInt start, end, roots, *numbers;
  PetscSF  points;

  PetscFunctionBegin;
  PetscCall(DMGetPointSF(surface->dm, &points));
  PetscCall(PetscSFGetGraph(points, &roots, NULL, NULL, NULL));
  if (roots < 0) points = NULL; /* a mesh on one rank */
  PetscCall(DMPlexGetChart(surface->dm, &start, &end));
  PetscCheck(!start, PETSC_COMM_SELF, PETSC_ERR_PLIB, "The points of a mesh begin at 0");
  PetscCall(PetscCalloc1(end, &numbers));
  PetscCall(SurfaceMarkVertices(surface->dm, surface->data.n_faces, surface->points, points, numbers));
  PetscCall(NumberNodes(surface, numbers));
  PetscCall(ConnectNodes(surface, points, numbers));
  PetscCall(SetUpFaces(surface, numbers));
  PetscCall(PetscFree(numbers));
  PetscCall(PetscCalloc2(surface->data.n_nodes, &surface->sharp, 3 * surface->data.n_nodes, &surface->smooth));
  PetscCall(SurfaceUpdate(surface, NULL));
  PetscCall(SurfaceFindEdges(surface, points));
  PetscCall(SurfaceUpdate(surface, NULL)); /* nodes on edges have no smooth normal */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SurfaceClearNodes(Surface surface)
{
  SurfaceData *data = &surface->data;

  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&surface->sf));
  PetscCall(PetscSFDestroy(&surface->vectors));
  PetscCall(PetscFree4(data->vertices, data->dofs, surface->owner_index, surface->owner_rank));
  PetscCall(PetscFree3(data->faces, data->face_normals, data->face_areas));
  PetscCall(PetscFree3(surface->near, surface->near_nodes, surface->near_faces));
  PetscCall(PetscFree2(surface->sharp, surface->smooth));
  PetscCall(PetscFree5(data->reference, data->positions, data->normals, data->areas, data->sizes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collects faces of a body's boundary. `name`: see MeshGetSurface(), NULL or empty: all. Needs a section of displacements at vertices. */
PetscErrorCode SurfaceCreate(DM dm, const char name[], Surface *surface)
{
  PetscSection section;
  PetscBool    all = PETSC_FALSE;
  const char  *body;
  char         full[256];

  PetscFunctionBegin;
  PetscCall(InterfaceInitializePackage());
  PetscCall(PetscHeaderCreate(*surface, SURFACE_CLASSID, "Surface", "Contact surface", "Interface", PetscObjectComm((PetscObject)dm),
                              SurfaceDestroy, NULL));
  PetscCall(PetscObjectGetName((PetscObject)dm, &body));
  PetscCall(PetscSNPrintf(full, sizeof(full), "%s.%s", body, name && name[0] ? name : "all"));
  PetscCall(PetscObjectSetName((PetscObject)*surface, full));
  PetscCall(PetscObjectReference((PetscObject)dm));
  (*surface)->dm = dm;
  PetscCall(DMGetCoordinateDim(dm, &(*surface)->data.dim));
  PetscCall(DMGetGlobalSection(dm, &section)); /* made by all ranks together, also by those that have no face */
  if (name) PetscCall(PetscStrcmp(name, "all", &all));
  PetscCall(MeshGetSurface(dm, all ? NULL : name, &(*surface)->data.n_faces, &(*surface)->points));
  PetscCall(SurfaceSetUpNodes(*surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SurfaceDestroy(Surface *surface)
{
  PetscFunctionBegin;
  if (!*surface) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*surface, SURFACE_CLASSID, 1);
  if (--((PetscObject)*surface)->refct > 0) {
    *surface = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SurfaceClearNodes(*surface));
  PetscCall(PetscFree((*surface)->points));
  PetscCall(PetscFree((*surface)->mirrors));
  PetscCall(DMDestroy(&(*surface)->dm));
  PetscCall(PetscHeaderDestroy(surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SurfaceGetData(Surface surface, const SurfaceData **data)
{
  PetscFunctionBegin;
  *data = &surface->data;
  PetscFunctionReturn(PETSC_SUCCESS);
}
