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

static PetscErrorCode ReadTable(Material material)
{
  Plastic  *plastic = GetPlastic(material);
  PetscReal numbers[2 * MAX_TABLE], strain[MAX_TABLE], stress[MAX_TABLE];
  PetscInt  n = 2 * MAX_TABLE;
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(
      PetscOptionsGetRealArray(((PetscObject)material)->options, ((PetscObject)material)->prefix, "-hardening_table", numbers, &n, &set));
  if (!set && plastic->n_table) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(set && n % 2 == 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%shardening_table has %" PetscInt_FMT
             " numbers; give pairs of plastic strain and strength [Pa], for example 0,400e6,0.1,450e6,1,500e6",
             GetPrefix(material), set ? n : 0);
  for (PetscInt i = 0; i < n / 2; i++) {
    strain[i] = numbers[2 * i];
    stress[i] = numbers[2 * i + 1];
  }
  PetscCall(CheckTable(material, n / 2, strain, stress));
  PetscCall(PetscFree2(plastic->strain, plastic->stress));
  PetscCall(PetscMalloc2(n / 2, &plastic->strain, n / 2, &plastic->stress));
  PetscCall(PetscArraycpy(plastic->strain, strain, n / 2));
  PetscCall(PetscArraycpy(plastic->stress, stress, n / 2));
  plastic->n_table = n / 2;
  plastic->yield   = stress[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error unless a constant is positive, or, where it `may_vanish`, not negative */
static PetscErrorCode CheckConstant(Material material, const char option[], PetscReal value, PetscBool may_vanish, const char unit[])
{
  PetscFunctionBegin;
  PetscCheck((value > 0 || (may_vanish && value == 0)) && isfinite(value), PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%s%s is %g%s; it must %s", GetPrefix(material), option, (double)value, unit, may_vanish ? "not be negative" : "be positive");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadHardening(Material material)
{
  Plastic    *p      = GetPlastic(material);
  PetscEnum   law    = (PetscEnum)p->hardening;
  const char *setter = "MaterialSetFromOptions", *unit = UnitsOf((PetscObject)material, UNIT_STRESS);

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsEnum("-hardening", "How strength grows with plastic strain", setter, laws, law, &law, NULL));
  PetscCall(PetscOptionsReal("-kinematic_modulus", "Modulus of kinematic hardening [Pa]", setter, p->kinematic, &p->kinematic, NULL));
  p->hardening = (Hardening)law;
  if (p->hardening == HARDENING_VOCE) {
    PetscCall(
        PetscOptionsReal("-saturation_stress", "Strength that Voce's law tends to [Pa]", setter, p->saturation, &p->saturation, NULL));
    PetscCall(PetscOptionsReal("-saturation_rate", "How fast it does", setter, p->saturate_at, &p->saturate_at, NULL));
  }
  PetscOptionsEnd();
  PetscCall(CheckConstant(material, "kinematic_modulus", p->kinematic, PETSC_TRUE, unit));
  if (p->hardening == HARDENING_VOCE) {
    PetscCall(CheckConstant(material, "saturation_stress", p->saturation, PETSC_FALSE, unit));
    PetscCall(CheckConstant(material, "saturation_rate", p->saturate_at, PETSC_FALSE, ""));
  }
  if (p->hardening == HARDENING_TABLE) PetscCall(ReadTable(material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadJohnsonCook(Material material)
{
  Plastic    *p      = GetPlastic(material);
  MPI_Comm    comm   = PetscObjectComm((PetscObject)material);
  const char *setter = "MaterialSetFromOptions", *prefix = GetPrefix(material);

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-hardening_exponent", "n of Johnson and Cook", setter, p->exponent, &p->exponent, NULL));
  PetscCall(PetscOptionsReal("-rate_coefficient", "C of Johnson and Cook", setter, p->rate, &p->rate, NULL));
  PetscCall(PetscOptionsReal("-reference_rate", "Plastic strain rate below which strength does not depend on it [1/s]", setter,
                             p->reference_rate, &p->reference_rate, NULL));
  PetscCall(PetscOptionsReal("-softening_exponent", "m of Johnson and Cook", setter, p->softening, &p->softening, NULL));
  PetscCall(PetscOptionsReal("-initial_temperature", "Temperature at the start [K]", setter, p->initial, &p->initial, NULL));
  PetscCall(PetscOptionsReal("-room_temperature", "Temperature of the strength as given [K]", setter, p->room, &p->room, NULL));
  PetscCall(PetscOptionsReal("-melting_temperature", "Temperature without strength [K]", setter, p->melting, &p->melting, NULL));
  PetscCall(PetscOptionsReal("-heat_fraction", "Of plastic work that becomes heat", setter, p->heat_fraction, &p->heat_fraction, NULL));
  PetscCall(PetscOptionsReal("-specific_heat", "Specific heat [J/(kg K)]", setter, p->specific_heat, &p->specific_heat, NULL));
  PetscOptionsEnd();
  PetscCall(CheckConstant(material, "hardening_exponent", p->exponent, PETSC_FALSE, ""));
  PetscCall(CheckConstant(material, "rate_coefficient", p->rate, PETSC_TRUE, ""));
  PetscCall(CheckConstant(material, "reference_rate", p->reference_rate, PETSC_FALSE, " 1/s"));
  PetscCall(CheckConstant(material, "softening_exponent", p->softening, PETSC_FALSE, ""));
  PetscCheck(p->melting > p->room, comm, PETSC_ERR_USER_INPUT, "-%smelting_temperature %g K must be above -%sroom_temperature %g K", prefix,
             (double)p->melting, prefix, (double)p->room);
  PetscCheck(p->initial >= 0 && p->initial < p->melting, comm, PETSC_ERR_USER_INPUT,
             "-%sinitial_temperature is %g K; it must not be negative, and lie below -%smelting_temperature %g K", prefix,
             (double)p->initial, prefix, (double)p->melting);
  PetscCheck(p->heat_fraction >= 0 && p->heat_fraction <= 1, comm, PETSC_ERR_USER_INPUT,
             "-%sheat_fraction is %g; it must lie between 0 and 1", prefix, (double)p->heat_fraction);
  PetscCall(CheckConstant(material, "specific_heat", p->specific_heat, PETSC_FALSE, UnitsOf((PetscObject)material, UNIT_SPECIFIC_HEAT)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions(Material material)
{
  Plastic    *p    = GetPlastic(material);
  const char *unit = UnitsOf((PetscObject)material, UNIT_STRESS), *setter = "MaterialSetFromOptions";

  PetscFunctionBegin;
  PetscCall(MaterialSetFromOptions_Isotropic(material));
  PetscObjectOptionsBegin((PetscObject)material);
  PetscCall(PetscOptionsReal("-yield_stress", "Strength of the virgin material [Pa]", setter, p->yield, &p->yield, NULL));
  PetscCall(PetscOptionsReal("-hardening_modulus", "Its growth per plastic strain [Pa]", setter, p->modulus, &p->modulus, NULL));
  PetscOptionsEnd();
  PetscCall(CheckConstant(material, "hardening_modulus", p->modulus, PETSC_TRUE, unit));
  if (p->hardening == HARDENING_JOHNSON_COOK) PetscCall(ReadJohnsonCook(material));
  else PetscCall(ReadHardening(material));
  if (p->hardening == HARDENING_TABLE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(p->yield != 0, PetscObjectComm((PetscObject)material), PETSC_ERR_USER_INPUT,
             "-%syield_stress is missing; give the strength at which the material begins to yield%s%s", GetPrefix(material),
             *unit ? " in" : "", unit);
  PetscCall(CheckConstant(material, "yield_stress", p->yield, PETSC_FALSE, unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Material material)
{
  Plastic *plastic = GetPlastic(material);
  MPI_Comm comm    = PetscObjectComm((PetscObject)material);

  PetscFunctionBegin;
  PetscCall(MaterialSetUp_Isotropic(material));
  PetscCheck(plastic->yield > 0, comm, PETSC_ERR_ARG_WRONGSTATE,
             "The material of type %s has no yield stress: call MaterialSetFromOptions()", ((PetscObject)material)->type_name);
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
  PetscCall(MaterialView_Isotropic(material, viewer));
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

static PetscErrorCode Destroy(Material material)
{
  Plastic *plastic = GetPlastic(material);

  PetscFunctionBegin;
  PetscCall(PetscFree2(plastic->strain, plastic->stress));
  PetscCall(MaterialDestroy_Isotropic(material));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constants of an isotropic elastic material, with those of plasticity behind them */
static PetscErrorCode Create(Material material, Hardening hardening, PetscErrorCode (*kernels)(Material, PetscBool, MaterialKernels *))
{
  Plastic *plastic;

  PetscFunctionBegin;
  PetscCall(MaterialCreate_Isotropic(material));
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
  material->ops->kernels        = kernels;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_J2(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_LINEAR, PlasticKernels_Finite));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_J2Small(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_LINEAR, PlasticKernels_Small));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MaterialCreate_JohnsonCook(Material material)
{
  PetscFunctionBegin;
  PetscCall(Create(material, HARDENING_JOHNSON_COOK, PlasticKernels_Finite));
  PetscFunctionReturn(PETSC_SUCCESS);
}
