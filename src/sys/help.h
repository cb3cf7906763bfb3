/* What the program says about itself. For main.c alone. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode ImpaktHelp(int, char **, PetscBool *);
PETSC_INTERN PetscErrorCode ImpaktPrintUsage(FILE *);
