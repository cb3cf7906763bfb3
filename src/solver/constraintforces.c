/* The constraint forces s: by factors of W_mm, or by conjugate gradients, which need W only as a product. */
#include "constrainedsolverimpl.h"
#include <sys/petsccompat.h>
#include <petscblaslapack.h>

/* Constraint forces up to this number by a dense matrix, whose factors take 64 MB then */
#define MAX_DENSE_CONSTRAINTS 2000

/* Columns for the dense matrix of constraint forces up to so many numbers in all, 800 MB */
#define MAX_COLUMN_NUMBERS 1e8
/* Up to so many constraints their matrix is dense: factoring it costs less than a few solutions of a body with such a surface */
#define FEW_CONSTRAINTS 256
/* of the constraint forces by conjugate gradients: contact gaps are closed to about 1e-12 of the displacements */
#define FORCE_TOLERANCE 1e-13
/* Of a pivot, in parts of the largest entry of its column */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* y = W_mm x + flexibility x; rows that are not constrained are left out */
static PetscErrorCode MultiplyConstrained(Mat shell, Vec x, Vec y)
{
  ConstrainedSolver  s;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  PetscCall(ConstrainedSolverApplyCompliance(s, x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt i = 0; i < s->local; i++) out[i] = s->mine[i] < 0 ? 0 : out[i] + s->mine[i] * in[i];
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Conjugate gradients begin from zero, so that a step that is made again ends with the same bits, whatever has been solved in between */
static PetscErrorCode CreateIterative(ConstrainedSolver s)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)s->ksp);
  Mat      shell;
  PC       pc;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(comm, s->local, s->local, s->global, s->global, s, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))MultiplyConstrained));
  PetscCall(KSPCreate(comm, &s->iterative));
  PetscCall(KSPSetOperators(s->iterative, shell, shell));
  PetscCall(KSPSetType(s->iterative, KSPCG));
  PetscCall(KSPGetPC(s->iterative, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(s->iterative, FORCE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, 500));
  PetscCall(KSPSetErrorIfNotConverged(s->iterative, s->constant));
  PetscCall(VecDuplicate(s->row, &s->force_vec));
  PetscCall(VecDuplicate(s->row, &s->gap_vec));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether there is room for a dense matrix of the constraint forces, and the columns that it takes */
static PetscErrorCode MayBeDense(ConstrainedSolver s, PetscBool *may)
{
  PetscInt size;

  PetscFunctionBegin;
  PetscCall(VecGetSize(s->rhs, &size));
  *may = (PetscBool)(s->n <= MAX_DENSE_CONSTRAINTS && (PetscReal)s->n * size <= MAX_COLUMN_NUMBERS);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B x on the constrained rows, less targets of this rank's (NULL: 0), on every rank */
static PetscErrorCode Gather(ConstrainedSolver s, Vec x, const PetscScalar target[], PetscScalar gathered[])
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->row));
  PetscCall(VecGetArrayRead(s->row, &row));
  for (PetscInt k = 0; k < s->n; k++) {
    const PetscInt local = s->rows[k] - s->begin;

    gathered[k] = local >= 0 && local < s->local ? row[local] - (target ? target[local] : 0) : 0;
  }
  PetscCall(VecRestoreArrayRead(s->row, &row));
  if (s->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, gathered, (PetscMPIInt)s->n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)s->ksp)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W_mm, symmetric to the last bit, with flexibilities on its diagonal */
static PetscErrorCode FillMatrix(ConstrainedSolver s)
{
  PetscFunctionBegin;
  if (s->n > s->room) {
    PetscCall(PetscFree2(s->W, s->pivots));
    s->room = s->n;
    PetscCall(PetscMalloc2(s->room * s->room, &s->W, s->room, &s->pivots));
  }
  for (PetscInt k = 0; k < s->n; k++) {
    PetscCall(ConstrainedSolverMakeColumn(s, s->rows[k]));
    PetscCall(Gather(s, s->columns[s->rows[k]], NULL, s->gathered));
    for (PetscInt l = 0; l <= k; l++) s->W[k * s->n + l] = s->W[l * s->n + k] = s->gathered[l];
    s->W[k * s->n + k] += s->constrained[s->rows[k]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* LU factors of W_mm. Dependent rows have a pivot of round-off, where MatLUFactor() ends the run and leaves memory behind: so by LAPACK. */
static PetscErrorCode FactorMatrix(ConstrainedSolver s, PetscBool *singular)
{
  PetscScalar *largest = s->force; /* entry of each column, without sign */
  PetscBLASInt n, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(s->n, &n));
  for (PetscInt k = 0; k < s->n; k++) {
    largest[k] = 0;
    for (PetscInt l = 0; l < s->n; l++) largest[k] = PetscMax(PetscRealPart(largest[k]), PetscAbsScalar(s->W[k * s->n + l]));
  }
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, s->W, &n, s->pivots, &info));
  *singular = (PetscBool)(info > 0);
  for (PetscInt k = 0; k < s->n; k++)
    *singular = (PetscBool)(*singular || !(PetscAbsScalar(s->W[k * s->n + k]) > ROUND_OFF * PetscRealPart(largest[k])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FactorConstraints(ConstrainedSolver s)
{
  PetscBool singular;

  PetscFunctionBegin;
  s->n = 0;
  for (PetscInt j = 0; j < s->global; j++)
    if (s->constrained[j] >= 0) s->rows[s->n++] = j;
  s->dense = PETSC_TRUE;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MayBeDense(s, &s->dense));
  if (s->n > FEW_CONSTRAINTS && !s->must_factor) s->dense = PETSC_FALSE;
  if (!s->dense) {
    if (!s->iterative) PetscCall(CreateIterative(s));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FillMatrix(s));
  PetscCall(FactorMatrix(s, &singular));
  if (s->failed) { /* columns are not numbers: the step has failed, and is not constrained any more */
    s->n = 0;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(!singular, PetscObjectComm((PetscObject)s->ksp), PETSC_ERR_MAT_LU_ZRPVT,
             "The prescribed contact rows of a body are not independent: their compliance is singular; is a node in two contact pairs?");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of this rank's rows are prescribed from now on, or on springs with those flexibilities (NULL: all prescribed). Collective. */
PetscErrorCode ConstrainedSolverSetConstraints(ConstrainedSolver s, const PetscBool constrained[], const PetscReal flexibility[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->local; i++) s->mine[i] = constrained[i] ? (flexibility ? flexibility[i] : 0) : -1;
  PetscCallMPI(MPI_Allgatherv(s->mine, (PetscMPIInt)s->local, MPIU_REAL, s->constrained, s->counts, s->offsets, MPIU_REAL,
                              PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No row of any rank is constrained. Not collective. */
PetscErrorCode ConstrainedSolverFreeRows(ConstrainedSolver s)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->local; i++) s->mine[i] = -1;
  s->dense = PETSC_TRUE;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One rank may have factored A without the others: columns of A^{-1} B^T are made again on all of them */
PetscErrorCode ConstrainedSolverForgetColumns(ConstrainedSolver s)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(s->fresh, s->global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A has new values, as that of a nonlinear body has in every Newton iteration */
PetscErrorCode ConstrainedSolverRefactor(ConstrainedSolver s)
{
  PetscFunctionBegin;
  PetscCall(KSPSetUp(s->ksp));
  PetscCall(PetscArrayzero(s->fresh, s->global));
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force_vec = W_mm^-1 gap_vec by conjugate gradients. Where these do not converge, as with elements a hundred times as long as high, and
   there is room for a dense matrix, there is one from now on, and nothing has been found. */
static PetscErrorCode Iterate(ConstrainedSolver s)
{
  KSPConvergedReason reason;
  PetscBool          may = PETSC_FALSE, raises;

  PetscFunctionBegin;
  PetscCall(MayBeDense(s, &may));
  PetscCall(KSPGetErrorIfNotConverged(s->iterative, &raises));
  if (may) PetscCall(KSPSetErrorIfNotConverged(s->iterative, PETSC_FALSE));
  PetscCall(KSPSolve(s->iterative, s->gap_vec, s->force_vec));
  PetscCall(KSPSetErrorIfNotConverged(s->iterative, raises));
  PetscCall(KSPGetConvergedReason(s->iterative, &reason));
  if (may && (reason == KSP_DIVERGED_ITS || reason == KSP_DIVERGED_INDEFINITE_MAT || reason == KSP_DIVERGED_BREAKDOWN)) {
    s->must_factor = PETSC_TRUE;
    PetscCall(FactorConstraints(s));
  } else PetscCall(ConstrainedSolverCheckSolution(s, s->iterative, s->force_vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x -= A^{-1} B_m^T s with the constraint forces s by conjugate gradients, unless it turns out that these have a dense matrix after all */
static PetscErrorCode ConstrainIteratively(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  PetscScalar *gap;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->gap_vec));
  PetscCall(VecGetArray(s->gap_vec, &gap));
  for (PetscInt i = 0; i < s->local; i++) {
    if (target) gap[i] -= target[i];
    if (s->mine[i] < 0) gap[i] = 0;
  }
  PetscCall(VecRestoreArray(s->gap_vec, &gap));
  PetscCall(Iterate(s));
  if (s->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMultTranspose(s->B, s->force_vec, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->product));
  PetscCall(VecAXPY(x, -1, s->product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x, a solution without constraints, becomes that with B_m x = target (this rank's rows; NULL: 0) */
static PetscErrorCode Constrain(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  const PetscBLASInt one = 1;
  PetscBLASInt       n, info;

  PetscFunctionBegin;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->dense) PetscCall(ConstrainIteratively(s, target, x));
  if (!s->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Gather(s, x, target, s->gathered));
  for (PetscInt k = 0; k < s->n; k++) {
    s->force[k] = -s->gathered[k];
    s->used[k]  = s->columns[s->rows[k]];
  }
  PetscCall(PetscBLASIntCast(s->n, &n));
  PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, s->W, &n, s->pivots, s->force, &n, &info));
  PetscCall(VecMAXPY(x, s->n, s->force, s->used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether iterations that do not converge end with an error of PETSc */
static PetscErrorCode SetRaises(ConstrainedSolver s, PetscBool raises)
{
  PetscFunctionBegin;
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, raises));
  if (s->iterative) PetscCall(KSPSetErrorIfNotConverged(s->iterative, raises));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solution of a step. If it does not converge the step has failed, and ConstrainedSolverTakeFailure() tells why; what a constant matrix
   is asked for beside steps, once, ends with an error instead. */
PetscErrorCode ConstrainedSolverSolve(ConstrainedSolver s, Vec b, Vec x)
{
  const PetscBool iterates = (PetscBool)(!s->direct || (s->n && !s->dense));

  PetscFunctionBegin;
  if (iterates && s->constant) PetscCall(SetRaises(s, PETSC_FALSE));
  PetscCall(ConstrainedSolverSolveFree(s, b, x));
  PetscCall(Constrain(s, NULL, x));
  if (iterates && s->constant) PetscCall(SetRaises(s, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = sum of C_j f_j, with columns that are all there */
static PetscErrorCode AddColumns(ConstrainedSolver s, Vec x)
{
  PetscInt used = 0;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < s->global; j++) {
    if (s->changes[j] == 0) continue;
    s->force[used]  = s->changes[j];
    s->used[used++] = s->columns[j];
  }
  if (used) PetscCall(VecAXPBY(x, s->force[0], 0, s->used[0]));
  else PetscCall(VecZeroEntries(x));
  if (used > 1) PetscCall(VecMAXPY(x, used - 1, s->force + 1, s->used + 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the columns of all rows whose force changes are there. Others are made at once where there are few rows, else when as many
   corrections, by a solution each, have missed them as they take; unless one rank may be doing this without the others. */
static PetscErrorCode FindColumns(ConstrainedSolver s, PetscBool *columns)
{
  PetscInt missing = 0;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < s->global; j++) missing += s->changes[j] != 0 && !s->fresh[j];
  *columns = (PetscBool)!missing;
  if (!missing || s->alone) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->global > FEW_ROWS && (s->exact || ++s->missed <= missing)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++)
    if (s->changes[j] != 0) PetscCall(ConstrainedSolverMakeColumn(s, j));
  s->missed = 0;
  *columns  = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Changes of forces, of all rows on every rank that may ask. `columns`: the columns of all rows whose force changes are there */
static PetscErrorCode GatherChanges(ConstrainedSolver s, const PetscScalar force[], PetscBool *columns)
{
  PetscFunctionBegin;
  if (s->size > 1 && !s->alone)
    PetscCallMPI(MPI_Allgatherv(force, (PetscMPIInt)s->local, MPIU_SCALAR, s->changes, s->counts, s->offsets, MPIU_SCALAR,
                                PetscObjectComm((PetscObject)s->ksp)));
  else PetscCall(PetscArraycpy(s->changes, force, s->local));
  PetscCall(FindColumns(s, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings changes of the forces on this rank's rows to the ranks that have A, for ConstrainedSolverCorrect(); collective */
PetscErrorCode ConstrainedSolverBring(ConstrainedSolver s, const PetscScalar force[])
{
  PetscScalar *row;

  PetscFunctionBegin;
  s->by_columns = PETSC_FALSE;
  if (s->keeps && !s->n) PetscCall(GatherChanges(s, force, &s->by_columns));
  if (s->by_columns) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(s->row, &row));
  PetscCall(PetscArraycpy(row, force, s->local));
  PetscCall(VecRestoreArrayWrite(s->row, &row));
  PetscCall(MatMultTranspose(s->B, s->row, s->rhs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x with A x = B^T (force - s) and B_m x = target, for the forces that ConstrainedSolverBring() has brought, without another use of the
   solver in between: what a change of both changes. By the columns where they are kept and no row is constrained, else by a solution. Where
   nothing is constrained, a rank that has all of A makes this alone. */
PetscErrorCode ConstrainedSolverCorrect(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  PetscFunctionBegin;
  if (s->by_columns) {
    PetscCall(AddColumns(s, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, x));
  PetscCall(Constrain(s, target, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constraints, for a checkpoint; their matrix follows from the columns, which are loaded before */
PetscErrorCode ConstrainedSolverVisitConstraints(ConstrainedSolver s, Checkpoint checkpoint)
{
  PetscInt numbers[2] = {s->missed, s->must_factor};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility", s->local, s->mine));
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility of all", s->global, s->constrained));
  PetscCall(CheckpointVisitInts(checkpoint, "constrained", 2, numbers));
  s->missed      = numbers[0];
  s->must_factor = (PetscBool)numbers[1];
  if (CheckpointLoads(checkpoint)) PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
