#include <impakt/private/materialimpl.h>

PetscClassId MATERIAL_CLASSID = 0;

static PetscFunctionList MaterialList = NULL;

/*@C
  MaterialRegister - adds a constitutive model to the registry

  Not Collective

  Input Parameters:
+ name   - its name for `-<body>_material_type`
- create - function that sets up the type-specific part of a `Material`

  Level: developer

.seealso: `Material`, `MaterialSetType()`
@*/
PetscErrorCode MaterialRegister(const char name[], PetscErrorCode (*create)(Material))
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(&MaterialList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialRegisterAll - registers the class and all models that Impakt brings

  Not Collective

  Level: developer

.seealso: `MaterialRegister()`, `ImpaktInitialize()`
@*/
PetscErrorCode MaterialRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(PetscClassIdRegister("Material", &MATERIAL_CLASSID));
  PetscCall(MaterialRegister(MATERIAL_LINEAR_ELASTIC, MaterialCreate_LinearElastic));
  PetscCall(MaterialRegister(MATERIAL_SAINT_VENANT_KIRCHHOFF, MaterialCreate_SaintVenantKirchhoff));
  PetscCall(MaterialRegister(MATERIAL_NEO_HOOKEAN, MaterialCreate_NeoHookean));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialFinalizePackage - empties the registry

  Not Collective

  Level: developer

.seealso: `MaterialRegisterAll()`
@*/
PetscErrorCode MaterialFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&MaterialList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialCreate - creates a material without a type

  Collective

  Input Parameter:
. comm - communicator

  Output Parameter:
. material - the `Material`

  Level: developer

.seealso: `Material`, `MaterialSetType()`, `MaterialSetFromOptions()`
@*/
PetscErrorCode MaterialCreate(MPI_Comm comm, Material *material)
{
  PetscFunctionBegin;
  PetscCall(
      PetscHeaderCreate(*material, MATERIAL_CLASSID, "Material", "Constitutive model", "Material", comm, MaterialDestroy, MaterialView));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetOptionsPrefix - sets the prefix of the material's options

  Logically Collective

  Input Parameters:
+ material - the `Material`
- prefix   - the prefix, for example `left_`

  Level: developer

.seealso: `Material`
@*/
PetscErrorCode MaterialSetOptionsPrefix(Material material, const char prefix[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)material, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names in the registry, in alphabetical order */
static PetscErrorCode GetKnownTypes(size_t size, char known[])
{
  const char **names;
  PetscInt    *order;
  int          n;

  PetscFunctionBegin;
  PetscCall(PetscFunctionListGet(MaterialList, &names, &n));
  PetscCall(PetscMalloc1(n, &order));
  for (int i = 0; i < n; i++) order[i] = i;
  PetscCall(PetscSortStrWithPermutation(n, names, order));
  known[0] = '\0';
  for (int i = 0; i < n; i++) {
    if (i) PetscCall(PetscStrlcat(known, ", ", size));
    PetscCall(PetscStrlcat(known, names[order[i]], size));
  }
  PetscCall(PetscFree(order));
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetType - chooses the constitutive model

  Collective

  Input Parameters:
+ material - the `Material`
- type     - its name

  Options Database Key:
. -<body>_material_type (linear_elastic|saint_venant_kirchhoff|neo_hookean) - the constitutive model

  Level: beginner

.seealso: `Material`, `MaterialRegister()`
@*/
PetscErrorCode MaterialSetType(Material material, MaterialType type)
{
  PetscErrorCode (*create)(Material);
  PetscBool same;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscCall(PetscObjectTypeCompare((PetscObject)material, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFunctionListFind(MaterialList, type, &create));
  if (!create) {
    char known[1024];

    PetscCall(GetKnownTypes(sizeof(known), known));
    SETERRQ(PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown -%smaterial_type '%s'; known: %s",
            ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "", type, known);
  }
  PetscTryTypeMethod(material, destroy);
  PetscCall(PetscMemzero(material->ops, sizeof(*material->ops)));
  material->data   = NULL;
  material->linear = PETSC_FALSE;
  PetscCall((*create)(material));
  PetscCall(PetscObjectChangeTypeName((PetscObject)material, type));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetFromOptions - reads type and constants from the options

  Collective

  Input Parameter:
. material - the `Material`

  Options Database Keys:
+ -<body>_material_type (linear_elastic|saint_venant_kirchhoff|neo_hookean) - the constitutive model
. -<body>_density rho                                                       - mass density [kg/m^3], required
. -<body>_youngs_modulus E                                                  - of these three models, at zero strain [Pa], required
- -<body>_poissons_ratio (0)                                                - of these three models, at zero strain; between -1 and 0.5

  Level: beginner

.seealso: `Material`, `MaterialSetType()`
@*/
PetscErrorCode MaterialSetFromOptions(Material material)
{
  char        type[64] = MATERIAL_LINEAR_ELASTIC;
  const char *prefix   = ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "";
  PetscBool   set;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsFList("-material_type", "Constitutive model", "MaterialSetType", MaterialList, type, type, sizeof(type), NULL));
  PetscCall(PetscOptionsReal("-density", "Mass density [kg/m^3]", "MaterialGetDensity", material->density, &material->density, &set));
  PetscOptionsEnd();
  PetscCall(MaterialSetType(material, type));
  PetscCheck(set, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT, "-%sdensity is missing; give the mass density in kg/m^3",
             prefix);
  PetscCheck(material->density > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%sdensity is %g kg/m^3; a density must be positive", prefix, (double)material->density);
  PetscTryTypeMethod(material, setfromoptions);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialView - prints a material

  Collective

  Input Parameters:
+ material - the `Material`
- viewer   - an ASCII viewer

  Level: beginner

.seealso: `Material`
@*/
PetscErrorCode MaterialView(Material material, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscCall(PetscObjectPrintClassNamePrefixType((PetscObject)material, viewer));
  PetscCall(
      PetscViewerASCIIPrintf(viewer, "  density %g kg/m^3%s\n", (double)material->density, material->plane_stress ? ", plane stress" : ""));
  PetscTryTypeMethod(material, view, viewer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialDestroy - frees a material

  Collective

  Input Parameter:
. material - the `Material`, set to `NULL`

  Level: developer

.seealso: `Material`, `MaterialCreate()`
@*/
PetscErrorCode MaterialDestroy(Material *material)
{
  PetscFunctionBegin;
  if (!*material) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*material, MATERIAL_CLASSID, 1);
  if (--((PetscObject)*material)->refct > 0) {
    *material = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscTryTypeMethod(*material, destroy);
  PetscCall(PetscHeaderDestroy(material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialGetDensity - the mass density in the reference configuration

  Not Collective

  Input Parameter:
. material - the `Material`

  Output Parameter:
. density - [kg/m^3]

  Level: beginner

.seealso: `Material`
@*/
PetscErrorCode MaterialGetDensity(Material material, PetscReal *density)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  *density = material->density;
  PetscFunctionReturn(PETSC_SUCCESS);
}
