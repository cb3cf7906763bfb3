/* New entries for rows of the interface, as contact surfaces slide and turn in the course of a run. */
#include <body/layout/bodyimpl.h>

/* Writes the output traces of all rows at the start of the controller step from the saved state. Collective. */
PetscErrorCode BodyWriteStartTraces(Body body)
{
  const Vec   vecs[]   = {body->saved.u, body->saved.v, body->saved.a};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration};

  PetscFunctionBegin;
  for (PetscInt t = 0; t < 3; t++) PetscCall(BodyWriteTrace(body, body->rows.matrix, vecs[t], traces[t], 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the rows of a body, as many as before, new entries at the start of a controller step. `numbers`: of each row of all ranks in the
   caller's list; `changed`: 1 for each row of that list, of all ranks, whose entries differ from those before. Collective. */
PetscErrorCode BodyUpdateInterface(Body body, Mat B, const PetscInt numbers[], const int changed[])
{
  PetscMPIInt *all = body->rows.changed;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < body->rows.global; k++) all[k] = changed[numbers[k]];
  PetscCall(PetscObjectReference((PetscObject)B));
  PetscCall(MatDestroy(&body->rows.matrix));
  body->rows.matrix = B;
  PetscCall(BodySetNearRows(body, -1, NULL));
  PetscCall(BodySetUpFreeRows(body));
  PetscCall(BodySetRowsOfLevels(body, all));
  if (body->mass.solver) PetscCall(ConstrainedSolverSetRows(body->mass.solver, body->rows.free_matrix, all));
  body->repeats = PETSC_FALSE;
  PetscCall(BodySetConstraints(body));
  PetscCall(BodyWriteStartTraces(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
