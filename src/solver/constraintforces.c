/* The constraint forces s, by LU factors of W_mm. */
#include "constrainedsolverimpl.h"
#include <petscblaslapack.h>

/* Most constraint forces: factors of their matrix take 800 MB on each rank then; */
#define MAX_CONSTRAINTS 10000
/* and most numbers of their columns, 8 GB on all ranks together */
#define MAX_COLUMN_NUMBERS 1e9
/* Of a pivot, in parts of the largest entry of its column */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

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
    PetscCall(Gather(s, s->columns[s->rows[k]], NULL, s->force));
    for (PetscInt l = 0; l <= k; l++) s->W[k * s->n + l] = s->W[l * s->n + k] = s->force[l];
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
  PetscInt  size;
  PetscBool singular;

  PetscFunctionBegin;
  s->n = 0;
  for (PetscInt j = 0; j < s->global; j++)
    if (s->constrained[j] >= 0) s->rows[s->n++] = j;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetSize(s->rhs, &size));
  PetscCheck(s->n <= MAX_CONSTRAINTS && (PetscReal)s->n * size <= MAX_COLUMN_NUMBERS, PetscObjectComm((PetscObject)s->ksp), PETSC_ERR_SUP,
             "%" PetscInt_FMT " contact rows of a body with %" PetscInt_FMT
             " displacements are prescribed, or on springs: their compliance "
             "does not fit into memory; choose a coarser mesh, or -contact_type schwarz in place of alternation, which prescribes none",
             s->n, size);
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
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  for (PetscInt i = 0; i < s->local; i++)
    if (constrained[i]) s->constrained[s->begin + i] = flexibility ? flexibility[i] : 0;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, s->constrained, (PetscMPIInt)s->global, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No row of any rank is constrained. Not collective. */
PetscErrorCode ConstrainedSolverFreeRows(ConstrainedSolver s)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < s->n; k++) s->constrained[s->rows[k]] = -1;
  s->n = 0;
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

/* x, a solution without constraints, becomes that with B_m x = target (this rank's rows; NULL: 0) */
static PetscErrorCode Constrain(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  const PetscBLASInt one = 1;
  PetscBLASInt       n, info;

  PetscFunctionBegin;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Gather(s, x, target, s->force));
  for (PetscInt k = 0; k < s->n; k++) {
    s->force[k] = -s->force[k];
    s->used[k]  = s->columns[s->rows[k]];
  }
  PetscCall(PetscBLASIntCast(s->n, &n));
  PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, s->W, &n, s->pivots, s->force, &n, &info));
  PetscCall(VecMAXPY(x, s->n, s->force, s->used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solution of a step. If it does not converge the step has failed, and ConstrainedSolverTakeFailure() tells why; what a constant matrix
   is asked for beside steps, once, ends with an error instead. */
PetscErrorCode ConstrainedSolverSolve(ConstrainedSolver s, Vec b, Vec x)
{
  PetscFunctionBegin;
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, PETSC_FALSE));
  PetscCall(ConstrainedSolverSolveFree(s, b, x));
  PetscCall(Constrain(s, NULL, x));
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, s->constant));
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

/* Whether the columns of all rows whose force changes are there, and not too many. Others are made at once where there are few rows, else
   when as many corrections, by a solution each, have missed them as they take, in place of columns of rows whose force stays; unless one
   rank may be doing this without the others. */
static PetscErrorCode FindColumns(ConstrainedSolver s, PetscBool *columns)
{
  PetscInt change = 0, missing = 0, others = 0;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < s->global; j++) {
    change += s->changes[j] != 0;
    missing += s->changes[j] != 0 && !s->fresh[j];
    others += s->changes[j] == 0 && s->columns[j];
  }
  *columns = (PetscBool)(!missing && change <= s->most);
  if (!missing || change > s->most || s->alone) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->global > FEW_ROWS && (s->exact || ++s->missed <= missing)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++) {
    if (s->changes[j] != 0) PetscCall(ConstrainedSolverMakeColumn(s, j));
    else if (change + others > s->most) {
      PetscCall(VecDestroy(&s->columns[j]));
      s->fresh[j] = PETSC_FALSE;
    }
  }
  s->missed = 0;
  *columns  = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Changes of forces, of all rows on every rank that may ask. `columns`: the columns of all rows whose force changes are there */
static PetscErrorCode GatherChanges(ConstrainedSolver s, const PetscScalar force[], PetscBool *columns)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(s->changes, s->global));
  PetscCall(PetscArraycpy(s->changes + s->begin, force, s->local));
  if (s->size > 1 && !s->alone)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, s->changes, (PetscMPIInt)s->global, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(FindColumns(s, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings changes of the forces on this rank's rows to the ranks that have A, for ConstrainedSolverCorrect(); collective */
PetscErrorCode ConstrainedSolverBring(ConstrainedSolver s, const PetscScalar force[])
{
  PetscScalar *row;

  PetscFunctionBegin;
  s->by_columns = PETSC_FALSE;
  if (s->most && !s->n) PetscCall(GatherChanges(s, force, &s->by_columns));
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

/* State for a checkpoint. A and B are loaded before: columns of A^{-1} B^T follow from them, to the last bit, and the matrix of the
   constraints from those. Collective. */
PetscErrorCode ConstrainedSolverVisit(ConstrainedSolver s, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointCheckInts(checkpoint, "rows", 1, &s->global));
  PetscCall(CheckpointVisitBools(checkpoint, "columns", s->global, s->fresh));
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility", s->global, s->constrained));
  PetscCall(CheckpointVisitInts(checkpoint, "missed columns", 1, &s->missed));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++) {
    if (!s->fresh[j]) continue;
    s->fresh[j] = PETSC_FALSE;
    PetscCall(ConstrainedSolverMakeColumn(s, j));
  }
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
