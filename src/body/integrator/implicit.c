/* A body under TSALPHA2: Newmark's method and its relatives. */
#include "implicitimpl.h"

/* The default: Newmark's trapezoidal rule, which conserves energy. TSALPHA2's own is the implicit midpoint rule. */
#define ALPHA_M 1
#define ALPHA_F 1
#define GAMMA   0.5
#define BETA    0.25
/* Of all parameters of the generalised-alpha family that a spectral radius of 0 to 1 gives: its alpha_m at 0 */
#define LARGEST 2.

/* Adds the forces of the dashpots at the stage, where held dofs and prescribed rows have the velocity that they are given */
static PetscErrorCode AddDamping(Body body, PetscReal t, PetscReal position, Vec U, Vec V, Vec F)
{
  Vec force = body->work.nodes[0];

  PetscFunctionBegin;
  if (!BodyIsDamped(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->held.any) PetscCall(BodyPrescribeHeld(body, t, NULL, V, NULL));
  if (body->rows.n_prescribed && body->rows.have_mass) PetscCall(BodyPrescribe(body, body->traces.velocity_in, position, V));
  PetscCall(BodyMultiplyDamping(body, U, V, force));
  PetscCall(VecAXPY(F, 1, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F = M A + C V + internal force - forces from outside and of contact, with held dofs and prescribed rows projected out */
static PetscErrorCode ComputeResidual(TS ts, PetscReal t, Vec U, Vec V, Vec A, Vec F, void *ctx)
{
  Body                body       = (Body)ctx;
  const BodyImplicit *implicit   = (const BodyImplicit *)body->integrator->data;
  const PetscBool     prescribed = (PetscBool)(body->rows.n_prescribed && body->rows.have_mass);
  const PetscReal     position   = (body->time.substep + implicit->alpha_f) / body->time.substeps;

  PetscFunctionBegin;
  (void)ts;
  if (!body->state.force_known) PetscCall(BodyComputeInternalForce(body, U, body->state.internal_force));
  /* Newmark's formulas are unstable on prescribed nodes with mass: their acceleration is the partner's, or the load's */
  if (body->held.any && (prescribed || !body->mass.diagonal)) PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
  if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
  PetscCall(BodyMultiplyMass(body, A, F));
  PetscCall(AddDamping(body, t, position, U, V, F));
  PetscCall(BodyImplicitAddForces(body, t, U, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* First iterate of a nonlinear body: the displacement at the last velocity, for bodies that turn fast, with held dofs and prescribed rows
   in place. Also brings the acceleration, which TSALPHA2 would take from its last step, even if that step has been undone since. */
static PetscErrorCode Predict(TS ts, Vec X0, Vec V0, Vec A0, Vec X1, void *ctx)
{
  Body body = (Body)ctx;

  PetscFunctionBegin;
  (void)ts;
  ((BodyImplicit *)body->integrator->data)->iterated = PETSC_FALSE;
  PetscCall(VecCopy(body->state.a, A0));
  PetscCall(VecWAXPY(X1, body->time.step, V0, X0));
  PetscCall(BodyImplicitPrescribe(body, X1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetDefaults(Body body)
{
  PetscFunctionBegin;
  PetscCall(TSAlpha2SetParams(body->time.ts, ALPHA_M, ALPHA_F, GAMMA, BETA));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetParameters(Body body)
{
  BodyImplicit  *implicit   = (BodyImplicit *)body->integrator->data;
  BodyIntegrator integrator = body->integrator;
  const char    *prefix     = ((PetscObject)body)->prefix;

  PetscFunctionBegin;
  PetscCall(TSAlpha2GetParams(body->time.ts, &implicit->alpha_m, &implicit->alpha_f, &integrator->gamma, &integrator->beta));
  PetscCheck(PetscMax(PetscMax(integrator->beta, integrator->gamma), PetscMax(implicit->alpha_f, implicit->alpha_m)) <= LARGEST,
             PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_alpha_...: alpha_m %g, alpha_f %g, gamma %g, beta %g must not be larger than %g", prefix, (double)implicit->alpha_m,
             (double)implicit->alpha_f, (double)integrator->gamma, (double)integrator->beta, LARGEST);
  PetscCheck(integrator->beta > 0 && implicit->alpha_f > 0 && implicit->alpha_m > 0 && integrator->gamma > 0,
             PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_alpha_...: alpha_m %g, alpha_f %g, gamma %g, beta %g must be positive; for the explicit scheme (beta = 0) choose "
             "-%sts_type centraldifference",
             prefix, (double)implicit->alpha_m, (double)implicit->alpha_f, (double)integrator->gamma, (double)integrator->beta, prefix);
  /* else the force at the stage, within the substep, is what displacements answer to */
  integrator->affine = (PetscBool)(implicit->alpha_f == 1 && implicit->alpha_m == 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Body body)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  body->integrator->depends_on_step = PETSC_TRUE;
  PetscCall(BodyImplicitSetUp(body, ComputeResidual, Predict));
  /* the force that acts in the substep is that at the stage; with a linear body it is the mean of those at the ends */
  if (!body->model.linear && implicit->alpha_f != 1 && (body->rows.global || body->rows.expected) &&
      (!body->rows.have_mass || body->rows.traction == BODY_TRACTION_REACTION)) {
    body->rows.stage = implicit->alpha_f;
    PetscCall(BodyCreateVec(body, &body->rows.stage_balance));
  }
  /* other masses are factored when they are needed first, which may be in a substep */
  body->integrator->is_local = (PetscBool)(ConstrainedSolverIsHome(body->solver) && (body->mass.diagonal || body->time.substeps == 1));
  /* iterations of Newton's method cannot bring forces from other ranks */
  if (!body->model.linear) {
    if (!body->integrator->affine || body->time.substeps > 1) body->integrator->is_local = PETSC_FALSE;
    if (body->integrator->is_local) PetscCall(BodyImplicitSetUpOwnStep(body, ComputeResidual, Predict, BodyImplicitSetUpNewton));
  }
  /* a mass matrix that is not diagonal hands the acceleration of prescribed nodes to others */
  if (body->rows.have_mass && body->mass.matrix) body->integrator->repeats_prescribed = PETSC_FALSE;
  /* else velocities at the end, and the dashpots' forces, have a part of the acceleration at the start; several ranks would wait for each
     other in what forces on the rows do there */
  body->integrator->repeats_constant = (PetscBool)(body->model.linear && body->integrator->affine && !body->layer.exists &&
                                                   body->time.substeps == 1 && body->integrator->gamma == 2 * body->integrator->beta &&
                                                   body->rows.size == 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity and acceleration of massless, held and prescribed nodes at a position in the controller step, and the forces of the dashpots */
static PetscErrorCode FinishRates(Body body, PetscReal position)
{
  PetscFunctionBegin;
  PetscCall(BodyFinishLayer(body));
  PetscCall(BodyPrescribeHeld(body, body->state.time, NULL, body->state.v, body->state.a));
  if (body->rows.have_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, position, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, body->state.a));
  }
  PetscCall(BodyNoteDamping(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the TS leaves undone: acceleration; rates of prescribed and massless nodes; the internal force at the end, if not evaluated */
static PetscErrorCode FinishSubstep(Body body)
{
  const BodyImplicit *implicit = (const BodyImplicit *)body->integrator->data;

  PetscFunctionBegin;
  if (!body->model.linear) { /* TSALPHA2 keeps the acceleration to itself */
    PetscCall(BodyImplicitGetAcceleration(body, body->state.u, body->work.nodes[0]));
    PetscCall(VecCopy(body->work.nodes[0], body->state.a));
  }
  if (!body->model.linear && implicit->alpha_f != 1) PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(FinishRates(body, (PetscReal)(body->time.substep + 1) / body->time.substeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dv = gamma / (beta dt) du, da = du / (beta dt^2); of massless nodes dv = du / dt. Forces throughout the step change the acceleration at
   its start too, by da0 = M^{-1} B^T df: A du = (1 + c0) B^T df and da -= c0 da0, c0 = (1 - 2 beta) / (2 beta). */
static PetscErrorCode Repeat(Body body, const PetscScalar force[], const PetscScalar displacement[])
{
  const PetscReal dt = body->time.step, beta = body->integrator->beta, to_velocity = body->integrator->gamma / (beta * dt);
  const PetscReal c0 = body->rows.constant ? (1 - 2 * beta) / (2 * beta) : 0;

  PetscFunctionBegin;
  PetscCall(BodyImplicitCorrect(body, displacement, 1 + c0, to_velocity, 1 / (beta * dt * dt), body->work.nodes[2]));
  if (body->rows.constant) {
    PetscCall(BodySolveMassOfRows(body, force, body->work.nodes[2]));
    PetscCall(VecAXPY(body->saved.a, 1, body->work.nodes[2]));
    PetscCall(VecAXPY(body->state.a, -c0, body->work.nodes[2]));
  }
  PetscCall(FinishRates(body, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyIntegratorCreate_Implicit(BodyIntegrator integrator)
{
  PetscFunctionBegin;
  PetscCall(BodyImplicitCreate(integrator));
  integrator->has_inertia       = PETSC_TRUE;
  integrator->ops.setdefaults   = SetDefaults;
  integrator->ops.getparameters = GetParameters;
  integrator->ops.setup         = SetUp;
  integrator->ops.finishsubstep = FinishSubstep;
  integrator->ops.repeat        = Repeat;
  PetscFunctionReturn(PETSC_SUCCESS);
}
