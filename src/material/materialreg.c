/* The registry of constitutive models, and the package of the class. */
#include <impakt/private/materialimpl.h>
#include <sys/package.h>

PetscClassId MATERIAL_CLASSID = 0;

PetscFunctionList MaterialList = NULL;

/*@C
  MaterialRegister - adds a constitutive model to the registry

  Not Collective

  Input Parameters:
+ name   - its name for `-<body>_material_type`
- create - function that sets up the type-specific part of a `Material`

  Level: developer

  Note:
  What the function has to fill in is in `<impakt/private/materialimpl.h>`; src/material/tutorials has an example.

.seealso: `Material`, `MaterialSetType()`, `ElementRegister()`
@*/
PetscErrorCode MaterialRegister(const char name[], PetscErrorCode (*create)(Material))
{
  PetscFunctionBegin;
  PetscAssertPointer(name, 1);
  PetscCall(MaterialInitializePackage());
  PetscCall(PetscFunctionListAdd(&MaterialList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(MaterialRegister(MATERIAL_LINEAR_ELASTIC, MaterialCreate_LinearElastic));
  PetscCall(MaterialRegister(MATERIAL_SAINT_VENANT_KIRCHHOFF, MaterialCreate_SaintVenantKirchhoff));
  PetscCall(MaterialRegister(MATERIAL_NEO_HOOKEAN, MaterialCreate_NeoHookean));
  PetscCall(MaterialRegister(MATERIAL_MOONEY_RIVLIN, MaterialCreate_MooneyRivlin));
  PetscCall(MaterialRegister(MATERIAL_J2, MaterialCreate_J2));
  PetscCall(MaterialRegister(MATERIAL_J2_SMALL, MaterialCreate_J2Small));
  PetscCall(MaterialRegister(MATERIAL_JOHNSON_COOK, MaterialCreate_JohnsonCook));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Empty(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&MaterialList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Material", &MATERIAL_CLASSID, RegisterAll, Empty));
  PetscFunctionReturn(PETSC_SUCCESS);
}
