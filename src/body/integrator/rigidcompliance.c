/* How a rigid body answers to forces on its nodes: M^{-1} within rigid motions. */
#include "rigidimpl.h"

/* Accelerations that forces bring where the body is at a place: within rigid motions that are not led */
static void Respond(Body body, const RigidMotion *place, const Resultant *resultant, RigidMotion *motion)
{
  PetscReal torque[3];

  *motion = *place;
  for (PetscInt d = 0; d < 3; d++) motion->angular_velocity[d] = 0;
  RigidTorque(motion->rotation, resultant->dyad, torque);
  BodyRigidFindAcceleration(body, resultant->force, torque, motion);
  for (PetscInt d = 0; d < 3; d++) {
    if (BodyLeads(body, d)) motion->acceleration[d] = 0;
    if (BodyLeads(body, 3)) motion->angular_acceleration[d] = 0;
  }
}

/* M^{-1} f */
PetscErrorCode BodyRigidSolveMass(Body body, Vec f, Vec a)
{
  RigidMotion place, motion;
  Resultant   resultant;

  PetscFunctionBegin;
  PetscCall(BodyRigidFindPlace(body, body->state.u, &place));
  PetscCall(BodyRigidFindResultant(body, NULL, f, &resultant));
  Respond(body, &place, &resultant, &motion);
  PetscCall(BodyRigidWriteMotion(body, &motion, NULL, NULL, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the body will be in the middle of the controller step, if it goes on as it does: forces turn it by their moments there */
static PetscErrorCode FindMiddle(Body body, PetscReal half, RigidMotion *middle)
{
  RigidMotion begin;
  PetscReal   way[3], turn[9];

  PetscFunctionBegin;
  PetscCall(BodyRigidFindMotion(body, body->saved.u, body->saved.v, &begin));
  for (PetscInt d = 0; d < 3; d++) way[d] = half * begin.angular_velocity[d];
  RigidCayley(way, turn);
  *middle = begin;
  RigidProduct(turn, begin.rotation, middle->rotation);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindUnitResultant(Body body, PetscInt dof, Resultant *resultant)
{
  const PetscInt dim = body->mesh.dim, d = dof % dim;
  PetscReal      Y[3];
  PetscInt       begin, end;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(resultant, sizeof(*resultant)));
  PetscCall(VecGetOwnershipRange(body->state.u, &begin, &end));
  if (dof >= begin && dof < end) {
    BodyRigidGetArm(body, (dof - begin) / dim, Y);
    resultant->force[d] = 1;
    for (PetscInt b = 0; b < dim; b++) resultant->dyad[3 * d + b] = Y[b];
  }
  PetscCall(BodyRigidSum(body, resultant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a displacement of this rank */
static PetscReal GetAcceleration(Body body, const RigidMotion *motion, PetscInt local)
{
  const PetscInt dim = body->mesh.dim, d = local % dim;
  PetscReal      Y[3], r[3], twist[3];

  BodyRigidGetArm(body, local / dim, Y);
  RigidMultiply(motion->rotation, Y, r);
  RigidCross(motion->angular_acceleration, r, twist);
  return motion->acceleration[d] + twist[d];
}

/* Displacements of nodes at the end of the controller step under unit forces on them: by the trapezoidal rule, which is exact for constant
   forces, and makes ways of forces that grow by 1/12 of their change in a substep too much. Of all other nodes nothing is found. */
PetscErrorCode BodyRigidSetNodalColumns(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], Compliance nodal)
{
  const PetscReal all    = body->time.substeps * body->time.step;
  const PetscReal factor = shape == BODY_FORCE_CONSTANT ? PetscSqr(all) / 2 : PetscSqr(all) / 6 + PetscSqr(body->time.step) / 12;
  PetscScalar    *way;
  RigidMotion     middle, motion;
  Resultant       resultant;
  PetscInt        begin, end;

  PetscFunctionBegin;
  PetscCall(FindMiddle(body, all / 2, &middle));
  PetscCall(VecGetOwnershipRange(body->state.u, &begin, &end));
  PetscCall(VecGetArrayWrite(body->work.nodes[0], &way));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt *known;
    PetscInt        n_known;

    if (ComplianceKnows(nodal, dofs[i])) continue;
    PetscCall(FindUnitResultant(body, dofs[i], &resultant));
    Respond(body, &middle, &resultant, &motion);
    ComplianceGetRows(nodal, &n_known, &known, NULL);
    for (PetscInt k = 0; k <= n_known; k++) {
      const PetscInt dof = k < n_known ? known[k] : dofs[i];

      if (dof >= begin && dof < end) way[dof - begin] = factor * GetAcceleration(body, &motion, dof - begin);
    }
    PetscCall(ComplianceSetColumn(nodal, dofs[i], way));
  }
  PetscCall(VecRestoreArrayWrite(body->work.nodes[0], &way));
  PetscFunctionReturn(PETSC_SUCCESS);
}
