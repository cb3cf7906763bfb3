/* A body under TSALPHA2. */
#include <body/layout/bodyimpl.h>
#include <sys/petsccompat.h>

/* What a nonlinear residual is measured against: its terms, and the round-off of the largest numbers in it */
static PetscErrorCode NoteScale(Body body, Vec U, Vec inertia)
{
  PetscReal force, stiffness, mass = 0, position = 0;

  PetscFunctionBegin;
  PetscCall(VecNorm(body->internal_force, NORM_2, &force));
  /* the internal force is a sum of displacements times stiffnesses, which may cancel: a body that moves as a whole has none */
  PetscCall(MatGetDiagonal(body->shifted, body->work[2]));
  PetscCall(VecPointwiseMult(body->work[2], body->work[2], U));
  PetscCall(VecNorm(body->work[2], NORM_2, &stiffness));
  if (!body->is_static) {
    PetscCall(VecNorm(inertia, NORM_2, &mass));
    /* the acceleration is a difference of displacements over dt^2 */
    PetscCall(VecPointwiseMult(body->work[2], body->mass_row_sum, U));
    PetscCall(VecNorm(body->work[2], NORM_2, &position));
    position *= body->shift;
  }
  body->force_scale = force + mass;
  body->force_floor = 8 * PETSC_MACHINE_EPSILON * (position + force + stiffness);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F = M A + internal force - forces from outside and of contact, with held dofs and prescribed rows projected out */
static PetscErrorCode ComputeResidual(TS ts, PetscReal t, Vec U, Vec V, Vec A, Vec F, void *ctx)
{
  Body            body     = (Body)ctx;
  const PetscReal position = (body->substep + body->alpha_f) / body->substeps;

  PetscFunctionBegin;
  (void)ts;
  (void)V;
  PetscCall(BodyComputeInternalForce(body, U, body->internal_force));
  if (body->is_static) PetscCall(VecZeroEntries(F));
  else {
    const PetscBool prescribed = (PetscBool)(body->n_prescribed && body->prescribed_mass);

    /* Newmark's formulas are unstable on prescribed nodes with mass: their acceleration is the partner's, or the load's */
    if (body->any_held && (prescribed || !body->mass_diagonal)) PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
    PetscCall(BodyMultiplyMass(body, A, F));
  }
  if (!body->linear) PetscCall(NoteScale(body, U, F));
  PetscCall(VecAXPY(F, 1, body->internal_force));
  PetscCall(BodyAddExternalForce(body, t, -1, F));
  PetscCall(BodyAddContactForce(body, position, -1, U, F));
  PetscCall(BodyZeroHeld(body, F));
  PetscCall(BodyPrescribe(body, NULL, position, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix K + shift M, its held dofs eliminated */
static PetscErrorCode AssembleShifted(Body body, Vec u)
{
  PetscFunctionBegin;
  PetscCall(BodyAssembleTangent(body, u, body->shifted));
  if (body->shift > 0 && body->mass_diagonal) {
    PetscCall(VecCopy(body->mass_diagonal, body->work[0]));
    PetscCall(VecScale(body->work[0], body->shift));
    PetscCall(MatDiagonalSet(body->shifted, body->work[0], ADD_VALUES));
  } else if (body->shift > 0) PetscCall(MatAXPY(body->shifted, body->shift, body->mass_matrix, SAME_NONZERO_PATTERN));
  PetscCall(BodyEliminateHeld(body, body->shifted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a linear body is constant, and was assembled at set-up */
static PetscErrorCode ComputeJacobian(TS ts, PetscReal t, Vec U, Vec V, Vec A, PetscReal shift_v, PetscReal shift_a, Mat J, Mat P,
                                      void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)V;
  (void)A;
  (void)shift_v;
  (void)shift_a;
  (void)J;
  (void)P;
  if (body->linear) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AssembleShifted(body, U));
  PetscCall(ConstrainedSolverRefactor(body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First iterate: the last displacement, of nonlinear bodies that at the last velocity, with held dofs and prescribed rows in place. Also
   brings the acceleration, which TSALPHA2 would take from its last step, even if that step has been undone since. */
static PetscErrorCode Predict(TS ts, Vec X0, Vec V0, Vec A0, Vec X1, void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  PetscCall(VecCopy(body->state.a, A0));
  if (body->linear || body->is_static) PetscCall(VecCopy(X0, X1));
  else PetscCall(VecWAXPY(X1, body->time_step, V0, X0)); /* a body that turns fast would need many iterations from where it was */
  PetscCall(BodyPrescribeHeld(body, body->time + body->time_step, X1, NULL, NULL));
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
static PetscErrorCode StopAfterOneIteration(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                            SNESConvergedReason *reason, void *ctx)
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

/* Newton's method has converged where the residual is small against the forces that it is the balance of */
static PetscErrorCode StopInBalance(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm, SNESConvergedReason *reason,
                                    void *ctx)
{
  Body      body = (Body)ctx;
  PetscReal rtol, atol;

  PetscFunctionBegin;
  (void)xnorm;
  (void)gnorm;
  PetscCall(SNESGetTolerances(snes, &atol, &rtol, NULL, NULL, NULL));
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (fnorm <= atol) *reason = SNES_CONVERGED_FNORM_ABS;
  else if (it && fnorm <= rtol * body->force_scale + body->force_floor) *reason = SNES_CONVERGED_FNORM_RELATIVE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For CG with multigrid: what the body can do without strain */
static PetscErrorCode SetNearNullSpace(Body body)
{
  MatNullSpace rigid;
  Vec          coordinates;

  PetscFunctionBegin;
  if (body->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDuplicate(body->positions, &coordinates));
  PetscCall(VecCopy(body->positions, coordinates));
  PetscCall(VecSetBlockSize(coordinates, body->dim));
  PetscCall(MatSetBlockSize(body->shifted, body->dim));
  PetscCall(MatNullSpaceCreateRigidBody(coordinates, &rigid));
  PetscCall(MatSetNearNullSpace(body->shifted, rigid));
  PetscCall(MatNullSpaceDestroy(&rigid));
  PetscCall(VecDestroy(&coordinates));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newton's method for nonlinear bodies; one iteration of it for linear ones */
static PetscErrorCode SetUpNewton(Body body, SNES snes)
{
  SNESLineSearch line_search;

  PetscFunctionBegin;
  PetscCall(SNESGetLineSearch(snes, &line_search));
  if (!body->linear) {
    PetscCall(SNESSetTolerances(snes, 1e-30, 1e-12, 1e-15, 50, PETSC_CURRENT));
    PetscCall(SNESLineSearchSetType(line_search, SNESLINESEARCHBT));
    PetscCall(SNESSetFromOptions(snes));
    PetscCall(SNESSetConvergenceTest(snes, StopInBalance, body, NULL));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SNESSetLagJacobian(snes, -2));
  PetscCall(SNESSetLagJacobianPersists(snes, PETSC_TRUE));
  PetscCall(SNESSetLagPreconditioner(snes, -2));
  PetscCall(SNESSetLagPreconditionerPersists(snes, PETSC_TRUE));
  PetscCall(SNESSetConvergenceTest(snes, StopAfterOneIteration, NULL, NULL));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscCall(SNESLineSearchSetComputeNorms(line_search, PETSC_FALSE)); /* one iteration is all there is: nothing reads them */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The effective matrix K + alpha_m / (alpha_f beta dt^2) M; of linear bodies, factored once */
PetscErrorCode BodySetUpImplicit(Body body)
{
  const char *prefix = ((PetscObject)body)->prefix;
  SNES        snes;
  KSP         ksp;
  PC          pc;
  Vec         residual;
  char        outer[128];

  PetscFunctionBegin;
  body->shift = body->is_static ? 0 : body->alpha_m / (body->alpha_f * body->beta * PetscSqr(body->time_step));
  PetscCall(BodyCreateMatrix(body, &body->shifted));
  PetscCall(AssembleShifted(body, NULL));
  PetscCall(SetNearNullSpace(body));
  PetscCall(ConstrainedSolverCreate(body->shifted, body->free_rows, body->dim, prefix, BodyGetSharedCompliance(body), &body->solver));

  PetscCall(BodyCreateVec(body, &residual));
  PetscCall(TSSetI2Function(body->ts, residual, ComputeResidual, body));
  PetscCall(TSSetI2Jacobian(body->ts, body->shifted, body->shifted, ComputeJacobian, body));
  PetscCall(VecDestroy(&residual));
  PetscCall(TSAlpha2SetPredictor(body->ts, Predict, body));
  PetscCall(TSGetSNES(body->ts, &snes));
  PetscCall(SetUpNewton(body, snes));
  /* BodyIntegrate() tells, with body and time */
  PetscCall(SNESSetErrorIfNotConverged(snes, PETSC_FALSE));
  PetscCall(TSSetErrorIfStepFails(body->ts, PETSC_FALSE));
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
  if (body->is_static) {
    for (PetscInt i = 0; i < n; i++) {
      v1[i] = (u1[i] - u0[i]) / dt;
      a[i]  = 0;
    }
  } else {
    for (PetscInt i = 0; i < n; i++) a[i] = c2 * (u1[i] - u0[i]) - c1 * v0[i] - c0 * a[i];
  }
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
  if (!body->is_static) PetscCall(BodyPrescribeHeld(body, body->time, NULL, body->state.v, body->state.a));
  if (body->prescribed_mass) {
    const PetscReal position = (PetscReal)(body->substep + 1) / body->substeps;

    PetscCall(BodyPrescribe(body, body->traces.velocity_in, position, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, body->state.a));
  }
  if (body->alpha_f != 1) PetscCall(BodyComputeInternalForce(body, body->state.u, body->internal_force));
  PetscFunctionReturn(PETSC_SUCCESS);
}
