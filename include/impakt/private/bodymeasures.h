/* Energies of many bodies at once, and what they are compared with. */
#pragma once
#include <impakt/body.h>

#define BODY_MEASURE_SUMS 24 /* numbers that measures and energies of a body are summed up from */

PETSC_EXTERN PetscErrorCode BodyGetAllMeasures(PetscInt, const Body[], PetscReal[], BodyMeasures[]);
PETSC_EXTERN PetscErrorCode BodyComputeEnergies(PetscInt, const Body[], PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyGetOwnKinetic(PetscInt, const Body[], const BodyMeasures[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodySumStartEnergies(PetscInt, const Body[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetLevelEnergy(Body, PetscInt, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetInverted(Body, PetscReal, PetscInt *, PetscReal[3]);
PETSC_EXTERN PetscErrorCode BodyHasHistory(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyHasHourglasses(Body, PetscBool *);
