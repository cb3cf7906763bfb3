/* Surfaces of the obstacles as grids of points, for files of fields. */
#pragma once
#include <impakt/contact.h>
#include <hdf5.h>

/* Points at origin + f_i(u, v) vector_i, in `rows` from v = 0 to 1, each of so many segments from u = 0 to 1 */
typedef struct {
  const char  *name;         /* borrowed */
  ObstacleType type;         /* a plane has f = 2 u - 1, 2 v - 1, 0; see Position() for the others */
  PetscInt     segments;     /* 0: the obstacle does not cut the plane of the bodies */
  PetscInt     rows;         /* a single one has v = 1/2 */
  PetscInt     corners;      /* of a cell: 4 between two rows, or 2 where each row is a line */
  PetscReal    origin[3];    /* [m] */
  PetscReal    vector[3][3]; /* [m] */
} ObstacleGrid;

static inline PetscInt ObstacleGridCountPoints(const ObstacleGrid *grid)
{
  return grid->rows * (grid->segments + 1);
}

static inline PetscInt ObstacleGridCountCells(const ObstacleGrid *grid)
{
  return grid->segments * (grid->corners == 4 ? grid->rows - 1 : grid->rows);
}

PETSC_INTERN PetscErrorCode FieldsObstaclesCheckPath(Contact, const char[]);
PETSC_INTERN PetscErrorCode FieldsObstaclesFind(Contact, PetscInt, const Body[], PetscInt *, ObstacleGrid *[]);
PETSC_INTERN PetscErrorCode FieldsObstaclesWrite(const char[], PetscInt, const ObstacleGrid[]);
