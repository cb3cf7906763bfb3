/* The state of a transfer, for checkpoints. Private to Impakt. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/transfer.h>

PETSC_INTERN PetscErrorCode TransferVisit(Transfer, Checkpoint);
