/* Lists of names: in the options, of any length, and in registries. Private to src. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode NamesRead(const char[], const char[], PetscInt *, char ***, PetscBool *);
PETSC_INTERN PetscErrorCode NamesDestroy(PetscInt, char ***);
PETSC_INTERN PetscErrorCode NamesOfRegistry(PetscFunctionList, size_t, char[]);
PETSC_INTERN PetscErrorCode NamesAppend(char[], size_t, const char[], const char[]);
