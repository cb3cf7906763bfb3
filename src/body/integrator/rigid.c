/* A body under TSRIGID: a rigid one, of which forces on its nodes change linear and angular momentum alone.

   The centre of mass moves by the trapezoidal rule, Newmark's of deformable bodies. The body turns by the rule of J. C. Simo and K. K.
   Wong, Unconditionally stable algorithms for rigid body dynamics that exactly preserve energy and momentum, International Journal for
   Numerical
   Methods in Engineering 31 (1991): with the angular velocity W in the frame of the body, its inertia J there, and the Cayley transform,

     Theta = dt/2 (W_0 + W_1),  R_1 = R_0 cay(Theta),  R_1 J W_1 = R_0 J W_0 + dt T,  T = sum (r_0 + r_1)/2 x (f_0 + f_1)/2.

   So a node moves by u_1 - u_0 = dt V + (R_0 Theta) x (r_0 + r_1)/2, and kinetic energy changes by exactly the work of the mean forces on
   the way of the nodes, sum (f_0 + f_1)/2 . (u_1 - u_0): the same that the partner of a contact takes or gives. W_1 is found by Newton's
   method.

   The state is that of all bodies: displacement, velocity and acceleration of the nodes. Where the body is follows from them. */
#include "rigidimpl.h"

/* Newton's method for the angular velocity: it takes 3 or 4 steps to round-off; the change by which its matrix is found, and when it is
   there, in parts of the angular velocity and of one radian in a step */
#define MAX_ITERATIONS 30
#define DIFFERENCE     1e-7
#define CONVERGED      1e-14
/* By how much the first state may be off a rigid motion, in parts of the body's size or of its largest velocity */
#define OFF 1e-9
/* A substep of the rotation: see the top of the file */
typedef struct {
  const BodyRigid   *rigid;
  const RigidMotion *begin;
  PetscReal          dt, spin[3]; /* W_0 */
  PetscReal          momentum[3]; /* R_0 J W_0 */
  PetscReal          rest[3];     /* half of the torque at the start that is not of the forces known there */
  PetscReal          dyad[9];     /* of the mean forces */
} Turn;

/* W_1 - J^{-1} R_1^T (R_0 J W_0 + dt T), with the R_1 that W_1 leads to */
static void EvaluateTurn(const Turn *turn, const PetscReal spin[3], PetscReal rotation[9], PetscReal residual[3])
{
  PetscReal theta[3], Q[9], mean[9], momentum[3], inside[3], reached[3];

  for (PetscInt d = 0; d < 3; d++) theta[d] = 0.5 * turn->dt * (turn->spin[d] + spin[d]);
  RigidCayley(theta, Q);
  RigidProduct(turn->begin->rotation, Q, rotation);
  for (PetscInt k = 0; k < 9; k++) mean[k] = 0.5 * (turn->begin->rotation[k] + rotation[k]);
  RigidTorque(mean, turn->dyad, momentum);
  for (PetscInt d = 0; d < 3; d++) momentum[d] = turn->momentum[d] + turn->dt * (momentum[d] + turn->rest[d]);
  RigidMultiplyTransposed(rotation, momentum, inside);
  RigidMultiply(turn->rigid->inverse, inside, reached);
  for (PetscInt d = 0; d < 3; d++) residual[d] = spin[d] - reached[d];
}

/* Newton's method for W_1, from W_0; false where it finds none */
static PetscBool SolveTurn(const Turn *turn, PetscReal spin[3], PetscReal rotation[9])
{
  PetscReal residual[3], scale = 1 / turn->dt, last = PETSC_MAX_REAL;

  for (PetscInt d = 0; d < 3; d++) scale = PetscMax(scale, PetscAbsReal(turn->spin[d]));
  PetscArraycpy(spin, turn->spin, 3);
  for (PetscInt k = 0; k < MAX_ITERATIONS; k++) {
    PetscReal J[9], inverse[9], moved[3], there[9], change[3], size = 0;

    EvaluateTurn(turn, spin, rotation, residual);
    for (PetscInt j = 0; j < 3; j++) {
      PetscReal other[3];

      PetscArraycpy(moved, spin, 3);
      moved[j] += DIFFERENCE * scale;
      EvaluateTurn(turn, moved, there, other);
      for (PetscInt i = 0; i < 3; i++) J[3 * i + j] = (other[i] - residual[i]) / (DIFFERENCE * scale);
    }
    if (!RigidInvert(J, inverse)) return PETSC_FALSE;
    RigidMultiply(inverse, residual, change);
    for (PetscInt d = 0; d < 3; d++) {
      spin[d] -= change[d];
      size = PetscMax(size, PetscAbsReal(change[d]));
    }
    if (PetscIsInfOrNanReal(size)) return PETSC_FALSE;
    /* until round-off ends it */
    if (size <= CONVERGED * scale || (size <= 1e3 * CONVERGED * scale && size >= 0.5 * last)) {
      EvaluateTurn(turn, spin, rotation, residual);
      return PETSC_TRUE;
    }
    last = size;
  }
  return PETSC_FALSE;
}

/* All forces on the nodes, from outside and of contact, at a time and position in the controller step */
static PetscErrorCode FindForces(Body body, PetscReal t, PetscReal position, Vec U, Resultant *resultant)
{
  Vec force = body->work.nodes[0];

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(force));
  PetscCall(BodyAddExternalForce(body, t, 1, force));
  PetscCall(BodyAddContactForce(body, position, 1, U, force));
  PetscCall(BodyRigidFindResultant(body, NULL, force, resultant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rotation at the end of the substep; `torque`: that at its start, as the acceleration there tells */
static PetscErrorCode AdvanceRotation(Body body, PetscReal dt, const RigidMotion *begin, const PetscReal torque[3],
                                      const Resultant forces[2], RigidMotion *end)
{
  const BodyRigid *rigid = BodyGetRigid(body);
  PetscReal        known[3], spin[3], product[3];
  Turn             turn = {.rigid = rigid, .begin = begin, .dt = dt};

  PetscFunctionBegin;
  RigidTorque(begin->rotation, forces[0].dyad, known);
  for (PetscInt d = 0; d < 3; d++) turn.rest[d] = 0.5 * (torque[d] - known[d]);
  for (PetscInt k = 0; k < 9; k++) turn.dyad[k] = 0.5 * (forces[0].dyad[k] + forces[1].dyad[k]);
  RigidMultiplyTransposed(begin->rotation, begin->angular_velocity, turn.spin);
  RigidMultiply(rigid->inertia, turn.spin, product);
  RigidMultiply(begin->rotation, product, turn.momentum);
  if (SolveTurn(&turn, spin, end->rotation)) {
    RigidMultiply(end->rotation, spin, end->angular_velocity);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *end = *begin;
  PetscCall(
      StepFailureSet(&body->failure, STEP_DIVERGED_NEWTON, PETSC_ERR_NOT_CONVERGED,
                     "Rigid body '%s': its rotation in the step that begins at time %.9g s was not found (angular velocity %g, %g, %g "
                     "rad/s); is the time step too large?",
                     body->hdr.name, (double)body->saved.time, (double)begin->angular_velocity[0], (double)begin->angular_velocity[1],
                     (double)begin->angular_velocity[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSRigidFn` */
static PetscErrorCode Advance(TS ts, PetscReal t, PetscReal dt, Vec U, Vec V, void *ctx)
{
  Body            body  = (Body)ctx;
  BodyRigid      *rigid = BodyGetRigid(body);
  const PetscReal from  = (PetscReal)body->time.substep / body->time.substeps;
  const PetscReal to    = (PetscReal)(body->time.substep + 1) / body->time.substeps;
  RigidMotion     begin, end;
  Momentum        impulse;
  Resultant       forces[2];
  PetscReal       torque[3];

  PetscFunctionBegin;
  (void)ts;
  PetscCall(BodyRigidFindMotion(body, U, V, &begin));
  PetscCall(BodyRigidFindMomentum(body, &begin, body->state.a, &impulse));
  PetscCall(FindForces(body, t, from, U, &forces[0]));
  PetscCall(FindForces(body, t + dt, to, U, &forces[1]));
  end = begin;
  for (PetscInt d = 0; d < 3; d++) {
    const PetscReal a0 = impulse.linear[d] / body->mass.total, a1 = forces[1].force[d] / body->mass.total;

    if (BodyRigidIsFixed(body, d)) continue;
    end.centre[d] += dt * (begin.velocity[d] + 0.25 * dt * (a0 + a1));
    end.velocity[d] += 0.5 * dt * (a0 + a1);
  }
  if (rigid->turns && !BodyLeads(body, 3)) PetscCall(AdvanceRotation(body, dt, &begin, impulse.angular, forces, &end));
  RigidTorque(end.rotation, forces[1].dyad, torque);
  BodyRigidFindAcceleration(body, forces[1].force, torque, &end);
  if (BodyIsLed(body) && !body->unloaded) PetscCall(BodyLead(body, t + dt, &end));
  PetscCall(BodyRigidWriteMotion(body, &end, U, V, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where vectors of the first state differ from those of a rigid motion by more than round-off */
static PetscErrorCode CheckStart(Body body, const char what[], Vec given, Vec rigid, PetscReal scale)
{
  PetscReal off;

  PetscFunctionBegin;
  PetscCall(VecAXPY(rigid, -1, given));
  PetscCall(VecNorm(rigid, NORM_INFINITY, &off));
  PetscCheck(off <= OFF * scale, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sinitial_%s: body '%s' is rigid, but its %s at the start is not that of a rigid motion: a node is off by %g of %g",
             ((PetscObject)body)->prefix, what, body->hdr.name, what, (double)off, (double)scale);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first state must be that of a rigid motion; what leads the body holds, as prescribed displacements do. Round-off is taken away. */
static PetscErrorCode Start(Body body)
{
  RigidMotion motion;
  Vec         u = body->work.nodes[1], v = body->work.nodes[2];
  PetscReal   box[6] = {0}, size = 0, largest;

  PetscFunctionBegin;
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  for (PetscInt d = 0; d < body->mesh.dim; d++) size = PetscMax(size, box[3 + d] - box[d]);
  PetscCall(BodyRigidFindMotion(body, body->state.u, body->state.v, &motion));
  PetscCall(BodyRigidWriteMotion(body, &motion, u, v, NULL));
  PetscCall(CheckStart(body, "displacement", body->state.u, u, size));
  PetscCall(VecNorm(body->state.v, NORM_INFINITY, &largest));
  PetscCall(CheckStart(body, "velocity", body->state.v, v, largest));
  if (BodyIsLed(body)) PetscCall(BodyLead(body, body->state.time, &motion));
  PetscCall(BodyRigidWriteMotion(body, &motion, body->state.u, body->state.v, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With what turning takes, and what leads the body */
static PetscErrorCode CompleteStartAcceleration(Body body)
{
  RigidMotion motion;
  Momentum    acceleration;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindMotion(body, body->state.u, body->state.v, &motion));
  PetscCall(BodyRigidFindMomentum(body, &motion, body->state.a, &acceleration));
  BodyRigidFindAcceleration(body, acceleration.linear, acceleration.angular, &motion);
  if (BodyIsLed(body)) PetscCall(BodyLead(body, body->state.time, &motion));
  PetscCall(BodyRigidWriteMotion(body, &motion, NULL, NULL, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetParameters(Body body)
{
  PetscFunctionBegin;
  BodyGetRigid(body)->turns = (PetscBool)(body->mesh.dim > 1 && !body->model.element->axisymmetric);
  PetscCheck(body->time.requested_step >= 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_time_step auto: a rigid body has no stable step to choose a part of; give a number, or leave it out",
             ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyRigidFindInertia(body));
  body->integrator->depends_on_step = PETSC_TRUE;
  PetscCall(TSRigidSetAdvance(body->time.ts, Advance, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyIntegratorCreate_Rigid(BodyIntegrator integrator)
{
  BodyRigid *rigid;

  PetscFunctionBegin;
  PetscCall(PetscNew(&rigid));
  integrator->data                  = rigid;
  integrator->deforms               = PETSC_FALSE;
  integrator->has_inertia           = PETSC_TRUE;
  integrator->affine                = PETSC_TRUE;
  integrator->beta                  = 0.25; /* as far as the body does not turn */
  integrator->gamma                 = 0.5;
  integrator->ops.getparameters     = GetParameters;
  integrator->ops.setup             = SetUp;
  integrator->ops.nodalcolumns      = BodyRigidSetNodalColumns;
  integrator->ops.solvemass         = BodyRigidSolveMass;
  integrator->ops.start             = Start;
  integrator->ops.startacceleration = CompleteStartAcceleration;
  integrator->ops.measure           = BodyRigidMeasure;
  integrator->ops.view              = BodyRigidView;
  PetscFunctionReturn(PETSC_SUCCESS);
}
