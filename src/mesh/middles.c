/* Nodes in the middle of the edges of second-order cells. A mesh is made and distributed by the corners of its cells; these nodes become
   vertices where it is divided, see composite.c. Until then their positions go with the edges. */
#include "meshimpl.h"
#include <petscpartitioner.h>
#include <petscsf.h>

static PetscInt Number(const MeshFile *file, PetscInt node)
{
  return file->node_numbers ? file->node_numbers[node] : node + 1;
}

/* The ends of the edges of a triangle and a tetrahedron, in the order of the nodes in their middle, VTK's; a line has the first */
const PetscInt MeshSimplexEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/* Collects the edges of the cells and the nodes in their middle */
PetscErrorCode MeshFileCollectEdges(MeshFile *file)
{
  PetscInt per_cell = 0, cell = 0;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < file->n_runs; r++)
    if (file->runs[r].chosen) per_cell = file->runs[r].nodes - file->runs[r].corners;
  if (!per_cell) PetscFunctionReturn(PETSC_SUCCESS);
  file->n_edges = per_cell * file->n_cells;
  PetscCall(PetscMalloc1(3 * file->n_edges, &file->edges));
  for (PetscInt r = 0; r < file->n_runs; r++) {
    const MeshRun *run = &file->runs[r];

    for (PetscInt e = 0; e < run->n && run->chosen; e++, cell++)
      for (PetscInt k = 0; k < per_cell; k++) {
        PetscInt      *edge   = file->edges + 3 * (cell * per_cell + k);
        const PetscInt middle = file->element_nodes[run->first_node + e * run->nodes + run->corners + k];

        for (PetscInt i = 0; i < 2; i++) edge[i] = file->cells[cell * file->corners + MeshSimplexEdges[k][i]];
        edge[2] = middle;
        PetscCheck(file->vertex_of_node[middle] < 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                   "node %" PetscInt_FMT " is in the middle of an edge of element %" PetscInt_FMT " (%s, %" PetscInt_FMT
                   " nodes) and a corner of another: neighbours must have their edges in common",
                   Number(file, middle), file->cell_numbers[cell], DMPolytopeTypes[file->shape], run->nodes);
        for (PetscInt d = 0; d < file->dim; d++)
          PetscCheck(!PetscIsInfOrNanReal(file->coordinates[3 * middle + d]), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                     "node %" PetscInt_FMT " has a coordinate that is no number", Number(file, middle));
      }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the edges in the DMPlex, on the first rank. Cells that have an edge in common must have its node in common. */
PetscErrorCode MeshFileFindEdges(MeshFile *file, DM dm)
{
  PetscInt vstart, start, end, *node_of_edge;

  PetscFunctionBegin;
  if (!file->n_edges) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, NULL));
  PetscCall(DMPlexGetDepthStratum(dm, 1, &start, &end));
  PetscCall(PetscMalloc1(file->n_nodes, &file->edge_of_node));
  PetscCall(PetscMalloc1(end - start, &file->node_of_edge));
  node_of_edge = file->node_of_edge;
  for (PetscInt i = 0; i < file->n_nodes; i++) file->edge_of_node[i] = -1;
  for (PetscInt i = 0; i < end - start; i++) node_of_edge[i] = -1;
  for (PetscInt i = 0; i < file->n_edges; i++) {
    const PetscInt *edge = file->edges + 3 * i, node = edge[2], ends[2] = {vstart + edge[0], vstart + edge[1]};
    const PetscInt *join;
    PetscInt        n_joins, point;

    PetscCall(DMPlexGetJoin(dm, 2, ends, &n_joins, &join));
    PetscCheck(n_joins == 1, PETSC_COMM_SELF, PETSC_ERR_PLIB, "two vertices have %" PetscInt_FMT " edges", n_joins);
    point = join[0];
    PetscCall(DMPlexRestoreJoin(dm, 2, ends, &n_joins, &join));
    PetscCheck(node_of_edge[point - start] < 0 || node_of_edge[point - start] == node, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "nodes %" PetscInt_FMT " and %" PetscInt_FMT " are both in the middle of one edge: neighbours must have its node in common",
               Number(file, node_of_edge[point - start]), Number(file, node));
    PetscCheck(file->edge_of_node[node] < 0 || file->edge_of_node[node] == point, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "node %" PetscInt_FMT " is in the middle of two edges", Number(file, node));
    node_of_edge[point - start] = node;
    file->edge_of_node[node]    = point;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Positions of the nodes in the middle of edges, on the rank that has the mesh; NULL where the cells have none. Collective. */
PetscErrorCode MeshFileGetMiddles(const MeshFile *file, DM dm, MeshMiddles *middles)
{
  MPI_Comm     comm = PetscObjectComm((PetscObject)dm);
  int          any  = file->n_edges > 0;
  PetscInt     dim, chart[2], edges[2];
  PetscScalar *x;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&any, 1, MPI_INT, file->rank, comm));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMGetCoordinateDim(dm, &dim));
  PetscCall(DMPlexGetChart(dm, &chart[0], &chart[1]));
  PetscCall(DMPlexGetDepthStratum(dm, 1, &edges[0], &edges[1]));
  PetscCall(PetscSectionCreate(comm, &middles->section));
  PetscCall(PetscSectionSetChart(middles->section, chart[0], chart[1]));
  for (PetscInt e = edges[0]; e < edges[1]; e++) PetscCall(PetscSectionSetDof(middles->section, e, dim));
  PetscCall(PetscSectionSetUp(middles->section));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, dim * (edges[1] - edges[0]), &middles->positions));
  PetscCall(VecGetArrayWrite(middles->positions, &x));
  for (PetscInt i = 0; i < file->n_edges; i++) {
    const PetscInt node = file->edges[3 * i + 2];
    PetscInt       offset;

    PetscCall(PetscSectionGetOffset(middles->section, file->edge_of_node[node], &offset));
    for (PetscInt d = 0; d < dim; d++) x[offset + d] = file->coordinates[3 * node + d];
  }
  PetscCall(VecRestoreArrayWrite(middles->positions, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshMiddlesDestroy(MeshMiddles *middles)
{
  PetscFunctionBegin;
  PetscCall(PetscSectionDestroy(&middles->section));
  PetscCall(VecDestroy(&middles->positions));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Divides a mesh that is on the first rank as its partitioner says, and with it the positions in the middle of its edges, if there are any
 */
PetscErrorCode MeshDivideWithMiddles(DM *dm, MeshMiddles *middles)
{
  MeshMiddles part;
  PetscSF     sf;
  DM          parallel;
  const char *prefix;

  PetscFunctionBegin;
  PetscCall(DMPlexDistribute(*dm, 0, &sf, &parallel));
  if (parallel && middles->section) {
    PetscCall(PetscSectionCreate(PetscObjectComm((PetscObject)*dm), &part.section));
    PetscCall(VecCreate(PETSC_COMM_SELF, &part.positions));
    PetscCall(DMPlexDistributeField(*dm, sf, middles->section, middles->positions, part.section, part.positions));
    PetscCall(MeshMiddlesDestroy(middles));
    *middles = part;
  }
  if (parallel) { /* there is more than one rank */
    PetscCall(DMGetOptionsPrefix(*dm, &prefix));
    PetscCall(DMSetOptionsPrefix(parallel, prefix));
    PetscCall(DMDestroy(dm));
    *dm = parallel;
  }
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MeshDistributeWithMiddles(DM *dm, const char prefix[], MeshMiddles *middles)
{
  PetscPartitioner partitioner;
  PetscBool        distribute = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(DMPlexGetPartitioner(*dm, &partitioner));
  PetscCall(PetscPartitionerSetFromOptions(partitioner));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_distribute", &distribute, NULL));
  if (distribute) PetscCall(MeshDivideWithMiddles(dm, middles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
