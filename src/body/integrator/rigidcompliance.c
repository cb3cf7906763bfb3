/* How a rigid body answers to forces on its nodes: M^{-1} within rigid motions. */
#include "rigidimpl.h"

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
    PetscCall(ComplianceSetColumn(nodal, dofs[i], way));
    PetscCall(VecRestoreArrayRead(moved, &way));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
