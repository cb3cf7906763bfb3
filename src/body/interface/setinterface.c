/* New entries for rows of the interface, as contact surfaces slide and turn in the course of a run. */
#include <body/layout/bodyimpl.h>

/*@
  BodyWriteStartTraces - the output traces of all rows at the start of the controller step, from the state there

  Collective

  Input Parameter:
. body - the `Body`, set up, saved

  Level: developer

.seealso: `Body`, `BodySetNearRows()`, `BodyGetTraces()`
@*/
PetscErrorCode BodyWriteStartTraces(Body body)
{
  const Vec   vecs[]   = {body->saved.u, body->saved.v, body->saved.a};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  for (PetscInt t = 0; t < 3; t++) PetscCall(BodyWriteTrace(body, body->rows.matrix, vecs[t], traces[t], 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyUpdateInterface - gives the rows of a body new entries, by callers who have told all ranks which rows of many bodies have changed

  Collective

  Input Parameters:
+ body    - the `Body`, set up, at the start of a controller step
. B       - matrix of as many rows as before
. numbers - for each row of the body, of all ranks, its number in the list of the caller
- changed - for each row of that list, of all ranks, 1 if its entries differ from those before, else 0; the same on every rank

  Level: developer

.seealso: `Body`, `BodySetInterface()`
@*/
PetscErrorCode BodyUpdateInterface(Body body, Mat B, const PetscInt numbers[], const int changed[])
{
  PetscMPIInt *all = body->rows.changed;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  for (PetscInt k = 0; k < body->rows.global; k++) all[k] = changed[numbers[k]];
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&body->rows.matrix));
  body->rows.matrix = B;
  PetscCall(BodySetNearRows(body, -1, NULL));
  PetscCall(BodySetUpFreeRows(body));
  if (body->integrator->ops.setrows) PetscCall((*body->integrator->ops.setrows)(body, all));
  PetscCall(BodySetRowsOfLevels(body, all));
  if (body->mass.solver) PetscCall(ConstrainedSolverSetRows(body->mass.solver, body->rows.free_matrix, all));
  body->repeats = PETSC_FALSE;
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyWriteStartTraces(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
