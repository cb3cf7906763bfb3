/*
   The response of a linear body, over one controller step, to what comes in at its interface rows.

   It serves twice: its values on the rows are the interface compliance that the outer Newton iteration wants, and with one
   substep the whole end state is affine in the inputs, so that repeated sweeps of a controller step add columns instead of
   solving again.

   The body is probed once for each input, by a hat: one at the end of the first substep, zero at the start and from the second
   substep on. Since the body does not change with time, what comes out k substeps after the hat is the same wherever it stands.
*/
#include "responseimpl.h"

/* Above this many rows the columns of whole states would cost more memory and time than they save. */
#define MAX_CONDENSED_ROWS 16

PetscErrorCode BodyDestroyResponse(Body body)
{
  struct _BodyResponse *response = body->response;

  PetscFunctionBegin;
  if (!response) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < 3 * body->rows.global; c++) {
    for (PetscInt k = 0; k < 4; k++) PetscCall(VecDestroy(&response->columns[c].change[k]));
    PetscCall(PetscFree(response->columns[c].rows));
  }
  PetscCall(PetscFree(response->kinds));
  PetscCall(PetscFree4(response->waveform, response->matrix, response->rate_matrix[0], response->rate_matrix[1]));
  PetscCall(PetscFree5(response->columns, response->inputs, response->new_inputs, response->mine, response->conditions));
  PetscCall(PetscFree(body->response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Column `row` of a response matrix, on every rank: the force along prescribed and Robin rows, the displacement of the others */
static PetscErrorCode GatherOutputs(Body body, const PetscScalar displacement[], const PetscScalar reaction[], PetscScalar matrix[],
                                    PetscInt row)
{
  struct _BodyResponse *response = body->response;
  const BodyRows       *rows     = &body->rows;

  PetscFunctionBegin;
  /* in steps of four, as the counts and offsets are */
  for (PetscInt i = 0; i < rows->local; i++)
    response->mine[4 * i] = body->rows.conditions[i] == BODY_PRESCRIBED || body->rows.conditions[i] == BODY_ROBIN ? reaction[i]
                                                                                                                  : displacement[i];
  PetscCallMPI(MPI_Allgatherv(response->mine, (PetscMPIInt)(4 * rows->local), MPIU_SCALAR, response->new_inputs, rows->counts,
                              rows->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)body)));
  for (PetscInt i = 0; i < rows->global; i++) matrix[row * rows->global + i] = response->new_inputs[4 * i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One column: integrates a body at rest under one unit input */
static PetscErrorCode Probe(Body body, PetscInt row, InputKind kind)
{
  struct _BodyResponse *response = body->response;
  const Trace           traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};
  const Vec             vecs[]   = {body->state.u, body->state.v, body->state.a, body->state.internal_force};
  PetscScalar          *outputs[4];
  Column               *column;

  PetscFunctionBegin;
  PetscCall(BodySetUnitInput(body, row, kind));
  PetscCall(BodyRestore(body));
  PetscCall(BodyIntegrateWindow(body));
  body->statistics.substeps -= body->time.substeps;
  for (PetscInt level = 1; level <= body->time.substeps; level++) {
    PetscScalar *matrix = response->waveform + (level - 1) * body->rows.global * body->rows.global;

    for (PetscInt t = 0; t < 4; t++) PetscCall(TraceGetLevel(traces[t], level, &outputs[t]));
    if (kind == INPUT_VELOCITY) matrix = response->rate_matrix[0];
    if (kind == INPUT_ACCELERATION) matrix = response->rate_matrix[1];
    PetscCall(GatherOutputs(body, outputs[0], outputs[3], matrix, row));
  }
  if (!response->condensed) PetscFunctionReturn(PETSC_SUCCESS);
  column       = &response->columns[response->n_columns++];
  column->row  = row;
  column->kind = kind;
  for (PetscInt t = 0; t < 4; t++) PetscCall(PetscArraycpy(column->rows + t * body->rows.local, outputs[t], body->rows.local));
  for (PetscInt k = 0; k < 4; k++) {
    PetscReal norm;

    PetscCall(VecNorm(vecs[k], NORM_INFINITY, &norm));
    column->changes[k] = (PetscBool)(norm > 0);
    if (column->changes[k]) PetscCall(VecCopy(vecs[k], column->change[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateResponse(Body body)
{
  struct _BodyResponse *response;
  BodyRows             *rows = &body->rows;
  PetscBool             linear;

  PetscFunctionBegin;
  PetscCall(PetscNew(&body->response));
  response = body->response;
  PetscCall(MaterialIsLinear(body->model.material, &linear));
  response->condensed = (PetscBool)(linear && body->time.substeps == 1 && rows->global <= MAX_CONDENSED_ROWS);
  PetscCall(PetscCalloc4(body->time.substeps * rows->global * rows->global, &response->waveform, rows->global * rows->global,
                         &response->matrix, rows->global * rows->global, &response->rate_matrix[0], rows->global * rows->global,
                         &response->rate_matrix[1]));
  PetscCall(PetscCalloc5(3 * rows->global, &response->columns, 4 * rows->global, &response->inputs, 4 * rows->global, &response->new_inputs,
                         4 * rows->local + 1, &response->mine, rows->local, &response->conditions));
  PetscCall(PetscMalloc1(rows->global, &response->kinds));
  if (!response->condensed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < 3 * rows->global; c++) {
    for (PetscInt k = 0; k < 4; k++) PetscCall(VecDuplicate(body->state.u, &response->columns[c].change[k]));
    PetscCall(PetscMalloc1(4 * rows->local, &response->columns[c].rows));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComputeResponse - what comes out of the rows for a unit input on each, under the present conditions

  Collective

  Input Parameter:
. body - the `Body`, linear

  Output Parameter:
. matrix - all rows by all rows, by columns, on every rank, owned by the body. Inputs rise linearly over the controller step to
           a displacement of 1 m on prescribed rows and a force of 1 N on forced and Robin rows; outputs, at its end, are the
           force along prescribed and Robin rows [N] and the displacement of all others [m]

  Level: developer

  Note:
  The interface compliance of the body. Made again only when the conditions have changed.

.seealso: `Body`, `BodySetConditions()`
@*/
PetscErrorCode BodyComputeResponse(Body body, const PetscScalar *matrix[])
{
  struct _BodyResponse *response;
  BodyRows             *rows = &body->rows;
  PetscMPIInt          *kinds;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->response) PetscCall(CreateResponse(body));
  response = body->response;
  kinds    = response->kinds;
  *matrix  = response->matrix;
  if (response->valid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(body->model.linear, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "Body '%s' is nonlinear, and the outer iteration wants its response as if it were linear; choose one that does without, as "
             "-schwarz_snes_type anderson, or explicit penalty",
             body->hdr.name);
  PetscCall(PetscLogEventBegin(BODY_Response, body, 0, 0, 0));
  response->n_columns = 0;
  PetscCall(PetscArrayzero(response->waveform, body->time.substeps * rows->global * rows->global));
  PetscCall(PetscArrayzero(response->matrix, rows->global * rows->global));
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscArrayzero(response->rate_matrix[k], rows->global * rows->global));
  PetscCall(BodyBeginProbe(body));
  for (PetscInt row = 0; row < rows->global; row++) {
    const PetscInt local = row - rows->begin;

    kinds[row] = local >= 0 && local < rows->local ? (PetscMPIInt)body->rows.conditions[local] : 0;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, kinds, (PetscMPIInt)rows->global, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  for (PetscInt row = 0; row < rows->global; row++) {
    if (kinds[row] == BODY_FORCED || kinds[row] == BODY_ROBIN) PetscCall(Probe(body, row, INPUT_FORCE));
    if (kinds[row] != BODY_PRESCRIBED) continue;
    PetscCall(Probe(body, row, INPUT_DISPLACEMENT));
    if (!body->rows.have_mass || body->time.substeps > 1) continue;
    PetscCall(Probe(body, row, INPUT_VELOCITY));
    PetscCall(Probe(body, row, INPUT_ACCELERATION));
  }
  PetscCall(BodyEndProbe(body));
  /* a linear rise is a sum of hats */
  for (PetscInt level = 1; level <= body->time.substeps; level++)
    for (PetscInt i = 0; i < rows->global * rows->global; i++)
      response->matrix[i] += (PetscReal)level / body->time.substeps *
                             response->waveform[(body->time.substeps - level) * rows->global * rows->global + i];
  PetscCall(PetscArraycpy(response->conditions, body->rows.conditions, rows->local));
  response->made = response->valid = PETSC_TRUE;
  PetscCall(PetscLogEventEnd(BODY_Response, body, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetWaveformResponse - what comes out of the rows in the course of the controller step, for an input at the end of its first
  substep alone

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodyComputeResponse()`

  Output Parameter:
. matrices - one for each substep, each laid out as the matrix of `BodyComputeResponse()`; owned by the body

  Level: developer

  Note:
  The output at the end of substep k for an input at the end of substep l is matrix k - l. Velocities and accelerations that go
  with a prescribed displacement are left out.

.seealso: `Body`, `BodyComputeResponse()`
@*/
PetscErrorCode BodyGetWaveformResponse(Body body, const PetscScalar *matrices[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->response && body->response->valid, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call BodyComputeResponse() first");
  *matrices = body->response->waveform;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetRateResponse - what comes out of the rows for a unit velocity or acceleration on each prescribed one, at rest otherwise

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodyComputeResponse()`, with one substep

  Output Parameters:
+ velocity     - reaction or displacement for 1 m/s, laid out as the matrix of `BodyComputeResponse()`
- acceleration - for 1 m/s^2

  Level: developer

  Note:
  Zero where the contact nodes are massless.

.seealso: `Body`, `BodyComputeResponse()`
@*/
PetscErrorCode BodyGetRateResponse(Body body, const PetscScalar *velocity[], const PetscScalar *acceleration[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->response && body->response->valid, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call BodyComputeResponse() first");
  *velocity     = body->response->rate_matrix[0];
  *acceleration = body->response->rate_matrix[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyPrepareSweeps - makes what repeated calls of `BodyIntegrate()` in one controller step profit from, under the present
  conditions

  Collective

  Input Parameter:
. body - the `Body`

  Level: developer

.seealso: `Body`, `BodyIntegrate()`
@*/
PetscErrorCode BodyPrepareSweeps(Body body)
{
  const PetscScalar *matrix;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (body->rows.global > MAX_CONDENSED_ROWS) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->response) PetscCall(CreateResponse(body));
  if (body->response->condensed && !body->response->valid) PetscCall(BodyComputeResponse(body, &matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
