/* New entries for rows of the interface, as contact surfaces slide and turn in the course of a run. */
#include <body/layout/bodyimpl.h>

/* all: for each row of all ranks 1 if it has changed, else 0 */
static PetscErrorCode GatherChanged(Body body, const PetscBool changed[], PetscMPIInt all[])
{
  const BodyRows *rows = &body->rows;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(all, rows->global));
  for (PetscInt i = 0; i < rows->local; i++) all[rows->begin + i] = changed[i] ? 1 : 0;
  if (rows->size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, (PetscMPIInt)rows->global, MPI_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The output traces at the start of the controller step: the new rows of the saved state */
static PetscErrorCode RewriteStart(Body body)
{
  const Vec   vecs[]   = {body->saved.u, body->saved.v, body->saved.a};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration};

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 3; t++) PetscCall(BodyWriteTrace(body, body->rows.matrix, vecs[t], traces[t], 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New rows, with what has changed in those of all ranks */
static PetscErrorCode TakeRows(Body body, Mat B, const PetscMPIInt all[])
{
  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&body->rows.matrix));
  body->rows.matrix = B;
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(BodyForgetCompliance(body, all));
  PetscCall((*body->integrator->ops.setrows)(body, all));
  PetscCall(BodySetRowsOfLevels(body, all));
  PetscCall(BodyNoteKnownRows(body));
  if (body->mass.solver) PetscCall(ConstrainedSolverSetRows(body->mass.solver, body->rows.free_matrix, all));
  body->repeats = PETSC_FALSE;
  PetscCall(BodySetConstraints(body));
  PetscCall(RewriteStart(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyUpdateInterface - gives the rows of the interface new entries, as contact surfaces slide and turn

  Collective

  Input Parameters:
+ body    - the `Body`, set up, at the start of a controller step
. B       - matrix of as many rows as before
- changed - for each row of this rank, whether its entries differ from those before

  Level: developer

  Note:
  No matrix of the body is factored again, and nothing is allocated where the rows have entries where they had them before. Columns of the
compliance that belong to rows which have changed are discarded.

.seealso: `Body`, `BodySetInterface()`
@*/
PetscErrorCode BodyUpdateInterface(Body body, Mat B, const PetscBool changed[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(GatherChanged(body, changed, body->rows.changed));
  PetscCall(TakeRows(body, B, body->rows.changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyUpdateInterfaceFrom - as `BodyUpdateInterface()`, for callers who have told all ranks which rows of many bodies have changed

  Collective

  Input Parameters:
+ body    - the `Body`, set up, at the start of a controller step
. B       - matrix of as many rows as before
. numbers - for each row of the body, of all ranks, its number in the list of the caller
- changed - for each row of that list, of all ranks, 1 if its entries differ from those before, else 0; the same on every rank

  Level: developer

.seealso: `Body`, `BodyUpdateInterface()`
@*/
PetscErrorCode BodyUpdateInterfaceFrom(Body body, Mat B, const PetscInt numbers[], const int changed[])
{
  PetscMPIInt *all = body->rows.changed;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  for (PetscInt k = 0; k < body->rows.global; k++) all[k] = changed[numbers[k]];
  PetscCall(TakeRows(body, B, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
