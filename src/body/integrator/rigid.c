/*
   A body under TSRIGID: a rigid one, of which forces on its nodes change linear and angular momentum alone.

   The centre of mass moves by the trapezoidal rule, Newmark's of deformable bodies. The body turns by the rule of J. C. Simo and K. K. Wong,
   Unconditionally stable algorithms for rigid body dynamics that exactly preserve energy and momentum, International Journal for Numerical
   Methods in Engineering 31 (1991): with the angular velocity W in the frame of the body, its inertia J there, and the Cayley transform,

     Theta = dt/2 (W_0 + W_1),  R_1 = R_0 cay(Theta),  R_1 J W_1 = R_0 J W_0 + dt T,  T = sum (r_0 + r_1)/2 x (f_0 + f_1)/2.

   So a node moves by u_1 - u_0 = dt V + (R_0 Theta) x (r_0 + r_1)/2, and kinetic energy changes by exactly the work of the mean forces on
   the way of the nodes, sum (f_0 + f_1)/2 . (u_1 - u_0): the same that the partner of a contact takes or gives. W_1 is found by Newton's method.

   The state is that of all bodies: displacement, velocity and acceleration of the nodes. Where the body is follows from them.
*/
#include <body/layout/bodyimpl.h>
#include <checkpoint/checkpoint.h>
#include <impakt/private/bodyrows.h>
#include "rigidmotion.h"

/* Newton's method for the angular velocity: it takes 3 or 4 steps to round-off; the change by which its matrix is found, and when it is
   there, in parts of the angular velocity and of one radian in a step */
#define MAX_ITERATIONS 30
#define DIFFERENCE     1e-7
#define CONVERGED      1e-14
/* By how much the first state may be off a rigid motion, in parts of the body's size or of its largest velocity */
#define OFF 1e-9
/* The compliance of the rows is found anew with new rows once the body has turned by that angle [rad] */
#define TURNED 0.05

typedef struct {
  PetscBool   turns;                   /* it can: not bars and rings */
  PetscReal   inertia[9], inverse[9];  /* about the centre of mass, undeformed; in two dimensions about the third axis alone [kg m^2] */
  PetscReal   spread[9], inverse_spread[9]; /* sum m Y Y^T by the masses of the nodes, Y being positions from the centre [kg m^2] */
  RigidMotion point;                   /* where the compliance of the rows is found: centre and rotation */
} BodyRigid;

/* Momentum and moment of momentum about the centre, of velocities or of forces over mass */
typedef struct {
  PetscReal linear[3], angular[3];
} Momentum;

/* Forces on the nodes as far as a rigid body feels them: their sum [N], and sum f Y^T [N m] */
typedef struct {
  PetscReal force[3], dyad[9];
} Resultant;

static BodyRigid *GetRigid(Body body)
{
  return (BodyRigid *)body->integrator->data;
}

/* Reference position of an owned node from the centre of mass */
static void GetArm(const struct _p_Body *body, PetscInt node, PetscReal Y[3])
{
  const PetscInt dim = body->mesh.dim;

  for (PetscInt d = 0; d < 3; d++) Y[d] = d < dim ? body->mesh.coordinates[node * dim + d] - body->mass.centre[d] : 0;
}

static PetscErrorCode Sum(Body body, PetscInt n, PetscReal sums[])
{
  PetscFunctionBegin;
  if (body->rows.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Centre and rotation of the displacement u; those nearest to it, if it is not rigid */
static PetscErrorCode FindPlace(Body body, Vec u, RigidMotion *motion)
{
  const BodyRigid   *rigid    = GetRigid(body);
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[12] = {0}, A[9];
  const PetscScalar *way, *mass;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(u, &way));
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3];

    GetArm(body, node, Y);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal moment = PetscRealPart(mass[node * dim + d] * way[node * dim + d]);

      sums[d] += moment;
      for (PetscInt b = 0; b < dim; b++) sums[3 + 3 * d + b] += moment * Y[b];
    }
  }
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscCall(VecRestoreArrayRead(u, &way));
  PetscCall(Sum(body, 12, sums));
  for (PetscInt d = 0; d < 3; d++) motion->centre[d] = body->mass.centre[d] + sums[d] / body->mass.total;
  if (rigid->turns) {
    for (PetscInt k = 0; k < 9; k++) A[k] = rigid->spread[k] + sums[3 + k];
    RigidProduct(A, rigid->inverse_spread, motion->rotation);
    if (dim == 2) motion->rotation[8] = 1;
    PetscCheck(RigidFindRotation(motion->rotation), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "Body '%s' is rigid, but its displacement is far from a rigid motion", body->hdr.name);
  } else
    for (PetscInt k = 0; k < 9; k++) motion->rotation[k] = k % 4 ? 0 : 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of velocities or accelerations of the nodes. `work` is overwritten. */
static PetscErrorCode FindMomentum(Body body, const RigidMotion *motion, Vec v, Vec work, Momentum *momentum)
{
  const PetscInt     dim     = body->mesh.dim;
  PetscReal          sums[6] = {0};
  const PetscScalar *p;

  PetscFunctionBegin;
  PetscCall(BodyMultiplyMass(body, v, work));
  PetscCall(VecGetArrayRead(work, &p));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3], r[3], q[3] = {0}, moment[3];

    GetArm(body, node, Y);
    RigidMultiply(motion->rotation, Y, r);
    for (PetscInt d = 0; d < dim; d++) q[d] = PetscRealPart(p[node * dim + d]);
    RigidCross(r, q, moment);
    for (PetscInt d = 0; d < 3; d++) {
      sums[d] += q[d];
      sums[3 + d] += moment[d];
    }
  }
  PetscCall(VecRestoreArrayRead(work, &p));
  PetscCall(Sum(body, 6, sums));
  PetscCall(PetscArraycpy(momentum->linear, sums, 3));
  PetscCall(PetscArraycpy(momentum->angular, sums + 3, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindResultant(Body body, Vec f, Resultant *resultant)
{
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[12] = {0};
  const PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(f, &force));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3];

    GetArm(body, node, Y);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal component = PetscRealPart(force[node * dim + d]);

      sums[d] += component;
      for (PetscInt b = 0; b < dim; b++) sums[3 + 3 * d + b] += component * Y[b];
    }
  }
  PetscCall(VecRestoreArrayRead(f, &force));
  PetscCall(Sum(body, 12, sums));
  PetscCall(PetscArraycpy(resultant->force, sums, 3));
  PetscCall(PetscArraycpy(resultant->dyad, sums + 3, 9));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = R A R^T x */
static void MultiplyTurned(const PetscReal R[9], const PetscReal A[9], const PetscReal x[3], PetscReal y[3])
{
  PetscReal inside[3], product[3];

  RigidMultiplyTransposed(R, x, inside);
  RigidMultiply(A, inside, product);
  RigidMultiply(R, product, y);
}

/* Displacement, velocity and acceleration of the nodes; each may be NULL. Those of bodies that cannot turn all move alike. */
static PetscErrorCode WriteMotion(Body body, const RigidMotion *motion, Vec u, Vec v, Vec a)
{
  const Vec    vecs[3] = {u, v, a};
  PetscInt     dim     = body->mesh.dim;
  PetscScalar *values[3] = {NULL};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3; k++)
    if (vecs[k]) PetscCall(VecGetArrayWrite(vecs[k], &values[k]));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3], r[3], spin[3], pull[3], twist[3];

    GetArm(body, node, Y);
    RigidMultiply(motion->rotation, Y, r);
    RigidCross(motion->angular_velocity, r, spin);
    RigidCross(motion->angular_velocity, spin, pull);
    RigidCross(motion->angular_acceleration, r, twist);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt i = node * dim + d;

      if (u) values[0][i] = motion->centre[d] - body->mass.centre[d] + (r[d] - Y[d]);
      if (v) values[1][i] = motion->velocity[d] + spin[d];
      if (a) values[2][i] = motion->acceleration[d] + twist[d] + pull[d];
    }
  }
  for (PetscInt k = 0; k < 3; k++)
    if (vecs[k]) PetscCall(VecRestoreArrayWrite(vecs[k], &values[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Components that nothing moves: rings along their radius */
static PetscBool IsFixed(const struct _p_Body *body, PetscInt d)
{
  return (PetscBool)(d >= body->mesh.dim || (body->model.element->axisymmetric && d == 0));
}

/* Velocities of the centre and about it, from momenta */
static void FindVelocity(Body body, const Momentum *momentum, RigidMotion *motion)
{
  const BodyRigid *rigid = GetRigid(body);

  for (PetscInt d = 0; d < 3; d++) motion->velocity[d] = IsFixed(body, d) ? 0 : momentum->linear[d] / body->mass.total;
  if (rigid->turns) MultiplyTurned(motion->rotation, rigid->inverse, momentum->angular, motion->angular_velocity);
  else
    for (PetscInt d = 0; d < 3; d++) motion->angular_velocity[d] = 0;
}

/* Accelerations from forces and torques; the angular velocity is there: T = J alpha + omega x J omega */
static void FindAcceleration(Body body, const PetscReal force[3], const PetscReal torque[3], RigidMotion *motion)
{
  const BodyRigid *rigid = GetRigid(body);
  PetscReal        spin[3], gyroscopic[3], rest[3];

  for (PetscInt d = 0; d < 3; d++) {
    motion->acceleration[d]         = IsFixed(body, d) ? 0 : force[d] / body->mass.total;
    motion->angular_acceleration[d] = 0;
  }
  if (!rigid->turns) return;
  MultiplyTurned(motion->rotation, rigid->inertia, motion->angular_velocity, spin);
  RigidCross(motion->angular_velocity, spin, gyroscopic);
  for (PetscInt d = 0; d < 3; d++) rest[d] = torque[d] - gyroscopic[d];
  MultiplyTurned(motion->rotation, rigid->inverse, rest, motion->angular_acceleration);
}

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
  PetscCall(FindResultant(body, force, resultant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rotation at the end of the substep; `torque`: that at its start, as the acceleration there tells */
static PetscErrorCode AdvanceRotation(Body body, PetscReal dt, const RigidMotion *begin, const PetscReal torque[3],
                                      const Resultant forces[2], RigidMotion *end)
{
  const BodyRigid *rigid = GetRigid(body);
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
  PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_NEWTON, PETSC_ERR_NOT_CONVERGED,
                           "Rigid body '%s': its rotation in the step that begins at time %.9g s was not found (angular velocity %g, %g, %g "
                           "rad/s); is the time step too large?",
                           body->hdr.name, (double)body->saved.time, (double)begin->angular_velocity[0],
                           (double)begin->angular_velocity[1], (double)begin->angular_velocity[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSRigidFn` */
static PetscErrorCode Advance(TS ts, PetscReal t, PetscReal dt, Vec U, Vec V, void *ctx)
{
  Body            body  = (Body)ctx;
  BodyRigid      *rigid = GetRigid(body);
  const PetscReal from  = (PetscReal)body->time.substep / body->time.substeps;
  const PetscReal to    = (PetscReal)(body->time.substep + 1) / body->time.substeps;
  RigidMotion     begin, end;
  Momentum        motion, impulse;
  Resultant       forces[2];
  PetscReal       torque[3];

  PetscFunctionBegin;
  (void)ts;
  PetscCall(PetscMemzero(&begin, sizeof(begin)));
  PetscCall(FindPlace(body, U, &begin));
  PetscCall(FindMomentum(body, &begin, V, body->work.nodes[0], &motion));
  PetscCall(FindMomentum(body, &begin, body->state.a, body->work.nodes[0], &impulse));
  FindVelocity(body, &motion, &begin);
  PetscCall(FindForces(body, t, from, U, &forces[0]));
  PetscCall(FindForces(body, t + dt, to, U, &forces[1]));
  end = begin;
  for (PetscInt d = 0; d < 3; d++) {
    const PetscReal a0 = impulse.linear[d] / body->mass.total, a1 = forces[1].force[d] / body->mass.total;

    if (IsFixed(body, d)) continue;
    end.centre[d] += dt * (begin.velocity[d] + 0.25 * dt * (a0 + a1));
    end.velocity[d] += 0.5 * dt * (a0 + a1);
  }
  if (rigid->turns && !BodyLeads(body, 3)) PetscCall(AdvanceRotation(body, dt, &begin, impulse.angular, forces, &end));
  RigidTorque(end.rotation, forces[1].dyad, torque);
  FindAcceleration(body, forces[1].force, torque, &end);
  if (BodyIsLed(body) && !body->unloaded) PetscCall(BodyLead(body, t + dt, &end));
  PetscCall(WriteMotion(body, &end, U, V, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Accelerations of the nodes that forces on them bring, where the body is at a place: M^{-1} f within rigid motions that are not led */
static PetscErrorCode Respond(Body body, const RigidMotion *place, Vec f, Vec a)
{
  RigidMotion motion = *place;
  Resultant   resultant;
  PetscReal   torque[3];

  PetscFunctionBegin;
  PetscCall(FindResultant(body, f, &resultant));
  for (PetscInt d = 0; d < 3; d++) motion.angular_velocity[d] = 0;
  RigidTorque(motion.rotation, resultant.dyad, torque);
  FindAcceleration(body, resultant.force, torque, &motion);
  for (PetscInt d = 0; d < 3; d++) {
    if (BodyLeads(body, d)) motion.acceleration[d] = 0;
    if (BodyLeads(body, 3)) motion.angular_acceleration[d] = 0;
  }
  PetscCall(WriteMotion(body, &motion, NULL, NULL, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveMass(Body body, Vec f, Vec a)
{
  RigidMotion place;

  PetscFunctionBegin;
  PetscCall(FindPlace(body, body->state.u, &place));
  PetscCall(Respond(body, &place, f, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B M^{-1} B^T force on the rows, at the point of the compliance */
static PetscErrorCode MultiplyMobility(Body body, Vec force, Vec result)
{
  PetscFunctionBegin;
  PetscCall(MatMultTranspose(body->rows.free_matrix, force, body->work.nodes[0]));
  PetscCall(Respond(body, &GetRigid(body)->point, body->work.nodes[0], body->work.nodes[1]));
  PetscCall(MatMult(body->rows.free_matrix, body->work.nodes[1], result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyCompliance(Body body, Vec force, Vec displacement)
{
  PetscFunctionBegin;
  PetscCall(MultiplyMobility(body, force, displacement));
  PetscCall(VecScale(displacement, 0.25 * PetscSqr(body->time.step)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The trapezoidal rule from rest, a force of 1 N at the end of the first substep alone: a way of dt^2/4 in it, then of dt^2 in each */
static PetscErrorCode ComputeComplianceColumn(Body body, PetscInt row, PetscScalar column[])
{
  const PetscReal    square = PetscSqr(body->time.step);
  const PetscInt     n = body->rows.local, local = row - body->rows.begin;
  const PetscScalar *moved;
  PetscScalar       *unit;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(body->work.rows[0], &unit));
  for (PetscInt i = 0; i < n; i++) unit[i] = i == local ? 1 : 0;
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &unit));
  PetscCall(MultiplyMobility(body, body->work.rows[0], body->work.rows[1]));
  PetscCall(VecGetArrayRead(body->work.rows[1], &moved));
  for (PetscInt k = 0; k < body->time.substeps; k++)
    for (PetscInt i = 0; i < n; i++) column[k * n + i] = (k ? k : 0.25) * square * moved[i];
  PetscCall(VecRestoreArrayRead(body->work.rows[1], &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows are found anew where the body is, once it has turned by much; those with new entries are forgotten in any case */
static PetscErrorCode SetRows(Body body, const PetscMPIInt changed[])
{
  BodyRigid   *rigid = GetRigid(body);
  PetscMPIInt *all   = body->rows.changed;
  RigidMotion  place;

  PetscFunctionBegin;
  PetscCall(FindPlace(body, body->saved.u, &place));
  if (RigidAngle(place.rotation, rigid->point.rotation) < TURNED) PetscFunctionReturn(PETSC_SUCCESS);
  rigid->point = place;
  (void)changed;
  for (PetscInt i = 0; i < body->rows.global; i++) all[i] = 1; /* which is where the caller looks as well */
  PetscCall(BodyForgetCompliance(body, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For steps of another length the compliance is found where the body is */
static PetscErrorCode Renew(Body body)
{
  PetscFunctionBegin;
  PetscCall(FindPlace(body, body->saved.u, &GetRigid(body)->point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitPoint(Body body, PetscInt level, Checkpoint checkpoint)
{
  RigidMotion *point = &GetRigid(body)->point;

  PetscFunctionBegin;
  if (level) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "compliance at centre", 3, point->centre));
  PetscCall(CheckpointVisitReals(checkpoint, "compliance at rotation", 9, point->rotation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyPoint(Body body, PetscBool back, Vec point, PetscReal numbers[2])
{
  RigidMotion *place = &GetRigid(body)->point;

  PetscFunctionBegin;
  numbers[0] = numbers[1] = 0;
  if (back) PetscCall(FindPlace(body, point, place));
  else PetscCall(WriteMotion(body, place, point, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Everything is written by Advance() */
static PetscErrorCode FinishSubstep(Body body)
{
  PetscFunctionBegin;
  (void)body;
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
  Momentum    momentum;
  Vec         u = body->work.nodes[1], v = body->work.nodes[2];
  PetscReal   box[6] = {0}, size = 0, largest;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(&motion, sizeof(motion)));
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  for (PetscInt d = 0; d < body->mesh.dim; d++) size = PetscMax(size, box[3 + d] - box[d]);
  PetscCall(FindPlace(body, body->state.u, &motion));
  PetscCall(FindMomentum(body, &motion, body->state.v, body->work.nodes[0], &momentum));
  FindVelocity(body, &momentum, &motion);
  PetscCall(WriteMotion(body, &motion, u, v, NULL));
  PetscCall(CheckStart(body, "displacement", body->state.u, u, size));
  PetscCall(VecNorm(body->state.v, NORM_INFINITY, &largest));
  PetscCall(CheckStart(body, "velocity", body->state.v, v, largest));
  if (BodyIsLed(body)) PetscCall(BodyLead(body, body->state.time, &motion));
  PetscCall(WriteMotion(body, &motion, body->state.u, body->state.v, NULL));
  GetRigid(body)->point = motion;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With what turning takes, and what leads the body */
static PetscErrorCode CompleteStartAcceleration(Body body)
{
  RigidMotion motion;
  Momentum    velocity, acceleration;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(&motion, sizeof(motion)));
  PetscCall(FindPlace(body, body->state.u, &motion));
  PetscCall(FindMomentum(body, &motion, body->state.v, body->work.nodes[0], &velocity));
  PetscCall(FindMomentum(body, &motion, body->state.a, body->work.nodes[0], &acceleration));
  FindVelocity(body, &velocity, &motion);
  FindAcceleration(body, acceleration.linear, acceleration.angular, &motion);
  if (BodyIsLed(body)) PetscCall(BodyLead(body, body->state.time, &motion));
  PetscCall(WriteMotion(body, &motion, NULL, NULL, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetParameters(Body body)
{
  PetscFunctionBegin;
  GetRigid(body)->turns = (PetscBool)(body->mesh.dim > 1 && !body->model.element->axisymmetric);
  PetscCheck(body->time.requested_step >= 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%sts_time_step auto: a rigid body has no stable step to choose a part of; give a number, or leave it out",
             ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Second moments of the mass: of the mass matrix, which have the inertia in them, and of the masses of the nodes, by which a place is found */
static PetscErrorCode FindInertia(Body body)
{
  BodyRigid         *rigid    = GetRigid(body);
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[18] = {0}, trace;
  PetscScalar       *arm;
  const PetscScalar *moment, *mass;
  Vec                Y = body->work.nodes[0], MY = body->work.nodes[1];

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(Y, &arm));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal y[3];

    GetArm(body, node, y);
    for (PetscInt d = 0; d < dim; d++) arm[node * dim + d] = y[d];
  }
  PetscCall(VecRestoreArrayWrite(Y, &arm));
  PetscCall(BodyMultiplyMass(body, Y, MY));
  PetscCall(VecGetArrayRead(MY, &moment));
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal y[3];

    GetArm(body, node, y);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        sums[3 * a + b] += y[a] * PetscRealPart(moment[node * dim + b]);
        sums[9 + 3 * a + b] += y[a] * y[b] * PetscRealPart(mass[node * dim + b]);
      }
  }
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscCall(VecRestoreArrayRead(MY, &moment));
  PetscCall(Sum(body, 18, sums));
  PetscCall(PetscArraycpy(rigid->spread, sums + 9, 9));
  if (!rigid->turns) PetscFunctionReturn(PETSC_SUCCESS);
  trace = sums[0] + sums[4] + sums[8];
  if (dim == 2) {
    rigid->inertia[8] = trace;
    rigid->inverse[8] = 1 / trace;
    rigid->spread[8]  = 1; /* nothing lies across the plane */
  } else {
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++) rigid->inertia[3 * i + j] = (i == j ? trace : 0) - 0.5 * (sums[3 * i + j] + sums[3 * j + i]);
    PetscCheck(RigidInvert(rigid->inertia, rigid->inverse), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "Rigid body '%s' has no moment of inertia about some axis: its mesh is a line", body->hdr.name);
  }
  PetscCheck(RigidInvert(rigid->spread, rigid->inverse_spread), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Rigid body '%s': all nodes of its mesh lie in one plane", body->hdr.name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Body body)
{
  PetscFunctionBegin;
  PetscCall(FindInertia(body));
  body->integrator->depends_on_step = PETSC_TRUE;
  body->integrator->feels_end_force = PETSC_TRUE;
  PetscCall(TSRigidSetAdvance(body->time.ts, Advance, body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Newmark's formulas, as far as the body does not turn */
static PetscErrorCode GetRates(Body body, PetscReal velocity[3], PetscReal acceleration[3])
{
  const PetscReal dt = body->time.step;

  PetscFunctionBegin;
  velocity[0]     = 2 / dt;
  velocity[1]     = -1;
  velocity[2]     = 0;
  acceleration[0] = 4 / (dt * dt);
  acceleration[1] = -4 / dt;
  acceleration[2] = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure(Body body, BodyMeasures *measures)
{
  RigidMotion motion;
  Momentum    momentum;

  PetscFunctionBegin;
  PetscCall(FindPlace(body, body->state.u, &motion));
  PetscCall(FindMomentum(body, &motion, body->state.v, body->work.nodes[1], &momentum));
  FindVelocity(body, &momentum, &motion);
  PetscCall(PetscArraycpy(measures->place, motion.centre, 3));
  PetscCall(PetscArraycpy(measures->angular_velocity, motion.angular_velocity, 3));
  RigidFindVector(motion.rotation, measures->orientation);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode View(Body body, PetscViewer viewer)
{
  const PetscReal *J = GetRigid(body)->inertia;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  rigid, centre of mass (%g, %g, %g) m\n", (double)body->mass.centre[0],
                                   (double)body->mass.centre[1], (double)body->mass.centre[2]));
  if (GetRigid(body)->turns && body->mesh.dim == 2)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  moment of inertia %g kg m^2\n", (double)J[8]));
  if (GetRigid(body)->turns && body->mesh.dim == 3)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  inertia xx %g, yy %g, zz %g, xy %g, yz %g, xz %g kg m^2\n", (double)J[0], (double)J[4],
                                     (double)J[8], (double)J[1], (double)J[5], (double)J[2]));
  if (BodyIsLed(body)) PetscCall(PetscViewerASCIIPrintf(viewer, "  led by formulas\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(body->integrator->data));
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
  integrator->ops.getparameters     = GetParameters;
  integrator->ops.setup             = SetUp;
  integrator->ops.setrows           = SetRows;
  integrator->ops.renew             = Renew;
  integrator->ops.finishsubstep     = FinishSubstep;
  integrator->ops.visit             = VisitPoint;
  integrator->ops.copypoint         = CopyPoint;
  integrator->ops.compliancecolumn  = ComputeComplianceColumn;
  integrator->ops.applycompliance   = ApplyCompliance;
  integrator->ops.solvemass         = SolveMass;
  integrator->ops.start             = Start;
  integrator->ops.startacceleration = CompleteStartAcceleration;
  integrator->ops.rates             = GetRates;
  integrator->ops.measure           = Measure;
  integrator->ops.view              = View;
  integrator->ops.destroy           = Destroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
