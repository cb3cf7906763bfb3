/* The equations of the laws of all rows that may touch: lambda = P(lambda - r y), y = y_0 + S (lambda - lambda_0), r = 1 / S_ii. P is not
   smooth but piecewise so: Newton's method with one of its derivatives (Qi, Sun 1993) finds the solution in a few iterations, or goes round
   in a circle; then Gauss and Seidel's, node by node, which does not. Both are SNES of PETSc (prefixes law_ and law_nodes_). Each rank
   solves the equations of all, which are the same to the last bit.

   S is singular where rows depend on each other, as those of a corner may. So y has the term eps diag(S) (lambda - c) beside it, whose c is
   the last solution, until the term is nothing: single forces are not unique then, what bodies get of them is (proximal point iteration,
   Rockafellar 1976).

   Sources: L. Qi, J. Sun, A nonsmooth version of Newton's method, Mathematical Programming 58 (1993); S. C. Eisenstat, H. F. Walker,
   Choosing the forcing terms in an inexact Newton method, SIAM Journal on Scientific Computing 17 (1996); R. T. Rockafellar, Monotone
   operators and the proximal point algorithm, SIAM Journal on Control and Optimization 14 (1976). */
#include "lawimpl.h"
#include <petsc/private/petscimpl.h>
#include <sys/optionstext.h>
#include <sys/petsccompat.h>

#define LAW_PREFIX       "law_" /* of options of the solver */
#define MOST_NEWTON      50
#define SPARSE_TOLERANCE 1e-13 /* of linear iterations [parts of the residual] */
#define MOST_LINEAR      200   /* round-off may keep them from either */
#define MOST_SWEEPS      5120
#define BY_PREDICTION    1 /* choice of Eisenstat and Walker: after a residual that the linear model foretold, the iteration is the last */
#define FORCING          1e-2 /* that linear iterations leave of a residual, at most: less as Newton's method gets faster */
#define NODE_ITERATIONS  10   /* for the rows of one node in a sweep */

/* f = lambda - P(lambda - r y) */
static PetscErrorCode Miss(LawProblem *problem, const PetscScalar x[], PetscScalar f[])
{
  PetscScalar *y = problem->work;

  PetscFunctionBegin;
  PetscCall(LawProblemRead(problem, x, y));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;
    PetscReal      force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

    LawProblemProject(problem, node, x, y, force, derivative);
    for (PetscInt k = 0; k < rows; k++) f[first + k] = x[first + k] - force[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeResidual(SNES snes, Vec X, Vec F, void *ctx)
{
  const PetscScalar *x;
  PetscScalar       *f;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayWrite(F, &f));
  PetscCall(Miss((LawProblem *)ctx, x, f));
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest force, and largest force that would by itself close what a row reads without any [N]. A row that no force moves tells none. */
PetscReal LawProblemForceScale(const LawProblem *problem, const PetscScalar force[])
{
  PetscReal scale = 0;

  for (PetscInt i = 0; i < problem->n; i++) {
    scale = PetscMax(scale, PetscAbsScalar(force[i]));
    scale = PetscMax(scale, PetscAbsScalar(problem->base[i]));
    if (problem->diagonal[i] > PETSC_SMALL * problem->largest)
      scale = PetscMax(scale, PetscAbsScalar(problem->read[i]) / problem->weight[i]);
  }
  return scale;
}

/* Whether f is within the tolerances of Newton's method, and what is read to what it is right to */
static PetscErrorCode IsSmall(const LawProblem *problem, const PetscScalar x[], const PetscScalar f[], PetscBool *is_small)
{
  PetscReal allowed, atol, rtol;

  PetscFunctionBegin;
  PetscCall(SNESGetTolerances(problem->newton, &atol, &rtol, NULL, NULL, NULL));
  allowed   = rtol * LawProblemForceScale(problem, x) + atol;
  *is_small = PETSC_TRUE;
  for (PetscInt i = 0; i < problem->n && *is_small; i++)
    *is_small = (PetscBool)(PetscAbsScalar(f[i]) <= allowed + problem->resolution / problem->weight[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  const PetscScalar *x, *f;
  PetscBool          is_small;
  Vec                X, F;

  PetscFunctionBegin;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  PetscCall(SNESGetSolution(snes, &X));
  PetscCall(SNESGetFunction(snes, &F, NULL, NULL));
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(IsSmall((const LawProblem *)ctx, x, f, &is_small));
  *reason = is_small ? SNES_CONVERGED_FNORM_RELATIVE : SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* LawProblemHolds - whether the law holds under `force` already, as in the last pass of a step: cheaper than PETSc's solvers find out. */
PetscErrorCode LawProblemHolds(LawProblem *problem, PetscBool *holds)
{
  PetscScalar *f = problem->work + problem->n;

  PetscFunctionBegin;
  PetscCall(Miss(problem, problem->force, f));
  PetscCall(IsSmall(problem, problem->force, f, holds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes off the forces of nodes that have gone farther away than `gap` [m]: those within the tolerances would stay for ever */
PetscErrorCode LawProblemLetGo(LawProblem *problem, PetscReal gap)
{
  PetscScalar *y = problem->work, *f = problem->work + problem->n, *force = problem->force;

  PetscFunctionBegin;
  PetscCall(Miss(problem, force, f));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], end = problem->begin[node + 1];
    PetscBool      away = (PetscBool)(PetscRealPart(y[first]) > gap);

    for (PetscInt i = first; i < end; i++) away = (PetscBool)(away && f[i] == force[i]); /* the law has none */
    for (PetscInt i = first; i < end && away; i++) force[i] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += a S_.i, which is a row of a sparse S too; `dense`: entries of one that is not */
static PetscErrorCode AddColumn(const LawProblem *problem, const PetscScalar dense[], PetscInt i, PetscScalar a, PetscScalar y[])
{
  PetscInt           n;
  const PetscInt    *rows;
  const PetscScalar *values;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < problem->n && dense; j++) y[j] += a * dense[i * problem->n + j];
  if (dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetRow(problem->entries, i, &n, &rows, &values));
  for (PetscInt e = 0; e < n; e++) y[rows[e]] += a * values[e];
  PetscCall(MatRestoreRow(problem->entries, i, &n, &rows, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One sweep: the rows of each node, one node after the other */
PetscErrorCode LawProblemSweep(LawProblem *problem, PetscScalar x[])
{
  PetscScalar       *y     = problem->work;
  const PetscScalar *dense = NULL;

  PetscFunctionBegin;
  if (!problem->sparse) PetscCall(MatDenseGetArrayRead(problem->entries, &dense));
  PetscCall(LawProblemRead(problem, x, y));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;

    for (PetscInt it = 0, moves = 1; moves && it < (rows > 1 ? NODE_ITERATIONS : 1); it++) {
      PetscReal force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

      LawProblemProject(problem, node, x, y, force, derivative);
      moves = 0;
      for (PetscInt k = 0; k < rows; k++) {
        const PetscScalar change = force[k] - x[first + k];

        if (change == 0) continue;
        x[first + k] = force[k];
        moves        = 1;
        PetscCall(AddColumn(problem, dense, first + k, change, y));
      }
    }
  }
  if (dense) PetscCall(MatDenseRestoreArrayRead(problem->entries, &dense));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SweepNodes(SNES snes, Vec X, Vec B, void *ctx)
{
  PetscScalar *x;

  PetscFunctionBegin;
  (void)snes;
  (void)B;
  PetscCall(VecGetArray(X, &x));
  PetscCall(LawProblemSweep((LawProblem *)ctx, x));
  PetscCall(VecRestoreArray(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSNES(LawProblem *problem, const char prefix[], SNESType type, PetscInt most, SNES *snes)
{
  PetscFunctionBegin;
  PetscCall(SNESDestroy(snes));
  PetscCall(SNESCreate(PETSC_COMM_SELF, snes));
  PetscCall(SNESSetOptionsPrefix(*snes, prefix));
  PetscCall(SNESSetFunction(*snes, NULL, ComputeResidual, problem));
  PetscCall(SNESSetType(*snes, type));
  PetscCall(SNESSetTolerances(*snes, 0, LawProblemHasProducts(problem) ? PetscMax(problem->rtol, LAW_TOLERANCE) : LAW_TOLERANCE, 0, most,
                              PETSC_INT_MAX));
  PetscCall(SNESSetConvergenceTest(*snes, TestConvergence, problem, NULL));
  PetscCall(SNESSetErrorIfNotConverged(*snes, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSolvers(LawProblem *problem)
{
  const PetscBool iterative = (PetscBool)(problem->sparse || LawProblemIsLagged(problem));
  SNESLineSearch  line_search;
  KSP             ksp;
  PC              pc;

  PetscFunctionBegin;
  PetscCall(OptionsTextHas("-" LAW_PREFIX, &problem->asked));
  PetscCall(CreateSNES(problem, LAW_PREFIX, SNESNEWTONLS, MOST_NEWTON, &problem->newton));
  PetscCall(SNESGetLineSearch(problem->newton, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESGetKSP(problem->newton, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  /* a sparse S is nearly diagonal: a few iterations, to round-off, are faster than factors; where a dense one is large, those of an earlier
     Jacobian precondition; where it is products, incomplete ones of that of a matrix near it, whose entries fall off fast */
  PetscCall(KSPSetType(ksp, LawProblemHasProducts(problem) ? KSPFGMRES : iterative ? KSPGMRES : KSPPREONLY));
  PetscCall(PCSetType(pc, LawProblemHasProducts(problem) ? PCILU : problem->sparse ? PCSOR : PCLU));
  if (LawProblemIsLagged(problem)) {
    PetscCall(SNESSetLagPreconditioner(problem->newton, LAW_LAG_AFTER_NEXT));
    PetscCall(SNESSetLagPreconditionerPersists(problem->newton, PETSC_TRUE));
  }
  if (iterative) {
    PetscCall(KSPGMRESSetPreAllocateVectors(ksp));
    PetscCall(KSPSetPCSide(ksp, PC_RIGHT)); /* its residual is that of Newton's method */
    PetscCall(SNESSetMaxLinearSolveFailures(problem->newton, PETSC_INT_MAX));
  }
  if (LawProblemIsLagged(problem)) { /* each iteration takes a product with a large S: no more of them than Newton's method is good for */
    PetscCall(SNESKSPSetUseEW(problem->newton, PETSC_TRUE));
    PetscCall(SNESKSPSetParametersEW(problem->newton, BY_PREDICTION, FORCING, FORCING, PETSC_CURRENT, PETSC_CURRENT, PETSC_CURRENT,
                                     PETSC_CURRENT));
  }
  if (LawProblemHasProducts(problem)) PetscCall(KSPSetMinimumIterations(ksp, 1)); /* one row alone may miss its tolerance */
  PetscCall(KSPSetTolerances(ksp, SPARSE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, MOST_LINEAR));
  PetscCall(SNESSetFromOptions(problem->newton));
  PetscCall(CreateSNES(problem, "law_nodes_", SNESNGS, MOST_SWEEPS, &problem->nodes));
  PetscCall(SNESSetNGS(problem->nodes, SweepNodes, problem));
  PetscCall(SNESSetFromOptions(problem->nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyVecs(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->derivative));
  PetscCall(MatDestroy(&problem->jacobian));
  PetscCall(MatDestroy(&problem->operator));
  PetscCall(VecDestroy(&problem->x));
  PetscCall(VecDestroy(&problem->y));
  PetscCall(VecDestroy(&problem->in));
  PetscCall(VecDestroy(&problem->out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Vectors and matrices of solvers for the rows there are */
static PetscErrorCode ResizeSolvers(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(DestroyVecs(problem));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, problem->n, &problem->x));
  PetscCall(VecDuplicate(problem->x, &problem->y));
  PetscCall(VecDuplicate(problem->x, &problem->in));
  PetscCall(VecDuplicate(problem->x, &problem->out));
  PetscCall(SNESReset(problem->newton));
  PetscCall(SNESReset(problem->nodes));
  PetscCall(LawProblemCreateJacobian(problem));
  problem->rows = problem->n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemResize(LawProblem *problem, PetscInt n)
{
  PetscFunctionBegin;
  problem->n = n;
  if (n > problem->room) {
    PetscCall(PetscFree7(problem->begin, problem->limit, problem->base, problem->read, problem->centre, problem->force, problem->work));
    PetscCall(PetscFree5(problem->diagonal, problem->weight, problem->law, problem->glue, problem->derivatives));
    problem->room = PetscMax(n, 2 * problem->room);
    PetscCall(PetscMalloc7(problem->room + 1, &problem->begin, 2 * problem->room, &problem->limit, problem->room, &problem->base,
                           problem->room, &problem->read, problem->room, &problem->centre, problem->room, &problem->force,
                           3 * problem->room, &problem->work));
    PetscCall(PetscMalloc5(problem->room, &problem->diagonal, problem->room, &problem->weight, problem->room, &problem->law, problem->room,
                           &problem->glue, ROW_LAW_ROWS * ROW_LAW_ROWS * problem->room, &problem->derivatives));
    PetscCall(PetscArrayzero(problem->derivatives, ROW_LAW_ROWS * ROW_LAW_ROWS * problem->room)); /* compared before they are set */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solvers for one row, that read their options */
PetscErrorCode LawProblemSetUp(LawProblem *problem)
{
  Mat S;

  PetscFunctionBegin;
  PetscCall(LawProblemResize(problem, 1));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, 1, 1, NULL, &S));
  PetscCall(LawProblemTakeS(problem, &S, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S of the rows there are, which the equations own from now on: the one that they have with other values, or another; solvers are those of
   its size and kind. `near`: (NULL where S has entries) a sparse matrix for S that is only multiplied with. `begin` is known. */
PetscErrorCode LawProblemTakeS(LawProblem *problem, Mat *S, Mat *near)
{
  const PetscBool    products = LawProblemHasProducts(problem), lagged = (PetscBool)(problem->operator!= NULL);
  const PetscBool    another = (PetscBool)(*S != problem->S), sparse = problem->sparse;
  const PetscScalar *diagonal;
  PetscBool          dense;

  PetscFunctionBegin;
  if (!near) PetscCall(PetscObjectReference((PetscObject)*S));
  PetscCall(MatDestroy(&problem->S));
  PetscCall(MatDestroy(&problem->entries));
  problem->S       = *S;
  problem->entries = near ? *near : *S;
  *S               = NULL;
  if (near) *near = NULL;
  PetscCall(PetscObjectTypeCompare((PetscObject)problem->entries, MATSEQDENSE, &dense));
  problem->sparse = (PetscBool)!dense;
  /* to read options anew costs more than a small solution */
  if (!problem->newton || sparse == dense || products != LawProblemHasProducts(problem) || lagged != LawProblemIsLagged(problem)) {
    PetscCall(CreateSolvers(problem));
    PetscCall(ResizeSolvers(problem));
  } else if (problem->n != problem->rows) PetscCall(ResizeSolvers(problem));
  else if (another && problem->sparse) PetscCall(LawProblemCreateJacobian(problem));
  if (another) problem->jacobian_of = -1;
  problem->product_of = -1;
  PetscCall(MatGetDiagonal(problem->entries, problem->out));
  PetscCall(VecGetArrayRead(problem->out, &diagonal));
  for (PetscInt i = 0; i < problem->n; i++) problem->diagonal[i] = PetscRealPart(diagonal[i]);
  PetscCall(VecRestoreArrayRead(problem->out, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemDestroy(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(SNESDestroy(&problem->newton));
  PetscCall(SNESDestroy(&problem->nodes));
  PetscCall(DestroyVecs(problem));
  PetscCall(PetscFree7(problem->begin, problem->limit, problem->base, problem->read, problem->centre, problem->force, problem->work));
  PetscCall(PetscFree5(problem->diagonal, problem->weight, problem->law, problem->glue, problem->derivatives));
  PetscCall(MatDestroy(&problem->S));
  PetscCall(MatDestroy(&problem->entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}
