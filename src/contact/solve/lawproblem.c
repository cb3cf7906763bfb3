/*
   The equations of the laws of all rows that may touch: lambda = P(lambda - r y), y = y_0 + S (lambda - lambda_0), r = 1 / S_ii. P is not
   smooth but piecewise so: Newton's method with one of its derivatives (Qi, Sun 1993) finds the solution in a few iterations, or goes round
   in a circle; then Gauss and Seidel's, node by node, which does not. Both are SNES of PETSc (prefixes law_ and law_nodes_). Each rank
   solves the equations of all, which are the same to the last bit.

   S is singular where rows depend on each other, as those of a corner may. So y has the term eps diag(S) (lambda - c) beside it, whose c is
   the last solution, until the term is nothing: single forces are not unique then, what bodies get of them is (proximal point iteration,
   Rockafellar 1976).

   Sources: L. Qi, J. Sun, A nonsmooth version of Newton's method, Mathematical Programming 58 (1993); R. T. Rockafellar, Monotone operators
   and the proximal point algorithm, SIAM Journal on Control and Optimization 14 (1976).
*/
#include "lawproblem.h"
#include <petsc/private/petscimpl.h>
#include <sys/petsccompat.h>

#define VANISHES         1e-12 /* of what rows read, by themselves or by their own force */
#define MOST_PROXIMAL    20
#define TOLERANCE        1e-13 /* of the largest force, and of the largest force that would close what is read */
#define MOST_NEWTON      50
#define FIRST_SWEEPS     5
#define FEW_DENSE        500   /* rows of a dense S whose Jacobian is factored each time it changes */
#define LAG_AFTER_NEXT   -2    /* for PETSc: the preconditioner is made anew once, and then stays */
#define STALE            20    /* nodes whose derivatives have changed since, after which it is: about as many iterations it takes */
#define SPARSE_TOLERANCE 1e-13 /* of linear iterations [parts of the residual] */
#define ENOUGH           0.5   /* or this part of the tolerance of Newton's method */
#define MOST_LINEAR      200   /* round-off may keep them from either */
#define MOST_SWEEPS      5120
#define NODE_ITERATIONS  10 /* for the rows of one node in a sweep */

/* out = S in */
PetscErrorCode LawProblemMultiply(LawProblem *problem, const PetscScalar in[], PetscScalar out[])
{
  const PetscScalar *product;
  PetscScalar       *x;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(problem->in, &x));
  PetscCall(PetscArraycpy(x, in, problem->n));
  PetscCall(VecRestoreArrayWrite(problem->in, &x));
  PetscCall(MatMult(problem->S, problem->in, problem->out));
  PetscCall(VecGetArrayRead(problem->out, &product));
  PetscCall(PetscArraycpy(out, product, problem->n));
  PetscCall(VecRestoreArrayRead(problem->out, &product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What rows read, without the proximal term */
static PetscErrorCode Read(LawProblem *problem, const PetscScalar force[], PetscScalar y[])
{
  PetscScalar *change = problem->work + 2 * problem->n;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) change[i] = force[i] - problem->base[i];
  PetscCall(LawProblemMultiply(problem, change, y));
  for (PetscInt i = 0; i < problem->n; i++) y[i] += problem->read[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 1/r of all rows. Rows across the normal of a node have the same r: else friction would not point against the slip */
static void FindWeights(LawProblem *problem)
{
  problem->largest = 0;
  for (PetscInt i = 0; i < problem->n; i++) problem->largest = PetscMax(problem->largest, problem->diagonal[i]);
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], end = problem->begin[node + 1];
    PetscReal      across = 0;

    for (PetscInt i = first + 1; i < end; i++) across = PetscMax(across, problem->diagonal[i]);
    for (PetscInt i = first; i < end; i++) /* of a row that is held all of the diagonal is zero */
      problem->weight[i] = PetscMax(i == first ? problem->diagonal[i] : across, PETSC_SMALL * problem->largest);
  }
}

/* The trial forces lambda - r y of a node's rows */
static void GetTrial(const LawProblem *problem, PetscInt node, const PetscScalar force[], const PetscScalar y[], PetscReal p[])
{
  for (PetscInt i = problem->begin[node]; i < problem->begin[node + 1]; i++)
    p[i - problem->begin[node]] = PetscRealPart(force[i] - y[i] / problem->weight[i] - problem->proximal * (force[i] - problem->centre[i]));
}

static PetscErrorCode ComputeResidual(SNES snes, Vec X, Vec F, void *ctx)
{
  LawProblem        *problem = (LawProblem *)ctx;
  const PetscScalar *x;
  PetscScalar       *f, *y = problem->work;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayWrite(F, &f));
  PetscCall(Read(problem, x, y));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;
    PetscReal      p[ROW_LAW_ROWS], force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

    GetTrial(problem, node, x, y, p);
    (*problem->law[node]->project)(rows, problem->limit + 2 * node, p, force, derivative);
    for (PetscInt k = 0; k < rows; k++) f[first + k] = x[first + k] - force[k];
  }
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pattern of a sparse matrix; of a dense one there is none */
typedef struct {
  const PetscInt *begin, *columns;
} Pattern;

static PetscErrorCode GetPattern(const LawProblem *problem, Mat A, Pattern *pattern)
{
  PetscInt  n;
  PetscBool done;

  PetscFunctionBegin;
  pattern->begin = pattern->columns = NULL;
  if (problem->sparse) PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &n, &pattern->begin, &pattern->columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestorePattern(const LawProblem *problem, Mat A, Pattern *pattern)
{
  PetscInt  n;
  PetscBool done;

  PetscFunctionBegin;
  if (problem->sparse) PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &n, &pattern->begin, &pattern->columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of S, for reading */
static PetscErrorCode GetS(const LawProblem *problem, Pattern *pattern, const PetscScalar *values[])
{
  PetscFunctionBegin;
  PetscCall(GetPattern(problem, problem->S, pattern));
  if (problem->sparse) PetscCall(MatSeqAIJGetArrayRead(problem->S, values));
  else PetscCall(MatDenseGetArrayRead(problem->S, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestoreS(const LawProblem *problem, Pattern *pattern, const PetscScalar *values[])
{
  PetscFunctionBegin;
  if (problem->sparse) PetscCall(MatSeqAIJRestoreArrayRead(problem->S, values));
  else PetscCall(MatDenseRestoreArrayRead(problem->S, values));
  PetscCall(RestorePattern(problem, problem->S, pattern));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds rows of I - D (I - r (S + eps diag S)) for the rows of one node, D the derivative of P for it. These have their entries in the same
   columns of the Jacobian. A dense S is read by columns, which are its rows. */
static void AddNode(const LawProblem *problem, PetscInt node, Pattern of_S, const PetscScalar S[], Pattern of_J, PetscScalar J[])
{
  const PetscInt   n = problem->n, first = problem->begin[node], rows = problem->begin[node + 1] - first;
  const PetscReal *derivative = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;
  const PetscInt   next       = of_J.begin ? of_J.begin[first + 1] - of_J.begin[first] : 1; /* from a row of the node to the next one */
  const PetscInt   step       = of_J.begin ? 1 : n;                                         /* from a column to the next one */

  J += of_J.begin ? of_J.begin[first] : first;
  for (PetscInt l = 0; l < rows; l++) {
    const PetscInt     i = first + l, count = of_S.begin ? of_S.begin[i + 1] - of_S.begin[i] : n;
    const PetscInt    *columns = of_S.begin ? of_S.columns + of_S.begin[i] : NULL;
    const PetscScalar *values  = S + (of_S.begin ? of_S.begin[i] : i * n);
    PetscInt           at = 0, own = i;

    if (of_J.begin) {
      const PetscInt *all = of_J.columns + of_J.begin[first];

      for (own = 0; all[own] != i; own++);
      for (PetscInt e = 0; e < count; e++) {
        while (all[at] != columns[e]) at++;
        for (PetscInt k = 0; k < rows; k++) J[k * next + at] += derivative[k * rows + l] / problem->weight[i] * values[e];
      }
    } else
      for (PetscInt k = 0; k < rows; k++) {
        const PetscReal part = derivative[k * rows + l] / problem->weight[i];

        for (PetscInt e = 0; e < n && part != 0; e++) J[e * step + k] += part * values[e];
      }
    for (PetscInt k = 0; k < rows; k++) J[k * next + own * step] += (k == l) - derivative[k * rows + l] * (1 - problem->proximal);
  }
}

/* Whether factors of an earlier Jacobian precondition */
static PetscBool IsLagged(const LawProblem *problem)
{
  return (PetscBool)(!problem->sparse && problem->n > FEW_DENSE);
}

/* Whether the Jacobian is that of other derivatives of P than those at the trial forces, which become its own, or of another S */
static PetscErrorCode TakeDerivatives(LawProblem *problem, const PetscScalar force[], const PetscScalar y[], PetscBool *other)
{
  PetscObjectState state;

  PetscFunctionBegin;
  PetscCall(PetscObjectStateGet((PetscObject)problem->S, &state));
  *other               = (PetscBool)(state != problem->jacobian_of);
  problem->jacobian_of = state;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt rows = problem->begin[node + 1] - problem->begin[node];
    PetscReal     *last = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;
    PetscReal      p[ROW_LAW_ROWS], projected[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];
    PetscBool      same;

    GetTrial(problem, node, force, y, p);
    (*problem->law[node]->project)(rows, problem->limit + 2 * node, p, projected, derivative);
    PetscCall(PetscArraycmp(derivative, last, rows * rows, &same));
    if (same) continue;
    PetscCall(PetscArraycpy(last, derivative, rows * rows));
    *other = PETSC_TRUE;
    problem->changes++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One that stays as it is keeps its factors */
static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  LawProblem        *problem = (LawProblem *)ctx;
  const PetscScalar *x, *S;
  PetscScalar       *y = problem->work, *values;
  Pattern            of_S, of_J;
  PetscBool          other = PETSC_FALSE;

  PetscFunctionBegin;
  (void)P;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(Read(problem, x, y));
  PetscCall(TakeDerivatives(problem, x, y, &other));
  PetscCall(VecRestoreArrayRead(X, &x));
  if (!other) PetscFunctionReturn(PETSC_SUCCESS);
  if (IsLagged(problem) && problem->changes > STALE) PetscCall(SNESSetLagPreconditioner(snes, LAG_AFTER_NEXT));
  if (problem->changes > STALE) problem->changes = 0;
  PetscCall(MatZeroEntries(J));
  PetscCall(GetS(problem, &of_S, &S));
  PetscCall(GetPattern(problem, J, &of_J));
  if (problem->sparse) PetscCall(MatSeqAIJGetArray(J, &values));
  else PetscCall(MatDenseGetArray(J, &values));
  for (PetscInt node = 0; node < problem->n_nodes; node++) AddNode(problem, node, of_S, S, of_J, values);
  if (problem->sparse) PetscCall(MatSeqAIJRestoreArray(J, &values));
  else PetscCall(MatDenseRestoreArray(J, &values));
  PetscCall(RestorePattern(problem, J, &of_J));
  PetscCall(RestoreS(problem, &of_S, &S));
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest force, and largest force that would by itself close what a row reads without any [N] */
static PetscReal ForceScale(const LawProblem *problem, const PetscScalar force[])
{
  PetscReal scale = 0;

  for (PetscInt i = 0; i < problem->n; i++) {
    scale = PetscMax(scale, PetscAbsScalar(force[i]));
    scale = PetscMax(scale, PetscAbsScalar(problem->base[i]));
    scale = PetscMax(scale, PetscAbsScalar(problem->read[i]) / problem->weight[i]);
  }
  return scale;
}

static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  const LawProblem  *problem = (const LawProblem *)ctx;
  const PetscScalar *x, *f;
  PetscReal          allowed, atol, rtol;
  Vec                X, F;

  PetscFunctionBegin;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  PetscCall(SNESGetSolution(snes, &X));
  PetscCall(SNESGetFunction(snes, &F, NULL, NULL));
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayRead(F, &f));
  PetscCall(SNESGetTolerances(snes, &atol, &rtol, NULL, NULL, NULL));
  allowed = rtol * ForceScale(problem, x) + atol;
  *reason = SNES_CONVERGED_FNORM_RELATIVE;
  for (PetscInt i = 0; i < problem->n; i++)
    if (PetscAbsScalar(f[i]) > allowed + problem->resolution / problem->weight[i]) *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  PetscCall(VecRestoreArrayRead(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += a S_.i, which is a row of S too */
static void AddColumn(const LawProblem *problem, Pattern of_S, const PetscScalar S[], PetscInt i, PetscScalar a, PetscScalar y[])
{
  if (of_S.begin)
    for (PetscInt e = of_S.begin[i]; e < of_S.begin[i + 1]; e++) y[of_S.columns[e]] += a * S[e];
  else
    for (PetscInt j = 0; j < problem->n; j++) y[j] += a * S[i * problem->n + j];
}

/* One sweep: the rows of each node, one node after the other */
static PetscErrorCode SweepNodes(SNES snes, Vec X, Vec B, void *ctx)
{
  LawProblem        *problem = (LawProblem *)ctx;
  PetscScalar       *x, *y = problem->work;
  const PetscScalar *S;
  Pattern            of_S;

  PetscFunctionBegin;
  (void)snes;
  (void)B;
  PetscCall(GetS(problem, &of_S, &S));
  PetscCall(VecGetArray(X, &x));
  PetscCall(Read(problem, x, y));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;

    for (PetscInt it = 0; it < (rows > 1 ? NODE_ITERATIONS : 1); it++) {
      PetscReal p[ROW_LAW_ROWS], force[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS];

      GetTrial(problem, node, x, y, p);
      (*problem->law[node]->project)(rows, problem->limit + 2 * node, p, force, derivative);
      for (PetscInt k = 0; k < rows; k++) {
        const PetscScalar change = force[k] - x[first + k];

        x[first + k] += change;
        if (change != 0) AddColumn(problem, of_S, S, first + k, change, y);
      }
    }
  }
  PetscCall(VecRestoreArray(X, &x));
  PetscCall(RestoreS(problem, &of_S, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroySolvers(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(SNESDestroy(&problem->newton));
  PetscCall(SNESDestroy(&problem->nodes));
  PetscCall(MatDestroy(&problem->jacobian));
  PetscCall(VecDestroy(&problem->x));
  PetscCall(VecDestroy(&problem->f));
  PetscCall(VecDestroy(&problem->in));
  PetscCall(VecDestroy(&problem->out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSNES(LawProblem *problem, const char prefix[], SNESType type, PetscInt most, SNES *snes)
{
  PetscFunctionBegin;
  PetscCall(SNESCreate(PETSC_COMM_SELF, snes));
  PetscCall(SNESSetOptionsPrefix(*snes, prefix));
  PetscCall(SNESSetFunction(*snes, problem->f, ComputeResidual, problem));
  PetscCall(SNESSetType(*snes, type));
  PetscCall(SNESSetTolerances(*snes, 0, TOLERANCE, 0, most, PETSC_INT_MAX));
  PetscCall(SNESSetConvergenceTest(*snes, TestConvergence, problem, NULL));
  PetscCall(SNESSetErrorIfNotConverged(*snes, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sparse Jacobian has the entries of S in all rows of a node where any has them, and those of the rows of one node */
static PetscErrorCode SetPattern(LawProblem *problem)
{
  PetscInt          *begin, *columns, room = 0;
  const PetscScalar *S;
  Pattern            of_S;

  PetscFunctionBegin;
  PetscCall(GetS(problem, &of_S, &S));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], end = problem->begin[node + 1];

    room += (end - first) * (of_S.begin[end] - of_S.begin[first] + end - first);
  }
  PetscCall(PetscMalloc2(problem->n + 1, &begin, room, &columns));
  begin[0] = 0;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], end = problem->begin[node + 1];
    PetscInt       n = of_S.begin[end] - of_S.begin[first], *mine = columns + begin[first];

    PetscCall(PetscArraycpy(mine, of_S.columns + of_S.begin[first], n));
    for (PetscInt i = first; i < end; i++) mine[n++] = i;
    PetscCall(PetscSortRemoveDupsInt(&n, mine));
    for (PetscInt i = first; i < end; i++) begin[i + 1] = begin[i] + n;
    for (PetscInt i = first + 1; i < end; i++) PetscCall(PetscArraycpy(columns + begin[i], mine, n));
  }
  PetscCall(RestoreS(problem, &of_S, &S));
  PetscCall(MatSeqAIJSetPreallocationCSR(problem->jacobian, begin, columns, NULL));
  PetscCall(PetscFree2(begin, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateJacobian(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->jacobian));
  PetscCall(MatCreate(PETSC_COMM_SELF, &problem->jacobian));
  PetscCall(MatSetSizes(problem->jacobian, problem->n, problem->n, problem->n, problem->n));
  PetscCall(MatSetType(problem->jacobian, problem->sparse ? MATSEQAIJ : MATSEQDENSE));
  if (problem->sparse) PetscCall(SetPattern(problem));
  else PetscCall(MatSetUp(problem->jacobian));
  PetscCall(SNESSetJacobian(problem->newton, problem->jacobian, problem->jacobian, ComputeJacobian, problem));
  problem->jacobian_of = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSolvers(LawProblem *problem)
{
  const PetscBool iterative = (PetscBool)(problem->sparse || IsLagged(problem));

  SNESLineSearch line_search;
  KSP            ksp;
  PC             pc;

  PetscFunctionBegin;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, problem->n, &problem->x));
  PetscCall(VecDuplicate(problem->x, &problem->f));
  PetscCall(VecDuplicate(problem->x, &problem->in));
  PetscCall(VecDuplicate(problem->x, &problem->out));
  PetscCall(CreateSNES(problem, "law_", SNESNEWTONLS, MOST_NEWTON, &problem->newton));
  PetscCall(CreateJacobian(problem));
  PetscCall(SNESGetLineSearch(problem->newton, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESGetKSP(problem->newton, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  /* a sparse S is nearly diagonal: a few iterations, to round-off, take a fraction of the time of factors, incomplete ones too; where a
     dense one is large, those of an earlier Jacobian precondition */
  PetscCall(KSPSetType(ksp, iterative ? KSPGMRES : KSPPREONLY));
  PetscCall(PCSetType(pc, problem->sparse ? PCSOR : PCLU));
  if (IsLagged(problem)) {
    PetscCall(SNESSetLagPreconditioner(problem->newton, LAG_AFTER_NEXT));
    PetscCall(SNESSetLagPreconditionerPersists(problem->newton, PETSC_TRUE));
  }
  if (iterative) {
    PetscCall(KSPGMRESSetPreAllocateVectors(ksp));
    PetscCall(KSPSetPCSide(ksp, PC_RIGHT)); /* its residual is that of Newton's method */
    PetscCall(SNESSetMaxLinearSolveFailures(problem->newton, PETSC_INT_MAX));
  }
  PetscCall(KSPSetTolerances(ksp, SPARSE_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, MOST_LINEAR));
  PetscCall(SNESSetFromOptions(problem->newton));
  PetscCall(CreateSNES(problem, "law_nodes_", SNESNGS, MOST_SWEEPS, &problem->nodes));
  PetscCall(SNESSetNGS(problem->nodes, SweepNodes, problem));
  PetscCall(SNESSetFromOptions(problem->nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the equations of n rows */
PetscErrorCode LawProblemResize(LawProblem *problem, PetscInt n)
{
  PetscFunctionBegin;
  problem->n = n;
  if (n > problem->room) {
    PetscCall(PetscFree7(problem->begin, problem->limit, problem->base, problem->read, problem->centre, problem->force, problem->work));
    PetscCall(PetscFree4(problem->diagonal, problem->weight, problem->law, problem->derivatives));
    problem->room = PetscMax(n, 2 * problem->room);
    PetscCall(PetscMalloc7(problem->room + 1, &problem->begin, 2 * problem->room, &problem->limit, problem->room, &problem->base,
                           problem->room, &problem->read, problem->room, &problem->centre, problem->room, &problem->force,
                           3 * problem->room, &problem->work));
    PetscCall(PetscMalloc4(problem->room, &problem->diagonal, problem->room, &problem->weight, problem->room, &problem->law,
                           ROW_LAW_ROWS * ROW_LAW_ROWS * problem->room, &problem->derivatives));
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
  PetscCall(LawProblemTakeS(problem, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S of the rows there are, which the equations own from now on: the one that they have with other values, or another; solvers are those of
   its size and kind. `begin` is known. */
PetscErrorCode LawProblemTakeS(LawProblem *problem, Mat *S)
{
  const PetscBool    another = (PetscBool)(*S != problem->S);
  const PetscScalar *diagonal;
  PetscBool          dense;

  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->S));
  problem->S = *S;
  *S         = NULL;
  PetscCall(PetscObjectTypeCompare((PetscObject)problem->S, MATSEQDENSE, &dense));
  if (problem->n != problem->rows || problem->sparse == dense) {
    problem->sparse = (PetscBool)!dense;
    PetscCall(DestroySolvers(problem));
    PetscCall(CreateSolvers(problem));
    problem->rows = problem->n;
  } else if (another && problem->sparse) PetscCall(CreateJacobian(problem));
  if (another) problem->jacobian_of = -1;
  PetscCall(MatGetDiagonal(problem->S, problem->out));
  PetscCall(VecGetArrayRead(problem->out, &diagonal));
  for (PetscInt i = 0; i < problem->n; i++) problem->diagonal[i] = PetscRealPart(diagonal[i]);
  PetscCall(VecRestoreArrayRead(problem->out, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By one of the solvers, from `force` on */
static PetscErrorCode SolveBy(LawProblem *problem, SNES snes, SNESConvergedReason *reason)
{
  PetscScalar *x;
  PetscInt     iterations;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(problem->x, &x));
  PetscCall(PetscArraycpy(x, problem->force, problem->n));
  PetscCall(VecRestoreArrayWrite(problem->x, &x));
  PetscCall(SNESSolve(snes, NULL, problem->x));
  PetscCall(SNESGetConvergedReason(snes, reason));
  PetscCall(SNESGetIterationNumber(snes, &iterations));
  problem->iterations += iterations;
  PetscCall(VecGetArray(problem->x, &x));
  PetscCall(PetscArraycpy(problem->force, x, problem->n));
  PetscCall(VecRestoreArray(problem->x, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By Newton's method; where it goes round in a circle, from where a few sweeps node by node lead, more of them each time */
static PetscErrorCode SolveOnce(LawProblem *problem)
{
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscScalar        *start  = problem->work + problem->n;
  PetscInt            sweeps = FIRST_SWEEPS, most;
  PetscReal           rtol;
  KSP                 ksp;

  PetscFunctionBegin;
  PetscCall(SNESGetKSP(problem->newton, &ksp));
  PetscCall(SNESGetTolerances(problem->newton, NULL, &rtol, NULL, NULL, NULL));
  PetscCall(KSPSetTolerances(ksp, PETSC_CURRENT, ENOUGH * rtol * ForceScale(problem, problem->force), PETSC_CURRENT, PETSC_CURRENT));
  PetscCall(PetscArraycpy(start, problem->force, problem->n));
  PetscCall(SNESGetTolerances(problem->nodes, NULL, NULL, NULL, &most, NULL));
  PetscCall(SolveBy(problem, problem->newton, &reason));
  for (; reason < 0 && sweeps <= most; sweeps *= 4) {
    PetscCall(PetscInfo(problem->newton,
                        "law of %" PetscInt_FMT " rows: %s after %" PetscInt_FMT " iterations, now %" PetscInt_FMT " sweeps node by node\n",
                        problem->n, SNESConvergedReasons[reason], problem->iterations, sweeps));
    problem->by_nodes = PETSC_TRUE;
    PetscCall(PetscArraycpy(problem->force, start, problem->n));
    PetscCall(SNESSetTolerances(problem->nodes, PETSC_CURRENT, PETSC_CURRENT, 0, sweeps, PETSC_INT_MAX));
    PetscCall(SolveBy(problem, problem->nodes, &reason));
    if (reason == SNES_DIVERGED_NAN) break;
    PetscCall(PetscArraycpy(start, problem->force, problem->n));
    if (reason < 0 || reason == SNES_CONVERGED_ITS) PetscCall(SolveBy(problem, problem->newton, &reason));
  }
  PetscCall(SNESSetTolerances(problem->nodes, PETSC_CURRENT, PETSC_CURRENT, 0, most, PETSC_INT_MAX));
  problem->solved = (PetscBool)(reason > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the proximal term is nothing beside a part of what rows read, or is as little as nobody knows of that: where no forces close the
   rows it never is, and forces grow for ever */
static PetscBool ProximalVanishes(const LawProblem *problem, PetscReal part)
{
  PetscReal off = 0, scale = 0;

  for (PetscInt i = 0; i < problem->n; i++) {
    off   = PetscMax(off, problem->proximal * problem->weight[i] * PetscAbsScalar(problem->force[i] - problem->centre[i]));
    scale = PetscMax(scale, PetscMax(PetscAbsScalar(problem->read[i]), PetscAbsScalar(problem->diagonal[i] * problem->force[i])));
  }
  return (PetscBool)(off <= part * scale + problem->resolution);
}

/* The forces of all rows with one weight of the proximal term, from `force` on; whether it has vanished or can, and does so slowly */
static PetscErrorCode SolveProximal(LawProblem *problem, PetscBool *slow)
{
  PetscFunctionBegin;
  *slow = PETSC_FALSE;
  for (PetscInt k = 0; k < MOST_PROXIMAL; k++) {
    PetscReal pull = 0;

    PetscCall(PetscArraycpy(problem->centre, problem->force, problem->n));
    PetscCall(SolveOnce(problem));
    if (!problem->solved) PetscFunctionReturn(PETSC_SUCCESS);
    for (PetscInt i = 0; i < problem->n; i++) pull = PetscMax(pull, PetscAbsScalar(problem->force[i] - problem->centre[i]));
    if (problem->proximal * pull <= TOLERANCE * ForceScale(problem, problem->force) || ProximalVanishes(problem, 0))
      PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(PetscInfo(problem->newton, "law of %" PetscInt_FMT " rows: forces of dependent rows change by %g N, solved again\n",
                        problem->n, (double)pull));
  }
  problem->solved = ProximalVanishes(problem, VANISHES);
  *slow           = (PetscBool)!problem->solved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of all rows, from `force` on, and whether they have been found. Where a weight of the proximal term is too small for Newton's
   method, or so large that the term does not vanish, which is where the stiffnesses of bodies are far apart, there are others. */
PetscErrorCode LawProblemSolve(LawProblem *problem)
{
  const PetscReal proximal[] = {1e-8, 1e-10, 1e-6}; /* of the diagonal of S */
  PetscBool       slow       = PETSC_TRUE;

  PetscFunctionBegin;
  problem->iterations = 0;
  problem->by_nodes = problem->solved = PETSC_FALSE;
  FindWeights(problem);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(proximal) && !problem->solved; k++) {
    if (problem->proximal != proximal[k]) problem->jacobian_of = -1; /* it has this weight in it */
    problem->proximal = proximal[k];
    if (!slow) PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
    PetscCall(SolveProximal(problem, &slow));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemDestroy(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(DestroySolvers(problem));
  PetscCall(PetscFree7(problem->begin, problem->limit, problem->base, problem->read, problem->centre, problem->force, problem->work));
  PetscCall(PetscFree4(problem->diagonal, problem->weight, problem->law, problem->derivatives));
  PetscCall(MatDestroy(&problem->S));
  PetscFunctionReturn(PETSC_SUCCESS);
}
