/* The text in which PetscOptionsGetAll() lists all options of a run. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscBool      OptionsTextNext(char **, const char **, const char **);
PETSC_INTERN PetscErrorCode OptionsTextHas(const char[], PetscBool *);
