/* What those ask of contact who make its controller steps: set-up, steps that may fail, what a step has done to energy. */
#pragma once
#include <impakt/contact.h>

PETSC_EXTERN PetscErrorCode ContactGetUnresolvedEnergy(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactSetStartEnergies(Contact, const PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetEnergyLoss(Contact, PetscReal *);
PETSC_EXTERN PetscErrorCode ContactGetResolvedStep(Contact, PetscReal *, size_t, char[]);
PETSC_EXTERN PetscErrorCode ContactGetShare(Contact, PetscInt *, PetscInt *);
PETSC_EXTERN PetscErrorCode ContactTakeStart(Contact, PetscBool);
PETSC_EXTERN PetscErrorCode ContactStep(Contact);
PETSC_EXTERN PetscErrorCode ContactTryStep(Contact, PetscBool, PetscReal, StepConvergedReason *);
PETSC_EXTERN PetscErrorCode ContactRaiseFailure(Contact, PetscInt, PetscInt);
PETSC_EXTERN PetscErrorCode ContactStepBack(Contact);
PETSC_EXTERN PetscErrorCode ContactSetStepLevel(Contact, PetscInt);
PETSC_EXTERN PetscErrorCode ContactSetUpSurfaces(Contact);
PETSC_EXTERN PetscErrorCode ContactSetUp(Contact);
PETSC_EXTERN PetscErrorCode ContactAccept(Contact);
PETSC_EXTERN PetscErrorCode ContactGetPairTraits(Contact, PetscInt, PetscBool *, PetscInt *, PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetBodyTraces(Contact, PetscReal[], PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetOverlapName(Contact, const ContactOverlap *, const char *[]);
PETSC_EXTERN PetscErrorCode ContactGetObstacles(Contact, PetscInt *, const Obstacle *[]);
PETSC_EXTERN PetscErrorCode ContactGetFields(Contact, PetscInt, PetscReal[]);
PETSC_EXTERN PetscErrorCode ContactGetOverlaps(Contact, ContactOverlap[]);
