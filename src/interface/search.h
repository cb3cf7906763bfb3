/* Which face lies opposite to a point. Private to src/interface. */
#pragma once
#include <surface.h>

PETSC_INTERN PetscErrorCode SearchClosestFace(const SurfaceData *, const PetscReal[], const PetscReal[], PetscInt *, PetscReal[]);
