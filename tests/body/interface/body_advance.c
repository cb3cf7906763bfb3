/* long: 3 */
/* Integrating a body: conservation, bitwise repetition, prescribed rows and reactions. */
#include "support.h"

static const char *const types[]       = {"lumped", "consistent", "averaged"};
static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE};

/* E A = 2 N, rho A = 0.5 kg/m, so c = 2 m/s; two metres in 8 elements: stable up to 0.072 s with consistent mass */
#define BAR "-dm_plex_box_faces 8 -dm_plex_box_upper 2 -density 1 -youngs_modulus 4 -cross_section 0.5 "
static const PetscReal ends[] = {2, 0};

static PetscErrorCode Wave(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)ctx;
  u[0] = 1e-2 * PetscSinReal(2 * x[0] + 1);
  v[0] = 0.3 * PetscCosReal(3 * x[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 1 kg at 3 m/s: 4.5 J, 3 kg m/s, and nothing strains it. 300 steps with a massless end, as between two impacts */
static void flies_freely(void **state)
{
  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt type = 0; type < 3; type++)
      for (PetscInt i = 0; i < 2; i++) {
        Body         body;
        PetscOptions options = bar_create(&body, BAR "-initial_velocity 3 -mass_type %s -ts_type %s -mass_redistribute %d", types[type],
                                          integrators[i], (int)moved);
        BodyMeasures measures;
        Rows         rows;
        Vec          u;

        set_rows(body, 1, ends, &rows);
        ok(BodySetControllerStep(body, 0, 0.05));
        ok(BodySetUp(body));
        for (PetscInt k = 0; k < 300; k++) {
          ok(BodyIntegrate(body));
          ok(BodySave(body));
        }
        ok(BodyGetMeasures(body, &measures));
        ok(BodyGetSolution(body, &u, NULL, NULL));
        /* it flies 45 m, stored to 3e-14 m: errors that act as forces of 2e-13 N (E A / h = 8 N/m) over 15 s, 3e-12 N s if all
           had one sign */
        near(measures.momentum[0], 3, 3e-11);
        near(measures.kinetic, 4.5, 1e-10); /* 3 m/s times that, and a margin */
        near(measures.potential, 0, 1e-10); /* sum of 45 m times forces of 2e-13 N, halved */
        near(value_at(body, u, 0), 45, 1e-10);
        near(value_at(body, u, 2), 45, 1e-10);
        bar_destroy(&body, options);
      }
}

/* A free bar that vibrates: energy (staggered under central differences) to round-off, momentum too */
static void conserves_energy_in_vibration(void **state)
{
  (void)state;
  for (PetscInt type = 0; type < 3; type++)
    for (PetscInt i = 0; i < 2; i++) {
      Body         body;
      PetscOptions options = bar_create(&body, BAR "-mass_type %s -ts_type %s", types[type], integrators[i]);
      BodyMeasures start, end;

      ok(BodySetControllerStep(body, 0, 0.05));
      ok(BodySetUp(body));
      ok(BodySetInitialState(body, Wave, NULL));
      ok(BodyGetMeasures(body, &start));
      assert_true(start.potential > 1e-5 && start.kinetic > 1e-2);
      for (PetscInt k = 0; k < 400; k++) {
        ok(BodyIntegrate(body));
        ok(BodySave(body));
      }
      ok(BodyGetMeasures(body, &end));
      /* energy 0.02 J, velocities 0.3 m/s: 400 steps of some 1e-16 of them; 1.3e-14 was measured */
      near(end.kinetic + end.potential, start.kinetic + start.potential, 1e-13);
      near(end.momentum[0], start.momentum[0], 1e-13);
      bar_destroy(&body, options);
    }
}

/* Fills the input traces with something that depends on `seed` */
static void write_inputs(const Rows *rows, const BodyTraces *traces, PetscInt substeps, PetscInt seed)
{
  for (PetscInt level = 0; level <= substeps; level++)
    for (PetscInt which = 0; which < rows->n; which++) {
      set_level(rows, traces->displacement_in, level, which, 1e-2 * PetscSinReal(1 + seed + 0.1 * level + which));
      set_level(rows, traces->velocity_in, level, which, 0.1 * PetscCosReal(2 * seed + 0.2 * level + which));
      set_level(rows, traces->acceleration_in, level, which, PetscCosReal(3 * seed + 0.3 * level + which));
      set_level(rows, traces->force_in, level, which, PetscSinReal(4 * seed + 0.4 * level + which));
    }
}

/* Everything that an integration makes: state, reactions, traces at the end */
typedef struct {
  PetscReal u[9], v[9], a[9], traces[4][2];
} Result;

static Result get_result(Body body, const Rows *rows, PetscInt substeps)
{
  Result     result;
  BodyTraces traces;
  Vec        u, v, a;

  ok(BodyGetSolution(body, &u, &v, &a));
  ok(BodyGetTraces(body, &traces));
  for (PetscInt i = 0; i < 9; i++) {
    result.u[i] = value_at(body, u, 0.25 * i);
    result.v[i] = value_at(body, v, 0.25 * i);
    result.a[i] = value_at(body, a, 0.25 * i);
  }
  for (PetscInt which = 0; which < 2; which++) {
    result.traces[0][which] = get_level(rows, traces.displacement, substeps, which);
    result.traces[1][which] = get_level(rows, traces.velocity, substeps, which);
    result.traces[2][which] = get_level(rows, traces.acceleration, substeps, which);
    result.traces[3][which] = get_level(rows, traces.reaction, substeps, which);
  }
  return result;
}

/* The same window twice, with others tried in between; with 1 and 7 substeps; for a body under way; and kept results come back */
static void repeats_a_window_bit_for_bit(void **state)
{
  const BodyCondition conditions[3][2] = {
      {BODY_PRESCRIBED, BODY_FORCED},
      {BODY_FORCED, BODY_FREE},
      {BODY_PRESCRIBED, BODY_PRESCRIBED},
  };

  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt i = 0; i < 2; i++)
      for (PetscInt substeps = 1; substeps <= 7; substeps += 6) {
        Body         body;
        PetscOptions options = bar_create(&body, BAR "-ts_type %s -ts_time_step %.17g -mass_redistribute %d", integrators[i], 0.05,
                                          (int)moved);
        Result       first, again, other;
        BodyTraces   traces;
        Rows         rows;

        set_rows(body, 2, ends, &rows);
        ok(BodySetControllerStep(body, 0, 0.05 * substeps));
        ok(BodySetUp(body));
        ok(BodySetInitialState(body, Wave, NULL));
        ok(BodyGetTraces(body, &traces));
        for (PetscInt k = 0; k < 3; k++) {
          ok(BodyIntegrate(body));
          ok(BodySave(body));
        }
        set_conditions(body, &rows, conditions[0]);
        write_inputs(&rows, &traces, substeps, 1);
        ok(BodyIntegrate(body));
        first = get_result(body, &rows, substeps);
        ok(BodyKeep(body));

        set_conditions(body, &rows, conditions[1]);
        write_inputs(&rows, &traces, substeps, 2);
        ok(BodyIntegrate(body));
        set_conditions(body, &rows, conditions[2]);
        ok(BodyRestore(body));
        ok(BodyIntegrate(body));
        other = get_result(body, &rows, substeps);
        assert_memory_not_equal(&first, &other, sizeof(first));

        set_conditions(body, &rows, conditions[0]);
        write_inputs(&rows, &traces, substeps, 1);
        ok(BodyIntegrate(body));
        again = get_result(body, &rows, substeps);
        assert_memory_equal(&first, &again, sizeof(first));

        set_conditions(body, &rows, conditions[1]);
        write_inputs(&rows, &traces, substeps, 3);
        ok(BodyIntegrate(body));
        ok(BodyReinstate(body));
        again = get_result(body, &rows, substeps);
        assert_memory_equal(&first, &again, sizeof(first));

        /* a reinstated end can be the start of the next window, as the end itself can: twice the same */
        ok(BodySave(body));
        ok(BodyIntegrate(body));
        first = get_result(body, &rows, substeps);
        ok(BodyIntegrate(body));
        again = get_result(body, &rows, substeps);
        assert_memory_equal(&first, &again, sizeof(first));
        bar_destroy(&body, options);
      }
}

/* At every substep, displacement and, on nodes with mass, velocity and acceleration too */
static void follows_the_prescribed_trace(void **state)
{
  const BodyCondition conditions[] = {BODY_PRESCRIBED, BODY_FREE};

  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt type = 0; type < 3; type++)
      for (PetscInt i = 0; i < 2; i++) {
        Body         body;
        PetscOptions options = bar_create(&body, BAR "-mass_type %s -ts_type %s -ts_time_step 0.05 -mass_redistribute %d", types[type],
                                          integrators[i], (int)moved);
        BodyTraces   traces;
        Rows         rows;

        set_rows(body, 2, ends, &rows);
        ok(BodySetControllerStep(body, 0, 0.25));
        ok(BodySetUp(body));
        ok(BodyGetTraces(body, &traces));
        set_conditions(body, &rows, conditions);
        write_inputs(&rows, &traces, 5, 1);
        ok(BodyIntegrate(body));
        for (PetscInt level = 1; level <= 5; level++) {
          /* displacements of 1e-2: a few units in the last place of the constraint's solution */
          near(get_level(&rows, traces.displacement, level, 0), get_level(&rows, traces.displacement_in, level, 0), 1e-16);
          if (moved) continue;
          near(get_level(&rows, traces.velocity, level, 0), get_level(&rows, traces.velocity_in, level, 0), 1e-15);
          near(get_level(&rows, traces.acceleration, level, 0), get_level(&rows, traces.acceleration_in, level, 0), 1e-14);
        }
        bar_destroy(&body, options);
      }
}

/* The end at 2 m is pushed in by d, d (t/T - sin(2 pi t/T) / (2 pi)), without jump in velocity or acceleration, in 50 times the
   1 s that a wave needs to go through the bar; the other end is held. Then the reactions are -+ E A d / L */
static void reacts_to_slow_compression(void **state)
{
  const BodyCondition conditions[] = {BODY_PRESCRIBED, BODY_PRESCRIBED};
  const PetscReal     d = 1e-2, force = 2 * d / 2, duration = 50;
  const PetscInt      steps = 1000;

  (void)state;
  for (PetscInt type = 0; type < 3; type++)
    for (PetscInt i = 0; i < 2; i++) {
      Body         body;
      PetscOptions options = bar_create(&body, BAR "-mass_type %s -ts_type %s", types[type], integrators[i]);
      BodyTraces   traces;
      BodyMeasures measures;
      Rows         rows;
      Vec          u;

      set_rows(body, 2, ends, &rows);
      ok(BodySetControllerStep(body, 0, duration / steps));
      ok(BodySetUp(body));
      ok(BodyGetTraces(body, &traces));
      set_conditions(body, &rows, conditions);
      for (PetscInt k = 1; k <= steps; k++) {
        const PetscReal t = (PetscReal)k / steps;

        set_level(&rows, traces.displacement_in, 0, 0, get_level(&rows, traces.displacement, 0, 0));
        set_level(&rows, traces.displacement_in, 1, 0, -d * (t - PetscSinReal(2 * PETSC_PI * t) / (2 * PETSC_PI)));
        ok(BodyIntegrate(body));
        ok(BodySave(body));
      }
      /* what is left of waves: some (2 pi)^2 / (omega T)^3 of d, with omega = pi c / L = 3.1 rad/s, 1e-5; 2.3e-5 was measured */
      near(get_level(&rows, traces.reaction, 1, 0), -force, 5e-5 * force);
      near(get_level(&rows, traces.reaction, 1, 1), force, 5e-5 * force);
      ok(BodyGetSolution(body, &u, NULL, NULL));
      for (PetscInt n = 0; n <= 8; n++) near(value_at(body, u, 0.25 * n), -d * n / 8, 5e-5 * d);
      ok(BodyGetMeasures(body, &measures));
      near(measures.potential, 0.5 * force * d, 1e-4 * 0.5 * force * d); /* a square */
      bar_destroy(&body, options);
    }
}

/* One implicit step of 1e4 s, where inertia is 4 M / dt^2, 1e-8 of the stiffness, leaves the static solution. With a force on the
   free end instead: it moves by F L / (E A), and the held one reacts with -F */
static void solves_statics_in_one_large_step(void **state)
{
  const BodyCondition conditions[] = {BODY_FORCED, BODY_PRESCRIBED};
  Body                body;
  PetscOptions        options = bar_create(&body, BAR);
  BodyTraces          traces;
  Rows                rows;

  (void)state;
  set_rows(body, 2, ends, &rows);
  ok(BodySetControllerStep(body, 0, 1e4));
  ok(BodySetUp(body));
  ok(BodyGetTraces(body, &traces));
  set_conditions(body, &rows, conditions);
  for (PetscInt level = 0; level < 2; level++) set_level(&rows, traces.force_in, level, 0, 0.03);
  ok(BodyIntegrate(body));
  /* 1e-8 by inertia, and as much by round-off: the free body's matrix has a condition number of about 1e9 */
  near(get_level(&rows, traces.displacement, 1, 0), 0.03, 1e-6 * 0.03);
  near(get_level(&rows, traces.reaction, 1, 1), -0.03, 1e-6 * 0.03);
  bar_destroy(&body, options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flies_freely),
      cmocka_unit_test(conserves_energy_in_vibration),
      cmocka_unit_test(repeats_a_window_bit_for_bit),
      cmocka_unit_test(follows_the_prescribed_trace),
      cmocka_unit_test(reacts_to_slow_compression),
      cmocka_unit_test(solves_statics_in_one_large_step),
  };

  return impakt_main(argc, argv, tests);
}
