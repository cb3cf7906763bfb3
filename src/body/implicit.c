/* A body under TSALPHA2. */
#include "bodyimpl.h"
#include <sys/petsccompat.h>

/* F = M A + internal force - contact forces, with prescribed rows projected out */
static PetscErrorCode ComputeResidual(TS ts, PetscReal t, Vec U, Vec V, Vec A, Vec F, void *ctx)
{
  Body            body     = (Body)ctx;
  const PetscReal position = (body->substep + body->alpha_f) / body->substeps;

  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)V;
  /* Newmark's formulas are unstable on prescribed nodes with mass: their acceleration is the partner's */
  if (body->n_prescribed && body->prescribed_mass) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
  PetscCall(BodyComputeInternalForce(body, U, body->internal_force));
  if (body->mass_diagonal) PetscCall(VecPointwiseMult(F, body->mass_diagonal, A));
  else PetscCall(MatMult(body->mass_matrix, A, F));
  PetscCall(VecAXPY(F, 1, body->internal_force));
  PetscCall(BodyAddContactForce(body, position, -1, U, F));
  PetscCall(BodyPrescribe(body, NULL, position, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix is constant, and was assembled at set-up */
static PetscErrorCode ComputeJacobian(TS ts, PetscReal t, Vec U, Vec V, Vec A, PetscReal shift_v, PetscReal shift_a, Mat J, Mat P, void *ctx)
{
  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)U;
  (void)V;
  (void)A;
  (void)shift_v;
  (void)shift_a;
  (void)J;
  (void)P;
  (void)ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First iterate: the last displacement, with prescribed rows in place. Also brings the acceleration, which TSALPHA2 would
   take from its last step, even if that step has been undone since. */
static PetscErrorCode Predict(TS ts, Vec X0, Vec V0, Vec A0, Vec X1, void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  (void)V0;
  PetscCall(VecCopy(body->state.a, A0));
  PetscCall(VecCopy(X0, X1));
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, (PetscReal)(body->substep + 1) / body->substeps, X1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyConstrainedSolver(PC pc, Vec b, Vec x)
{
  Body body;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &body));
  PetscCall(ConstrainedSolverSolve(body->solver, b, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One Newton iteration solves a linear body. The residual must still be evaluated at the solution, because velocity and
   acceleration are by-products of its evaluation. */
static PetscErrorCode StopAfterOneIteration(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm, SNESConvergedReason *reason, void *ctx)
{
  PetscFunctionBegin;
  (void)snes;
  (void)xnorm;
  (void)gnorm;
  (void)ctx;
  *reason = it ? SNES_CONVERGED_ITS : SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix K + alpha_m / (alpha_f beta dt^2) M, factored once */
PetscErrorCode BodySetUpImplicit(Body body)
{
  const PetscReal shift  = body->alpha_m / (body->alpha_f * body->beta * PetscSqr(body->time_step));
  const char     *prefix = ((PetscObject)body)->prefix;
  SNES            snes;
  SNESLineSearch  line_search;
  KSP             ksp;
  PC              pc;
  Vec             residual;
  char            outer[128];

  PetscFunctionBegin;
  PetscCall(MatDuplicate(body->stiffness, MAT_COPY_VALUES, &body->shifted));
  if (body->mass_diagonal) {
    PetscCall(VecCopy(body->mass_diagonal, body->work[0]));
    PetscCall(VecScale(body->work[0], shift));
    PetscCall(MatDiagonalSet(body->shifted, body->work[0], ADD_VALUES));
  } else PetscCall(MatAXPY(body->shifted, shift, body->mass_matrix, SAME_NONZERO_PATTERN));
  PetscCall(ConstrainedSolverCreate(body->shifted, body->interface, prefix, &body->solver));

  PetscCall(BodyCreateVec(body, &residual));
  PetscCall(TSSetI2Function(body->ts, residual, ComputeResidual, body));
  PetscCall(TSSetI2Jacobian(body->ts, body->shifted, body->shifted, ComputeJacobian, body));
  PetscCall(VecDestroy(&residual));
  PetscCall(TSAlpha2SetPredictor(body->ts, Predict, body));
  PetscCall(TSGetSNES(body->ts, &snes));
  PetscCall(SNESSetLagJacobian(snes, -2));
  PetscCall(SNESSetLagJacobianPersists(snes, PETSC_TRUE));
  PetscCall(SNESSetLagPreconditioner(snes, -2));
  PetscCall(SNESSetLagPreconditionerPersists(snes, PETSC_TRUE));
  PetscCall(SNESSetConvergenceTest(snes, StopAfterOneIteration, NULL, NULL));
  /* BodyIntegrate() tells, with body and time */
  PetscCall(SNESSetErrorIfNotConverged(snes, PETSC_FALSE));
  PetscCall(TSSetErrorIfStepFails(body->ts, PETSC_FALSE));
  PetscCall(SNESGetLineSearch(snes, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESLineSearchSetComputeNorms(line_search, PETSC_FALSE)); /* one iteration is all there is: nothing reads them */
  PetscCall(SNESGetKSP(snes, &ksp));
  /* the user's -<body>_ksp_... options are for the solver with the factors, inside */
  PetscCall(PetscSNPrintf(outer, sizeof(outer), "%sconstrained_", prefix));
  PetscCall(KSPSetOptionsPrefix(ksp, outer));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, body));
  PetscCall(PCShellSetApply(pc, ApplyConstrainedSolver));
  PetscCall(PCShellSetName(pc, "factored effective matrix with contact constraints"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Acceleration by Newmark's formula; velocity and acceleration of prescribed and massless nodes */
PetscErrorCode BodyFinishSubstepImplicit(Body body)
{
  const PetscReal    dt = body->time_step, c2 = 1 / (body->beta * dt * dt), c1 = c2 * dt, c0 = (1 - 2 * body->beta) / (2 * body->beta);
  const PetscInt     n = body->owned_nodes * body->dim;
  const PetscScalar *u0, *v0, *u1;
  PetscScalar       *v1, *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->substep_start.u, &u0));
  PetscCall(VecGetArrayRead(body->substep_start.v, &v0));
  PetscCall(VecGetArrayRead(body->state.u, &u1));
  PetscCall(VecGetArray(body->state.v, &v1));
  PetscCall(VecGetArray(body->state.a, &a));
  for (PetscInt i = 0; i < n; i++) a[i] = c2 * (u1[i] - u0[i]) - c1 * v0[i] - c0 * a[i];
  for (PetscInt i = 0; i < body->n_layer_dofs; i++) {
    const PetscInt dof = body->layer_dofs[i];

    v1[dof] = (u1[dof] - u0[dof]) / dt;
    a[dof]  = 0;
  }
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArray(body->state.v, &v1));
  PetscCall(VecRestoreArrayRead(body->state.u, &u1));
  PetscCall(VecRestoreArrayRead(body->substep_start.v, &v0));
  PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  if (body->prescribed_mass) {
    const PetscReal position = (PetscReal)(body->substep + 1) / body->substeps;

    PetscCall(BodyPrescribe(body, body->traces.velocity_in, position, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, body->state.a));
  }
  if (body->alpha_f != 1) PetscCall(BodyComputeInternalForce(body, body->state.u, body->internal_force));
  PetscFunctionReturn(PETSC_SUCCESS);
}
