/* The state of a transfer, for checkpoints: its rows, and what the next update and TransferFollow() start from. */
#include "interfaceimpl.h"
#include "transfervisit.h"

/* The rows. Which nodes of the partner they name follows from their shares. */
static PetscErrorCode VisitRows(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt n = transfer->n, dim = transfer->dim;
  RowSet        *rows     = &transfer->rows;
  PetscInt       n_shares = rows->offsets[n];

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "shares", 1, &n_shares));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(RowSetDestroy(rows));
    PetscCall(RowSetAllocate(dim, n, n_shares, rows));
  }
  PetscCall(CheckpointVisitInts(checkpoint, "offsets", n + 1, rows->offsets));
  PetscCall(CheckpointVisitBytes(checkpoint, "share", (size_t)n_shares * sizeof(*rows->shares), rows->shares));
  PetscCall(CheckpointVisitBools(checkpoint, "opposite", n, rows->opposite));
  PetscCall(CheckpointVisitBools(checkpoint, "beyond", n, rows->beyond));
  PetscCall(CheckpointVisitBools(checkpoint, "changed", n, rows->changed));
  PetscCall(CheckpointVisitReals(checkpoint, "gap", n, rows->gap));
  PetscCall(CheckpointVisitReals(checkpoint, "area", n, rows->area));
  PetscCall(CheckpointVisitReals(checkpoint, "normals", dim * n, rows->normals));
  PetscCall(CheckpointVisitReals(checkpoint, "partner", 3 * n, rows->partner));
  PetscCall(CheckpointVisitReals(checkpoint, "bow", n, rows->bow));
  PetscCall(CheckpointVisitReals(checkpoint, "rest", n, rows->rest));
  if (!CheckpointLoads(checkpoint) || !transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RowSetConnectColumns(transfer->comm, transfer->neumann->data.n_owned, n, rows));
  PetscCall(TransferAllocateColumns(transfer));
  PetscCall(TransferGetColumns(transfer, transfer->neumann->data.reference, transfer->column_reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitFollow(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt n = transfer->n, partners = transfer->neumann->data.n_owned;
  Follow        *follow = &transfer->follow;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitReals(checkpoint, "x", 3 * n, follow->x[0]));
  PetscCall(CheckpointVisitReals(checkpoint, "partner_x", 3 * partners, follow->x[1]));
  PetscCall(CheckpointVisitReals(checkpoint, "moved", 3 * n, follow->moved));
  PetscCall(CheckpointVisitReals(checkpoint, "partner_moved", 3 * partners, follow->partner_moved));
  PetscCall(CheckpointVisitReals(checkpoint, "expected slip", 3 * n, follow->slip));
  PetscCall(CheckpointVisitBools(checkpoint, "known", n, follow->known));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitBalance(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt n       = transfer->n;
  Balance       *balance = &transfer->balance;

  PetscFunctionBegin;
  if (!balance->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "uneven", balance->n * n, balance->uneven));
  PetscCall(CheckpointVisitReals(checkpoint, "lever", balance->n * n, balance->lever));
  PetscCall(CheckpointVisitReals(checkpoint, "across", 3 * n, balance->across));
  PetscCall(CheckpointVisitReals(checkpoint, "present gap", n, balance->gap));
  PetscCall(CheckpointVisitReals(checkpoint, "turned", n, balance->turned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one rank alone knows of a transfer, to all ranks */
static PetscErrorCode TellRanks(Transfer transfer)
{
  Follow *follow = &transfer->follow;
  struct {
    PetscReal      near, size, step, scale;
    PetscBool      sleeps, has_last;
    TransferCounts counts;
  } told = {transfer->built_near, transfer->smallest_size, follow->step,    follow->scale,
            transfer->sleeps,     follow->has_last,        transfer->counts};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&told, sizeof(told), MPI_BYTE, transfer->owner, PetscObjectComm((PetscObject)transfer)));
  transfer->built_near    = told.near;
  transfer->smallest_size = told.size;
  transfer->sleeps        = told.sleeps;
  transfer->counts        = told.counts;
  follow->step            = told.step;
  follow->scale           = told.scale;
  follow->has_last        = told.has_last;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TransferVisitShared - what all ranks have of the state of a transfer, to or from a checkpoint */
PetscErrorCode TransferVisitShared(Transfer transfer, Checkpoint checkpoint)
{
  Follow  *follow  = &transfer->follow;
  Balance *balance = &transfer->balance;

  PetscFunctionBegin;
  if (transfer->owner >= 0 && !CheckpointLoads(checkpoint)) PetscCall(TellRanks(transfer));
  PetscCall(CheckpointVisitReals(checkpoint, "built_near", 1, &transfer->built_near));
  PetscCall(CheckpointVisitBools(checkpoint, "sleeps", 1, &transfer->sleeps));
  PetscCall(CheckpointVisitReals(checkpoint, "smallest_size", 1, &transfer->smallest_size));
  PetscCall(CheckpointVisitBytes(checkpoint, "counts", sizeof(transfer->counts), &transfer->counts));
  PetscCall(CheckpointVisitBools(checkpoint, "has_last", 1, &follow->has_last));
  PetscCall(CheckpointVisitReals(checkpoint, "step", 1, &follow->step));
  PetscCall(CheckpointVisitReals(checkpoint, "scale", 1, &follow->scale));
  PetscCall(CheckpointCheckInts(checkpoint, "turns of gaps", 1, &balance->n));
  PetscCall(CheckpointVisitReals(checkpoint, "turn", 3, balance->turn));
  PetscCall(CheckpointVisitReals(checkpoint, "axes", 6, balance->axes[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  TransferVisit - what a rank has of the state of a transfer, to or from a checkpoint

  Collective

  Input Parameters:
+ transfer   - the `Transfer`, updated once at least
- checkpoint - the `Checkpoint`
*/
PetscErrorCode TransferVisit(Transfer transfer, Checkpoint checkpoint)
{
  const PetscInt sizes[2] = {transfer->n, transfer->neumann ? transfer->neumann->data.n_owned : -1}, n = sizes[0];

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, "contact surfaces"));
  PetscCall(CheckpointCheckInts(checkpoint, "contact nodes", 2, sizes));
  PetscCall(VisitRows(transfer, checkpoint));
  PetscCall(CheckpointVisitReals(checkpoint, "built_x", 3 * n, transfer->built_x[0]));
  PetscCall(CheckpointVisitReals(checkpoint, "built_slip", 3 * n, transfer->built_slip));
  PetscCall(CheckpointVisitReals(checkpoint, "slip", n, transfer->slip));
  PetscCall(CheckpointVisitBools(checkpoint, "keep", n, transfer->keep));
  PetscCall(CheckpointVisitBools(checkpoint, "followed", n, transfer->followed));
  PetscCall(CheckpointVisitBools(checkpoint, "goes_on", n, transfer->goes_on));
  PetscCall(VisitBalance(transfer, checkpoint));
  if (CheckpointLoads(checkpoint)) transfer->saved.builds = 0; /* what has been put aside is of other rows */
  if (!transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "partner_built_x", 3 * sizes[1], transfer->built_x[1]));
  PetscCall(VisitFollow(transfer, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
