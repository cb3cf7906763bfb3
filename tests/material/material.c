/* Constitutive models and their registry. */
#include "support.h"
#include <impakt/private/materialimpl.h>

static Material create(void)
{
  Material material;

  ok(MaterialCreate(PETSC_COMM_WORLD, &material));
  ok(PetscObjectSetOptionsPrefix((PetscObject)material, "bar_"));
  return material;
}

static void is_made_from_options(void **state)
{
  PetscOptions options = options_begin(
      "-bar_density 7850 -bar_youngs_modulus 2.1e11 -bar_poissons_ratio 0.3 -bar_material_type linear_elastic");
  Material  material = create();
  PetscReal density, modulus;
  PetscBool linear, same;

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

static Material create_with(const char type[], PetscReal E, PetscReal nu)
{
  PetscOptions options  = options_begin("-bar_density 1 -bar_youngs_modulus %.17g -bar_poissons_ratio %.17g -bar_material_type %s",
                                        (double)E, (double)nu, type);
  Material     material = create();

  ok(MaterialSetFromOptions(material));
  options_end(options);
  return material;
}

static void nonlinear_models_share_the_constants(void **state)
{
  const char *const types[] = {MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};

  (void)state;
  for (int i = 0; i < 2; i++) {
    Material  material = create_with(types[i], 8, 0.25);
    PetscReal modulus;
    PetscBool linear, same;

    ok(PetscObjectTypeCompare((PetscObject)material, types[i], &same));
    assert_true(same);
    ok(MaterialIsLinear(material, &linear));
    assert_false(linear);
    ok(MaterialGetUniaxialModulus(material, &modulus));
    assert_true(modulus == 8);
    /* lambda = mu = 3.2; E / (1 - nu^2) = 8 / 0.9375. Round-off of a few operations. */
    ok(MaterialGetWaveModulus(material, &modulus));
    near(modulus, 9.6, 1e-14);
    ok(MaterialSetPlaneStress(material, PETSC_TRUE));
    ok(MaterialGetWaveModulus(material, &modulus));
    near(modulus, 8 / 0.9375, 1e-14);
    ok(MaterialDestroy(&material));
  }
}

/* Saint-Venant-Kirchhoff: (1 + e) E (e + e^2/2), 1.5 * 8 * 0.625 = 7.5 whatever Poisson's ratio. Neo-Hookean without lambda: the sides
   stay, mu (s - 1/s), 4 (1.5 - 1/1.5) = 10/3. With it, s = 2 and nu = 0.25 (lambda = mu = 3.2): the squared stretch x of the sides has
   2 x^2 + x - 1.5 = 0, x = (sqrt(13) - 1) / 4, and the stress is mu (4 - x) / 2. */
static void bars_of_nonlinear_models_have_known_stresses(void **state)
{
  const PetscReal strain = 0.5, one = 1;
  PetscReal       stress;
  Material        material;

  (void)state;
  material = create_with(MATERIAL_SAINT_VENANT_KIRCHHOFF, 8, 0.25);
  ok(MaterialComputeUniaxial(material, 1, &strain, &stress));
  near(stress, 7.5, 1e-14);
  ok(MaterialDestroy(&material));
  material = create_with(MATERIAL_NEO_HOOKEAN, 8, 0);
  ok(MaterialComputeUniaxial(material, 1, &strain, &stress));
  near(stress, 10. / 3, 1e-14);
  ok(MaterialDestroy(&material));
  material = create_with(MATERIAL_NEO_HOOKEAN, 8, 0.25);
  ok(MaterialComputeUniaxial(material, 1, &one, &stress));
  near(stress, 1.6 * (4 - (PetscSqrtReal(13) - 1) / 4), 1e-14);
  ok(MaterialDestroy(&material));
}

/* Central differences of order 8 with a step of 0.002: truncation and round-off are of order 1e-13 of the modulus as long as nothing
   is singular near by (s = 0, 0.3 away; the end of the sides' equilibrium with nu = -0.4, 0.1 away). A batch that is no multiple of the
   vectors' length. */
static void bars_have_consistent_stress_tangent_and_energy(void **state)
{
  const char *const types[]   = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
  const PetscReal   ratios[]  = {0, 0.3, 0.45, -0.4};
  const PetscReal   weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280}, step = 2e-3, E = 5;
  PetscReal         e[11] = {-0.7, -0.5, -0.2, -0.1, -1e-3, 0, 1e-3, 0.02, 0.05, 0.08, 0.1};

  (void)state;
  for (int type = 0; type < 3; type++)
    for (int nu = 0; nu < 4; nu++) {
      Material  material = create_with(types[type], E, ratios[nu]);
      PetscReal stress[11], tangent[11], dstress[11] = {0}, denergy[11] = {0};

      ok(MaterialComputeUniaxial(material, 11, e, stress));
      ok(MaterialComputeUniaxialTangent(material, 11, e, tangent));
      for (int k = 0; k < 8; k++) {
        const PetscReal shift = (k % 2 ? -1 : 1) * (k / 2 + 1), weight = (k % 2 ? -1 : 1) * weights[k / 2] / step;
        PetscReal       shifted[11], P[11], W[11];

        for (int i = 0; i < 11; i++) shifted[i] = e[i] + shift * step;
        ok(MaterialComputeUniaxial(material, 11, shifted, P));
        ok(MaterialComputeUniaxialEnergy(material, 11, shifted, W));
        for (int i = 0; i < 11; i++) {
          dstress[i] += weight * P[i];
          denergy[i] += weight * W[i];
        }
      }
      for (int i = 0; i < 11; i++) {
        near(stress[i], denergy[i], 1e-11 * E);
        near(tangent[i], dstress[i], 1e-11 * E);
      }
      near(tangent[5], E, 1e-14 * E); /* at zero strain */
      ok(MaterialDestroy(&material));
    }
}

/* Relative to linear elasticity: terms of the order of the strain, and round-off of the small numbers themselves */
static void bars_keep_the_digits_of_small_strains(void **state)
{
  const char *const types[] = {MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
  const PetscReal   e = 1e-11, E = 5;

  (void)state;
  for (int type = 0; type < 2; type++) {
    Material  material = create_with(types[type], E, 0.3);
    PetscReal stress, energy;

    ok(MaterialComputeUniaxial(material, 1, &e, &stress));
    ok(MaterialComputeUniaxialEnergy(material, 1, &e, &energy));
    near(stress, E * e, E * e * (3 * e + 1e-15));
    near(energy, E * e * e / 2, E * e * e * (3 * e + 2e-15));
    ok(MaterialDestroy(&material));
  }
}

/* Nothing is left of the bar at e = -1, or it is turned round; with nu = 0.45 the sides of one of Saint-Venant-Kirchhoff material have
   no width left from 0.9 (e + e^2/2) = 1 on, e = 0.795. Strong compression is allowed, and linear elasticity knows no limit. */
static void bars_are_not_defined_where_they_are_inverted(void **state)
{
  const PetscReal strain[] = {-1, -1.5, -3, 0.8, -0.999, 0.79};
  const struct {
    const char *type;
    PetscBool   defined[6];
  } cases[] = {
      {MATERIAL_LINEAR_ELASTIC, {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE}},
      {MATERIAL_SAINT_VENANT_KIRCHHOFF, {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE, PETSC_TRUE}},
      {MATERIAL_NEO_HOOKEAN, {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE}},
  };

  (void)state;
  for (int k = 0; k < 3; k++) {
    Material  material = create_with(cases[k].type, 5, 0.45);
    PetscReal stress[6], tangent[6], energy[6];

    ok(MaterialComputeUniaxial(material, 6, strain, stress));
    ok(MaterialComputeUniaxialTangent(material, 6, strain, tangent));
    ok(MaterialComputeUniaxialEnergy(material, 6, strain, energy));
    for (int i = 0; i < 6; i++) {
      assert_true(PetscIsNanReal(stress[i]) != cases[k].defined[i]);
      assert_true(PetscIsNanReal(tangent[i]) != cases[k].defined[i]);
      assert_true(PetscIsNanReal(energy[i]) != cases[k].defined[i]);
    }
    ok(MaterialDestroy(&material));
  }
}

/* Another model, by the registry: stress is a cube of the strain */
static PetscErrorCode CubicStress(Material material, PetscInt n, const PetscReal strain[], PetscReal stress[], PetscReal tangent[],
                                  PetscReal energy[])
{
  PetscFunctionBegin;
  (void)material;
  (void)tangent;
  (void)energy;
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
  MaterialKernels kernels;
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
  refused(PETSC_ERR_SUP, "wavemodulus|cubic", MaterialGetWaveModulus(material, &stress));
  refused(PETSC_ERR_SUP, "kernels|cubic", MaterialGetKernels(material, &kernels));
  ok(MaterialDestroy(&material));
  options_end(options);
}

static void refuses_bad_input(void **state)
{
  const char *const types[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
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
  for (int type = 0; type < 3; type++)
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
      PetscOptions options  = options_begin("%s -bar_material_type %s", cases[i].options, types[type]);
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
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "-bar_material_type|chewing_gum|linear_elastic, mooney_rivlin, neo_hookean, saint_venant_kirchhoff",
          MaterialSetFromOptions(material));
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "jelly", MaterialSetType(material, "jelly"));
  ok(MaterialDestroy(&material));
  options_drop(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_made_from_options),
      cmocka_unit_test(gives_uniaxial_stress_of_a_batch),
      cmocka_unit_test(nonlinear_models_share_the_constants),
      cmocka_unit_test(bars_of_nonlinear_models_have_known_stresses),
      cmocka_unit_test(bars_have_consistent_stress_tangent_and_energy),
      cmocka_unit_test(bars_keep_the_digits_of_small_strains),
      cmocka_unit_test(bars_are_not_defined_where_they_are_inverted),
      cmocka_unit_test(takes_new_models),
      cmocka_unit_test(refuses_bad_input),
      cmocka_unit_test(names_an_unknown_type),
  };

  return impakt_main(argc, argv, tests);
}
