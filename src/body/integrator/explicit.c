/* A body under central differences. */
#include "explicitimpl.h"

/* a = (force - internal force) / m; without a force, where it is NULL */
static PetscErrorCode DivideByMass(Body body, Vec force, Vec A)
{
  PetscFunctionBegin;
  if (force) PetscCall(VecWAXPY(A, -1, body->state.internal_force, force));
  else PetscCall(VecAXPBY(A, -1, 0, body->state.internal_force));
  PetscCall(VecPointwiseMult(A, A, body->mass.inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a = M^{-1} f with a mass matrix that is not diagonal, where a is prescribed on some rows and on held dofs, whose part of f is their
   acceleration already: what is prescribed is taken to the right-hand side. f is overwritten. */
static PetscErrorCode SolveMassPrescribed(Body body, Vec f, PetscReal position, Vec a)
{
  Vec prescribed = body->work.nodes[1];

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(prescribed));
  PetscCall(BodyCopyHeld(body, f, prescribed));
  PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, prescribed));
  PetscCall(BodyZeroHeld(body, prescribed));
  PetscCall(MatMult(body->mass.matrix, prescribed, a));
  PetscCall(VecAXPY(f, -1, a));
  PetscCall(BodySolveMass(body, f, a));
  PetscCall(VecAXPY(a, 1, prescribed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal GetPosition(Body body)
{
  return (PetscReal)(body->time.substep + 1) / body->time.substeps;
}

/* Held and contact conditions on U, with the massless layer in balance. With a layer `force` becomes those from outside. */
static PetscErrorCode PlaceRows(Body body, PetscReal t, Vec U, Vec force)
{
  const LayerBalance layer    = GetLayerBalance(body);
  const PetscReal    position = GetPosition(body);

  PetscFunctionBegin;
  PetscCall(BodyPrescribeHeld(body, t, U, NULL, NULL));
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, position, U));
  if (layer) PetscCall(LayerBalanceSolve(layer, body, t, position, U, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows move without the elements and the end of the step: by the layer's balance alone, or, with mass, by forces at the start */
static PetscBool IsEarly(Body body)
{
  if (((BodyExplicit *)body->integrator->data)->layer_alone) return PETSC_TRUE;
  return (PetscBool)(body->rows.constant && body->time.substeps == 1 && !GetLayerBalance(body) && !body->rows.n_prescribed &&
                     !body->rows.n_robin && !body->unloaded);
}

/* The acceleration that U brings about, being in place; the forces of the dashpots are known. known: `force` is that from outside. */
static PetscErrorCode Accelerate(Body body, PetscReal t, PetscBool known, Vec force, Vec U, Vec A)
{
  const PetscReal position = GetPosition(body), one = 1;
  const PetscBool prescribed = (PetscBool)(body->rows.n_prescribed && body->rows.have_mass);
  /* contact forces that act on massless nodes alone accelerate nothing, constant ones with lumped mass the nodes that they act on */
  const PetscBool layer_alone = ((BodyExplicit *)body->integrator->data)->layer_alone;
  const PetscBool by_nodes    = (PetscBool)(BodyAnswersByNodes(body) && IsEarly(body) && !body->rows.exchange.open && !BodyHandsOver(body));
  const PetscBool contact     = (PetscBool)(!by_nodes && (known || (!body->mass.inverse && !body->mass.of_nodes) || !layer_alone));
  PetscBool       outside     = BodyHasOutsideForce(body, contact);
  PetscScalar    *constant;

  PetscFunctionBegin;
  if (outside && !known) PetscCall(BodyComputeOutsideForce(body, t, position, contact, U, force));
  if (body->state.damping) {
    if (!outside) PetscCall(VecZeroEntries(force));
    PetscCall(VecAXPY(force, -1, body->state.damping));
    outside = PETSC_TRUE;
  }
  PetscCall(BodyComputeInternalForce(body, U, body->state.internal_force));
  if (body->mass.inverse) {
    PetscCall(DivideByMass(body, outside ? force : NULL, A));
    if (by_nodes) PetscCall(TraceGetLevel(body->traces.force_in, 1, &constant));
    if (by_nodes) PetscCall(BodyAddAnswerOfNodes(body, constant, PETSC_FALSE, 1, &one, &A));
    PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
  } else {
    if (!outside) PetscCall(VecZeroEntries(force));
    PetscCall(VecAXPY(force, -1, body->state.internal_force));
    PetscCall(BodySubtractHeldInertia(body, t, force, A));
    if (prescribed) PetscCall(SolveMassPrescribed(body, force, position, A));
    else PetscCall(BodySolveMass(body, force, A));
    PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the force that LayerBalanceSolve() has left is the one that acts: Robin rows have moved with the layer since */
static PetscBool KnowsForce(Body body)
{
  return (PetscBool)(GetLayerBalance(body) && !body->rows.n_robin);
}

/* The displacement is all that the rows depend on, and the layer's force of prescribed ones: the acceleration, which is zero on massless
   nodes, is left to Complete() on all ranks */
static PetscErrorCode LeaveIncomplete(Body body, Vec U, Vec A)
{
  PetscFunctionBegin;
  if (GetLayerBalance(body) && body->rows.n_prescribed) PetscCall(LayerBalanceGetForce(body, U, body->state.internal_force));
  if (body->held.n && !body->state.incomplete) PetscCall(VecZeroEntries(A)); /* of held nodes it is not */
  else PetscCall(PetscObjectStateIncrease((PetscObject)A));
  body->state.incomplete = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSCentralDifferenceFn`. Dashpots feel the velocity V at mid-step. */
static PetscErrorCode ComputeAcceleration(TS ts, PetscReal t, Vec U, Vec V, Vec A, void *ctx)
{
  Body body  = (Body)ctx;
  Vec  force = body->work.nodes[0];

  PetscFunctionBegin;
  PetscCall(PlaceRows(body, t, U, force));
  if (body->state.damping) PetscCall(BodyMultiplyDamping(body, U, V, body->state.damping));
  if (IsEarly(body)) {
    PetscCall(LeaveIncomplete(body, U, A));
    PetscCall(TSCentralDifferenceLeaveVelocity(ts));
  } else PetscCall(Accelerate(body, t, KnowsForce(body), force, U, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity of massless, held and prescribed nodes */
static PetscErrorCode FinishSubstep(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyFinishLayer(body));
  PetscCall(BodyPrescribeHeld(body, body->state.time, NULL, body->state.v, NULL));
  if (body->rows.have_mass)
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, (PetscReal)(body->time.substep + 1) / body->time.substeps, body->state.v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Contact nodes with mass. Forces at the end of the substep change da = M^{-1} B^T df there, and dv = dt/2 da. Forces throughout it change
   the acceleration at its start, and the way and the velocity at mid-step that follow. */
static PetscErrorCode RepeatForces(Body body, const PetscScalar force[], const PetscScalar displacement[])
{
  const PetscBool early = IsEarly(body);
  const PetscReal dt = body->time.step, scales[] = {1, 0.5 * dt, 0.5 * dt * dt};
  const Vec       vecs[] = {early ? body->saved.a : body->state.a, body->state.v, body->state.u};
  const PetscInt  n      = early ? 3 : 2;

  PetscFunctionBegin;
  (void)displacement;
  if (early && BodyAnswersByNodes(body)) PetscCall(BodyAddAnswerOfNodes(body, force, PETSC_FALSE, n, scales, vecs));
  else {
    PetscCall(BodySolveMassOfRows(body, force, body->work.nodes[2]));
    for (PetscInt k = 0; k < n; k++) PetscCall(VecAXPY(vecs[k], scales[k], body->work.nodes[2]));
  }
  if (early && body->state.damping) PetscCall(BodyMultiplyDamping(body, body->state.u, body->state.v, body->state.damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacement of nodes with mass is known before the end of the substep, and so is the velocity at mid-step, which dashpots feel;
   layer and prescribed rows are put in place anew. Of a linear body the new acceleration replaces the old one in the velocity; where the
   layer alone answers, of any, Complete() finds it. */
static PetscErrorCode Repeat(Body body, const PetscScalar force[], const PetscScalar displacement[])
{
  const PetscReal half = 0.5 * body->time.step;

  PetscFunctionBegin;
  if (!body->rows.n_prescribed && !body->rows.n_robin && !GetLayerBalance(body)) {
    PetscCall(RepeatForces(body, force, displacement));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  body->time.substep = 0;
  if (!body->state.incomplete) PetscCall(VecAXPY(body->state.v, -half, body->state.a));
  PetscCall(PlaceRows(body, body->state.time, body->state.u, body->work.nodes[0]));
  if (IsEarly(body)) PetscCall(LeaveIncomplete(body, body->state.u, body->state.a));
  else {
    PetscCall(Accelerate(body, body->state.time, KnowsForce(body), body->work.nodes[0], body->state.u, body->state.a));
    PetscCall(VecAXPY(body->state.v, half, body->state.a));
  }
  PetscCall(FinishSubstep(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements' forces, the acceleration, and the velocity at the end of the step */
static PetscErrorCode Complete(Body body)
{
  PetscFunctionBegin;
  body->time.substep = 0;
  PetscCall(Accelerate(body, body->state.time, PETSC_FALSE, body->work.nodes[0], body->state.u, body->state.a));
  PetscCall(VecAXPY(body->state.v, 0.5 * body->time.step, body->state.a));
  PetscCall(FinishSubstep(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Central differences know where nodes with mass get in a step before the force at its end. So rows that are all on massless nodes ask for
   the balance of the layer, as often as sweeps want it, and the acceleration is computed once, when the step is complete. */
static PetscErrorCode SetUp(Body body)
{
  BodyIntegrator integrator = body->integrator;
  BodyExplicit *explicit    = (BodyExplicit *)integrator->data;
  const PetscBool layer     = body->layer.exists;

  PetscFunctionBegin;
  if (layer) {
    PetscCall(LayerBalanceCreate(body, &explicit->layer));
    integrator->ops.setrows   = LayerBalanceSetRows;
    integrator->ops.save      = LayerBalanceSave;
    integrator->ops.restore   = LayerBalanceRestore;
    integrator->ops.visit     = LayerBalanceVisit;
    integrator->ops.agree     = LayerBalanceAgree;
    integrator->ops.copypoint = LayerBalanceCopyPoint;
  }
  integrator->answers_by_layer = (PetscBool)(layer && body->time.substeps == 1 && (body->rows.global || body->rows.expected) &&
                                             !body->rows.have_mass && !body->rows.tied_mass);
  /* dashpots of a nonlinear body act by where the layer is, and by its velocity at mid-step */
  explicit->layer_alone = (PetscBool)(integrator->answers_by_layer && (body->model.linear || !BodyIsDamped(body)));
  if (body->mass.matrix) {
    PetscCall(BodySetUpMassSolver(body));
    /* scatters take their tags when they are first used: here, where all ranks are, and not in a substep that some do not make */
    PetscCall(VecZeroEntries(body->work.nodes[0]));
    PetscCall(BodySolveMass(body, body->work.nodes[0], body->work.nodes[1]));
  }
  PetscCall(TSCentralDifferenceSetAcceleration(body->time.ts, ComputeAcceleration, body->state.a, body));
  integrator->is_local        = (PetscBool)(body->mass.inverse || body->mass.blocks);
  integrator->depends_on_step = (PetscBool)(body->time.substeps > 1);
  integrator->reads_start     = layer;
  if (body->time.substeps == 1) integrator->ops.complete = Complete;
  if (explicit->layer_alone || (body->time.substeps == 1 && body->model.linear)) integrator->ops.repeat = Repeat;
  else if (body->time.substeps == 1 && !layer) integrator->ops.repeat = RepeatForces;
  integrator->repeats_prescribed = (PetscBool)(body->model.linear || explicit->layer_alone);
  integrator->repeats_constant   = (PetscBool)(body->time.substeps == 1 && !layer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Body body)
{
  PetscFunctionBegin;
  PetscCall(LayerBalanceDestroy(&((BodyExplicit *)body->integrator->data)->layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyIntegratorCreate_Explicit(BodyIntegrator integrator)
{
  BodyExplicit *explicit;

  PetscFunctionBegin;
  PetscCall(PetscNew(&explicit));
  integrator->data              = explicit;
  integrator->has_inertia       = PETSC_TRUE;
  integrator->needs_stable_step = PETSC_TRUE;
  integrator->divides_by_mass   = PETSC_TRUE;
  integrator->staggered         = 0.25;
  integrator->affine            = PETSC_TRUE;
  integrator->ops.setup         = SetUp;
  integrator->ops.finishsubstep = FinishSubstep;
  integrator->ops.destroy       = Destroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
