/* What options are looked for by: words of other programs, and what has to be chosen for an option to count. Private to sys. */
#pragma once
#include "optiontable.h"

PETSC_INTERN PetscErrorCode OptionGetRank(const KnownOption *, const char[], PetscInt *);
PETSC_INTERN PetscErrorCode OptionsSuggest(const char[], PetscInt, const char *const[], PetscBool *, char[], size_t);
PETSC_INTERN PetscErrorCode OptionsFindNeed(const char[], char[], size_t);
