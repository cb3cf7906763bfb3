/* What a body has to set against a push on its rows: the stiffness of the elements beside them; and whether a push at the end of a step
   moves them. */
#include <body/layout/bodyimpl.h>

/* Diagonal of B K B^T for the rows of this rank [N/m]: the force along a row for a unit displacement of its nodes alone; 0 on rows of
   other bodies. Collective. */
PetscErrorCode BodyComputeRowStiffness(Body body, PetscReal stiffness[])
{
  const BodyRows *rows = &body->rows;
  Mat             K, forces;

  PetscFunctionBegin;
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

/* Whether displacements at the end of the controller step depend on the contact forces there: not those of explicit bodies with mass on
   contact nodes and one substep */
PetscErrorCode BodyFeelsEndForce(Body body, PetscBool *feels)
{
  PetscFunctionBegin;
  *feels = body->integrator->feels_end_force;
  PetscFunctionReturn(PETSC_SUCCESS);
}
