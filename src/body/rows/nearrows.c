/*
   Rows near contact. Callers who know which rows may have a force say so, and a step costs what these cost, not what all contact nodes do:
   of a sheet that falls these are all of its nodes, though a corner touches. Output traces of other rows are old.
*/
#include <body/layout/bodyimpl.h>

static PetscErrorCode DestroyList(RowList *list)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&list->matrix));
  PetscCall(VecDestroy(&list->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyNearRows(Body body)
{
  BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(DestroyList(&rows->near));
  PetscCall(PetscFree(rows->near.numbers));
  rows->near.n = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the matrix that are in a list of this rank; those of all ranks that have such a list */
static PetscErrorCode CreateMatrix(Body body, RowList *list)
{
  BodyRows *rows = &body->rows;
  MPI_Comm  comm = PetscObjectComm((PetscObject)rows->matrix);
  PetscInt *numbers, begin, end;
  IS        some, all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(list->n, &numbers));
  for (PetscInt k = 0; k < list->n; k++) numbers[k] = rows->begin + list->numbers[k];
  PetscCall(ISCreateGeneral(comm, list->n, numbers, PETSC_OWN_POINTER, &some));
  PetscCall(MatGetOwnershipRangeColumn(rows->matrix, &begin, &end));
  PetscCall(ISCreateStride(comm, end - begin, begin, 1, &all));
  PetscCall(MatCreateSubMatrix(rows->matrix, some, all, MAT_INITIAL_MATRIX, &list->matrix));
  PetscCall(MatCreateVecs(list->matrix, NULL, &list->values));
  PetscCall(ISDestroy(&all));
  PetscCall(ISDestroy(&some));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Limits the rows that may have a force, and that a step reads, until rows get new entries: ascending numbers on this rank; n < 0 on all
   ranks: all rows. Output traces of other rows stay as they are until BodyWriteStartTraces(). No row is prescribed or a Robin row.
   Collective. */
PetscErrorCode BodySetNearRows(Body body, PetscInt n, const PetscInt near[])
{
  BodyRows       *rows = &body->rows;
  const PetscBool all = (PetscBool)(n < 0), other = (PetscBool)(!all || rows->some_near || rows->near.n != rows->local);

  PetscFunctionBegin;
  PetscCall(DestroyList(&rows->near));
  rows->near.n    = all ? rows->local : n;
  rows->some_near = (PetscBool)!all;
  if (!rows->near.numbers) PetscCall(PetscMalloc1(rows->local, &rows->near.numbers));
  for (PetscInt k = 0; k < rows->near.n && other; k++) rows->near.numbers[k] = all ? k : near[k];
  if (!all) {
    PetscCall(CreateMatrix(body, &rows->near));
    PetscCall(BodyClearRepeat(body));
  } else {
    PetscCall(PetscObjectReference((PetscObject)rows->matrix));
    PetscCall(PetscObjectReference((PetscObject)body->work.rows[0]));
    rows->near.matrix = rows->matrix;
    rows->near.values = body->work.rows[0];
  }
  if (other) PetscCall(BodyListContactDofs(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* values = B vec, of near rows */
PetscErrorCode BodyMultiplyNearRows(Body body, Vec vec, PetscScalar values[])
{
  const RowList     *list = &body->rows.near;
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(list->matrix, vec, list->values));
  PetscCall(VecGetArrayRead(list->values, &row));
  for (PetscInt k = 0; k < list->n; k++) values[list->numbers[k]] = row[k];
  PetscCall(VecRestoreArrayRead(list->values, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether near rows of all ranks have forces that are all zero, as far as one rank knows */
PetscBool BodyNearRowsAreZero(Body body, const PetscScalar values[])
{
  const BodyRows *rows = &body->rows;
  PetscBool       zero = (PetscBool)(rows->size == 1);

  for (PetscInt k = 0; k < rows->near.n && zero; k++) zero = (PetscBool)(values[rows->near.numbers[k]] == 0);
  return zero;
}

/* f += B^T values, of near rows */
PetscErrorCode BodyAddNearRows(Body body, const PetscScalar values[], Vec f)
{
  const RowList *near = &body->rows.near;
  PetscScalar   *row;

  PetscFunctionBegin;
  if (BodyNearRowsAreZero(body, values)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(near->values, &row));
  for (PetscInt k = 0; k < near->n; k++) row[k] = values[near->numbers[k]];
  PetscCall(VecRestoreArrayWrite(near->values, &row));
  PetscCall(MatMultTransposeAdd(near->matrix, near->values, f, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}
