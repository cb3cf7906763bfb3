/*
   Rows near contact. Callers who know which rows may have a force say so, and a step costs what these cost, not what all contact nodes do:
   of a sheet that falls these are all of its nodes, though a corner touches. Output traces of other rows are old.
*/
#include <body/layout/bodyimpl.h>

PetscErrorCode BodyDestroyNearRows(Body body)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&body->rows.near_matrix));
  PetscCall(VecDestroy(&body->rows.near_row));
  PetscCall(PetscFree(body->rows.near));
  body->rows.n_near = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of this rank in `near`, of the matrix */
static PetscErrorCode CreateMatrix(Body body)
{
  BodyRows *rows = &body->rows;
  MPI_Comm  comm = PetscObjectComm((PetscObject)rows->matrix);
  PetscInt *numbers, begin, end;
  IS        some, all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(rows->n_near, &numbers));
  for (PetscInt k = 0; k < rows->n_near; k++) numbers[k] = rows->begin + rows->near[k];
  PetscCall(ISCreateGeneral(comm, rows->n_near, numbers, PETSC_OWN_POINTER, &some));
  PetscCall(MatGetOwnershipRangeColumn(rows->matrix, &begin, &end));
  PetscCall(ISCreateStride(comm, end - begin, begin, 1, &all));
  PetscCall(MatCreateSubMatrix(rows->matrix, some, all, MAT_INITIAL_MATRIX, &rows->near_matrix));
  PetscCall(MatCreateVecs(rows->near_matrix, NULL, &rows->near_row));
  PetscCall(ISDestroy(&all));
  PetscCall(ISDestroy(&some));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetNearRows - tells which rows may have a force, until rows get new entries or the next call; a step looks at no others

  Collective

  Input Parameters:
+ body - the `Body`, set up, with the state of its start of a controller step; none of its rows is prescribed or a Robin row
. n    - number of these rows on this rank; negative, on all ranks: all rows are
- near - their numbers, ascending

  Level: developer

  Note:
  Other rows have no force. Their output traces stay as they are, until `BodyWriteStartTraces()` makes those at the start of the step anew.

.seealso: `Body`, `BodyWriteStartTraces()`, `BodyUpdateInterface()`
@*/
PetscErrorCode BodySetNearRows(Body body, PetscInt n, const PetscInt near[])
{
  BodyRows       *rows = &body->rows;
  const PetscBool all = (PetscBool)(n < 0), other = (PetscBool)(!all || rows->some_near || rows->n_near != rows->local);

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(MatDestroy(&rows->near_matrix));
  PetscCall(VecDestroy(&rows->near_row));
  rows->n_near    = all ? rows->local : n;
  rows->some_near = (PetscBool)!all;
  if (!rows->near) PetscCall(PetscMalloc1(rows->local, &rows->near));
  for (PetscInt k = 0; k < rows->n_near && other; k++) rows->near[k] = all ? k : near[k];
  if (!all) {
    PetscCall(CreateMatrix(body));
    PetscCall(BodyClearRepeat(body));
  } else {
    PetscCall(PetscObjectReference((PetscObject)rows->matrix));
    PetscCall(PetscObjectReference((PetscObject)body->work.rows[0]));
    rows->near_matrix = rows->matrix;
    rows->near_row    = body->work.rows[0];
  }
  if (other) PetscCall(BodyListContactDofs(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* values = B vec, of near rows */
PetscErrorCode BodyMultiplyNearRows(Body body, Vec vec, PetscScalar values[])
{
  const BodyRows    *rows = &body->rows;
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(rows->near_matrix, vec, rows->near_row));
  PetscCall(VecGetArrayRead(rows->near_row, &row));
  for (PetscInt k = 0; k < rows->n_near; k++) values[rows->near[k]] = row[k];
  PetscCall(VecRestoreArrayRead(rows->near_row, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether near rows of all ranks have numbers that are all zero, as far as one rank knows */
PetscBool BodyNearRowsAreZero(Body body, const PetscScalar values[])
{
  const BodyRows *rows = &body->rows;
  PetscBool       zero = (PetscBool)(rows->size == 1);

  for (PetscInt k = 0; k < rows->n_near && zero; k++) zero = (PetscBool)(values[rows->near[k]] == 0);
  return zero;
}

/* f += B^T values, of near rows */
PetscErrorCode BodyAddNearRows(Body body, const PetscScalar values[], Vec f)
{
  const BodyRows *rows = &body->rows;
  PetscScalar    *row;

  PetscFunctionBegin;
  if (BodyNearRowsAreZero(body, values)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(rows->near_row, &row));
  for (PetscInt k = 0; k < rows->n_near; k++) row[k] = values[rows->near[k]];
  PetscCall(VecRestoreArrayWrite(rows->near_row, &row));
  PetscCall(MatMultTransposeAdd(rows->near_matrix, rows->near_row, f, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}
