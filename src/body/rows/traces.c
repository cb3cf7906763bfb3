/* What the rows of a body do in a substep, written to its traces. */
#include <body/layout/bodyimpl.h>

/* values = rows vec, of this rank */
PetscErrorCode BodyReadRows(Body body, Mat rows, Vec vec, PetscScalar values[])
{
  const PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(rows, vec, body->work.rows[0]));
  PetscCall(VecGetArrayRead(body->work.rows[0], &row));
  PetscCall(PetscArraycpy(values, row, body->rows.local));
  PetscCall(VecRestoreArrayRead(body->work.rows[0], &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* f = rows^T values, which this rank has of its rows */
PetscErrorCode BodySpreadRows(Body body, Mat rows, const PetscScalar values[], Vec f)
{
  PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
  PetscCall(PetscArraycpy(row, values, body->rows.local));
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
  PetscCall(MatMultTranspose(rows, body->work.rows[0], f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What rows make of a vector, at a level of a trace */
PetscErrorCode BodyWriteTrace(Body body, Mat rows, Vec vec, Trace trace, PetscInt level)
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(trace, level, &values));
  PetscCall(BodyReadRows(body, rows, vec, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces at the end of a substep such that those at its stage lie on the line from its start: partners take them as varying linearly, and
   get at the stage what has held the rows there. By the balance at the end momentum would change by what is nonlinear in the substep. */
static PetscErrorCode ExtendFromStage(Body body, PetscInt level, PetscScalar reaction[])
{
  const PetscReal stage = body->rows.stage;
  PetscScalar    *start;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(body->traces.reaction, level - 1, &start));
  for (PetscInt i = 0; i < body->rows.local; i++) reaction[i] = (reaction[i] - (1 - stage) * start[i]) / stage;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the near rows make of a vector, at a level of a trace */
static PetscErrorCode WriteNear(Body body, Vec vec, Trace trace, PetscInt level)
{
  const RowList     *near = &body->rows.near;
  const PetscScalar *row;
  PetscScalar       *values;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(trace, level, &values));
  PetscCall(MatMult(near->matrix, vec, near->values));
  PetscCall(VecGetArrayRead(near->values, &row));
  for (PetscInt k = 0; k < near->n; k++) values[near->numbers[k]] = row[k];
  PetscCall(VecRestoreArrayRead(near->values, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the displacement of BodyWriteTraces(). With forces constant in a controller step only tied nodes with mass need accelerations. */
static PetscErrorCode WriteRates(Body body, PetscInt level)
{
  const PetscBool at_stage = (PetscBool)(level && body->rows.stage_balance);
  const RowList  *near     = &body->rows.near;
  PetscScalar    *reaction, *displacement, *acceleration, *force_in;

  PetscFunctionBegin;
  PetscCall(WriteNear(body, body->state.v, body->traces.velocity, level));
  if (body->state.incomplete && !body->held.any) {
    PetscCall(TraceGetLevel(body->traces.acceleration, level, &acceleration));
    for (PetscInt k = 0; k < near->n; k++) acceleration[near->numbers[k]] = 0;
  } else if (!body->rows.constant || body->rows.tied_mass) PetscCall(WriteNear(body, body->state.a, body->traces.acceleration, level));
  if (body->rows.n_prescribed) {
    Vec             force   = body->state.internal_force;
    const PetscBool inertia = (PetscBool)(body->rows.traction == BODY_TRACTION_REACTION || body->rows.tied_mass);

    PetscCall(BodyFindInternalForce(body));
    if (at_stage) force = body->rows.stage_balance;
    else if (inertia || body->loads || body->state.damping || body->rows.n_forced || BodyHandsOver(body)) {
      force = body->work.nodes[0];
      if (inertia) {
        PetscCall(BodyMultiplyMass(body, body->state.a, force));
        PetscCall(VecAXPY(force, 1, body->state.internal_force));
      } else PetscCall(VecCopy(body->state.internal_force, force));
      if (body->state.damping) PetscCall(VecAXPY(force, 1, body->state.damping));
      /* what is loaded and prescribed at once has the load in its balance */
      PetscCall(BodyAddExternalForce(body, body->state.time, -1, force));
      PetscCall(BodyAddContactForce(body, (PetscReal)level / body->time.substeps, -1, body->state.u, force));
    }
    PetscCall(BodyWriteTrace(body, body->rows.free_matrix, force, body->traces.reaction, level));
  }
  PetscCall(TraceGetLevel(body->traces.reaction, level, &reaction));
  if (body->rows.n_prescribed) BodyDivideByGram(body, reaction);
  if (body->rows.n_prescribed && at_stage) PetscCall(ExtendFromStage(body, level, reaction));
  PetscCall(TraceGetLevel(body->traces.displacement, level, &displacement));
  PetscCall(TraceGetLevel(body->traces.force_in, level, &force_in));
  /* nobody reads reactions of rows that are under given forces */
  for (PetscInt k = 0; k < near->n && (!body->rows.constant || body->rows.n_prescribed || body->rows.n_robin); k++) {
    const PetscInt i = near->numbers[k];

    if (body->rows.conditions[i] == BODY_ROBIN) reaction[i] = force_in[i] - body->rows.robin[i] * displacement[i];
    else if (body->rows.conditions[i] != BODY_PRESCRIBED) reaction[i] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement, velocity and acceleration of the near rows, and the force along prescribed and Robin ones, as they are now.
   Massless nodes, which all rows are on where the state may be incomplete, have no acceleration unless they are held. */
PetscErrorCode BodyWriteTraces(Body body, PetscInt level)
{
  PetscFunctionBegin;
  if (!body->rows.global || body->unloaded) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->rows.exchange.open) {
    body->rows.exchange.writes = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(WriteNear(body, body->state.u, body->traces.displacement, level));
  /* BodyCompleteStep() writes the rest */
  if (body->state.incomplete && body->rows.constant && !body->rows.n_prescribed && !body->rows.n_robin) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(WriteRates(body, level));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After a state that was incomplete has been completed, whose displacement of rows has been written: the rest */
PetscErrorCode BodyWriteRest(Body body)
{
  PetscFunctionBegin;
  if (!body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->rows.exchange.open) body->rows.exchange.writes = PETSC_TRUE;
  else PetscCall(WriteRates(body, body->time.substeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The waveforms at the rows, owned by the body; level k is the end of substep k */
PetscErrorCode BodyGetTraces(Body body, BodyTraces *traces)
{
  PetscFunctionBegin;
  *traces = body->traces;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Contact force along each near row of this rank at the end of substep 1 to their number [N], reactions on prescribed and Robin rows */
PetscErrorCode BodyGetRowForces(Body body, PetscInt substep, PetscReal force[])
{
  PetscScalar *reaction, *force_in;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(body->traces.reaction, substep, &reaction));
  PetscCall(TraceGetLevel(body->traces.force_in, substep, &force_in));
  for (PetscInt k = 0; k < body->rows.near.n; k++) {
    const PetscInt      i         = body->rows.near.numbers[k];
    const BodyCondition condition = body->rows.conditions[i];

    force[i] = condition == BODY_FREE ? 0 : PetscRealPart(condition == BODY_FORCED ? force_in[i] : reaction[i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
