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
PetscErrorCode BodyRigidSum(Body body, Resultant *resultant)
{
  const PetscMPIInt n = sizeof(*resultant) / sizeof(PetscReal);

  PetscFunctionBegin;
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, resultant, n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sum of vectors of the nodes, and of their dyads with the arms: of `x`, or of each of its components times that of `weights` */
PetscErrorCode BodyRigidFindResultant(Body body, Vec weights, Vec x, Resultant *resultant)
{
  const PetscInt     dim = body->mesh.dim;
  const PetscScalar *values, *weight = NULL;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(resultant, sizeof(*resultant)));
  PetscCall(VecGetArrayRead(x, &values));
  if (weights) PetscCall(VecGetArrayRead(weights, &weight));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal Y[3];

    BodyRigidGetArm(body, node, Y);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt  i         = node * dim + d;
      const PetscReal component = PetscRealPart(weights ? weight[i] * values[i] : values[i]);

      resultant->force[d] += component;
      for (PetscInt b = 0; b < dim; b++) resultant->dyad[3 * d + b] += component * Y[b];
    }
  }
  if (weights) PetscCall(VecRestoreArrayRead(weights, &weight));
  PetscCall(VecRestoreArrayRead(x, &values));
  PetscCall(BodyRigidSum(body, resultant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Centre and rotation of the displacement u; those nearest to it, if it is not rigid */
PetscErrorCode BodyRigidFindPlace(Body body, Vec u, RigidMotion *motion)
{
  const BodyRigid *rigid = BodyGetRigid(body);
  Resultant        moved;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindResultant(body, body->mass.row_sum, u, &moved));
  for (PetscInt d = 0; d < 3; d++) motion->centre[d] = body->mass.centre[d] + moved.force[d] / body->mass.total;
  if (rigid->turns) {
    for (PetscInt k = 0; k < 9; k++) moved.dyad[k] += rigid->spread[k];
    RigidProduct(moved.dyad, rigid->inverse_spread, motion->rotation);
    if (body->mesh.dim == 2) motion->rotation[8] = 1;
    PetscCheck(RigidFindRotation(motion->rotation), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "Body '%s' is rigid, but its displacement is far from a rigid motion", body->hdr.name);
  } else
    for (PetscInt k = 0; k < 9; k++) motion->rotation[k] = k % 4 ? 0 : 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of velocities or accelerations of the nodes */
PetscErrorCode BodyRigidFindMomentum(Body body, const RigidMotion *motion, Vec v, Momentum *momentum)
{
  Resultant sums;

  PetscFunctionBegin;
  PetscCall(BodyMultiplyMass(body, v, body->work.nodes[0]));
  PetscCall(BodyRigidFindResultant(body, NULL, body->work.nodes[0], &sums));
  PetscCall(PetscArraycpy(momentum->linear, sums.force, 3));
  RigidTorque(motion->rotation, sums.dyad, momentum->angular);
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
  BodyRigid     *rigid = BodyGetRigid(body);
  const PetscInt dim   = body->mesh.dim;
  PetscReal      trace;
  PetscScalar   *arm;
  Vec            Y = body->work.nodes[0], MY = body->work.nodes[1];
  Resultant      moments, spread;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(Y, &arm));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++) arm[i] = body->mesh.coordinates[i] - body->mass.centre[i % dim];
  PetscCall(VecRestoreArrayWrite(Y, &arm));
  PetscCall(BodyMultiplyMass(body, Y, MY));
  PetscCall(BodyRigidFindResultant(body, NULL, MY, &moments));
  PetscCall(BodyRigidFindResultant(body, body->mass.row_sum, Y, &spread));
  PetscCall(PetscArraycpy(rigid->spread, spread.dyad, 9));
  if (!rigid->turns) PetscFunctionReturn(PETSC_SUCCESS);
  trace = moments.dyad[0] + moments.dyad[4] + moments.dyad[8];
  if (dim == 2) {
    rigid->inertia[8] = trace;
    rigid->inverse[8] = 1 / trace;
    rigid->spread[8]  = 1; /* nothing lies across the plane */
  } else {
    for (PetscInt i = 0; i < 3; i++)
      for (PetscInt j = 0; j < 3; j++)
        rigid->inertia[3 * i + j] = (i == j ? trace : 0) - 0.5 * (moments.dyad[3 * i + j] + moments.dyad[3 * j + i]);
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
