/* A unit force on a row of a body at rest. Private to src/body/rows. */
#pragma once
#include <body/layout/bodyimpl.h>

PETSC_INTERN PetscErrorCode BodyBeginProbe(Body);
PETSC_INTERN PetscErrorCode BodySetUnitForce(Body, PetscInt);
PETSC_INTERN PetscErrorCode BodyEndProbe(Body);
