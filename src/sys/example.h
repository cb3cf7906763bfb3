/* Options files to start from. For main.c alone. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode ImpaktExample(int, char **, PetscBool *);
