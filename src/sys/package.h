/* What the packages of all classes end their registration with. Private to src. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode ImpaktFinishPackage(const char[], PetscClassId, PetscErrorCode (*)(void));
