/* Boxes about points: the lower corner, then the upper one with its sign changed, so that one minimum over the ranks finds both. */
#pragma once
#include <petscsys.h>

/* The box about n points, three numbers each [m]; without points its lower corner is beyond the upper one */
static inline void BoxFind(PetscInt n, const PetscReal x[], PetscReal box[6])
{
  for (PetscInt k = 0; k < 6; k++) box[k] = PETSC_MAX_REAL;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt d = 0; d < 3; d++) {
      box[d]     = PetscMin(box[d], x[3 * i + d]);
      box[3 + d] = PetscMin(box[3 + d], -x[3 * i + d]);
    }
}

/* Whether two boxes have a point in common, which an empty one has with none */
static inline PetscBool BoxesMeet(const PetscReal a[6], const PetscReal b[6])
{
  for (PetscInt d = 0; d < 3; d++)
    if (a[d] > -b[3 + d] || b[d] > -a[3 + d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* How far two boxes are apart, 0 where they meet [m] */
static inline PetscReal BoxesDistance(const PetscReal a[6], const PetscReal b[6])
{
  PetscReal square = 0;

  for (PetscInt d = 0; d < 3; d++) square += PetscSqr(PetscMax(0, PetscMax(a[d] + b[3 + d], b[d] + a[3 + d])));
  return PetscSqrtReal(square);
}
