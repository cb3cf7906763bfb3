/* Constants of isotropic models, by which they agree with linear elasticity at small strain. */
#include <impakt/private/isotropic.h>
#include <sys/units.h>

/* What the constants mean as Lame's; nothing as long as there is no Young's modulus */
static void FindLamesConstants(Isotropic *constants)
{
  const PetscReal E = constants->youngs_modulus, nu = constants->poissons_ratio;

  constants->lambda       = E * nu / ((1 + nu) * (1 - 2 * nu));
  constants->mu           = E / (2 * (1 + nu));
  constants->plane_lambda = E * nu / ((1 + nu) * (1 - nu));
}

/* The constants of a material, which must be of an isotropic model for the function that wants them */
static PetscErrorCode GetConstants(Material material, const char function[], Isotropic **constants)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscCheck(material->isotropic, PetscObjectComm((PetscObject)material), PETSC_ERR_SUP,
             "%s(): a material of type %s has neither Young's modulus nor Poisson's ratio", function,
             ((PetscObject)material)->type_name ? ((PetscObject)material)->type_name : "none");
  *constants = (Isotropic *)material->data;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialSetFromOptions_Isotropic(Material material)
{
  Isotropic  *constants = (Isotropic *)material->data;
  const char *prefix    = ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "";
  MPI_Comm    comm      = PetscObjectComm((PetscObject)material);
  PetscReal   E = constants->youngs_modulus, nu = constants->poissons_ratio;
  PetscBool   set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-youngs_modulus", "Young's modulus [Pa]", "MaterialSetYoungsModulus", E, &E, &set));
  PetscCall(PetscOptionsReal("-poissons_ratio", "Poisson's ratio", "MaterialSetPoissonsRatio", nu, &nu, NULL));
  PetscOptionsEnd();
  PetscCheck(set || E > 0, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is missing; give Young's modulus%s%s", prefix,
             *UnitsOf((PetscObject)material, UNIT_STRESS) ? " in" : "", UnitsOf((PetscObject)material, UNIT_STRESS));
  PetscCheck(E > 0, comm, PETSC_ERR_USER_INPUT, "-%syoungs_modulus is %g%s; it must be positive", prefix, (double)E,
             UnitsOf((PetscObject)material, UNIT_STRESS));
  PetscCheck(E >= MATERIAL_SMALLEST && E <= MATERIAL_LARGEST, comm, PETSC_ERR_USER_INPUT,
             "-%syoungs_modulus is %g%s; it must lie between %g and %g%s", prefix, (double)E, UnitsOf((PetscObject)material, UNIT_STRESS),
             MATERIAL_SMALLEST, MATERIAL_LARGEST, UnitsOf((PetscObject)material, UNIT_STRESS));
  PetscCheck(nu > -1 && nu < 0.5, comm, PETSC_ERR_USER_INPUT, "-%spoissons_ratio is %g; it must lie between -1 and 0.5", prefix,
             (double)nu);
  constants->youngs_modulus = E;
  constants->poissons_ratio = nu;
  FindLamesConstants(constants);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialSetUp_Isotropic(Material material)
{
  PetscFunctionBegin;
  PetscCheck(((const Isotropic *)material->data)->youngs_modulus > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_WRONGSTATE,
             "The material of type %s has no Young's modulus: call MaterialSetYoungsModulus() or MaterialSetFromOptions()",
             ((PetscObject)material)->type_name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialView_Isotropic(Material material, PetscViewer viewer)
{
  const Isotropic *constants = (const Isotropic *)material->data;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Young's modulus %g%s, Poisson's ratio %g\n", (double)constants->youngs_modulus,
                                   UnitsOf((PetscObject)material, UNIT_STRESS), (double)constants->poissons_ratio));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialDestroy_Isotropic(Material material)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(material->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialUniaxialModulus_Isotropic(Material material, PetscReal *modulus)
{
  PetscFunctionBegin;
  *modulus = ((const Isotropic *)material->data)->youngs_modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialWaveModulus_Isotropic(Material material, PetscBool plane_stress, PetscReal *modulus)
{
  const Isotropic *constants = (const Isotropic *)material->data;

  PetscFunctionBegin;
  *modulus = (plane_stress ? constants->plane_lambda : constants->lambda) + 2 * constants->mu;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetYoungsModulus - sets Young's modulus of an isotropic model

  Logically Collective

  Input Parameters:
+ material - the `Material`, of a type that has it
- modulus  - at zero strain [Pa]

  Options Database Key:
. -<body>_youngs_modulus E - the modulus

  Level: beginner

.seealso: `Material`, `MaterialSetPoissonsRatio()`, `MaterialGetYoungsModulus()`, `MaterialSetType()`
@*/
PetscErrorCode MaterialSetYoungsModulus(Material material, PetscReal modulus)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(GetConstants(material, PETSC_FUNCTION_NAME, &constants));
  PetscValidLogicalCollectiveReal(material, modulus, 2);
  PetscCheck(modulus > 0, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_OUTOFRANGE, "Young's modulus is %g%s; it must be positive",
             (double)modulus, UnitsOf((PetscObject)material, UNIT_STRESS));
  constants->youngs_modulus = modulus;
  FindLamesConstants(constants);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialGetYoungsModulus - Young's modulus of an isotropic model

  Not Collective

  Input Parameter:
. material - the `Material`, of a type that has it

  Output Parameter:
. modulus - at zero strain [Pa]; 0 until it is set

  Level: beginner

.seealso: `Material`, `MaterialSetYoungsModulus()`
@*/
PetscErrorCode MaterialGetYoungsModulus(Material material, PetscReal *modulus)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(GetConstants(material, PETSC_FUNCTION_NAME, &constants));
  PetscAssertPointer(modulus, 2);
  *modulus = constants->youngs_modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetPoissonsRatio - sets Poisson's ratio of an isotropic model

  Logically Collective

  Input Parameters:
+ material - the `Material`, of a type that has it
- ratio    - at zero strain, between -1 and 0.5; 0 by default

  Options Database Key:
. -<body>_poissons_ratio nu - the ratio

  Level: beginner

.seealso: `Material`, `MaterialSetYoungsModulus()`, `MaterialGetPoissonsRatio()`, `MaterialSetType()`
@*/
PetscErrorCode MaterialSetPoissonsRatio(Material material, PetscReal ratio)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(GetConstants(material, PETSC_FUNCTION_NAME, &constants));
  PetscValidLogicalCollectiveReal(material, ratio, 2);
  PetscCheck(ratio > -1 && ratio < 0.5, PetscObjectComm((PetscObject)material), PETSC_ERR_ARG_OUTOFRANGE,
             "Poisson's ratio is %g; it must lie between -1 and 0.5", (double)ratio);
  constants->poissons_ratio = ratio;
  FindLamesConstants(constants);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialGetPoissonsRatio - Poisson's ratio of an isotropic model

  Not Collective

  Input Parameter:
. material - the `Material`, of a type that has it

  Output Parameter:
. ratio - at zero strain

  Level: beginner

.seealso: `Material`, `MaterialSetPoissonsRatio()`
@*/
PetscErrorCode MaterialGetPoissonsRatio(Material material, PetscReal *ratio)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(GetConstants(material, PETSC_FUNCTION_NAME, &constants));
  PetscAssertPointer(ratio, 2);
  *ratio = constants->poissons_ratio;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first thing that the constructor of an isotropic model does: constants with their options, moduli at zero strain */
PetscErrorCode MaterialCreate_Isotropic(Material material)
{
  Isotropic *constants;

  PetscFunctionBegin;
  PetscCall(PetscNew(&constants));
  material->data                 = constants;
  material->isotropic            = PETSC_TRUE;
  material->ops->setfromoptions  = MaterialSetFromOptions_Isotropic;
  material->ops->setup           = MaterialSetUp_Isotropic;
  material->ops->view            = MaterialView_Isotropic;
  material->ops->destroy         = MaterialDestroy_Isotropic;
  material->ops->uniaxialmodulus = MaterialUniaxialModulus_Isotropic;
  material->ops->wavemodulus     = MaterialWaveModulus_Isotropic;
  PetscFunctionReturn(PETSC_SUCCESS);
}
