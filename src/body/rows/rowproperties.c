/* What a body has to set against a push on its rows: stiffness and wave impedance. */
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

    PetscCall(VecZeroEntries(body->row_vec[0]));
    if (local >= 0 && local < rows->local) PetscCall(VecSetValue(body->row_vec[0], j, 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(body->row_vec[0]));
    PetscCall(VecAssemblyEnd(body->row_vec[0]));
    PetscCall(MatMultTranspose(body->interface, body->row_vec[0], body->work[0]));
    PetscCall(MatMult(K, body->work[0], body->work[2]));
    PetscCall(MatMult(body->interface, body->work[2], body->row_vec[0]));
    PetscCall(VecGetArrayRead(body->row_vec[0], &row));
    if (local >= 0 && local < rows->local) stiffness[local] = PetscRealPart(row[local]);
    PetscCall(VecRestoreArrayRead(body->row_vec[0], &row));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetImpedance - force for a unit velocity of a plane wave, for each unit of area

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. impedance - sqrt(M rho), M being the modulus of plane waves, lambda + 2 mu [N s/m^3]; of a bar, sqrt(E rho) times its cross-section [N
s/m]

  Level: intermediate

.seealso: `Body`, `BodyComputeRowStiffness()`, `MaterialGetUniaxialModulus()`
@*/
PetscErrorCode BodyGetImpedance(Body body, PetscReal *impedance)
{
  PetscReal density, modulus;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(impedance, 2);
  PetscCall(MaterialGetDensity(body->material, &density));
  if (body->dim == 1) PetscCall(MaterialGetUniaxialModulus(body->material, &modulus));
  else PetscCall(MaterialGetWaveModulus(body->material, &modulus));
  *impedance = PetscSqrtReal(modulus * density) * body->element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetCrossSection - what lengths and points of the mesh are multiplied by to give areas

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetFromOptions()`

  Output Parameter:
. cross_section - of bars [m^2]; thickness of plane bodies [m]; 1 in three dimensions

  Level: intermediate

.seealso: `Body`, `BodyGetImpedance()`
@*/
PetscErrorCode BodyGetCrossSection(Body body, PetscReal *cross_section)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(cross_section, 2);
  *cross_section = body->element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}
