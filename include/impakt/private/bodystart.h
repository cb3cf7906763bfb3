/* The balance of the massless layer in the first state, and loads. */
#pragma once
#include <impakt/body.h>

#define BODY_SUDDEN_LENGTH 512 /* of the text of BodyDescribeSuddenLoad() */

PETSC_EXTERN PetscErrorCode BodyIsOutOfBalance(Body, PetscBool *);
PETSC_EXTERN PetscErrorCode BodySumRows(Body, PetscBool, PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyBalanceLayer(Body, PetscBool, PetscScalar[], PetscReal *);
PETSC_EXTERN PetscErrorCode BodyMultiplyLayerCompliance(Body, Vec, Vec);
PETSC_EXTERN PetscErrorCode BodyStartUnderForces(Body, const PetscScalar[]);
PETSC_EXTERN PetscErrorCode BodyDescribeSuddenLoad(Body, char[BODY_SUDDEN_LENGTH]);
PETSC_EXTERN PetscErrorCode BodyHasForces(Body, PetscBool *);
