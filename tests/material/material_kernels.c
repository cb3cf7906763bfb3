/* Stress, energy and tangent of the constitutive models at points, in three dimensions and in plane stress. */
/* ranks: 1 */
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

/* R = rotation by an angle about an axis (Rodrigues); about z in the plane */
static void rotation(uint32_t *seed, PetscBool plane, PetscReal R[9])
{
  PetscReal n[3], angle = 3 * pseudo_random(seed), length = 0;

  for (int i = 0; i < 3; i++) {
    n[i] = i < 2 && plane ? 0 : pseudo_random(seed);
    length += n[i] * n[i];
  }
  for (int i = 0; i < 3; i++) n[i] /= PetscSqrtReal(length);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) R[3 * i + j] = (i == j ? PetscCosReal(angle) : 0) + (1 - PetscCosReal(angle)) * n[i] * n[j];
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;

    R[3 * i + j] -= PetscSinReal(angle) * n[k];
    R[3 * j + i] += PetscSinReal(angle) * n[k];
  }
}

static void multiply(const PetscReal A[9], const PetscReal B[9], PetscReal C[9])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

/* P(R F) = R P(F) and W(R F) = W(F), to round-off; isotropy: P(F R) = P(F) R. Linear elasticity knows nothing of rotations. */
static void rotations_do_no_more_than_rotate(void **state)
{
  MaterialKernels kernels;
  Material        material;
  uint32_t        seed = 3;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    for (int point = 0; point < 10; point++) {
      PetscReal H[9], P[9], R[9], rotated[9], expected[9], zero[9] = {0};

      draw(&seed, 0.4, plane, H);
      rotation(&seed, plane, R);
      stress_at(&kernels, H, P);
      for (int left = 0; left < 2 && type != LINEAR; left++) {
        PetscReal F[9];

        for (int i = 0; i < 9; i++) F[i] = H[i] + (i % 4 == 0);
        if (left) multiply(R, F, rotated);
        else multiply(F, R, rotated);
        for (int i = 0; i < 9; i++) rotated[i] -= i % 4 == 0;
        if (left) multiply(R, P, expected);
        else multiply(P, R, expected);
        stress_at(&kernels, rotated, F);
        near_all(F, expected, 9, 2e-14 * MODULUS); /* observed: 5e-15 */
        near(energy_at(&kernels, rotated), energy_at(&kernels, H), 2e-14 * MODULUS);
      }
      for (int i = 0; i < 9; i++) rotated[i] = R[i] - (i % 4 == 0);
      stress_at(&kernels, rotated, expected);
      if (type != LINEAR) near_all(expected, zero, 9, 1e-14 * MODULUS);
      else assert_true(largest(expected, 9) > 1e-3 * MODULUS);
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

/* Each of the 8 points of a batch has what it has alone, to the bit, whatever the others are */
static void points_of_a_batch_do_not_touch_each_other(void **state)
{
  const PetscReal inverted[9] = {-2};
  MaterialKernels kernels;
  Material        material;
  uint32_t        seed = 6;

  (void)state;
  for_all_models(material, kernels, type, nu, plane)
  {
    for (int bad = -1; bad < 8; bad++) {
      PetscReal in[9][8], out[9][8], W[8], H[8][9];

      for (int p = 0; p < 8; p++) {
        draw(&seed, 0.4, plane, H[p]);
        put(p == bad ? inverted : H[p], p, in);
      }
      kernels.stress(kernels.data, in, out);
      kernels.energy(kernels.data, in, W);
      for (int p = 0; p < 8; p++) {
        PetscReal P[9];

        if (p == bad) continue;
        stress_at(&kernels, H[p], P);
        for (int i = 0; i < 9; i++) assert_true(out[i][p] == P[i]);
        assert_true(W[p] == energy_at(&kernels, H[p]));
      }
    }
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

/* By hand, from the energies; the tolerance is round-off of some tens of operations */
static void known_states_have_known_stresses(void **state)
{
  const PetscReal stretches[] = {0.4, 0.9, 1.001, 1.5, 3}, tolerance = 1e-14;

  (void)state;
  for (size_t n = 0; n < PETSC_STATIC_ARRAY_LENGTH(ratios); n++) {
    const PetscReal nu = ratios[n], lambda = lambda_of(nu), mu = mu_of(nu), gamma = 0.7;
    const PetscReal shear[9] = {0, gamma};
    MaterialKernels svk, neo;
    Material        first  = create(MATERIAL_SAINT_VENANT_KIRCHHOFF, nu, PETSC_FALSE, &svk),
                    second = create(MATERIAL_NEO_HOOKEAN, nu, PETSC_FALSE, &neo);
    PetscReal       P[9];

    /* simple shear: E_xy = gamma / 2, E_yy = gamma^2 / 2; the neo-Hookean one has no volume change and F - F^-T = gamma (xy and yx) */
    {
      const PetscReal Sxx = lambda * gamma * gamma / 2, Syy = (lambda + 2 * mu) * gamma * gamma / 2, Sxy = mu * gamma;
      const PetscReal of_svk[9] = {Sxx + gamma * Sxy, Sxy + gamma * Syy, 0, Sxy, Syy, 0, 0, 0, Sxx},
                      of_neo[9] = {0, mu * gamma, 0, mu * gamma};

      stress_at(&svk, shear, P);
      near_all(P, of_svk, 9, tolerance * MODULUS);
      stress_at(&neo, shear, P);
      near_all(P, of_neo, 9, tolerance * MODULUS);
      near(energy_at(&neo, shear), mu * gamma * gamma / 2, tolerance * MODULUS);
    }
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(stretches); k++) {
      const PetscReal s = stretches[k], E = (s * s - 1) / 2;
      const PetscReal along[9] = {s - 1}, all[9] = {s - 1, 0, 0, 0, s - 1, 0, 0, 0, s - 1};

      /* uniaxial strain */
      {
        const PetscReal of_svk[9] = {s * (lambda + 2 * mu) * E, 0, 0, 0, lambda * E, 0, 0, 0, lambda * E};
        const PetscReal of_neo[9] = {mu * (s - 1 / s) + lambda * E / s, 0, 0, 0, lambda * E, 0, 0, 0, lambda * E};

        stress_at(&svk, along, P);
        near_all(P, of_svk, 9, tolerance * (MODULUS + largest(of_svk, 9)));
        stress_at(&neo, along, P);
        near_all(P, of_neo, 9, tolerance * (MODULUS + largest(of_neo, 9)));
        near(energy_at(&svk, along), (lambda + 2 * mu) * E * E / 2, tolerance * (MODULUS + PetscAbsReal(P[0])));
        near(energy_at(&neo, along), mu * (E - PetscLogReal(s)) + lambda / 2 * (E - PetscLogReal(s)),
             tolerance * (MODULUS + PetscAbsReal(P[0])));
      }
      /* the same stretch along every axis */
      {
        const PetscReal in_svk = s * (3 * lambda + 2 * mu) * E, in_neo = mu * (s - 1 / s) + lambda / 2 * (PetscPowRealInt(s, 6) - 1) / s;
        const PetscReal of_svk[9] = {in_svk, 0, 0, 0, in_svk, 0, 0, 0, in_svk}, of_neo[9] = {in_neo, 0, 0, 0, in_neo, 0, 0, 0, in_neo};

        stress_at(&svk, all, P);
        near_all(P, of_svk, 9, tolerance * (MODULUS + largest(of_svk, 9)));
        stress_at(&neo, all, P);
        near_all(P, of_neo, 9, tolerance * (MODULUS + largest(of_neo, 9)));
      }
    }
    ok(MaterialDestroy(&first));
    ok(MaterialDestroy(&second));
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stress_is_the_derivative_of_the_energy),
      cmocka_unit_test(tangent_is_the_derivative_of_the_stress),
      cmocka_unit_test(rotations_do_no_more_than_rotate),
      cmocka_unit_test(small_strains_are_linear_and_keep_their_digits),
      cmocka_unit_test(stress_and_energy_are_those_of_the_textbooks),
      cmocka_unit_test(energy_is_exact_where_its_logarithm_changes_form),
      cmocka_unit_test(points_of_a_batch_do_not_touch_each_other),
      cmocka_unit_test(inverted_points_are_not_defined),
      cmocka_unit_test(known_states_have_known_stresses),
      cmocka_unit_test(wave_modulus_is_that_of_the_tangent),
  };

  return impakt_main(argc, argv, tests);
}
