/*
   Where the rows of the interface have entries. Rows that follow their surfaces have other values in the same places, so that what has been
   made of their matrix (that without held dofs, that of the massless layer) gets new values too, and nothing is allocated.
*/
#include <body/layout/bodyimpl.h>

PetscErrorCode RowPatternDestroy(RowPattern *pattern)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(pattern->offsets, pattern->columns));
  PetscCall(PetscFree(pattern->elsewhere));
  pattern->n = pattern->n_elsewhere = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of other ranks that a matrix has room for */
static PetscErrorCode GetElsewhere(Mat matrix, PetscInt *n, const PetscInt *columns[])
{
  PetscBool many;
  Mat       block;

  PetscFunctionBegin;
  *n       = 0;
  *columns = NULL;
  PetscCall(PetscObjectTypeCompare((PetscObject)matrix, MATMPIAIJ, &many));
  if (!many) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMPIAIJGetSeqAIJ(matrix, NULL, &block, columns));
  PetscCall(MatGetSize(block, NULL, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the rows of this rank have entries in the columns that were noted last, and store them in the same places */
static PetscErrorCode Compare(const RowPattern *pattern, Mat matrix, PetscBool *same)
{
  PetscInt        begin, end, n_elsewhere;
  const PetscInt *elsewhere;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(matrix, &begin, &end));
  PetscCall(GetElsewhere(matrix, &n_elsewhere, &elsewhere));
  *same = (PetscBool)(pattern->offsets && pattern->n == end - begin && pattern->n_elsewhere == n_elsewhere);
  if (*same && n_elsewhere) PetscCall(PetscArraycmp(elsewhere, pattern->elsewhere, n_elsewhere, same));
  for (PetscInt i = 0; *same && i < pattern->n; i++) {
    const PetscInt  first = pattern->offsets[i];
    const PetscInt *columns;
    PetscInt        n;

    PetscCall(MatGetRow(matrix, begin + i, &n, &columns, NULL));
    *same = (PetscBool)(n == pattern->offsets[i + 1] - first);
    if (*same && n) PetscCall(PetscArraycmp(columns, pattern->columns + first, n, same));
    PetscCall(MatRestoreRow(matrix, begin + i, &n, &columns, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes where a matrix has entries. `same`: where the last one had them; then nothing is allocated. `agree`: on every rank, collective */
PetscErrorCode RowPatternNote(RowPattern *pattern, Mat matrix, PetscBool agree, PetscBool *same)
{
  PetscInt        begin, end, count = 0;
  const PetscInt *elsewhere;
  int             differs;
  PetscMPIInt     size;

  PetscFunctionBegin;
  PetscCall(Compare(pattern, matrix, same));
  differs = *same ? 0 : 1;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)matrix), &size));
  if (agree && size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &differs, 1, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)matrix)));
  *same = (PetscBool)!differs;
  if (*same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RowPatternDestroy(pattern));
  PetscCall(MatGetOwnershipRange(matrix, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    PetscInt n;

    PetscCall(MatGetRow(matrix, row, &n, NULL, NULL));
    count += n;
    PetscCall(MatRestoreRow(matrix, row, &n, NULL, NULL));
  }
  pattern->n = end - begin;
  PetscCall(GetElsewhere(matrix, &pattern->n_elsewhere, &elsewhere));
  PetscCall(PetscMalloc1(pattern->n_elsewhere, &pattern->elsewhere));
  PetscCall(PetscArraycpy(pattern->elsewhere, elsewhere, pattern->n_elsewhere));
  PetscCall(PetscMalloc2(pattern->n + 1, &pattern->offsets, count, &pattern->columns));
  pattern->offsets[0] = 0;
  for (PetscInt i = 0; i < pattern->n; i++) {
    const PetscInt *columns;
    PetscInt        n;

    PetscCall(MatGetRow(matrix, begin + i, &n, &columns, NULL));
    if (n) PetscCall(PetscArraycpy(pattern->columns + pattern->offsets[i], columns, n));
    pattern->offsets[i + 1] = pattern->offsets[i] + n;
    PetscCall(MatRestoreRow(matrix, begin + i, &n, &columns, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
