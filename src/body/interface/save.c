/* The state that a body goes back to: the start of a controller step. */
#include <body/layout/bodyimpl.h>

/* Takes the current state as the start of the next controller step. Collective. */
PetscErrorCode BodySave(Body body)
{
  const PetscBool stepped = (PetscBool)(body->state.step != body->saved.step), here = (PetscBool)!BodyIsElsewhere(body);
  const RowList  *read = &body->rows.near;
  PetscScalar    *start, *end;

  PetscFunctionBegin;
  if (body->rows.local && stepped) {
    const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};

    for (PetscInt i = 0; i < 4; i++) { /* those of other rows are old */
      PetscCall(TraceGetLevel(traces[i], 0, &start));
      PetscCall(TraceGetLevel(traces[i], body->time.substeps, &end));
      if (read->n == body->rows.local) PetscCall(PetscArraycpy(start, end, body->rows.local));
      else
        for (PetscInt k = 0; k < read->n; k++) start[read->numbers[k]] = end[read->numbers[k]];
    }
  }
  /* the end of a single substep may be corrected until it is accepted, by BodyAddImpulses() for one: its work is counted now */
  if (here && body->loads && body->time.substeps == 1 && stepped) PetscCall(BodyAddWork(body, body->substep_start.u));
  if (here && body->time.substeps == 1 && stepped) PetscCall(BodyAddDampingWork(body));
  /* TSStep() fires no monitors, and should not in sweeps: a step is shown once, when it is accepted */
  if (stepped) PetscCall(TSMonitor(body->time.ts, body->state.step, body->state.time, body->state.u));
  if (stepped) PetscCall(BodyNoteStartEnergy(body));
  PetscCall(BodyStateCopy(body, &body->state, &body->saved));
  BodyHistorySave(body);
  if (stepped) PetscCall(BodyUpdateStableStep(body));
  body->start.changed = PETSC_FALSE;
  /* The TS has added up its substeps, with another round-off than the state. Loads are to see the same time whenever the step is made. */
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  if (here && body->integrator->ops.save) PetscCall((*body->integrator->ops.save)(body));
  PetscCall(BodyHandoverEnd(body));
  body->iterate.known = PETSC_FALSE;
  body->repeats       = PETSC_FALSE;
  if (stepped) body->time.accepted_level = body->time.level;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the output traces at all times of the controller step to their values at its start: what the first sweep starts from */
PetscErrorCode BodyResetTraces(Body body)
{
  const Trace  traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};
  PetscScalar *start, *values;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 4; t++) {
    PetscCall(TraceGetLevel(traces[t], 0, &start));
    for (PetscInt level = 1; level <= body->time.substeps; level++) {
      PetscCall(TraceGetLevel(traces[t], level, &values));
      PetscCall(PetscArraycpy(values, start, body->rows.local));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
