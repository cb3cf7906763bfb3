/* Many right-hand sides at once. A solution reads all factors of A, which are larger than any cache: together each costs a fraction. */
#include "constrainedsolverimpl.h"

/* Right-hand sides that are solved for together, and numbers that they may have in all: 200 MB */
#define MAX_BLOCK         256
#define MAX_BLOCK_NUMBERS 25000000

/* How many right-hand sides are solved for together: those of MUMPS; PETSc's own factors solve for one after the other, whatever they are
   asked for */
PetscErrorCode ConstrainedSolverChooseBlock(ConstrainedSolver s)
{
  PetscInt      size;
  PetscBool     mumps = PETSC_FALSE;
  MatSolverType package;

  PetscFunctionBegin;
  s->block = 1;
  if (!s->factors || s->global <= FEW_ROWS) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PCFactorGetMatSolverType(s->factors, &package));
  PetscCall(PetscStrcmp(package, MATSOLVERMUMPS, &mumps));
  if (!mumps) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetSize(s->rhs, &size));
  s->block = PetscMax(1, PetscMin(MAX_BLOCK, MAX_BLOCK_NUMBERS / size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} b for the columns of dense matrices, without constraints: together where MUMPS has factors on all ranks */
PetscErrorCode ConstrainedSolverSolveFreeColumns(ConstrainedSolver s, Mat b, Mat x)
{
  PetscInt n;
  Mat      factors;

  PetscFunctionBegin;
  if (s->block > 1 && !s->home) {
    PetscCall(PCFactorGetMatrix(s->factors, &factors));
    PetscCall(MatMumpsSetIcntl(factors, 27, (PetscInt)MAX_BLOCK));
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
