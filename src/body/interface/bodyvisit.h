/* The state of a body, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>
#include <impakt/body.h>

PETSC_INTERN PetscErrorCode BodyVisit(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitMesh(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyVisitShared(Body, Checkpoint);
PETSC_INTERN PetscErrorCode BodyPack(Body, Tables);
PETSC_INTERN PetscErrorCode BodyUnpack(Body, Tables);
PETSC_INTERN PetscErrorCode BodyPackHistory(Body, Tables);
PETSC_INTERN PetscErrorCode BodyUnpackHistory(Body, Tables);
PETSC_INTERN PetscErrorCode BodyTakeState(Body, Tables, PetscBool *);
PETSC_INTERN PetscErrorCode BodyTakeHistory(Body, Tables);
PETSC_INTERN PetscErrorCode BodyNotePlasticBefore(Body);
PETSC_INTERN PetscErrorCode BodyTakeRows(Body);
PETSC_INTERN PetscErrorCode BodyRepeatsBits(Body, PetscBool *);
