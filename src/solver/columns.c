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

/* rhs = B^T e for n rows, with what stays zero left out, on the rank that has A; the others need nothing */
static PetscErrorCode CreateSparseUnits(ConstrainedSolver s, PetscInt n, const PetscInt rows[], PetscBool here, Mat *rhs)
{
  Mat taken, units;
  IS  is;

  PetscFunctionBegin;
  *rhs = NULL;
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)s->B), here ? n : 0, rows, PETSC_USE_POINTER, &is));
  PetscCall(MatCreateSubMatrix(s->B, is, NULL, MAT_INITIAL_MATRIX, &taken));
  PetscCall(ISDestroy(&is));
  units = taken;
  if (s->size > 1) PetscCall(MatGetDiagonalBlock(taken, &units)); /* all columns are this rank's, or none */
  if (here) PetscCall(MatCreateTranspose(units, rhs));
  PetscCall(MatDestroy(&taken));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} B^T e for n rows. MUMPS of one rank is told where right-hand sides have their entries, and leaves out what stays zero, which
   takes a third of the time; that of several ranks would want them all on the first one. */
static PetscErrorCode SolveBlock(ConstrainedSolver s, PetscInt n, const PetscInt rows[], Mat x)
{
  const PetscBool sparse = (PetscBool)(s->size == 1 || s->home);
  PetscBool       here;
  PetscInt        mine;
  Mat             factors, rhs;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(s->rhs, &mine));
  here = (PetscBool)(!s->home || mine > 0);
  if (sparse) PetscCall(CreateSparseUnits(s, n, rows, here, &rhs));
  else {
    PetscCall(MatDuplicate(x, MAT_DO_NOT_COPY_VALUES, &rhs));
    PetscCall(FillUnits(s, n, rows, rhs));
  }
  if (s->home) PetscCall(MatDenseGetLocalMatrix(x, &x));
  if (here) {
    PetscCall(PCFactorGetMatrix(s->factors, &factors));
    PetscCall(MatMumpsSetIcntl(factors, 27, (PetscInt)MAX_BLOCK));
    PetscCall(MatMatSolve(factors, rhs, x));
  }
  PetscCall(MatDestroy(&rhs));
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

/* Makes rows known to the compliance, at its first level; `rows`: of any rank, the same on every rank, none of them known. Collective. */
PetscErrorCode ConstrainedSolverExtend(ConstrainedSolver s, PetscInt n, const PetscInt rows[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k += s->block) {
    const PetscInt width = PetscMin(s->block, n - k);

    if (width == 1) PetscCall(ExtendByOne(s, rows[k]));
    else PetscCall(ExtendByBlock(s, width, rows + k));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
