/* Puts the rows of a transfer aside at the start of a step, and brings them back where the step is made again. */
#include "interfaceimpl.h"

/* What a transfer remembers of its rows, and of the nodes of the partner that this rank owns */
void TransferListState(Transfer transfer, StateList lists[2])
{
  RowSet        *rows    = &transfer->rows;
  Follow        *follow  = &transfer->follow;
  Balance       *balance = &transfer->balance;
  const PetscInt follows = transfer->neumann ? 1 : 0, turns = balance->n, turned = turns ? 1 : 0;

  lists[0] = (StateList){.n      = transfer->n,
                         .arrays = {{1, .bools = rows->opposite},
                                    {1, .bools = rows->beyond},
                                    {1, .bools = rows->changed},
                                    {1, rows->gap},
                                    {1, rows->area},
                                    {transfer->dim, rows->normals},
                                    {3, rows->partner},
                                    {1, rows->bow},
                                    {1, rows->rest},
                                    {3, transfer->built_x[0]},
                                    {3, transfer->built_slip},
                                    {1, transfer->slip},
                                    {1, .bools = transfer->keep},
                                    {1, .bools = transfer->followed},
                                    {1, .bools = transfer->goes_on},
                                    {3 * follows, follow->x[0]},
                                    {3 * follows, follow->moved},
                                    {3 * follows, follow->slip},
                                    {follows, .bools = follow->known},
                                    {turns, balance->uneven},
                                    {turns, balance->lever},
                                    {3 * turned, balance->across},
                                    {turned, balance->gap},
                                    {turned, balance->turned}}};
  lists[1] = (StateList){.n      = follows ? transfer->neumann->data.n_owned : 0,
                         .arrays = {{3, transfer->built_x[1]}, {3, follow->x[1]}, {3, follow->partner_moved}}};
}

/* The shares. Those of rows of another build need room of another size. */
static PetscErrorCode CopyShares(Transfer transfer, const RowSet *from, PetscBool other, RowSet *to)
{
  const PetscInt n_shares = from->offsets[transfer->n];

  PetscFunctionBegin;
  if (other) {
    PetscCall(RowSetDestroy(to));
    PetscCall(RowSetAllocate(transfer->dim, transfer->n, n_shares, to));
    PetscCall(PetscArraycpy(to->offsets, from->offsets, transfer->n + 1));
    if (n_shares) PetscCall(PetscArraycpy(to->columns, from->columns, n_shares));
    to->n_columns = from->n_columns;
    to->vectors   = from->vectors;
    if (to->vectors) PetscCall(PetscObjectReference((PetscObject)to->vectors));
  }
  PetscCall(PetscArraycpy(to->shares, from->shares, n_shares));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the rows aside, and what the next update and TransferFollow() start from. Allocates only after a new build. */
PetscErrorCode TransferSave(Transfer transfer)
{
  TransferSaved  *saved = &transfer->saved;
  const PetscBool other = (PetscBool)(saved->builds != transfer->builds);
  StateList       lists[2];

  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  if (!other && !transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS); /* builds alone change what obstacles remember */
  PetscCall(CopyShares(transfer, &transfer->rows, other, &saved->rows));
  TransferListState(transfer, lists);
  for (PetscInt side = 0; side < 2; side++) {
    if (!saved->state[side]) PetscCall(StateListAllocate(&lists[side], &saved->state[side]));
    PetscCall(StateListCopy(&lists[side], PETSC_FALSE, saved->state[side]));
  }
  saved->builds  = transfer->builds;
  saved->numbers = transfer->numbers;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes back to the last TransferSave(), any number of times, with rows and surfaces as they were. Counts of builds go on. */
PetscErrorCode TransferRestore(Transfer transfer)
{
  TransferSaved  *saved = &transfer->saved;
  const PetscBool other = (PetscBool)(saved->builds != transfer->builds);
  StateList       lists[2];

  PetscFunctionBegin;
  PetscCheck(saved->state[0], transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferSave() first");
  PetscCall(CopyShares(transfer, &saved->rows, other, &transfer->rows));
  if (other) PetscCall(TransferSetUpColumns(transfer, &transfer->rows, PETSC_FALSE));
  TransferListState(transfer, lists);
  for (PetscInt side = 0; side < 2; side++) PetscCall(StateListCopy(&lists[side], PETSC_TRUE, saved->state[side]));
  transfer->numbers = saved->numbers;
  saved->builds     = transfer->builds;
  PetscFunctionReturn(PETSC_SUCCESS);
}
