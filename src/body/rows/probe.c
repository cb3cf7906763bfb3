/* A body is put to rest, without loads, to see what unit inputs at its rows bring about; afterwards it is as it was. */
#include "probe.h"

#define N_BACKUP 7

/* What probing overwrites: present and saved state, internal force; forces from outside, NULL without loads; all traces; where the body is
   in time */
struct _BodyProbe {
  Vec          vecs[N_BACKUP], applied;
  PetscScalar *traces;
  PetscReal    time, saved_time, work;
  PetscInt     step, saved_step;
};

PetscErrorCode BodyDestroyProbe(Body body)
{
  PetscFunctionBegin;
  if (!body->probe) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDestroy(&body->probe->vecs[k]));
  PetscCall(VecDestroy(&body->probe->applied));
  PetscCall(PetscFree(body->probe->traces));
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
PetscErrorCode BodyBeginProbe(Body body)
{
  const Vec vecs[N_BACKUP] = {
      body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->state.internal_force};

  PetscFunctionBegin;
  if (!body->probe) {
    PetscCall(PetscNew(&body->probe));
    PetscCall(PetscMalloc1(8 * (body->time.substeps + 1) * body->rows.local, &body->probe->traces));
    for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDuplicate(body->state.u, &body->probe->vecs[k]));
    if (body->state.applied) PetscCall(VecDuplicate(body->state.applied, &body->probe->applied));
  }
  for (PetscInt k = 0; k < N_BACKUP; k++) {
    PetscCall(VecCopy(vecs[k], body->probe->vecs[k]));
    PetscCall(VecZeroEntries(vecs[k]));
  }
  if (body->state.applied) PetscCall(VecCopy(body->state.applied, body->probe->applied));
  PetscCall(CopyTraces(body, PETSC_TRUE));
  body->probe->time       = body->state.time;
  body->probe->saved_time = body->saved.time;
  body->probe->step       = body->state.step;
  body->probe->saved_step = body->saved.step;
  body->probe->work       = body->state.external_work;
  body->unloaded          = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A unit at the end of the first substep, on one row alone; zero at the start and from the second substep on */
PetscErrorCode BodySetUnitInput(Body body, PetscInt row, InputKind kind)
{
  const Trace    traces[] = {body->traces.displacement_in, body->traces.velocity_in, body->traces.acceleration_in, body->traces.force_in};
  const PetscInt local    = row - body->rows.begin;
  PetscScalar   *values;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 4; t++) PetscCall(TraceZero(traces[t]));
  if (local < 0 || local >= body->rows.local) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TraceGetLevel(traces[kind], 1, &values));
  values[local] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyEndProbe(Body body)
{
  const Vec vecs[N_BACKUP] = {
      body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->state.internal_force};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecCopy(body->probe->vecs[k], vecs[k]));
  if (body->state.applied) PetscCall(VecCopy(body->probe->applied, body->state.applied));
  PetscCall(CopyTraces(body, PETSC_FALSE));
  body->state.time          = body->probe->time;
  body->saved.time          = body->probe->saved_time;
  body->state.step          = body->probe->step;
  body->saved.step          = body->probe->saved_step;
  body->state.external_work = body->probe->work;
  body->unloaded            = PETSC_FALSE;
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
