/* Where a rigid body is and how it moves, from its nodes, and the nodes from that; momenta, resultants of forces, inertia. */
#include "rigidimpl.h"
#include <sys/units.h>

BodyRigid *BodyGetRigid(Body body)
{
  return (BodyRigid *)body->integrator->data;
}

/* Reference position of an owned node from the centre of mass */
void BodyRigidGetArm(const struct _p_Body *body, PetscInt node, PetscReal Y[3])
{
  const PetscInt dim = body->mesh.dim;

  for (PetscInt d = 0; d < 3; d++) Y[d] = d < dim ? body->mesh.coordinates[node * dim + d] - body->mass.centre[d] : 0;
}

/* Sums over all ranks */
PetscErrorCode BodyRigidSum(Body body, PetscInt n, PetscReal sums[])
{
  PetscFunctionBegin;
  if (body->rows.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Centre and rotation of the displacement u; those nearest to it, if it is not rigid */
PetscErrorCode BodyRigidFindPlace(Body body, Vec u, RigidMotion *motion)
{
  const BodyRigid   *rigid    = BodyGetRigid(body);
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[12] = {0}, A[9];
  const PetscScalar *way, *mass;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(u, &way));
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3];

    BodyRigidGetArm(body, node, Y);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal moment = PetscRealPart(mass[node * dim + d] * way[node * dim + d]);

      sums[d] += moment;
      for (PetscInt b = 0; b < dim; b++) sums[3 + 3 * d + b] += moment * Y[b];
    }
  }
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscCall(VecRestoreArrayRead(u, &way));
  PetscCall(BodyRigidSum(body, 12, sums));
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

/* Of velocities or accelerations of the nodes */
PetscErrorCode BodyRigidFindMomentum(Body body, const RigidMotion *motion, Vec v, Momentum *momentum)
{
  const PetscInt     dim     = body->mesh.dim;
  const Vec          work    = body->work.nodes[0];
  PetscReal          sums[6] = {0};
  const PetscScalar *p;

  PetscFunctionBegin;
  PetscCall(BodyMultiplyMass(body, v, work));
  PetscCall(VecGetArrayRead(work, &p));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3], r[3], q[3] = {0}, moment[3];

    BodyRigidGetArm(body, node, Y);
    RigidMultiply(motion->rotation, Y, r);
    for (PetscInt d = 0; d < dim; d++) q[d] = PetscRealPart(p[node * dim + d]);
    RigidCross(r, q, moment);
    for (PetscInt d = 0; d < 3; d++) {
      sums[d] += q[d];
      sums[3 + d] += moment[d];
    }
  }
  PetscCall(VecRestoreArrayRead(work, &p));
  PetscCall(BodyRigidSum(body, 6, sums));
  PetscCall(PetscArraycpy(momentum->linear, sums, 3));
  PetscCall(PetscArraycpy(momentum->angular, sums + 3, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidFindResultant(Body body, Vec f, Resultant *resultant)
{
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[12] = {0};
  const PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(f, &force));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3];

    BodyRigidGetArm(body, node, Y);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal component = PetscRealPart(force[node * dim + d]);

      sums[d] += component;
      for (PetscInt b = 0; b < dim; b++) sums[3 + 3 * d + b] += component * Y[b];
    }
  }
  PetscCall(VecRestoreArrayRead(f, &force));
  PetscCall(BodyRigidSum(body, 12, sums));
  PetscCall(PetscArraycpy(resultant->force, sums, 3));
  PetscCall(PetscArraycpy(resultant->dyad, sums + 3, 9));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement, velocity and acceleration of the nodes; each may be NULL. Those of bodies that cannot turn all move alike. */
PetscErrorCode BodyRigidWriteMotion(Body body, const RigidMotion *motion, Vec u, Vec v, Vec a)
{
  const Vec    vecs[3]   = {u, v, a};
  PetscInt     dim       = body->mesh.dim;
  PetscScalar *values[3] = {NULL};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3; k++)
    if (vecs[k]) PetscCall(VecGetArrayWrite(vecs[k], &values[k]));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3], r[3], spin[3], pull[3], twist[3];

    BodyRigidGetArm(body, node, Y);
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
PetscBool BodyRigidIsFixed(const struct _p_Body *body, PetscInt d)
{
  return (PetscBool)(d >= body->mesh.dim || (body->model.element->axisymmetric && d == 0));
}

/* y = R A R^T x */
static void MultiplyTurned(const PetscReal R[9], const PetscReal A[9], const PetscReal x[3], PetscReal y[3])
{
  PetscReal inside[3], product[3];

  RigidMultiplyTransposed(R, x, inside);
  RigidMultiply(A, inside, product);
  RigidMultiply(R, product, y);
}

/* Centre, rotation, and velocities of the centre and about it, of the displacement u and the velocity v */
PetscErrorCode BodyRigidFindMotion(Body body, Vec u, Vec v, RigidMotion *motion)
{
  const BodyRigid *rigid = BodyGetRigid(body);
  Momentum         momentum;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(motion, sizeof(*motion)));
  PetscCall(BodyRigidFindPlace(body, u, motion));
  PetscCall(BodyRigidFindMomentum(body, motion, v, &momentum));
  for (PetscInt d = 0; d < 3; d++) motion->velocity[d] = BodyRigidIsFixed(body, d) ? 0 : momentum.linear[d] / body->mass.total;
  if (rigid->turns) MultiplyTurned(motion->rotation, rigid->inverse, momentum.angular, motion->angular_velocity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Accelerations from forces and torques; the angular velocity is there: T = J alpha + omega x J omega */
void BodyRigidFindAcceleration(Body body, const PetscReal force[3], const PetscReal torque[3], RigidMotion *motion)
{
  const BodyRigid *rigid = BodyGetRigid(body);
  PetscReal        spin[3], gyroscopic[3], rest[3];

  for (PetscInt d = 0; d < 3; d++) {
    motion->acceleration[d]         = BodyRigidIsFixed(body, d) ? 0 : force[d] / body->mass.total;
    motion->angular_acceleration[d] = 0;
  }
  if (!rigid->turns) return;
  MultiplyTurned(motion->rotation, rigid->inertia, motion->angular_velocity, spin);
  RigidCross(motion->angular_velocity, spin, gyroscopic);
  for (PetscInt d = 0; d < 3; d++) rest[d] = torque[d] - gyroscopic[d];
  MultiplyTurned(motion->rotation, rigid->inverse, rest, motion->angular_acceleration);
}

/* Second moments of the mass matrix, which have the inertia in them, and of the masses of nodes, by which a place is found */
PetscErrorCode BodyRigidFindInertia(Body body)
{
  BodyRigid         *rigid    = BodyGetRigid(body);
  const PetscInt     dim      = body->mesh.dim;
  PetscReal          sums[18] = {0}, trace;
  PetscScalar       *arm;
  const PetscScalar *moment, *mass;
  Vec                Y = body->work.nodes[0], MY = body->work.nodes[1];

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(Y, &arm));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal y[3];

    BodyRigidGetArm(body, node, y);
    for (PetscInt d = 0; d < dim; d++) arm[node * dim + d] = y[d];
  }
  PetscCall(VecRestoreArrayWrite(Y, &arm));
  PetscCall(BodyMultiplyMass(body, Y, MY));
  PetscCall(VecGetArrayRead(MY, &moment));
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal y[3];

    BodyRigidGetArm(body, node, y);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        sums[3 * a + b] += y[a] * PetscRealPart(moment[node * dim + b]);
        sums[9 + 3 * a + b] += y[a] * y[b] * PetscRealPart(mass[node * dim + b]);
      }
  }
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscCall(VecRestoreArrayRead(MY, &moment));
  PetscCall(BodyRigidSum(body, 18, sums));
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

PetscErrorCode BodyRigidMeasure(Body body, BodyMeasures *measures)
{
  RigidMotion motion;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindMotion(body, body->state.u, body->state.v, &motion));
  PetscCall(PetscArraycpy(measures->place, motion.centre, 3));
  PetscCall(PetscArraycpy(measures->angular_velocity, motion.angular_velocity, 3));
  RigidFindVector(motion.rotation, measures->orientation);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidView(Body body, PetscViewer viewer)
{
  const PetscReal *J = BodyGetRigid(body)->inertia;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  rigid, centre of mass (%g, %g, %g)%s\n", (double)body->mass.centre[0],
                                   (double)body->mass.centre[1], (double)body->mass.centre[2], UnitsOf((PetscObject)body, UNIT_LENGTH)));
  if (BodyGetRigid(body)->turns && body->mesh.dim == 2)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  moment of inertia %g%s\n", (double)J[8], UnitsOf((PetscObject)body, UNIT_INERTIA)));
  if (BodyGetRigid(body)->turns && body->mesh.dim == 3)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  inertia xx %g, yy %g, zz %g, xy %g, yz %g, xz %g%s\n", (double)J[0], (double)J[4],
                                     (double)J[8], (double)J[1], (double)J[5], (double)J[2], UnitsOf((PetscObject)body, UNIT_INERTIA)));
  if (BodyIsLed(body)) PetscCall(PetscViewerASCIIPrintf(viewer, "  led by formulas\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
