/*
   The rows of the interface as the massless layer of an explicit body sees them: on the dofs of the layer. Where one of several ranks has
   all of the body, each knows which dofs these are, and needs no other to have its rows get entries in other places.
*/
#include "explicitimpl.h"

struct _n_LayerRows {
  Mat        matrix;
  IS         dofs;     /* of the layer, numbers in the vectors of the body */
  PetscInt   n;        /* of a body that one of several ranks has: how many, */
  PetscInt  *list;     /* and all of them, ascending; else NULL */
  PetscInt  *column;   /* per entry of the rows of the body: its column, or -1 where the layer does not have it */
  PetscInt64 laid_out; /* what the rows of the body counted when the matrix was made */
};

Mat LayerRowsGetMatrix(LayerRows rows)
{
  return rows->matrix;
}

PetscErrorCode LayerRowsDestroy(LayerRows *rows)
{
  PetscFunctionBegin;
  if (!*rows) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*rows)->matrix));
  PetscCall(ISDestroy(&(*rows)->dofs));
  PetscCall(PetscFree((*rows)->list));
  PetscCall(PetscFree((*rows)->column));
  PetscCall(PetscFree(*rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for a column of each entry of the rows of the body */
static PetscErrorCode MakeRoom(LayerRows rows, const RowPattern *pattern)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rows->column));
  PetscCall(PetscMalloc1(pattern->offsets[pattern->n], &rows->column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the entries of the rows of the body that are in the layer: a copy of the rows has ones there, and else zeros */
static PetscErrorCode MarkEntries(LayerRows rows, Body body)
{
  const RowPattern *pattern = &body->rows.pattern;
  PetscScalar      *in;
  Vec               mask;
  Mat               marks;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &mask));
  PetscCall(VecZeroEntries(mask));
  PetscCall(VecGetArray(mask, &in));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) in[body->layer.dofs[i]] = 1;
  PetscCall(VecRestoreArray(mask, &in));
  PetscCall(MatDuplicate(body->rows.free_matrix, MAT_DO_NOT_COPY_VALUES, &marks));
  for (PetscInt i = 0; i < pattern->n; i++) {
    const PetscInt row = body->rows.begin + i;

    for (PetscInt k = pattern->offsets[i]; k < pattern->offsets[i + 1]; k++)
      PetscCall(MatSetValue(marks, row, pattern->columns[k], 1, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(marks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(marks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatDiagonalScale(marks, NULL, mask));
  for (PetscInt i = 0; i < pattern->n; i++) {
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(marks, body->rows.begin + i, &n, NULL, &values));
    for (PetscInt k = 0; k < n; k++) rows->column[pattern->offsets[i] + k] = PetscRealPart(values[k]) != 0 ? 0 : -1;
    PetscCall(MatRestoreRow(marks, body->rows.begin + i, &n, NULL, &values));
  }
  PetscCall(MatDestroy(&marks));
  PetscCall(VecDestroy(&mask));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of marked entries, in the order of those of the matrix: the dofs of the layer are in the order of those of the body */
static PetscErrorCode NumberEntries(LayerRows rows, Body body)
{
  const RowPattern *pattern = &body->rows.pattern;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < pattern->n; i++) {
    const PetscInt *columns;
    PetscInt        n, next = 0;

    PetscCall(MatGetRow(rows->matrix, body->rows.begin + i, &n, &columns, NULL));
    for (PetscInt k = pattern->offsets[i]; k < pattern->offsets[i + 1]; k++)
      if (rows->column[k] >= 0) rows->column[k] = columns[next++];
    PetscCall(MatRestoreRow(rows->matrix, body->rows.begin + i, &n, &columns, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A part of the matrix of the body; collective */
static PetscErrorCode Extract(LayerRows rows, Body body)
{
  IS own;

  PetscFunctionBegin;
  PetscCall(MatDestroy(&rows->matrix));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, body->rows.begin, 1, &own));
  PetscCall(MatCreateSubMatrix(body->rows.free_matrix, own, rows->dofs, MAT_INITIAL_MATRIX, &rows->matrix));
  PetscCall(MatSetOption(rows->matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscCall(MatSetOption(rows->matrix, MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE)); /* assembled again, it needs no word of other ranks */
  PetscCall(ISDestroy(&own));
  PetscCall(MakeRoom(rows, &body->rows.pattern));
  PetscCall(MarkEntries(rows, body));
  PetscCall(NumberEntries(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix for as many rows as the body has now, with entries anywhere. Collective. */
static PetscErrorCode CreateWhole(LayerRows rows, Body body)
{
  PetscInt *columns;

  PetscFunctionBegin;
  PetscCall(MatDestroy(&rows->matrix));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), &rows->matrix));
  PetscCall(MatSetSizes(rows->matrix, body->rows.local, body->layer.n_dofs, body->rows.global, rows->n));
  PetscCall(MatSetType(rows->matrix, MATAIJ));
  PetscCall(MatSetUp(rows->matrix));
  PetscCall(MatSetOption(rows->matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscCall(PetscMalloc1(rows->n, &columns));
  for (PetscInt k = 0; k < rows->n; k++) columns[k] = k;
  PetscCall(BodyWholeRowsTellColumns(rows->matrix, body->mesh.is_owner, rows->n, columns));
  PetscCall(PetscFree(columns));
  rows->laid_out = body->rows.laid_out;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the entries that the layer has of the rows of this rank */
static PetscErrorCode MakeEntries(LayerRows rows, Body body)
{
  const RowPattern *pattern = &body->rows.pattern;
  PetscInt         *counts;

  PetscFunctionBegin;
  PetscCall(MakeRoom(rows, pattern));
  PetscCall(PetscCalloc1(pattern->n, &counts));
  for (PetscInt i = 0; i < pattern->n; i++)
    for (PetscInt k = pattern->offsets[i]; k < pattern->offsets[i + 1]; k++) {
      PetscCall(PetscFindInt(pattern->columns[k], rows->n, rows->list, &rows->column[k]));
      if (rows->column[k] < 0) rows->column[k] = -1;
      else counts[i]++;
    }
  PetscCall(BodyWholeRowsRenew(rows->matrix, body->mesh.is_owner, counts));
  PetscCall(PetscFree(counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Fill(LayerRows rows, Body body)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < body->rows.local; i++) {
    const PetscInt    *column = rows->column + body->rows.pattern.offsets[i], row = body->rows.begin + i;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(body->rows.free_matrix, row, &n, NULL, &values));
    for (PetscInt k = 0; k < n; k++)
      if (column[k] >= 0) PetscCall(MatSetValue(rows->matrix, row, column[k], values[k], INSERT_VALUES));
    PetscCall(MatRestoreRow(body->rows.free_matrix, row, &n, NULL, &values));
  }
  PetscCall(MatAssemblyBegin(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As the rows of the body are now. Of a whole body each rank does what its own rows need, and all do where there are other rows. */
PetscErrorCode LayerRowsUpdate(LayerRows rows, Body body)
{
  const PetscBool others = (PetscBool)(!rows->matrix || rows->laid_out != body->rows.laid_out);

  PetscFunctionBegin;
  if (!rows->list) {
    if (body->rows.same_pattern) PetscCall(Fill(rows, body));
    else PetscCall(Extract(rows, body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (others) PetscCall(CreateWhole(rows, body));
  if (others || !body->rows.same_pattern) PetscCall(MakeEntries(rows, body));
  PetscCall(Fill(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dofs: those of the layer that this rank has, numbers in the vectors of the body, ascending */
PetscErrorCode LayerRowsCreate(Body body, IS dofs, LayerRows *created)
{
  MPI_Comm        comm = PetscObjectComm((PetscObject)body);
  const PetscInt *own;
  LayerRows       rows;

  PetscFunctionBegin;
  PetscCall(PetscNew(created));
  rows = *created;
  PetscCall(PetscObjectReference((PetscObject)dofs));
  rows->dofs = dofs;
  if (!body->mesh.whole) {
    PetscCall(Extract(rows, body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  rows->n = body->layer.n_dofs;
  PetscCallMPI(MPI_Bcast(&rows->n, 1, MPIU_INT, body->mesh.owner, comm));
  PetscCall(PetscMalloc1(rows->n + 1, &rows->list));
  PetscCall(ISGetIndices(dofs, &own));
  if (body->mesh.is_owner) PetscCall(PetscArraycpy(rows->list, own, rows->n));
  PetscCall(ISRestoreIndices(dofs, &own));
  PetscCallMPI(MPI_Bcast(rows->list, (PetscMPIInt)rows->n, MPIU_INT, body->mesh.owner, comm));
  PetscCall(LayerRowsUpdate(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
