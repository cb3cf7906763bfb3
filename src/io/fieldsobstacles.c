/* Surfaces of the obstacles, to be shown with the fields: /mesh/obstacles/<name>/{points,cells}, listed by an XDMF file of their own. In
   that of the bodies they would disturb: meshio takes the first grid alone for the mesh, and VTK returns blocks where there are two. */
#include "obstaclegrid.h"
#include "fieldsfile.h"
#include "hdf5file.h"
#include "outputfile.h"
#include "xdmf.h"
#include <impakt/private/bodymesh.h>
#include <impakt/private/contactsteps.h>
#include <impakt/private/transfer.h>

#define SIZE        1.5  /* of a plane, and length of a cylinder, in diagonals of the box of all bodies */
#define FLAT_CELLS  8    /* along each side of a plane, and along a cylinder */
#define ROUND_CELLS 48   /* all around a sphere or a cylinder */
#define IN_PLANE    1e-9 /* an axis with a smaller third component lies in the plane of the bodies */

static void Scale(PetscReal factor, const PetscReal x[], PetscReal y[])
{
  for (PetscInt d = 0; d < 3; d++) y[d] = factor * x[d];
}

/* Changes the grid of an obstacle in three dimensions to the lines in which the obstacle cuts z = 0, the plane of the bodies */
static void CutGrid(const PetscReal point[], const PetscReal n[], PetscReal radius, PetscReal size, ObstacleGrid *grid)
{
  const PetscReal flat = PetscSqrtReal(PetscSqr(n[0]) + PetscSqr(n[1]));
  const PetscReal half = PetscSqrtReal(PetscMax(0, PetscSqr(radius) - PetscSqr(point[2]))); /* of the chord of a circle about `point` */
  const PetscReal across[3] = {-n[1], n[0], 0};
  PetscReal      *origin    = grid->origin;

  grid->rows    = 1;
  grid->corners = 2;
  if (grid->type == OBSTACLE_PLANE) {
    if (flat < IN_PLANE) grid->segments = 0;
    else {
      for (PetscInt d = 0; d < 2; d++) origin[d] += origin[2] * n[2] * n[d] / PetscSqr(flat);
      Scale(size / 2 / flat, across, grid->vector[0]);
    }
  } else if (grid->type == OBSTACLE_SPHERE) {
    if (!(half > 0)) grid->segments = 0;
    else
      for (PetscInt i = 0; i < 2; i++) Scale(half / radius, grid->vector[i], grid->vector[i]);
  } else if (PetscAbsReal(n[2]) < IN_PLANE) { /* two lines along the axis */
    grid->type     = OBSTACLE_PLANE;
    grid->rows     = 2;
    grid->segments = half > 0 ? FLAT_CELLS : 0;
    Scale(size / 2, n, grid->vector[0]);
    Scale(half, across, grid->vector[1]);
  } else { /* an ellipse: along the axis onto the plane */
    for (PetscInt i = -1; i < 2; i++) {
      PetscReal      *x  = i < 0 ? origin : grid->vector[i];
      const PetscReal up = x[2] / n[2];

      for (PetscInt d = 0; d < 3; d++) x[d] -= up * n[d];
    }
  }
  origin[2] = 0;
  Scale(0, n, grid->vector[2]);
}

/* A plane gets a grid about its point closest to the box's centre, a cylinder one along its axis there, a sphere one all around */
static PetscErrorCode FindGrid(Obstacle obstacle, PetscInt dim, const PetscReal centre[], PetscReal size, ObstacleGrid *grid)
{
  PetscReal point[3], n[3], normal[3], distance, along = 0, norm, radius;
  PetscInt  first = 0;

  PetscFunctionBegin;
  PetscCall(ObstacleGetShape(obstacle, &grid->type, point, n));
  PetscCall(ObstacleGetGap(obstacle, point, &distance, normal));
  radius = -distance;
  if (grid->type == OBSTACLE_SPHERE) n[2] = 1;
  for (PetscInt d = 0; d < 3; d++) along += (centre[d] - point[d]) * n[d];
  for (PetscInt d = 1; d < 3; d++)
    if (PetscAbsReal(n[d]) < PetscAbsReal(n[first])) first = d;
  norm = PetscSqrtReal(1 - PetscSqr(n[first]));
  for (PetscInt d = 0; d < 3; d++) {
    grid->origin[d]    = grid->type == OBSTACLE_PLANE ? centre[d] - along * n[d] : point[d];
    grid->vector[0][d] = ((d == first) - n[first] * n[d]) / norm;
    if (grid->type == OBSTACLE_CYLINDER) grid->origin[d] += along * n[d];
  }
  for (PetscInt d = 0; d < 3; d++) { /* so that cells have the normal of the obstacle */
    const PetscInt e = (d + 1) % 3, f = (d + 2) % 3;

    grid->vector[1][d] = n[e] * grid->vector[0][f] - n[f] * grid->vector[0][e];
  }
  for (PetscInt i = 0; i < 2; i++) Scale(grid->type == OBSTACLE_PLANE ? size / 2 : radius, grid->vector[i], grid->vector[i]);
  Scale(grid->type == OBSTACLE_SPHERE ? radius : size / 2, n, grid->vector[2]);
  grid->segments = grid->type == OBSTACLE_PLANE ? FLAT_CELLS : ROUND_CELLS;
  grid->rows     = 1 + (grid->type == OBSTACLE_SPHERE ? ROUND_CELLS / 2 : FLAT_CELLS);
  grid->corners  = 4;
  if (dim < 3) CutGrid(point, n, radius, size, grid);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Position(const ObstacleGrid *grid, PetscInt row, PetscInt column, PetscReal x[])
{
  const PetscReal u    = (PetscReal)column / (PetscReal)grid->segments,
                  v    = grid->rows > 1 ? (PetscReal)row / (PetscReal)(grid->rows - 1) : 0.5;
  const PetscReal ring = grid->type == OBSTACLE_SPHERE ? PetscSinReal(PETSC_PI * v) : 1;
  PetscReal       f[3] = {ring * PetscCosReal(2 * PETSC_PI * u), ring * PetscSinReal(2 * PETSC_PI * u), 2 * v - 1};

  if (grid->type == OBSTACLE_SPHERE) f[2] = -PetscCosReal(PETSC_PI * v);
  if (grid->type == OBSTACLE_PLANE) f[0] = 2 * u - 1, f[1] = 2 * v - 1, f[2] = 0;
  for (PetscInt d = 0; d < 3; d++)
    x[d] = grid->origin[d] + f[0] * grid->vector[0][d] + f[1] * grid->vector[1][d] + f[2] * grid->vector[2][d];
}

static PetscErrorCode WriteGrid(hid_t file, const ObstacleGrid *grid, const char path[])
{
  PetscReal *points;
  int       *cells, *cell;
  char       name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * ObstacleGridCountPoints(grid), &points, grid->corners * ObstacleGridCountCells(grid), &cells));
  for (PetscInt i = 0; i < ObstacleGridCountPoints(grid); i++)
    Position(grid, i / (grid->segments + 1), i % (grid->segments + 1), points + 3 * i);
  cell = cells;
  for (PetscInt i = 0; i < ObstacleGridCountCells(grid); i++) {
    const int begin = (int)(i + i / grid->segments), above = begin + (int)grid->segments + 1;

    *cell++ = begin;
    *cell++ = begin + 1;
    if (grid->corners == 4) *cell++ = above + 1, *cell++ = above;
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "/mesh/obstacles/%s/points", grid->name));
  PetscCall(FieldsFileAdd(file, name, H5T_NATIVE_DOUBLE, (hsize_t)ObstacleGridCountPoints(grid), 3, UNIT_LENGTH, points, path));
  PetscCall(PetscSNPrintf(name, sizeof(name), "/mesh/obstacles/%s/cells", grid->name));
  PetscCall(FieldsFileAdd(file, name, H5T_NATIVE_INT, (hsize_t)ObstacleGridCountCells(grid), grid->corners, UNIT_ONE, cells, path));
  PetscCall(PetscFree2(points, cells));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The centre and the diagonal of the box of all bodies where they are now */
static PetscErrorCode FindBox(PetscInt n_bodies, const Body bodies[], PetscReal centre[], PetscReal *diagonal)
{
  PetscReal *box, squares = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(6 * n_bodies, &box));
  PetscCall(BodyGetAllBoxes(n_bodies, bodies, box));
  for (PetscInt k = 6; k < 6 * n_bodies; k++) box[k % 6] = PetscMin(box[k % 6], box[k]);
  for (PetscInt d = 0; d < 3; d++) {
    centre[d] = (box[d] - box[3 + d]) / 2;
    squares += PetscSqr(box[d] + box[3 + d]);
  }
  *diagonal = PetscSqrtReal(squares);
  PetscCall(PetscFree(box));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FieldsObstaclesCheckPath - makes sure, where there are obstacles, that their XDMF file can be written; Collective */
PetscErrorCode FieldsObstaclesCheckPath(Contact contact, const char fields[])
{
  char     path[PETSC_MAX_PATH_LEN];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(ContactGetObstacles(contact, &n, NULL));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(XdmfGetPath(fields, XDMF_OBSTACLES, sizeof(path), path));
  PetscCall(OutputFileCheck(PetscObjectComm((PetscObject)contact), "-output_fields, beside it,", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surfaces of all obstacles within the space of the bodies. `grids`: n of them, to be freed; `contact` must outlive them. Collective */
PetscErrorCode FieldsObstaclesFind(Contact contact, PetscInt n_bodies, const Body bodies[], PetscInt *n, ObstacleGrid *grids[])
{
  const Obstacle *obstacles;
  PetscReal       centre[3], diagonal = 0;
  PetscInt        n_obstacles, dim;

  PetscFunctionBegin;
  *n     = 0;
  *grids = NULL;
  PetscCall(ContactGetObstacles(contact, &n_obstacles, &obstacles));
  if (!n_obstacles) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetDimension(bodies[0], &dim));
  PetscCall(FindBox(n_bodies, bodies, centre, &diagonal));
  PetscCall(PetscMalloc1(n_obstacles, grids));
  for (PetscInt o = 0; o < n_obstacles; o++) {
    ObstacleGrid *grid = *grids + *n;

    PetscCall(FindGrid(obstacles[o], dim, centre, SIZE * diagonal, grid));
    PetscCall(PetscObjectGetName((PetscObject)obstacles[o], &grid->name));
    if (grid->segments) (*n)++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FieldsObstaclesWrite - adds the grids, if there are any, to a file that FieldsFileCreate() has made; one rank calls it */
PetscErrorCode FieldsObstaclesWrite(const char path[], PetscInt n, const ObstacleGrid grids[])
{
  hid_t file;

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  PetscCall(HDF5Check(file, "open the file again", path));
  for (PetscInt i = 0; i < n; i++) PetscCall(WriteGrid(file, &grids[i], path));
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
