/*
   A step that could not be made is no PETSc error as long as the controller may make it again with a smaller step. So what fails deep
   inside a step leaves its reason and its message in a StepFailure, and returns; whoever called it looks, and returns too. The message
   becomes an error when nobody is left who could make the step again.
*/
#pragma once
#include <impakt/stepreason.h>

typedef struct {
  StepConvergedReason reason;
  PetscErrorCode      code;          /* of the error that it becomes */
  char                message[1024]; /* the same */
} StepFailure;

PETSC_EXTERN void           StepFailureClear(StepFailure *);
PETSC_EXTERN void           StepFailureCopy(const StepFailure *, StepFailure *);
PETSC_EXTERN PetscErrorCode StepFailureSet(StepFailure *, StepConvergedReason, PetscErrorCode, const char[], ...)
    PETSC_ATTRIBUTE_FORMAT(4, 5);
PETSC_EXTERN PetscErrorCode StepFailureRaise(MPI_Comm, const StepFailure *);
