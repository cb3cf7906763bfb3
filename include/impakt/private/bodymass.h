/* The mass of contact nodes: whether they have any, what ties need of it, and how rows answer to impulses. */
#pragma once
#include <impakt/body.h>

PETSC_EXTERN PetscErrorCode BodyChooseMass(Body, PetscInt, const PetscInt[], PetscBool *);
PETSC_EXTERN PetscBool      BodyChoosesMass(Body);
PETSC_EXTERN PetscErrorCode BodyKeepMass(Body);
PETSC_EXTERN PetscErrorCode BodyMassIsChosen(Body, PetscBool *, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyGetContactPart(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetInertiaChange(Body, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyGetForceOnMass(Body, const PetscReal[], PetscReal *, PetscReal *);
PETSC_EXTERN PetscErrorCode BodyIntegratesLike(Body, Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyRequestsControllerStep(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySetTiedMass(Body, PetscBool);
PETSC_EXTERN PetscErrorCode BodyPrescribesMass(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodyComputeInverseMass(Body, PetscBool, Mat *);
PETSC_EXTERN PetscErrorCode BodyBoundInverseMass(Body, PetscReal[]);
PETSC_EXTERN PetscErrorCode BodyMultiplyInverseMass(Body, const PetscScalar[], PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyGetMassRedistributeNear(Body, PetscBool *);
