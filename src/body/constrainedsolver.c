/*
   A x = b subject to B_m x = 0 for the constrained rows m, with the factors of the unconstrained A: the constraint forces s
   follow from the compliance W = B A^{-1} B^T,

     z = A^{-1} b,   W_mm s = B_m z,   x = z - A^{-1} B_m^T s.

   A row on a spring, rather than held, gives (A + B_m^T k B_m) x = b: the same with the flexibility 1 / k added to its entry on the
   diagonal of W (Woodbury's formula). So a change of the constrained rows never makes A be factored again. The columns C = A^{-1} B^T are made once each, when
   their row is constrained for the first time.
*/
#include "constrainedsolver.h"
#include <petscblaslapack.h>
#include <sys/petsccompat.h>

struct _n_ConstrainedSolver {
  KSP           ksp;
  PC            direct; /* the preconditioner where it is the whole solver, else NULL */
  Mat           B;
  PetscInt      local, global, begin; /* rows of B */
  PetscMPIInt   size, *counts, *offsets;
  PetscReal    *mine, *constrained; /* flexibility of a row, 0 where it is held, less than 0 where it is free: this rank's rows, and all rows */
  PetscInt      n;                  /* how many of them */
  PetscInt     *rows;               /* which */
  PetscBool    *stale;              /* per row: its column was made with an earlier A */
  Vec          *columns;            /* per row: A^{-1} B^T e, or NULL until needed */
  PetscScalar  *compliance;         /* global x global, by columns; column j valid where columns[j] is */
  PetscScalar  *factor;             /* n x n, LU of the constrained part */
  PetscBLASInt *pivots;
  PetscScalar  *gathered, *force;
  Vec          *active_columns; /* those of the constrained rows */
  Vec           row, rhs;
};

/* Bodies up to this size are factored whole on every rank; larger ones by MUMPS */
#define MAX_REDUNDANT_SIZE 5000
/* On one rank, PETSc's own factorisation is an order of magnitude faster than MUMPS for small bodies: up to these sizes, by dimension. In more dimensions factors fill in more, and MUMPS has the better kernels and orderings. */
static const PetscInt max_sequential_size[] = {50000, 50000, 5000, 1500};
/* In three dimensions factors of bodies larger than this take more memory and time than multigrid */
#define MAX_DIRECT_SIZE_3D 150000
/* of multigrid: what is left of the residual must not show in energies and momenta */
#define ITERATIVE_TOLERANCE 1e-12

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
    PetscCall(PCFactorSetMatOrderingType(pc, dim == 1 ? MATORDERINGRCM : MATORDERINGND));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (size > 1 || n > max_sequential_size[dim]) {
    PetscCall(PCSetType(pc, PCCHOLESKY)); /* all matrices here are symmetric */
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PCSetType(pc, PCLU));
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
  s->size = size;
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
  PetscCall(PetscCalloc6(s->local, &s->mine, s->global, &s->constrained, s->global, &s->rows, s->global, &s->columns, s->global, &s->active_columns, s->global * s->global, &s->compliance));
  PetscCall(PetscCalloc5(s->global * s->global, &s->factor, s->global, &s->pivots, s->global, &s->gathered, s->global, &s->force, s->global, &s->stale));
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  *solver = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverDestroy(ConstrainedSolver *solver)
{
  ConstrainedSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->global; j++) PetscCall(VecDestroy(&s->columns[j]));
  PetscCall(PetscFree6(s->mine, s->constrained, s->rows, s->columns, s->active_columns, s->compliance));
  PetscCall(PetscFree5(s->factor, s->pivots, s->gathered, s->force, s->stale));
  PetscCall(PetscFree2(s->counts, s->offsets));
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

/* B z on every rank, in solver->gathered */
static PetscErrorCode GatherRows(ConstrainedSolver s, Vec z)
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, z, s->row));
  PetscCall(VecGetArrayRead(s->row, &row));
  if (s->size == 1) PetscCall(PetscArraycpy(s->gathered, row, s->global));
  else PetscCallMPI(MPI_Allgatherv(row, (PetscMPIInt)s->local, MPIU_SCALAR, s->gathered, s->counts, s->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)s->ksp)));
  PetscCall(VecRestoreArrayRead(s->row, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C_j = A^{-1} B^T e_j and column j of W */
static PetscErrorCode MakeColumn(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
  s->stale[j] = PETSC_FALSE;
  PetscCall(VecZeroEntries(s->row));
  if (j >= s->begin && j < s->begin + s->local) PetscCall(VecSetValue(s->row, j, 1.0, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(s->row));
  PetscCall(VecAssemblyEnd(s->row));
  PetscCall(MatMultTranspose(s->B, s->row, s->rhs));
  PetscCall(KSPSolve(s->ksp, s->rhs, s->columns[j]));
  PetscCall(GatherRows(s, s->columns[j]));
  PetscCall(PetscArraycpy(s->compliance + j * s->global, s->gathered, s->global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constraint forces' matrix, for the rows that are constrained now */
static PetscErrorCode FactorConstraints(ConstrainedSolver s)
{
  PetscBLASInt n, info;

  PetscFunctionBegin;
  s->n = 0;
  for (PetscInt j = 0; j < s->global; j++) {
    if (s->constrained[j] < 0) continue;
    if (!s->columns[j] || s->stale[j]) PetscCall(MakeColumn(s, j));
    s->active_columns[s->n] = s->columns[j];
    s->rows[s->n++]         = j;
  }
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j < s->n; j++)
    for (PetscInt i = 0; i < s->n; i++) s->factor[j * s->n + i] = s->compliance[s->rows[j] * s->global + s->rows[i]] + (i == j ? s->constrained[s->rows[j]] : 0);
  PetscCall(PetscBLASIntCast(s->n, &n));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, s->factor, &n, s->pivots, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_MAT_LU_ZRPVT, "The prescribed contact rows of a body are not independent (LAPACK getrf info %d); is a node in two contact pairs?", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of this rank's rows are held from now on, or on springs with those flexibilities (NULL: all held). Collective. */
PetscErrorCode ConstrainedSolverSetConstraints(ConstrainedSolver s, const PetscBool constrained[], const PetscReal flexibility[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->local; i++) s->mine[i] = constrained[i] ? (flexibility ? flexibility[i] : 0) : -1;
  PetscCallMPI(MPI_Allgatherv(s->mine, (PetscMPIInt)s->local, MPIU_REAL, s->constrained, s->counts, s->offsets, MPIU_REAL, PetscObjectComm((PetscObject)s->ksp)));
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

PetscErrorCode ConstrainedSolverSolve(ConstrainedSolver s, Vec b, Vec x)
{
  PetscBLASInt n, one = 1, info;

  PetscFunctionBegin;
  if (s->direct) PetscCall(PCApply(s->direct, b, x));
  else PetscCall(KSPSolve(s->ksp, b, x));
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GatherRows(s, x));
  for (PetscInt i = 0; i < s->n; i++) s->force[i] = -s->gathered[s->rows[i]];
  PetscCall(PetscBLASIntCast(s->n, &n));
  if (n == 1) s->force[0] /= s->factor[0];
  else PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, s->factor, &n, s->pivots, s->force, &n, &info));
  PetscCall(VecMAXPY(x, s->n, s->force, s->active_columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}
