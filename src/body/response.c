/*
   The response of a linear body, over one controller step, to what comes in at its interface rows.

   It serves twice: its values on the rows are the interface compliance that the outer Newton iteration wants, and with one
   substep the whole end state is affine in the inputs, so that repeated sweeps of a controller step add columns instead of
   solving again.

   The body is probed once for each input, by a hat: one at the end of the first substep, zero at the start and from the second
   substep on. Since the body does not change with time, what comes out k substeps after the hat is the same wherever it stands.
*/
#include "bodyimpl.h"

/* Above this many rows the columns of whole states would cost more memory and time than they save. */
#define MAX_CONDENSED_ROWS 16
#define N_BACKUP           7

typedef enum {
  INPUT_DISPLACEMENT,
  INPUT_VELOCITY,
  INPUT_ACCELERATION,
  INPUT_FORCE
} InputKind;

typedef struct {
  PetscInt     row; /* global */
  InputKind    kind;
  Vec          change[4];  /* of displacement, velocity, acceleration, internal force */
  PetscBool    changes[4]; /* whether they are not zero: a velocity, say, changes little but itself */
  PetscScalar *rows;       /* displacement, velocity, acceleration, reaction: 4 x local rows */
} Column;

struct _BodyResponse {
  PetscBool      made;  /* there is a matrix, for `conditions` */
  PetscBool      valid; /* these are the present conditions */
  BodyCondition *conditions;
  PetscBool      window_valid; /* the present end state came from `inputs` */
  PetscBool      condensed;    /* columns hold states */
  /* all rows by all rows, by columns: reaction of prescribed, displacement of other rows, for displacements and forces */
  PetscScalar *waveform;       /* at the end of each substep, for a hat in the first: substeps of them */
  PetscScalar *matrix;         /* at the end of the controller step, for inputs that rise linearly over it */
  PetscScalar *rate_matrix[2]; /* for velocities and accelerations, with one substep */
  PetscInt     n_columns;
  Column      *columns;             /* at most 3 for each row */
  PetscScalar *inputs, *new_inputs; /* of all rows on every rank, 4 kinds each */
  PetscScalar *mine;
  /* what probing overwrites: present and saved state, internal force; all traces */
  Vec          backup[N_BACKUP];
  PetscScalar *backup_traces;
  PetscMPIInt *kinds; /* conditions of all rows */
};

PetscErrorCode BodyDestroyResponse(Body body)
{
  struct _BodyResponse *response = body->response;

  PetscFunctionBegin;
  if (!response) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < 3 * body->rows.global; c++) {
    for (PetscInt k = 0; k < 4; k++) PetscCall(VecDestroy(&response->columns[c].change[k]));
    PetscCall(PetscFree(response->columns[c].rows));
  }
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDestroy(&response->backup[k]));
  PetscCall(PetscFree2(response->backup_traces, response->kinds));
  PetscCall(PetscFree4(response->waveform, response->matrix, response->rate_matrix[0], response->rate_matrix[1]));
  PetscCall(PetscFree5(response->columns, response->inputs, response->new_inputs, response->mine, response->conditions));
  PetscCall(PetscFree(body->response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the response was made for the present conditions, as far as this rank can tell */
PetscBool BodyMatchResponse(Body body)
{
  const struct _BodyResponse *response = body->response;

  if (!response || !response->made) return PETSC_FALSE;
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (response->conditions[i] != body->conditions[i]) return PETSC_FALSE;
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
    PetscCall(TraceGetLevel(traces[kind], body->substeps, &values));
    for (PetscInt i = 0; i < rows->local; i++) mine[4 * i + kind] = values[i];
  }
  if (rows->size > 1) PetscCallMPI(MPI_Allgatherv(mine, (PetscMPIInt)(4 * rows->local), MPIU_SCALAR, all, rows->counts, rows->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)body)));
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
  const Vec    vecs[]   = {body->state.u, body->state.v, body->state.a, body->internal_force};
  PetscScalar *values;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++)
    if (column->changes[k]) PetscCall(VecAXPY(vecs[k], change, column->change[k]));
  for (PetscInt t = 0; t < 4; t++) {
    PetscCall(TraceGetLevel(traces[t], body->substeps, &values));
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
  body->total_substeps += body->substeps;
  *done = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUnitInput(Body body, PetscInt row, InputKind kind)
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

/* Column `row` of a response matrix, on every rank: the force along prescribed and Robin rows, the displacement of the others */
static PetscErrorCode GatherOutputs(Body body, const PetscScalar displacement[], const PetscScalar reaction[], PetscScalar matrix[], PetscInt row)
{
  struct _BodyResponse *response = body->response;
  const BodyRows       *rows     = &body->rows;

  PetscFunctionBegin;
  /* in steps of four, as the counts and offsets are */
  for (PetscInt i = 0; i < rows->local; i++) response->mine[4 * i] = body->conditions[i] == BODY_PRESCRIBED || body->conditions[i] == BODY_ROBIN ? reaction[i] : displacement[i];
  PetscCallMPI(MPI_Allgatherv(response->mine, (PetscMPIInt)(4 * rows->local), MPIU_SCALAR, response->new_inputs, rows->counts, rows->offsets, MPIU_SCALAR, PetscObjectComm((PetscObject)body)));
  for (PetscInt i = 0; i < rows->global; i++) matrix[row * rows->global + i] = response->new_inputs[4 * i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One column: integrates a body at rest under one unit input */
static PetscErrorCode Probe(Body body, PetscInt row, InputKind kind)
{
  struct _BodyResponse *response = body->response;
  const Trace           traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};
  const Vec             vecs[]   = {body->state.u, body->state.v, body->state.a, body->internal_force};
  PetscScalar          *outputs[4];
  Column               *column;

  PetscFunctionBegin;
  PetscCall(SetUnitInput(body, row, kind));
  PetscCall(BodyRestore(body));
  PetscCall(BodyIntegrateWindow(body));
  body->total_substeps -= body->substeps;
  for (PetscInt level = 1; level <= body->substeps; level++) {
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
  PetscCall(MaterialIsLinear(body->material, &linear));
  response->condensed = (PetscBool)(linear && body->substeps == 1 && rows->global <= MAX_CONDENSED_ROWS);
  PetscCall(PetscCalloc4(body->substeps * rows->global * rows->global, &response->waveform, rows->global * rows->global, &response->matrix, rows->global * rows->global, &response->rate_matrix[0], rows->global * rows->global, &response->rate_matrix[1]));
  PetscCall(PetscCalloc5(3 * rows->global, &response->columns, 4 * rows->global, &response->inputs, 4 * rows->global, &response->new_inputs, 4 * rows->local + 1, &response->mine, rows->local, &response->conditions));
  PetscCall(PetscMalloc2(8 * (body->substeps + 1) * rows->local, &response->backup_traces, rows->global, &response->kinds));
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecDuplicate(body->state.u, &response->backup[k]));
  if (!response->condensed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < 3 * rows->global; c++) {
    for (PetscInt k = 0; k < 4; k++) PetscCall(VecDuplicate(body->state.u, &response->columns[c].change[k]));
    PetscCall(PetscMalloc1(4 * rows->local, &response->columns[c].rows));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a body is in time, beside what its response keeps of its state */
typedef struct {
  PetscReal time, saved_time;
  PetscInt  step, saved_step;
} Clock;

static PetscErrorCode CopyTraces(Body body, PetscScalar buffer[], PetscBool store)
{
  const Trace    traces[] = {body->traces.displacement_in, body->traces.velocity_in, body->traces.acceleration_in, body->traces.force_in, body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};
  const PetscInt n        = (body->substeps + 1) * body->rows.local;
  PetscScalar   *values;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 8; t++) {
    PetscCall(TraceGetLevel(traces[t], 0, &values));
    if (store) PetscCall(PetscArraycpy(buffer + t * n, values, n));
    else PetscCall(PetscArraycpy(values, buffer + t * n, n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BeginProbing(Body body, Clock *clock)
{
  struct _BodyResponse *response       = body->response;
  const Vec             vecs[N_BACKUP] = {body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->internal_force};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < N_BACKUP; k++) {
    PetscCall(VecCopy(vecs[k], response->backup[k]));
    PetscCall(VecZeroEntries(vecs[k]));
  }
  PetscCall(CopyTraces(body, response->backup_traces, PETSC_TRUE));
  clock->time       = body->time;
  clock->saved_time = body->saved_time;
  clock->step       = body->step;
  clock->saved_step = body->saved_step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndProbing(Body body, const Clock *clock)
{
  struct _BodyResponse *response       = body->response;
  const Vec             vecs[N_BACKUP] = {body->state.u, body->state.v, body->state.a, body->saved.u, body->saved.v, body->saved.a, body->internal_force};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < N_BACKUP; k++) PetscCall(VecCopy(response->backup[k], vecs[k]));
  PetscCall(CopyTraces(body, response->backup_traces, PETSC_FALSE));
  body->time       = clock->time;
  body->saved_time = clock->saved_time;
  body->step       = clock->step;
  body->saved_step = clock->saved_step;
  PetscCall(TSSecondOrderSetState(body->ts, body->time, body->time_step, body->step));
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
  Clock                 clock = {0};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->response) PetscCall(CreateResponse(body));
  response = body->response;
  kinds    = response->kinds;
  *matrix  = response->matrix;
  if (response->valid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(BODY_Response, body, 0, 0, 0));
  response->n_columns = 0;
  PetscCall(PetscArrayzero(response->waveform, body->substeps * rows->global * rows->global));
  PetscCall(PetscArrayzero(response->matrix, rows->global * rows->global));
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscArrayzero(response->rate_matrix[k], rows->global * rows->global));
  PetscCall(BeginProbing(body, &clock));
  for (PetscInt row = 0; row < rows->global; row++) {
    const PetscInt local = row - rows->begin;

    kinds[row] = local >= 0 && local < rows->local ? (PetscMPIInt)body->conditions[local] : 0;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, kinds, (PetscMPIInt)rows->global, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  for (PetscInt row = 0; row < rows->global; row++) {
    if (kinds[row] == BODY_FORCED || kinds[row] == BODY_ROBIN) PetscCall(Probe(body, row, INPUT_FORCE));
    if (kinds[row] != BODY_PRESCRIBED) continue;
    PetscCall(Probe(body, row, INPUT_DISPLACEMENT));
    if (!body->prescribed_mass || body->substeps > 1) continue;
    PetscCall(Probe(body, row, INPUT_VELOCITY));
    PetscCall(Probe(body, row, INPUT_ACCELERATION));
  }
  PetscCall(EndProbing(body, &clock));
  /* a linear rise is a sum of hats */
  for (PetscInt level = 1; level <= body->substeps; level++)
    for (PetscInt i = 0; i < rows->global * rows->global; i++) response->matrix[i] += (PetscReal)level / body->substeps * response->waveform[(body->substeps - level) * rows->global * rows->global + i];
  PetscCall(PetscArraycpy(response->conditions, body->conditions, rows->local));
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
  PetscCheck(body->response && body->response->valid, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodyComputeResponse() first");
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
  PetscCheck(body->response && body->response->valid, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodyComputeResponse() first");
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
  if (!body->response) PetscCall(CreateResponse(body));
  if (body->response->condensed && !body->response->valid) PetscCall(BodyComputeResponse(body, &matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
