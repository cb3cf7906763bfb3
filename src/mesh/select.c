/* Which elements of a mesh file make the body, and whether these can be computed with. */
#include "meshimpl.h"
#include <sys/names.h>

/* A body in one or two dimensions may be off its axis or plane by this part of its largest coordinate: round-off in files */
#define OFF_PLANE 1e-12

/* Finds the dimension of the body, which is that of its elements, and decides what groups are whose kind the file does not tell: a group of
   the body's dimension is a block, one of a dimension less a side set, any other a node set */
static PetscErrorCode DecideGroups(MeshFile *file)
{
  PetscFunctionBegin;
  file->dim = 0;
  for (PetscInt r = 0; r < file->n_runs; r++)
    if (file->runs[r].n) file->dim = PetscMax(file->dim, file->runs[r].dim);
  for (PetscInt g = 0; g < file->n_groups; g++) {
    MeshGroup *group = &file->groups[g];

    if (group->kind != MESH_UNDECIDED) continue;
    group->kind = group->dim == file->dim ? MESH_BLOCK : group->dim == file->dim - 1 ? MESH_SIDE_SET : MESH_NODE_SET;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if -mesh_blocks names a block that the file does not have */
static PetscErrorCode CheckWanted(const MeshFile *file)
{
  char list[1024] = "";

  PetscFunctionBegin;
  for (PetscInt g = 0; g < file->n_groups; g++) {
    const MeshGroup *group = &file->groups[g];
    char             text[MESH_NAME_LENGTH + 32];

    if (group->kind != MESH_BLOCK) continue;
    PetscCall(PetscSNPrintf(text, sizeof(text), "%s%s%" PetscInt_FMT "%s", group->name, group->name[0] ? " (" : "", group->number,
                            group->name[0] ? ")" : ""));
    PetscCall(NamesAppend(list, sizeof(list), ", ", text));
  }
  for (PetscInt i = 0; i < file->n_wanted; i++) {
    PetscBool found = PETSC_FALSE;

    for (PetscInt g = 0; g < file->n_groups && !found; g++) {
      char number[32];

      if (file->groups[g].kind != MESH_BLOCK) continue;
      PetscCall(PetscStrcmp(file->wanted[i], file->groups[g].name, &found));
      PetscCall(PetscSNPrintf(number, sizeof(number), "%" PetscInt_FMT, file->groups[g].number));
      if (!found) PetscCall(PetscStrcmp(file->wanted[i], number, &found));
    }
    PetscCheck(found, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no block '%s', which -mesh_blocks names; it has: %s", file->wanted[i],
               list[0] ? list : "none");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collects the cells, which must have one shape. Vertices are numbered in the order of the file's nodes; nodes of no cell are left out. */
static PetscErrorCode CollectCells(MeshFile *file)
{
  const MeshRun *first = NULL;
  PetscInt       cell  = 0;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < file->n_runs; r++) {
    MeshRun *run = &file->runs[r];

    run->chosen = (PetscBool)(run->n && run->dim == file->dim && !file->n_wanted);
    for (PetscInt g = 0; g < run->n_groups && run->n && run->dim == file->dim && !run->chosen; g++) {
      const MeshGroup *group = &file->groups[file->run_groups[run->first_group + g]];

      PetscCall(MeshFileWants(file, group->number, group->name, &run->chosen));
    }
    if (!run->chosen) continue;
    if (!first) first = run;
    PetscCheck(run->shape == first->shape, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "it mixes shapes: element %" PetscInt_FMT " is a %s, element %" PetscInt_FMT
               " a %s; a body must have elements of one shape (-mesh_blocks chooses blocks of a file)",
               file->numbers[first->first], DMPolytopeTypes[first->shape], file->numbers[run->first], DMPolytopeTypes[run->shape]);
    PetscCheck(run->nodes == first->nodes, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "it mixes orders: element %" PetscInt_FMT " (%s) has %" PetscInt_FMT " nodes, element %" PetscInt_FMT " has %" PetscInt_FMT
               "; a body must have elements of one order (-mesh_blocks chooses blocks of a file)",
               file->numbers[first->first], DMPolytopeTypes[first->shape], first->nodes, file->numbers[run->first], run->nodes);
    file->n_cells += run->n;
  }
  PetscCheck(first, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "the blocks that -mesh_blocks names have no elements");
  PetscCheck(first->dim > 1 || first->nodes == first->corners, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "element %" PetscInt_FMT " is a line with three nodes; bars have two", file->numbers[first->first]);
  file->shape   = first->shape;
  file->corners = first->corners;
  PetscCall(PetscMalloc1(file->n_cells * file->corners, &file->cells));
  PetscCall(PetscMalloc1(file->n_cells, &file->cell_numbers));
  PetscCall(PetscCalloc1(file->n_nodes, &file->vertex_of_node));
  for (PetscInt r = 0; r < file->n_runs; r++) {
    const MeshRun *run = &file->runs[r];

    if (!run->chosen) continue;
    for (PetscInt e = 0; e < run->n; e++)
      PetscCall(
          PetscArraycpy(file->cells + (cell + e) * file->corners, file->element_nodes + run->first_node + e * run->nodes, file->corners));
    PetscCall(PetscArraycpy(file->cell_numbers + cell, file->numbers + run->first, run->n));
    cell += run->n;
  }
  for (PetscInt i = 0; i < file->n_cells * file->corners; i++) file->vertex_of_node[file->cells[i]] = 1;
  for (PetscInt node = 0; node < file->n_nodes; node++) file->vertex_of_node[node] = file->vertex_of_node[node] ? file->n_vertices++ : -1;
  for (PetscInt i = 0; i < file->n_cells * file->corners; i++) file->cells[i] = file->vertex_of_node[file->cells[i]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collects as many coordinates of each vertex as the elements have dimensions. The others must be zero. */
static PetscErrorCode CollectVertices(MeshFile *file)
{
  const PetscInt dim  = file->dim;
  PetscReal      size = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(file->n_vertices * dim, &file->vertices));
  for (PetscInt node = 0; node < file->n_nodes; node++) {
    const PetscReal *x = file->coordinates + 3 * node;

    if (file->vertex_of_node[node] < 0) continue;
    for (PetscInt d = 0; d < 3; d++)
      PetscCheck(!PetscIsInfOrNanReal(x[d]), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                 "node %" PetscInt_FMT " has a coordinate that is no number", file->node_numbers ? file->node_numbers[node] : node + 1);
    for (PetscInt d = 0; d < dim; d++) {
      file->vertices[file->vertex_of_node[node] * dim + d] = x[d];
      size                                                 = PetscMax(size, PetscAbsReal(x[d]));
    }
  }
  for (PetscInt node = 0; node < file->n_nodes; node++)
    for (PetscInt d = dim; d < 3; d++) {
      if (file->vertex_of_node[node] < 0) continue;
      PetscCheck(PetscAbsReal(file->coordinates[3 * node + d]) <= OFF_PLANE * size, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                 "its elements have dimension %" PetscInt_FMT " (%s), but node %" PetscInt_FMT
                 " has %c = %g: a body of dimension %" PetscInt_FMT " must lie in %s",
                 dim, DMPolytopeTypes[file->shape], file->node_numbers ? file->node_numbers[node] : node + 1, (char)('x' + d),
                 (double)file->coordinates[3 * node + d], dim, dim == 1 ? "y = z = 0" : "z = 0");
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Determinant(PetscInt dim, PetscReal J[3][3])
{
  if (dim == 1) return J[0][0];
  if (dim == 2) return J[0][0] * J[1][1] - J[0][1] * J[1][0];
  return J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
         J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
}

/* Jacobian of a simplex: its edges from the first corner */
static PetscReal SimplexJacobian(PetscInt dim, const PetscReal *x[])
{
  PetscReal J[3][3] = {{0}};

  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt j = 0; j < dim; j++) J[i][j] = x[i + 1][j] - x[0][j]; /* NOLINT(clang-analyzer-core.NullDereference): dim + 1 corners */
  return Determinant(dim, J);
}

/* Smallest Jacobian of a quadrilateral or hexahedron at the points of its 2-point Gauss rule; their sum is its volume */
static PetscReal TensorJacobian(PetscInt dim, const PetscReal *x[], PetscReal *sum)
{
  static const int signs[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  const PetscInt   corners     = dim == 2 ? 4 : 8;
  PetscReal        smallest    = PETSC_MAX_REAL;

  *sum = 0;
  for (PetscInt q = 0; q < corners; q++) {
    PetscReal J[3][3] = {{0}}, determinant;

    for (PetscInt k = 0; k < corners; k++) {
      PetscReal factor[3];

      for (PetscInt d = 0; d < dim; d++) factor[d] = (1 + signs[k][d] * signs[q][d] / PetscSqrtReal(3.0)) / 2;
      for (PetscInt i = 0; i < dim; i++) {
        PetscReal slope = signs[k][i] / 2.0;

        for (PetscInt d = 0; d < dim; d++)
          if (d != i) slope *= factor[d];
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): 4 or 8 corners, by dim */
        for (PetscInt j = 0; j < dim; j++) J[i][j] += slope * x[k][j];
      }
    }
    determinant = Determinant(dim, J);
    smallest    = PetscMin(smallest, determinant);
    *sum += determinant;
  }
  return smallest;
}

/* Ends with an error if an element has the same node at two corners, is inverted, or has no volume */
static PetscErrorCode CheckCells(const MeshFile *file)
{
  const char *const measures[]     = {"length", "area", "volume"};
  const PetscInt    dim            = file->dim;
  const PetscReal   simplex_part[] = {1, 0.5, 1.0 / 6};
  const PetscBool   simplex        = (PetscBool)(file->corners == dim + 1);
  PetscInt          inverted = 0, first = -1;
  PetscReal         volume_of_first = 0, center[3] = {0};
  char              where[128];

  PetscFunctionBegin;
  for (PetscInt c = 0; c < file->n_cells; c++) {
    const PetscInt  *cell = file->cells + c * file->corners;
    const PetscReal *x[8] = {NULL};
    PetscReal        smallest, volume;

    for (PetscInt k = 0; k < file->corners; k++) {
      for (PetscInt l = 0; l < k; l++)
        PetscCheck(cell[k] != cell[l], PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                   "element %" PetscInt_FMT " (%s) has the same node at its corners %" PetscInt_FMT " and %" PetscInt_FMT
                   ": collapsed elements are not supported",
                   file->cell_numbers[c], DMPolytopeTypes[file->shape], l + 1, k + 1);
      x[k] = file->vertices + cell[k] * dim;
    }
    smallest = simplex ? SimplexJacobian(dim, x) : TensorJacobian(dim, x, &volume);
    if (simplex) volume = smallest * simplex_part[dim - 1];
    if (smallest > 0) continue;
    if (!inverted++) {
      first           = c;
      volume_of_first = volume;
      for (PetscInt k = 0; k < file->corners; k++)
        for (PetscInt d = 0; d < dim; d++) center[d] += x[k][d] / file->corners;
    }
  }
  if (!inverted) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(where, sizeof(where),
                          dim == 1   ? "(%g)"
                          : dim == 2 ? "(%g, %g)"
                                     : "(%g, %g, %g)",
                          (double)center[0], (double)center[1], (double)center[2]));
  if (inverted == file->n_cells && volume_of_first < 0)
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
            "all %" PetscInt_FMT
            " elements are inverted (left-handed), as in a mirror image: turn the order of their nodes; the first is element %" PetscInt_FMT
            " at %s with %s %g",
            inverted, file->cell_numbers[first], where, measures[dim - 1], (double)volume_of_first);
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
          "%" PetscInt_FMT " of %" PetscInt_FMT
          " elements %s inverted or have a Jacobian that is not positive; the first is element %" PetscInt_FMT " at %s with %s %g",
          inverted, file->n_cells, inverted == 1 ? "is" : "are", file->cell_numbers[first], where, measures[dim - 1],
          (double)volume_of_first);
}

/* Chooses the body's cells and vertices in the context, a MeshFile */
PetscErrorCode MeshFileSelect(void *ctx)
{
  MeshFile *file = (MeshFile *)ctx;

  PetscFunctionBegin;
  PetscCall(DecideGroups(file));
  PetscCall(CheckWanted(file));
  PetscCheck(file->dim > 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "it has no elements");
  PetscCall(CollectCells(file));
  PetscCall(CollectVertices(file));
  /* elements of a bar may run either way in a file */
  if (file->dim == 1)
    for (PetscInt c = 0; c < file->n_cells; c++) {
      PetscInt *cell = file->cells + 2 * c;

      if (file->vertices[cell[0]] > file->vertices[cell[1]]) {
        const PetscInt node = cell[0];

        cell[0] = cell[1];
        cell[1] = node;
      }
    }
  PetscCall(CheckCells(file));
  PetscCall(MeshFileCollectEdges(file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
