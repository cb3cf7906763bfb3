/* Stress, energy and tangent of the constitutive models at points, in three dimensions and in plane stress, beside the solid that it comes
   from and the bar that it contains. */
#include "material_points.h"

/* Central differences of order 8: with STEP, their truncation and the round-off of what they divide by it are of order 1e-13, as the
   models are analytic with the nearest singularity (an inverted point) some tenths away. Observed: 4e-13 of the modulus. */
#define STEP 4e-3
static const PetscReal weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
#define DIFFERENCE_TOLERANCE (4e-12 * MODULUS)

static void stress_is_the_derivative_of_the_energy(void **state)
{
  MaterialKernels kernels;
  Material        material;
  uint32_t        seed = 1;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    for (int point = 0; point < 10; point++) {
      PetscReal H[9], P[9];

      draw(&seed, 0.4, plane, H);
      stress_at(&kernels, H, P);
      for (int i = 0; i < 9; i++) {
        const PetscReal h          = H[i];
        PetscReal       derivative = 0;

        for (int k = 0; k < 4; k++)
          for (int sign = -1; sign <= 1; sign += 2) {
            H[i] = h + sign * (k + 1) * STEP;
            derivative += sign * weights[k] / STEP * energy_at(&kernels, H);
          }
        H[i] = h;
        near(P[i], derivative, DIFFERENCE_TOLERANCE);
      }
    }
  }
}

static void tangent_is_the_derivative_of_the_stress(void **state)
{
  MaterialKernels kernels;
  Material        material;
  uint32_t        seed = 2;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    for (int point = 0; point < 10; point++) {
      PetscReal H[9], P[9], A[81];

      draw(&seed, 0.4, plane, H);
      kernels.tangent(kernels.data, H, A);
      for (int k = 0; k < 9; k++) {
        const PetscReal h             = H[k];
        PetscReal       derivative[9] = {0};

        for (int n = 0; n < 4; n++)
          for (int sign = -1; sign <= 1; sign += 2) {
            H[k] = h + sign * (n + 1) * STEP;
            stress_at(&kernels, H, P);
            for (int i = 0; i < 9; i++) derivative[i] += sign * weights[n] / STEP * P[i];
          }
        H[k] = h;
        for (int i = 0; i < 9; i++) {
          near(A[9 * i + k], derivative[i], DIFFERENCE_TOLERANCE);
          near(A[9 * i + k], A[9 * k + i], 1e-13 * MODULUS); /* there is an energy: round-off, condensed as well */
        }
      }
    }
  }
}

/* At strains of s the models differ from linear elasticity by terms of s^2 (stress) and s^3 (energy), and by round-off of the small
   numbers, not of 1: 1e-16 s and 1e-16 s^2 */
static void small_strains_are_linear_and_keep_their_digits(void **state)
{
  const PetscReal s = 1e-10;
  MaterialKernels kernels, linear;
  Material        material, reference;
  uint32_t        seed = 4;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    reference = create(types[LINEAR], ratios[nu], plane, &linear);
    for (int point = 0; point < 10; point++) {
      PetscReal H[9], P[9], expected[9], A[81], B[81];

      draw(&seed, s, plane, H);
      stress_at(&kernels, H, P);
      stress_at(&linear, H, expected);
      near_all(P, expected, 9, MODULUS * (30 * s * s + 3e-15 * s));
      near(energy_at(&kernels, H), energy_at(&linear, H), MODULUS * (30 * s * s * s + 3e-15 * s * s));
      kernels.tangent(kernels.data, H, A);
      linear.tangent(linear.data, H, B);
      near_all(A, B, 81, MODULUS * 60 * s);
    }
    ok(MaterialDestroy(&reference));
  }
}

/* The models as textbooks write them, in F, with 64 bits of mantissa; rounding of F costs 1e-19 / size */
static void definition(int type, PetscReal nu, const PetscReal H[9], PetscReal P[9], PetscReal *W)
{
  const long double lambda = (long double)MODULUS * nu / ((1 + (long double)nu) * (1 - 2 * (long double)nu)),
                    mu     = MODULUS / (2 * (1 + (long double)nu));
  long double       F[9], C[9], cofactor[9], J = 0, trace = 0, squares = 0;

  for (int i = 0; i < 9; i++) F[i] = H[i] + (long double)(i % 4 == 0);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int a = 3 * ((i + 1) % 3), b = 3 * ((i + 2) % 3), c = (j + 1) % 3, d = (j + 2) % 3;

      cofactor[3 * i + j] = F[a + c] * F[b + d] - F[a + d] * F[b + c];
      C[3 * i + j]        = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
    }
  for (int j = 0; j < 3; j++) J += F[j] * cofactor[j];
  trace = C[0] + C[4] + C[8] - 3;
  for (int i = 0; i < 9; i++) squares += (C[i] - (i % 4 == 0)) * (C[i] - (i % 4 == 0));
  if (!strcmp(types[type], MATERIAL_NEO_HOOKEAN)) {
    for (int i = 0; i < 9; i++) P[i] = (PetscReal)(mu * (F[i] - cofactor[i] / J) + lambda / 2 * (J * J - 1) * cofactor[i] / J);
    *W = (PetscReal)(mu / 2 * trace - mu * logl(J) + lambda / 4 * (J * J - 1 - 2 * logl(J)));
  } else if (!strcmp(types[type], MATERIAL_MOONEY_RIVLIN)) {
    const long double c01 = (long double)SHARE * mu / 2, c10 = mu / 2 - c01, kappa = lambda + 2 * mu / 3;
    const long double I1 = trace + 3, root = cbrtl(J), y2 = 1 / (root * root), y4 = y2 * y2;
    long double       I2 = I1 * I1 / 2;

    for (int i = 0; i < 9; i++) I2 -= C[i] * C[i] / 2;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        const int         n  = 3 * i + j;
        const long double FC = F[3 * i] * C[j] + F[3 * i + 1] * C[3 + j] + F[3 * i + 2] * C[6 + j], G = cofactor[n] / J;

        P[n] = (PetscReal)(2 * c10 * y2 * (F[n] - I1 / 3 * G) + 2 * c01 * y4 * (I1 * F[n] - FC - 2 * I2 / 3 * G) +
                           kappa / 2 * (J * J - 1) * G);
      }
    *W = (PetscReal)(c10 * (y2 * I1 - 3) + c01 * (y4 * I2 - 3) + kappa / 4 * (J * J - 1 - 2 * logl(J)));
  } else {
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        P[3 * i + j] = (PetscReal)(lambda / 2 * trace * F[3 * i + j] +
                                   mu * (F[3 * i] * C[j] + F[3 * i + 1] * C[3 + j] + F[3 * i + 2] * C[6 + j] - F[3 * i + j]));
      }
    *W = (PetscReal)(lambda / 8 * trace * trace + mu / 4 * squares);
  }
}

/* From strains of order 1 down to those at which the textbook's form begins to fail; large and small ratios of volumes */
static void stress_and_energy_are_those_of_the_textbooks(void **state)
{
  const PetscReal sizes[] = {0.9, 0.4, 0.1, 0.01, 1e-3, 1e-4};
  MaterialKernels kernels;
  Material        material;
  uint32_t        seed = 5;

  (void)state;
  for (int type = 1; type < N_TYPES; type++)
    for (size_t nu = 0; nu < PETSC_STATIC_ARRAY_LENGTH(ratios); nu++) {
      material = create(types[type], ratios[nu], PETSC_FALSE, &kernels);
      for (size_t size = 0; size < PETSC_STATIC_ARRAY_LENGTH(sizes); size++)
        for (int point = 0; point < 20; point++) {
          const PetscReal s = sizes[size];
          PetscReal       H[9], P[9], expected[9], W;

          draw(&seed, s, PETSC_FALSE, H);
          stress_at(&kernels, H, P);
          definition(type, ratios[nu], H, expected, &W);
          /* round-off, of terms that grow to some tens of the modulus where strains are large: observed 2e-15 */
          near_all(P, expected, 9, 1e-14 * (MODULUS * s + largest(expected, 9)));
          near(energy_at(&kernels, H), W, 1e-14 * (MODULUS * s * s + W) + 1e-18 * MODULUS); /* the latter for the textbook */
        }
      ok(MaterialDestroy(&material));
    }
}

/* The neo-Hookean energy changes from a series to a logarithm at volume changes of 0.2: both are exact to round-off there. Observed: 4e-16.
 */
static void energy_is_exact_where_its_logarithm_changes_form(void **state)
{
  const PetscReal changes[] = {-0.21, -0.2001, -0.1999, -0.19, -0.15, 0.15, 0.19, 0.1999, 0.2001, 0.21};

  (void)state;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(changes); k++) {
    const PetscReal h = PetscPowReal(1 + changes[k], 1. / 3) - 1, H[9] = {h, 0, 0, 0, h, 0, 0, 0, h};
    MaterialKernels kernels;
    Material        material = create(MATERIAL_NEO_HOOKEAN, 0.3, PETSC_FALSE, &kernels);
    PetscReal       P[9], W;

    definition(2, 0.3, H, P, &W);
    near(energy_at(&kernels, H), W, 3e-15 * W);
    ok(MaterialDestroy(&material));
  }
}

/* det F negative, zero and just above; two axes turned round are a rotation, and no inversion */
static void inverted_points_are_not_defined(void **state)
{
  const PetscReal inverted[][9] = {
      {-2, 0, 0, 0, 0, 0, 0, 0, 0},    /* mirrored */
      {-1, 0, 0, 0, 0, 0, 0, 0, 0},    /* flat */
      {-1, 0, 0, 0, -1, 0, 0, 0, 0},   /* a line: no cofactors */
      {0, 2.5, 0, 2.5, 0, 0, 0, 0, 0}, /* sheared through itself: 1 - 6.25 */
  };
  const PetscReal defined[][9] = {
      {-0.999, 0, 0, 0, 0, 0, 0, 0, 0},
      {-2, 0, 0, 0, -2, 0, 0, 0, 0},
  };
  MaterialKernels kernels;
  Material        material;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    PetscReal P[9], A[81];

    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(inverted); k++) {
      if (plane && (k == 1 || k == 2)) continue; /* flat to round-off only, with the stretch across the plane */
      stress_at(&kernels, inverted[k], P);
      kernels.tangent(kernels.data, inverted[k], A);
      assert_true(PetscIsNanReal(energy_at(&kernels, inverted[k])) == (type != LINEAR));
      for (int i = 0; i < 9; i++) {
        if (type == LINEAR) assert_false(PetscIsInfOrNanReal(P[i]));
        else if (!plane || i == 0 || i == 1 || i == 3 || i == 4 || i == 8) assert_true(PetscIsNanReal(P[i]));
      }
      for (int i = 0; i < 81; i++)
        if (type == LINEAR) assert_false(PetscIsInfOrNanReal(A[i]));
        else if (!plane) assert_true(PetscIsNanReal(A[i]));
      assert_true(PetscIsNanReal(A[0]) == (type != LINEAR));
    }
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(defined); k++) {
      stress_at(&kernels, defined[k], P);
      kernels.tangent(kernels.data, defined[k], A);
      assert_false(PetscIsInfOrNanReal(energy_at(&kernels, defined[k])));
      for (int i = 0; i < 9; i++) assert_false(PetscIsInfOrNanReal(P[i]));
      for (int i = 0; i < 81; i++) assert_false(PetscIsInfOrNanReal(A[i]));
    }
  }
}

/* Where waves of small strain are concerned, the tangent's first entry is the wave modulus */
static void wave_modulus_is_that_of_the_tangent(void **state)
{
  const PetscReal zero[9] = {0};
  MaterialKernels kernels;
  Material        material;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    PetscReal modulus, A[81];

    ok(MaterialGetWaveModulus(material, &modulus));
    kernels.tangent(kernels.data, zero, A);
    near(modulus, plane ? MODULUS / (1 - ratios[nu] * ratios[nu]) : lambda_of(ratios[nu]) + 2 * mu_of(ratios[nu]), 1e-14 * MODULUS);
    near(modulus, A[0], 1e-14 * MODULUS);
  }
}

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
      cmocka_unit_test(stress_is_the_derivative_of_the_energy),
      cmocka_unit_test(tangent_is_the_derivative_of_the_stress),
      cmocka_unit_test(small_strains_are_linear_and_keep_their_digits),
      cmocka_unit_test(stress_and_energy_are_those_of_the_textbooks),
      cmocka_unit_test(energy_is_exact_where_its_logarithm_changes_form),
      cmocka_unit_test(inverted_points_are_not_defined),
      cmocka_unit_test(wave_modulus_is_that_of_the_tangent),
      cmocka_unit_test(plane_stress_is_that_of_a_solid_free_to_thin),
      cmocka_unit_test(a_free_plate_is_a_bar),
  };

  return impakt_main(argc, argv, tests);
}
