/* The steps by which a body comes into being, whether its parts are made by options or by a program. Private to src/body. */
#pragma once
#include <impakt/body.h>

PETSC_INTERN PetscErrorCode BodySetUpCells(Body);
PETSC_INTERN PetscErrorCode BodySetUpMesh(Body);
PETSC_INTERN PetscErrorCode BodySetTimeFromOptions(Body);
PETSC_INTERN PetscErrorCode BodySetUpIntegrator(Body);
PETSC_INTERN PetscErrorCode BodySetUpMassType(Body);
PETSC_INTERN PetscErrorCode BodyNoteHeld(Body);
