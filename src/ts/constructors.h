/* Constructors of time integrators that TSSecondOrderRegisterAll() registers, and what they share. Private to src/ts. */
#pragma once
#include <petscts.h>

PETSC_INTERN PetscErrorCode TSCreate_CentralDifference(TS);
PETSC_INTERN PetscErrorCode TSCreate_Rigid(TS);
PETSC_INTERN PetscErrorCode TSSecondOrderKeepNoStart(TS);
PETSC_INTERN PetscErrorCode TSSecondOrderCheckSolution(TS);
