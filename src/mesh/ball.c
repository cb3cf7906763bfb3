/* Discs and balls from options: an O-grid, graded toward a pole by a conformal map, or a symmetric part of it. PETSc itself can make balls
   only with a generator of tetrahedra. */
#include "ballimpl.h"

/* A face of the sphere belongs to its back if no corner is further than this on the pole's side of the centre [radii]: round-off */
#define BACK_TOLERANCE 1e-12

PetscErrorCode MeshIsBall(const char prefix[], PetscBool *ball)
{
  char shape[64] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-dm_plex_shape", shape, sizeof(shape), NULL));
  PetscCall(PetscStrcasecmp(shape, "ball", ball));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPart(MPI_Comm comm, const char prefix[], Ball *ball)
{
  const char *const parts[] = {"full", "half", "quarter"};
  char              part[64];
  PetscBool         set, same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, prefix, "-ball_part", part, sizeof(part), &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < 3 && !same; p++) {
    PetscCall(PetscStrcasecmp(part, parts[p], &same));
    if (same) ball->n_cuts = p;
  }
  PetscCheck(same, comm, PETSC_ERR_USER_INPUT, "-%sball_part %s: expected full, half (x >= centre) or quarter (also y >= centre)", prefix,
             part);
  PetscCheck(ball->n_cuts < ball->dim, comm, PETSC_ERR_USER_INPUT,
             "-%sball_part %s: a disc can be full or half; quarters are for -%sdm_plex_dim 3", prefix, part, prefix);
  PetscCheck(!ball->n_cuts || ball->divisions % 2 == 0, comm, PETSC_ERR_USER_INPUT,
             "-%sball_divisions %" PetscInt_FMT ": must be even for -%sball_part %s, which cuts the central block in its middle", prefix,
             ball->divisions, prefix, part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPole(MPI_Comm comm, const char prefix[], Ball *ball)
{
  const PetscInt dim = ball->dim;
  PetscReal      pole[4], length = 0;
  PetscBool      set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, "-ball_pole", dim, "a direction from the centre", pole, &set));
  if (!set)
    for (PetscInt d = 0; d < dim; d++) pole[d] = d == dim - 1 ? -1 : 0;
  for (PetscInt d = 0; d < dim; d++) length = PetscMax(length, PetscAbsReal(pole[d]));
  PetscCheck(length > 0, comm, PETSC_ERR_USER_INPUT, "-%sball_pole: all its components are zero, which is no direction", prefix);
  for (PetscInt d = 0; d < dim; d++) ball->pole[d] = pole[d] / length; /* so that squares neither overflow nor vanish */
  length = 0;
  for (PetscInt d = 0; d < dim; d++) length += PetscSqr(ball->pole[d]);
  for (PetscInt d = 0; d < dim; d++) ball->pole[d] /= PetscSqrtReal(length);
  for (PetscInt d = 0; d < ball->n_cuts; d++)
    PetscCheck(ball->pole[d] == 0, comm, PETSC_ERR_USER_INPUT,
               "-%sball_pole: its component along %c is %g; for -%sball_part %s it must be 0, so that the pole is in the cut plane", prefix,
               (char)('x' + d), (double)pole[d], prefix, ball->n_cuts == 1 ? "half" : "quarter");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNumber(MPI_Comm comm, const char prefix[], const char option[], const char meaning[], PetscReal *value)
{
  PetscReal values[4];
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(MeshReadNumbers(comm, prefix, option, 1, meaning, values, &set));
  if (set) *value = values[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where elements are composite the grid of nodes is made twice as fine: every second node is a corner, and those between lie in the middle
   of edges, of those on the surface where the true one is */
PetscErrorCode BallChooseOrder(const char prefix[], Ball *ball)
{
  PetscBool composite;

  PetscFunctionBegin;
  PetscCall(MeshWantsComposite(prefix, &composite));
  ball->step = composite && ball->simplex ? 2 : 1; /* other cells are refused when they are to be divided */
  ball->divisions *= ball->step;
  ball->layers *= ball->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBall(MPI_Comm comm, const char prefix[], Ball *ball)
{
  PetscReal centre[4];
  PetscBool set;

  PetscFunctionBegin;
  *ball = (Ball){.dim = 2, .divisions = 4, .radius = 1, .grading = 1, .keep_volume = PETSC_TRUE};
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-dm_plex_dim", &ball->dim, NULL));
  PetscCheck(ball->dim == 2 || ball->dim == 3, comm, PETSC_ERR_USER_INPUT,
             "-%sdm_plex_dim %" PetscInt_FMT ": -%sdm_plex_shape ball makes a disc (2) or a ball (3)", prefix, ball->dim, prefix);
  PetscCall(ReadNumber(comm, prefix, "-ball_radius", "a radius [m]", &ball->radius));
  PetscCheck(ball->radius > 0, comm, PETSC_ERR_USER_INPUT, "-%sball_radius %g: must be positive", prefix, (double)ball->radius);
  PetscCall(MeshReadNumbers(comm, prefix, "-ball_centre", ball->dim, "a point [m]", centre, &set));
  for (PetscInt d = 0; d < ball->dim && set; d++) ball->centre[d] = centre[d];
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-ball_divisions", &ball->divisions, NULL));
  PetscCheck(ball->divisions >= 1, comm, PETSC_ERR_USER_INPUT,
             "-%sball_divisions %" PetscInt_FMT ": the central block has at least 1 element along an edge", prefix, ball->divisions);
  ball->layers = (ball->divisions + 1) / 2; /* the central block is as wide as the radius, and the layers beside it as half the radius */
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-ball_layers", &ball->layers, NULL));
  PetscCheck(ball->layers >= 1, comm, PETSC_ERR_USER_INPUT,
             "-%sball_layers %" PetscInt_FMT ": there is at least 1 around the central block", prefix, ball->layers);
  PetscCall(ReadNumber(comm, prefix, "-ball_grading", "a ratio of element sizes", &ball->grading));
  PetscCheck(
      ball->grading >= 1, comm, PETSC_ERR_USER_INPUT,
      "-%sball_grading %g: the ratio of the largest to the smallest element size is 1 or more; -%sball_pole says where they are small",
      prefix, (double)ball->grading, prefix);
  PetscCall(ReadPart(comm, prefix, ball));
  PetscCall(ReadPole(comm, prefix, ball));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-dm_plex_simplex", &ball->simplex, NULL));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-ball_keep_volume", &ball->keep_volume, NULL));
  PetscCall(PetscOptionsGetBool(NULL, prefix, "-axisymmetric", &ball->turned, NULL));
  ball->turned = (PetscBool)(ball->turned && ball->dim == 2 && ball->n_cuts == 1 && ball->centre[0] == 0);
  PetscCall(BallChooseOrder(prefix, ball));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Begins a run of elements of the order that the ball's have */
PetscErrorCode BallAddRun(MeshFile *file, const Ball *ball, PetscInt dim, PetscInt n_groups, const PetscInt groups[])
{
  static const DMPolytopeType shapes[3][2] = {{DM_POLYTOPE_SEGMENT, DM_POLYTOPE_SEGMENT},
                                              {DM_POLYTOPE_QUADRILATERAL, DM_POLYTOPE_TRIANGLE},
                                              {DM_POLYTOPE_HEXAHEDRON, DM_POLYTOPE_TETRAHEDRON}};
  const DMPolytopeType        shape        = shapes[dim - 1][ball->simplex];

  PetscFunctionBegin;
  if (ball->step == 1) PetscCall(MeshFileAddRun(file, shape, n_groups, groups));
  else PetscCall(MeshFileAddSecondOrderRun(file, shape, n_groups, groups));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a corner is among the 3 x 3 x 3 places of a cell. Bit d of a corner's number is 1 if it is the farther one along axis d. */
static PetscInt CornerPlace(PetscInt corner)
{
  return 2 * (corner & 1) + 6 * (corner >> 1 & 1) + 18 * (corner >> 2);
}

/* Adds a segment, quadrilateral or hexahedron, or the simplices that fill it: one for each way to walk from its first corner to its last
   along the axes (Kuhn 1960). Blocks have the same axes where they touch, so that common faces are cut along the same diagonal. `node` is
   the node at each of the 3 x 3 x 3 places of the cell; what lies between two of them, in the middle of an edge, is at their mean. */
static PetscErrorCode AddCell(MeshFile *file, const Ball *ball, PetscInt dim, const PetscInt node[27], PetscBool mirrored)
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
  for (PetscInt o = 0; o < n_orders; o++) {
    const PetscBool odd = (PetscBool)(o >= n_orders / 2);
    PetscInt        place[4];

    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    for (PetscInt k = 0, corner = 0; k <= dim; k++) { /* the last two change places where the element would be mirrored */
      place[dim == 1 || odd == mirrored || k < dim - 1 ? k : 2 * dim - 1 - k] = CornerPlace(corner);
      /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): dim is 1 to 3 */
      if (k < dim) corner |= 1 << orders[dim - 1][o][k];
    }
    for (PetscInt k = 0; k <= dim; k++) nodes[k] = node[place[k]];
    for (PetscInt k = 0; k < dim * (dim + 1) / 2 && ball->step == 2; k++)
      nodes[dim + 1 + k] = node[(place[MeshSimplexEdges[k][0]] + place[MeshSimplexEdges[k][1]]) / 2];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes of a cell of a block, or of a face or edge of it that lies along some axes: those at its corners, and those between where the
   grid has some. A place without a node has -1. */
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
static PetscErrorCode AddRange(const BallGrid *grid, const BallBlock *block, PetscInt n_axes, const PetscInt axes[],
                               const PetscInt begin[3], const PetscInt end[3])
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
        PetscCheck(n_axes < ball->dim || ball->simplex || BallCellIsConvex(grid, block, corner, &x), PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
                   "with %" PetscInt_FMT " divisions, %" PetscInt_FMT " layers and a grading of %g, the element with a corner at (%g, %g, "
                   "%g) is not convex: take more divisions, or a weaker grading",
                   ball->divisions, ball->layers, (double)ball->grading, (double)x[0], (double)x[1], (double)x[2]);
        PetscCall(AddCell(grid->file, ball, n_axes, node, mirrored));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Begins a surface with a number and a name */
static PetscErrorCode AddSurface(MeshFile *file, const Ball *ball, PetscInt number, const char name[])
{
  PetscInt group;

  PetscFunctionBegin;
  PetscCall(MeshFileAddGroup(file, MESH_SIDE_SET, ball->dim - 1, number, &group));
  PetscCall(PetscStrncpy(file->groups[group].name, name, sizeof(file->groups[group].name)));
  PetscCall(BallAddRun(file, ball, ball->dim - 1, 1, &group));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the faces of a block across an axis that lie behind `place` cells along it */
static PetscErrorCode AddFaces(const BallGrid *grid, const BallBlock *block, PetscInt axis, PetscInt place)
{
  PetscInt axes[3], n_axes = 0, begin[3] = {0}, end[3] = {1, 1, 1};

  PetscFunctionBegin;
  for (PetscInt d = 0; d < grid->ball->dim; d++) {
    end[d] = d == block->axis ? grid->ball->layers : grid->n[d];
    if (d != axis) axes[n_axes++] = d;
  }
  begin[axis] = place;
  end[axis]   = place + 1;
  PetscCall(AddRange(grid, block, n_axes, axes, begin, end));
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

/* MeshFillBall - nodes, cells and surfaces of a disc or ball */
PetscErrorCode MeshFillBall(BallGrid *grid)
{
  static const char *const cut_names[] = {"cut_x", "cut_y"};
  const Ball              *ball        = grid->ball;
  const PetscInt           all[3] = {0, 1, 2}, begin[3] = {0};
  const BallBlock         *blocks = grid->blocks;
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
  PetscCall(BallAddRun(grid->file, ball, ball->dim, 0, NULL));
  for (PetscInt b = 0; b < grid->n_blocks; b++) {
    PetscInt end[3] = {1, 1, 1};

    for (PetscInt d = 0; d < ball->dim; d++) end[d] = d == blocks[b].axis ? ball->layers : grid->n[d];
    PetscCall(AddRange(grid, &blocks[b], ball->dim, all, begin, end));
  }
  PetscCall(AddSurface(grid->file, ball, 1, "surface"));
  sphere = grid->file->n_runs - 1;
  for (PetscInt b = 1; b < grid->n_blocks; b++) PetscCall(AddFaces(grid, &blocks[b], blocks[b].axis, ball->layers));
  for (PetscInt cut = 0; cut < ball->n_cuts; cut++) {
    PetscCall(AddSurface(grid->file, ball, cut + 2, cut_names[cut]));
    for (PetscInt b = 0; b < grid->n_blocks; b++)
      if (blocks[b].axis != cut) PetscCall(AddFaces(grid, &blocks[b], cut, 0));
  }
  PetscCall(AddBack(grid->file, ball, sphere));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FillBall(void *ctx)
{
  PetscFunctionBegin;
  PetscCall(MeshFillBall((BallGrid *)ctx));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A disc or a ball from options, all of it on a rank; `PETSC_DECIDE`: on the first one. And where the nodes in the middle of its edges are,
   if it has some */
PetscErrorCode MeshCreateBall(MPI_Comm comm, const char prefix[], const char name[], PetscMPIInt rank, DM *dm, MeshMiddles *middles)
{
  Ball           ball;
  MeshFile       file;
  BallGrid       grid = {.file = &file, .ball = &ball};
  char           where[256];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(ReadBall(comm, prefix, &ball));
  PetscCall(MeshFileInitialize(&file, NULL));
  file.rank = PetscMax(rank, 0);
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_shape ball", name, prefix));
  error = MeshOnRank(comm, file.rank, FillBall, &grid, where);
  PetscCallMPI(MPI_Bcast(&grid.missing, 1, MPIU_REAL, file.rank, comm));
  if (!error && grid.missing > 0 && ball.keep_volume)
    PetscCall(
        PetscFPrintf(comm, stderr,
                     "impakt: warning: body '%s' has %.2g %% less volume than the ball of its radius: elements opposite to the pole are "
                     "too large to be moved outward; take more -%sball_divisions, or a weaker -%sball_grading\n",
                     name, (double)(100 * grid.missing), prefix, prefix));
  if (!error && grid.missing > 0 && !ball.keep_volume)
    PetscCall(PetscPrintf(comm, "body '%s' has %.2g %% less volume than the ball of its radius (-%sball_keep_volume false)\n", name,
                          (double)(100 * grid.missing), prefix));
  if (!error) error = MeshBuild(comm, &file, where, dm, middles);
  PetscCall(PetscFree(grid.rim));
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
