/* What a body has to set against a push on its rows: the stiffness of the elements beside them; and whether a push at the end of a step
   moves them. */
#include <body/layout/bodyimpl.h>

/*@
  BodyComputeRowStiffness - stiffness of the elements beside each row: force along it for a unit displacement of its nodes alone

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. stiffness - diagonal of B K B^T [N/m], one for each row of this rank; E A / h for the end of a bar with elements of length h, 0 on
              rows of other bodies

  Level: developer

.seealso: `Body`, `BodyGetImpedance()`, `BodySetRobin()`
@*/
PetscErrorCode BodyComputeRowStiffness(Body body, PetscReal stiffness[])
{
  const BodyRows *rows = &body->rows;
  Mat             K, forces;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (!rows->global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStiffness(body, &K));
  PetscCall(MatMatMult(body->rows.matrix, K, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &forces));
  for (PetscInt i = 0; i < rows->local; i++) {
    const PetscInt    *of_forces, *of_row;
    const PetscScalar *force, *row;
    PetscInt           n_forces, n_row;

    stiffness[i] = 0;
    PetscCall(MatGetRow(body->rows.matrix, rows->begin + i, &n_row, &of_row, &row));
    PetscCall(MatGetRow(forces, rows->begin + i, &n_forces, &of_forces, &force));
    for (PetscInt k = 0, l = 0; k < n_row; k++) {
      while (l < n_forces && of_forces[l] < of_row[k]) l++;
      if (l < n_forces && of_forces[l] == of_row[k]) stiffness[i] += PetscRealPart(force[l] * row[k]);
    }
    PetscCall(MatRestoreRow(forces, rows->begin + i, &n_forces, &of_forces, &force));
    PetscCall(MatRestoreRow(body->rows.matrix, rows->begin + i, &n_row, &of_row, &row));
  }
  PetscCall(MatDestroy(&forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyFeelsEndForce - whether displacements at the end of the controller step answer to the contact forces there

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. feels - false for explicit bodies with mass on their contact nodes and one substep to a controller step, where the force at its end goes
          into the acceleration alone

  Level: developer

.seealso: `Body`, `BodyIntegrate()`
@*/
PetscErrorCode BodyFeelsEndForce(Body body, PetscBool *feels)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(feels, 2);
  *feels = body->integrator->feels_end_force;
  PetscFunctionReturn(PETSC_SUCCESS);
}
