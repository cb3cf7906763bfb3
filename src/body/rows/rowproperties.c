/* What a body has to set against a push on its rows: the stiffness of the elements beside them. */
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

  Note:
  Costs two products with sparse matrices for each row of the interface.

.seealso: `Body`, `BodyGetImpedance()`, `BodySetRobin()`
@*/
PetscErrorCode BodyComputeRowStiffness(Body body, PetscReal stiffness[])
{
  const BodyRows    *rows = &body->rows;
  const PetscScalar *row;
  Mat                K;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call BodySetUp() first");
  if (!rows->global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStiffness(body, &K));
  for (PetscInt j = 0; j < rows->global; j++) {
    const PetscInt local = j - rows->begin;

    PetscCall(VecZeroEntries(body->work.rows[0]));
    if (local >= 0 && local < rows->local) PetscCall(VecSetValue(body->work.rows[0], j, 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(body->work.rows[0]));
    PetscCall(VecAssemblyEnd(body->work.rows[0]));
    PetscCall(MatMultTranspose(body->rows.matrix, body->work.rows[0], body->work.nodes[0]));
    PetscCall(MatMult(K, body->work.nodes[0], body->work.nodes[2]));
    PetscCall(MatMult(body->rows.matrix, body->work.nodes[2], body->work.rows[0]));
    PetscCall(VecGetArrayRead(body->work.rows[0], &row));
    if (local >= 0 && local < rows->local) stiffness[local] = PetscRealPart(row[local]);
    PetscCall(VecRestoreArrayRead(body->work.rows[0], &row));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
