/*
   Ranks that have rows of a body, and the rank that has the body, tell each other what they need of each other before and after its step,
   in place of within it.

   A body that steps alone (BodyStepsAlone()) on one of several ranks feels forces on rows that others may have, and has displacements that
   these ask for. Within the step, these would wait until it is done, and bodies on different ranks would be integrated one after the other.
   So the forces of all bodies are brought first, B^T f; then each rank makes the steps of its bodies; and then their traces are written.
*/
#include <body/layout/bodyimpl.h>

/* Whether a step needs only the forces at its end, which are known before it. Inside of a step with substeps it needs both. What goes over
   from other rows has gone by the end (handover.c). */
static PetscBool Exchanges(Body body)
{
  return (PetscBool)(BodyStepsAlone(body) && !body->rows.at_home && body->rows.global && body->time.substeps == 1 &&
                     body->integrator->affine);
}

/* B^T f of forces at the end of the controller step */
static PetscErrorCode BringForces(Body body)
{
  BodyExchange *exchange = &body->rows.exchange;
  PetscScalar  *row, *force;

  PetscFunctionBegin;
  if (!body->rows.n_forced) PetscFunctionReturn(PETSC_SUCCESS);
  if (!exchange->force) PetscCall(BodyCreateVec(body, &exchange->force));
  PetscCall(TraceGetLevel(body->traces.force_in, 1, &force));
  PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
  for (PetscInt i = 0; i < body->rows.local; i++) row[i] = body->rows.conditions[i] == BODY_FORCED ? force[i] : 0;
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
  PetscCall(MatMultTranspose(body->rows.matrix, body->work.rows[0], exchange->force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyBeginExchange - brings the forces on the rows of a body to the rank that has the body, before its step

  Collective

  Input Parameters:
+ body      - the `Body`, with its input traces
- completes - whether `BodyCompleteStep()` is next, and not `BodyTryIntegrateRows()`

  Level: developer

  Note:
  Until `BodyEndExchange()`, which has to follow, input traces and conditions must stay as they are, and output traces mean nothing. For
  bodies that need no exchange, or cannot do with one, both do nothing.

.seealso: `Body`, `BodyEndExchange()`, `BodyTryIntegrateRows()`, `BodyCompleteStep()`, `BodyIsLocal()`
@*/
PetscErrorCode BodyBeginExchange(Body body, PetscBool completes)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!Exchanges(body) || (completes && !body->state.incomplete)) PetscFunctionReturn(PETSC_SUCCESS);
  body->rows.exchange.open   = PETSC_TRUE;
  body->rows.exchange.writes = PETSC_FALSE;
  if (!completes && body->repeats && body->integrator->ops.bringchanges) PetscCall(BodyBringChanges(body));
  else PetscCall(BringForces(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyEndExchange - writes the output traces of a body, after its step

  Collective

  Input Parameter:
. body - the `Body`, after `BodyBeginExchange()`

  Level: developer

.seealso: `Body`, `BodyBeginExchange()`
@*/
PetscErrorCode BodyEndExchange(Body body)
{
  BodyExchange *exchange = &body->rows.exchange;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!exchange->open) PetscFunctionReturn(PETSC_SUCCESS);
  exchange->open = PETSC_FALSE;
  if (exchange->writes) PetscCall(BodyWriteTraces(body, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}
