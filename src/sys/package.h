/* The packages of all classes. Private to src. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode ImpaktRegisterClass(const char[], PetscClassId *, PetscErrorCode (*)(void), PetscErrorCode (*)(void));
