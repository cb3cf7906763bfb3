/* The state of a body, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>
#include <impakt/body.h>

PETSC_INTERN PetscErrorCode BodyVisit(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitMesh(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitShared(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitTables(Body, Tables);
PETSC_INTERN PetscErrorCode BodyVisitHistory(Body, Tables);
PETSC_INTERN PetscErrorCode BodyTakeState(Body, Tables, PetscBool *);
PETSC_INTERN PetscErrorCode BodyTakeHistory(Body, Tables);
PETSC_INTERN PetscErrorCode BodyNotePlasticBefore(Body);
PETSC_INTERN PetscErrorCode BodyTakeRows(Body);
PETSC_INTERN PetscErrorCode BodyRepeatsBits(Body, PetscBool *);
