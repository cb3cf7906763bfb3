/* What the files about floating bodies share. Private to src/contact/interface. */
#pragma once
#include <contact/parts.h>

/* Moves of the springs that are remembered: with as many as there are springs a linear problem is solved, but for round-off */
#define SPRINGS_HISTORY 12

PETSC_INTERN PetscErrorCode SpringsMove(Contact, PetscBool);
