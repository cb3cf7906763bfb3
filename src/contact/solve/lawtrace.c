/* The size of a matrix near S, where S is products alone: that of S, in the mean.

   Source: M. F. Hutchinson, A stochastic estimator of the trace of the influence matrix for Laplacian smoothing splines, Communications in
   Statistics - Simulation and Computation 19 (1990). */
#include "lawimpl.h"

/* Gives a matrix near S the trace of S, for weights of laws: by x x^T S with random signs x (Hutchinson 1990), the same on all ranks. */
PetscErrorCode LawProblemMatchTrace(Mat S, Mat near)
{
  PetscScalar *signs, ours, its;
  PetscInt     n;
  Vec          x, y;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(near, &x, &y));
  PetscCall(VecSetRandom(x, NULL)); /* from 0 to 1, the same each time */
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArray(x, &signs));
  for (PetscInt i = 0; i < n; i++) signs[i] = PetscRealPart(signs[i]) < 0.5 ? -1 : 1;
  PetscCall(VecRestoreArray(x, &signs));
  PetscCall(MatMult(near, x, y));
  PetscCall(VecDot(x, y, &ours));
  PetscCall(MatMult(S, x, y));
  PetscCall(VecDot(x, y, &its));
  if (PetscRealPart(its) > 0 && PetscRealPart(ours) > 0) PetscCall(MatScale(near, its / ours));
  PetscCall(PetscInfo(S, "a matrix near S for %" PetscInt_FMT " rows, made %g times as large\n", n, (double)PetscRealPart(its / ours)));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
