/* Options that belong to a name of a list which another list has taken the place of. Private to sys. */
#pragma once
#include <petscsys.h>

PETSC_INTERN PetscErrorCode OptionsFindOverridden(const char[], char[], size_t);
