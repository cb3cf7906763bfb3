/* Constitutive models and their registry. */
#include "support.h"
#include <body/material/materialimpl.h>

static Material create(void)
{
  Material material;

  ok(MaterialCreate(PETSC_COMM_WORLD, &material));
  ok(MaterialSetOptionsPrefix(material, "bar_"));
  return material;
}

static void is_made_from_options(void **state)
{
  PetscOptions options  = options_begin("-bar_density 7850 -bar_youngs_modulus 2.1e11 -bar_poissons_ratio 0.3 -bar_material_type linear_elastic");
  Material     material = create();
  PetscReal    density, modulus;
  PetscBool    linear, same;

  (void)state;
  ok(MaterialSetFromOptions(material));
  ok(PetscObjectTypeCompare((PetscObject)material, MATERIAL_LINEAR_ELASTIC, &same));
  assert_true(same);
  ok(MaterialGetDensity(material, &density));
  ok(MaterialGetUniaxialModulus(material, &modulus));
  ok(MaterialIsLinear(material, &linear));
  assert_true(density == 7850);
  assert_true(modulus == 2.1e11);
  assert_true(linear);
  ok(MaterialDestroy(&material));
  assert_null(material);
  options_end(options);
}

/* Linear elasticity is what one gets without asking, and Poisson's ratio is 0 */
static void needs_density_and_modulus_only(void **state)
{
  PetscOptions options  = options_begin("-bar_density 2 -bar_youngs_modulus 3");
  Material     material = create();
  PetscBool    same;

  (void)state;
  ok(MaterialSetFromOptions(material));
  ok(PetscObjectTypeCompare((PetscObject)material, MATERIAL_LINEAR_ELASTIC, &same));
  assert_true(same);
  ok(MaterialDestroy(&material));
  options_end(options);
}

/* sigma = E epsilon, whatever Poisson's ratio; products with powers of two are exact */
static void gives_uniaxial_stress_of_a_batch(void **state)
{
  const PetscReal strain[]  = {0, 0.25, -0.5, 3, 1e-3};
  PetscReal       stress[6] = {-1, -1, -1, -1, -1, -1};
  PetscOptions    options   = options_begin("-bar_density 1 -bar_youngs_modulus 5e8 -bar_poissons_ratio 0.49");
  Material        material  = create();

  (void)state;
  ok(MaterialSetFromOptions(material));
  ok(MaterialComputeUniaxial(material, 5, strain, stress));
  assert_true(stress[0] == 0);
  assert_true(stress[1] == 1.25e8);
  assert_true(stress[2] == -2.5e8);
  assert_true(stress[3] == 1.5e9);
  near(stress[4], 5e5, 1e-9);                           /* one rounding of 5e5 */
  assert_true(stress[5] == -1);                         /* not of the batch */
  ok(MaterialComputeUniaxial(material, 0, NULL, NULL)); /* a rank without elements */
  ok(MaterialDestroy(&material));
  options_end(options);
}

/* Another model, by the registry: stress is a cube of the strain */
static PetscErrorCode CubicStress(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[])
{
  PetscFunctionBegin;
  (void)material;
  for (PetscInt i = 0; i < n; i++) stress[i] = strain[i] * strain[i] * strain[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateCubic(Material material)
{
  PetscFunctionBegin;
  material->ops->uniaxial = CubicStress;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void takes_new_models(void **state)
{
  const PetscReal strain = 2;
  PetscReal       stress, density;
  PetscOptions    options  = options_begin("-bar_density 11 -bar_material_type cubic");
  Material        material = create();

  (void)state;
  ok(MaterialRegister("cubic", CreateCubic));
  ok(MaterialSetFromOptions(material));
  ok(MaterialGetDensity(material, &density));
  assert_true(density == 11);
  ok(MaterialComputeUniaxial(material, 1, &strain, &stress));
  assert_true(stress == 8);
  refused(PETSC_ERR_SUP, "uniaxialmodulus|cubic", MaterialGetUniaxialModulus(material, &stress)); /* it has none */
  ok(MaterialDestroy(&material));
  options_end(options);
}

/* A model given up for another one leaves nothing of itself behind */
static void changes_its_type(void **state)
{
  Material  material = create();
  PetscBool same;

  (void)state;
  ok(MaterialRegister("cubic", CreateCubic));
  ok(MaterialSetType(material, MATERIAL_LINEAR_ELASTIC));
  ok(MaterialSetType(material, MATERIAL_LINEAR_ELASTIC)); /* nothing to do */
  ok(MaterialSetType(material, "cubic"));
  ok(PetscObjectTypeCompare((PetscObject)material, "cubic", &same));
  assert_true(same);
  assert_null(material->ops->uniaxialmodulus);
  assert_null(material->ops->destroy);
  ok(MaterialDestroy(&material));
}

static void refuses_bad_input(void **state)
{
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-bar_youngs_modulus 1", "-bar_density|missing|kg/m^3"},
      {"-bar_youngs_modulus 1 -bar_density -7850", "-bar_density|-7850|positive"},
      {"-bar_youngs_modulus 1 -bar_density 0", "-bar_density|0|positive"},
      {"-bar_density 1", "-bar_youngs_modulus|missing"},
      {"-bar_density 1 -bar_youngs_modulus -1e9", "-bar_youngs_modulus|-1e+09"},
      {"-bar_density 1 -bar_youngs_modulus 1 -bar_poissons_ratio 0.5", "-bar_poissons_ratio|0.5|-1"},
      {"-bar_density 1 -bar_youngs_modulus 1 -bar_poissons_ratio -1", "-bar_poissons_ratio|-1|0.5"},
      {"-bar_density 1 -bar_youngs_modulus 1 -bar_poissons_ratio 0.7", "-bar_poissons_ratio|0.7"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options  = options_begin("%s", cases[i].options);
    Material     material = create();

    refused(PETSC_ERR_USER_INPUT, cases[i].words, MaterialSetFromOptions(material));
    ok(MaterialDestroy(&material));
    options_drop(options);
  }
}

static void names_an_unknown_type(void **state)
{
  Material     material = create();
  PetscOptions options  = options_begin("-bar_material_type chewing_gum");

  (void)state;
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "-bar_material_type|chewing_gum|linear_elastic", MaterialSetFromOptions(material));
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "jelly", MaterialSetType(material, "jelly"));
  ok(MaterialDestroy(&material));
  options_drop(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_made_from_options),
      cmocka_unit_test(needs_density_and_modulus_only),
      cmocka_unit_test(gives_uniaxial_stress_of_a_batch),
      cmocka_unit_test(takes_new_models),
      cmocka_unit_test(changes_its_type),
      cmocka_unit_test(refuses_bad_input),
      cmocka_unit_test(names_an_unknown_type),
  };

  return impakt_main(argc, argv, tests);
}
