/* Messages of a body's rows before and after its step, in place of within it. A body that steps alone (BodyStepsAlone()) on one of several
   ranks takes forces on rows of other ranks, which take its displacements. Within the step these would wait until it is done, and bodies on
   different ranks would be integrated one after the other. So the forces of all bodies are brought first, B^T f; then each rank makes the
   steps of its bodies; and then their traces are written. */
#include <body/layout/bodyimpl.h>

/* Whether a step needs only the forces at its end: one substep does. What other rows hand over has gone by then (handover.c). */
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

/* Brings the forces on the rows to the rank that has the body, before BodyTryIntegrateRows(), or BodyCompleteStep() if `completes`. Until
   BodyEndExchange() input traces and conditions stay, and output traces mean nothing. Collective. */
PetscErrorCode BodyBeginExchange(Body body, PetscBool completes)
{
  PetscFunctionBegin;
  if (!Exchanges(body) || (completes && !body->state.incomplete)) PetscFunctionReturn(PETSC_SUCCESS);
  body->rows.exchange.open   = PETSC_TRUE;
  body->rows.exchange.writes = PETSC_FALSE;
  if (!completes && body->repeats && body->integrator->repeats_by_solver) PetscCall(BodyBringChanges(body));
  else PetscCall(BringForces(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the output traces of a body after its step. Collective. */
PetscErrorCode BodyEndExchange(Body body)
{
  BodyExchange *exchange = &body->rows.exchange;

  PetscFunctionBegin;
  if (!exchange->open) PetscFunctionReturn(PETSC_SUCCESS);
  exchange->open = PETSC_FALSE;
  if (exchange->writes) PetscCall(BodyWriteTraces(body, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}
