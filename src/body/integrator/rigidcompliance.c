/* How a rigid body answers to forces on its nodes and on its rows: M^{-1} within rigid motions. */
#include "rigidimpl.h"
#include <checkpoint/checkpoint.h>
#include <impakt/private/bodyrows.h>

/* The compliance of the rows is found anew with new rows once the body has turned by that angle [rad] */
#define TURNED 0.05

/* Accelerations of the nodes that forces on them bring, where the body is at a place: M^{-1} f within rigid motions that are not led */
static PetscErrorCode Respond(Body body, const RigidMotion *place, Vec f, Vec a)
{
  RigidMotion motion = *place;
  Resultant   resultant;
  PetscReal   torque[3];

  PetscFunctionBegin;
  PetscCall(BodyRigidFindResultant(body, f, &resultant));
  for (PetscInt d = 0; d < 3; d++) motion.angular_velocity[d] = 0;
  RigidTorque(motion.rotation, resultant.dyad, torque);
  BodyRigidFindAcceleration(body, resultant.force, torque, &motion);
  for (PetscInt d = 0; d < 3; d++) {
    if (BodyLeads(body, d)) motion.acceleration[d] = 0;
    if (BodyLeads(body, 3)) motion.angular_acceleration[d] = 0;
  }
  PetscCall(BodyRigidWriteMotion(body, &motion, NULL, NULL, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidSolveMass(Body body, Vec f, Vec a)
{
  RigidMotion place;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindPlace(body, body->state.u, &place));
  PetscCall(Respond(body, &place, f, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B M^{-1} B^T force on the rows, at the point of the compliance */
static PetscErrorCode MultiplyMobility(Body body, Vec force, Vec result)
{
  PetscFunctionBegin;
  PetscCall(MatMultTranspose(body->rows.free_matrix, force, body->work.nodes[0]));
  PetscCall(Respond(body, &BodyGetRigid(body)->point, body->work.nodes[0], body->work.nodes[1]));
  PetscCall(MatMult(body->rows.free_matrix, body->work.nodes[1], result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidApplyCompliance(Body body, Vec force, Vec displacement)
{
  PetscFunctionBegin;
  PetscCall(MultiplyMobility(body, force, displacement));
  PetscCall(VecScale(displacement, 0.25 * PetscSqr(body->time.step)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the body will be in the middle of the controller step, if it goes on as it does: forces turn it by their moments there */
static PetscErrorCode FindMiddle(Body body, PetscReal half, RigidMotion *middle)
{
  RigidMotion begin;
  Momentum    momentum;
  PetscReal   way[3], turn[9];

  PetscFunctionBegin;
  PetscCall(PetscMemzero(&begin, sizeof(begin)));
  PetscCall(BodyRigidFindPlace(body, body->saved.u, &begin));
  PetscCall(BodyRigidFindMomentum(body, &begin, body->saved.v, body->work.nodes[0], &momentum));
  BodyRigidFindVelocity(body, &momentum, &begin);
  for (PetscInt d = 0; d < 3; d++) way[d] = half * begin.angular_velocity[d];
  RigidCayley(way, turn);
  *middle = begin;
  RigidProduct(turn, begin.rotation, middle->rotation);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacements of nodes at the end of the controller step under unit forces on them: by the trapezoidal rule, which is exact for constant
   forces, and makes ways of forces that grow by 1/12 of their change in a substep too much */
PetscErrorCode BodyRigidSetNodalColumns(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], Compliance nodal)
{
  const PetscReal    all    = body->time.substeps * body->time.step;
  const PetscReal    factor = shape == BODY_FORCE_CONSTANT ? PetscSqr(all) / 2 : PetscSqr(all) / 6 + PetscSqr(body->time.step) / 12;
  Vec                force = body->work.nodes[0], moved = body->work.nodes[1];
  const PetscScalar *way;
  RigidMotion        middle;
  PetscInt           begin, end;

  PetscFunctionBegin;
  PetscCall(FindMiddle(body, all / 2, &middle));
  PetscCall(VecGetOwnershipRange(force, &begin, &end));
  for (PetscInt i = 0; i < n; i++) {
    if (ComplianceKnows(nodal, dofs[i])) continue;
    PetscCall(VecZeroEntries(force));
    if (dofs[i] >= begin && dofs[i] < end) PetscCall(VecSetValue(force, dofs[i], 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(force));
    PetscCall(VecAssemblyEnd(force));
    PetscCall(Respond(body, &middle, force, moved));
    PetscCall(VecScale(moved, factor));
    PetscCall(VecGetArrayRead(moved, &way));
    PetscCall(ComplianceSetColumn(nodal, dofs[i], 1, way));
    PetscCall(VecRestoreArrayRead(moved, &way));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All rows are found anew where the body is, once it has turned by much; those with new entries are forgotten in any case */
PetscErrorCode BodyRigidSetRows(Body body, const PetscMPIInt changed[])
{
  BodyRigid   *rigid = BodyGetRigid(body);
  PetscMPIInt *all   = body->rows.changed;
  RigidMotion  place;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindPlace(body, body->saved.u, &place));
  if (RigidAngle(place.rotation, rigid->point.rotation) < TURNED) PetscFunctionReturn(PETSC_SUCCESS);
  rigid->point = place;
  (void)changed;
  for (PetscInt i = 0; i < body->rows.global; i++) all[i] = 1; /* which is where the caller looks as well */
  PetscCall(BodyForgetCompliance(body, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For steps of another length the compliance is found where the body is */
PetscErrorCode BodyRigidRenew(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyRigidFindPlace(body, body->saved.u, &BodyGetRigid(body)->point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidVisit(Body body, PetscInt level, Checkpoint checkpoint)
{
  RigidMotion *point = &BodyGetRigid(body)->point;

  PetscFunctionBegin;
  if (level) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "compliance at centre", 3, point->centre));
  PetscCall(CheckpointVisitReals(checkpoint, "compliance at rotation", 9, point->rotation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRigidCopyPoint(Body body, PetscBool back, Vec point, PetscReal numbers[2])
{
  RigidMotion *place = &BodyGetRigid(body)->point;

  PetscFunctionBegin;
  numbers[0] = numbers[1] = 0;
  if (back) PetscCall(BodyRigidFindPlace(body, point, place));
  else PetscCall(BodyRigidWriteMotion(body, place, point, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
