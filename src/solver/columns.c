/*
   Columns of W, of rows that become known. One solution reads all factors of A, which are larger than any cache: as many right-hand sides
   as there are rows to be known are solved for together, and each costs a fraction.
*/
#include "constrainedsolverimpl.h"

/* Right-hand sides that are solved for together, and numbers that they may have in all: 200 MB */
#define MAX_BLOCK         256
#define MAX_BLOCK_NUMBERS 25000000
/* Time of an operation in a solution for one right-hand side, by that of one in a solution for a block of them. Measured on one rank: 8 in
   a cube of 7000 unknowns, 20 in one of 27000 and in one of 9e4; right-hand sides of several ranks are dense, and gain two thirds of that.
 */
#define BLOCK_GAIN 12

/* Makes a row known by a solution of its own */
static PetscErrorCode ExtendByOne(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (s->keeps) {
    s->fresh[j] = (PetscBool)(s->fresh[j] && ComplianceKnows(s->compliance, j)); /* its owner may have forgotten it */
    PetscCall(ConstrainedSolverMakeColumn(s, j));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ConstrainedSolverApplyUnit(s, j, s->product, s->column));
  PetscCall(ComplianceSetColumn(s->compliance, j, 1, s->column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

/* Operations that it takes to make `n` rows known, in operations of solutions for one right-hand side each, which take longer than those
   of blocks; counted, so that a run repeats */
PetscLogDouble ConstrainedSolverGetExtendFlops(ConstrainedSolver s, PetscInt n)
{
  return n * s->solve_flops / PetscMax(1, PetscMin(PetscMin(s->block, n), BLOCK_GAIN));
}

/* rhs = B^T e for n rows */
static PetscErrorCode FillUnits(ConstrainedSolver s, PetscInt n, const PetscInt rows[], Mat rhs)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries;

    if (rows[k] < s->begin || rows[k] >= s->begin + s->local) continue;
    PetscCall(MatGetRow(s->B, rows[k], &entries, &columns, &values));
    PetscCall(MatSetValues(rhs, entries, columns, 1, &k, values, INSERT_VALUES));
    PetscCall(MatRestoreRow(s->B, rows[k], &entries, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(rhs, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(rhs, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} B^T e for n rows, of factors that several ranks have together: MUMPS would want sparse right-hand sides all on the first one
 */
static PetscErrorCode SolveBlock(ConstrainedSolver s, PetscInt n, const PetscInt rows[], Mat x)
{
  Mat factors, rhs;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(x, MAT_DO_NOT_COPY_VALUES, &rhs));
  PetscCall(FillUnits(s, n, rows, rhs));
  PetscCall(PCFactorGetMatrix(s->factors, &factors));
  PetscCall(MatMumpsSetIcntl(factors, 27, (PetscInt)MAX_BLOCK));
  PetscCall(MatMatSolve(factors, rhs, x));
  PetscCall(MatDestroy(&rhs));
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
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, s->shares));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode KeepColumn(ConstrainedSolver s, PetscInt j, Vec column)
{
  PetscFunctionBegin;
  if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
  PetscCall(VecCopy(column, s->columns[j]));
  s->fresh[j] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes n rows known by solutions that are found together */
static PetscErrorCode ExtendByBlock(ConstrainedSolver s, PetscInt n, const PetscInt rows[])
{
  PetscInt local, size;
  Mat      x;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(s->rhs, &local));
  PetscCall(VecGetSize(s->rhs, &size));
  PetscCall(MatCreateDense(PetscObjectComm((PetscObject)s->ksp), local, PETSC_DECIDE, size, n, NULL, &x));
  PetscCall(SolveBlock(s, n, rows, x));
  for (PetscInt k = 0; k < n; k++) {
    const PetscScalar *w;
    Vec                column;

    PetscCall(MatDenseGetColumnVecRead(x, k, &column));
    PetscCall(MatMult(s->B, column, s->row));
    if (s->keeps) PetscCall(KeepColumn(s, rows[k], column));
    PetscCall(MatDenseRestoreColumnVecRead(x, k, &column));
    PetscCall(VecGetArrayRead(s->row, &w));
    PetscCall(ComplianceSetColumn(s->compliance, rows[k], 1, w));
    PetscCall(VecRestoreArrayRead(s->row, &w));
  }
  PetscCall(MatDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of B that any ranks have, on the rank that has A: `part`, of which the columns are all this rank's; others take part, and have none
 */
static PetscErrorCode TakeRows(ConstrainedSolver s, IS rows, Mat *taken, Mat *part)
{
  PetscFunctionBegin;
  PetscCall(MatCreateSubMatrix(s->B, rows, NULL, MAT_INITIAL_MATRIX, taken));
  *part = *taken;
  if (s->size > 1) PetscCall(MatGetDiagonalBlock(*taken, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} C^T for n rows C of B from number k on among those that have been taken, on the rank that has A. MUMPS is told where
   right-hand sides have their entries, and leaves out what stays zero, which takes a third of the time. */
static PetscErrorCode SolveHere(ConstrainedSolver s, Mat taken, PetscInt k, PetscInt n, Mat *x)
{
  PetscInt size;
  IS       is;
  Mat      factors, rows, rhs;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(taken, NULL, &size));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, n, k, 1, &is));
  PetscCall(MatCreateSubMatrix(taken, is, NULL, MAT_INITIAL_MATRIX, &rows));
  PetscCall(ISDestroy(&is));
  PetscCall(MatCreateTranspose(rows, &rhs));
  PetscCall(MatDestroy(&rows));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, size, n, NULL, x));
  PetscCall(PCFactorGetMatrix(s->factors, &factors));
  PetscCall(MatMumpsSetIcntl(factors, 27, (PetscInt)MAX_BLOCK));
  PetscCall(MatMatSolve(factors, rhs, *x));
  PetscCall(MatDestroy(&rhs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A column of A^{-1} B^T from the rank that has A, and `w`, that of W on all rows of B; both NULL on others */
static PetscErrorCode TakeColumn(ConstrainedSolver s, PetscInt j, const PetscScalar column[], const PetscScalar w[])
{
  PetscScalar *kept;
  PetscInt     size;

  PetscFunctionBegin;
  if (s->keeps) {
    if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
    PetscCall(VecGetLocalSize(s->rhs, &size));
    PetscCall(VecGetArrayWrite(s->columns[j], &kept));
    if (column) PetscCall(PetscArraycpy(kept, column, size));
    PetscCall(VecRestoreArrayWrite(s->columns[j], &kept));
    s->fresh[j] = PETSC_TRUE;
  }
  PetscCall(ComplianceSetWholeColumn(s->compliance, j, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether one rank makes so many rows known */
static PetscBool IsHere(ConstrainedSolver s, PetscInt n)
{
  return (PetscBool)(n > 1 && s->block > 1 && (s->size == 1 || s->home));
}

/* Brings rows that are to become known, and all that answer, to the rank that has A: then no other is asked for anything when they do. For
   all bodies before ConstrainedSolverExtend() is called for the first of them, so that ranks that have others solve at the same time.
   Collective. */
PetscErrorCode ConstrainedSolverBringRows(ConstrainedSolver s, PetscInt n, const PetscInt rows[])
{
  MPI_Comm comm = PetscObjectComm((PetscObject)s->B);
  PetscInt mine;
  IS       some, all;

  PetscFunctionBegin;
  if (!IsHere(s, n)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ConstrainedSolverDropTaken(s));
  PetscCall(VecGetLocalSize(s->rhs, &mine));
  PetscCall(ISCreateGeneral(comm, mine ? n : 0, rows, PETSC_COPY_VALUES, &some));
  PetscCall(ISCreateStride(comm, mine ? s->global : 0, 0, 1, &all));
  PetscCall(TakeRows(s, some, &s->taken[0], &s->part[0]));
  PetscCall(TakeRows(s, all, &s->taken[1], &s->part[1]));
  PetscCall(ISDestroy(&some));
  PetscCall(ISDestroy(&all));
  s->n_taken = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverDropTaken(ConstrainedSolver s)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) PetscCall(MatDestroy(&s->taken[k]));
  s->n_taken = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes rows known by the solutions of the rank that has A. It tells the others nothing: columns that wait are theirs when they are added
   up. */
static PetscErrorCode ExtendHere(ConstrainedSolver s, PetscInt n, const PetscInt rows[])
{
  PetscInt  mine;
  PetscBool here;
  Mat       x = NULL;
  Vec       w = NULL;

  PetscFunctionBegin;
  if (s->n_taken != n) PetscCall(ConstrainedSolverBringRows(s, n, rows));
  PetscCall(VecGetLocalSize(s->rhs, &mine));
  here = (PetscBool)(mine > 0);
  if (here) PetscCall(MatCreateVecs(s->part[1], NULL, &w));
  for (PetscInt k = 0; k < n; k += s->block) {
    const PetscInt width = PetscMin(s->block, n - k);

    if (here) PetscCall(SolveHere(s, s->part[0], k, width, &x));
    for (PetscInt i = 0; i < width; i++) {
      const PetscScalar *column = NULL, *displacement = NULL;
      Vec                vec;

      if (here) {
        PetscCall(MatDenseGetColumnVecRead(x, i, &vec));
        PetscCall(MatMult(s->part[1], vec, w));
        PetscCall(VecGetArrayRead(vec, &column));
        PetscCall(VecGetArrayRead(w, &displacement));
      }
      PetscCall(TakeColumn(s, rows[k + i], column, displacement));
      if (here) {
        PetscCall(VecRestoreArrayRead(w, &displacement));
        PetscCall(VecRestoreArrayRead(vec, &column));
        PetscCall(MatDenseRestoreColumnVecRead(x, i, &vec));
      }
    }
    PetscCall(MatDestroy(&x));
  }
  PetscCall(VecDestroy(&w));
  PetscCall(ConstrainedSolverDropTaken(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes rows known to the compliance, at its first level; `rows`: of any rank, the same on every rank, none of them known. Collective. */
PetscErrorCode ConstrainedSolverExtend(ConstrainedSolver s, PetscInt n, const PetscInt rows[])
{
  PetscFunctionBegin;
  if (IsHere(s, n)) {
    PetscCall(ExtendHere(s, n, rows));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt k = 0; k < n; k += s->block) {
    const PetscInt width = PetscMin(s->block, n - k);

    if (width == 1) PetscCall(ExtendByOne(s, rows[k]));
    else PetscCall(ExtendByBlock(s, width, rows + k));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
