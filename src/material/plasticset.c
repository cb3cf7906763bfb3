/* Setters of the plastic models. */
#include <impakt/private/materialimpl.h>

/*@
  MaterialSetYieldStress - sets the strength of a plastic model before any plastic strain

  Logically Collective

  Input Parameters:
+ material - the `Material`, of a plastic type
- yield    - equivalent (von Mises) stress at which it begins to flow [Pa]

  Options Database Key:
. -<body>_yield_stress s - the strength

  Level: beginner

.seealso: `Material`, `MaterialSetHardeningModulus()`, `MaterialSetHardeningTable()`, `MaterialSetType()`
@*/
PetscErrorCode MaterialSetYieldStress(Material material, PetscReal yield)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, yield, 2);
  PetscUseMethod(material, "MaterialSetYieldStress_C", (Material, PetscReal), (material, yield));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetHardeningModulus - sets by how much the strength of a plastic model grows with the equivalent plastic strain

  Logically Collective

  Input Parameters:
+ material - the `Material`, of a plastic type
- modulus  - [Pa]; 0 by default. Of `MATERIAL_JOHNSON_COOK` the factor B of the power of the plastic strain

  Options Database Key:
. -<body>_hardening_modulus H - the modulus

  Level: beginner

.seealso: `Material`, `MaterialSetYieldStress()`, `MaterialSetKinematicModulus()`, `MaterialSetVoceHardening()`
@*/
PetscErrorCode MaterialSetHardeningModulus(Material material, PetscReal modulus)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, modulus, 2);
  PetscUseMethod(material, "MaterialSetHardeningModulus_C", (Material, PetscReal), (material, modulus));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetKinematicModulus - sets by how much the yield surface moves with plastic strain (Prager's kinematic hardening)

  Logically Collective

  Input Parameters:
+ material - the `Material`, of type `MATERIAL_J2` or `MATERIAL_J2_SMALL`
- modulus  - slope of uniaxial stress against plastic strain that this alone would make [Pa]; 0 by default

  Options Database Key:
. -<body>_kinematic_modulus K - the modulus

  Level: intermediate

.seealso: `Material`, `MaterialSetHardeningModulus()`
@*/
PetscErrorCode MaterialSetKinematicModulus(Material material, PetscReal modulus)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, modulus, 2);
  PetscUseMethod(material, "MaterialSetKinematicModulus_C", (Material, PetscReal), (material, modulus));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetVoceHardening - chooses Voce's law: strength = yield + (saturation - yield) (1 - exp(- rate strain)) + modulus strain

  Logically Collective

  Input Parameters:
+ material   - the `Material`, of type `MATERIAL_J2` or `MATERIAL_J2_SMALL`
. saturation - [Pa], not below the yield stress
- rate       - per equivalent plastic strain

  Options Database Keys:
+ -<body>_hardening voce      - choose this law
. -<body>_saturation_stress s - the strength that it tends to
- -<body>_saturation_rate d   - how fast it does

  Level: intermediate

.seealso: `Material`, `MaterialSetYieldStress()`, `MaterialSetHardeningModulus()`, `MaterialSetHardeningTable()`
@*/
PetscErrorCode MaterialSetVoceHardening(Material material, PetscReal saturation, PetscReal rate)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, saturation, 2);
  PetscValidLogicalCollectiveReal(material, rate, 3);
  PetscUseMethod(material, "MaterialSetVoceHardening_C", (Material, PetscReal, PetscReal), (material, saturation, rate));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetHardeningTable - sets the strength at some equivalent plastic strains, linear in between, constant beyond the last

  Logically Collective

  Input Parameters:
+ material - the `Material`, of type `MATERIAL_J2` or `MATERIAL_J2_SMALL`
. n        - number of points, 2 or more
. strain   - equivalent plastic strains, ascending, the first 0
- stress   - strengths, positive, not falling; the first is the yield stress [Pa]

  Options Database Keys:
+ -<body>_hardening table                  - choose this law
- -<body>_hardening_table 0,s0,e1,s1,...   - pairs of plastic strain and strength

  Level: intermediate

.seealso: `Material`, `MaterialSetYieldStress()`, `MaterialSetVoceHardening()`
@*/
PetscErrorCode MaterialSetHardeningTable(Material material, PetscInt n, const PetscReal strain[], const PetscReal stress[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveInt(material, n, 2);
  PetscUseMethod(material, "MaterialSetHardeningTable_C", (Material, PetscInt, const PetscReal[], const PetscReal[]),
                 (material, n, strain, stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetJohnsonCook - sets how strength depends on plastic strain and its rate: (A + B strain^n) (1 + C ln(rate / reference))

  Logically Collective

  Input Parameters:
+ material       - the `Material`, of type `MATERIAL_JOHNSON_COOK`; A is its yield stress, B its hardening modulus
. exponent       - n, 1 by default
. rate           - C, 0 by default
- reference_rate - [1/s], 1 by default; slower flow has the strength at this rate

  Options Database Keys:
+ -<body>_hardening_exponent n - the exponent
. -<body>_rate_coefficient C   - the factor of the rate
- -<body>_reference_rate r     - the reference

  Level: intermediate

.seealso: `Material`, `MaterialSetJohnsonCookHeat()`, `MaterialSetYieldStress()`, `MaterialSetHardeningModulus()`
@*/
PetscErrorCode MaterialSetJohnsonCook(Material material, PetscReal exponent, PetscReal rate, PetscReal reference_rate)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, exponent, 2);
  PetscValidLogicalCollectiveReal(material, rate, 3);
  PetscValidLogicalCollectiveReal(material, reference_rate, 4);
  PetscUseMethod(material, "MaterialSetJohnsonCook_C", (Material, PetscReal, PetscReal, PetscReal),
                 (material, exponent, rate, reference_rate));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  MaterialSetJohnsonCookHeat - sets how strength depends on temperature, and how plastic work heats

  Logically Collective

  Input Parameters:
+ material      - the `Material`, of type `MATERIAL_JOHNSON_COOK`
. softening     - m: strength has the factor 1 - ((T - room) / (melting - room))^m; 1 by default
. initial       - temperature at the start [K], 293 by default
. room          - up to which the factor is 1 [K], 293 by default
. melting       - from which on it is 0 [K]; by default so high that strength does not depend on temperature
. heat_fraction - of plastic work that becomes heat, 0.9 by default
- specific_heat - [J/(kg K)], 400 by default

  Options Database Keys:
+ -<body>_softening_exponent m  - the exponent
. -<body>_initial_temperature T - at the start
. -<body>_room_temperature T    - of the strength as given
. -<body>_melting_temperature T - without strength
. -<body>_heat_fraction f       - of plastic work
- -<body>_specific_heat c       - of the material

  Level: intermediate

  Note:
  No heat is conducted: impacts are too short for that.

.seealso: `Material`, `MaterialSetJohnsonCook()`
@*/
PetscErrorCode MaterialSetJohnsonCookHeat(Material material, PetscReal softening, PetscReal initial, PetscReal room, PetscReal melting,
                                          PetscReal heat_fraction, PetscReal specific_heat)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(material, MATERIAL_CLASSID, 1);
  PetscValidLogicalCollectiveReal(material, softening, 2);
  PetscValidLogicalCollectiveReal(material, initial, 3);
  PetscValidLogicalCollectiveReal(material, room, 4);
  PetscValidLogicalCollectiveReal(material, melting, 5);
  PetscValidLogicalCollectiveReal(material, heat_fraction, 6);
  PetscValidLogicalCollectiveReal(material, specific_heat, 7);
  PetscUseMethod(material, "MaterialSetJohnsonCookHeat_C", (Material, PetscReal, PetscReal, PetscReal, PetscReal, PetscReal, PetscReal),
                 (material, softening, initial, room, melting, heat_fraction, specific_heat));
  PetscFunctionReturn(PETSC_SUCCESS);
}
