/* Energy that contact gains and loses. Private to src/contact/energy. */
#pragma once
#include <contact/parts.h>

PETSC_INTERN PetscErrorCode ContactBeginAttempts(Contact);
PETSC_INTERN PetscErrorCode ContactMakeAttempt(Contact);
PETSC_INTERN PetscErrorCode ContactComputeWork(Contact);
PETSC_INTERN PetscErrorCode ContactComputeEnergies(Contact, PetscReal[], PetscReal[]);
PETSC_INTERN void           ContactFindGroups(Contact);
PETSC_INTERN void           ContactLeaveOutStatic(Contact);
PETSC_INTERN PetscReal      ContactMoreRoom(Contact);
PETSC_INTERN PetscErrorCode ContactCanAffordHalves(Contact, PetscBool *);
