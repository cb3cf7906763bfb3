/*
   Repeated sweeps of one controller step: the end state of a linear body with one substep is affine in what comes in at its rows, so
   that a change of inputs adds columns of its response instead of solving again.
*/
#include "responseimpl.h"

/* Whether the response was made for the present conditions, as far as this rank can tell */
PetscBool BodyMatchResponse(Body body)
{
  const struct _BodyResponse *response = body->response;

  if (!response || !response->made) return PETSC_FALSE;
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (response->conditions[i] != body->rows.conditions[i]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The conditions have changed, to some that the response was made for, or others */
PetscErrorCode BodyValidateResponse(Body body, PetscBool valid)
{
  PetscFunctionBegin;
  if (!body->response) PetscFunctionReturn(PETSC_SUCCESS);
  body->response->valid        = valid;
  body->response->window_valid = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The saved state has changed */
PetscErrorCode BodyInvalidateWindow(Body body)
{
  PetscFunctionBegin;
  if (body->response) body->response->window_valid = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All inputs at the end of the controller step, on every rank */
static PetscErrorCode GatherInputs(Body body, PetscScalar all[])
{
  const Trace  traces[] = {body->traces.displacement_in, body->traces.velocity_in, body->traces.acceleration_in, body->traces.force_in};
  BodyRows    *rows     = &body->rows;
  PetscScalar *values, *mine = body->response->mine;

  PetscFunctionBegin;
  for (PetscInt kind = 0; kind < 4; kind++) {
    PetscCall(TraceGetLevel(traces[kind], body->time.substeps, &values));
    for (PetscInt i = 0; i < rows->local; i++) mine[4 * i + kind] = values[i];
  }
  if (rows->size > 1)
    PetscCallMPI(MPI_Allgatherv(mine, (PetscMPIInt)(4 * rows->local), MPIU_SCALAR, all, rows->counts, rows->offsets, MPIU_SCALAR,
                                PetscObjectComm((PetscObject)body)));
  else PetscCall(PetscArraycpy(all, mine, 4 * rows->local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole integration has just been done: remember what came in */
PetscErrorCode BodyNoteWindow(Body body)
{
  PetscFunctionBegin;
  if (!body->response || !body->response->valid || !body->response->condensed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GatherInputs(body, body->response->inputs));
  body->response->window_valid = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddColumn(Body body, const Column *column, PetscScalar change)
{
  const Trace  traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};
  const Vec    vecs[]   = {body->state.u, body->state.v, body->state.a, body->state.internal_force};
  PetscScalar *values;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++)
    if (column->changes[k]) PetscCall(VecAXPY(vecs[k], change, column->change[k]));
  for (PetscInt t = 0; t < 4; t++) {
    PetscCall(TraceGetLevel(traces[t], body->time.substeps, &values));
    for (PetscInt i = 0; i < body->rows.local; i++) values[i] += change * column->rows[t * body->rows.local + i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if it can be done by adding columns */
PetscErrorCode BodyIntegrateByResponse(Body body, PetscBool *done)
{
  struct _BodyResponse *response = body->response;

  PetscFunctionBegin;
  *done = PETSC_FALSE;
  if (!response || !response->window_valid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GatherInputs(body, response->new_inputs));
  for (PetscInt c = 0; c < response->n_columns; c++) {
    const PetscInt  input  = 4 * response->columns[c].row + response->columns[c].kind;
    const PetscReal change = response->new_inputs[input] - response->inputs[input];

    if (change != 0) PetscCall(AddColumn(body, &response->columns[c], change));
  }
  PetscCall(PetscArraycpy(response->inputs, response->new_inputs, 4 * body->rows.global));
  body->statistics.substeps += body->time.substeps;
  *done = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
