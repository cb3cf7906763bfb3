/* Where the nodes of a disc or ball lie before it gets its volume: an O-grid on the sphere, graded toward a pole by a conformal map. */
#include "ballimpl.h"

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

/* Sets the coordinates of a node, from the centre, by the radius: of the central block (layer 0), or of the one outside it in a layer */
static void SetNode(const BallGrid *grid, PetscInt core, PetscInt layer)
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
  for (PetscInt d = 0; d < 3; d++) x[d] /= PetscSqrtReal(length);
}

/* Whether a node of the central block has layers outside: not if it lies inside, or on a cut plane alone */
static PetscBool OnRim(const BallGrid *grid, PetscInt core)
{
  for (PetscInt d = 0; d < grid->ball->dim; d++) {
    const PetscInt place = core / grid->stride[d] % (grid->n[d] + 1);

    if (place == grid->n[d] || (place == 0 && d >= grid->ball->n_cuts)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Numbers the nodes, and sets their coordinates from the centre, by the radius: those of the last layer lie on the sphere */
PetscErrorCode BallSetNodes(BallGrid *grid)
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
               "%" PetscInt_FMT " divisions and %" PetscInt_FMT " layers are too many: take fewer", ball->divisions / ball->step,
               ball->layers / ball->step);
    grid->n_core *= grid->n[d] + 1;
  }
  PetscCall(PetscMalloc1(grid->n_core, &grid->rim));
  for (PetscInt core = 0; core < grid->n_core; core++) grid->rim[core] = OnRim(grid, core) ? grid->n_rim++ : -1;
  grid->n_section     = grid->n_core + ball->layers * grid->n_rim;
  grid->file->n_nodes = grid->n_section;
  PetscCall(PetscCalloc1(3 * grid->file->n_nodes, &grid->file->coordinates));
  for (PetscInt core = 0; core < grid->n_core; core++)
    for (PetscInt layer = 0; layer <= (grid->rim[core] < 0 ? 0 : ball->layers); layer++) SetNode(grid, core, layer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of the node at a place of a block */
PetscInt BallGetNode(const BallGrid *grid, const BallBlock *block, const PetscInt place[3])
{
  const PetscInt before = grid->ball->dim == 2 ? place[2] * grid->n_section : 0; /* of other sections of a rod */
  PetscInt       core = 0, layer = 0;

  for (PetscInt d = 0; d < grid->ball->dim; d++) {
    if (d == block->axis) layer = place[d];
    core += grid->stride[d] * (d != block->axis ? place[d] : block->side ? grid->n[d] : 0);
  }
  return before + (layer ? grid->n_core + (layer - 1) * grid->n_rim + grid->rim[core] : core);
}

/* Whether the axes of a block are left-handed: layers go outward */
PetscBool BallBlockIsMirrored(const BallBlock *block)
{
  return (PetscBool)(block->axis >= 0 && !block->side);
}

/* Whether the Jacobian is positive at all corners of a quadrilateral or hexahedron; if not, `x` is such a corner */
PetscBool BallCellIsConvex(const BallGrid *grid, const BallBlock *block, const PetscInt corner[], const PetscReal *x[])
{
  const PetscReal *coordinates = grid->file->coordinates;
  const PetscInt   dim         = grid->ball->dim;

  for (PetscInt k = 0; k < 1 << dim; k++) {
    PetscReal J[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}, jacobian;

    *x = coordinates + 3 * corner[k];
    for (PetscInt i = 0; i < dim; i++)
      for (PetscInt j = 0; j < dim; j++) J[i][j] = (k >> i & 1 ? -1 : 1) * (coordinates[3 * corner[k ^ 1 << i] + j] - (*x)[j]);
    jacobian = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
               J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
    if (BallBlockIsMirrored(block) ? jacobian >= 0 : jacobian <= 0) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}
