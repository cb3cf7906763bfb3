/* Contact forces at the start of a controller step that differ from those that the last step ended with. A force on rows of a massless
   layer moves the layer, and the layer pulls at the nodes inside: those feel B~^T x with B~^T = -K_IL K_LL^{-1} B^T. So a start under
   forces that are larger by x is one with the acceleration M^{-1} B~^T x on top, displacement and velocity being as they are. The mean
   contact force of the step is then that of the start as given here and of the end, on both bodies, so that momentum is kept. */
#include <body/layout/bodyimpl.h>

/* BodyAnswerAtStart - the acceleration that forces on nodes, in work.nodes[0], bring to the nodes that have mass */
PetscErrorCode BodyAnswerAtStart(Body body, Vec change)
{
  Vec          f = body->work.nodes[0], du = body->work.nodes[1], pull = body->work.nodes[2];
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(BodyZeroHeld(body, f));
  if (body->layer.exists) {
    PetscCall(BodySolveLayer(body, body->saved.u, f, du, pull));
    PetscCall(VecAXPY(f, 1, pull));
    PetscCall(VecGetArray(f, &values));
    for (PetscInt i = 0; i < body->layer.n_dofs; i++) values[body->layer.dofs[i]] = 0;
    PetscCall(VecRestoreArray(f, &values));
  }
  PetscCall(BodyZeroHeld(body, f));
  PetscCall(BodySolveMass(body, f, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of forces on the rows, and of those that go over from the rows of the last step */
static PetscErrorCode ComputeChange(Body body, const PetscScalar force[], Vec change)
{
  PetscFunctionBegin;
  if (!body->layer.exists && !BodyHandsOver(body)) {
    PetscCall(BodySolveMassOfRows(body, force, change));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodySpreadRows(body, body->rows.free_matrix, force, body->work.nodes[0]));
  PetscCall(BodyAddStoppedHandover(body, body->work.nodes[0]));
  PetscCall(BodyAnswerAtStart(body, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the acceleration at the start where forces on rows may change it. The first state's energy is that of all nodes. */
static PetscErrorCode CopyStart(Body body, Vec from, Vec to)
{
  PetscFunctionBegin;
  if (body->saved.step && BodyAnswersByNodes(body)) PetscCall(BodyCopyContactNodes(body, from, to));
  else PetscCall(VecCopy(from, to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes the acceleration with which the step begins, before forces at its start change that: BodyDropStartForce() goes back to it */
PetscErrorCode BodyNoteStart(Body body)
{
  PetscFunctionBegin;
  if (body->start.changed) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->start.a) PetscCall(BodyCreateVec(body, &body->start.a));
  PetscCall(CopyStart(body, body->saved.a, body->start.a));
  body->start.changed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the controller step begin with contact forces that exceed those at the end of the last step by `force` along each row [N], until
   BodySave() or BodyDropStartForce(). The body goes back to the saved state, whose acceleration becomes that under the new forces, with
   the massless layer in balance. `rest`: the part that remains of forces handed over, see BodyHandOver(); NULL: all. A static body has
   no acceleration and stays. Collective. */
PetscErrorCode BodySetStartForce(Body body, const PetscScalar force[], const PetscReal rest[])
{
  const PetscBool by_nodes = BodyAnswersByNodes(body), moved = (PetscBool)(body->state.step != body->saved.step);
  const PetscReal one = 1;

  PetscFunctionBegin;
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->start.changed && !moved && by_nodes && !BodyHandsOver(body) && BodyNearRowsAreZero(body, force))
    PetscFunctionReturn(PETSC_SUCCESS); /* as it is */
  if (body->start.changed) PetscCall(CopyStart(body, body->start.a, body->saved.a));
  PetscCall(BodyNoteStart(body));
  if (moved || !by_nodes) PetscCall(BodyRestore(body));
  PetscCall(BodySetHandoverRest(body, rest));
  if (by_nodes) PetscCall(BodyAddAnswerOfNodes(body, force, PETSC_TRUE, 1, &one, &body->saved.a));
  else {
    PetscCall(ComputeChange(body, force, body->state.a));
    PetscCall(VecAXPY(body->saved.a, 1, body->state.a));
  }
  PetscCall(VecCopy(body->saved.a, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the controller step begin with the contact forces that the last one ended with. Collective. */
PetscErrorCode BodyDropStartForce(Body body)
{
  PetscFunctionBegin;
  if (!body->start.changed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CopyStart(body, body->start.a, body->saved.a));
  PetscCall(BodySetHandoverRest(body, NULL));
  body->start.changed = PETSC_FALSE;
  PetscCall(BodyRestore(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before the first step is accepted: by how much the first state has more energy, in this rank's part, with the contact forces of that
   step's start than its record tells, which is made before anybody knows them [J]: not 0 for central differences alone. Collective. */
PetscErrorCode BodyNoteStartEnergy(Body body)
{
  PetscReal with, without;

  PetscFunctionBegin;
  if (body->integrator->staggered == 0 || body->saved.step) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySumStaggering(body, body->saved.a, &with));
  PetscCall(BodySumStaggering(body, body->start.changed ? body->start.a : body->saved.a, &without));
  body->start.energy = 0.5 * body->integrator->staggered * PetscSqr(body->time.step) * (without - with);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodySumStartEnergies - this, of bodies with all ranks, from the first step on. Forces that hold a body accelerate it less than it would
   be without them. Those of a hit, which sets in within the step, accelerate it more, and count as in other steps: not here. Collective on
   the communicator of all bodies. */
PetscErrorCode BodySumStartEnergies(PetscInt n, const Body bodies[], PetscReal *sum)
{
  PetscReal *energies;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &energies));
  for (PetscInt b = 0; b < n; b++) energies[b] = bodies[b]->start.energy;
  if (n && bodies[0]->rows.size > 1)
    PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, energies, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)bodies[0])));
  *sum = 0;
  for (PetscInt b = 0; b < n; b++) *sum += PetscMax(energies[b], 0);
  PetscCall(PetscFree(energies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of this rank on which forces act on nodes with mass by their mean over the controller step, for forces that go linearly from l_0 to
   l_1 over m substeps. The massless layer is in balance with the force at the end of each substep. The trapezoidal rule would have the
   force l_k do the work (l_{k-1} + l_k) / 2 dw_k in substep k, and the sum of these is not that of a partner with other substeps, (l_0 +
   l_1) / 2 dw: a closed row would bring energy or take it. Here each substep starts with the force x_k = l_0 + l_1 - l_k on the nodes with
   mass, so that their mean is (l_0 + l_1) / 2 in all substeps. By the identity of src/contact/energy/limit.c the energy changes by dE =
   (l_0 + l_1) / 2 dw - 1/2 sum_k (x_k - l_{k-1}) C (l_k - l_{k-1}), and that sum is zero. So both partners take and give the same, and the
   same impulse: exact for implicit bodies. Explicit ones take half of x_k - l_{k-1} at the start of the substep and half at its end, and
   their staggered energy sways by terms of the fourth order of the substep. Nonlinear bodies, whose layers would be factored in each
   substep, and single substeps do not change. Collective. */
PetscErrorCode BodySetMeanForces(Body body, const PetscBool rows[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  if (!body->model.linear || !body->integrator->has_inertia || body->time.substeps == 1) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->rows.by_mean) PetscCall(PetscCalloc1(body->rows.local, &body->rows.by_mean));
  if (!body->start.change) PetscCall(BodyCreateVec(body, &body->start.change));
  body->rows.any_by_mean = PETSC_FALSE;
  for (PetscInt i = 0; i < body->rows.local; i++) {
    body->rows.by_mean[i]  = rows[i];
    body->rows.any_by_mean = (PetscBool)(body->rows.any_by_mean || rows[i]);
  }
  PetscCall(BodyAnyRank(body, &body->rows.any_by_mean));
  if (body->layer.exists && body->rows.any_by_mean)
    PetscCall(BodyPrepareLayer(body, body->state.u)); /* its factors, before the time loop */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether forces act by their mean in what the body does now: rows, or a force on nodes whose compliance is found */
static PetscBool ActsByMean(Body body)
{
  return (PetscBool)(!body->unloaded || (body->rows.nodal_force && body->rows.nodal_shape == BODY_FORCE_LINEAR));
}

/* Takes a substep's start from the forces at the end of the one before to those that have the mean of the controller step in this one, see
   BodySetMeanForces(). Central differences take half of the change here and half at the end of the substep: their staggered energy changes
   by -dt^2/8 (a + b)'M (b - a) where the acceleration goes from a to b, and these then cancel over a controller step, at the start of which
   the force goes one way and within which it goes back. With all of it here the change is a loss in each step. */
PetscErrorCode BodyTurnToMeanForce(Body body)
{
  const PetscInt  m    = body->time.substeps;
  const PetscReal part = (body->integrator->staggered > 0 ? 0.5 : 1) * (1 - (PetscReal)(2 * body->time.substep + 1) / m);
  PetscScalar    *start, *end, *more;

  PetscFunctionBegin;
  if (!ActsByMean(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->unloaded) {
    PetscCall(VecCopy(body->rows.nodal_force, body->work.nodes[0]));
    PetscCall(VecScale(body->work.nodes[0], part));
    PetscCall(BodyAnswerAtStart(body, body->start.change));
  } else {
    PetscCall(TraceGetLevel(body->traces.force_in, 0, &start));
    PetscCall(TraceGetLevel(body->traces.force_in, m, &end));
    PetscCall(VecGetArrayWrite(body->work.rows[1], &more));
    for (PetscInt i = 0; i < body->rows.local; i++)
      more[i] = body->rows.by_mean[i] && body->rows.conditions[i] == BODY_FORCED ? part * (end[i] - start[i]) : 0;
    PetscCall(ComputeChange(body, more, body->start.change));
    PetscCall(VecRestoreArrayWrite(body->work.rows[1], &more));
  }
  PetscCall(VecAXPY(body->state.a, 1, body->start.change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the end of a substep: the half of the change that central differences have left. The acceleration is that of the end. */
PetscErrorCode BodyEndMeanForce(Body body)
{
  PetscFunctionBegin;
  if (!ActsByMean(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->integrator->staggered > 0) PetscCall(VecAXPY(body->state.v, 0.5 * body->time.step, body->start.change));
  PetscFunctionReturn(PETSC_SUCCESS);
}
