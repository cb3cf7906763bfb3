/* Values of options that are missing, or are not what they should be. Private to the library and main.c. */
#pragma once
#include "optiontable.h"

PETSC_INTERN PetscErrorCode OptionsCheckValues(void);
PETSC_INTERN PetscErrorCode OptionsFindKnown(const char[], const KnownOption **);
PETSC_INTERN PetscErrorCode OptionsDescribeMissing(const char[], char[], size_t);
PETSC_INTERN PetscErrorCode OptionsReadSwitch(MPI_Comm, const char[], const char[], const char[], PetscBool *);
PETSC_INTERN PetscErrorCode OptionsExplain(const char[], PetscErrorCode, const char[], char[], size_t, PetscBool *);
