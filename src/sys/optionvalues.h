/* Values of options that are missing, or are not what they should be. Private to sys and main.c. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode OptionsCheckValues(void);
PETSC_INTERN PetscErrorCode OptionsDescribeMissing(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsExplain(const char[], PetscErrorCode, const char[], char[], size_t, PetscBool *);
