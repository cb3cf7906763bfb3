/* The plastic models at points: return map, tangents, history, what they refuse. */
#include "support.h"
#include <impakt/private/plastic.h>

#define YOUNG 117e9
#define YIELD 400e6
#define N     PLASTIC_SIZE_CENTRED

/* The laws that are tested, as options */
static const char *const models[] = {
    "-material_type j2 -yield_stress 400e6 -hardening_modulus 100e6",
    "-material_type j2 -yield_stress 400e6 -hardening_modulus 1e9 -kinematic_modulus 5e9",
    "-material_type j2 -yield_stress 400e6 -hardening voce -saturation_stress 600e6 -saturation_rate 20 -hardening_modulus 1e8",
    "-material_type j2 -hardening table -hardening_table 0,400e6,0.05,500e6,0.3,550e6",
    "-material_type johnson_cook -yield_stress 90e6 -hardening_modulus 292e6 -hardening_exponent 0.31 -rate_coefficient 0.025 "
    "-softening_exponent 1.09 -melting_temperature 1356 -specific_heat 383",
    "-material_type j2_small -yield_stress 400e6 -hardening_modulus 100e6 -kinematic_modulus 1e9",
};

static Material create(const char model[], MaterialKernels *kernels)
{
  PetscOptions options = options_begin("-density 8930 -youngs_modulus %.17g -poissons_ratio 0.35 %s", YOUNG, model);
  Material     material;

  ok(MaterialCreate(PETSC_COMM_SELF, &material));
  ok(MaterialSetFromOptions(material));
  ok(MaterialSetUp(material));
  ok(MaterialGetKernels(material, kernels));
  options_end(options);
  return material;
}

static PetscReal pseudo_random(uint32_t *seed)
{
  *seed = 1664525u * *seed + 1013904223u;
  return *seed / 2147483648. - 1;
}

/* One point, third of a batch whose other points are virgin and undeformed */
static void advance(const MaterialKernels *kernels, const PetscReal H[9], const PetscReal start[], PetscReal end[], PetscReal P[9])
{
  SimdReal h[9] = {{0}}, s[N] = {{0}}, e[N], p[9];

  for (int i = 0; i < 9; i++) h[i][2] = H[i];
  for (PetscInt i = 0; i < kernels->n_history; i++) s[i][2] = start[i];
  kernels->advance(kernels->data, 1e-6, (const PetscReal(*)[8])h, (const PetscReal(*)[8])s, e, p);
  for (int i = 0; i < 9; i++) P[i] = p[i][2];
  for (PetscInt i = 0; i < kernels->n_history && end; i++) end[i] = e[i][2];
}

/* By central differences of order 8. The bound is that of the models' requirement; what is seen is 2e-11 of Young's modulus. */
static void compare_tangent(const MaterialKernels *kernels, const PetscReal H[9], const PetscReal start[])
{
  const PetscReal weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280}, step = 2e-4;
  PetscReal       tangent[81], moved[9], P[9];

  kernels->advancetangent(kernels->data, 1e-6, H, start, tangent);
  for (int k = 0; k < 9; k++) {
    PetscReal derivative[9] = {0};

    for (int i = 0; i < 9; i++) moved[i] = H[i];
    for (int n = 0; n < 4; n++)
      for (int sign = -1; sign <= 1; sign += 2) {
        moved[k] = H[k] + sign * (n + 1) * step;
        advance(kernels, moved, start, NULL, P);
        for (int i = 0; i < 9; i++) derivative[i] += sign * weights[n] / step * P[i];
      }
    for (int i = 0; i < 9; i++) near(tangent[9 * i + k], derivative[i], 1e-8 * YOUNG);
  }
}

static void tangents_are_derivatives(void **state)
{
  /* two principal stretches are equal, and all three nearly so */
  const PetscReal repeated[9] = {0.12, 0, 0, 0, -0.04, 0, 0, 0, -0.04}, close[9] = {0.02, 1e-9, 0, 1e-9, 0.02 + 1e-9, 0, 0, 0, 0.02};
  const PetscReal none[N] = {0};
  uint32_t        seed    = 3;

  (void)state;
  for (size_t m = 0; m < PETSC_STATIC_ARRAY_LENGTH(models); m++) {
    MaterialKernels kernels;
    Material        material = create(models[m], &kernels);

    compare_tangent(&kernels, repeated, none);
    compare_tangent(&kernels, close, none);
    for (int path = 0; path < 5; path++) {
      PetscReal H[9] = {0}, history[N] = {0}, P[9];

      for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 9; i++) H[i] += 0.08 * pseudo_random(&seed);
        advance(&kernels, H, history, history, P);
      }
      for (int i = 0; i < 9; i++) H[i] += 0.03 * pseudo_random(&seed);
      assert_true(history[PLASTIC_STRAIN] > 0.01);
      compare_tangent(&kernels, H, history);
    }
    ok(MaterialDestroy(&material));
  }
}

/* A bar with free sides that is pulled to a logarithmic strain of 0.4 in so many steps: Newton's method for its width. Returns Kirchhoff's
   stress along it. */
static PetscReal pull(const MaterialKernels *kernels, PetscReal from, PetscReal to, int steps, PetscReal *across, PetscReal history[])
{
  PetscReal P[9], H[9] = {0}, tangent[81], start[N];

  for (int k = 1; k <= steps; k++) {
    for (int i = 0; i < N; i++) start[i] = history[i];
    H[0] = expm1(from + (to - from) * k / steps);
    for (int n = 0; n < 40; n++) {
      H[4] = H[8] = *across;
      advance(kernels, H, start, history, P);
      kernels->advancetangent(kernels->data, 1e-6, H, start, tangent);
      *across -= P[4] / (tangent[9 * 4 + 4] + tangent[9 * 4 + 8]);
    }
  }
  return P[0] * (1 + H[0]);
}

/* In a bar with free sides the logarithmic strain is that of a small-strain model: stress / E + plastic strain. The return map is exact
   along a straight path, however few the steps; 1e-9 is Newton's method of the test. */
static void bars_follow_the_hardening_curve(void **state)
{
  const PetscReal strain = 0.4;
  MaterialKernels kernels;

  (void)state;
  for (int steps = 1; steps < 30; steps += 14) {
    PetscReal history[N] = {0}, across = 0, stress, plastic;
    Material  material = create(models[0], &kernels);

    stress = pull(&kernels, 0, strain, steps, &across, history);
    near(stress, YIELD + 100e6 * (strain - YIELD / YOUNG) / (1 + 100e6 / YOUNG), 1e-9 * stress);
    plastic = strain - stress / YOUNG;
    near(history[PLASTIC_STRAIN], plastic, 1e-9);
    /* plastic work is the area under the hardening curve */
    near(history[PLASTIC_WORK], plastic * (YIELD + 0.5 * 100e6 * plastic), 1e-9 * history[PLASTIC_WORK]);
    ok(MaterialDestroy(&material));

    material = create(models[3], &kernels);
    for (int i = 0; i < N; i++) history[i] = 0;
    across  = 0;
    stress  = pull(&kernels, 0, strain, steps, &across, history);
    plastic = strain - stress / YOUNG;
    near(stress, 550e6, 1e-9 * stress); /* beyond the end of the table */
    near(history[PLASTIC_STRAIN], plastic, 1e-9);
    ok(MaterialDestroy(&material));

    material = create(models[2], &kernels);
    for (int i = 0; i < N; i++) history[i] = 0;
    across  = 0;
    stress  = pull(&kernels, 0, strain, steps, &across, history);
    plastic = strain - stress / YOUNG;
    near(stress, 600e6 - 200e6 * exp(-20 * plastic) + 1e8 * plastic, 1e-9 * stress);
    ok(MaterialDestroy(&material));
  }
}

/* Pulled and pressed back: the elastic range stays twice the strength, and its centre has moved (Bauschinger's effect) */
static void kinematic_hardening_moves_the_elastic_range(void **state)
{
  PetscReal       history[N] = {0}, across = 0, pulled, pressed;
  MaterialKernels kernels;
  Material        material = create("-material_type j2 -yield_stress 400e6 -kinematic_modulus 2e9", &kernels);

  (void)state;
  pulled = pull(&kernels, 0, 0.1, 10, &across, history);
  near(pulled, YIELD + 2e9 * history[PLASTIC_STRAIN], 1e-9 * pulled);
  {
    const PetscReal strain = history[PLASTIC_STRAIN], yields = (2 * YIELD) / YOUNG;

    pressed = pull(&kernels, 0.1, 0.1 - 0.99 * yields, 3, &across, history);
    near(history[PLASTIC_STRAIN], strain, 1e-15);
    pressed = pull(&kernels, 0.1 - 0.99 * yields, 0.1 - 1.5 * yields, 3, &across, history);
    near(history[PLASTIC_STRAIN], strain + 0.5 * yields / (1 + 2e9 / YOUNG), 1e-9);
    near(pressed, pulled - 2 * YIELD - 2e9 * (history[PLASTIC_STRAIN] - strain), 1e-9 * YIELD);
  }
  ok(MaterialDestroy(&material));
}

/* Johnson and Cook's strength at the rate of the step, with the temperature that earlier steps have left */
static void johnson_cook_knows_rate_and_heat(void **state)
{
  PetscReal       history[N] = {0}, across = 0, stress, before, strain, work, expected;
  MaterialKernels kernels;
  Material        material = create(models[4], &kernels);

  (void)state;
  pull(&kernels, 0, 0.3, 30, &across, history);
  strain   = history[PLASTIC_STRAIN];
  work     = history[PLASTIC_WORK];
  before   = strain;
  stress   = pull(&kernels, 0.3, 0.31, 1, &across, history);
  strain   = history[PLASTIC_STRAIN];
  expected = (90e6 + 292e6 * pow(strain, 0.31)) * (1 + 0.025 * log((strain - before) / 1e-6)) *
             (1 - pow(0.9 * work / (8930 * 383) / (1356 - 293), 1.09));
  near(stress, expected, 1e-9 * expected);
  assert_true(work > 0.3 * 200e6 && stress > 300e6);
  ok(MaterialDestroy(&material));
}

/* Stored energy at a point [J/m^3] */
static PetscReal stored(const MaterialKernels *kernels, const PetscReal H[9], const PetscReal history[])
{
  SimdReal h[9] = {{0}}, s[N] = {{0}}, w;

  for (int i = 0; i < 9; i++) h[i][2] = H[i];
  for (PetscInt i = 0; i < kernels->n_history; i++) s[i][2] = history[i];
  kernels->hold(kernels->data, (const PetscReal(*)[8])h, (const PetscReal(*)[8])s, w, NULL);
  return w[2];
}

/* Work of the mean of the stresses at both ends of each step, less what is stored and what flow takes of it, on a way there and half of it
   back [J/m^3]; `work`: the first of these */
static PetscReal missing_of_mean_stress(const MaterialKernels *kernels, const PetscReal far[9], int steps, PetscReal *work)
{
  PetscReal history[N] = {0}, H[9] = {0}, P[9] = {0};

  *work = 0;
  for (int k = 1; k <= steps; k++) {
    const PetscReal at = 1 - fabs(1 - 1.5 * k / steps);
    PetscReal       last[9], before[9];

    for (int i = 0; i < 9; i++) {
      last[i]   = H[i];
      before[i] = P[i];
      H[i]      = at * far[i];
    }
    advance(kernels, H, history, history, P);
    for (int i = 0; i < 9; i++) *work += 0.5 * (before[i] + P[i]) * (H[i] - last[i]);
  }
  return *work - stored(kernels, H, history) - history[kernels->taken];
}

/* What the mean stress of each step does is stored or taken: at small strain, where the stored energy is a quadratic function, to round-off
   in any step, with yield and reversal within steps; at finite strain to the second order of the step */
static void mean_stress_is_stored_or_taken(void **state)
{
  uint32_t seed = 7;

  (void)state;
  for (size_t m = 0; m < PETSC_STATIC_ARRAY_LENGTH(models); m++) {
    MaterialKernels kernels;
    Material        material = create(models[m], &kernels);
    PetscReal       far[9], work, coarse, fine;

    for (int i = 0; i < 9; i++) far[i] = 0.05 * pseudo_random(&seed);
    coarse = missing_of_mean_stress(&kernels, far, 30, &work);
    if (m == 5) near(coarse, 0, 1e-13 * work);
    fine = missing_of_mean_stress(&kernels, far, 60, &work);
    assert_true(fabs(coarse) < 2e-3 * work && fabs(fine) < 0.3 * fabs(coarse) + 1e-13 * work);
    ok(MaterialDestroy(&material));
  }
}

/* Turned as a whole after it has flowed: the stress turns with it and nothing flows, to round-off; the same stress whether the logarithm is
   that of the series or, in a batch with another point far away, of eigenvalues */
static void rotation_does_nothing(void **state)
{
  uint32_t seed = 5;

  (void)state;
  for (size_t m = 0; m < 4; m++) { /* Johnson and Cook's law goes on flowing until the stress is that of slow flow */
    MaterialKernels kernels;
    Material        material = create(models[m], &kernels);
    PetscReal       H[9], history[N] = {0}, after[N], P[9], turned[9], T[9];
    const PetscReal c = cos(2.), s = sin(2.), Q[9] = {c, -s, 0, s, c, 0, 0, 0, 1};

    for (int i = 0; i < 9; i++) H[i] = 0.1 * pseudo_random(&seed);
    advance(&kernels, H, history, history, P);
    for (int i = 0; i < 9; i++) H[i] *= 0.999; /* back into the elastic range */
    advance(&kernels, H, history, history, P);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        turned[3 * i + j] = i == j ? -1 : 0;
        for (int k = 0; k < 3; k++) turned[3 * i + j] += Q[3 * i + k] * (H[3 * k + j] + (k == j ? 1 : 0));
      }
    advance(&kernels, turned, history, after, T);
    for (int i = 0; i < kernels.n_history; i++)
      near(after[i], history[i], i >= PLASTIC_STRESS && i < PLASTIC_STRESS + 6 ? 1e-13 * YOUNG : 0);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) near(T[3 * i + j], Q[3 * i] * P[j] + Q[3 * i + 1] * P[3 + j] + Q[3 * i + 2] * P[6 + j], 1e-13 * YOUNG);
    ok(MaterialDestroy(&material));
  }
}

/* Large elastic strains, for which the series does not serve: the stress is the derivative of the stored energy */
static void elastic_stress_is_the_derivative_of_the_energy(void **state)
{
  const PetscReal weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280}, step = 1e-3;
  uint32_t        seed = 9;

  (void)state;
  for (int point = 0; point < 12; point++) {
    MaterialKernels kernels;
    Material        material = create("-material_type j2 -yield_stress 1e30", &kernels);
    SimdReal        h[9], p[9], w;
    PetscReal       size = point % 2 ? 0.4 : 0.03;

    for (int i = 0; i < 9; i++) {
      const PetscReal entry = size * pseudo_random(&seed);

      for (int k = 0; k < 8; k++) h[i][k] = entry;
    }
    for (int k = 0; k < 9; k++) {
      PetscReal derivative = 0, entry = h[k][0];

      for (int n = 0; n < 4; n++)
        for (int sign = -1; sign <= 1; sign += 2) {
          h[k][0] = entry + sign * (n + 1) * step;
          kernels.energy(kernels.data, (const PetscReal(*)[8])h, w);
          derivative += sign * weights[n] / step * w[0];
        }
      h[k][0] = entry;
      kernels.stress(kernels.data, (const PetscReal(*)[8])h, p);
      near(p[k][0], derivative, 1e-11 * YOUNG);
    }
    ok(MaterialDestroy(&material));
  }
}

/* An inverted point, and one whose strain is beyond all numbers, have no stress. Small strains know no inversion. */
static void hopeless_points_are_told(void **state)
{
  static const char *const small[] = {
      "-material_type j2_small -yield_stress 400e6 -hardening_modulus 100e6",
      "-material_type j2_small -hardening voce -yield_stress 400e6 -saturation_stress 600e6 -saturation_rate 20",
      "-material_type j2_small -hardening table -hardening_table 0,400e6,0.05,500e6,0.3,550e6",
  };
  const PetscReal inverted[9] = {-2, 0, 0, 0, 0, 0, 0, 0, 0}, beyond[9] = {1e200, 0, 0, 0, 0, 0, 0, 0, 0};

  (void)state;
  for (size_t m = 0; m < 5 + PETSC_STATIC_ARRAY_LENGTH(small); m++) {
    MaterialKernels kernels;
    Material        material   = create(m < 5 ? models[m] : small[m - 5], &kernels);
    PetscReal       history[N] = {0}, P[9];

    advance(&kernels, inverted, history, history, P);
    if (m < 5) assert_true(isnan(P[0]));
    for (int i = 0; i < N; i++) history[i] = 0;
    advance(&kernels, beyond, history, history, P);
    assert_true(!isfinite(P[0]));
    ok(MaterialDestroy(&material));
  }
}

/* Where no growth of the plastic strain meets the law, which takes constants of no metal, there is no stress */
static void flow_that_is_not_found_is_told(void **state)
{
  static const char *const laws[] = {
      "-material_type johnson_cook -yield_stress 90e6 -hardening_modulus 1e300 -hardening_exponent 0.31 -rate_coefficient 1e300 "
      "-softening_exponent 1.09 -melting_temperature 1356 -specific_heat 383",
      "-material_type j2 -yield_stress 400e6 -hardening voce -saturation_stress 1e300 -saturation_rate 1e300",
  };
  const PetscReal sheared[9] = {0, 0.1, 0, 0, 0, 0, 0, 0, 0}, hardly[9] = {0, 1e-4, 0, 0, 0, 0, 0, 0, 0};

  (void)state;
  for (size_t m = 0; m < PETSC_STATIC_ARRAY_LENGTH(laws); m++) {
    MaterialKernels kernels;
    Material        material   = create(laws[m], &kernels);
    PetscReal       history[N] = {0}, P[9];

    advance(&kernels, hardly, history, NULL, P);
    assert_true(isfinite(P[1]));
    advance(&kernels, sheared, history, NULL, P);
    assert_true(isnan(P[1]));
    ok(MaterialDestroy(&material));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tangents_are_derivatives),
      cmocka_unit_test(bars_follow_the_hardening_curve),
      cmocka_unit_test(kinematic_hardening_moves_the_elastic_range),
      cmocka_unit_test(johnson_cook_knows_rate_and_heat),
      cmocka_unit_test(mean_stress_is_stored_or_taken),
      cmocka_unit_test(rotation_does_nothing),
      cmocka_unit_test(elastic_stress_is_the_derivative_of_the_energy),
      cmocka_unit_test(hopeless_points_are_told),
      cmocka_unit_test(flow_that_is_not_found_is_told),
  };

  return impakt_main(argc, argv, tests);
}
