/* What a body has to set against a push on its rows: the stiffness of the elements beside them, and how its steps answer. */
#include <body/layout/bodyimpl.h>

/* Diagonal of B K B^T for the rows of this rank [N/m]: the force along a row by a unit displacement of its nodes; else 0. Collective. */
PetscErrorCode BodyComputeRowStiffness(Body body, PetscReal stiffness[])
{
  const BodyRows    *rows = &body->rows;
  Mat                K, forces, answers;
  Vec                diagonal;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (!rows->global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStiffness(body, &K));
  PetscCall(MatMatMult(rows->matrix, K, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &forces));
  PetscCall(MatMatTransposeMult(forces, rows->matrix, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &answers));
  PetscCall(MatCreateVecs(answers, NULL, &diagonal));
  PetscCall(MatGetDiagonal(answers, diagonal));
  PetscCall(VecGetArrayRead(diagonal, &values));
  for (PetscInt i = 0; i < rows->local; i++) stiffness[i] = PetscRealPart(values[i]);
  PetscCall(VecRestoreArrayRead(diagonal, &values));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(MatDestroy(&answers));
  PetscCall(MatDestroy(&forces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How the steps of a body answer to contact. Of a local body ranks do not wait for each other in BodyTryIntegrateRows() and
   BodyCompleteStep() unless rows are prescribed, and the rank of BodyGetMeshRank() alone has the reason of a failure. */
PetscErrorCode BodyGetStepProperties(Body body, BodyStepProperties *properties)
{
  const BodyRows *rows  = &body->rows;
  const PetscBool plain = (PetscBool)(!rows->n_robin && !rows->n_prescribed);

  PetscFunctionBegin;
  properties->local   = body->local;
  properties->free    = (PetscBool)(plain && !rows->n_forced);
  properties->forced  = (PetscBool)(plain && rows->n_forced == rows->global);
  properties->affine  = (PetscBool)(body->model.linear && body->integrator->affine);
  properties->by_mean = rows->by_mean;
  properties->failure = &body->failure;
  PetscFunctionReturn(PETSC_SUCCESS);
}
