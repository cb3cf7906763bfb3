/* The state of a body, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/body.h>

PETSC_INTERN PetscErrorCode BodyVisit(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitMesh(Body, Checkpoint);
