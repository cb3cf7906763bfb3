/*
   A x = b subject to B_m x = t for the constrained rows m, with the factors of the unconstrained A: the constraint forces s
   follow from the compliance W = B A^{-1} B^T,

     z = A^{-1} b,   W_mm s = B_m z - t,   x = z - A^{-1} B_m^T s.

   A row on a spring, rather than prescribed, gives (A + B_m^T k B_m) x = b: the same with t = 0 and the flexibility 1 / k added to its
   entry on the diagonal of W (Woodbury's formula). So a change of the constrained rows never makes A be factored again. The columns C =
   A^{-1} B^T are made once each, when their row is constrained for the first time; W is kept in a Compliance, which may be one that others
   read too. With more constrained rows than would fit, and until iterations have cost as much as columns and factors would, the constraint
   forces are found by conjugate gradients, which need W only as a product.
*/
#include "constrainedsolver.h"
#include "densefactor.h"
#include <math.h>
#include <sys/petsccompat.h>

struct _n_ConstrainedSolver {
  KSP                ksp;
  PC                 direct; /* the preconditioner where it is the whole solver, else NULL */
  Mat                B;
  PetscInt           local, global, begin; /* rows of B */
  PetscMPIInt        size, *counts, *offsets;
  Compliance         compliance; /* W at its first level */
  PetscBool          shares;     /* that is another's, who destroys it; then A is constant */
  KSPConvergedReason failed;     /* why a solution with a matrix that is not constant did not converge; 0: none failed */
  PetscReal         *mine,
      *constrained;   /* flexibility of a row, 0 where it is prescribed, less than 0 where it is free: this rank's rows, all rows */
  PetscInt   n;       /* how many rows are constrained */
  PetscInt  *rows;    /* which */
  Vec       *columns; /* per row: A^{-1} B^T e, or NULL until needed */
  PetscBool *fresh;   /* per row: its column is there, and that of W, both with A and B as they are */
  /* a dense matrix for the constraint forces */
  PetscBool    dense; /* its factors are there */
  PetscInt     dense_limit;
  DenseFactor  factor;
  PetscInt     room;             /* of the following */
  PetscScalar *gathered, *force; /* of constrained rows, on every rank */
  Vec         *used;             /* columns */
  Vec          row, rhs;
  /* conjugate gradients */
  KSP            iterative;
  Vec            force_vec, gap_vec, product;
  PetscLogDouble solve_flops, spent; /* of one solution with A; of all iterations so far */
  /* corrections by stored columns, on interfaces of few rows: their changes, all rows on every rank */
  PetscScalar *changes, *coefficients;
  PetscScalar *column; /* work space: of this rank's rows */
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
/* and iterations of it, of which bodies of 10^4 to 3e5 unknowns take 18 to 20 */
#define ITERATIVE_MAX_IT 1000
/* Constraint forces up to this number by a dense matrix, whose factors take 64 MB then; and of columns up to so many numbers in all, 800 MB
 */
#define MAX_DENSE_CONSTRAINTS 2000
#define MAX_COLUMN_NUMBERS    1e8
/* Up to so many constraints the dense matrix is made at once: factoring it costs less than a few solutions of a body with such a surface */
#define FEW_CONSTRAINTS 256
/* Interfaces of so few rows in all keep the column of each row that is asked for: a correction adds them up in place of a solution */
#define FEW_ROWS 16
/* Operations of one solution, in parts of the entries of the factors: a multiplication and an addition each, in both triangles */
#define FLOPS_OF_ENTRY 4
/* The same where PETSc does not tell how many entries there are, as with multigrid: in parts of the unknowns, of the order of what 20
   iterations of conjugate gradients with a matrix of 81 entries in a row take */
#define FLOPS_OF_UNKNOWN 4000
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
  PetscCall(KSPSetTolerances(ksp, ITERATIVE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, ITERATIVE_MAX_IT));
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

/* What one solution costs, to compare iterations with columns; counted, so that a run repeats */
static PetscErrorCode CountFlops(ConstrainedSolver s, Mat A)
{
  MatInfo  info;
  PetscInt n;
  Mat      factors = NULL;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &n, NULL));
  s->solve_flops = (PetscLogDouble)FLOPS_OF_UNKNOWN * n;
  if (s->direct) {
    PetscBool lu, cholesky;

    PetscCall(PetscObjectTypeCompare((PetscObject)s->direct, PCLU, &lu));
    PetscCall(PetscObjectTypeCompare((PetscObject)s->direct, PCCHOLESKY, &cholesky));
    if (lu || cholesky) PetscCall(PCFactorGetMatrix(s->direct, &factors));
  }
  if (!factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetInfo(factors, MAT_GLOBAL_SUM, &info));
  if (info.nz_used > 0) s->solve_flops = FLOPS_OF_ENTRY * info.nz_used;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A is the matrix of a body in `dim` dimensions; `compliance`: where W is kept, or NULL for one of the solver's own */
PetscErrorCode ConstrainedSolverCreate(Mat A, Mat B, PetscInt dim, const char prefix[], Compliance compliance, ConstrainedSolver *solver)
{
  ConstrainedSolver s;
  MPI_Comm          comm = PetscObjectComm((PetscObject)A);
  PetscMPIInt       local, total = 0;
  PetscBool         direct;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  PetscCall(KSPCreate(comm, &s->ksp));
  PetscCall(KSPSetOptionsPrefix(s->ksp, prefix));
  PetscCall(KSPSetOperators(s->ksp, A, A));
  PetscCallMPI(MPI_Comm_size(comm, &s->size));
  s->dense_limit = MAX_DENSE_CONSTRAINTS;
  PetscCall(KSPSetErrorIfNotConverged(s->ksp, (PetscBool)(compliance != NULL)));
  PetscCall(ChooseSolver(s->ksp, A, dim));
  PetscCall(KSPSetFromOptions(s->ksp));
  PetscCall(KSPSetUp(s->ksp));
  PetscCall(PetscObjectTypeCompare((PetscObject)s->ksp, KSPPREONLY, &direct));
  if (direct) PetscCall(KSPGetPC(s->ksp, &s->direct));
  PetscCall(CountFlops(s, A));

  PetscCall(PetscObjectReference((PetscObject)B));
  s->B = B;
  PetscCall(MatCreateVecs(B, NULL, &s->row));
  PetscCall(MatCreateVecs(A, NULL, &s->rhs));
  PetscCall(VecDuplicate(s->rhs, &s->product));
  PetscCall(MatGetLocalSize(B, &s->local, NULL));
  PetscCall(MatGetSize(B, &s->global, NULL));
  PetscCall(MatGetOwnershipRange(B, &s->begin, NULL));
  PetscCall(PetscMalloc2(s->size, &s->counts, s->size, &s->offsets));
  PetscCall(PetscMPIIntCast(s->local, &local));
  PetscCallMPI(MPI_Allgather(&local, 1, MPI_INT, s->counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < s->size; total += s->counts[r++]) s->offsets[r] = total;
  PetscCall(
      PetscCalloc5(s->local, &s->mine, s->global, &s->constrained, s->global, &s->rows, s->global, &s->columns, s->global, &s->fresh));
  PetscCall(PetscCalloc3(2 * s->global, &s->changes, s->global, &s->coefficients, s->local, &s->column));
  s->room = PetscMin(s->global, FEW_ROWS);
  PetscCall(PetscMalloc3(s->room, &s->gathered, s->room, &s->force, s->room, &s->used));
  for (PetscInt j = 0; j < s->global; j++) s->constrained[j] = -1;
  s->shares     = (PetscBool)(compliance != NULL);
  s->compliance = compliance;
  if (!compliance) PetscCall(ComplianceCreate(comm, s->local, s->begin, s->global, 1, &s->compliance));
  *solver = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverDestroy(ConstrainedSolver *solver)
{
  ConstrainedSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->shares) PetscCall(ComplianceDestroy(&s->compliance));
  for (PetscInt j = 0; j < s->global; j++) PetscCall(VecDestroy(&s->columns[j]));
  PetscCall(PetscFree5(s->mine, s->constrained, s->rows, s->columns, s->fresh));
  PetscCall(PetscFree3(s->changes, s->coefficients, s->column));
  PetscCall(PetscFree3(s->gathered, s->force, s->used));
  PetscCall(PetscFree2(s->counts, s->offsets));
  PetscCall(DenseFactorDestroy(&s->factor));
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

/* A and B, owned by the solver */
PetscErrorCode ConstrainedSolverGetMatrices(ConstrainedSolver s, Mat *A, Mat *B)
{
  PetscFunctionBegin;
  if (A) PetscCall(KSPGetOperators(s->ksp, A, NULL));
  if (B) *B = s->B;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Operations of one solution */
PetscLogDouble ConstrainedSolverGetFlops(ConstrainedSolver s)
{
  return s->solve_flops;
}

/* How many constraint forces are found by a dense matrix; more come from conjugate gradients */
PetscErrorCode ConstrainedSolverSetDenseLimit(ConstrainedSolver s, PetscInt limit)
{
  PetscFunctionBegin;
  s->dense_limit = limit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solution that did not converge is not a number: the matrix of a nonlinear body may be indefinite where Newton's method has gone astray,
   and its step fails then. With a constant matrix PETSc has ended with an error. */
static PetscErrorCode CheckSolution(ConstrainedSolver s, KSP ksp, Vec x)
{
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  if (reason >= 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->failed) s->failed = reason;
  PetscCall(VecSet(x, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} b, without constraints */
PetscErrorCode ConstrainedSolverSolveFree(ConstrainedSolver s, Vec b, Vec x)
{
  PetscFunctionBegin;
  if (s->direct) PetscCall(PCApply(s->direct, b, x));
  else {
    PetscCall(KSPSolve(s->ksp, b, x));
    PetscCall(CheckSolution(s, s->ksp, x));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Why the first solution since the last call did not converge; 0 if all did. The same on every rank. */
KSPConvergedReason ConstrainedSolverTakeFailure(ConstrainedSolver s)
{
  const KSPConvergedReason failed = s->failed;

  s->failed = KSP_CONVERGED_ITERATING;
  return failed;
}

/* The rows have new entries, as many as before; `changed`: for each row of all ranks, whether it is one of them. A compliance of the
   solver's own forgets these; of a shared one its owner does. */
PetscErrorCode ConstrainedSolverSetRows(ConstrainedSolver s, Mat B, const PetscMPIInt changed[])
{
  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&s->B));
  s->B = B;
  for (PetscInt j = 0; j < s->global; j++)
    if (changed[j]) s->fresh[j] = PETSC_FALSE;
  if (!s->shares) PetscCall(ComplianceForget(s->compliance, changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The owner of a shared compliance has made rows unknown: their columns are not used either, until they are made again */
PetscErrorCode ConstrainedSolverForgetUnknown(ConstrainedSolver s)
{
  const PetscInt *place;

  PetscFunctionBegin;
  ComplianceGetRows(s->compliance, NULL, NULL, &place);
  for (PetscInt j = 0; j < s->global; j++)
    if (place[j] < 0) s->fresh[j] = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* w = W e_j, the displacement of the rows of this rank under a unit force on row j. Leaves A^{-1} B^T e_j in x. */
PetscErrorCode ConstrainedSolverApplyUnit(ConstrainedSolver s, PetscInt j, Vec x, PetscScalar w[])
{
  const PetscScalar *row;
  PetscScalar       *unit;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(s->row, &unit));
  PetscCall(PetscArrayzero(unit, s->local));
  if (j >= s->begin && j < s->begin + s->local) unit[j - s->begin] = 1;
  PetscCall(VecRestoreArrayWrite(s->row, &unit));
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
  PetscCall(KSPSetErrorIfNotConverged(s->iterative, s->shares));
  PetscCall(VecDuplicate(s->row, &s->force_vec));
  PetscCall(VecDuplicate(s->row, &s->gap_vec));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C_j = A^{-1} B^T e_j and column j of W */
static PetscErrorCode MakeColumn(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (s->fresh[j]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
  PetscCall(ConstrainedSolverApplyUnit(s, j, s->columns[j], s->column));
  PetscCall(ComplianceSetColumn(s->compliance, j, 1, s->column));
  s->fresh[j] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a row known to the compliance, at its first level */
PetscErrorCode ConstrainedSolverExtend(ConstrainedSolver s, PetscInt j)
{
  PetscFunctionBegin;
  if (s->global <= FEW_ROWS) {
    s->fresh[j] = (PetscBool)(s->fresh[j] && ComplianceKnows(s->compliance, j)); /* its owner may have forgotten it */
    PetscCall(MakeColumn(s, j));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ConstrainedSolverApplyUnit(s, j, s->product, s->column));
  PetscCall(ComplianceSetColumn(s->compliance, j, 1, s->column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the constraint forces are worth a dense matrix: few of them, or iterations have cost as much as it would */
static PetscErrorCode ChooseDense(ConstrainedSolver s, PetscBool *dense)
{
  PetscInt size, missing = 0;

  PetscFunctionBegin;
  PetscCall(VecGetSize(s->rhs, &size));
  for (PetscInt k = 0; k < s->n; k++) missing += !s->fresh[s->rows[k]];
  *dense = (PetscBool)(s->n <= s->dense_limit && (PetscReal)s->n * size <= MAX_COLUMN_NUMBERS);
  if (s->n > FEW_CONSTRAINTS && s->spent < missing * s->solve_flops + DenseFactorFlops(s->n)) *dense = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for as many constraint forces as the dense matrix has */
static PetscErrorCode MakeRoom(ConstrainedSolver s)
{
  PetscFunctionBegin;
  if (s->factor.room <= s->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3(s->gathered, s->force, s->used));
  s->room = s->factor.room;
  PetscCall(PetscMalloc3(s->room, &s->gathered, s->room, &s->force, s->room, &s->used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constraint forces' matrix, for the rows that are constrained now */
static PetscErrorCode FactorConstraints(ConstrainedSolver s)
{
  const PetscScalar *W;
  const PetscInt    *place;
  PetscInt           leading;
  PetscBool          singular;

  PetscFunctionBegin;
  s->n = 0;
  for (PetscInt j = 0; j < s->global; j++)
    if (s->constrained[j] >= 0) s->rows[s->n++] = j;
  s->dense = PETSC_TRUE;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ChooseDense(s, &s->dense));
  if (!s->dense) {
    /* from zero, so that a step that is made again ends with the same bits, whatever has been solved in between */
    if (!s->iterative) PetscCall(CreateIterative(s));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(DenseFactorResize(&s->factor, s->n, s->global));
  PetscCall(MakeRoom(s));
  for (PetscInt k = 0; k < s->n; k++) PetscCall(MakeColumn(s, s->rows[k]));
  ComplianceGetRows(s->compliance, NULL, NULL, &place);
  ComplianceGetMatrix(s->compliance, 0, &leading, &W);
  for (PetscInt k = 0; k < s->n; k++)
    for (PetscInt l = 0; l < s->n; l++)
      s->factor.values[k * s->n + l] = W[place[s->rows[k]] * leading + place[s->rows[l]]] + (k == l ? s->constrained[s->rows[k]] : 0);
  PetscCall(DenseFactorCompute(&s->factor, &singular));
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

/* A has new values, as that of a nonlinear body has in every Newton iteration */
PetscErrorCode ConstrainedSolverRefactor(ConstrainedSolver s)
{
  PetscFunctionBegin;
  PetscCheck(!s->shares, PetscObjectComm((PetscObject)s->ksp), PETSC_ERR_PLIB, "A compliance that others read belongs to one matrix");
  PetscCall(KSPSetUp(s->ksp));
  PetscCall(PetscArrayzero(s->fresh, s->global));
  PetscCall(FactorConstraints(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x -= A^{-1} B_m^T s with the constraint forces s by conjugate gradients, from those of the last solve on */
static PetscErrorCode ConstrainIteratively(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  PetscScalar *gap;
  PetscInt     iterations;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->gap_vec));
  PetscCall(VecGetArray(s->gap_vec, &gap));
  for (PetscInt i = 0; i < s->local; i++) {
    if (target) gap[i] -= target[i];
    if (s->mine[i] < 0) gap[i] = 0;
  }
  PetscCall(VecRestoreArray(s->gap_vec, &gap));
  PetscCall(KSPSolve(s->iterative, s->gap_vec, s->force_vec));
  PetscCall(CheckSolution(s, s->iterative, s->force_vec));
  PetscCall(KSPGetIterationNumber(s->iterative, &iterations));
  s->spent += (iterations + 1) * s->solve_flops; /* one more for x */
  PetscCall(MatMultTranspose(s->B, s->force_vec, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, s->product));
  PetscCall(VecAXPY(x, -1, s->product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* gathered = B x - target on the constrained rows, on every rank */
static PetscErrorCode GatherGaps(ConstrainedSolver s, Vec x, const PetscScalar target[])
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(s->B, x, s->row));
  PetscCall(VecGetArrayRead(s->row, &row));
  for (PetscInt k = 0; k < s->n; k++) {
    const PetscInt local = s->rows[k] - s->begin;

    s->gathered[k] = local >= 0 && local < s->local ? row[local] - (target ? target[local] : 0) : 0;
  }
  PetscCall(VecRestoreArrayRead(s->row, &row));
  if (s->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, s->gathered, (PetscMPIInt)s->n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)s->ksp)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x, a solution without constraints, becomes that with B_m x = target (this rank's rows; NULL: 0) */
static PetscErrorCode Constrain(ConstrainedSolver s, const PetscScalar target[], Vec x)
{
  PetscFunctionBegin;
  if (!s->n) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->dense) {
    PetscCall(ConstrainIteratively(s, target, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(GatherGaps(s, x, target));
  for (PetscInt k = 0; k < s->n; k++) {
    s->force[k] = -s->gathered[k];
    s->used[k]  = s->columns[s->rows[k]];
  }
  PetscCall(DenseFactorSolve(&s->factor, s->force));
  PetscCall(VecMAXPY(x, s->n, s->force, s->used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverSolve(ConstrainedSolver s, Vec b, Vec x)
{
  PetscFunctionBegin;
  PetscCall(ConstrainedSolverSolveFree(s, b, x));
  PetscCall(Constrain(s, NULL, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = sum of C_j (f_j - s_j), with columns that are all there */
static PetscErrorCode AddColumns(ConstrainedSolver s, Vec x)
{
  const PetscScalar *f = s->changes, *t = s->changes + s->global, *W;
  PetscScalar       *c = s->coefficients;
  const PetscInt    *place;
  PetscInt           leading, used = 0;

  PetscFunctionBegin;
  ComplianceGetRows(s->compliance, NULL, NULL, &place);
  ComplianceGetMatrix(s->compliance, 0, &leading, &W);
  PetscCall(PetscArraycpy(c, f, s->global));
  for (PetscInt k = 0; k < s->n; k++) {
    const PetscInt i = s->rows[k];

    s->force[k] = -t[i];
    for (PetscInt j = 0; j < s->global; j++)
      if (f[j] != 0) s->force[k] += W[place[j] * leading + place[i]] * f[j];
  }
  PetscCall(DenseFactorSolve(&s->factor, s->force));
  for (PetscInt k = 0; k < s->n; k++) c[s->rows[k]] -= s->force[k];
  for (PetscInt j = 0; j < s->global; j++) {
    if (c[j] == 0) continue;
    c[used]         = c[j];
    s->used[used++] = s->columns[j];
  }
  PetscCall(VecZeroEntries(x));
  PetscCall(VecMAXPY(x, used, c, s->used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x with A x = B^T (force - s) and B_m x = target, for forces and targets of this rank's rows: what a change of both changes. By the
   columns where the interface has few rows, else by a solution. */
PetscErrorCode ConstrainedSolverCorrect(ConstrainedSolver s, const PetscScalar force[], const PetscScalar target[], Vec x)
{
  PetscScalar *row;

  PetscFunctionBegin;
  if (s->global <= FEW_ROWS && s->dense) {
    MPI_Comm comm = PetscObjectComm((PetscObject)s->ksp);

    if (s->size > 1) {
      PetscCallMPI(MPI_Allgatherv(force, (PetscMPIInt)s->local, MPIU_SCALAR, s->changes, s->counts, s->offsets, MPIU_SCALAR, comm));
      PetscCallMPI(
          MPI_Allgatherv(target, (PetscMPIInt)s->local, MPIU_SCALAR, s->changes + s->global, s->counts, s->offsets, MPIU_SCALAR, comm));
    } else {
      PetscCall(PetscArraycpy(s->changes, force, s->local));
      PetscCall(PetscArraycpy(s->changes + s->global, target, s->local));
    }
    for (PetscInt j = 0; j < s->global; j++)
      if (s->changes[j] != 0) PetscCall(MakeColumn(s, j));
    PetscCall(AddColumns(s, x));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(s->row, &row));
  PetscCall(PetscArraycpy(row, force, s->local));
  PetscCall(VecRestoreArrayWrite(s->row, &row));
  PetscCall(MatMultTranspose(s->B, s->row, s->rhs));
  PetscCall(ConstrainedSolverSolveFree(s, s->rhs, x));
  PetscCall(Constrain(s, target, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of W are loaded; those of A^{-1} B^T follow from A and B as they are */
static PetscErrorCode RemakeColumns(ConstrainedSolver s)
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j < s->global; j++) {
    if (!s->fresh[j]) continue;
    if (!s->columns[j]) PetscCall(VecDuplicate(s->rhs, &s->columns[j]));
    PetscCall(ConstrainedSolverApplyUnit(s, j, s->columns[j], s->column));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint. A and B, and a compliance that is shared, are loaded before. Collective. */
PetscErrorCode ConstrainedSolverVisit(ConstrainedSolver s, Checkpoint checkpoint)
{
  PetscInt numbers[2] = {s->n, s->dense};

  PetscFunctionBegin;
  PetscCall(CheckpointCheckInts(checkpoint, "rows", 1, &s->global));
  if (!s->shares) PetscCall(ComplianceVisit(s->compliance, checkpoint));
  PetscCall(CheckpointVisitBools(checkpoint, "columns", s->global, s->fresh));
  if (CheckpointLoads(checkpoint)) PetscCall(RemakeColumns(s));
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility", s->local, s->mine));
  PetscCall(CheckpointVisitReals(checkpoint, "flexibility of all", s->global, s->constrained));
  PetscCall(CheckpointVisitInts(checkpoint, "constrained", 2, numbers));
  s->n     = numbers[0];
  s->dense = (PetscBool)numbers[1];
  PetscCall(CheckpointVisitInts(checkpoint, "constrained rows", s->n, s->rows));
  PetscCall(CheckpointVisitReals(checkpoint, "spent", 1, &s->spent));
  PetscCall(DenseFactorVisit(&s->factor, s->global, checkpoint));
  if (!CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(s));
  if (!s->dense && !s->iterative) PetscCall(CreateIterative(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether solutions are the same to the last bit in another run: factors of PETSc's own, or of one rank, are. Iterations and factors that
   several ranks have together are not always. */
PetscErrorCode ConstrainedSolverRepeats(ConstrainedSolver s, PetscBool *repeats)
{
  PetscBool redundant = PETSC_FALSE, lu = PETSC_FALSE, cholesky = PETSC_FALSE;

  PetscFunctionBegin;
  if (s->direct) {
    PetscCall(PetscObjectTypeCompare((PetscObject)s->direct, PCREDUNDANT, &redundant));
    PetscCall(PetscObjectTypeCompare((PetscObject)s->direct, PCLU, &lu));
    PetscCall(PetscObjectTypeCompare((PetscObject)s->direct, PCCHOLESKY, &cholesky));
  }
  *repeats = (PetscBool)(redundant || ((lu || cholesky) && s->size == 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}
