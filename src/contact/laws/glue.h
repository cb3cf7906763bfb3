/* Laws of glue that pairs have: those of the registry of laws that have a stiffness, with the parameters that users give. */
#pragma once
#include "rowlaw.h"
#include <contact/parts.h>

struct _n_ContactGlue {
  char      name[64];
  RowLaw    law;
  PetscReal parameters[ROW_LAW_PARAMETERS]; /* of pairs that have none of their own; less than 0: not set */
};

PETSC_INTERN PetscErrorCode ContactFindGlue(Contact, const char[], PetscInt *);
PETSC_INTERN void           ContactGetGlueParameters(Contact, PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode ContactCheckGlue(Contact);
