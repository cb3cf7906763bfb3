/* The rows of the interface as the massless layer of an explicit body sees them: on the dofs of the layer. Each rank knows which dofs these
   are. Where one of several ranks has all of the body, no rank needs another to have its rows get entries in other places. */
#include "explicitimpl.h"

struct _n_LayerRows {
  Mat        matrix;
  IS         dofs;     /* of the layer, those of all ranks, ascending */
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
  PetscCall(PetscFree(*rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix for as many rows as the body has now; of a whole body with entries anywhere. Collective. */
static PetscErrorCode CreateMatrix(LayerRows rows, Body body)
{
  PetscInt n, *columns;

  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(rows->dofs, &n));
  PetscCall(MatDestroy(&rows->matrix));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), &rows->matrix));
  PetscCall(MatSetSizes(rows->matrix, body->rows.local, body->layer.n_dofs, body->rows.global, n));
  PetscCall(MatSetType(rows->matrix, MATAIJ));
  PetscCall(MatSetUp(rows->matrix));
  PetscCall(MatSetOption(rows->matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  rows->laid_out = body->rows.laid_out;
  if (!body->mesh.whole) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(n, &columns));
  for (PetscInt k = 0; k < n; k++) columns[k] = k;
  PetscCall(BodyWholeRowsTellColumns(rows->matrix, body->mesh.is_owner, n, columns));
  PetscCall(PetscFree(columns));
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
  const PetscInt *dofs;
  PetscInt        n_dofs;

  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(rows->dofs, &n_dofs));
  PetscCall(ISGetIndices(rows->dofs, &dofs));
  for (PetscInt row = body->rows.begin; row < body->rows.begin + body->rows.local; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(body->rows.free_matrix, row, &n, &columns, &values));
    for (PetscInt k = 0; k < n; k++) {
      PetscInt column;

      PetscCall(PetscFindInt(columns[k], n_dofs, dofs, &column));
      if (column >= 0) PetscCall(MatSetValue(rows->matrix, row, column, values[k], INSERT_VALUES));
    }
    PetscCall(MatRestoreRow(body->rows.free_matrix, row, &n, &columns, &values));
  }
  PetscCall(ISRestoreIndices(rows->dofs, &dofs));
  PetscCall(MatAssemblyBegin(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(rows->matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As the rows of the body are now. Of a whole body each rank does what its own rows need, and all do where there are other rows. */
PetscErrorCode LayerRowsUpdate(LayerRows rows, Body body)
{
  const PetscBool whole = body->mesh.whole, others = (PetscBool)(!rows->matrix || rows->laid_out != body->rows.laid_out);
  const PetscBool anew = (PetscBool)(others || !body->rows.same_pattern);

  PetscFunctionBegin;
  if (others || (anew && !whole)) PetscCall(CreateMatrix(rows, body));
  if (anew && whole) PetscCall(MakeRoom(rows, body));
  PetscCall(Fill(rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After BodySetUpLayerElements() */
PetscErrorCode LayerRowsCreate(Body body, LayerRows *rows)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(rows));
  PetscCall(ISAllGather(body->layer.global, &(*rows)->dofs));
  PetscCall(LayerRowsUpdate(*rows, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
