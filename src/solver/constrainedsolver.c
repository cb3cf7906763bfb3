/* A x = b subject to B_m x = t for the constrained rows m, with the factors of the unconstrained A: the constraint forces s
   follow from the compliance W = B A^{-1} B^T,

     z = A^{-1} b,   W_mm s = B_m z - t,   x = z - A^{-1} B_m^T s.

   A row on a spring, rather than prescribed, gives (A + B_m^T k B_m) x = b: the same with t = 0 and the flexibility 1 / k added to its
   entry on the diagonal of W (Woodbury's formula). So a change of the constrained rows never makes A be factored again. The columns C =
   A^{-1} B^T are made once each, when their row is constrained for the first time, and W_mm comes from them. */
#include "constrainedsolverimpl.h"
#include <math.h>

/* How many columns are kept: of all rows where these are few, else so many that to add them up is half the work of a solution by factors;
   they take two thirds of the memory of Cholesky's factors then */
static PetscErrorCode ChooseColumns(ConstrainedSolver s)
{
  PetscInt size;

  PetscFunctionBegin;
  PetscCall(VecGetSize(s->rhs, &size));
  s->most = s->direct ? (PetscInt)PetscMin(s->global, 0.25 * s->solve_flops / PetscMax(size, 1)) : 0;
  if (s->global <= FEW_ROWS) s->most = s->global;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the rank that has A has all rows too */
static PetscErrorCode FindWhetherAlone(ConstrainedSolver s)
{
  const PetscInt *rows, *ranges;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRanges(s->B, &rows));
  PetscCall(VecGetOwnershipRanges(s->rhs, &ranges));
  s->alone = s->home;
  for (PetscMPIInt r = 0; r < s->size; r++)
    if (rows[r + 1] > rows[r] && ranges[r + 1] == ranges[r]) s->alone = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All that goes with the rows: none of them is constrained, and no column is there */
static PetscErrorCode CreateRows(ConstrainedSolver s, Mat B)
{
  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)B));
  s->B = B;
  PetscCall(MatCreateVecs(B, NULL, &s->row));
  PetscCall(MatGetLocalSize(B, &s->local, NULL));
  PetscCall(MatGetSize(B, &s->global, NULL));
  PetscCall(MatGetOwnershipRange(B, &s->begin, NULL));
  PetscCall(FindWhetherAlone(s));
  PetscCall(
      PetscCalloc5(s->global, &s->constrained, s->global, &s->rows, s->global, &s->columns, s->global, &s->fresh, s->global, &s->changes));
  PetscCall(PetscMalloc2(s->global, &s->force, s->global, &s->used));
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  s->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyRows(ConstrainedSolver s)
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j < s->global; j++) PetscCall(VecDestroy(&s->columns[j]));
  PetscCall(PetscFree5(s->constrained, s->rows, s->columns, s->fresh, s->changes));
  PetscCall(PetscFree2(s->force, s->used));
  PetscCall(PetscFree2(s->W, s->pivots));
  PetscCall(VecDestroy(&s->row));
  PetscCall(MatDestroy(&s->B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other rows, of another number: the factors of A stay, and what is known of the rows goes */
PetscErrorCode ConstrainedSolverReplaceRows(ConstrainedSolver s, Mat B)
{
  PetscFunctionBegin;
  PetscCall(DestroyRows(s));
  PetscCall(CreateRows(s, B));
  PetscCall(ChooseColumns(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A is the matrix of a body in `dim` dimensions; `constant`: it never changes, so that a failed solution is an error. */
PetscErrorCode ConstrainedSolverBegin(Mat A, Mat B, PetscInt dim, const char prefix[], PetscBool constant, ConstrainedSolver *solver)
{
  ConstrainedSolver s;
  MPI_Comm          comm = PetscObjectComm((PetscObject)A);
  PetscBool         direct;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  PetscCall(KSPCreate(comm, &s->ksp));
  PetscCall(KSPSetOptionsPrefix(s->ksp, prefix));
  PetscCall(KSPSetOperators(s->ksp, A, A));
  PetscCallMPI(MPI_Comm_size(comm, &s->size));
  s->constant = constant;
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, constant));
  PetscCall(ConstrainedSolverChoose(s->ksp, A, dim));
  PetscCall(KSPSetFromOptions(s->ksp));
  PetscCall(ConstrainedSolverAdjust(s->ksp));
  PetscCall(KSPSetUp(s->ksp)); /* which makes factors that several ranks have, and none of one rank's */
  PetscCall(PetscObjectTypeCompare((PetscObject)s->ksp, KSPPREONLY, &direct));
  if (direct) PetscCall(KSPGetPC(s->ksp, &s->direct));
  PetscCall(ConstrainedSolverFindFactors(s, A));
  PetscCall(MatCreateVecs(A, NULL, &s->rhs));
  PetscCall(VecDuplicate(s->rhs, &s->product));
  PetscCall(CreateRows(s, B));
  *solver = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the factors where one rank has all of A, there. Not collective: ranks factor at the same time. */
PetscErrorCode ConstrainedSolverFactor(ConstrainedSolver s)
{
  PetscInt mine;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(s->rhs, &mine));
  if (s->home && mine && s->factors) PetscCall(PCSetUp(s->factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solver can be used. Collective. */
PetscErrorCode ConstrainedSolverEnd(ConstrainedSolver s)
{
  Mat A;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverFactor(s));
  PetscCall(KSPSetUpOnBlocks(s->ksp)); /* now, not with the first solution */
  PetscCall(KSPGetOperators(s->ksp, &A, NULL));
  PetscCall(ConstrainedSolverCountFlops(s, A));
  PetscCall(ChooseColumns(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ConstrainedSolverBegin() and what has to follow */
PetscErrorCode ConstrainedSolverCreate(Mat A, Mat B, PetscInt dim, const char prefix[], PetscBool constant, ConstrainedSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(ConstrainedSolverBegin(A, B, dim, prefix, constant, solver));
  PetscCall(ConstrainedSolverEnd(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverDestroy(ConstrainedSolver *solver)
{
  ConstrainedSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DestroyRows(s));
  PetscCall(VecDestroy(&s->product));
  PetscCall(VecDestroy(&s->rhs));
  PetscCall(KSPDestroy(&s->ksp));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverGetMatrices(ConstrainedSolver s, Mat *A, Mat *B)
{
  PetscFunctionBegin;
  if (A) PetscCall(KSPGetOperators(s->ksp, A, NULL));
  if (B) *B = s->B;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where forces are in balance but for round-off, as on a body without inertia that hangs on soft springs, columns of single forces are far
   larger than their sum: that has fewer digits than a solution. An arch of blocks missed its forces by 1e-7 of them by columns. */
void ConstrainedSolverSetExact(ConstrainedSolver s)
{
  s->exact = PETSC_TRUE;
}

/* Whether A has factors, by which a solution costs little beside these */
PetscBool ConstrainedSolverIsDirect(ConstrainedSolver s)
{
  return (PetscBool)(s && s->direct);
}

/* x = A^{-1} b, without constraints. A solution that did not converge is not a number: the matrix of a nonlinear body may be indefinite
   where Newton's method has gone astray, and its step fails then. Where a column of a constant matrix is made PETSc has ended with an
   error. */
PetscErrorCode ConstrainedSolverSolveFree(ConstrainedSolver s, Vec b, Vec x)
{
  KSPConvergedReason reason;

  PetscFunctionBegin;
  if (s->direct) {
    PetscCall(PCApply(s->direct, b, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(KSPSolve(s->ksp, b, x));
  PetscCall(KSPGetConvergedReason(s->ksp, &reason));
  if (reason >= 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->failed) s->failed = reason;
  PetscCall(VecSet(x, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Why the first solution since the last call did not converge; 0 if all did. The same on every rank. */
KSPConvergedReason ConstrainedSolverTakeFailure(ConstrainedSolver s)
{
  const KSPConvergedReason failed = s->failed;

  s->failed = KSP_CONVERGED_ITERATING;
  return failed;
}

/* The rows have new entries, as many as before; `changed`: for each row of all ranks, whether it is one of them; NULL: none is, the columns
   of entries alone are others */
PetscErrorCode ConstrainedSolverSetRows(ConstrainedSolver s, Mat B, const PetscMPIInt changed[])
{
  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&s->B));
  s->B = B;
  for (PetscInt j = 0; j < s->global && changed; j++) {
    if (!changed[j]) continue;
    s->fresh[j] = PETSC_FALSE;
    s->missed   = 0; /* columns of rows that change again and again are not worth it */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* w = W f for forces f on all rows; neither may be a vector of the solver */
PetscErrorCode ConstrainedSolverApplyCompliance(ConstrainedSolver s, Vec f, Vec w)
{
  PetscFunctionBegin;
  PetscCall(MatMultTranspose(s->B, f, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->product));
  PetscCall(MatMult(s->B, s->product, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C_j = A^{-1} B^T e_j, unless it is there */
PetscErrorCode ConstrainedSolverMakeColumn(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (s->fresh[j]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
  PetscCall(ComplianceSetUnit(s->row, j));
  PetscCall(MatMultTranspose(s->B, s->row, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->columns[j]));
  s->fresh[j] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
