/*
   A x = b subject to B_m x = 0 for the constrained rows m, with the factors of the unconstrained A: the constraint forces s
   follow from the compliance W = B A^{-1} B^T,

     z = A^{-1} b,   W_mm s = B_m z,   x = z - A^{-1} B_m^T s.

   A row on a spring, rather than held, gives (A + B_m^T k B_m) x = b: the same with the flexibility 1 / k added to its entry on the
   diagonal of W (Woodbury's formula). So a change of the constrained rows never makes A be factored again. The columns C = A^{-1} B^T are
   made once each, when their row is constrained for the first time; with more constrained rows than would fit, the constraint forces are
   found by conjugate gradients, which need W only as a product.
*/
#include "constrainedsolver.h"
#include <petscblaslapack.h>
#include <sys/petsccompat.h>

struct _n_ConstrainedSolver {
  KSP         ksp;
  PC          direct; /* the preconditioner where it is the whole solver, else NULL */
  Mat         B;
  PetscInt    local, global, begin; /* rows of B */
  PetscMPIInt size, *counts, *offsets;
  PetscReal  *mine,
      *constrained;         /* flexibility of a row, 0 where it is held, less than 0 where it is free: this rank's rows, and all rows */
  PetscInt      n, n_most;  /* how many of them; for how many there is room */
  PetscInt     *rows;       /* which */
  PetscBool    *stale;      /* per row: its column was made with an earlier A or B */
  Vec          *columns;    /* per row: A^{-1} B^T e, or NULL until needed */
  PetscScalar **compliance; /* per row: B times its column, this rank's rows */
  PetscScalar  *factor;     /* n x n, LU of the constrained part */
  PetscBLASInt *pivots;
  PetscScalar  *gathered, *force;
  Vec          *active_columns; /* those of the constrained rows */
  Vec           row, rhs;
  PetscBool     dense; /* the factor is there */
  PetscInt      dense_limit;
  KSP           iterative; /* for the constraint forces, where they are many */
  Vec           force_vec, gap_vec, product;
};

/* Bodies up to this size are factored whole on every rank; larger ones by MUMPS */
#define MAX_REDUNDANT_SIZE 5000
/* On one rank, PETSc's own factorisation is an order of magnitude faster than MUMPS for small bodies: up to these sizes, by dimension. In
   more dimensions factors fill in more, and MUMPS has the better kernels and orderings. */
static const PetscInt max_sequential_size[] = {50000, 50000, 5000, 1500};
/* In three dimensions factors of bodies larger than this take more memory and time than multigrid */
#define MAX_DIRECT_SIZE_3D 150000
/* of multigrid: what is left of the residual must not show in energies and momenta */
#define ITERATIVE_TOLERANCE 1e-12
/* Constraint forces up to this number by a dense matrix; and of columns up to so many numbers in all, 800 MB */
#define MAX_DENSE_CONSTRAINTS 2000
#define MAX_COLUMN_NUMBERS    1e8
/* of the constraint forces by conjugate gradients: contact gaps are closed to about 1e-12 of the displacements */
#define FORCE_TOLERANCE 1e-13

/* How A is factored, unless options say otherwise */
static PetscErrorCode ChooseSolver(KSP ksp, Mat A, PetscInt dim)
{
  PetscMPIInt size;
  PetscInt    n;
  PC          pc;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)ksp), &size));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(KSPSetTolerances(ksp, ITERATIVE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, 1000));
  if (dim == 3 && n > MAX_DIRECT_SIZE_3D) {
    PetscCall(KSPSetType(ksp, KSPCG));
    PetscCall(PCSetType(pc, PCGAMG));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  if (size > 1 && n <= MAX_REDUNDANT_SIZE) {
    KSP inner;

    PetscCall(PCSetType(pc, PCREDUNDANT));
    PetscCall(PCRedundantGetKSP(pc, &inner));
    PetscCall(KSPSetType(inner, KSPPREONLY));
    PetscCall(KSPGetPC(inner, &pc));
    PetscCall(PCSetType(pc, PCLU));
    PetscCall(PCFactorSetZeroPivot(pc, 0));
    PetscCall(PCFactorSetMatOrderingType(pc, dim == 1 ? MATORDERINGRCM : MATORDERINGND));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (size > 1 || n > max_sequential_size[dim]) {
    PetscCall(PCSetType(pc, PCCHOLESKY)); /* all matrices here are symmetric */
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(PCFactorSetZeroPivot(pc, 0)); /* PETSc's default is 2e-14, whatever the unit of the matrix */
  PetscCall(PCFactorSetMatOrderingType(pc, dim == 1 ? MATORDERINGRCM : MATORDERINGND));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A is the matrix of a body in `dim` dimensions */
PetscErrorCode ConstrainedSolverCreate(Mat A, Mat B, PetscInt dim, const char prefix[], ConstrainedSolver *solver)
{
  ConstrainedSolver s;
  MPI_Comm          comm = PetscObjectComm((PetscObject)A);
  PetscMPIInt       size;
  PetscBool         direct;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  PetscCall(KSPCreate(comm, &s->ksp));
  PetscCall(KSPSetOptionsPrefix(s->ksp, prefix));
  PetscCall(KSPSetOperators(s->ksp, A, A));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  s->size        = size;
  s->dense_limit = MAX_DENSE_CONSTRAINTS;
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, PETSC_TRUE));
  PetscCall(ChooseSolver(s->ksp, A, dim));
  PetscCall(KSPSetFromOptions(s->ksp));
  PetscCall(KSPSetUp(s->ksp));
  PetscCall(PetscObjectTypeCompare((PetscObject)s->ksp, KSPPREONLY, &direct));
  if (direct) PetscCall(KSPGetPC(s->ksp, &s->direct));

  PetscCall(PetscObjectReference((PetscObject)B));
  s->B = B;
  PetscCall(MatCreateVecs(B, NULL, &s->row));
  PetscCall(MatCreateVecs(A, NULL, &s->rhs));
  PetscCall(MatGetLocalSize(B, &s->local, NULL));
  PetscCall(MatGetSize(B, &s->global, NULL));
  PetscCall(MatGetOwnershipRange(B, &s->begin, NULL));
  PetscCall(PetscMalloc2(size, &s->counts, size, &s->offsets));
  {
    PetscMPIInt local, total = 0;

    PetscCall(PetscMPIIntCast(s->local, &local));
    PetscCallMPI(MPI_Allgather(&local, 1, MPI_INT, s->counts, 1, MPI_INT, comm));
    for (PetscMPIInt r = 0; r < size; total += s->counts[r++]) s->offsets[r] = total;
  }
  PetscCall(PetscCalloc6(s->local, &s->mine, s->global, &s->constrained, s->global, &s->rows, s->global, &s->columns, s->global, &s->stale,
                         s->global, &s->compliance));
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  *solver = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverDestroy(ConstrainedSolver *solver)
{
  ConstrainedSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++) {
    PetscCall(VecDestroy(&s->columns[j]));
    PetscCall(PetscFree(s->compliance[j]));
  }
  PetscCall(PetscFree6(s->mine, s->constrained, s->rows, s->columns, s->stale, s->compliance));
  PetscCall(PetscFree5(s->factor, s->pivots, s->gathered, s->force, s->active_columns));
  PetscCall(PetscFree2(s->counts, s->offsets));
  PetscCall(KSPDestroy(&s->iterative));
  PetscCall(VecDestroy(&s->force_vec));
  PetscCall(VecDestroy(&s->gap_vec));
  PetscCall(VecDestroy(&s->product));
  PetscCall(VecDestroy(&s->row));
  PetscCall(VecDestroy(&s->rhs));
  PetscCall(MatDestroy(&s->B));
  PetscCall(KSPDestroy(&s->ksp));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverGetKSP(ConstrainedSolver solver, KSP *ksp)
{
  PetscFunctionBegin;
  *ksp = solver->ksp;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many constraint forces are found by a dense matrix; more come from conjugate gradients */
PetscErrorCode ConstrainedSolverSetDenseLimit(ConstrainedSolver s, PetscInt limit)
{
  PetscFunctionBegin;
  s->dense_limit = limit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} b, without constraints */
PetscErrorCode ConstrainedSolverSolveFree(ConstrainedSolver s, Vec b, Vec x)
{
  PetscFunctionBegin;
  if (s->direct) PetscCall(PCApply(s->direct, b, x));
  else PetscCall(KSPSolve(s->ksp, b, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows have new entries, as many as before: some of them, or (NULL) all */
PetscErrorCode ConstrainedSolverSetRows(ConstrainedSolver s, Mat B, const PetscBool changed[])
{
  PetscMPIInt *all, *mine;

  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&s->B));
  s->B = B;
  PetscCall(PetscMalloc2(s->global, &all, s->local, &mine));
  for (PetscInt i = 0; i < s->local; i++) mine[i] = !changed || changed[i];
  PetscCallMPI(
      MPI_Allgatherv(mine, (PetscMPIInt)s->local, MPI_INT, all, s->counts, s->offsets, MPI_INT, PetscObjectComm((PetscObject)s->ksp)));
  for (PetscInt j = 0; j < s->global; j++) {
    if (all[j]) s->stale[j] = PETSC_TRUE;
    else if (s->columns[j] && !s->stale[j]) {
      /* what this column does to the rows that have changed */
      const PetscScalar *row;

      PetscCall(MatMult(s->B, s->columns[j], s->row));
      PetscCall(VecGetArrayRead(s->row, &row));
      PetscCall(PetscArraycpy(s->compliance[j], row, s->local));
      PetscCall(VecRestoreArrayRead(s->row, &row));
    }
  }
  PetscCall(PetscFree2(all, mine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* w = W e_j, the displacement of the rows of this rank under a unit force on row j. Leaves A^{-1} B^T e_j in x. */
PetscErrorCode ConstrainedSolverApplyUnit(ConstrainedSolver s, PetscInt j, Vec x, PetscScalar w[])
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(s->row));
  if (j >= s->begin && j < s->begin + s->local) PetscCall(VecSetValue(s->row, j, 1.0, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(s->row));
  PetscCall(VecAssemblyEnd(s->row));
  PetscCall(MatMultTranspose(s->B, s->row, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, x));
  PetscCall(MatMult(s->B, x, s->row));
  PetscCall(VecGetArrayRead(s->row, &row));
  PetscCall(PetscArraycpy(w, row, s->local));
  PetscCall(VecRestoreArrayRead(s->row, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* w = W f for forces f on all rows; neither may be a vector of the solver */
PetscErrorCode ConstrainedSolverApplyCompliance(ConstrainedSolver s, Vec f, Vec w)
{
  PetscFunctionBegin;
  if (!s->product) PetscCall(VecDuplicate(s->rhs, &s->product));
  PetscCall(MatMultTranspose(s->B, f, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->product));
  PetscCall(MatMult(s->B, s->product, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscCall(KSPSetInitialGuessNonzero(s->iterative, PETSC_TRUE)); /* the forces of the last solve */
  PetscCall(KSPSetErrorIfNotConverged(s->iterative, PETSC_TRUE));
  PetscCall(VecDuplicate(s->row, &s->force_vec));
  PetscCall(VecDuplicate(s->row, &s->gap_vec));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C_j = A^{-1} B^T e_j and column j of W */
static PetscErrorCode MakeColumn(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (!s->columns[j]) {
    PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
    PetscCall(PetscMalloc1(s->local, &s->compliance[j]));
  }
  s->stale[j] = PETSC_FALSE;
  PetscCall(ConstrainedSolverApplyUnit(s, j, s->columns[j], s->compliance[j]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeRoom(ConstrainedSolver s, PetscInt n)
{
  PetscFunctionBegin;
  if (n <= s->n_most) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree5(s->factor, s->pivots, s->gathered, s->force, s->active_columns));
  s->n_most = PetscMin(s->global, PetscMax(n, 2 * s->n_most));
  PetscCall(PetscMalloc5(s->n_most * s->n_most, &s->factor, s->n_most, &s->pivots, s->n_most, &s->gathered, s->n_most, &s->force, s->n_most,
                         &s->active_columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constraint forces' matrix, for the rows that are constrained now */
static PetscErrorCode FactorConstraints(ConstrainedSolver s)
{
  PetscBLASInt n, info;
  PetscInt     size;

  PetscFunctionBegin;
  s->n = 0;
  for (PetscInt j = 0; j < s->global; j++)
    if (s->constrained[j] >= 0) s->rows[s->n++] = j;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetSize(s->rhs, &size));
  if (s->n > s->dense_limit || (PetscReal)s->n * size > MAX_COLUMN_NUMBERS) {
    if (!s->iterative) PetscCall(CreateIterative(s));
    PetscCall(VecZeroEntries(s->force_vec));
    s->dense = PETSC_FALSE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  s->dense = PETSC_TRUE;
  PetscCall(MakeRoom(s, s->n));
  for (PetscInt k = 0; k < s->n; k++) {
    const PetscInt j = s->rows[k];

    if (!s->columns[j] || s->stale[j]) PetscCall(MakeColumn(s, j));
    s->active_columns[k] = s->columns[j];
  }
  PetscCall(PetscArrayzero(s->factor, s->n * s->n));
  for (PetscInt k = 0; k < s->n; k++)
    for (PetscInt l = 0; l < s->n; l++) {
      const PetscInt local = s->rows[l] - s->begin;

      if (local >= 0 && local < s->local)
        s->factor[k * s->n + l] = s->compliance[s->rows[k]][local] + (k == l ? s->constrained[s->rows[k]] : 0);
    }
  if (s->size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, s->factor, (PetscMPIInt)(s->n * s->n), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(PetscBLASIntCast(s->n, &n));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, s->factor, &n, s->pivots, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_MAT_LU_ZRPVT,
             "The prescribed contact rows of a body are not independent (LAPACK getrf info %d); is a node in two contact pairs?",
             (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of this rank's rows are held from now on, or on springs with those flexibilities (NULL: all held). Collective. */
PetscErrorCode ConstrainedSolverSetConstraints(ConstrainedSolver s, const PetscBool constrained[], const PetscReal flexibility[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->local; i++) s->mine[i] = constrained[i] ? (flexibility ? flexibility[i] : 0) : -1;
  PetscCallMPI(MPI_Allgatherv(s->mine, (PetscMPIInt)s->local, MPIU_REAL, s->constrained, s->counts, s->offsets, MPIU_REAL,
                              PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A has new values, as that of a nonlinear body has in every Newton iteration */
PetscErrorCode ConstrainedSolverRefactor(ConstrainedSolver s)
{
  PetscFunctionBegin;
  PetscCall(KSPSetUp(s->ksp));
  for (PetscInt j = 0; j < s->global; j++) s->stale[j] = PETSC_TRUE;
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x -= A^{-1} B_m^T s with the constraint forces s by conjugate gradients, from those of the last solve on */
static PetscErrorCode ConstrainIteratively(ConstrainedSolver s, Vec x)
{
  PetscScalar *gap;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->gap_vec));
  PetscCall(VecGetArray(s->gap_vec, &gap));
  for (PetscInt i = 0; i < s->local; i++)
    if (s->mine[i] < 0) gap[i] = 0;
  PetscCall(VecRestoreArray(s->gap_vec, &gap));
  PetscCall(KSPSolve(s->iterative, s->gap_vec, s->force_vec));
  PetscCall(MatMultTranspose(s->B, s->force_vec, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->product));
  PetscCall(VecAXPY(x, -1, s->product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B x on the constrained rows, on every rank, in solver->gathered */
static PetscErrorCode GatherRows(ConstrainedSolver s, Vec x)
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->row));
  PetscCall(VecGetArrayRead(s->row, &row));
  for (PetscInt k = 0; k < s->n; k++) {
    const PetscInt local = s->rows[k] - s->begin;

    s->gathered[k] = local >= 0 && local < s->local ? row[local] : 0;
  }
  PetscCall(VecRestoreArrayRead(s->row, &row));
  if (s->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, s->gathered, (PetscMPIInt)s->n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)s->ksp)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverSolve(ConstrainedSolver s, Vec b, Vec x)
{
  PetscBLASInt n, one = 1, info;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverSolveFree(s, b, x));
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->dense) {
    PetscCall(ConstrainIteratively(s, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(GatherRows(s, x));
  for (PetscInt k = 0; k < s->n; k++) s->force[k] = -s->gathered[k];
  PetscCall(PetscBLASIntCast(s->n, &n));
  if (n == 1) s->force[0] /= s->factor[0];
  else PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, s->factor, &n, s->pivots, s->force, &n, &info));
  PetscCall(VecMAXPY(x, s->n, s->force, s->active_columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}
