/* Laws with parameters that pairs have: those of the registry that users name, glue and friction, with the numbers that users give. */
#pragma once
#include "rowlaw.h"
#include <contact/parts.h>

struct _n_ContactNamedLaw {
  char      name[64];
  RowLaw    law;
  PetscReal parameters[ROW_LAW_PARAMETERS]; /* of pairs that have none of their own; less than 0: not set */
};

PETSC_INTERN PetscBool ContactGlueBreaks(Contact);
PETSC_INTERN void      ContactGetLawParameters(Contact, const ContactPair *, PetscReal[]);
