/* Elements and surfaces of a disc, a ball or a rod, in the grid of its nodes.

   Simplices fill a quadrilateral or hexahedron of this grid, one for each way to walk from one of its corners to the opposite one along the
   axes (H. W. Kuhn, 1960). Cells are mirror images of their neighbours: a walk begins where the number of elements to the plane in the
   middle is even along each axis, and ends where it is odd along each. (Along the axis of layers it is the number to the axis' own plane,
   too, where the number of divisions is even, as it goes on from the central block.) A face is walked through from its corner that is even
   along both of its axes to that which is odd along both. So cells that share a face cut it along the same diagonal, within a block and
   where blocks touch, which have the axes of their common face in common; and with an even number of divisions a ball is its own image in
   the planes through its centre, across the axes and halfway between two of them. With all cells cut the same way, a bar that is compressed
   along an axis gets wider in one direction than in another. */
#include "ballimpl.h"

/* A face of the sphere belongs to its back if no corner is further than this on the pole's side of the centre [radii]: round-off */
#define BACK_TOLERANCE 1e-12

static PetscInt BodyDim(const Ball *ball)
{
  return ball->sections ? 3 : ball->dim;
}

/* Begins a run of elements of the order that the ball's have */
static PetscErrorCode AddRun(MeshFile *file, const Ball *ball, PetscInt dim, PetscInt n_groups, const PetscInt groups[])
{
  static const DMPolytopeType shapes[3][2] = {{DM_POLYTOPE_SEGMENT, DM_POLYTOPE_SEGMENT},
                                              {DM_POLYTOPE_QUADRILATERAL, DM_POLYTOPE_TRIANGLE},
                                              {DM_POLYTOPE_HEXAHEDRON, DM_POLYTOPE_TETRAHEDRON}};
  const DMPolytopeType        shape        = shapes[dim - 1][ball->simplex];

  PetscFunctionBegin;
  PetscCall(MeshFileAddRun(file, shape, (PetscBool)(ball->step == 2), n_groups, groups));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a corner is among the 3 x 3 x 3 places of a cell. Bit d of a corner's number is 1 if it is the farther one along axis d. */
static PetscInt CornerPlace(PetscInt corner)
{
  return 2 * (corner & 1) + 6 * (corner >> 1 & 1) + 18 * (corner >> 2);
}

/* Adds a segment, quadrilateral or hexahedron, or the simplices that fill it, whose walks begin at the corner `first`. `node` is the node
   at each of the 3 x 3 x 3 places of the cell; what lies between two of them, in the middle of an edge, is at their mean. */
static PetscErrorCode AddCell(MeshFile *file, const Ball *ball, PetscInt dim, const PetscInt node[27], PetscInt first, PetscBool mirrored)
{
  static const PetscInt whole[2][8]     = {{0, 1, 3, 2, 4, 5, 7, 6}, {0, 2, 3, 1, 4, 6, 7, 5}};
  static const PetscInt orders[3][6][3] = {{{0}}, {{0, 1}, {1, 0}}, {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const PetscInt        n_orders        = dim == 3 ? 6 : dim;
  PetscInt             *nodes;

  PetscFunctionBegin;
  if (!ball->simplex) {
    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    for (PetscInt k = 0; k < 1 << dim; k++) nodes[k] = node[CornerPlace(whole[mirrored && dim > 1][k])];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt d = 0; d < dim; d++)
    if (first >> d & 1) mirrored = (PetscBool)!mirrored; /* axes that are walked along backwards */
  for (PetscInt o = 0; o < n_orders; o++) {
    const PetscBool odd = (PetscBool)(o >= n_orders / 2);
    PetscInt        place[4];

    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    for (PetscInt k = 0, corner = first; k <= dim; k++) { /* the last two change places where the element would be mirrored */
      place[dim == 1 || odd == mirrored || k < dim - 1 ? k : 2 * dim - 1 - k] = CornerPlace(corner);
      /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): dim is 1 to 3 */
      if (k < dim) corner ^= 1 << orders[dim - 1][o][k];
    }
    for (PetscInt k = 0; k <= dim; k++) nodes[k] = node[place[k]];
    for (PetscInt k = 0; k < dim * (dim + 1) / 2 && ball->step == 2; k++)
      nodes[dim + 1 + k] = node[(place[MeshSimplexEdges[k][0]] + place[MeshSimplexEdges[k][1]]) / 2];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes of a cell of a block, or of its face or edge along some axes: corners, and those between if any; -1: none */
static void FindNodes(const BallGrid *grid, const BallBlock *block, PetscInt n_axes, const PetscInt axes[], const PetscInt at[3],
                      PetscInt node[27])
{
  for (PetscInt k = 0; k < 27; k++) {
    const PetscInt offset[3] = {k % 3 * grid->ball->step, k / 3 % 3 * grid->ball->step, k / 9 * grid->ball->step};
    PetscInt       place[3]  = {at[0], at[1], at[2]};
    PetscBool      has       = PETSC_TRUE;

    for (PetscInt i = 0; i < 3; i++) {
      if (i < n_axes) place[axes[i]] += offset[i] / 2;
      if (i < n_axes ? offset[i] % 2 : offset[i]) has = PETSC_FALSE;
    }
    node[k] = has ? BallGetNode(grid, block, place) : -1;
  }
}

/* Adds the elements between the places begin[d] and end[d] of a block along each axis d, or those faces of them that lie along some axes */
PetscErrorCode BallAddRange(const BallGrid *grid, const BallBlock *block, PetscInt n_axes, const PetscInt axes[], const PetscInt begin[3],
                            const PetscInt end[3])
{
  const Ball     *ball     = grid->ball;
  const PetscBool mirrored = BallBlockIsMirrored(block);
  PetscInt        at[3];

  PetscFunctionBegin;
  for (at[2] = begin[2]; at[2] < end[2]; at[2] += ball->step)
    for (at[1] = begin[1]; at[1] < end[1]; at[1] += ball->step)
      for (at[0] = begin[0]; at[0] < end[0]; at[0] += ball->step) {
        const PetscReal *x;
        PetscInt         node[27], corner[8];

        FindNodes(grid, block, n_axes, axes, at, node);
        for (PetscInt k = 0; k < 8; k++) corner[k] = node[CornerPlace(k)];
        PetscCheck(n_axes < BodyDim(ball) || ball->simplex || BallCellIsConvex(grid, block, corner, &x), PETSC_COMM_SELF,
                   PETSC_ERR_USER_INPUT,
                   "with %" PetscInt_FMT " divisions, %" PetscInt_FMT " layers and a grading of %g, the element with a corner at (%g, %g, "
                   "%g) is not convex: take more divisions, or a weaker grading",
                   ball->divisions, ball->layers, (double)ball->grading, (double)x[0], (double)x[1], (double)x[2]);
        PetscCall(AddCell(grid->file, ball, n_axes, node, BallFirstCorner(ball, block, n_axes, axes, at), mirrored));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddSurface(MeshFile *file, const Ball *ball, PetscInt number, const char name[])
{
  PetscInt group;

  PetscFunctionBegin;
  PetscCall(MeshFileAddGroup(file, MESH_SIDE_SET, BodyDim(ball) - 1, number, &group));
  PetscCall(PetscStrncpy(file->groups[group].name, name, sizeof(file->groups[group].name)));
  PetscCall(AddRun(file, ball, BodyDim(ball) - 1, 1, &group));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Places of the cells of a block: of a rod those that follow a section */
static void GetRange(const BallGrid *grid, const BallBlock *block, PetscInt section, PetscInt begin[3], PetscInt end[3])
{
  const Ball *ball = grid->ball;

  for (PetscInt d = 0; d < 3; d++) {
    begin[d] = d < ball->dim ? 0 : section;
    end[d]   = d < ball->dim ? (d == block->axis ? ball->layers : grid->n[d]) : section + 1;
  }
}

/* Adds the cells of all blocks, those of a rod in the order of its sections */
static PetscErrorCode AddCells(const BallGrid *grid)
{
  const PetscInt all[3] = {0, 1, 2}, dim = BodyDim(grid->ball);
  PetscInt       begin[3], end[3];

  PetscFunctionBegin;
  PetscCall(AddRun(grid->file, grid->ball, dim, 0, NULL));
  for (PetscInt section = 0; section < PetscMax(grid->ball->sections, 1); section += grid->ball->step)
    for (PetscInt b = 0; b < grid->n_blocks; b++) {
      GetRange(grid, &grid->blocks[b], section, begin, end);
      PetscCall(BallAddRange(grid, &grid->blocks[b], dim, all, begin, end));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the faces of a block across an axis that lie behind `place` cells along it; of a rod those that follow a section */
static PetscErrorCode AddFaces(const BallGrid *grid, const BallBlock *block, PetscInt section, PetscInt axis, PetscInt place)
{
  PetscInt axes[3], n_axes = 0, begin[3], end[3];

  PetscFunctionBegin;
  GetRange(grid, block, section, begin, end);
  for (PetscInt d = 0; d < BodyDim(grid->ball); d++)
    if (d != axis) axes[n_axes++] = d;
  begin[axis] = place;
  end[axis]   = place + 1;
  PetscCall(BallAddRange(grid, block, n_axes, axes, begin, end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the faces of the sphere, or of those of a cut plane, of all blocks */
static PetscErrorCode AddSurfaceFaces(const BallGrid *grid, PetscInt cut)
{
  const Ball *ball = grid->ball;

  PetscFunctionBegin;
  for (PetscInt section = 0; section < PetscMax(ball->sections, 1); section += ball->step)
    for (PetscInt b = 0; b < grid->n_blocks; b++) {
      const BallBlock *block = &grid->blocks[b];

      if (cut < 0 && block->axis >= 0) PetscCall(AddFaces(grid, block, section, block->axis, ball->layers));
      if (cut >= 0 && block->axis != cut) PetscCall(AddFaces(grid, block, section, cut, 0));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Faces of the sphere's run that are opposite to the pole, where a body that is pressed onto something can be held: none of
   their nodes is on the pole's side of the centre, but for round-off */
static PetscErrorCode AddBack(MeshFile *file, const Ball *ball, PetscInt sphere)
{
  const MeshRun run = file->runs[sphere]; /* as adding may move it */

  PetscFunctionBegin;
  PetscCall(AddSurface(file, ball, 4, "back"));
  for (PetscInt e = 0; e < run.n; e++) {
    PetscReal nearest = -PETSC_MAX_REAL;
    PetscInt *nodes;

    for (PetscInt k = 0; k < run.nodes; k++) {
      const PetscReal *x     = file->coordinates + 3 * file->element_nodes[run.first_node + e * run.nodes + k];
      PetscReal        along = 0;

      for (PetscInt d = 0; d < ball->dim; d++) along += (x[d] - ball->centre[d]) * ball->pole[d];
      nearest = PetscMax(nearest, along);
    }
    if (nearest > BACK_TOLERANCE * ball->radius) continue;
    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    PetscCall(PetscArraycpy(nodes, file->element_nodes + run.first_node + e * run.nodes, run.nodes));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the nodes of a rod of those of the disc that is its section, section by section */
static PetscErrorCode DrawOut(BallGrid *grid)
{
  MeshFile      *file     = grid->file;
  const PetscInt sections = grid->ball->sections + 1; /* of nodes */
  PetscReal     *disc     = file->coordinates;

  PetscFunctionBegin;
  /* the corners of 6 tetrahedra in each cell must be counted in PetscInt */
  PetscCheck((double)grid->n_section * sections * 24 < PETSC_INT_MAX, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "%" PetscInt_FMT " divisions, %" PetscInt_FMT " layers and %" PetscInt_FMT " elements along it are too many: take fewer",
             grid->ball->divisions / grid->ball->step, grid->ball->layers / grid->ball->step, grid->ball->sections / grid->ball->step);
  file->n_nodes = grid->n_section * sections;
  PetscCall(PetscMalloc1(3 * file->n_nodes, &file->coordinates));
  for (PetscInt k = 0; k < sections; k++)
    for (PetscInt i = 0; i < grid->n_section; i++) {
      PetscReal *x = file->coordinates + 3 * (k * grid->n_section + i);

      x[0] = disc[3 * i];
      x[1] = disc[3 * i + 1];
      x[2] = grid->ball->length * (PetscReal)k / (PetscReal)(sections - 1);
    }
  PetscCall(PetscFree(disc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes, cells and surfaces of a disc, a ball or a rod, which the context, a BallGrid, describes */
PetscErrorCode MeshFillBall(void *ctx)
{
  static const char *const cut_names[] = {"cut_x", "cut_y"};
  BallGrid                *grid        = (BallGrid *)ctx;
  const Ball              *ball        = grid->ball;
  PetscInt                 sphere;

  PetscFunctionBegin;
  grid->blocks[grid->n_blocks++] = (BallBlock){.axis = -1};
  for (PetscInt d = 0; d < ball->dim; d++)
    for (PetscInt side = d < ball->n_cuts ? 1 : 0; side < 2; side++) grid->blocks[grid->n_blocks++] = (BallBlock){d, side};
  PetscCall(BallSetNodes(grid));
  PetscCall(BallKeepVolume(grid));
  for (PetscInt i = 0; i < grid->file->n_nodes; i++)
    for (PetscInt d = 0; d < 3; d++)
      grid->file->coordinates[3 * i + d] = ball->centre[d] + ball->radius * grid->file->coordinates[3 * i + d];
  if (ball->sections) PetscCall(DrawOut(grid));
  PetscCall(AddCells(grid));
  PetscCall(AddSurface(grid->file, ball, 1, "surface"));
  sphere = grid->file->n_runs - 1;
  PetscCall(AddSurfaceFaces(grid, -1));
  for (PetscInt cut = 0; cut < ball->n_cuts; cut++) {
    PetscCall(AddSurface(grid->file, ball, cut + 2, cut_names[cut]));
    PetscCall(AddSurfaceFaces(grid, cut));
  }
  if (!ball->sections) PetscCall(AddBack(grid->file, ball, sphere)); /* a rod has no pole, and no back to it */
  PetscFunctionReturn(PETSC_SUCCESS);
}
