/* The plastic models: constants with their options. */
#include <impakt/private/plastic.h>
#include <math.h>
#include <sys/units.h>

#define MAX_TABLE 256

static const char *const laws[] = {"linear", "voce", "table", "Hardening", "HARDENING_", NULL};

static Plastic *GetPlastic(Material material)
{
  return (Plastic *)material->data;
}

static const char *GetPrefix(Material material)
{
  return ((PetscObject)material)->prefix ? ((PetscObject)material)->prefix : "";
}

/* PlasticGetSize - numbers of the history of a point */
PetscInt PlasticGetSize(const Plastic *plastic)
{
  return plastic->kinematic > 0 ? PLASTIC_SIZE_CENTRED : PLASTIC_SIZE;
}

/* PlasticCompleteKernels - what the kernels of all plastic models have in common, beside the functions that the caller has put in */
PetscErrorCode PlasticCompleteKernels(Material material, PetscBool plane_stress, MaterialKernels *kernels)
{
  PetscFunctionBegin;
  PetscCheck(!plane_stress, PetscObjectComm((PetscObject)material), PETSC_ERR_SUP,
             "The material of type %s is there for solids and plane strain, not for plane stress: leave -%splane_stress out",
             ((PetscObject)material)->type_name, GetPrefix(material));
  kernels->data           = material->data;
  kernels->n_history      = PlasticGetSize((const Plastic *)material->data);
  kernels->plastic_strain = PLASTIC_STRAIN;
  kernels->plastic_work   = PLASTIC_WORK;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error unless the strains of a table begin with 0 and ascend, and the strengths are positive and do not fall */
static PetscErrorCode CheckTable(Material material, PetscInt n, const PetscReal strain[], const PetscReal stress[])
{
  MPI_Comm comm = PetscObjectComm((PetscObject)material);

  PetscFunctionBegin;
  PetscCheck(n >= 2, comm, PETSC_ERR_USER_INPUT,
             "-%shardening_table has %" PetscInt_FMT " points; it needs two or more pairs of plastic strain and strength [Pa]",
             GetPrefix(material), n);
  PetscCheck(strain[0] == 0, comm, PETSC_ERR_USER_INPUT,
             "-%shardening_table begins at a plastic strain of %g; it must begin at 0, with the strength at which the material yields",
             GetPrefix(material), (double)strain[0]);
  for (PetscInt i = 0; i < n; i++) {
    PetscCheck(stress[i] > 0 && isfinite(stress[i]), comm, PETSC_ERR_USER_INPUT,
               "-%shardening_table: strength %g%s of point %" PetscInt_FMT " must be positive", GetPrefix(material), (double)stress[i],
               UnitsOf((PetscObject)material, UNIT_STRESS), i);
    if (!i) continue;
    PetscCheck(strain[i] > strain[i - 1] && isfinite(strain[i]), comm, PETSC_ERR_USER_INPUT,
               "-%shardening_table: plastic strain %g of point %" PetscInt_FMT " comes after %g; plastic strains must ascend",
               GetPrefix(material), (double)strain[i], i, (double)strain[i - 1]);
    PetscCheck(stress[i] >= stress[i - 1], comm, PETSC_ERR_USER_INPUT,
               "-%shardening_table: strength falls from %g to %g%s at point %" PetscInt_FMT
               "; a material that softens has no solution that "
               "the mesh does not decide",
               GetPrefix(material), (double)stress[i - 1], (double)stress[i], UnitsOf((PetscObject)material, UNIT_STRESS), i);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetHardeningTable_Plastic(Material material, PetscInt n, const PetscReal strain[], const PetscReal stress[])
{
  Plastic *plastic = GetPlastic(material);

  PetscFunctionBegin;
  PetscCall(CheckTable(material, n, strain, stress));
  PetscCall(PetscFree2(plastic->strain, plastic->stress));
  PetscCall(PetscMalloc2(n, &plastic->strain, n, &plastic->stress));
  PetscCall(PetscArraycpy(plastic->strain, strain, n));
  PetscCall(PetscArraycpy(plastic->stress, stress, n));
  plastic->n_table   = n;
  plastic->yield     = stress[0];
  plastic->hardening = HARDENING_TABLE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetYieldStress_Plastic(Material material, PetscReal yield)
{
  PetscFunctionBegin;
  PetscCheck(yield > 0 && isfinite(yield), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%syield_stress is %g%s; it must be positive", GetPrefix(material), (double)yield,
             UnitsOf((PetscObject)material, UNIT_STRESS));
  GetPlastic(material)->yield = yield;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetHardeningModulus_Plastic(Material material, PetscReal modulus)
{
  PetscFunctionBegin;
  PetscCheck(modulus >= 0 && isfinite(modulus), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%shardening_modulus is %g%s; it must not be negative", GetPrefix(material), (double)modulus,
             UnitsOf((PetscObject)material, UNIT_STRESS));
  GetPlastic(material)->modulus = modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetKinematicModulus_Plastic(Material material, PetscReal modulus)
{
  PetscFunctionBegin;
  PetscCheck(modulus >= 0 && isfinite(modulus), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%skinematic_modulus is %g%s; it must not be negative", GetPrefix(material), (double)modulus,
             UnitsOf((PetscObject)material, UNIT_STRESS));
  GetPlastic(material)->kinematic = modulus;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetVoceHardening_Plastic(Material material, PetscReal saturation, PetscReal rate)
{
  PetscFunctionBegin;
  PetscCheck(saturation > 0 && isfinite(saturation), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%ssaturation_stress is %g%s; it must be positive, and not below -%syield_stress", GetPrefix(material), (double)saturation,
             UnitsOf((PetscObject)material, UNIT_STRESS), GetPrefix(material));
  PetscCheck(rate > 0 && isfinite(rate), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%ssaturation_rate is %g; it must be positive", GetPrefix(material), (double)rate);
  GetPlastic(material)->saturation  = saturation;
  GetPlastic(material)->saturate_at = rate;
  GetPlastic(material)->hardening   = HARDENING_VOCE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetJohnsonCook_Plastic(Material material, PetscReal exponent, PetscReal rate, PetscReal reference_rate)
{
  Plastic *plastic = GetPlastic(material);
  MPI_Comm comm    = PetscObjectComm((PetscObject)material);

  PetscFunctionBegin;
  PetscCheck(exponent > 0 && isfinite(exponent), comm, PETSC_ERR_USER_INPUT, "-%shardening_exponent is %g; it must be positive",
             GetPrefix(material), (double)exponent);
  PetscCheck(rate >= 0 && isfinite(rate), comm, PETSC_ERR_USER_INPUT, "-%srate_coefficient is %g; it must not be negative",
             GetPrefix(material), (double)rate);
  PetscCheck(reference_rate > 0 && isfinite(reference_rate), comm, PETSC_ERR_USER_INPUT, "-%sreference_rate is %g 1/s; it must be positive",
             GetPrefix(material), (double)reference_rate);
  plastic->exponent       = exponent;
  plastic->rate           = rate;
  plastic->reference_rate = reference_rate;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MaterialSetJohnsonCookHeat_Plastic(Material material, PetscReal softening, PetscReal initial, PetscReal room,
                                                         PetscReal melting, PetscReal heat_fraction, PetscReal specific_heat)
{
  Plastic *plastic = GetPlastic(material);
  MPI_Comm comm    = PetscObjectComm((PetscObject)material);

  PetscFunctionBegin;
  PetscCheck(softening > 0 && isfinite(softening), comm, PETSC_ERR_USER_INPUT, "-%ssoftening_exponent is %g; it must be positive",
             GetPrefix(material), (double)softening);
  PetscCheck(melting > room, comm, PETSC_ERR_USER_INPUT, "-%smelting_temperature %g K must be above -%sroom_temperature %g K",
             GetPrefix(material), (double)melting, GetPrefix(material), (double)room);
  PetscCheck(initial >= 0 && initial < melting, comm, PETSC_ERR_USER_INPUT,
             "-%sinitial_temperature is %g K; it must not be negative, and lie below -%smelting_temperature %g K", GetPrefix(material),
             (double)initial, GetPrefix(material), (double)melting);
  PetscCheck(heat_fraction >= 0 && heat_fraction <= 1, comm, PETSC_ERR_USER_INPUT, "-%sheat_fraction is %g; it must lie between 0 and 1",
             GetPrefix(material), (double)heat_fraction);
  PetscCheck(specific_heat > 0 && isfinite(specific_heat), comm, PETSC_ERR_USER_INPUT, "-%sspecific_heat is %g%s; it must be positive",
             GetPrefix(material), (double)specific_heat, UnitsOf((PetscObject)material, UNIT_SPECIFIC_HEAT));
  plastic->softening     = softening;
  plastic->initial       = initial;
  plastic->room          = room;
  plastic->melting       = melting;
  plastic->heat_fraction = heat_fraction;
  plastic->specific_heat = specific_heat;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTable(Material material)
{
  PetscReal numbers[2 * MAX_TABLE], strain[MAX_TABLE], stress[MAX_TABLE];
  PetscInt  n = 2 * MAX_TABLE;
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(
      PetscOptionsGetRealArray(((PetscObject)material)->options, ((PetscObject)material)->prefix, "-hardening_table", numbers, &n, &set));
  if (!set && GetPlastic(material)->n_table) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(set && n % 2 == 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%shardening_table has %" PetscInt_FMT
             " numbers; give pairs of plastic strain and strength [Pa], for example 0,400e6,0.1,450e6,1,500e6",
             GetPrefix(material), set ? n : 0);
  for (PetscInt i = 0; i < n / 2; i++) {
    strain[i] = numbers[2 * i];
    stress[i] = numbers[2 * i + 1];
  }
  PetscCall(MaterialSetHardeningTable(material, n / 2, strain, stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadHardening(Material material)
{
  Plastic  *plastic    = GetPlastic(material);
  PetscReal saturation = plastic->saturation, rate = plastic->saturate_at, kinematic = plastic->kinematic;
  PetscEnum law = (PetscEnum)plastic->hardening;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsEnum("-hardening", "How strength grows with plastic strain", "MaterialSetHardeningTable", laws, law, &law, NULL));
  PetscCall(PetscOptionsReal("-kinematic_modulus", "Modulus of kinematic hardening [Pa]", "MaterialSetKinematicModulus", kinematic,
                             &kinematic, NULL));
  if ((Hardening)law == HARDENING_VOCE) {
    PetscCall(PetscOptionsReal("-saturation_stress", "Strength that Voce's law tends to [Pa]", "MaterialSetVoceHardening", saturation,
                               &saturation, NULL));
    PetscCall(PetscOptionsReal("-saturation_rate", "How fast it does", "MaterialSetVoceHardening", rate, &rate, NULL));
  }
  PetscOptionsEnd();
  plastic->hardening = (Hardening)law;
  PetscCall(MaterialSetKinematicModulus(material, kinematic));
  if (plastic->hardening == HARDENING_VOCE) PetscCall(MaterialSetVoceHardening(material, saturation, rate));
  if (plastic->hardening == HARDENING_TABLE) PetscCall(ReadTable(material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadJohnsonCook(Material material)
{
  const Plastic *plastic  = GetPlastic(material);
  PetscReal      exponent = plastic->exponent, rate = plastic->rate, reference = plastic->reference_rate, softening = plastic->softening;
  PetscReal      initial = plastic->initial, room = plastic->room, melting = plastic->melting, fraction = plastic->heat_fraction;
  PetscReal      heat = plastic->specific_heat;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-hardening_exponent", "n of Johnson and Cook", "MaterialSetJohnsonCook", exponent, &exponent, NULL));
  PetscCall(PetscOptionsReal("-rate_coefficient", "C of Johnson and Cook", "MaterialSetJohnsonCook", rate, &rate, NULL));
  PetscCall(PetscOptionsReal("-reference_rate", "Plastic strain rate below which strength does not depend on it [1/s]",
                             "MaterialSetJohnsonCook", reference, &reference, NULL));
  PetscCall(PetscOptionsReal("-softening_exponent", "m of Johnson and Cook", "MaterialSetJohnsonCookHeat", softening, &softening, NULL));
  PetscCall(
      PetscOptionsReal("-initial_temperature", "Temperature at the start [K]", "MaterialSetJohnsonCookHeat", initial, &initial, NULL));
  PetscCall(
      PetscOptionsReal("-room_temperature", "Temperature of the strength as given [K]", "MaterialSetJohnsonCookHeat", room, &room, NULL));
  PetscCall(
      PetscOptionsReal("-melting_temperature", "Temperature without strength [K]", "MaterialSetJohnsonCookHeat", melting, &melting, NULL));
  PetscCall(
      PetscOptionsReal("-heat_fraction", "Of plastic work that becomes heat", "MaterialSetJohnsonCookHeat", fraction, &fraction, NULL));
  PetscCall(PetscOptionsReal("-specific_heat", "Specific heat [J/(kg K)]", "MaterialSetJohnsonCookHeat", heat, &heat, NULL));
  PetscOptionsEnd();
  PetscCall(MaterialSetJohnsonCook(material, exponent, rate, reference));
  PetscCall(MaterialSetJohnsonCookHeat(material, softening, initial, room, melting, fraction, heat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions(Material material)
{
  Plastic  *plastic = GetPlastic(material);
  PetscReal yield = plastic->yield, modulus = plastic->modulus;
  PetscErrorCode (*elastic)(Material);

  PetscFunctionBegin;
  PetscCall(PetscObjectQueryFunction((PetscObject)material, "MaterialSetFromOptionsElastic_C", &elastic));
  PetscCall((*elastic)(material));
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-yield_stress", "Strength of the virgin material [Pa]", "MaterialSetYieldStress", yield, &yield, NULL));
  PetscCall(
      PetscOptionsReal("-hardening_modulus", "Its growth per plastic strain [Pa]", "MaterialSetHardeningModulus", modulus, &modulus, NULL));
  PetscOptionsEnd();
  PetscCall(MaterialSetHardeningModulus(material, modulus));
  if (plastic->hardening == HARDENING_JOHNSON_COOK) PetscCall(ReadJohnsonCook(material));
  else PetscCall(ReadHardening(material));
  if (plastic->hardening == HARDENING_TABLE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(yield != 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%syield_stress is missing; give the strength at which the material begins to yield%s%s", GetPrefix(material),
             *UnitsOf((PetscObject)material, UNIT_STRESS) ? " in" : "", UnitsOf((PetscObject)material, UNIT_STRESS));
  PetscCall(MaterialSetYieldStress(material, yield));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Material material)
{
  Plastic *plastic = GetPlastic(material);
  MPI_Comm comm    = PetscObjectComm((PetscObject)material);

  PetscFunctionBegin;
  PetscCheck(plastic->elastic.youngs_modulus > 0, comm, PETSC_ERR_ARG_WRONGSTATE,
             "The material of type %s has no Young's modulus: call MaterialSetYoungsModulus() or MaterialSetFromOptions()",
             ((PetscObject)material)->type_name);
  PetscCheck(plastic->yield > 0, comm, PETSC_ERR_ARG_WRONGSTATE,
             "The material of type %s has no yield stress: call MaterialSetYieldStress() or MaterialSetFromOptions()",
             ((PetscObject)material)->type_name);
  PetscCheck(plastic->hardening != HARDENING_VOCE || plastic->saturation >= plastic->yield, comm, PETSC_ERR_USER_INPUT,
             "-%ssaturation_stress %g%s lies below -%syield_stress %g%s", GetPrefix(material), (double)plastic->saturation,
             UnitsOf((PetscObject)material, UNIT_STRESS), GetPrefix(material), (double)plastic->yield,
             UnitsOf((PetscObject)material, UNIT_STRESS));
  plastic->density = material->density;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode View(Material material, PetscViewer viewer)
{
  const Plastic *plastic = GetPlastic(material);
  const char    *unit;

  PetscFunctionBegin;
  unit = UnitsOf((PetscObject)material, UNIT_STRESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Young's modulus %g%s, Poisson's ratio %g\n", (double)plastic->elastic.youngs_modulus, unit,
                                   (double)plastic->elastic.poissons_ratio));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  yield stress %g%s, hardening %s, modulus %g%s, kinematic %g%s\n", (double)plastic->yield,
                                   unit, plastic->hardening == HARDENING_JOHNSON_COOK ? "of Johnson and Cook" : laws[plastic->hardening],
                                   (double)plastic->modulus, unit, (double)plastic->kinematic, unit));
  if (plastic->hardening == HARDENING_VOCE)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  saturation %g%s, at %g per plastic strain\n", (double)plastic->saturation, unit,
                                     (double)plastic->saturate_at));
  if (plastic->hardening == HARDENING_JOHNSON_COOK)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "  exponent %g, rate coefficient %g above %g%s, softening exponent %g from %g to %g%s\n"
                                     "  initial temperature %g%s, heat fraction %g, specific heat %g%s\n",
                                     (double)plastic->exponent, (double)plastic->rate, (double)plastic->reference_rate,
                                     UnitsOf((PetscObject)material, UNIT_RATE), (double)plastic->softening, (double)plastic->room,
                                     (double)plastic->melting, UnitsOf((PetscObject)material, UNIT_TEMPERATURE), (double)plastic->initial,
                                     UnitsOf((PetscObject)material, UNIT_TEMPERATURE), (double)plastic->heat_fraction,
                                     (double)plastic->specific_heat, UnitsOf((PetscObject)material, UNIT_SPECIFIC_HEAT)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *const setters[] = {"MaterialSetYieldStress_C",    "MaterialSetHardeningModulus_C", "MaterialSetKinematicModulus_C",
                                      "MaterialSetVoceHardening_C",  "MaterialSetHardeningTable_C",   "MaterialSetJohnsonCook_C",
                                      "MaterialSetJohnsonCookHeat_C"};

static PetscErrorCode Destroy(Material material)
{
  Plastic *plastic = GetPlastic(material);
  PetscErrorCode (*elastic)(Material);

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(setters); i++)
    PetscCall(PetscObjectComposeFunction((PetscObject)material, setters[i], NULL));
  PetscCall(PetscObjectQueryFunction((PetscObject)material, "MaterialDestroyElastic_C", &elastic));
  PetscCall(PetscObjectComposeFunction((PetscObject)material, "MaterialDestroyElastic_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)material, "MaterialSetFromOptionsElastic_C", NULL));
  PetscCall(PetscFree2(plastic->strain, plastic->stress));
  PetscCall((*elastic)(material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constants of an isotropic elastic material, with those of plasticity behind them */
static PetscErrorCode Create(Material material, Hardening hardening)
{
  Plastic    *plastic;
  PetscObject object = (PetscObject)material;

  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
  PetscCall(PetscObjectComposeFunction(object, "MaterialDestroyElastic_C", material->ops->destroy));
  PetscCall(PetscObjectComposeFunction(object, "MaterialSetFromOptionsElastic_C", material->ops->setfromoptions));
  PetscCall(PetscFree(material->data));
  PetscCall(PetscNew(&plastic));
  material->data                = plastic;
  plastic->hardening            = hardening;
  plastic->exponent             = 1;
  plastic->reference_rate       = 1;
  plastic->softening            = 1;
  plastic->room                 = 293;
  plastic->initial              = 293;
  plastic->melting              = 1e30;
  plastic->heat_fraction        = 0.9;
  plastic->specific_heat        = 400;
  material->ops->setfromoptions = SetFromOptions;
  material->ops->setup          = SetUp;
  material->ops->view           = View;
  material->ops->destroy        = Destroy;
  PetscCall(PetscObjectComposeFunction(object, setters[0], MaterialSetYieldStress_Plastic));
  PetscCall(PetscObjectComposeFunction(object, setters[1], MaterialSetHardeningModulus_Plastic));
  if (hardening == HARDENING_JOHNSON_COOK) {
    PetscCall(PetscObjectComposeFunction(object, setters[5], MaterialSetJohnsonCook_Plastic));
    PetscCall(PetscObjectComposeFunction(object, setters[6], MaterialSetJohnsonCookHeat_Plastic));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscObjectComposeFunction(object, setters[2], MaterialSetKinematicModulus_Plastic));
  PetscCall(PetscObjectComposeFunction(object, setters[3], MaterialSetVoceHardening_Plastic));
  PetscCall(PetscObjectComposeFunction(object, setters[4], MaterialSetHardeningTable_Plastic));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_J2(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_LINEAR));
  material->ops->kernels = PlasticKernels_Finite;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_J2Small(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_LINEAR));
  material->ops->kernels = PlasticKernels_Small;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_JohnsonCook(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_JOHNSON_COOK));
  material->ops->kernels = PlasticKernels_Finite;
  PetscFunctionReturn(PETSC_SUCCESS);
}
