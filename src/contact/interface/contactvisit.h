/* The state of contact and of its bodies, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>
#include <impakt/contact.h>

PETSC_INTERN PetscBool      ContactHasVisit(Contact);
PETSC_INTERN PetscErrorCode ContactRepeatsBits(Contact, PetscBool *);
PETSC_INTERN PetscErrorCode ContactVisit(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode ContactVisitShared(Contact, Checkpoint);
PETSC_INTERN PetscErrorCode ContactVisitTables(Contact, Tables);
