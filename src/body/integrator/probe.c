/* A body is put to rest, without loads, to see what a unit force on a row brings about, in the course of a substep or throughout a
   controller step; afterwards it is as it was. */
#include "explicitimpl.h"

#define N_BACKUP 7

/* What probing overwrites: present and saved state, internal force; forces from outside and of dashpots, NULL without any; all traces;
   where the body is in time; a force on
   nodes */
struct _BodyProbe {
  Vec          vecs[N_BACKUP], applied, damping, force;
  PetscScalar *traces;
  PetscScalar *column; /* displacement of this rank's rows, for each substep */
  PetscReal    time, saved_time, work, damping_work;
  PetscInt     step, saved_step;
  PetscBool    force_known; /* whether the internal force is that of the present state: not after a step that has failed */
};

PetscErrorCode BodyDestroyProbe(Body body)
{
  PetscFunctionBegin;
  if (!body->probe) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDestroy(&body->probe->vecs[k]));
  PetscCall(VecDestroy(&body->probe->applied));
  PetscCall(VecDestroy(&body->probe->damping));
  PetscCall(VecDestroy(&body->probe->force));
  PetscCall(PetscFree2(body->probe->traces, body->probe->column));
  PetscCall(PetscFree(body->probe));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyTraces(Body body, PetscBool store)
{
  const Trace    traces[] = {body->traces.displacement_in, body->traces.velocity_in, body->traces.acceleration_in, body->traces.force_in,
                             body->traces.displacement,    body->traces.velocity,    body->traces.acceleration,    body->traces.reaction};
  const PetscInt n        = (body->time.substeps + 1) * body->rows.local;
  PetscScalar   *values;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 8; t++) {
    PetscCall(TraceGetLevel(traces[t], 0, &values));
    if (store) PetscCall(PetscArraycpy(body->probe->traces + t * n, values, n));
    else PetscCall(PetscArraycpy(values, body->probe->traces + t * n, n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the body to rest */
static PetscErrorCode BeginProbe(Body body)
{
  const Vec vecs[N_BACKUP] = {
      body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->state.internal_force};

  PetscFunctionBegin;
  if (!body->probe) {
    PetscCall(PetscNew(&body->probe));
    PetscCall(PetscMalloc2(8 * (body->time.substeps + 1) * body->rows.local, &body->probe->traces, body->time.substeps * body->rows.local,
                           &body->probe->column));
    for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDuplicate(body->state.u, &body->probe->vecs[k]));
    if (body->state.applied) PetscCall(VecDuplicate(body->state.applied, &body->probe->applied));
    if (body->state.damping) PetscCall(VecDuplicate(body->state.damping, &body->probe->damping));
  }
  for (PetscInt k = 0; k < N_BACKUP; k++) {
    PetscCall(VecCopy(vecs[k], body->probe->vecs[k]));
    PetscCall(VecZeroEntries(vecs[k]));
  }
  if (body->state.applied) PetscCall(VecCopy(body->state.applied, body->probe->applied));
  if (body->state.damping) PetscCall(VecCopy(body->state.damping, body->probe->damping));
  PetscCall(CopyTraces(body, PETSC_TRUE));
  body->probe->force_known  = body->state.force_known;
  body->probe->time         = body->state.time;
  body->probe->saved_time   = body->saved.time;
  body->probe->step         = body->state.step;
  body->probe->saved_step   = body->saved.step;
  body->probe->work         = body->state.external_work;
  body->probe->damping_work = body->state.damping_work;
  body->unloaded            = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A force of 1 N along one displacement, at the end of the controller step or throughout it, so that the step starts from it too */
static PetscErrorCode SetUnitNodalForce(Body body, PetscInt dof)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(body->probe->force));
  PetscCall(VecGetOwnershipRange(body->probe->force, &begin, &end));
  if (dof >= begin && dof < end) PetscCall(VecSetValue(body->probe->force, dof, 1, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(body->probe->force));
  PetscCall(VecAssemblyEnd(body->probe->force));
  if (body->rows.nodal_shape == BODY_FORCE_LINEAR) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecCopy(body->probe->force, body->work.nodes[0]));
  PetscCall(BodyAnswerAtStart(body, body->saved.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndProbe(Body body)
{
  const Vec vecs[N_BACKUP] = {
      body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->state.internal_force};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecCopy(body->probe->vecs[k], vecs[k]));
  if (body->state.applied) PetscCall(VecCopy(body->probe->applied, body->state.applied));
  if (body->state.damping) PetscCall(VecCopy(body->probe->damping, body->state.damping));
  PetscCall(CopyTraces(body, PETSC_FALSE));
  body->state.force_known   = body->probe->force_known;
  body->state.time          = body->probe->time;
  body->saved.time          = body->probe->saved_time;
  body->state.step          = body->probe->step;
  body->saved.step          = body->probe->saved_step;
  body->state.external_work = body->probe->work;
  body->state.damping_work  = body->probe->damping_work;
  body->unloaded            = PETSC_FALSE;
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The substeps of a controller step */
static PetscErrorCode Integrate(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyRestore(body));
  StepFailureClear(&body->failure);
  PetscCall(BodyMakeSubsteps(body));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)body), &body->failure));
  body->statistics.substeps -= body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyProbeNodes - columns of displacements, by their numbers on all ranks, at the end of a controller step: by making its substeps, of a
   body at rest with all rows free */
PetscErrorCode BodyProbeNodes(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], Compliance matrices)
{
  const PetscInt counts[3] = {body->rows.n_prescribed, body->rows.n_forced, body->rows.n_robin};
  BodyCondition *kept;

  PetscFunctionBegin;
  PetscCall(BeginProbe(body));
  PetscCall(PetscMalloc1(body->rows.local, &kept));
  PetscCall(PetscArraycpy(kept, body->rows.conditions, body->rows.local));
  PetscCall(PetscArrayzero(body->rows.conditions, body->rows.local));
  body->rows.n_prescribed = body->rows.n_robin = 0;
  body->rows.n_forced                          = 1;
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyPrepareLinearized(body));
  body->model.linearized = (PetscBool)!body->model.linear;
  if (!body->probe->force) PetscCall(VecDuplicate(body->state.u, &body->probe->force));
  body->rows.nodal_force = body->probe->force;
  body->rows.nodal_shape = shape;
  for (PetscInt i = 0; i < n; i++) {
    const PetscScalar *u;

    if (ComplianceKnows(matrices, dofs[i])) continue;
    PetscCall(SetUnitNodalForce(body, dofs[i]));
    PetscCall(Integrate(body));
    PetscCall(VecGetArrayRead(body->state.u, &u));
    PetscCall(ComplianceSetColumn(matrices, dofs[i], u));
    PetscCall(VecRestoreArrayRead(body->state.u, &u));
  }
  body->rows.nodal_force = NULL;
  body->model.linearized = PETSC_FALSE;
  PetscCall(EndProbe(body));
  PetscCall(PetscArraycpy(body->rows.conditions, kept, body->rows.local));
  body->rows.n_prescribed = counts[0];
  body->rows.n_forced     = counts[1];
  body->rows.n_robin      = counts[2];
  PetscCall(BodySetConstraints(body));
  PetscCall(PetscFree(kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}
