/* The massless layer at the start of the simulation. Displacements of the user, strains and loads need not leave the layer in balance; the
   first step would bring it there, at the cost of energy that belongs to no motion. So the layer is moved into the balance

     internal force(u)_L = (forces from outside + B^T force)_L

   before that, with the rest of the body where it is. The forces on the rows are sought by those who know what the rows have to do: here
   are the answers of one body, with the tangent of its layer at the present displacement. */
#include <body/layout/bodyimpl.h>

/* Changes of the layer below this part of positions and displacements of the nodes are round-off */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* f = forces from outside, and on the rows, on all ranks or none (NULL), less the forces of dashpots and the internal force at the present
   displacement, which must have been computed */
static PetscErrorCode ComputeImbalance(Body body, const PetscScalar force[], Vec f)
{
  PetscFunctionBegin;
  if (force) PetscCall(BodySpreadRows(body, body->rows.free_matrix, force, f));
  else PetscCall(VecZeroEntries(f));
  PetscCall(VecAXPY(f, -1, body->state.internal_force)); /* no -0, which PETSc would take for zeroes to leave alone later */
  if (body->state.damping) PetscCall(VecAXPY(f, -1, body->state.damping));
  PetscCall(BodyAddExternalForce(body, body->state.time, 1, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M a = forces, those on the rows too, on all ranks or none (NULL): the acceleration of the first state; needs its internal force */
static PetscErrorCode ComputeAcceleration(Body body, const PetscScalar force[])
{
  Vec       f = body->work.nodes[0];
  PetscReal norm;

  PetscFunctionBegin;
  PetscCall(BodyNoteDamping(body));
  PetscCall(ComputeImbalance(body, force, f));
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
  PetscCall(ComputeImbalance(body, NULL, f));
  PetscCall(VecGetArrayRead(f, &values));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++)
    if (values[body->layer.dofs[i]] != 0) *out = PETSC_TRUE;
  PetscCall(VecRestoreArrayRead(f, &values));
  PetscCall(BodyAnyRank(body, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of the entries of this rank's rows, without signs, on the massless layer; `massive`: on nodes with mass and bodies without inertia.
   Collective. */
PetscErrorCode BodySumRows(Body body, PetscBool massive, PetscScalar sums[])
{
  Vec                marks = body->work.nodes[0];
  PetscScalar       *mark;
  const PetscScalar *sum;
  Mat                marked;

  PetscFunctionBegin;
  PetscCall(VecSet(marks, massive));
  PetscCall(VecGetArray(marks, &mark));
  for (PetscInt i = 0; i < body->layer.n_dofs && HasLayer(body); i++) mark[body->layer.dofs[i]] = !massive;
  PetscCall(VecRestoreArray(marks, &mark));
  PetscCall(MatDuplicate(body->rows.free_matrix, MAT_COPY_VALUES, &marked));
  PetscCall(MatDiagonalScale(marked, NULL, marks));
  PetscCall(MatGetRowSumAbs(marked, body->work.rows[0]));
  PetscCall(VecGetArrayRead(body->work.rows[0], &sum));
  PetscCall(PetscArraycpy(sums, sum, body->rows.local));
  PetscCall(VecRestoreArrayRead(body->work.rows[0], &sum));
  PetscCall(MatDestroy(&marked));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far the massless layer is from its balance without forces on the rows, by the tangent at its displacement; then, if it `moves`,
   takes it to that with the forces `rows` [N], which a linear body reaches. rows: how far they go by it [m]; `change`: the largest
   displacement, 0 where that is round-off [m]. BodyStartUnderForces() completes the state. Before the first step, collective. */
PetscErrorCode BodyBalanceLayer(Body body, PetscBool moves, PetscScalar rows[], PetscReal *change)
{
  Vec       f = body->work.nodes[0], du = body->work.nodes[1];
  PetscReal u, x;

  PetscFunctionBegin;
  PetscCheck(!body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call before the first step");
  *change = 0;
  if (!HasLayer(body)) {
    PetscCall(PetscArrayzero(rows, body->rows.local));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!moves) {
    PetscCall(BodyPrepareLayer(body, body->state.u));
    PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  }
  PetscCall(ComputeImbalance(body, moves ? rows : NULL, f));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  PetscCall(BodyReadRows(body, body->rows.free_matrix, du, rows));
  PetscCall(VecNorm(du, NORM_INFINITY, change));
  PetscCall(VecNorm(body->state.u, NORM_INFINITY, &u));
  PetscCall(VecNorm(body->mesh.positions, NORM_INFINITY, &x));
  if (*change <= ROUND_OFF * (u + x)) *change = 0;
  if (moves) PetscCall(VecAXPY(body->state.u, 1, du));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* displacement = B K_LL^{-1} B^T force of the massless layer alone, after BodyBalanceLayer() [m], [N]. Collective. */
PetscErrorCode BodyMultiplyLayerCompliance(Body body, Vec force, Vec displacement)
{
  Vec f = body->work.nodes[0], du = body->work.nodes[1];

  PetscFunctionBegin;
  if (!HasLayer(body)) {
    PetscCall(VecZeroEntries(displacement));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatMultTranspose(body->rows.free_matrix, force, f));
  PetscCall(BodyApplyLayerCompliance(body, f, du));
  PetscCall(MatMult(body->rows.free_matrix, du, displacement));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reactions of held dofs do no work against contact forces, which come from the partner; nor does what holds a static body as it is */
static PetscErrorCode SubtractFromReactions(Body body, const PetscScalar force[])
{
  const PetscBool all      = (PetscBool)(!body->integrator->has_inertia || BodyIsLed(body));
  Vec             on_nodes = body->work.nodes[0], on_held = body->work.nodes[1];

  PetscFunctionBegin;
  if (!body->loads || (!all && !body->held.any)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySpreadRows(body, body->rows.matrix, force, on_nodes));
  PetscCall(VecZeroEntries(on_held));
  PetscCall(BodyCopyHeld(body, on_nodes, on_held));
  PetscCall(VecAXPY(body->state.applied, -1, all ? on_nodes : on_held));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes displacement and velocity the first state, with forces on the rows [N]; acceleration, traces and work follow. Without forces, NULL
   on all ranks, the internal force must have been computed. Collective. */
PetscErrorCode BodyStartUnderForces(Body body, const PetscScalar force[])
{
  PetscScalar *reaction;

  PetscFunctionBegin;
  PetscCheck(body->setup && !body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call after BodySetUp(), before the first step");
  PetscCall(BodyHistoryBeginHeld(body));
  if (force || body->history) PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(BodyEndHistory(body));
  PetscCall(ComputeAcceleration(body, force));
  PetscCall(BodyWriteTraces(body, 0));
  if (force && body->rows.global) {
    PetscCall(TraceGetLevel(body->traces.reaction, 0, &reaction));
    PetscCall(PetscArraycpy(reaction, force, body->rows.local));
  }
  PetscCall(BodySetUpWork(body));
  if (force) PetscCall(SubtractFromReactions(body, force));
  PetscCall(BodySave(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
