/* How A is solved: by which factors or iterations, what a solution costs, and whether another run has the same bits. */
#include "constrainedsolverimpl.h"
#include <sys/petsccompat.h>

/* Bodies up to this size are factored whole on every rank; larger ones by MUMPS */
#define MAX_REDUNDANT_SIZE 5000
/* On one rank, PETSc's own factorisation is an order of magnitude faster than MUMPS for small bodies: up to these sizes, by dimension. In
   more dimensions factors fill in more, and MUMPS has the better kernels and orderings. A square of 10^4 unknowns takes a third of the time
   of MUMPS for a solution and 0.9 of it for its factors, a strip of 4 x 640 elements 0.15 and 0.6, a cube of 12^3 elements 1.3 and 3.
   Cholesky's factors have half the memory of LU factors, and take a third to 1.3 times their time for a solution, as processors have it,
   in chains twice as long, in small solids 1.3 to 2 times. In the plane the law of rows of blocks of 1e13 on 1e7 Pa is not solved by LU. */
static const PetscInt max_sequential_size[] = {50000, 50000, 12000, 1500};
static const PCType   own_factors[]         = {PCLU, PCLU, PCCHOLESKY, PCLU};
/* Memory that factors may take beyond what MUMPS expects [%]. Its own 20 were too few on three ranks that divide a ball of which a small
   part has most elements: what it expects leaves out what moves between ranks as they go, and what pivots of indefinite matrices take.
   Pages that are not used are not taken. */
#define MUMPS_MEMORY 100
/* Right-hand sides that MUMPS solves for together: its factors are larger than any cache, and are read once for all of them */
#define TOGETHER 64
/* In three dimensions factors of bodies larger than this take more memory and time than multigrid */
#define MAX_DIRECT_SIZE_3D 150000
/* of multigrid: what is left of the residual must not show in energies and momenta */
#define ITERATIVE_TOLERANCE 1e-12
/* and iterations of it, of which bodies of 10^4 to 3e5 unknowns take 18 to 20 */
#define ITERATIVE_MAX_IT 1000
/* Iterations by which the smoothers of multigrid estimate the largest eigenvalue, which they must not underrate. PETSc takes over the
   estimate of 10 iterations that smoothed the aggregates: too few where stiffnesses jump. Around a core 10^4 times as stiff multigrid
   became indefinite; 20 iterations were enough for all jumps that were tried, up to 10^6, and so were they in Newton's method. */
#define ESTIMATE_OPTION     "mg_levels_esteig_ksp_max_it"
#define ESTIMATE_ITERATIONS "20"
/* Operations of one solution, in parts of the entries of the factors. Cholesky's are one triangle of two. LU's are both, but a solution
   takes twice as long for an operation as sums of columns, with which it is compared, or more (1.2 and 3.8 in a nanosecond). */
#define FLOPS_OF_ENTRY 4
/* The same where PETSc does not tell how many entries there are, as with multigrid: in parts of the unknowns, of the order of what 20
   iterations of conjugate gradients with a matrix of 81 entries in a row take */
#define FLOPS_OF_UNKNOWN 4000

static PetscErrorCode IsOnOneRank(Mat A, PetscMPIInt size, PetscBool *one)
{
  const PetscInt *ranges;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRanges(A, &ranges));
  *one = PETSC_FALSE;
  for (PetscMPIInt r = 0; r < size && size > 1; r++)
    if (ranges[r] == 0 && ranges[r + 1] == ranges[size] && ranges[size] > 0) *one = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of MUMPS, of the matrix that a preconditioner has. All matrices here are symmetric. */
PetscErrorCode ConstrainedSolverChooseMUMPS(PC pc)
{
  Mat F;

  PetscFunctionBegin;
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &F));
  PetscCall(MatMumpsSetIcntl(F, 14, MUMPS_MEMORY));
  PetscCall(MatMumpsSetIcntl(F, 27, TOGETHER));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc's own factors */
static PetscErrorCode ChooseOwn(PC pc, PetscInt dim)
{
  PetscFunctionBegin;
  PetscCall(PCSetType(pc, own_factors[dim]));
  PetscCall(PCFactorSetZeroPivot(pc, 0)); /* PETSc's default is 2e-14, whatever the unit of the matrix */
  PetscCall(PCFactorSetMatOrderingType(pc, MATORDERINGND));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ChooseSequential(PC pc, PetscInt n, PetscInt dim)
{
  PetscFunctionBegin;
  if (n > max_sequential_size[dim]) PetscCall(ConstrainedSolverChooseMUMPS(pc));
  else PetscCall(ChooseOwn(pc, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix of one rank is factored and solved with there, without a message: the block of each other rank is empty */
static PetscErrorCode ChooseOneRank(PC pc, Mat A, PetscInt n, PetscInt dim)
{
  KSP *inner;

  PetscFunctionBegin;
  PetscCall(PCSetType(pc, PCBJACOBI));
  PetscCall(PCSetOperators(pc, A, A));
  PetscCall(PCSetUp(pc)); /* makes the solver of the block, which is set up later */
  PetscCall(PCBJacobiGetSubKSP(pc, NULL, NULL, &inner));
  PetscCall(KSPSetType(inner[0], KSPPREONLY));
  PetscCall(KSPGetPC(inner[0], &pc));
  PetscCall(ChooseSequential(pc, n, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConstrainedSolverChoose(KSP ksp, Mat A, PetscInt dim)
{
  PetscMPIInt size;
  PetscInt    n;
  PetscBool   one = PETSC_FALSE;
  PC          pc;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)ksp), &size));
  PetscCall(IsOnOneRank(A, size, &one));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(KSPSetTolerances(ksp, ITERATIVE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, ITERATIVE_MAX_IT));
  if (dim == 3 && n > MAX_DIRECT_SIZE_3D) {
    PetscCall(KSPSetType(ksp, KSPCG));
    PetscCall(PCSetType(pc, PCGAMG));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  if (one) {
    PetscCall(ChooseOneRank(pc, A, n, dim));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (size > 1 && n <= MAX_REDUNDANT_SIZE) {
    KSP inner;

    PetscCall(PCSetType(pc, PCREDUNDANT));
    PetscCall(PCRedundantGetKSP(pc, &inner));
    PetscCall(KSPSetType(inner, KSPPREONLY));
    PetscCall(KSPGetPC(inner, &pc));
    PetscCall(ChooseOwn(pc, dim));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (size > 1) PetscCall(ConstrainedSolverChooseMUMPS(pc));
  else PetscCall(ChooseSequential(pc, n, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What has to be said of the solver that options have chosen. The iterations of multigrid's estimate can be told by an option alone. */
PetscErrorCode ConstrainedSolverAdjust(KSP ksp)
{
  const char *prefix;
  char        name[256];
  PetscBool   multigrid, taken_over, given;
  PC          pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCGAMG, &multigrid));
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  PetscCall(PetscOptionsHasName(NULL, prefix, "-pc_gamg_use_sa_esteig", &taken_over));
  if (!multigrid || taken_over) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PCGAMGSetUseSAEstEig(pc, PETSC_FALSE));
  PetscCall(PetscOptionsHasName(NULL, prefix, "-" ESTIMATE_OPTION, &given));
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s" ESTIMATE_OPTION, prefix ? prefix : ""));
  if (!given) PetscCall(PetscOptionsSetValue(NULL, name, ESTIMATE_ITERATIONS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which preconditioner has factors of A, if any has: `direct`, or the one of the block where one of several ranks has all of A */
PetscErrorCode ConstrainedSolverFindFactors(ConstrainedSolver s, Mat A)
{
  PetscBool     blocks, factored;
  KSP          *inner;
  PC            pc = s->direct;
  MatSolverType package;

  PetscFunctionBegin;
  if (!pc) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCBJACOBI, &blocks));
  if (blocks) PetscCall(IsOnOneRank(A, s->size, &s->home));
  if (s->home) {
    PetscCall(PCBJacobiGetSubKSP(pc, NULL, NULL, &inner));
    PetscCall(PetscObjectTypeCompare((PetscObject)inner[0], KSPPREONLY, &s->home));
    if (s->home) PetscCall(KSPGetPC(inner[0], &pc));
  }
  PetscCall(PetscObjectTypeCompareAny((PetscObject)pc, &factored, PCLU, PCCHOLESKY, ""));
  if (!factored) PetscFunctionReturn(PETSC_SUCCESS);
  s->factors = pc;
  if (s->home) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PCFactorGetMatSolverType(pc, &package));
  PetscCall(PetscStrcmp(package, MATSOLVERMUMPS, &s->mumps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether one of several ranks has A and solves with it without a message, as long as no row is constrained */
PetscBool ConstrainedSolverIsHome(ConstrainedSolver s)
{
  return s->home;
}

/* What one solution costs, to compare it with columns; counted, so that a run repeats */
PetscErrorCode ConstrainedSolverCountFlops(ConstrainedSolver s, Mat A)
{
  PetscInt       n, mine;
  PetscLogDouble entries = 0;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatGetLocalSize(A, &mine, NULL));
  s->solve_flops = (PetscLogDouble)FLOPS_OF_UNKNOWN * n;
  if (!s->factors) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s->home || mine) {
    MatInfo info;
    Mat     factors;

    PetscCall(PCFactorGetMatrix(s->factors, &factors));
    PetscCall(MatGetInfo(factors, MAT_GLOBAL_SUM, &info));
    entries = info.nz_used;
  }
  if (s->home) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &entries, 1, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)s->ksp)));
  if (entries > 0) s->solve_flops = FLOPS_OF_ENTRY * entries;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether solutions are the same to the last bit in another run: by factors of PETSc's own, or of one rank, not always by others. */
PetscErrorCode ConstrainedSolverRepeats(ConstrainedSolver s, PetscBool *repeats)
{
  PetscFunctionBegin;
  *repeats = PETSC_FALSE;
  if (!s->direct) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->size > 1) PetscCall(PetscObjectTypeCompareAny((PetscObject)s->direct, repeats, PCREDUNDANT, PCBJACOBI, ""));
  else PetscCall(PetscObjectTypeCompareAny((PetscObject)s->direct, repeats, PCREDUNDANT, PCLU, PCCHOLESKY, ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}
