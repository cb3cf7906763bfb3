/* Many right-hand sides at once. A solution reads all factors of A, which are larger than any cache: together each costs a fraction. */
#include "constrainedsolverimpl.h"

/* Factors of MUMPS on all ranks, or NULL */
PetscErrorCode ConstrainedSolverGetMUMPS(ConstrainedSolver s, Mat *factors)
{
  PetscFunctionBegin;
  *factors = NULL;
  if (s->mumps) PetscCall(PCFactorGetMatrix(s->factors, factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} b for the columns of dense matrices, without constraints: together where MUMPS has factors on all ranks */
PetscErrorCode ConstrainedSolverSolveFreeColumns(ConstrainedSolver s, Mat b, Mat x)
{
  PetscInt n;
  Mat      factors;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverGetMUMPS(s, &factors));
  if (factors) {
    PetscCall(MatMatSolve(factors, b, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatGetSize(b, NULL, &n));
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, PETSC_FALSE)); /* ConstrainedSolverTakeFailure() tells */
  for (PetscInt k = 0; k < n; k++) {
    Vec of_b, of_x;

    PetscCall(MatDenseGetColumnVecRead(b, k, &of_b));
    PetscCall(MatDenseGetColumnVecWrite(x, k, &of_x));
    PetscCall(ConstrainedSolverSolveFree(s, of_b, of_x));
    PetscCall(MatDenseRestoreColumnVecWrite(x, k, &of_x));
    PetscCall(MatDenseRestoreColumnVecRead(b, k, &of_b));
  }
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, s->constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}
