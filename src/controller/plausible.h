/* Whether the numbers of a body fit the set of units. Private to src/controller and src/io. */
#pragma once
#include <impakt/body.h>

#define DOUBT_SIZE 400

PETSC_INTERN PetscErrorCode BodyDoubtUnits(Body, const PetscReal[6], char[DOUBT_SIZE]);
