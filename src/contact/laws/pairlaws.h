/* Laws with parameters that pairs have: those of the registry that users name, glue and friction, with the numbers that users give. */
#pragma once
#include "rowlaw.h"
#include <contact/parts.h>

PETSC_INTERN PetscBool ContactGlueBreaks(Contact);
PETSC_INTERN void      ContactGetLawParameters(Contact, const ContactPair *, PetscReal[]);
