/* The massless layer at the start of the simulation. Displacements of the user, strains and loads need not leave the layer in balance; the
   first step would bring it there, at the cost of energy that belongs to no motion. So the layer is moved into the balance

     internal force(u)_L = (forces from outside + B^T force)_L

   before that, with the rest of the body where it is. The forces on the rows are sought by those who know what the rows have to do: here
   are the answers of one body, with the tangent of its layer at the present displacement. */
#include <body/layout/bodyimpl.h>

/* Changes of the layer below this part of positions and displacements of the nodes are round-off */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* f = forces from outside, and on the rows if it is pushed there, less the forces of dashpots and the internal force at the present
   displacement, which must have been computed. A rank without rows has no forces, but takes part. */
static PetscErrorCode ComputeImbalance(Body body, PetscBool pushed, const PetscScalar force[], Vec f)
{
  PetscFunctionBegin;
  if (pushed) PetscCall(BodySpreadRows(body, body->rows.free_matrix, force, f));
  else PetscCall(VecZeroEntries(f));
  PetscCall(VecAXPY(f, -1, body->state.internal_force)); /* no -0, which PETSc would take for zeroes to leave alone later */
  if (body->state.damping) PetscCall(VecAXPY(f, -1, body->state.damping));
  PetscCall(BodyAddExternalForce(body, body->state.time, 1, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M a = forces, those on the rows too if it is pushed there: the acceleration of the first state; needs its internal force */
PetscErrorCode BodyComputeStartAcceleration(Body body, PetscBool pushed, const PetscScalar force[])
{
  Vec       f = body->work.nodes[0];
  PetscReal norm;

  PetscFunctionBegin;
  PetscCall(BodyNoteDamping(body));
  PetscCall(ComputeImbalance(body, pushed, force, f));
  PetscCall(VecNorm(f, NORM_INFINITY, &norm));
  PetscCall(VecZeroEntries(body->state.a));
  PetscCall(BodySubtractHeldInertia(body, body->state.time, f, body->state.a));
  if (norm > 0 || body->held.any) PetscCall(BodySolveMass(body, f, body->state.a));
  if (body->integrator->has_inertia) PetscCall(BodyPrescribeHeld(body, body->state.time, NULL, NULL, body->state.a));
  if (body->integrator->ops.startacceleration) PetscCall((*body->integrator->ops.startacceleration)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the body has massless nodes on any rank, whose balance means anything */
static PetscBool HasLayer(Body body)
{
  return (PetscBool)(body->layer.exists && body->integrator->has_inertia);
}

/* Whether outside and internal forces of the massless layer differ before the first step; false without layer or inertia. Collective. */
PetscErrorCode BodyIsOutOfBalance(Body body, PetscBool *out)
{
  Vec                f = body->work.nodes[0];
  const PetscScalar *values;

  PetscFunctionBegin;
  *out = PETSC_FALSE;
  if (!HasLayer(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComputeImbalance(body, PETSC_FALSE, NULL, f));
  PetscCall(VecGetArrayRead(f, &values));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++)
    if (values[body->layer.dofs[i]] != 0) *out = PETSC_TRUE;
  PetscCall(VecRestoreArrayRead(f, &values));
  PetscCall(BodyAnyRank(body, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether each row has entries on dofs with a positive mark */
static PetscErrorCode FindEntries(Body body, Vec marks, PetscBool found[])
{
  const PetscScalar *sums;
  Mat                marked;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(body->rows.free_matrix, MAT_COPY_VALUES, &marked));
  PetscCall(MatDiagonalScale(marked, NULL, marks));
  PetscCall(MatGetRowSumAbs(marked, body->work.rows[0]));
  PetscCall(VecGetArrayRead(body->work.rows[0], &sums));
  for (PetscInt i = 0; i < body->rows.local; i++) found[i] = (PetscBool)(PetscRealPart(sums[i]) > 0);
  PetscCall(VecRestoreArrayRead(body->work.rows[0], &sums));
  PetscCall(MatDestroy(&marked));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks this rank's rows that move the massless layer, and those on nodes with mass or on bodies without inertia. Collective. */
PetscErrorCode BodyMarkRows(Body body, PetscBool massless[], PetscBool mass[])
{
  Vec          marks = body->work.nodes[0];
  PetscScalar *mark;

  PetscFunctionBegin;
  for (PetscInt massive = 0; massive < 2; massive++) {
    PetscCall(VecSet(marks, massive));
    PetscCall(VecGetArray(marks, &mark));
    for (PetscInt i = 0; i < body->layer.n_dofs && HasLayer(body); i++) mark[body->layer.dofs[i]] = 1 - massive;
    PetscCall(VecRestoreArray(marks, &mark));
    PetscCall(FindEntries(body, marks, massive ? mass : massless));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest component of a vector's change, or zero where that is round-off */
static PetscErrorCode MeasureChange(Body body, Vec du, PetscReal *change)
{
  PetscReal u, x;

  PetscFunctionBegin;
  PetscCall(VecNorm(du, NORM_INFINITY, change));
  PetscCall(VecNorm(body->state.u, NORM_INFINITY, &u));
  PetscCall(VecNorm(body->mesh.positions, NORM_INFINITY, &x));
  if (*change <= ROUND_OFF * (u + x)) *change = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far rows would move from their present places [m] if the massless layer went into balance without contact forces (tangent at the
   present displacement); `change`: largest displacement of the layer, 0 where that is round-off [m]. Before the first step. Collective. */
PetscErrorCode BodyRelaxLayer(Body body, PetscScalar displacement[], PetscReal *change)
{
  Vec f = body->work.nodes[0], du = body->work.nodes[1];

  PetscFunctionBegin;
  *change = 0;
  PetscCall(PetscArrayzero(displacement, body->rows.local));
  if (!HasLayer(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyPrepareLayer(body, body->state.u));
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(ComputeImbalance(body, PETSC_FALSE, NULL, f));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  PetscCall(BodyReadRows(body, body->rows.free_matrix, du, displacement));
  PetscCall(MeasureChange(body, du, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* displacement = B K_LL^{-1} B^T force of the massless layer alone, after BodyRelaxLayer() [m], [N]. Collective. */
PetscErrorCode BodyMultiplyLayerCompliance(Body body, const PetscScalar force[], PetscScalar displacement[])
{
  Vec f = body->work.nodes[0], du = body->work.nodes[1];

  PetscFunctionBegin;
  if (!HasLayer(body)) {
    PetscCall(PetscArrayzero(displacement, body->rows.local));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodySpreadRows(body, body->rows.free_matrix, force, f));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  PetscCall(BodyReadRows(body, body->rows.free_matrix, du, displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the massless layer towards its balance under forces on the rows [N], into it if the body is linear, after BodyRelaxLayer();
   `change` as there. Displacements and their traces at the start change; BodyStartUnderForces() completes the state. Collective. */
PetscErrorCode BodyMoveLayer(Body body, const PetscScalar force[], PetscReal *change)
{
  Vec f = body->work.nodes[0], du = body->work.nodes[1];

  PetscFunctionBegin;
  PetscCheck(!body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call before the first step");
  *change = 0;
  if (!HasLayer(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComputeImbalance(body, PETSC_TRUE, force, f));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  PetscCall(MeasureChange(body, du, change));
  PetscCall(VecAXPY(body->state.u, 1, du));
  PetscCall(BodyWriteTrace(body, body->rows.matrix, body->state.u, body->traces.displacement, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reactions of held dofs do no work against contact forces, which come from the partner; nor does what holds a static body as it is */
static PetscErrorCode SubtractFromReactions(Body body, const PetscScalar force[])
{
  Vec                on_nodes = body->work.nodes[0];
  const PetscScalar *contact;
  PetscScalar       *applied;

  PetscFunctionBegin;
  if (!body->loads || (body->integrator->has_inertia && !body->held.any && !BodyIsLed(body))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySpreadRows(body, body->rows.matrix, force, on_nodes));
  if (!body->integrator->has_inertia || BodyIsLed(body)) {
    PetscCall(VecAXPY(body->state.applied, -1, on_nodes));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayRead(on_nodes, &contact));
  PetscCall(VecGetArray(body->state.applied, &applied));
  for (PetscInt i = 0; i < body->held.n; i++) applied[body->held.dofs[i]] -= contact[body->held.dofs[i]];
  PetscCall(VecRestoreArray(body->state.applied, &applied));
  PetscCall(VecRestoreArrayRead(on_nodes, &contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes displacement and velocity the first state, with forces on the rows [N]; acceleration, traces and work follow. Collective. */
PetscErrorCode BodyStartUnderForces(Body body, const PetscScalar force[])
{
  PetscScalar *reaction;

  PetscFunctionBegin;
  PetscCheck(body->setup && !body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call after BodySetUp(), before the first step");
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(BodyComputeStartAcceleration(body, PETSC_TRUE, force));
  PetscCall(BodyWriteTraces(body, 0));
  if (body->rows.global) {
    PetscCall(TraceGetLevel(body->traces.reaction, 0, &reaction));
    PetscCall(PetscArraycpy(reaction, force, body->rows.local));
  }
  PetscCall(BodySetUpWork(body));
  PetscCall(SubtractFromReactions(body, force));
  PetscCall(BodySave(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
