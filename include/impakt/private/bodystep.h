/* The set-up of a body in parts, and its controller steps: saved, made again, in halves. */
#pragma once
#include <impakt/body.h>
#include <impakt/private/stepfailure.h>

PETSC_EXTERN PetscErrorCode BodySetUpDiscretization(Body);
PETSC_EXTERN PetscErrorCode BodyExpectRows(Body);
PETSC_EXTERN PetscErrorCode BodySetUpSteps(Body);
PETSC_EXTERN PetscErrorCode BodySetControllerStep(Body, PetscReal, PetscReal);
PETSC_EXTERN PetscErrorCode BodyShareControllerStep(Body, PetscInt);
PETSC_EXTERN PetscErrorCode BodyBeginSetUp(Body);
PETSC_EXTERN PetscErrorCode BodyFactor(Body);
PETSC_EXTERN PetscErrorCode BodySetUp(Body);
PETSC_EXTERN PetscErrorCode BodyRefuseNewtonOptions(PetscInt, const Body[]);
PETSC_EXTERN PetscErrorCode BodyGetControllerStep(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyEstimateSubsteps(Body, PetscReal, PetscReal, PetscInt *);
PETSC_EXTERN PetscErrorCode BodyGetStartTime(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodySave(Body);
PETSC_EXTERN PetscErrorCode BodyRestore(Body);
PETSC_EXTERN PetscErrorCode BodyStepBack(Body);
PETSC_EXTERN PetscErrorCode BodySetStepLevel(Body, PetscInt);
PETSC_EXTERN PetscErrorCode BodyIntegrate(Body);
PETSC_EXTERN PetscErrorCode BodyMeasureSubstep(Body, PetscLogDouble *);
