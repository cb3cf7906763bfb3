/*
   Sweeps of one controller step integrate a body again and again from one state, with other inputs at its rows. Where it makes one substep,
   its integrator may find what a change of the inputs changes at the end of the step without another whole step.
*/
#include <body/layout/bodyimpl.h>

struct _BodyRepeat {
  PetscScalar *inputs[2], *changes[2]; /* of this rank's rows, at the end of the controller step: force [N], displacement [m] */
  PetscBool    told;                   /* ranks have told each other whether inputs have changed */
  PetscScalar  changed;                /* then, the number of ranks on which they have */
};

PetscErrorCode BodyDestroyRepeat(Body body)
{
  PetscFunctionBegin;
  if (!body->repeat) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscFree2(body->repeat->inputs[k], body->repeat->changes[k]));
  PetscCall(PetscFree(body->repeat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the integrator and the rows */
PetscErrorCode BodySetUpRepeat(Body body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->repeat));
  for (PetscInt k = 0; k < 2; k++)
    PetscCall(PetscCalloc2(body->rows.local, &body->repeat->inputs[k], body->rows.local, &body->repeat->changes[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row takes in a force (0) or a displacement (1) */
static PetscBool Counts(Body body, PetscInt input, PetscInt row)
{
  const BodyCondition condition = body->rows.conditions[row];

  return (PetscBool)(input ? condition == BODY_PRESCRIBED : condition == BODY_FORCED || condition == BODY_ROBIN);
}

/* What comes in at the end of the controller step is the present state's from now on; `changes`: by how much that is more than before, on
   the rows that it counts for */
static PetscErrorCode TakeInputs(Body body, PetscBool *any)
{
  const Trace         traces[] = {body->traces.force_in, body->traces.displacement_in};
  struct _BodyRepeat *repeat   = body->repeat;

  PetscFunctionBegin;
  *any = PETSC_FALSE;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(traces[k], body->time.substeps, &values));
    for (PetscInt i = 0; i < body->rows.local; i++) {
      repeat->changes[k][i] = Counts(body, k, i) ? values[i] - repeat->inputs[k][i] : 0;
      repeat->inputs[k][i]  = values[i];
      if (repeat->changes[k][i] != 0) *any = PETSC_TRUE;
    }
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

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(word, 2);
  word->n = 0;
  if (!body->repeats || !TellsOthers(body)) PetscFunctionReturn(PETSC_SUCCESS);
  repeat->told    = PETSC_TRUE;
  repeat->changed = 0;
  for (PetscInt k = 0; k < 2; k++) {
    PetscScalar *values;

    PetscCall(TraceGetLevel(k ? body->traces.displacement_in : body->traces.force_in, body->time.substeps, &values));
    for (PetscInt i = 0; i < body->rows.local; i++)
      if (Counts(body, k, i) && values[i] - repeat->inputs[k][i] != 0) repeat->changed = 1;
  }
  word->n      = 1;
  word->values = &repeat->changed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole integration has just been done */
PetscErrorCode BodyNoteInputs(Body body)
{
  PetscBool any;

  PetscFunctionBegin;
  if (!body->integrator->ops.repeat || !body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body, &any));
  body->repeat->told = PETSC_FALSE;
  /* rows of one node that are not orthonormal are prescribed by least squares, which has no simple change */
  body->repeats = (PetscBool)(!body->rows.n_prescribed || (body->integrator->repeats_prescribed && !body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if that can be done */
PetscErrorCode BodyRepeat(Body body, PetscBool *done)
{
  PetscBool any;

  PetscFunctionBegin;
  *done = body->repeats;
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body, &any));
  if (body->repeat->told) any = (PetscBool)(body->repeat->changed != 0);
  else if (TellsOthers(body)) PetscCall(BodyAnyRank(body, &any));
  body->repeat->told = PETSC_FALSE;
  /* Without a change the state stays as it is, bit for bit. Prescribed nodes with mass may yet be given another velocity and acceleration,
     which others feel through a mass matrix that is not diagonal alone. */
  if (any || (body->rows.have_mass && body->mass.matrix))
    PetscCall((*body->integrator->ops.repeat)(body, body->repeat->changes[0], body->repeat->changes[1]));
  else if (body->rows.have_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, 1, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, 1, body->state.a));
  }
  PetscCall(BodyWriteTraces(body, body->time.substeps));
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
