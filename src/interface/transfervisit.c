/* The state of a transfer, for checkpoints: its rows, and what the next update and TransferFollow() start from. */
#include "interfaceimpl.h"
#include "transfervisit.h"

/* The shares. Which nodes of the partner they name follows from them. */
static PetscErrorCode VisitShares(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt n        = transfer->n;
  RowSet        *rows     = &transfer->rows;
  PetscInt       n_shares = rows->offsets[n];

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "shares", 1, &n_shares));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(RowSetDestroy(rows));
    PetscCall(RowSetAllocate(transfer->dim, n, n_shares, rows));
  }
  PetscCall(CheckpointVisitInts(checkpoint, "offsets", n + 1, rows->offsets));
  PetscCall(CheckpointVisitBytes(checkpoint, "share", (size_t)n_shares * sizeof(*rows->shares), rows->shares));
  if (CheckpointLoads(checkpoint)) PetscCall(TransferSetUpColumns(transfer, &transfer->rows, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all ranks have of the state of a transfer, to or from a checkpoint */
PetscErrorCode TransferVisitShared(Transfer transfer, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  if (transfer->options.owned && !CheckpointLoads(checkpoint)) { /* one rank alone knows it */
    MPI_Comm comm = PetscObjectComm((PetscObject)transfer);

    PetscCallMPI(MPI_Bcast(&transfer->numbers, sizeof(transfer->numbers), MPI_BYTE, transfer->options.owner, comm));
    PetscCallMPI(MPI_Bcast(&transfer->builds, 1, MPIU_INT, transfer->options.owner, comm));
  }
  PetscCall(CheckpointVisitBytes(checkpoint, "numbers", sizeof(transfer->numbers), &transfer->numbers));
  PetscCall(CheckpointVisitInts(checkpoint, "builds", 1, &transfer->builds));
  PetscCall(CheckpointCheckInts(checkpoint, "turns of gaps", 1, &transfer->balance.n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a rank has of the state of a transfer, to or from a checkpoint */
PetscErrorCode TransferVisit(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt sizes[2] = {transfer->n, transfer->neumann ? transfer->neumann->data.n_owned : -1};
  StateList      lists[2];

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, "contact surfaces"));
  PetscCall(CheckpointCheckInts(checkpoint, "contact nodes", 2, sizes));
  PetscCall(VisitShares(transfer, checkpoint));
  TransferListState(transfer, lists);
  PetscCall(StateListVisit(&lists[0], "rows", checkpoint));
  PetscCall(StateListVisit(&lists[1], "partners", checkpoint));
  if (CheckpointLoads(checkpoint)) transfer->saved.builds = 0; /* what has been put aside is of other rows */
  PetscFunctionReturn(PETSC_SUCCESS);
}
