/* Plane stress, beside the solid that it comes from and the bar that it contains. */
/* ranks: 1 */
#include "material_points.h"

/* The stretch across the plane at which the solid's own stress there vanishes, by bisection: that stress grows with it */
static PetscReal thickness_of(const MaterialKernels *solid, const PetscReal H[9])
{
  PetscReal low = -0.99, high = 5, full[9], P[9];

  for (int i = 0; i < 9; i++) full[i] = H[i];
  for (int i = 0; i < 60; i++) {
    full[8] = 0.5 * (low + high);
    stress_at(solid, full, P);
    if (P[8] < 0) low = full[8];
    else high = full[8];
  }
  return full[8];
}

static void plane_stress_is_that_of_a_solid_free_to_thin(void **state)
{
  MaterialKernels solid, plane;
  uint32_t        seed = 7;

  (void)state;
  for (int type = 0; type < N_TYPES; type++)
    for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++) {
      Material a = create(types[type], ratios[nu], PETSC_FALSE, &solid), b = create(types[type], ratios[nu], PETSC_TRUE, &plane);

      for (int point = 0; point < 10; point++) {
        PetscReal H[9], P[9], expected[9], W;

        draw(&seed, 0.4, PETSC_TRUE, H);
        H[8] = thickness_of(&solid, H);
        stress_at(&solid, H, expected);
        W           = energy_at(&solid, H);
        expected[8] = 0; /* the test's own H_zz is exact to 1e-16: P_zz is 1e-16 of the modulus */
        /* what is not read */
        for (int i = 2; i < 9; i++)
          if (i != 3 && i != 4) H[i] = NAN;
        stress_at(&plane, H, P);
        near_all(P, expected, 9, 1e-14 * MODULUS);
        near(energy_at(&plane, H), W, 1e-14 * MODULUS);
      }
      ok(MaterialDestroy(&a));
      ok(MaterialDestroy(&b));
    }
}

/* As for a model without a formula for the thickness: the formulas withheld, Newton's method must find the same */
static void thickness_is_found_without_a_formula(void **state)
{
  uint32_t seed      = 8;
  int      undefined = 0;

  (void)state;
  for (int type = 1; type < N_TYPES; type++)
    for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++)
      for (int size = 0; size < 3; size++) {
        const PetscReal sizes[] = {1.6, 0.4, 1e-10};
        MaterialKernels formula, newton;
        Material        material = create(types[type], ratios[nu], PETSC_TRUE, &formula),
                        other    = create(types[type], ratios[nu], PETSC_FALSE, &newton);

        ok(MaterialCondenseKernels(other, NULL, &newton));
        for (int point = 0; point < 20; point++) {
          PetscReal H[9], P[9], expected[9], A[81], B[81];

          draw(&seed, sizes[size], PETSC_TRUE, H);
          stress_at(&formula, H, expected);
          stress_at(&newton, H, P);
          formula.tangent(formula.data, H, A);
          newton.tangent(newton.data, H, B);
          if (PetscIsNanReal(expected[0])) { /* large strains: there is no such thickness */
            for (int i = 0; i < 9; i++) assert_true(PetscIsNanReal(P[i]) == PetscIsNanReal(expected[i]));
            assert_true(PetscIsNanReal(energy_at(&newton, H)));
            assert_true(PetscIsNanReal(B[0]));
            undefined++;
            continue;
          }
          near_all(P, expected, 9, 1e-14 * PetscMin(1, sizes[size]) * (MODULUS + largest(expected, 9)));
          near_all(B, A, 81, 1e-14 * (MODULUS + largest(A, 81))); /* converged to round-off, of relative size */
        }
        ok(MaterialDestroy(&material));
        ok(MaterialDestroy(&other));
      }
  assert_true(undefined > 0); /* some of the large strains were such */
}

/* A plate pulled along x, its width free (Newton's method with the condensed tangent, so that this is checked as well), is a bar */
static void a_free_plate_is_a_bar(void **state)
{
  const PetscReal strains[] = {-0.5, -0.1, 1e-6, 0.15, 0.5};

  (void)state;
  for (int type = 0; type < N_TYPES; type++)
    for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++)
      for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(strains); k++) {
        const PetscReal e = strains[k];
        MaterialKernels kernels;
        Material        material = create(types[type], ratios[nu], PETSC_TRUE, &kernels);
        PetscReal       H[9]     = {e, 0, 0, 0, -ratios[nu] * e}, P[9], A[81], stress, tangent, energy;

        ok(MaterialComputeUniaxial(material, 1, &e, &stress));
        ok(MaterialComputeUniaxialTangent(material, 1, &e, &tangent));
        ok(MaterialComputeUniaxialEnergy(material, 1, &e, &energy));
        /* by hand: above a strain of 0.203, a neo-Hookean bar with nu = -0.4 has sides without equilibrium */
        if (e > 0.203 && ratios[nu] < 0 && !strcmp(types[type], MATERIAL_NEO_HOOKEAN)) {
          assert_true(PetscIsNanReal(stress) && PetscIsNanReal(tangent) && PetscIsNanReal(energy));
          ok(MaterialDestroy(&material));
          continue;
        }
        for (int i = 0; i < 8; i++) {
          stress_at(&kernels, H, P);
          kernels.tangent(kernels.data, H, A);
          H[4] -= P[4] / A[9 * 4 + 4];
        }
        stress_at(&kernels, H, P);
        kernels.tangent(kernels.data, H, A);
        near(P[4], 0, 1e-14 * MODULUS);
        near(P[0], stress, 1e-14 * (MODULUS + PetscAbsReal(stress))); /* round-off; observed: 7.6e-14 of a stress of 3.8, Mooney-Rivlin */
        near(A[0] - A[4] * A[36] / A[40], tangent, 1e-13 * MODULUS);
        near(energy_at(&kernels, H), energy, 1e-14 * MODULUS);
        ok(MaterialDestroy(&material));
      }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plane_stress_is_that_of_a_solid_free_to_thin),
      cmocka_unit_test(thickness_is_found_without_a_formula),
      cmocka_unit_test(a_free_plate_is_a_bar),
  };

  return impakt_main(argc, argv, tests);
}
