/* Puts the rows of a transfer aside at the start of a step, and brings them back where the step is made again. */
#include "interfaceimpl.h"

/* The numbers of a set of rows, to one of the same size */
static PetscErrorCode CopyNumbers(PetscInt dim, PetscInt n, const RowSet *from, RowSet *to)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(to->opposite, from->opposite, n));
  PetscCall(PetscArraycpy(to->beyond, from->beyond, n));
  PetscCall(PetscArraycpy(to->changed, from->changed, n));
  PetscCall(PetscArraycpy(to->gap, from->gap, n));
  PetscCall(PetscArraycpy(to->area, from->area, n));
  PetscCall(PetscArraycpy(to->normals, from->normals, dim * n));
  PetscCall(PetscArraycpy(to->partner, from->partner, 3 * n));
  PetscCall(PetscArraycpy(to->rest, from->rest, n));
  PetscCall(PetscArraycpy(to->bow, from->bow, n));
  PetscCall(PetscArraycpy(to->shares, from->shares, from->offsets[n]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that have been built since they were put aside last need room of another size; of others only the numbers have changed */
static PetscErrorCode SaveRows(Transfer transfer)
{
  const RowSet  *rows  = &transfer->rows;
  TransferSaved *saved = &transfer->saved;

  PetscFunctionBegin;
  if (saved->builds != transfer->counts.builds) {
    const PetscInt n_shares = rows->offsets[transfer->n];

    PetscCall(RowSetDestroy(&saved->rows));
    PetscCall(RowSetAllocate(transfer->dim, transfer->n, n_shares, &saved->rows));
    PetscCall(PetscArraycpy(saved->rows.offsets, rows->offsets, transfer->n + 1));
    if (n_shares) PetscCall(PetscArraycpy(saved->rows.columns, rows->columns, n_shares));
    saved->rows.n_columns = rows->n_columns;
    saved->rows.vectors   = rows->vectors;
    if (rows->vectors) PetscCall(PetscObjectReference((PetscObject)rows->vectors));
    saved->builds = transfer->counts.builds;
    saved->same   = PETSC_FALSE;
  }
  if (!saved->same) PetscCall(CopyNumbers(transfer->dim, transfer->n, rows, &saved->rows));
  saved->same = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestoreRows(Transfer transfer)
{
  TransferSaved *saved = &transfer->saved;

  PetscFunctionBegin;
  if (saved->builds == transfer->counts.builds) {
    PetscCall(CopyNumbers(transfer->dim, transfer->n, &saved->rows, &transfer->rows));
    saved->same = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(RowSetDestroy(&transfer->rows));
  transfer->rows = saved->rows;
  PetscCall(PetscMemzero(&saved->rows, sizeof(saved->rows)));
  if (transfer->neumann) {
    PetscCall(TransferAllocateColumns(transfer));
    PetscCall(TransferGetColumns(transfer, transfer->neumann->data.reference, transfer->column_reference));
  }
  PetscCall(SaveRows(transfer)); /* the step may have to be made once more */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for what is noted of nodes and rows, whose numbers do not change */
static PetscErrorCode Allocate(Transfer transfer)
{
  const PetscInt n = transfer->n, partners = transfer->neumann ? transfer->neumann->data.n_owned : 0;
  TransferSaved *saved = &transfer->saved;

  PetscFunctionBegin;
  if (saved->ready) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc4(3 * n, &saved->built_x[0], 3 * partners, &saved->built_x[1], 3 * n, &saved->built_slip, n, &saved->slip));
  PetscCall(PetscMalloc4(3 * n, &saved->x[0], 3 * partners, &saved->x[1], 3 * n, &saved->follow_slip, n, &saved->known));
  if (transfer->balance.n) PetscCall(PetscMalloc2(n, &saved->turned, 3 * n, &saved->across));
  saved->ready = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyReals(PetscBool back, PetscInt n, PetscReal now[], PetscReal aside[])
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(back ? now : aside, back ? aside : now, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an update reads and changes beside the rows, to what has been put aside or back */
static PetscErrorCode CopyNotes(Transfer transfer, PetscBool back)
{
  const PetscInt n      = transfer->n;
  TransferSaved *saved  = &transfer->saved;
  Follow        *follow = &transfer->follow;

  PetscFunctionBegin;
  PetscCall(CopyReals(back, 3 * n, transfer->built_slip, saved->built_slip));
  PetscCall(CopyReals(back, n, transfer->slip, saved->slip));
  PetscCall(CopyReals(back, 1, &transfer->built_near, &saved->built_near));
  *(back ? &transfer->sleeps : &saved->sleeps) = back ? saved->sleeps : transfer->sleeps;
  PetscCall(CopyReals(back, 1, &transfer->smallest_size, &saved->smallest_size));
  PetscCall(CopyReals(back, 3 * n, transfer->built_x[0], saved->built_x[0]));
  if (!transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CopyReals(back, 3 * transfer->neumann->data.n_owned, transfer->built_x[1], saved->built_x[1]));
  PetscCall(CopyReals(back, 3 * n, follow->x[0], saved->x[0]));
  PetscCall(CopyReals(back, 3 * transfer->neumann->data.n_owned, follow->x[1], saved->x[1]));
  PetscCall(CopyReals(back, 3 * n, follow->slip, saved->follow_slip));
  PetscCall(CopyReals(back, 1, &follow->step, &saved->step));
  PetscCall(PetscArraycpy(back ? follow->known : saved->known, back ? saved->known : follow->known, n));
  *(back ? &follow->has_last : &saved->has_last) = back ? saved->has_last : follow->has_last;
  if (!transfer->balance.n) PetscFunctionReturn(PETSC_SUCCESS);
  *(back ? &transfer->balance : &saved->balance) = back ? saved->balance : transfer->balance; /* its arrays stay where they are */
  PetscCall(CopyReals(back, n, transfer->balance.turned, saved->turned));
  PetscCall(CopyReals(back, 3 * n, transfer->balance.across, saved->across));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSave - puts the rows aside as they are, and what the next update and `TransferFollow()` start from

  Collective

  Input Parameter:
. transfer - the `Transfer`, updated once at least

  Level: developer

  Note:
  Allocates only where rows have been built since the last call.

.seealso: `Transfer`, `TransferRestore()`, `TransferUpdate()`, `TransferFollow()`
@*/
PetscErrorCode TransferSave(Transfer transfer)
{
  const PetscBool same = (PetscBool)(transfer->saved.same && transfer->saved.builds == transfer->counts.builds);

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCall(Allocate(transfer));
  PetscCall(SaveRows(transfer));
  if (!same || transfer->neumann) PetscCall(CopyNotes(transfer, PETSC_FALSE)); /* before an obstacle builds alone change them */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferRestore - goes back to the last `TransferSave()`, as if rows had neither been built nor followed the surfaces since

  Collective

  Input Parameter:
. transfer - the `Transfer`

  Level: developer

  Note:
  May be called any number of times. The counts of builds go on: they count work.

.seealso: `Transfer`, `TransferSave()`
@*/
PetscErrorCode TransferRestore(Transfer transfer)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->saved.ready, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferSave() first");
  PetscCall(RestoreRows(transfer));
  PetscCall(CopyNotes(transfer, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Work space for vectors of the columns of rows that have just been built */
PetscErrorCode TransferAllocateColumns(Transfer transfer)
{
  const PetscInt n = 3 * transfer->rows.n_columns;

  PetscFunctionBegin;
  transfer->columns_present = PETSC_FALSE;
  PetscCall(PetscFree4(transfer->column_x, transfer->column_normals, transfer->column_moved, transfer->column_reference));
  PetscCall(PetscMalloc4(n, &transfer->column_x, n, &transfer->column_normals, n, &transfer->column_moved, n, &transfer->column_reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferDestroySaved(Transfer transfer)
{
  TransferSaved *saved = &transfer->saved;

  PetscFunctionBegin;
  PetscCall(RowSetDestroy(&saved->rows));
  PetscCall(PetscFree4(saved->built_x[0], saved->built_x[1], saved->built_slip, saved->slip));
  PetscCall(PetscFree4(saved->x[0], saved->x[1], saved->follow_slip, saved->known));
  PetscCall(PetscFree2(saved->turned, saved->across));
  PetscFunctionReturn(PETSC_SUCCESS);
}
