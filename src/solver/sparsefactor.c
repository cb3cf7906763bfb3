#include "sparsefactor.h"

/* Of a pivot, where the diagonal is one */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)
/* Entries of the factor for each of the matrix, at first: a guess that costs memory if it is too large and a copy if it is too small */
#define FILL 3

/* 1 / sqrt(diagonal), and the matrix scaled by it on both sides; `singular`: an entry of the diagonal is not positive */
static PetscErrorCode Scale(SparseFactor *f, Mat A, PetscBool *singular)
{
  PetscScalar *scale;

  PetscFunctionBegin;
  *singular = PETSC_FALSE;
  PetscCall(MatGetDiagonal(A, f->scale));
  PetscCall(VecGetArray(f->scale, &scale));
  for (PetscInt i = 0; i < f->n; i++) {
    if (PetscRealPart(scale[i]) <= 0) *singular = PETSC_TRUE;
    else scale[i] = 1 / PetscSqrtScalar(scale[i]);
  }
  PetscCall(VecRestoreArray(f->scale, &scale));
  if (!*singular) PetscCall(MatDiagonalScale(A, f->scale, f->scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors a matrix of type MATSEQAIJ, which is scaled in place; `singular`: it has no factors */
PetscErrorCode SparseFactorCompute(SparseFactor *f, Mat A, PetscBool *singular)
{
  IS             rows, columns;
  MatFactorInfo  info;
  MatFactorError error;

  PetscFunctionBegin;
  PetscCall(SparseFactorDestroy(f));
  PetscCall(MatGetSize(A, &f->n, NULL));
  PetscCall(MatCreateVecs(A, &f->scale, &f->x));
  PetscCall(Scale(f, A, singular));
  if (*singular) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatFactorInfoInitialize(&info));
  info.fill      = FILL;
  info.zeropivot = ROUND_OFF;
  PetscCall(MatGetOrdering(A, MATORDERINGND, &rows, &columns));
  PetscCall(MatGetFactor(A, MATSOLVERPETSC, MAT_FACTOR_CHOLESKY, &f->factor));
  PetscCall(MatCholeskyFactorSymbolic(f->factor, A, rows, &info));
  PetscCall(MatCholeskyFactorNumeric(f->factor, A, &info));
  PetscCall(MatFactorGetError(f->factor, &error));
  PetscCall(ISDestroy(&rows));
  PetscCall(ISDestroy(&columns));
  *singular   = (PetscBool)(error != MAT_FACTOR_NOERROR);
  f->factored = (PetscBool) !*singular;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} x */
PetscErrorCode SparseFactorSolve(const SparseFactor *f, PetscScalar x[])
{
  Vec b;

  PetscFunctionBegin;
  PetscCheck(f->factored, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "Call SparseFactorCompute() first");
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, f->n, x, &b));
  PetscCall(VecPointwiseMult(b, b, f->scale));
  PetscCall(MatSolve(f->factor, b, f->x));
  PetscCall(VecPointwiseMult(b, f->x, f->scale));
  PetscCall(VecDestroy(&b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SparseFactorDestroy(SparseFactor *f)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&f->factor));
  PetscCall(VecDestroy(&f->scale));
  PetscCall(VecDestroy(&f->x));
  f->n        = 0;
  f->factored = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Operations that factoring a matrix of order n with so many entries takes, were it that of a mesh in the plane: nested dissection leaves
   n log n entries, as many of them in each column */
PetscLogDouble SparseFactorFlops(PetscInt n, PetscLogDouble entries)
{
  const PetscLogDouble filled = n > 1 ? 0.5 * entries * PetscLog2Real((PetscReal)n) : entries;

  return n ? filled * filled / n : 0;
}
