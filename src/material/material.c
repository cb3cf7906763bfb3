/* The class: creation, type, options, view, destruction. */
#include <impakt/private/materialimpl.h>
#include <sys/names.h>
#include <sys/units.h>

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
  PetscAssertPointer(material, 2);
  PetscCall(MaterialInitializePackage());
  PetscCall(
      PetscHeaderCreate(*material, MATERIAL_CLASSID, "Material", "Constitutive model", "Material", comm, MaterialDestroy, MaterialView));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetType - chooses the constitutive model

  Collective

  Input Parameters:
+ material - the `Material`
- type     - its name

  Options Database Key:
. -<body>_material_type (linear_elastic|saint_venant_kirchhoff|neo_hookean|mooney_rivlin|j2|j2_small|johnson_cook) - the constitutive model

  Level: beginner

.seealso: `Material`, `MaterialRegister()`
@*/
PetscErrorCode MaterialSetType(Material material, MaterialType type)
{
  PetscErrorCode (*create)(Material);
  PetscBool same;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)material, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFunctionListFind(MaterialList, type, &create));
  if (!create) {
    char known[1024];

    PetscCall(NamesOfRegistry(MaterialList, sizeof(known), known));
    SETERRQ(PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown -%smaterial_type '%s'; known: %s",
            ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "", type, known);
  }
  PetscTryTypeMethod(material, destroy);
  PetscCall(PetscMemzero(material->ops, sizeof(*material->ops)));
  material->data   = NULL;
  material->linear = material->isotropic = PETSC_FALSE;
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
+ -<body>_material_type, -<body>_density, -<body>_youngs_modulus, -<body>_poissons_ratio - of all models, see the setters
- -<body>_yield_stress, ... - constants of single models, in options/README.md, which `impakt -help materials` prints too

  Level: beginner

  Note:
  What the program has set before need not be in the options; what is in the options takes its place.

.seealso: `Material`, `MaterialSetType()`, `MaterialSetDensity()`, `MaterialSetYoungsModulus()`, `MaterialSetPoissonsRatio()`
@*/
PetscErrorCode MaterialSetFromOptions(Material material)
{
  const char *prefix  = ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "", *chosen;
  PetscReal   density = material->density;
  char        type[64];
  PetscBool   set;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  chosen = ((PetscObject)material)->type_name;
  PetscCall(PetscStrncpy(type, chosen ? chosen : MATERIAL_LINEAR_ELASTIC, sizeof(type)));
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsFList("-material_type", "Constitutive model", "MaterialSetType", MaterialList, type, type, sizeof(type), NULL));
  PetscCall(PetscOptionsReal("-density", "Mass density [kg/m^3]", "MaterialSetDensity", density, &density, &set));
  PetscOptionsEnd();
  PetscCall(MaterialSetType(material, type));
  PetscCheck(set || density > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%sdensity is missing; give the mass density%s%s", prefix, *UnitsOf((PetscObject)material, UNIT_DENSITY) ? " in" : "",
             UnitsOf((PetscObject)material, UNIT_DENSITY));
  PetscCheck(density > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT, "-%sdensity is %g%s; a density must be positive",
             prefix, (double)density, UnitsOf((PetscObject)material, UNIT_DENSITY));
  PetscCheck(density >= MATERIAL_SMALLEST && density <= MATERIAL_LARGEST, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%sdensity is %g%s; a density must lie between %g and %g%s", prefix, (double)density,
             UnitsOf((PetscObject)material, UNIT_DENSITY), MATERIAL_SMALLEST, MATERIAL_LARGEST,
             UnitsOf((PetscObject)material, UNIT_DENSITY));
  PetscCall(MaterialSetDensity(material, density));
  PetscTryTypeMethod(material, setfromoptions);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes sure that a material has all that it needs; an error names what is missing. Logically collective. */
PetscErrorCode MaterialSetUp(Material material)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscCheck(((PetscObject)material)->type_name, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_WRONGSTATE,
             "The material has no type: call MaterialSetType() or MaterialSetFromOptions()");
  PetscCheck(material->density > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_WRONGSTATE,
             "The material of type %s has no density: call MaterialSetDensity() or MaterialSetFromOptions()",
             ((PetscObject)material)->type_name);
  PetscTryTypeMethod(material, setup);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialView - prints a material

  Collective

  Input Parameters:
+ material - the `Material`
- viewer   - an ASCII viewer, `NULL` for standard output

  Level: beginner

.seealso: `Material`
@*/
PetscErrorCode MaterialView(Material material, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)material), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectPrintClassNamePrefixType((PetscObject)material, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  density %g%s%s\n", (double)material->density, UnitsOf((PetscObject)material, UNIT_DENSITY),
                                   material->plane_stress ? ", plane stress" : ""));
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
  MaterialSetDensity - sets the mass density in the reference configuration

  Logically Collective

  Input Parameters:
+ material - the `Material`
- density  - [kg/m^3]

  Options Database Key:
. -<body>_density rho - the density

  Level: beginner

.seealso: `Material`, `MaterialGetDensity()`
@*/
PetscErrorCode MaterialSetDensity(Material material, PetscReal density)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, density, 2);
  PetscCheck(density > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_OUTOFRANGE, "A density of %g%s must be positive",
             (double)density, UnitsOf((PetscObject)material, UNIT_DENSITY));
  material->density = density;
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

.seealso: `Material`, `MaterialSetDensity()`
@*/
PetscErrorCode MaterialGetDensity(Material material, PetscReal *density)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscAssertPointer(density, 2);
  *density = material->density;
  PetscFunctionReturn(PETSC_SUCCESS);
}
