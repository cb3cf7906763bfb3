/* What the rows of a body do in a substep, written to its traces. */
#include <body/layout/bodyimpl.h>

/* What rows make of a vector, at a level of a trace */
PetscErrorCode BodyWriteTrace(Body body, Mat rows, Vec vec, Trace trace, PetscInt level)
{
  const PetscScalar *row;
  PetscScalar       *values;

  PetscFunctionBegin;
  PetscCall(MatMult(rows, vec, body->row_vec[0]));
  PetscCall(TraceGetLevel(trace, level, &values));
  PetscCall(VecGetArrayRead(body->row_vec[0], &row));
  PetscCall(PetscArraycpy(values, row, body->rows.local));
  PetscCall(VecRestoreArrayRead(body->row_vec[0], &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement, velocity and acceleration of all rows, and the force along prescribed and Robin ones, as they are now */
PetscErrorCode BodyWriteTraces(Body body, PetscInt level)
{
  PetscScalar *reaction, *displacement, *force_in;

  PetscFunctionBegin;
  if (!body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyWriteTrace(body, body->interface, body->state.u, body->traces.displacement, level));
  PetscCall(BodyWriteTrace(body, body->interface, body->state.v, body->traces.velocity, level));
  PetscCall(BodyWriteTrace(body, body->interface, body->state.a, body->traces.acceleration, level));
  if (body->n_prescribed) {
    Vec force = body->internal_force;

    if (body->traction == BODY_TRACTION_REACTION || body->loads || body->n_forced) {
      force = body->work[0];
      if (body->traction == BODY_TRACTION_REACTION) {
        PetscCall(BodyMultiplyMass(body, body->state.a, force));
        PetscCall(VecAXPY(force, 1, body->internal_force));
      } else PetscCall(VecCopy(body->internal_force, force));
      /* what is loaded and prescribed at once has the load in its balance */
      PetscCall(BodyAddExternalForce(body, body->time, -1, force));
      PetscCall(BodyAddContactForce(body, (PetscReal)level / body->substeps, -1, body->state.u, force));
    }
    PetscCall(BodyWriteTrace(body, body->free_rows, force, body->traces.reaction, level));
  }
  PetscCall(TraceGetLevel(body->traces.reaction, level, &reaction));
  if (body->n_prescribed) BodyDivideByGram(body, reaction);
  PetscCall(TraceGetLevel(body->traces.displacement, level, &displacement));
  PetscCall(TraceGetLevel(body->traces.force_in, level, &force_in));
  for (PetscInt i = 0; i < body->rows.local; i++) {
    if (body->conditions[i] == BODY_ROBIN) reaction[i] = force_in[i] - body->robin[i] * displacement[i];
    else if (body->conditions[i] != BODY_PRESCRIBED) reaction[i] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetTraces - the waveforms through which the body talks with its partners

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. traces - the waveforms, owned by the body; level k is the end of substep k

  Level: developer

.seealso: `Body`, `BodyTraces`, `BodyIntegrate()`
@*/
PetscErrorCode BodyGetTraces(Body body, BodyTraces *traces)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  *traces = body->traces;
  PetscFunctionReturn(PETSC_SUCCESS);
}
