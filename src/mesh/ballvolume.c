/* Moves the nodes of a disc or ball so that it has the volume of the true one. A polyhedron with its corners on the sphere lacks
   volume: 1.7 % with 8 divisions, and 16 % with 12 divisions and a grading of 64, where the elements opposite to the pole are large. */
#include "ballimpl.h"
#include <math.h>

/* The volume is met to this part of itself: round-off of sums over some 10^5 faces */
#define VOLUME_TOLERANCE 1e-13
/* Of a secant method, on a polynomial of degree 2 or 3 that is nearly linear */
#define MAX_ROUNDS 50
/* No node moves outward by more than this part of the radius: the mesh would have another shape than a ball */
#define MOST_MOVE 0.5

/* Faces of the sphere, and by how much its nodes move outward, in the order of the rim of the central block */
typedef struct {
  PetscInt   n_faces, corners, n_nodes;
  PetscInt  *faces;     /* per face: its nodes, in the order of the bits of a corner's number, from that where simplices cut it on */
  PetscReal *direction; /* per node: from the centre, of length 1 */
  PetscReal *move;      /* per node: the way outward that its faces ask for [radii] */
} Sphere;

static PetscReal Dot(const PetscReal a[3], const PetscReal b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static PetscReal Determinant(const PetscReal a[3], const PetscReal b[3], const PetscReal c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Solid angle of a triangle of directions (Van Oosterom, Strackee 1983) */
static PetscReal SolidAngle(const PetscReal a[3], const PetscReal b[3], const PetscReal c[3])
{
  return 2 * PetscAtan2Real(PetscAbsReal(Determinant(a, b, c)), 1 + Dot(a, b) + Dot(b, c) + Dot(c, a));
}

/* The volume between the centre and a face, and of the sector of the unit ball that is seen through it. A quadrilateral is bilinear, as the
   faces of hexahedra are; simplices cut it along the diagonal from its first corner to its last. */
static void FaceVolumes(const Ball *ball, const PetscReal x[4][3], const PetscReal direction[4][3], PetscReal *volume, PetscReal *sector)
{
  const PetscReal gauss[2] = {0.5 - PetscSqrtReal(1 / 12.0), 0.5 + PetscSqrtReal(1 / 12.0)};

  if (ball->dim == 2) {
    const PetscReal *a = direction[0], *b = direction[1];

    *volume = 0.5 * PetscAbsReal(x[0][0] * x[1][1] - x[0][1] * x[1][0]);
    *sector = 0.5 * PetscAtan2Real(PetscAbsReal(a[0] * b[1] - a[1] * b[0]), Dot(a, b));
    if (ball->turned) { /* by Pappus's theorem, and of the ball by Archimedes's */
      *volume *= 2 * PETSC_PI / 3 * (x[0][0] + x[1][0]);
      *sector = 2 * PETSC_PI / 3 * PetscAbsReal(a[1] - b[1]);
    }
    return;
  }
  *sector = (SolidAngle(direction[0], direction[1], direction[3]) + SolidAngle(direction[0], direction[2], direction[3])) / 3;
  if (ball->simplex) {
    *volume = (PetscAbsReal(Determinant(x[0], x[1], x[3])) + PetscAbsReal(Determinant(x[0], x[2], x[3]))) / 6;
    return;
  }
  *volume = 0;
  for (PetscInt i = 0; i < 2; i++)
    for (PetscInt j = 0; j < 2; j++) { /* the integrand has degree 2 along either axis: exact */
      const PetscReal u = gauss[i], v = gauss[j];
      PetscReal       point[3], along[3], across[3];

      for (PetscInt d = 0; d < 3; d++) {
        point[d]  = (1 - v) * ((1 - u) * x[0][d] + u * x[1][d]) + v * ((1 - u) * x[2][d] + u * x[3][d]);
        along[d]  = (1 - v) * (x[1][d] - x[0][d]) + v * (x[3][d] - x[2][d]);
        across[d] = (1 - u) * (x[2][d] - x[0][d]) + u * (x[3][d] - x[1][d]);
      }
      *volume += Determinant(point, along, across) / 12;
    }
  *volume = PetscAbsReal(*volume);
}

/* Volumes of a face with its nodes moved by `share` of what their faces ask for */
static void MovedFaceVolumes(const Ball *ball, const Sphere *sphere, PetscInt face, PetscReal share, PetscReal *volume, PetscReal *sector)
{
  PetscReal x[4][3], direction[4][3];

  for (PetscInt k = 0; k < sphere->corners; k++) {
    const PetscInt node = sphere->faces[sphere->corners * face + k];

    for (PetscInt d = 0; d < 3; d++) {
      direction[k][d] = sphere->direction[3 * node + d];
      x[k][d]         = direction[k][d] * (1 + share * sphere->move[node]);
    }
  }
  FaceVolumes(ball, x, direction, volume, sector);
}

static PetscReal Volume(const Ball *ball, const Sphere *sphere, PetscReal share)
{
  PetscReal sum = 0;

  for (PetscInt f = 0; f < sphere->n_faces; f++) {
    PetscReal volume, sector;

    MovedFaceVolumes(ball, sphere, f, share, &volume, &sector);
    sum += volume;
  }
  return sum;
}

/* The corner of a cell, or of a face or edge of it that lies along some axes, at which the walks of its simplices begin: bit i is 1 if it
   is the farther one along axes[i], where the number of elements to the nearer one is odd; cells of a box, which has no divisions, are all
   cut the same way */
PetscInt BallFirstCorner(const Ball *ball, const BallBlock *block, PetscInt n_axes, const PetscInt axes[], const PetscInt at[3])
{
  const PetscInt half  = ball->divisions / ball->step / 2; /* elements from the plane in the middle to the lower side, or to the layers */
  PetscInt       first = 0;

  for (PetscInt i = 0; i < n_axes && ball->divisions; i++) {
    const PetscInt  d        = axes[i];
    const PetscBool from_cut = (PetscBool)(d < ball->n_cuts && d != block->axis);

    first |= (at[d] / ball->step + (from_cut || d >= ball->dim ? 0 : half)) % 2 << i;
  }
  return first;
}

static PetscErrorCode FindFaces(const BallGrid *grid, Sphere *sphere)
{
  const PetscInt dim = grid->ball->dim, outer = grid->n_core + (grid->ball->layers - 1) * grid->n_rim;

  PetscFunctionBegin;
  sphere->corners = 1 << (dim - 1);
  sphere->n_nodes = grid->n_rim;
  for (PetscInt b = 1; b < grid->n_blocks; b++) {
    PetscInt n = 1;

    for (PetscInt d = 0; d < dim; d++) n *= d == grid->blocks[b].axis ? 1 : grid->n[d];
    sphere->n_faces += n;
  }
  PetscCall(PetscMalloc3(sphere->n_faces * sphere->corners, &sphere->faces, 3 * sphere->n_nodes, &sphere->direction, sphere->n_nodes,
                         &sphere->move));
  for (PetscInt b = 1, next = 0; b < grid->n_blocks; b++) {
    const BallBlock *block   = &grid->blocks[b];
    PetscInt         axes[2] = {0, 0}, n_axes = 0;

    for (PetscInt d = 0; d < dim; d++)
      if (d != block->axis) axes[n_axes++] = d;
    for (PetscInt j = 0; j < (dim == 3 ? grid->n[axes[1]] : 1); j++)
      for (PetscInt i = 0; i < grid->n[axes[0]]; i++)
        for (PetscInt k = 0; k < sphere->corners; k++) {
          PetscInt place[3] = {0, 0, 0}, corner = k;

          if (dim == 3) place[axes[1]] = j;
          place[axes[0]] = i;
          if (grid->ball->simplex) corner ^= BallFirstCorner(grid->ball, block, n_axes, axes, place);
          place[axes[0]] += corner & 1;
          if (dim == 3) place[axes[1]] += corner >> 1;
          place[block->axis]    = grid->ball->layers;
          sphere->faces[next++] = BallGetNode(grid, block, place) - outer;
        }
  }
  PetscCall(PetscArraycpy(sphere->direction, grid->file->coordinates + 3 * outer, 3 * sphere->n_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A node moves outward so that the faces around it, if all of their nodes did so, would bound the volume of their sectors */
static PetscErrorCode FindMoves(const Ball *ball, Sphere *sphere)
{
  PetscReal *volumes, *sectors;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(sphere->n_nodes, &volumes, sphere->n_nodes, &sectors));
  PetscCall(PetscArrayzero(sphere->move, sphere->n_nodes));
  for (PetscInt f = 0; f < sphere->n_faces; f++) {
    PetscReal volume, sector;

    MovedFaceVolumes(ball, sphere, f, 0, &volume, &sector);
    for (PetscInt k = 0; k < sphere->corners; k++) {
      volumes[sphere->faces[sphere->corners * f + k]] += volume;
      sectors[sphere->faces[sphere->corners * f + k]] += sector;
    }
  }
  for (PetscInt i = 0; i < sphere->n_nodes; i++)
    sphere->move[i] = PetscPowReal(sectors[i] / volumes[i], 1.0 / (ball->turned ? 3 : ball->dim)) - 1;
  PetscCall(PetscFree2(volumes, sectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The share of these moves that makes the volume that of the true ball: near 1, as neighbours move alike. NAN if there is none. */
static PetscReal FindShare(const Ball *ball, const Sphere *sphere, PetscReal wanted)
{
  PetscReal share = 1, before = 0, missing = wanted - Volume(ball, sphere, 0);

  for (PetscInt round = 0; round < MAX_ROUNDS; round++) {
    const PetscReal now = share, left = wanted - Volume(ball, sphere, now);

    if (PetscAbsReal(left) <= VOLUME_TOLERANCE * wanted) return share;
    share += left * (now - before) / (missing - left);
    before  = now;
    missing = left;
  }
  return NAN;
}

/* Moves the nodes of the last layer along their radii, those of the layers within by their part of it, and a graded ball as a whole along
   its pole, so that it still reaches as far as the true ball there: bodies that touch at the pole still do */
static void MoveNodes(const BallGrid *grid, const Sphere *sphere, PetscReal share)
{
  const Ball *ball  = grid->ball;
  PetscReal   reach = 0;

  for (PetscInt layer = 1; layer <= ball->layers; layer++)
    for (PetscInt i = 0; i < grid->n_rim; i++) {
      PetscReal *x = grid->file->coordinates + 3 * (grid->n_core + (layer - 1) * grid->n_rim + i);

      for (PetscInt d = 0; d < 3; d++) x[d] *= 1 + share * sphere->move[i] * (PetscReal)layer / (PetscReal)ball->layers;
      reach = PetscMax(reach, Dot(x, ball->pole));
    }
  for (PetscInt i = 0; i < grid->file->n_nodes && ball->grading > 1; i++)
    for (PetscInt d = 0; d < 3; d++) grid->file->coordinates[3 * i + d] -= (reach - 1) * ball->pole[d];
}

/* Whether all boxes, which may be made of simplices, are convex */
static PetscBool CellsAreConvex(const BallGrid *grid)
{
  for (PetscInt b = 0; b < grid->n_blocks; b++) {
    const BallBlock *block  = &grid->blocks[b];
    PetscInt         end[3] = {1, 1, 1}, at[3];

    for (PetscInt d = 0; d < grid->ball->dim; d++) end[d] = d == block->axis ? grid->ball->layers : grid->n[d];
    for (at[2] = 0; at[2] < end[2]; at[2]++)
      for (at[1] = 0; at[1] < end[1]; at[1]++)
        for (at[0] = 0; at[0] < end[0]; at[0]++) {
          const PetscReal *x;
          PetscInt         corner[8];

          for (PetscInt k = 0; k < 1 << grid->ball->dim; k++) {
            const PetscInt place[3] = {at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2)};

            corner[k] = BallGetNode(grid, block, place);
          }
          if (!BallCellIsConvex(grid, block, corner, &x)) return PETSC_FALSE;
        }
  }
  return PETSC_TRUE;
}

/* Moves the nodes, whose positions are from the centre and by the radius, so that the volume is that of the ball. Where elements are too
   coarse for that, nodes stay on the sphere, and grid->missing says how much of the volume is missing. */
PetscErrorCode BallKeepVolume(BallGrid *grid)
{
  const Ball     *ball   = grid->ball;
  const PetscReal wanted = ball->turned ? 4 * PETSC_PI / 3
                                        : (ball->dim == 2 ? PETSC_PI : 4 * PETSC_PI / 3) / (PetscReal)(1 << ball->n_cuts);
  Sphere          sphere = {0};
  PetscReal      *before, share, most = 0;

  PetscFunctionBegin;
  PetscCall(FindFaces(grid, &sphere));
  PetscCall(FindMoves(ball, &sphere));
  share = FindShare(ball, &sphere, wanted);
  for (PetscInt i = 0; i < sphere.n_nodes; i++) most = PetscMax(most, share * sphere.move[i]);
  grid->missing = 1 - Volume(ball, &sphere, 0) / wanted;
  if (ball->keep_volume && most <= MOST_MOVE && !PetscIsNanReal(share)) {
    PetscCall(PetscMalloc1(3 * grid->file->n_nodes, &before));
    PetscCall(PetscArraycpy(before, grid->file->coordinates, 3 * grid->file->n_nodes));
    MoveNodes(grid, &sphere, share);
    if (CellsAreConvex(grid)) grid->missing = 0;
    else PetscCall(PetscArraycpy(grid->file->coordinates, before, 3 * grid->file->n_nodes));
    PetscCall(PetscFree(before));
  }
  PetscCall(PetscFree3(sphere.faces, sphere.direction, sphere.move));
  PetscFunctionReturn(PETSC_SUCCESS);
}
