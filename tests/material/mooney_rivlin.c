/* Mooney-Rivlin against the closed forms of incompressible rubber (Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.5). */
#include "material_points.h"

/* Deformations without change of volume: Cauchy stresses differ from -p I + 2 c10 B - 2 c01 B^-1 by a pressure only, whatever nu is */
static void simple_shear_is_the_closed_form(void **state)
{
  (void)state;
  for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++)
    for (int k = 1; k < 5; k++) {
      const PetscReal g = 0.5 * k, H[9] = {0, g}, mu = mu_of(ratios[nu]), c01 = 0.5 * mu * SHARE, c10 = 0.5 * mu - c01;
      MaterialKernels kernels;
      Material        material = create(MATERIAL_MOONEY_RIVLIN, ratios[nu], PETSC_FALSE, &kernels);
      PetscReal       P[9], cauchy[9];

      stress_at(&kernels, H, P);
      for (int i = 0; i < 9; i++) cauchy[i] = P[i] + (i % 3 == 0 ? g * P[i + 1] : 0); /* P F^T */
      near(cauchy[1], mu * g, 1e-14 * MODULUS * (1 + g * g));                         /* round-off */
      near(cauchy[3], mu * g, 1e-14 * MODULUS * (1 + g * g));
      near(cauchy[0] - cauchy[8], 2 * c10 * g * g, 1e-14 * MODULUS * (1 + g * g * g * g));
      near(cauchy[4] - cauchy[8], -2 * c01 * g * g, 1e-14 * MODULUS * (1 + g * g * g * g));
      near(energy_at(&kernels, H), 0.5 * mu * g * g, 1e-14 * MODULUS * (1 + g * g));
      ok(MaterialDestroy(&material));
    }
}

/* A sheet drawn alike both ways, almost incompressible: P = 2 (c10 + c01 s^2) (s - s^-5), up to changes of volume of P/kappa */
static void equibiaxial_tension_is_the_closed_form(void **state)
{
  const PetscReal nu = 0.5 - 1e-7, mu = mu_of(nu), c01 = 0.5 * mu * SHARE, c10 = 0.5 * mu - c01;

  (void)state;
  for (PetscReal s = 0.75; s < 2.1; s += 0.25) {
    const PetscReal H[9] = {s - 1, 0, 0, 0, s - 1}, expected = 2 * (c10 + c01 * s * s) * (s - PetscPowReal(s, -5));
    MaterialKernels kernels;
    Material        material = create(MATERIAL_MOONEY_RIVLIN, nu, PETSC_TRUE, &kernels);
    PetscReal       P[9];

    stress_at(&kernels, H, P);
    near(P[0], expected, 2e-5 * MODULUS); /* kappa is 1.7e6 of the modulus, stresses up to 10 of it, and the square of the stretch */
    near(P[4], P[0], 1e-8 * MODULUS);
    ok(MaterialDestroy(&material));
  }
}

/* A bar with free sides: P = 2 (c10 + c01/s) (s - s^-2); its tangent and energy by differences */
static void uniaxial_tension_is_the_closed_form(void **state)
{
  const PetscReal nu = 0.5 - 1e-7, mu = mu_of(nu), c01 = 0.5 * mu * SHARE, c10 = 0.5 * mu - c01, d = 1e-4;
  MaterialKernels kernels;
  Material        material = create(MATERIAL_MOONEY_RIVLIN, nu, PETSC_FALSE, &kernels);

  (void)state;
  for (PetscReal s = 0.5; s < 2.6; s += 0.25) {
    const PetscReal strain[5] = {s - 1, s - 1 - d, s - 1 + d, s - 1 - 2 * d, s - 1 + 2 * d};
    PetscReal       stress[5], tangent, energy[5];

    ok(MaterialComputeUniaxial(material, 5, strain, stress));
    ok(MaterialComputeUniaxialTangent(material, 1, strain, &tangent));
    ok(MaterialComputeUniaxialEnergy(material, 5, strain, energy));
    near(stress[0], 2 * (c10 + c01 / s) * (s - 1 / (s * s)), 2e-5 * MODULUS);
    /* differences of order 4: (d/s)^4 of a tangent of some tens, and round-off of 1e-9, as kappa is 1.7e6 of the modulus, over d */
    near(tangent, (8 * (stress[2] - stress[1]) - (stress[4] - stress[3])) / (12 * d), 1e-5 * MODULUS);
    near(stress[0], (8 * (energy[2] - energy[1]) - (energy[4] - energy[3])) / (12 * d), 1e-5 * MODULUS);
  }
  ok(MaterialDestroy(&material));
}

static void shares_outside_0_to_1_are_refused(void **state)
{
  const char *const bad[] = {"-0.1", "1.1"};
  MaterialKernels   kernels;
  Material          material = create(MATERIAL_MOONEY_RIVLIN, 0.3, PETSC_FALSE, &kernels);

  (void)state;
  for (int k = 0; k < 2; k++) {
    PetscOptions options = options_begin("-mooney_rivlin_share %s", bad[k]);

    refused(PETSC_ERR_USER_INPUT, "share|between 0 and 1", MaterialSetFromOptions(material));
    options_end(options);
  }
  ok(MaterialDestroy(&material));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(simple_shear_is_the_closed_form),
      cmocka_unit_test(equibiaxial_tension_is_the_closed_form),
      cmocka_unit_test(uniaxial_tension_is_the_closed_form),
      cmocka_unit_test(shares_outside_0_to_1_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
