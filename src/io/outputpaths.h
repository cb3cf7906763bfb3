/* Which files the paths of outputs stand for. Private to src/io. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode OutputPathResolve(const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode OutputPathsCheck(MPI_Comm, PetscInt, const char *const[], const char *const[]);
