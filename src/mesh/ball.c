/* Discs and balls from options: an O-grid, graded toward a pole by a conformal map, or a symmetric part of it. PETSc itself can make balls
   only with a generator of tetrahedra. */
#include "meshimpl.h"

/* A face of the sphere belongs to its back if no corner is further than this on the pole's side of the centre [radii]: round-off */
#define BACK_TOLERANCE 1e-12

typedef struct {
  PetscInt  dim, divisions, layers;
  PetscInt  n_cuts; /* planes that cut it: x = centre, then y = centre */
  PetscReal radius, centre[3], pole[3], grading;
  PetscBool simplex;
} Ball;

/* Numbers of the nodes: those of the central block come first, along its axes; then those of each layer around it, in which there is a node
   for each node on the rim of the central block */
typedef struct {
  MeshFile   *file;
  const Ball *ball;
  PetscInt    n[3], stride[3]; /* elements along the axes of the central block */
  PetscInt    n_core, n_rim;   /* nodes of the central block, and of its rim */
  PetscInt   *rim;             /* per node of the central block: its number on the rim, -1 inside */
} Grid;

/* The central block, or the block of layers on one side of it: along the axis of that side places count layers */
typedef struct {
  PetscInt axis; /* -1: the central block */
  PetscInt side; /* 0: lower, 1: upper */
} Block;

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

static PetscErrorCode ReadBall(MPI_Comm comm, const char prefix[], Ball *ball)
{
  PetscReal centre[4];
  PetscBool set;

  PetscFunctionBegin;
  *ball = (Ball){.dim = 2, .divisions = 4, .radius = 1, .grading = 1};
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A point of the unit ball. xi is a point of the central block, with components from -1 to 1; the result is its place (share 0), or one on
   the straight line from there to the sphere (share 1 on the sphere). */
static void LayPoint(PetscInt dim, const PetscReal xi[3], PetscReal share, PetscReal x[3])
{
  /* The shape of the central block lies between a cube of this half width [radii] and a ball. With these values the worst elements, at its
     corners, have the largest scaled Jacobian: 0.85 in 2-D, 0.73 in 3-D. */
  const PetscReal half_width = 0.5, bulge = dim == 2 ? 0.375 : 0.5;
  PetscReal       outer[3], length        = 0;

  for (PetscInt d = 0; d < 3; d++) outer[d] = PetscTanReal(PETSC_PI / 4 * xi[d]); /* equal angles on the sphere */
  for (PetscInt d = 0; d < 3; d++) length += PetscSqr(outer[d]);
  for (PetscInt d = 0; d < 3; d++) {
    const PetscReal a = PetscSqr(xi[(d + 1) % 3]), b = PetscSqr(xi[(d + 2) % 3]);
    const PetscReal round = PetscSqrtReal(1 - a / 2 - b / 2 + a * b / 3); /* cube to ball: Nowell 2005 */
    const PetscReal inner = half_width * xi[d] * (1 - bulge + bulge * round);

    x[d] = share > 0 ? inner + share * (outer[d] / PetscSqrtReal(length) - inner) : inner;
  }
}

/* Applies the Moebius transformation of the unit ball onto itself that takes the point a to the centre (Ahlfors, Moebius transformations in
   several dimensions, 1981, eq. 2.7):  T x = ((1 - |a|^2) (x - a) - |x - a|^2 a) / (1 + |x|^2 |a|^2 - 2 x.a).
   T is conformal, so that small elements keep their shapes. It scales by (1 - |a|^2) / (1 + |x|^2 |a|^2 - 2 x.a): with a = -s pole, by
   (1 - s) / (1 + s) at the pole and by the inverse of that opposite to the pole. */
static void GradePoint(const Ball *ball, PetscReal x[3])
{
  const PetscReal root = PetscSqrtReal(ball->grading), s = (root - 1) / (root + 1);
  PetscReal       a[3], squared = 0, distance = 0, product = 0;

  for (PetscInt d = 0; d < 3; d++) {
    a[d] = -s * ball->pole[d];
    squared += PetscSqr(x[d]);
    distance += PetscSqr(x[d] - a[d]);
    product += x[d] * a[d];
  }
  for (PetscInt d = 0; d < 3; d++) x[d] = ((1 - s * s) * (x[d] - a[d]) - distance * a[d]) / (1 + squared * s * s - 2 * product);
}

/* Sets the coordinates of a node: of the central block (layer 0), or of the one outside it in a layer */
static void SetNode(const Grid *grid, PetscInt core, PetscInt layer)
{
  const Ball *ball  = grid->ball;
  PetscReal  *x     = grid->file->coordinates + 3 * (layer ? grid->n_core + (layer - 1) * grid->n_rim + grid->rim[core] : core);
  PetscReal   xi[3] = {0}, length = 0;

  for (PetscInt d = 0; d < ball->dim; d++) {
    const PetscInt place = core / grid->stride[d] % (grid->n[d] + 1);

    xi[d] = d < ball->n_cuts ? (PetscReal)place / grid->n[d] : -1 + 2 * (PetscReal)place / grid->n[d];
  }
  LayPoint(ball->dim, xi, (PetscReal)layer / ball->layers, x);
  if (ball->grading > 1) GradePoint(ball, x);
  for (PetscInt d = 0; d < 3; d++) length += PetscSqr(x[d]);
  if (layer < ball->layers) length = 1; /* only nodes of the last layer are put onto the sphere, from which they differ by round-off */
  for (PetscInt d = 0; d < 3; d++) x[d] = ball->centre[d] + ball->radius * x[d] / PetscSqrtReal(length);
}

/* Whether a node of the central block has layers outside: not if it lies inside, or on a cut plane alone */
static PetscBool OnRim(const Grid *grid, PetscInt core)
{
  for (PetscInt d = 0; d < grid->ball->dim; d++) {
    const PetscInt place = core / grid->stride[d] % (grid->n[d] + 1);

    if (place == grid->n[d] || (place == 0 && d >= grid->ball->n_cuts)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode SetNodes(Grid *grid)
{
  const Ball *ball = grid->ball;
  double      size = 1;

  PetscFunctionBegin;
  grid->n_core = 1;
  for (PetscInt d = 0; d < ball->dim; d++) {
    grid->n[d]      = d < ball->n_cuts ? ball->divisions / 2 : ball->divisions;
    grid->stride[d] = grid->n_core;
    size *= ball->divisions + 1.0;
    /* the corners of all cells of all blocks must be counted in PetscInt; there are most with 6 tetrahedra in each cell */
    PetscCheck(size * (1 + 2.0 * ball->dim * ball->layers / ball->divisions) * 24 < PETSC_INT_MAX, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
               "%" PetscInt_FMT " divisions and %" PetscInt_FMT " layers are too many: take fewer", ball->divisions, ball->layers);
    grid->n_core *= grid->n[d] + 1;
  }
  PetscCall(PetscMalloc1(grid->n_core, &grid->rim));
  for (PetscInt core = 0; core < grid->n_core; core++) grid->rim[core] = OnRim(grid, core) ? grid->n_rim++ : -1;
  grid->file->n_nodes = grid->n_core + ball->layers * grid->n_rim;
  PetscCall(PetscCalloc1(3 * grid->file->n_nodes, &grid->file->coordinates));
  for (PetscInt core = 0; core < grid->n_core; core++)
    for (PetscInt layer = 0; layer <= (grid->rim[core] < 0 ? 0 : ball->layers); layer++) SetNode(grid, core, layer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of the node at a place of a block */
static PetscInt GetNode(const Grid *grid, const Block *block, const PetscInt place[3])
{
  PetscInt core = 0, layer = 0;

  for (PetscInt d = 0; d < grid->ball->dim; d++) {
    if (d == block->axis) layer = place[d];
    core += grid->stride[d] * (d != block->axis ? place[d] : block->side ? grid->n[d] : 0);
  }
  return layer ? grid->n_core + (layer - 1) * grid->n_rim + grid->rim[core] : core;
}

/* Adds a segment, quadrilateral or hexahedron, or the simplices that fill it: one for each way to walk from its first corner to its last
   along the axes (Kuhn 1960). Bit d of a corner's number is 1 if it is the farther one along axis d. Blocks have the same axes where they
   touch, so that common faces are cut along the same diagonal. */
static PetscErrorCode AddCell(MeshFile *file, PetscInt dim, const PetscInt corner[8], PetscBool mirrored, PetscBool simplex)
{
  static const PetscInt whole[2][8]     = {{0, 1, 3, 2, 4, 5, 7, 6}, {0, 2, 3, 1, 4, 6, 7, 5}};
  static const PetscInt orders[3][6][3] = {{{0}}, {{0, 1}, {1, 0}}, {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const PetscInt        n_orders        = dim == 3 ? 6 : dim;
  PetscInt             *nodes;

  PetscFunctionBegin;
  if (!simplex || dim == 1) {
    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    for (PetscInt k = 0; k < 1 << dim; k++) nodes[k] = corner[whole[mirrored && dim > 1][k]];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt o = 0; o < n_orders; o++) {
    const PetscBool odd = (PetscBool)(o >= n_orders / 2);

    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    for (PetscInt k = 0, place = 0; k <= dim; k++) {
      nodes[odd == mirrored || k < dim - 1 ? k : 2 * dim - 1 - k] = corner[place]; /* otherwise the last two change places */
      if (k < dim) place |= 1 << orders[dim - 1][o][k];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error unless the Jacobian is positive at all corners of a quadrilateral or hexahedron, which is convex then */
static PetscErrorCode CheckCell(const Grid *grid, const PetscInt corner[8], PetscBool mirrored)
{
  const Ball *ball = grid->ball;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 1 << ball->dim; k++) {
    const PetscReal *x       = grid->file->coordinates + 3 * corner[k];
    PetscReal        J[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}, jacobian;

    for (PetscInt i = 0; i < ball->dim; i++)
      for (PetscInt j = 0; j < ball->dim; j++)
        J[i][j] = (k >> i & 1 ? -1 : 1) * (grid->file->coordinates[3 * corner[k ^ 1 << i] + j] - x[j]);
    jacobian = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
               J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
    PetscCheck(
        mirrored ? jacobian < 0 : jacobian > 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
        "with %" PetscInt_FMT " divisions, %" PetscInt_FMT
        " layers and a grading of %g, the element with a corner at (%g, %g, %g) is not convex: take more divisions, or a weaker grading",
        ball->divisions, ball->layers, (double)ball->grading, (double)x[0], (double)x[1], (double)x[2]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the cells begin[d] to end[d] - 1 of a block along each axis d, or those faces of these cells that lie along some axes */
static PetscErrorCode AddRange(const Grid *grid, const Block *block, PetscInt n_axes, const PetscInt axes[], const PetscInt begin[3],
                               const PetscInt end[3])
{
  const Ball     *ball     = grid->ball;
  const PetscBool mirrored = (PetscBool)(block->axis >= 0 && !block->side); /* layers go outward */
  PetscInt        at[3];

  PetscFunctionBegin;
  for (at[2] = begin[2]; at[2] < end[2]; at[2]++)
    for (at[1] = begin[1]; at[1] < end[1]; at[1]++)
      for (at[0] = begin[0]; at[0] < end[0]; at[0]++) {
        PetscInt corner[8];

        for (PetscInt k = 0; k < 1 << n_axes; k++) {
          PetscInt place[3] = {at[0], at[1], at[2]};

          for (PetscInt i = 0; i < n_axes; i++) place[axes[i]] += k >> i & 1;
          corner[k] = GetNode(grid, block, place);
        }
        if (n_axes == ball->dim && !ball->simplex) PetscCall(CheckCell(grid, corner, mirrored));
        PetscCall(AddCell(grid->file, n_axes, corner, mirrored, ball->simplex));
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
  PetscCall(MeshFileAddRun(file,
                           ball->dim == 2  ? DM_POLYTOPE_SEGMENT
                           : ball->simplex ? DM_POLYTOPE_TRIANGLE
                                           : DM_POLYTOPE_QUADRILATERAL,
                           1, &group));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the faces of a block across an axis that lie behind `place` cells along it */
static PetscErrorCode AddFaces(const Grid *grid, const Block *block, PetscInt axis, PetscInt place)
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

    for (PetscInt k = 0; k < run.corners; k++) {
      const PetscReal *x     = file->coordinates + 3 * file->element_nodes[run.first_node + e * run.corners + k];
      PetscReal        along = 0;

      for (PetscInt d = 0; d < ball->dim; d++) along += (x[d] - ball->centre[d]) * ball->pole[d];
      nearest = PetscMax(nearest, along);
    }
    if (nearest > BACK_TOLERANCE * ball->radius) continue;
    PetscCall(MeshFileAddElement(file, file->n_elements + 1, &nodes));
    PetscCall(PetscArraycpy(nodes, file->element_nodes + run.first_node + e * run.corners, run.corners));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FillBall(void *ctx)
{
  static const char *const cut_names[] = {"cut_x", "cut_y"};
  Grid                    *grid        = (Grid *)ctx;
  const Ball              *ball        = grid->ball;
  const PetscInt           all[3] = {0, 1, 2}, begin[3] = {0};
  const DMPolytopeType     shapes[2][2] = {{DM_POLYTOPE_QUADRILATERAL, DM_POLYTOPE_TRIANGLE},
                                           {DM_POLYTOPE_HEXAHEDRON, DM_POLYTOPE_TETRAHEDRON}};
  Block                    blocks[7]    = {{-1, 0}};
  PetscInt                 n_blocks     = 1, sphere;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < ball->dim; d++)
    for (PetscInt side = d < ball->n_cuts ? 1 : 0; side < 2; side++) blocks[n_blocks++] = (Block){d, side};
  PetscCall(SetNodes(grid));
  PetscCall(MeshFileAddRun(grid->file, shapes[ball->dim - 2][ball->simplex], 0, NULL));
  for (PetscInt b = 0; b < n_blocks; b++) {
    PetscInt end[3] = {1, 1, 1};

    for (PetscInt d = 0; d < ball->dim; d++) end[d] = d == blocks[b].axis ? ball->layers : grid->n[d];
    PetscCall(AddRange(grid, &blocks[b], ball->dim, all, begin, end));
  }
  PetscCall(AddSurface(grid->file, ball, 1, "surface"));
  sphere = grid->file->n_runs - 1;
  for (PetscInt b = 1; b < n_blocks; b++) PetscCall(AddFaces(grid, &blocks[b], blocks[b].axis, ball->layers));
  for (PetscInt cut = 0; cut < ball->n_cuts; cut++) {
    PetscCall(AddSurface(grid->file, ball, cut + 2, cut_names[cut]));
    for (PetscInt b = 0; b < n_blocks; b++)
      if (blocks[b].axis != cut) PetscCall(AddFaces(grid, &blocks[b], cut, 0));
  }
  PetscCall(AddBack(grid->file, ball, sphere));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A disc or a ball from options */
PetscErrorCode MeshCreateBall(MPI_Comm comm, const char prefix[], const char name[], DM *dm)
{
  Ball           ball;
  MeshFile       file;
  Grid           grid = {.file = &file, .ball = &ball};
  char           where[256];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(ReadBall(comm, prefix, &ball));
  PetscCall(MeshFileInitialize(&file, NULL));
  PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', -%sdm_plex_shape ball", name, prefix));
  error = MeshOnFirstRank(comm, FillBall, &grid, where);
  if (!error) error = MeshBuild(comm, &file, where, dm);
  PetscCall(PetscFree(grid.rim));
  PetscCall(MeshFileDestroy(&file));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
