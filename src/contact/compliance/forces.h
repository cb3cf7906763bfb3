/* What the methods whose unknowns are the contact forces share: all bodies under given forces. Private to src/contact/impls. */
#pragma once
#include <impakt/private/contactimpl.h>

typedef struct {
  Trace        trace;      /* forces over the controller step, of the rows of this rank: its start and its end [N] */
  PetscBool   *held;       /* rows whose gap rate matters in this step */
  PetscBool   *feels;      /* bodies whose displacements answer to the forces at the end of the step */
  PetscBool    integrated; /* all bodies have been, in this step */
  PetscScalar *change;     /* work space: of the force on a body [N] */
} Forces;

PETSC_INTERN PetscErrorCode ForcesCreate(Contact, Forces *);
PETSC_INTERN PetscErrorCode ForcesDestroy(Forces *);
PETSC_INTERN PetscErrorCode ForcesIntegrate(Contact, Forces *, const PetscScalar[], PetscReal);
PETSC_INTERN PetscErrorCode ForcesCheckDense(Contact, const char[]);
PETSC_INTERN PetscErrorCode ForcesComputeCompliance(Contact, PetscScalar[]);
PETSC_INTERN PetscErrorCode ForcesCheckBodies(Contact, const char[]);
PETSC_INTERN PetscErrorCode ForcesBeginStep(Contact, Forces *, PetscBool *);
PETSC_INTERN PetscErrorCode ForcesHold(Contact, Forces *, const PetscScalar[], PetscBool *);
PETSC_INTERN PetscErrorCode ForcesGetTime(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ForcesGetStep(Contact, PetscReal *);
