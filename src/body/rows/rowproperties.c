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
  PetscCall(MatMatMult(body->interface, K, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &forces));
  for (PetscInt i = 0; i < rows->local; i++) {
    const PetscInt    *of_forces, *of_row;
    const PetscScalar *force, *row;
    PetscInt           n_forces, n_row;

    stiffness[i] = 0;
    PetscCall(MatGetRow(body->interface, rows->begin + i, &n_row, &of_row, &row));
    PetscCall(MatGetRow(forces, rows->begin + i, &n_forces, &of_forces, &force));
    for (PetscInt k = 0, l = 0; k < n_row; k++) {
      while (l < n_forces && of_forces[l] < of_row[k]) l++;
      if (l < n_forces && of_forces[l] == of_row[k]) stiffness[i] += PetscRealPart(force[l] * row[k]);
    }
    PetscCall(MatRestoreRow(forces, rows->begin + i, &n_forces, &of_forces, &force));
    PetscCall(MatRestoreRow(body->interface, rows->begin + i, &n_row, &of_row, &row));
  }
  PetscCall(MatDestroy(&forces));
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
  *cross_section = body->element->cross_section;
  PetscFunctionReturn(PETSC_SUCCESS);
}
