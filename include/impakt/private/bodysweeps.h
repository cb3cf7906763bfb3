/* What the sweeps of an alternation ask of a body: how its rows are prescribed, and how far a sweep has moved it. */
#pragma once
#include <impakt/body.h>

PETSC_EXTERN PetscErrorCode BodySetTractionType(Body, BodyTractionType);
PETSC_EXTERN PetscErrorCode BodySetRowWeights(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodySetRobin(Body, const PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyComputeRowStiffness(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetNewmark(Body, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyResetTraces(Body);
PETSC_EXTERN PetscErrorCode BodyGetPositionChange(Body, PetscReal *, PetscReal *);
