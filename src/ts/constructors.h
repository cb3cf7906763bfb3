/* Constructors of time integrators that TSSecondOrderRegisterAll() registers. Private to src/ts. */
#pragma once
#include <petscts.h>

PETSC_INTERN PetscErrorCode TSCreate_CentralDifference(TS);
PETSC_INTERN PetscErrorCode TSCreate_Rigid(TS);
