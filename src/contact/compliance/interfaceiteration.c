/* S where it is only multiplied with: one solution with the factors of each body for a product, and conjugate gradients. */
#include "interfaceimpl.h"

/* Iterations after which conjugate gradients are said not to converge; without a preconditioner surfaces of 10^4 facets take 20 to 30 */
#define MAX_ITERATIONS 1000

PetscErrorCode InterfaceOperatorCreateVecs(InterfaceOperator op)
{
  const Contact contact = op->contact;

  PetscFunctionBegin;
  PetscCall(ContactCreateRowVec(contact, &op->unknown));
  PetscCall(VecDuplicate(op->unknown, &op->rhs));
  PetscCall(PetscCalloc1(2 * contact->n_bodies, &op->on_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    for (PetscInt k = 0; k < 2 && op->feels[b]; k++) PetscCall(MatCreateVecs(contact->interfaces[b], NULL, &op->on_bodies[2 * b + k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceOperatorDestroyIterative(InterfaceOperator op)
{
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&op->iterative));
  PetscCall(InterfacePreconditionerDestroy(&op->preconditioner));
  PetscCall(VecDestroy(&op->unknown));
  PetscCall(VecDestroy(&op->rhs));
  for (PetscInt k = 0; op->on_bodies && k < 2 * op->contact->n_bodies; k++) PetscCall(VecDestroy(&op->on_bodies[k]));
  PetscCall(PetscFree(op->on_bodies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one body adds to y = S x on the rows that are solved for */
static PetscErrorCode ApplyBody(InterfaceOperator op, PetscInt b, Vec x, Vec y)
{
  const Contact          contact = op->contact;
  const ContactBodyRows *of      = &contact->body_rows[b];
  const Vec              forces = op->on_bodies[2 * b], displacements = op->on_bodies[2 * b + 1];
  const PetscScalar     *in, *moved;
  PetscScalar           *force, *out;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(forces, &force));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt i = of->rows[k];

    force[k] = op->marks[i] == INTERFACE_SOLVED ? InterfaceSide(&contact->pairs[contact->rows.pair[i]], b) * in[i] : 0;
  }
  PetscCall(VecRestoreArrayWrite(forces, &force));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscCall(BodyApplyCompliance(contact->bodies[b], forces, displacements));
  PetscCall(VecGetArrayRead(displacements, &moved));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt i = of->rows[k];

    if (op->marks[i] == INTERFACE_SOLVED) out[i] += InterfaceSide(&contact->pairs[contact->rows.pair[i]], b) * moved[k];
  }
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(displacements, &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = S x on the rows that are solved for, zero on the others; x counts on the former alone. Bodies without such rows add nothing. */
PetscErrorCode InterfaceOperatorApply(InterfaceOperator op, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(VecZeroEntries(y));
  for (PetscInt b = 0; b < op->contact->n_bodies; b++)
    if (op->has_rows[b]) PetscCall(ApplyBody(op, b, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (S + diagonal) x on the rows that are in, y = x on the others, where x is zero */
static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  InterfaceOperator  op;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &op));
  if (op->matrix) PetscCall(MatMult(op->matrix, x, y));
  else PetscCall(InterfaceOperatorApply(op, x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) {
    if (InterfaceIsIn(op, i)) out[i] += op->diagonal[i] * in[i];
    else out[i] = in[i];
  }
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What Jacobi's preconditioner divides by: the diagonal of a sparse S; else what is added to S, which outweighs it where springs are soft.
   One where there is neither, as between bodies without mass. */
static PetscErrorCode GetDiagonal(Mat shell, Vec diagonal)
{
  InterfaceOperator op;
  PetscScalar      *values;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &op));
  if (op->matrix) PetscCall(MatGetDiagonal(op->matrix, diagonal));
  else PetscCall(VecZeroEntries(diagonal));
  PetscCall(VecGetArray(diagonal, &values));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) {
    values[i] += op->diagonal[i];
    if (!InterfaceIsIn(op, i) || !(PetscRealPart(values[i]) > 0)) values[i] = 1;
  }
  PetscCall(VecRestoreArray(diagonal, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What products take, and what preconditions */
PetscErrorCode InterfaceOperatorCreateProducts(InterfaceOperator op)
{
  PetscFunctionBegin;
  if (!op->unknown) PetscCall(InterfaceOperatorCreateVecs(op));
  if (op->settings.precondition && !op->matrix && op->contact->rows.n_all > op->settings.few)
    PetscCall(InterfacePreconditionerCreate(op, &op->preconditioner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In the set-up, so that its options are read there */
PetscErrorCode InterfaceOperatorCreateIterative(InterfaceOperator op)
{
  const Contact contact = op->contact;
  MPI_Comm      comm    = PetscObjectComm((PetscObject)contact);
  Mat           shell;
  PC            pc;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorCreateProducts(op));
  PetscCall(MatCreateShell(comm, contact->rows.n, contact->rows.n, contact->rows.n_all, contact->rows.n_all, op, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(shell, MATOP_GET_DIAGONAL, (void (*)(void))GetDiagonal));
  PetscCall(KSPCreate(comm, &op->iterative));
  PetscCall(KSPSetOptionsPrefix(op->iterative, op->settings.prefix));
  PetscCall(KSPSetOperators(op->iterative, shell, shell));
  PetscCall(KSPSetType(op->iterative, KSPCG));
  PetscCall(KSPGetPC(op->iterative, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetNormType(op->iterative, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetInitialGuessNonzero(op->iterative, op->settings.warm));
  PetscCall(KSPSetTolerances(op->iterative, op->settings.tolerance, 0, PETSC_CURRENT, MAX_ITERATIONS));
  PetscCall(KSPSetFromOptions(op->iterative));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where it does not converge, and not round-off alone keeps the residual from the tolerance, the controller step has failed */
static PetscErrorCode CheckConverged(InterfaceOperator op)
{
  KSPConvergedReason reason;
  PetscReal          left, all;
  PetscInt           iterations;

  PetscFunctionBegin;
  PetscCall(KSPGetIterationNumber(op->iterative, &iterations));
  op->contact->counts.inner_iterations += iterations;
  op->spent += (iterations + (op->settings.warm ? 1 : 0)) * op->product_flops; /* a first iterate takes a product for its residual */
  PetscCall(KSPGetConvergedReason(op->iterative, &reason));
  if (reason > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KSPGetResidualNorm(op->iterative, &left));
  PetscCall(VecNorm(op->rhs, NORM_2, &all));
  if (left <= op->settings.worst * all) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StepFailureSet(&op->contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "Conjugate gradients for the contact forces of %" PetscInt_FMT
                           " rows leave %g of their gaps after %" PetscInt_FMT
                           " iterations (%s); raise -%sksp_max_it, or look with -%sksp_monitor",
                           op->n, (double)(left / all), iterations, KSPConvergedReasons[reason], op->settings.prefix, op->settings.prefix));
  if (!op->contact->attempt.returns) PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)op->contact), &op->contact->attempt.failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (S + diagonal)^{-1} x on this rank's rows that are in, zero on the others */
PetscErrorCode InterfaceOperatorIterate(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  const PetscScalar *solution;
  PetscScalar       *values;

  PetscFunctionBegin;
  if (!op->iterative) PetscCall(InterfaceOperatorCreateIterative(op));
  PetscCall(VecGetArrayWrite(op->rhs, &values));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) values[i] = InterfaceIsIn(op, i) ? x[i] : 0;
  PetscCall(VecRestoreArrayWrite(op->rhs, &values));
  PetscCall(VecGetArrayWrite(op->unknown, &values));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) values[i] = InterfaceIsIn(op, i) && op->settings.warm ? y[i] : 0;
  PetscCall(VecRestoreArrayWrite(op->unknown, &values));
  PetscCall(KSPSolve(op->iterative, op->rhs, op->unknown));
  PetscCall(CheckConverged(op));
  PetscCall(VecGetArrayRead(op->unknown, &solution));
  PetscCall(PetscArraycpy(y, solution, op->contact->rows.n));
  PetscCall(VecRestoreArrayRead(op->unknown, &solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}
