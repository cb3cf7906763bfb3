/* What the methods whose unknowns are the contact forces share: all bodies under given forces. Private to src/contact/impls. */
#pragma once
#include <contact/parts.h>

typedef struct {
  Trace      trace;    /* forces over the controller step, of the rows of this rank: its start and its end [N] */
  PetscBool *touching; /* rows whose gap rate counts in this step */
} Forces;

PETSC_INTERN PetscErrorCode ForcesCreate(Contact, Forces *);
PETSC_INTERN PetscErrorCode ForcesDestroy(Forces *);
PETSC_INTERN PetscErrorCode ForcesIntegrate(Contact, Forces *, const PetscScalar[], PetscReal);
PETSC_INTERN PetscErrorCode ForcesCheckDense(Contact, const char[]);
PETSC_INTERN PetscErrorCode ForcesCheckBodies(Contact, const char[]);
PETSC_INTERN PetscErrorCode ForcesBeginStep(Contact, Forces *, PetscBool *);
PETSC_INTERN PetscErrorCode ForcesTouch(Contact, Forces *, const PetscScalar[], PetscBool *);
PETSC_INTERN PetscErrorCode ForcesGetTime(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ForcesGetStep(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ForcesVisit(Contact, Forces *, Checkpoint);
