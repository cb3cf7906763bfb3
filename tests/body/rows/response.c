/* long: 3 */
/* The response of a body to unit inputs on its rows, and the shortcut that it gives repeated sweeps. */
#include "support.h"

/* E A = 2 N, c = 2 m/s; two metres in 6 elements */
#define BAR "-dm_plex_box_faces 6 -dm_plex_box_upper 2 -density 1 -youngs_modulus 4 -cross_section 0.5 "
#define DT  0.08 /* stable: h / c = 1/6 s with lumped mass, 0.136 s with averaged */
static const PetscReal     ends[]          = {2, 0};
static const char *const   integrators[]   = {TSALPHA2, TSCENTRALDIFFERENCE};
static const BodyCondition conditions[][2] = {
    {BODY_PRESCRIBED, BODY_FORCED}, {BODY_FORCED, BODY_PRESCRIBED}, {BODY_PRESCRIBED, BODY_PRESCRIBED}, {BODY_FORCED, BODY_FORCED},
    {BODY_PRESCRIBED, BODY_FREE},   {BODY_ROBIN, BODY_FORCED},      {BODY_PRESCRIBED, BODY_ROBIN},
};
/* Springs of Robin rows [N/m]: about the stiffness of an element, E A / h = 6 N/m, with which explicit bodies are stable */
static const PetscReal robin[] = {5, 7};

static PetscErrorCode Wave(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)ctx;
  u[0] = 1e-2 * PetscSinReal(2 * x[0] + 1);
  v[0] = 0.3 * PetscCosReal(3 * x[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body under way, one window after its start, with conditions and smooth inputs */
static PetscOptions create_body(Body *body, Rows *rows, BodyTraces *traces, const char integrator[], const char mass[], PetscInt moved,
                                PetscInt substeps, const BodyCondition condition[])
{
  PetscOptions options = bar_create(body, BAR "-ts_type %s -ts_time_step %.17g -mass_type %s -mass_redistribute %d", integrator, DT, mass,
                                    (int)moved);

  set_rows(*body, 2, ends, rows);
  ok(BodySetControllerStep(*body, 0, DT * substeps));
  ok(BodySetUp(*body));
  ok(BodySetInitialState(*body, Wave, NULL));
  ok(BodyGetTraces(*body, traces));
  ok(BodyIntegrate(*body));
  ok(BodySave(*body));
  set_robin(*body, rows, robin);
  set_conditions(*body, rows, condition);
  return options;
}

/* Inputs that ramp over the window, from where the body is to something else */
static void write_inputs(const Rows *rows, const BodyTraces *traces, PetscInt substeps, PetscInt seed)
{
  const Trace in[]  = {traces->displacement_in, traces->velocity_in, traces->acceleration_in, traces->force_in},
              out[] = {traces->displacement, traces->velocity, traces->acceleration, traces->reaction};

  for (PetscInt kind = 0; kind < 4; kind++)
    for (PetscInt which = 0; which < 2; which++) {
      const PetscReal start = get_level(rows, out[kind], 0, which), change = 1e-2 * PetscSinReal(1 + kind + 3 * which + 5 * seed);

      for (PetscInt level = 0; level <= substeps; level++) set_level(rows, in[kind], level, which, start + change * level / substeps);
    }
}

/* Adds a unit input, in the way of BodyComputeResponse(): a ramp, with its slope where velocity is prescribed */
static void add_unit(const Rows *rows, const BodyTraces *traces, PetscInt substeps, PetscInt which, BodyCondition condition)
{
  Trace in = condition == BODY_PRESCRIBED ? traces->displacement_in : traces->force_in;

  for (PetscInt level = 1; level <= substeps; level++) {
    set_level(rows, in, level, which, get_level(rows, in, level, which) + (PetscReal)level / substeps);
    if (condition == BODY_PRESCRIBED && substeps > 1)
      set_level(rows, traces->velocity_in, level, which, get_level(rows, traces->velocity_in, level, which) + 1 / (DT * substeps));
  }
}

static void get_outputs(const Rows *rows, const BodyTraces *traces, PetscInt substeps, const BodyCondition condition[],
                        PetscReal outputs[2])
{
  for (PetscInt which = 0; which < 2; which++)
    outputs[which] = get_level(
        rows, condition[which] == BODY_PRESCRIBED || condition[which] == BODY_ROBIN ? traces->reaction : traces->displacement, substeps,
        which);
}

/* The body is linear: the difference that a unit input makes is exact from any state, but for round-off */
static void is_the_difference_that_a_unit_makes(void **state)
{
  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt i = 0; i < 2; i++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3)
        for (size_t c = 0; c < sizeof(conditions) / sizeof(conditions[0]); c++) {
          Body               body;
          BodyTraces         traces;
          Rows               rows;
          PetscOptions       options = create_body(&body, &rows, &traces, integrators[i], "averaged", moved, substeps, conditions[c]);
          PetscReal          before[2], after[2][2], largest = 0;
          const PetscScalar *matrix;

          write_inputs(&rows, &traces, substeps, 1);
          ok(BodyIntegrate(body));
          get_outputs(&rows, &traces, substeps, conditions[c], before);
          for (PetscInt which = 0; which < 2; which++) {
            write_inputs(&rows, &traces, substeps, 1);
            if (conditions[c][which] != BODY_FREE) add_unit(&rows, &traces, substeps, which, conditions[c][which]);
            ok(BodyIntegrate(body));
            get_outputs(&rows, &traces, substeps, conditions[c], after[which]);
          }
          ok(BodyComputeResponse(body, &matrix));
          for (PetscInt k = 0; k < 4; k++) largest = PetscMax(largest, PetscAbsReal(matrix[k]));
          for (PetscInt which = 0; which < 2; which++)
            for (PetscInt to = 0; to < 2; to++)
              near(matrix[rows.row[which] * 2 + rows.row[to]], after[which][to] - before[to], 1e-12 * PetscMax(largest, 1));
          bar_destroy(&body, options);
        }
}

/* A linear body answers the same at rest, asked before its first step, as under way */
static void does_not_depend_on_when_it_is_asked_for(void **state)
{
  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt i = 0; i < 2; i++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        Body               rest, moving;
        BodyTraces         traces;
        Rows               rows, rest_rows;
        const PetscScalar *first, *second;
        PetscOptions other, options = create_body(&moving, &rows, &traces, integrators[i], "averaged", moved, substeps, conditions[0]);

        ok(BodyComputeResponse(moving, &second));
        other = bar_create(&rest, BAR "-ts_type %s -ts_time_step %.17g -mass_type averaged -mass_redistribute %d", integrators[i], DT,
                           (int)moved);
        set_rows(rest, 2, ends, &rest_rows);
        ok(BodySetControllerStep(rest, 0, DT * substeps));
        ok(BodySetUp(rest));
        set_conditions(rest, &rest_rows, conditions[0]);
        ok(BodyComputeResponse(rest, &first));
        /* the very same arithmetic; the largest number is about E A / h = 6 N/m, or M / dt^2 */
        for (PetscInt in = 0; in < 2; in++)
          for (PetscInt out = 0; out < 2; out++)
            near(first[2 * rest_rows.row[in] + rest_rows.row[out]], second[2 * rows.row[in] + rows.row[out]], 1e-13);
        bar_destroy(&rest, other);
        bar_destroy(&moving, options);
      }
}

/* Reciprocity: a symmetric body with both ends loaded has a symmetric compliance, positive on the diagonal */
static void is_symmetric_for_forces(void **state)
{
  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    Body               body;
    BodyTraces         traces;
    Rows               rows;
    PetscOptions       options = create_body(&body, &rows, &traces, integrators[i], "averaged", 1, 4, conditions[3]);
    const PetscScalar *matrix;

    ok(BodyComputeResponse(body, &matrix));
    near(matrix[1], matrix[2], 1e-13);
    near(matrix[0], matrix[3], 1e-13); /* mirrored; numbers of the order of h / (E A) = 0.17 m/N */
    /* a massless end node moves at least as a spring of one element: h / (E A) = 1/6 m/N */
    assert_true(matrix[0] >= (1 - 1e-12) / 6);
    bar_destroy(&body, options);
  }
}

/* Probing leaves the body as it was, bit for bit: state, and traces in and out */
static void leaves_no_trace(void **state)
{
  (void)state;
  for (PetscInt i = 0; i < 2; i++)
    for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
      Body               body;
      BodyTraces         traces;
      Rows               rows;
      PetscOptions       options = create_body(&body, &rows, &traces, integrators[i], "averaged", 1, substeps, conditions[0]);
      const PetscScalar *matrix;
      PetscReal          before[2][21], *values, norm;
      Vec                vec[3], copy[3];

      write_inputs(&rows, &traces, substeps, 1);
      ok(BodyIntegrate(body));
      ok(BodyGetSolution(body, &vec[0], &vec[1], &vec[2]));
      for (PetscInt k = 0; k < 3; k++) {
        ok(VecDuplicate(vec[k], &copy[k]));
        ok(VecCopy(vec[k], copy[k]));
      }
      for (PetscInt pass = 0; pass < 2; pass++) {
        const Trace all[] = {traces.displacement_in, traces.velocity_in, traces.acceleration_in, traces.force_in,
                             traces.displacement,    traces.velocity,    traces.acceleration,    traces.reaction};

        values = before[pass];
        for (PetscInt t = 0; t < 8; t++)
          for (PetscInt which = 0; which < 2; which++) *values++ = get_level(&rows, all[t], substeps, which);
        if (!pass) ok(BodyComputeResponse(body, &matrix));
      }
      assert_memory_equal(before[0], before[1], 16 * sizeof(PetscReal));
      for (PetscInt k = 0; k < 3; k++) {
        ok(VecAXPY(copy[k], -1, vec[k]));
        ok(VecNorm(copy[k], NORM_INFINITY, &norm));
        assert_true(norm == 0);
        ok(VecDestroy(&copy[k]));
      }
      bar_destroy(&body, options);
    }
}

/* After BodyPrepareSweeps(), a window integrated again under other inputs is the same as one integrated as a whole */
static void gives_the_same_as_a_whole_integration(void **state)
{
  const char *const types[] = {"lumped", "averaged"};

  (void)state;
  for (PetscInt moved = 0; moved < 2; moved++)
    for (PetscInt type = 0; type < 2; type++)
      for (PetscInt i = 0; i < 2; i++)
        for (size_t c = 0; c < sizeof(conditions) / sizeof(conditions[0]); c++) {
          Body         body;
          BodyTraces   traces;
          Rows         rows;
          PetscOptions options = create_body(&body, &rows, &traces, integrators[i], types[type], moved, 1, conditions[c]);
          PetscReal    outputs[2][8], norm, scale;
          Vec          vec[3], copy[3];

          ok(BodyGetSolution(body, &vec[0], &vec[1], &vec[2]));
          ok(BodyPrepareSweeps(body));
          for (PetscInt seed = 1; seed < 6; seed++) {
            write_inputs(&rows, &traces, 1, seed);
            ok(BodyIntegrate(body)); /* as a whole at first, then four times by columns */
          }
          for (PetscInt pass = 0; pass < 2; pass++) {
            const Trace out[] = {traces.displacement, traces.velocity, traces.acceleration, traces.reaction};

            for (PetscInt t = 0; t < 4; t++)
              for (PetscInt which = 0; which < 2; which++) outputs[pass][2 * t + which] = get_level(&rows, out[t], 1, which);
            if (pass) break;
            for (PetscInt k = 0; k < 3; k++) {
              ok(VecDuplicate(vec[k], &copy[k]));
              ok(VecCopy(vec[k], copy[k]));
            }
            ok(BodyResetTraces(body)); /* nothing to add columns to any more */
            ok(BodyIntegrate(body));
          }
          for (PetscInt k = 0; k < 3; k++) {
            ok(VecNorm(vec[k], NORM_INFINITY, &scale));
            ok(VecAXPY(copy[k], -1, vec[k]));
            ok(VecNorm(copy[k], NORM_INFINITY, &norm));
            /* round-off of four additions; accelerations are differences of displacements over dt^2 / 4 = 1.6e-3 */
            between(norm, 0, 1e-12 * PetscMax(scale, k == 2 ? 10 : 1));
            ok(VecDestroy(&copy[k]));
          }
          for (PetscInt k = 0; k < 8; k++)
            near(outputs[0][k], outputs[1][k], 1e-12 * PetscMax(PetscAbsReal(outputs[1][k]), k / 2 == 2 ? 10 : 1));
          bar_destroy(&body, options);
        }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_the_difference_that_a_unit_makes),
      cmocka_unit_test(does_not_depend_on_when_it_is_asked_for),
      cmocka_unit_test(is_symmetric_for_forces),
      cmocka_unit_test(leaves_no_trace),
      cmocka_unit_test(gives_the_same_as_a_whole_integration),
  };

  return impakt_main(argc, argv, tests);
}
