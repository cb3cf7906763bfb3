/* The state of a transfer, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>
#include <impakt/private/transfer.h>

PETSC_INTERN PetscErrorCode TransferVisit(Transfer, Checkpoint);
PETSC_INTERN PetscErrorCode TransferVisitShared(Transfer, Checkpoint);
PETSC_INTERN PetscErrorCode TransferVisitTables(Transfer, Tables);
