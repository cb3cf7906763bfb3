/* What the methods whose unknowns are the contact forces share: all bodies under given forces. Private to src/contact/impls. */
#pragma once
#include "../contactimpl.h"

PETSC_INTERN PetscErrorCode ForcesIntegrate(Contact, Trace, const PetscScalar[], PetscReal);
PETSC_INTERN PetscErrorCode ForcesComputeCompliance(Contact, PetscScalar[]);
PETSC_INTERN PetscErrorCode ForcesCheckBodies(Contact, const char[]);
PETSC_INTERN PetscErrorCode ForcesBeginStep(Contact, PetscBool[], PetscBool *);
PETSC_INTERN PetscErrorCode ForcesHold(Contact, const PetscScalar[], PetscBool[], PetscBool *);
PETSC_INTERN PetscErrorCode ForcesGetTime(Contact, PetscReal *);
PETSC_INTERN PetscErrorCode ForcesGetStep(Contact, PetscReal *);
