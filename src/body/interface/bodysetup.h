/* The steps by which a body comes into being, whether its parts are made by options or by a program. Private to src/body. */
#pragma once
#include <body/layout/cells.h>

PETSC_INTERN PetscErrorCode BodySetUpMesh(Body);
PETSC_INTERN PetscErrorCode BodySetUpIntegrator(Body);
PETSC_INTERN PetscErrorCode BodySetUpMassType(Body);
PETSC_INTERN PetscErrorCode BodyNoteHeld(Body);
PETSC_INTERN PetscErrorCode BodyAsksForRigid(Body, PetscBool *);
PETSC_INTERN PetscErrorCode BodyReadRigid(Body, const char[], PetscBool *);
PETSC_INTERN PetscErrorCode BodyReadPoints(Body);
PETSC_INTERN PetscErrorCode BodyReadRanks(Body);
PETSC_INTERN PetscErrorCode BodyViewRanks(Body, PetscViewer);
