/* Mass matrices: by hand, their total, the massless contact layer, and what they do to waves. */
#include "support.h"
#include <body/layout/bodyimpl.h>

static const char *const types[]       = {"lumped", "consistent", "averaged"};
static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE};

/* M e for the unit vector e of the node at x = node, seen at x = 0, 1, 2 */
static void get_column(Body body, PetscInt node, PetscReal column[3])
{
  const PetscScalar *x;
  PetscScalar       *unit;
  PetscInt           n;
  Vec                positions, e, Me;

  ok(BodyGetReferencePositions(body, &positions));
  ok(VecDuplicate(positions, &e));
  ok(VecDuplicate(positions, &Me));
  ok(VecGetLocalSize(e, &n));
  ok(VecGetArrayRead(positions, &x));
  ok(VecGetArray(e, &unit));
  for (PetscInt i = 0; i < n; i++) unit[i] = PetscAbsReal(x[i] - node) < 1e-9;
  ok(VecRestoreArray(e, &unit));
  ok(VecRestoreArrayRead(positions, &x));
  ok(BodyMultiplyMass(body, e, Me));
  for (PetscInt i = 0; i < 3; i++) column[i] = value_at(body, Me, i);
  ok(VecDestroy(&e));
  ok(VecDestroy(&Me));
}

/* A bar of elements of length 1 m with 6 kg each, on whose last node nothing may rest where mass is moved */
static PetscOptions create_bar(Body *body, PetscInt elements, PetscInt type, PetscInt moved)
{
  const PetscReal end     = elements;
  PetscOptions    options = bar_create(
      body, "-dm_plex_box_faces %d -dm_plex_box_upper %d -density 3 -cross_section 2 -youngs_modulus 1 -mass_type %s -mass_redistribute %d",
      (int)elements, (int)elements, types[type], (int)moved);
  PetscBool redistributed;
  Rows      rows;

  set_rows(*body, 1, &end, &rows);
  ok(BodySetControllerStep(*body, 0, 0.1));
  ok(BodySetUp(*body));
  ok(BodyIsRedistributed(*body, &redistributed));
  assert_int_equal(redistributed, moved);
  return options;
}

/* An element has [2 1; 1 2] consistent, diag(3, 3) lumped, [2.5 0.5; 0.5 2.5] averaged */
static void is_that_found_by_hand(void **state)
{
  const PetscReal expected[3][3][3] = {
      {{3, 0, 0}, {0, 6, 0}, {0, 0, 3}}, {{2, 1, 0}, {1, 4, 1}, {0, 1, 2}}, {{2.5, 0.5, 0}, {0.5, 5, 0.5}, {0, 0.5, 2.5}}};

  (void)state;
  skip_beyond_ranks(2);
  for (PetscInt type = 0; type < 3; type++) {
    Body         body;
    PetscOptions options = create_bar(&body, 2, type, 0);
    PetscReal    column[3];

    for (PetscInt j = 0; j < 3; j++) {
      get_column(body, j, column);
      for (PetscInt i = 0; i < 3; i++) near(column[i], expected[type][i][j], 1e-14); /* round-off of 6 kg */
    }
    bar_destroy(&body, options);
  }
}

/* Three elements, without mass at x = 3: all 6 kg of the last one are at x = 2, and then a factor f = a + b x brings the centre of the 18
   kg back to x = 1.5. Lumped mass has the factor of its node: 3 f0 + 6 f1 + 9 f2 = 18 and 6 f1 + 18 f2 = 27 = 18 * 1.5. Consistent mass of
   an element has the mean factor of its inner nodes: the same total, and 3 (f0 + f1) / 2 + 9 (f1 + f2) / 2 + 12 f2 = 27. Averaged mass is
   the mean of both. */
static void keeps_its_centre_without_mass_at_an_end(void **state)
{
  const PetscReal slope[3] = {0.3, 3. / 7, 6. / 17}; /* and a = 1 - 4 b / 3 */

  (void)state;
  skip_beyond_ranks(3);
  for (PetscInt type = 0; type < 3; type++) {
    Body            body;
    PetscOptions    options     = create_bar(&body, 3, type, 1);
    const PetscReal f[3]        = {1 - 4 * slope[type] / 3, 1 - slope[type] / 3, 1 + 2 * slope[type] / 3};
    const PetscReal mean[2]     = {(f[0] + f[1]) / 2, (f[1] + f[2]) / 2};
    const PetscReal parts[2][9] = {
        {3 * f[0], 0, 0, 0, 6 * f[1], 0, 0, 0, 9 * f[2]},
        {2 * mean[0], mean[0], 0, mean[0], 2 * mean[0] + 2 * mean[1], mean[1], 0, mean[1], 2 * mean[1] + 6 * f[2]}};
    const PetscReal share = type == 0 ? 1 : type == 1 ? 0 : 0.5;
    PetscReal       column[3], least, largest, shift;

    for (PetscInt j = 0; j < 3; j++) {
      get_column(body, j, column);
      for (PetscInt i = 0; i < 3; i++) near(column[i], share * parts[0][3 * i + j] + (1 - share) * parts[1][3 * i + j], 1e-12);
    }
    get_column(body, 3, column);
    for (PetscInt i = 0; i < 3; i++) near(column[i], 0, 0);
    ok(BodyGetMassRedistribution(body, &least, &largest, &shift, NULL));
    near(least, f[0], 1e-12);
    near(largest, f[2], 1e-12);
    near(shift, 0, 0);
    bar_destroy(&body, options);
  }
}

/* Two elements: the 12 kg would have to be at x = 1 for their centre to stay. The factor at x = 0 is the least there is, 0.3; with lumped
   mass 0.9 kg are left there, and the centre is at 11.1 / 12. */
static void tells_where_its_centre_cannot_be_kept(void **state)
{
  Body         body;
  PetscOptions options;
  PetscReal    column[3], least, shift;

  (void)state;
  skip_beyond_ranks(2);
  options = create_bar(&body, 2, 0, 1);
  ok(BodyGetMassRedistribution(body, &least, NULL, &shift, NULL));
  near(least, 0.3, 0);
  near(shift, -0.9 / 12, 1e-13);
  get_column(body, 0, column);
  near(column[0], 0.9, 1e-13);
  get_column(body, 1, column);
  near(column[1], 11.1, 1e-12);
  bar_destroy(&body, options);
}

/* rho A L = 3 * 0.5 * 1.4 = 2.1 kg, with one or both ends massless or none; momentum and kinetic energy at 1 m/s */
static void adds_up_to_that_of_the_body(void **state)
{
  const PetscReal ends[] = {1.4, 0};

  (void)state;
  for (PetscInt n_ends = 0; n_ends < 3; n_ends++)
    for (PetscInt moved = 0; moved < 2; moved++)
      for (PetscInt type = 0; type < 3; type++) {
        Body         body;
        PetscOptions options = bar_create(&body,
                                          "-dm_plex_box_faces 7 -dm_plex_box_upper 1.4 -density 3 -cross_section 0.5 -youngs_modulus 1 "
                                          "-initial_velocity 1 -mass_type %s -mass_redistribute %d",
                                          types[type], (int)moved);
        BodyMeasures measures;
        PetscReal    mass;
        Rows         rows;

        if (n_ends) set_rows(body, n_ends, ends, &rows);
        ok(BodySetControllerStep(body, 0, 0.1));
        ok(BodySetUp(body));
        ok(BodyGetMass(body, &mass));
        ok(BodyGetMeasures(body, &measures));
        near(mass, 2.1, 1e-14); /* round-off of 21 additions */
        near(measures.momentum[0], 2.1, 1e-14);
        near(measures.mean_velocity[0], 1, 1e-14);
        near(measures.kinetic, 1.05, 1e-14);
        near(measures.potential, 0, 0);
        bar_destroy(&body, options);
      }
}

/* One element with both its nodes on contact surfaces: nowhere to put its mass */
static void is_refused_without_a_place_to_go(void **state)
{
  const PetscReal ends[] = {0, 1};
  Body            body;
  PetscOptions    options;
  PetscMPIInt     size;
  Rows            rows;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  if (size > 1) skip(); /* an error on the rank of the element alone; Impakt ends all ranks then */
  options = bar_create(&body, "-dm_plex_box_faces 1 -density 1 -youngs_modulus 1");
  set_rows(body, 2, ends, &rows);
  ok(BodySetControllerStep(body, 0, 0.1));
  refused(PETSC_ERR_USER_INPUT, "'bar'|contact surfaces|refine|-bar_mass_redistribute", BodySetUp(body));
  ok(BodyDestroy(&body));
  options_drop(options);
}

static PetscErrorCode FirstMode(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)ctx;
  u[0] = 1e-3 * PetscCosReal(PETSC_PI * x[0] / 2);
  v[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The frequency of the first axial mode, cos(pi x / L), of a free bar with L = 2 m, c = 3 m/s; exactly pi c / L.

   The mode is an eigenvector of the mesh too, so the end swings as cos(n phi) over the steps n, and the integrator's own error
   is known: tan(phi / 2) = omega dt / 2 for the trapezoidal rule, sin(phi / 2) = omega dt / 2 for central differences. What
   remains is the error of the mesh. Measured near a quarter period, where cos(n phi) is zero and acos is well conditioned. */
static PetscReal measure_frequency(const char type[], const char integrator[], PetscInt elements, PetscInt steps)
{
  const PetscReal dt = 2 / 3. / 2 / steps; /* a quarter period is L / (2 c) */
  Body            body;
  PetscOptions    options = bar_create(&body,
                                       "-dm_plex_box_faces %d -dm_plex_box_upper 2 -density 2 -youngs_modulus 18 -mass_type %s -ts_type %s",
                                       (int)elements, type, integrator);
  PetscReal       phi;
  Vec             u;

  ok(BodySetControllerStep(body, 0, dt));
  ok(BodySetUp(body));
  ok(BodySetInitialState(body, FirstMode, NULL));
  for (PetscInt k = 0; k < steps; k++) {
    ok(BodyIntegrate(body));
    ok(BodySave(body));
  }
  ok(BodyGetSolution(body, &u, NULL, NULL));
  phi = PetscAcosReal(value_at(body, u, 0) / 1e-3) / steps;
  bar_destroy(&body, options);
  return 2 / dt * (strcmp(integrator, TSALPHA2) ? PetscSinReal(phi / 2) : PetscTanReal(phi / 2));
}

/* With theta = pi / N: omega^2 = (c / h)^2 2 (1 - cos theta) / m, where m is 1 for lumped, (2 + cos theta) / 3 for consistent
   and (5 + cos theta) / 6 for averaged mass. Hence relative errors of -theta^2/24, theta^2/24 and -theta^4/480. */
static void gives_vibrations_their_order_in_space(void **state)
{
  (void)state;
  for (PetscInt type = 0; type < 3; type++)
    for (PetscInt i = 0; i < 2; i++) {
      PetscReal errors[3];

      for (PetscInt k = 0; k < 3; k++) {
        const PetscInt  elements = 6 << k;
        const PetscReal theta = PETSC_PI / elements, cosine = PetscCosReal(theta),
                        mass  = type == 0   ? 1
                                : type == 1 ? (2 + cosine) / 3
                                            : (5 + cosine) / 6;
        const PetscReal exact = 1.5 * PETSC_PI,
                        omega = measure_frequency(types[type], integrators[i], elements, 24); /* stable: 24 >= 12 sqrt(3) */

        near(omega, 3 * elements / 2. * PetscSqrtReal(2 * (1 - cosine) / mass), 1e-11); /* round-off of 24 steps, and of acos */
        errors[k] = omega / exact - 1;
      }
      /* the next term of the error is theta^2 times smaller: 0.27 times some hundredths for N = 6 */
      for (PetscInt k = 1; k < 3; k++) near(PetscLog2Real(errors[k - 1] / errors[k]), type == 2 ? 4 : 2, 0.05);
      assert_true(type == 1 ? errors[0] > 0 : errors[0] < 0);
    }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_that_found_by_hand),
      cmocka_unit_test(keeps_its_centre_without_mass_at_an_end),
      cmocka_unit_test(tells_where_its_centre_cannot_be_kept),
      cmocka_unit_test(adds_up_to_that_of_the_body),
      cmocka_unit_test(is_refused_without_a_place_to_go),
      cmocka_unit_test(gives_vibrations_their_order_in_space),
  };

  return impakt_main(argc, argv, tests);
}
