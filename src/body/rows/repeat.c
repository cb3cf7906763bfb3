/*
   Sweeps of one controller step integrate a body again and again from one state, with other inputs at its rows. Where it makes one substep,
   its integrator may find what a change of the inputs changes at the end of the step without another whole step.
*/
#include <body/layout/bodyimpl.h>

struct _BodyRepeat {
  PetscScalar *inputs[2], *changes[2]; /* of this rank's rows, at the end of the controller step: force [N], displacement [m] */
  PetscBool    told;                   /* ranks have told each other how inputs have changed */
  PetscScalar  news[2];                /* then, the numbers of ranks on which they have, and on which they have otherwise than expected */
  PetscBool    expects;                /* what a change of forces brings about has been told */
  PetscScalar *expected;               /* that change, per row of this rank [N] */
};

/* Forces that are to change by so much do, as far as round-off of them tells [of what they were and are] */
#define ROUND_OFF (4 * PETSC_MACHINE_EPSILON)

PetscErrorCode BodyDestroyRepeat(Body body)
{
  PetscFunctionBegin;
  if (!body->repeat) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscFree2(body->repeat->inputs[k], body->repeat->changes[k]));
  PetscCall(PetscFree(body->repeat->expected));
  PetscCall(PetscFree(body->repeat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that nobody looks at have no changes */
PetscErrorCode BodyClearRepeat(Body body)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2 && body->repeat; k++) PetscCall(PetscArrayzero(body->repeat->changes[k], body->rows.local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the integrator and the rows */
PetscErrorCode BodySetUpRepeat(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->repeat));
  for (PetscInt k = 0; k < 2; k++)
    PetscCall(PetscCalloc2(body->rows.local, &body->repeat->inputs[k], body->rows.local, &body->repeat->changes[k]));
  if (body->integrator->ops.expect) PetscCall(PetscCalloc1(body->rows.local, &body->repeat->expected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row takes in a force (0) or a displacement (1) */
static PetscBool Counts(Body body, PetscInt input, PetscInt row)
{
  const BodyCondition condition = body->rows.conditions[row];

  return (PetscBool)(input ? condition == BODY_PRESCRIBED : condition == BODY_FORCED || condition == BODY_ROBIN);
}

/* By how much an input is more than it was, where it counts; news: whether it is, and whether otherwise than expected, which is of forces
   alone */
static PetscScalar Compare(Body body, PetscInt input, PetscInt row, PetscScalar value, PetscBool news[2])
{
  const struct _BodyRepeat *repeat = body->repeat;
  const PetscScalar         before = repeat->inputs[input][row], change = Counts(body, input, row) ? value - before : 0;

  if (change != 0) news[0] = PETSC_TRUE;
  if (!repeat->expects) return change;
  if (input && Counts(body, input, row)) news[1] = PETSC_TRUE;
  if (!input && !(PetscAbsScalar(change - repeat->expected[row]) <= ROUND_OFF * (PetscAbsScalar(value) + PetscAbsScalar(before))))
    news[1] = PETSC_TRUE;
  return change;
}

/* By how much what comes in at the end of the controller step is more than what the present state has, in `changes`, on the rows that it
   counts for; news: as those of Compare() */
static PetscErrorCode CompareInputs(Body body, PetscBool news[2])
{
  const Trace         traces[] = {body->traces.force_in, body->traces.displacement_in};
  struct _BodyRepeat *repeat   = body->repeat;
  const RowList      *read     = body->rows.read;

  PetscFunctionBegin;
  news[0] = PETSC_FALSE;
  news[1] = (PetscBool)!repeat->expects;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(traces[k], body->time.substeps, &values));
    for (PetscInt j = 0; j < read->n; j++) {
      const PetscInt i = read->numbers[j];

      repeat->changes[k][i] = Compare(body, k, i, values[i], news);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What comes in is the present state's from now on: forces, and displacements where any are prescribed */
static PetscErrorCode TakeInputs(Body body)
{
  const Trace    traces[] = {body->traces.force_in, body->traces.displacement_in};
  const RowList *read     = body->rows.read;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < (body->rows.n_prescribed ? 2 : 1); k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(traces[k], body->time.substeps, &values));
    for (PetscInt j = 0; j < read->n; j++) body->repeat->inputs[k][read->numbers[j]] = values[read->numbers[j]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a change of the inputs of any rank counts for all of them */
static PetscBool TellsOthers(Body body)
{
  return (PetscBool)(body->rows.size > 1 && !(BodyStepsAlone(body) && body->rows.at_home));
}

/*@
  BodyProposeRepeat - whether what comes in along the rows of this rank has changed since the last integration, which all ranks are to know

  Not Collective

  Input Parameter:
. body - the `Body`, whose input traces are those of the next `BodyTryIntegrateRows()`

  Output Parameter:
. word - what ranks have to add up before that; it stays with the body. Ranks that are not asked here ask each other there.

  Level: developer

.seealso: `Body`, `BodyTryIntegrateRows()`
@*/
PetscErrorCode BodyProposeRepeat(Body body, BodyWord *word)
{
  struct _BodyRepeat *repeat = body->repeat;
  PetscBool           news[2];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(word, 2);
  word->n = 0;
  if (!body->repeats || !TellsOthers(body)) PetscFunctionReturn(PETSC_SUCCESS);
  repeat->told = PETSC_TRUE;
  PetscCall(CompareInputs(body, news));
  for (PetscInt k = 0; k < 2; k++) repeat->news[k] = news[k];
  word->n      = repeat->expects ? 2 : 1;
  word->values = repeat->news;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings the changes that the next BodyRepeat() makes to the rank that has the body */
PetscErrorCode BodyBringChanges(Body body)
{
  PetscBool news[2];

  PetscFunctionBegin;
  PetscCall(CompareInputs(body, news));
  PetscCall((*body->integrator->ops.bringchanges)(body, body->repeat->changes[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A word that was told before a step that has not been made is not that of the next one */
void BodyDropWord(Body body)
{
  if (body->repeat) body->repeat->told = PETSC_FALSE;
}

/*@
  BodyExpectRepeat - tells what a change of the forces on rows brings about, which the next `BodyTryIntegrateRows()` need not find again

  Not Collective, but all ranks that have rows of the body or parts of it have to call it

  Input Parameters:
+ body   - the `Body`, linear, whose rows answer by a massless layer alone
. change - of the forces on the rows of this rank, as the body feels them [N]
- answer - displacement of the dofs of the layer that this rank has under that change, in the order of the rows of the stiffness that
           `BodyGetLayerMatrices()` gives [m]

  Level: developer

  Note:
  Where inputs turn out to change otherwise on any rank, by more than round-off, the body finds its answer itself.

.seealso: `Body`, `BodyGetLayerMatrices()`, `BodyTryIntegrateRows()`
@*/
PetscErrorCode BodyExpectRepeat(Body body, const PetscScalar change[], const PetscScalar answer[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->integrator->ops.expect || !body->repeats) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(body->repeat->expected, change, body->rows.local));
  PetscCall((*body->integrator->ops.expect)(body, answer));
  body->repeat->expects = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyExpectApplied - `BodyExpectRepeat()` for the forces of the last `BodyApplyCompliance()`

  Not Collective, but all ranks that have rows of the body or parts of it have to call it

  Input Parameters:
+ body   - the `Body`, linear, whose rows answer by a massless layer alone
- change - the forces of that call, by which those on the rows change next [N]

  Level: developer

.seealso: `Body`, `BodyExpectRepeat()`, `BodyApplyCompliance()`
@*/
PetscErrorCode BodyExpectApplied(Body body, Vec change)
{
  const PetscScalar *force, *answer;
  Vec                moved;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  moved = ConstrainedSolverGetProduct(body->solver);
  PetscCall(VecGetArrayRead(change, &force));
  PetscCall(VecGetArrayRead(moved, &answer));
  PetscCall(BodyExpectRepeat(body, force, answer));
  PetscCall(VecRestoreArrayRead(moved, &answer));
  PetscCall(VecRestoreArrayRead(change, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole integration has just been done */
PetscErrorCode BodyNoteInputs(Body body)
{
  PetscFunctionBegin;
  if (!body->integrator->ops.repeat || !body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body));
  body->repeat->told = body->repeat->expects = PETSC_FALSE;
  /* rows of one node that are not orthonormal are prescribed by least squares, which has no simple change */
  body->repeats = (PetscBool)(!body->rows.n_prescribed || (body->integrator->repeats_prescribed && !body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if that can be done */
PetscErrorCode BodyRepeat(Body body, PetscBool *done)
{
  struct _BodyRepeat *repeat = body->repeat;
  PetscBool           news[2], any;

  PetscFunctionBegin;
  *done = body->repeats;
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CompareInputs(body, news));
  PetscCall(TakeInputs(body));
  for (PetscInt k = 0; k < (repeat->expects ? 2 : 1); k++) {
    if (repeat->told) news[k] = (PetscBool)(repeat->news[k] != 0);
    else if (TellsOthers(body)) PetscCall(BodyAnyRank(body, &news[k]));
  }
  any          = news[0];
  repeat->told = repeat->expects = PETSC_FALSE;
  /* Without a change a state in balance stays as it is, bit for bit. Prescribed nodes with mass may yet be given another velocity and
     acceleration, which others feel through a mass matrix that is not diagonal alone. */
  if (any && !news[1]) PetscCall((*body->integrator->ops.follow)(body));
  else if (any || (body->rows.have_mass && body->mass.matrix)) {
    if (body->integrator->ops.bringchanges && !body->rows.exchange.open)
      PetscCall((*body->integrator->ops.bringchanges)(body, repeat->changes[0]));
    PetscCall((*body->integrator->ops.repeat)(body, repeat->changes[0], repeat->changes[1]));
  } else if (body->rows.have_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, 1, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, 1, body->state.a));
  }
  PetscCall(BodyWriteTraces(body, body->time.substeps));
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
