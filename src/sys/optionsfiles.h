/* Options files, looked at apart from PETSc: whether it can read them, and in which line an option stands. Private to sys. */
#pragma once
#include <petscsys.h>
#include <sys/stat.h>

PETSC_INTERN PetscBool      OptionsIsUnclosed(const char[]);
PETSC_INTERN PetscErrorCode OptionsFileCheck(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsFilesInclude(const struct stat *, PetscBool *);
PETSC_INTERN PetscErrorCode OptionsFindOrigin(const char[], char[], size_t);
