/* The Jacobian of the equations of laws, in known patterns and as matrices lie in memory; see lawproblem.c. */
#include "lawimpl.h"
#include <petsc/private/petscimpl.h>

#define FEW_DENSE    500 /* rows of a dense S whose Jacobian is factored each time it changes */
#define STALE_DENSE  20  /* iterations of the last linear solution beyond which they have grown stale: new ones cost more than 80, */
#define STALE_SPARSE 5   /* and incomplete ones, where S is products, less than one */

static PetscErrorCode GetPattern(const LawProblem *problem, Mat A, LawPattern *pattern)
{
  PetscInt  n;
  PetscBool done;

  PetscFunctionBegin;
  pattern->begin = pattern->columns = NULL;
  if (problem->sparse) PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &n, &pattern->begin, &pattern->columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestorePattern(const LawProblem *problem, Mat A, LawPattern *pattern)
{
  PetscInt  n;
  PetscBool done;

  PetscFunctionBegin;
  if (problem->sparse) PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &n, &pattern->begin, &pattern->columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of S, or of what is near it, for reading */
PetscErrorCode LawProblemGetS(const LawProblem *problem, LawPattern *pattern, const PetscScalar *values[])
{
  PetscFunctionBegin;
  PetscCall(GetPattern(problem, problem->entries, pattern));
  if (problem->sparse) PetscCall(MatSeqAIJGetArrayRead(problem->entries, values));
  else PetscCall(MatDenseGetArrayRead(problem->entries, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemRestoreS(const LawProblem *problem, LawPattern *pattern, const PetscScalar *values[])
{
  PetscFunctionBegin;
  if (problem->sparse) PetscCall(MatSeqAIJRestoreArrayRead(problem->entries, values));
  else PetscCall(MatDenseRestoreArrayRead(problem->entries, values));
  PetscCall(RestorePattern(problem, problem->entries, pattern));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds rows of I - D (I - r (S + eps diag S)) for the rows of one node, D the derivative of P for it. They share their columns. */
static void AddNode(const LawProblem *problem, PetscInt node, LawPattern of_S, const PetscScalar S[], LawPattern of_J, PetscScalar J[])
{
  const PetscInt   first = problem->begin[node], rows = problem->begin[node + 1] - first;
  const PetscReal *derivative = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;
  const PetscInt  *all        = of_J.columns + of_J.begin[first],
                 next         = of_J.begin[first + 1] - of_J.begin[first]; /* to the next row of the node */

  J += of_J.begin[first];
  for (PetscInt l = 0; l < rows; l++) {
    const PetscInt i  = first + l;
    PetscInt       at = 0, own;

    for (own = 0; all[own] != i; own++);
    for (PetscInt e = of_S.begin[i]; e < of_S.begin[i + 1]; e++) {
      while (all[at] != of_S.columns[e]) at++;
      for (PetscInt k = 0; k < rows; k++) J[k * next + at] += derivative[k * rows + l] / problem->weight[i] * S[e];
    }
    for (PetscInt k = 0; k < rows; k++) J[k * next + own] += (k == l) - derivative[k * rows + l] * (1 - problem->proximal);
  }
}

/* The same of a dense S for all nodes, column by column, as both matrices lie in memory */
static void AddNodes(const LawProblem *problem, const PetscScalar S[], PetscScalar J[])
{
  for (PetscInt column = 0; column < problem->n; column++, S += problem->n, J += problem->n)
    for (PetscInt node = 0; node < problem->n_nodes; node++) {
      const PetscInt   first = problem->begin[node], rows = problem->begin[node + 1] - first;
      const PetscReal *derivative = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;

      for (PetscInt l = 0; l < rows; l++) {
        const PetscInt    i     = first + l;
        const PetscScalar value = S[i] / problem->weight[i] - (i == column ? 1 - problem->proximal : 0);

        for (PetscInt k = 0; k < rows; k++) J[first + k] += derivative[k * rows + l] * value;
        J[i] += i == column;
      }
    }
}

/* Whether factors of an earlier Jacobian precondition */
PetscBool LawProblemIsLagged(const LawProblem *problem)
{
  return (PetscBool)(LawProblemHasProducts(problem) || (!problem->sparse && problem->n > FEW_DENSE));
}

/* Whether the Jacobian is that of other derivatives of P than those at the trial forces, which become its own, or of another S */
static PetscErrorCode TakeDerivatives(LawProblem *problem, const PetscScalar force[], const PetscScalar y[], PetscBool *other)
{
  PetscObjectState state;

  PetscFunctionBegin;
  PetscCall(PetscObjectStateGet((PetscObject)problem->entries, &state));
  *other               = (PetscBool)(state != problem->jacobian_of);
  problem->jacobian_of = state;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt rows = problem->begin[node + 1] - problem->begin[node];
    PetscReal     *last = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;
    PetscReal      projected[ROW_LAW_ROWS], derivative[ROW_LAW_ROWS * ROW_LAW_ROWS], change = 0;

    LawProblemProject(problem, node, force, y, projected, derivative);
    for (PetscInt k = 0; k < rows * rows; k++) change = PetscMax(change, PetscAbsReal(derivative[k] - last[k]));
    if (change == 0) continue;
    PetscCall(PetscArraycpy(last, derivative, rows * rows));
    *other = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether to factor anew: factors are absent or precondition badly. Incomplete ones (S as products) cost less than an iteration. */
static PetscErrorCode AreStale(LawProblem *problem, PetscBool *stale)
{
  PetscInt iterations;
  KSP      ksp;

  PetscFunctionBegin;
  PetscCall(SNESGetKSP(problem->newton, &ksp));
  PetscCall(KSPGetIterationNumber(ksp, &iterations));
  *stale            = (PetscBool)(!problem->factored || iterations > (problem->sparse ? STALE_SPARSE : STALE_DENSE));
  problem->factored = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One that stays as it is keeps its factors */
static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  LawProblem        *problem = (LawProblem *)ctx;
  const PetscScalar *x, *S;
  PetscScalar       *y = problem->work, *values;
  LawPattern         of_S, of_J;
  PetscBool          other = PETSC_FALSE, stale = PETSC_TRUE;

  PetscFunctionBegin;
  (void)J;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(LawProblemRead(problem, x, y));
  PetscCall(TakeDerivatives(problem, x, y, &other));
  PetscCall(VecRestoreArrayRead(X, &x));
  if (!other) PetscFunctionReturn(PETSC_SUCCESS);
  if (LawProblemIsLagged(problem)) { /* what is multiplied with is J as it is, and its entries are for the preconditioner alone */
    PetscCall(AreStale(problem, &stale));
    if (!stale) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(SNESSetLagPreconditioner(snes, LAW_LAG_AFTER_NEXT));
  }
  PetscCall(MatZeroEntries(P));
  PetscCall(LawProblemGetS(problem, &of_S, &S));
  PetscCall(GetPattern(problem, P, &of_J));
  if (problem->sparse) PetscCall(MatSeqAIJGetArray(P, &values));
  else PetscCall(MatDenseGetArray(P, &values));
  if (!problem->sparse) AddNodes(problem, S, values);
  for (PetscInt node = 0; node < problem->n_nodes && problem->sparse; node++) AddNode(problem, node, of_S, S, of_J, values);
  if (problem->sparse) PetscCall(MatSeqAIJRestoreArray(P, &values));
  else PetscCall(MatDenseRestoreArray(P, &values));
  PetscCall(RestorePattern(problem, P, &of_J));
  PetscCall(LawProblemRestoreS(problem, &of_S, &S));
  PetscCall(MatAssemblyBegin(P, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(P, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = J x, J = I - D (I - r (S + eps diag S)), of S by products or of a large dense one */
static PetscErrorCode Multiply(Mat J, Vec X, Vec Y)
{
  LawProblem        *problem;
  const PetscScalar *x;
  PetscScalar       *y, *read;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(J, &problem));
  read = problem->work;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayWrite(Y, &y));
  PetscCall(LawProblemMultiply(problem, x, read));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt   first = problem->begin[node], rows = problem->begin[node + 1] - first;
    const PetscReal *derivative = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;

    for (PetscInt k = 0; k < rows; k++) {
      y[first + k] = x[first + k];
      for (PetscInt l = 0; l < rows; l++) {
        const PetscInt i = first + l;

        y[first + k] -= derivative[k * rows + l] * ((1 - problem->proximal) * x[i] - read[i] / problem->weight[i]);
      }
    }
  }
  PetscCall(VecRestoreArrayWrite(Y, &y));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sparse Jacobian has the entries of S in all rows of a node where any has them, and those of the rows of one node */
static PetscErrorCode SetPattern(LawProblem *problem)
{
  PetscInt          *begin, *columns, room = 0;
  const PetscScalar *S;
  LawPattern         of_S;

  PetscFunctionBegin;
  PetscCall(LawProblemGetS(problem, &of_S, &S));
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
  PetscCall(LawProblemRestoreS(problem, &of_S, &S));
  PetscCall(MatSeqAIJSetPreallocationCSR(problem->jacobian, begin, columns, NULL));
  PetscCall(PetscFree2(begin, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemCreateJacobian(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->jacobian));
  PetscCall(MatCreate(PETSC_COMM_SELF, &problem->jacobian));
  PetscCall(MatSetSizes(problem->jacobian, problem->n, problem->n, problem->n, problem->n));
  PetscCall(MatSetType(problem->jacobian, problem->sparse ? MATSEQAIJ : MATSEQDENSE));
  if (problem->sparse) PetscCall(SetPattern(problem));
  else PetscCall(MatSetUp(problem->jacobian));
  PetscCall(MatDestroy(&problem->operator));
  if (LawProblemIsLagged(problem)) {
    PetscCall(MatCreateShell(PETSC_COMM_SELF, problem->n, problem->n, problem->n, problem->n, problem, &problem->operator));
    PetscCall(MatShellSetOperation(problem->operator, MATOP_MULT, (void (*)(void))Multiply));
  }
  PetscCall(SNESSetJacobian(problem->newton, problem->operator ? problem->operator : problem->jacobian, problem->jacobian, ComputeJacobian,
                            problem));
  problem->jacobian_of = -1;
  problem->factored    = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
