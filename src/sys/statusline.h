/* The line on the terminal that tells how far a run is. Private to Impakt. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode StatusLineBegin(PetscBool);
PETSC_INTERN PetscBool      StatusLineHasTerminal(void);
PETSC_INTERN void           StatusLineTell(const char[], ...) PETSC_ATTRIBUTE_FORMAT(1, 2);
PETSC_INTERN void           StatusLineSetSteps(PetscInt, PetscInt);
PETSC_INTERN void           StatusLineBreak(void);
PETSC_INTERN void           StatusLineEnd(void);
