/* The Jacobian of the equations of laws; see lawproblem.c. */
#include "lawimpl.h"
#include <petsc/private/petscimpl.h>

#define FEW_DENSE    500 /* rows of a dense S whose Jacobian is factored each time it changes */
#define STALE_DENSE  20  /* iterations of the last linear solution beyond which they have grown stale: new ones cost more than 80, */
#define STALE_SPARSE 10  /* and incomplete ones, where S is products, as much as a few */

/* Room for D r, in blocks of the rows of nodes, which may be others later where the Jacobian is dense */
static PetscErrorCode CreateDerivative(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->derivative));
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, problem->n, problem->n, 2 * ROW_LAW_ROWS - 1, NULL, &problem->derivative));
  for (PetscInt i = 0, node = 0; i < problem->n; i++) {
    const PetscInt first = problem->sparse ? problem->begin[node] : PetscMax(i - ROW_LAW_ROWS + 1, 0);
    const PetscInt end   = problem->sparse ? problem->begin[node + 1] : PetscMin(i + ROW_LAW_ROWS, problem->n);

    for (PetscInt j = first; j < end; j++) PetscCall(MatSetValue(problem->derivative, i, j, 0, INSERT_VALUES));
    node += i + 1 == end;
  }
  PetscCall(MatAssemblyBegin(problem->derivative, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(problem->derivative, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds D r to a matrix, with the derivatives D of P, or I - (1 - eps) D */
static PetscErrorCode AddDerivatives(const LawProblem *problem, PetscBool times_r, Mat matrix)
{
  PetscFunctionBegin;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt   first = problem->begin[node], rows = problem->begin[node + 1] - first;
    const PetscReal *derivative = problem->derivatives + node * ROW_LAW_ROWS * ROW_LAW_ROWS;

    for (PetscInt k = 0; k < rows; k++)
      for (PetscInt l = 0; l < rows; l++) {
        const PetscReal d = derivative[k * rows + l];

        PetscCall(MatSetValue(matrix, first + k, first + l,
                              times_r ? d / problem->weight[first + l] : (k == l) - (1 - problem->proximal) * d, ADD_VALUES));
      }
  }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
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

/* Whether to factor anew: factors are absent or precondition badly. Incomplete ones (S as products) cost a few iterations. */
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
  const PetscScalar *x;
  PetscScalar       *y     = problem->work;
  PetscBool          other = PETSC_FALSE, stale = PETSC_TRUE;

  PetscFunctionBegin;
  (void)J;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(LawProblemRead(problem, x, y));
  PetscCall(TakeDerivatives(problem, x, y, &other));
  PetscCall(VecRestoreArrayRead(X, &x));
  if (!other) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatZeroEntries(problem->derivative));
  PetscCall(AddDerivatives(problem, PETSC_TRUE, problem->derivative));
  if (LawProblemIsLagged(problem)) { /* what is multiplied with is J as it is, and its entries are for the preconditioner alone */
    PetscCall(AreStale(problem, &stale));
    if (!stale) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(SNESSetLagPreconditioner(snes, LAW_LAG_AFTER_NEXT));
  }
  /* J = I - D (I - r (S + eps diag S)) = I + D r S - (1 - eps) D */
  PetscCall(MatMatMult(problem->derivative, problem->entries, MAT_REUSE_MATRIX, PETSC_DETERMINE, &P));
  PetscCall(AddDerivatives(problem, PETSC_FALSE, P));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = J x, J = I - D (I - r (S + eps diag S)), of S by products or of a large dense one */
static PetscErrorCode Multiply(Mat J, Vec X, Vec Y)
{
  LawProblem        *problem;
  const PetscScalar *x;
  PetscScalar       *y;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(J, &problem));
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArrayWrite(problem->y, &y));
  PetscCall(LawProblemMultiply(problem, x, problem->work));
  for (PetscInt i = 0; i < problem->n; i++) y[i] = problem->work[i] - (1 - problem->proximal) * problem->weight[i] * x[i];
  PetscCall(VecRestoreArrayWrite(problem->y, &y));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscCall(MatMultAdd(problem->derivative, problem->y, X, Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LawProblemCreateJacobian(LawProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&problem->jacobian));
  PetscCall(CreateDerivative(problem));
  PetscCall(MatMatMult(problem->derivative, problem->entries, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &problem->jacobian));
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
