/* The rows of the interface as the massless layer of an explicit body sees them: on the dofs of the layer. Where one of several ranks has
   all of the body, each knows which dofs these are, and needs no other to have its rows get entries in other places. */
#include "explicitimpl.h"

struct _n_LayerRows {
  Mat        matrix;
  PetscInt   n;        /* of a body that one rank has: how many, */
  PetscInt  *list;     /* and all of them, ascending; else NULL */
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
  PetscCall(PetscFree((*rows)->list));
  PetscCall(PetscFree(*rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A part of the matrix of the body, in place where entries are where they were; collective. It takes memory of PETSc each time. */
static PetscErrorCode Extract(LayerRows rows, Body body)
{
  const MatReuse reuse = rows->matrix && body->rows.same_pattern ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX;
  IS             own;

  PetscFunctionBegin;
  if (reuse == MAT_INITIAL_MATRIX) PetscCall(MatDestroy(&rows->matrix));
  rows->laid_out = body->rows.laid_out;
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, body->rows.begin, 1, &own));
  PetscCall(MatCreateSubMatrix(body->rows.free_matrix, own, body->layer.global, reuse, &rows->matrix));
  PetscCall(ISDestroy(&own));
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

/* Room for the entries of the rows of this rank */
static PetscErrorCode MakeRoom(LayerRows rows, Body body)
{
  PetscInt *counts;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(body->rows.local, &counts));
  for (PetscInt i = 0; i < body->rows.local; i++) {
    PetscCall(MatGetRow(body->rows.free_matrix, body->rows.begin + i, &counts[i], NULL, NULL));
    PetscCall(MatRestoreRow(body->rows.free_matrix, body->rows.begin + i, NULL, NULL, NULL));
  }
  PetscCall(BodyWholeRowsRenew(rows->matrix, body->mesh.is_owner, counts));
  PetscCall(PetscFree(counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Fill(LayerRows rows, Body body)
{
  PetscFunctionBegin;
  for (PetscInt row = body->rows.begin; row < body->rows.begin + body->rows.local; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(body->rows.free_matrix, row, &n, &columns, &values));
    for (PetscInt k = 0; k < n; k++) {
      PetscInt column;

      PetscCall(PetscFindInt(columns[k], rows->n, rows->list, &column));
      if (column >= 0) PetscCall(MatSetValue(rows->matrix, row, column, values[k], INSERT_VALUES));
    }
    PetscCall(MatRestoreRow(body->rows.free_matrix, row, &n, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As the rows of the body are now. Of a whole body each rank does what its own rows need, and all do where there are other rows. */
PetscErrorCode LayerRowsUpdate(LayerRows rows, Body body)
{
  const PetscBool others = (PetscBool)(!rows->matrix || rows->laid_out != body->rows.laid_out);
  const PetscBool anew   = (PetscBool)(others || !body->rows.same_pattern);

  PetscFunctionBegin;
  if (!rows->list || (anew && !body->mesh.whole)) {
    PetscCall(Extract(rows, body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (others) PetscCall(CreateWhole(rows, body));
  if (anew) PetscCall(MakeRoom(rows, body));
  PetscCall(Fill(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After BodySetUpLayerElements() */
PetscErrorCode LayerRowsCreate(Body body, LayerRows *created)
{
  MPI_Comm        comm = PetscObjectComm((PetscObject)body);
  const PetscInt *own;
  LayerRows       rows;

  PetscFunctionBegin;
  PetscCall(PetscNew(created));
  rows = *created;
  if (body->mesh.ghosted) {
    PetscCall(Extract(rows, body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  rows->n = body->layer.n_dofs;
  PetscCallMPI(MPI_Bcast(&rows->n, 1, MPIU_INT, body->mesh.owner, comm));
  PetscCall(PetscMalloc1(rows->n + 1, &rows->list));
  PetscCall(ISGetIndices(body->layer.global, &own));
  if (body->mesh.is_owner) PetscCall(PetscArraycpy(rows->list, own, rows->n));
  PetscCall(ISRestoreIndices(body->layer.global, &own));
  PetscCallMPI(MPI_Bcast(rows->list, (PetscMPIInt)rows->n, MPIU_INT, body->mesh.owner, comm));
  PetscCall(LayerRowsUpdate(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
