/* Putting unit inputs into a body at rest. Private to src/body. */
#pragma once
#include <body/layout/bodyimpl.h>

typedef enum { INPUT_DISPLACEMENT, INPUT_VELOCITY, INPUT_ACCELERATION, INPUT_FORCE } InputKind;

PETSC_INTERN PetscErrorCode BodyBeginProbe(Body);
PETSC_INTERN PetscErrorCode BodySetUnitInput(Body, PetscInt, InputKind);
PETSC_INTERN PetscErrorCode BodyEndProbe(Body);
