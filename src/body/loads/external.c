/* What loads do to a body: forces from outside, and the work of these and of held displacements. */
#include <body/layout/bodyimpl.h>

/* f += scale * forces from outside at time t [N]. Loads that a static body has from the start, at rest as it is, grow to what they are over
   the first controller step: halves of that step are halves of the load. */
PetscErrorCode BodyAddExternalForce(Body body, PetscReal t, PetscScalar scale, Vec f)
{
  const PetscReal part = (t - body->time.start) / (body->time.shared * body->time.whole_step);

  PetscFunctionBegin;
  if (!body->loads || body->unloaded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyLoadsAddForce(body, t, scale, f));
  if (body->loads_grow && part < 1 - PETSC_SQRT_MACHINE_EPSILON)
    PetscCall(BodyLoadsAddForce(body, body->time.start, (part - 1) * scale, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Contact forces on all nodes at the end of the substep that has been made last */
static PetscErrorCode ComputeContactForce(Body body, Vec contact)
{
  PetscScalar *reaction, *force_in, *row;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(body->traces.reaction, body->state.step - body->saved.step, &reaction));
  PetscCall(TraceGetLevel(body->traces.force_in, body->state.step - body->saved.step, &force_in));
  PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
  for (PetscInt i = 0; i < body->rows.local; i++) row[i] = body->rows.conditions[i] == BODY_FORCED ? force_in[i] : reaction[i];
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
  PetscCall(MatMultTranspose(body->rows.matrix, body->work.rows[0], contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces from outside and the reactions that hold held dofs, at the current state: what does work on the body, beside contact. Where a
   rigid body is led, what leads it is spread over all its nodes, as M a less the forces from outside and of contact. */
static PetscErrorCode ComputeApplied(Body body, Vec applied)
{
  const PetscScalar *force;
  PetscScalar       *values;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(applied));
  PetscCall(BodyAddExternalForce(body, body->state.time, 1, applied));
  if (!body->held.any && !BodyIsLed(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyFindInternalForce(body));
  if (!body->integrator->has_inertia) PetscCall(VecCopy(body->state.internal_force, body->work.nodes[0]));
  else {
    PetscCall(BodyMultiplyMass(body, body->state.a, body->work.nodes[0]));
    PetscCall(VecAXPY(body->work.nodes[0], 1, body->state.internal_force));
    if (body->state.damping) PetscCall(VecAXPY(body->work.nodes[0], 1, body->state.damping));
  }
  /* contact forces on held dofs come from the partner */
  if (body->rows.n_prescribed || body->rows.n_forced) {
    PetscCall(ComputeContactForce(body, body->work.nodes[1]));
    PetscCall(VecAXPY(body->work.nodes[0], -1, body->work.nodes[1]));
  }
  PetscCall(VecGetArrayRead(body->work.nodes[0], &force));
  PetscCall(VecGetArray(applied, &values));
  if (BodyIsLed(body)) PetscCall(PetscArraycpy(values, force, body->mesh.owned_nodes * body->mesh.dim));
  else
    for (PetscInt i = 0; i < body->held.n; i++) values[body->held.dofs[i]] = force[body->held.dofs[i]];
  PetscCall(VecRestoreArray(applied, &values));
  PetscCall(VecRestoreArrayRead(body->work.nodes[0], &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* To be called when the initial state is there. A static body need not be in balance there: its loads grow in the first step from what
   would hold it as it is to what they are at the end, however suddenly they come. */
PetscErrorCode BodySetUpWork(Body body)
{
  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  body->state.external_work = body->saved.external_work = 0;
  if (body->integrator->has_inertia) PetscCall(ComputeApplied(body, body->state.applied));
  else {
    PetscReal largest;

    PetscCall(VecCopy(body->state.internal_force, body->state.applied));
    PetscCall(VecNorm(body->state.u, NORM_INFINITY, &largest));
    body->loads_grow = (PetscBool)(largest == 0);
  }
  PetscCall(VecCopy(body->state.applied, body->saved.applied));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a part of a force to `applied`, on held dofs alone */
static PetscErrorCode AddOnHeld(Body body, PetscScalar part, Vec force, Vec applied)
{
  const PetscScalar *more;
  PetscScalar       *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(force, &more));
  PetscCall(VecGetArray(applied, &values));
  for (PetscInt i = 0; i < body->held.n; i++) values[body->held.dofs[i]] += part * more[body->held.dofs[i]];
  PetscCall(VecRestoreArray(applied, &values));
  PetscCall(VecRestoreArrayRead(force, &more));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Jump of the acceleration into the last substep, held dofs apart, from the velocities: these have the mean of start and end */
static PetscErrorCode ComputeAccelerationChange(Body body, Vec change)
{
  PetscFunctionBegin;
  PetscCall(VecWAXPY(change, -1, body->saved.v, body->state.v));
  PetscCall(VecScale(change, 2 / body->time.step));
  PetscCall(VecAXPY(change, -1, body->state.a));
  PetscCall(VecAXPY(change, -1, body->start.changed ? body->start.a : body->saved.a));
  PetscCall(BodyZeroHeld(body, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reactions at the start of a step are those that the last one ended with. Where contact forces are constant in it, they are others from
   its start on, and so are reactions. Through a mass that is not diagonal held dofs bear inertia of others. */
static PetscErrorCode CountForceChange(Body body, Vec work, Vec applied)
{
  PetscBool any;

  PetscFunctionBegin;
  if (!body->rows.n_forced || (!body->held.any && !BodyIsLed(body))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyComputeForceChange(body, &any, work));
  if (any && BodyIsLed(body)) PetscCall(VecAXPY(applied, -1, work));
  if (!any || BodyIsLed(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddOnHeld(body, -1, work, applied));
  if (!body->mass.diagonal) {
    if (!body->start.change) PetscCall(BodyCreateVec(body, &body->start.change));
    PetscCall(ComputeAccelerationChange(body, body->start.change));
    PetscCall(BodyMultiplyMass(body, body->start.change, work));
    PetscCall(AddOnHeld(body, 1, work, applied));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The work from displacement `start` to the present one, by the trapezoidal rule; `applied`: what does it at the end [N] */
static PetscErrorCode ComputeWork(Body body, Vec start, Vec applied, PetscReal *work)
{
  Vec sum = body->work.nodes[0], way = body->work.nodes[1];

  PetscFunctionBegin;
  PetscCall(ComputeApplied(body, applied));
  PetscCall(VecWAXPY(sum, 1, body->state.applied, applied));
  PetscCall(CountForceChange(body, way, sum));
  PetscCall(VecWAXPY(way, -1, start, body->state.u));
  if (body->local) PetscCall(BodyGetLocalDot(sum, way, work));
  else PetscCall(VecDot(sum, way, work));
  *work *= 0.5;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the work from displacement `start` to the present one; collective only where there are loads */
PetscErrorCode BodyAddWork(Body body, Vec start)
{
  Vec       applied = body->work.nodes[2];
  PetscReal work;

  PetscFunctionBegin;
  if (!body->loads || body->unloaded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComputeWork(body, start, applied, &work));
  PetscCall(VecCopy(applied, body->state.applied));
  body->state.external_work += work;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's part of the energy of the present state beside the measures: work of loads and dashpots in a step not yet accepted */
PetscErrorCode BodyAddPendingWork(Body body, PetscReal sums[2])
{
  PetscReal pending = 0, damped = 0;

  PetscFunctionBegin;
  if (body->loads && body->time.substeps == 1 && body->state.step != body->saved.step)
    PetscCall(ComputeWork(body, body->substep_start.u, body->work.nodes[2], &pending));
  if (body->time.substeps == 1 && body->state.step != body->saved.step) PetscCall(BodyGetPendingDampingWork(body, &damped));
  sums[0] = BodyShareOf(body, pending);
  sums[1] = BodyShareOf(body, damped);
  PetscFunctionReturn(PETSC_SUCCESS);
}
