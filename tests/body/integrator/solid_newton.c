/* long: 2 3 */
/* Nonlinear bodies: convergence of Newton's method, windows repeated bit for bit, prescribed rows, and what cannot converge. */
#include "solid_bodies.h"

static const char *const materials[] = {MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 2

/* Waves run at 1.4 m/s and cross an element of 0.5 m in 0.36 s */
#define COMMON "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 "
static const char *const boxes[] = {"-dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5",
                                    "-dm_plex_box_faces 3,2,3 -dm_plex_box_upper 1.5,1,1.5"};
static const char *const sides[] = {"ymax", "zmax"};

/* The lower side clamped, a traction of 0.06 of Young's modulus in each second on the upper one, askew */
static const char *const loads[] = {
    "-boundary_displacement ymin -boundary_displacement_ymin 0,0 -boundary_traction ymax -boundary_traction_ymax 0.15*t,0.3*t",
    "-boundary_displacement zmin -boundary_displacement_zmin 0,0,0 -boundary_traction zmax -boundary_traction_zmax 0.15*t,0.05*t,0.3*t"};

static PetscOptions create(Body *body, PetscInt kind, PetscInt material, PetscReal step, const char more[])
{
  const PetscInt space   = kind_dim[kind] - 2;
  PetscOptions   options = solid_body_create(body, "%s %s -material_type %s " COMMON "%s", kind_options(kind), boxes[space],
                                             materials[material], more);

  ok(BodySetControllerStep(*body, 0, step));
  return options;
}

static PetscErrorCode Scattered(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = 0.01 * scattered(x, dim, d);
    v[d] = 0.1 * scattered(x, dim, 3 + d);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Residuals of the last substep, one for each iteration and the first; how many iterations */
static PetscInt get_residuals(Body body, const PetscReal **residuals)
{
  PetscInt   n, iterations;
  PetscReal *history;
  SNES       snes;

  ok(TSGetSNES(body->time.ts, &snes));
  ok(SNESGetConvergenceHistory(snes, &history, NULL, &n));
  ok(SNESGetIterationNumber(snes, &iterations));
  assert_int_equal(n, iterations + 1);
  *residuals = history;
  return iterations;
}

/* With the exact tangent the relative residual is squared in each iteration, up to a factor that hangs on how nonlinear the step is */
static void converges_quadratically(void **state)
{
  static const char *const integrators[] = {TSALPHA2, TSSTATIC};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt i = 0; i < 2; i++) {
        char         more[512];
        PetscInt     seen = 0;
        SNES         snes;
        Body         body;
        PetscOptions options;

        (void)snprintf(more, sizeof(more), "%s -ts_type %s", loads[kind_dim[kind] - 2], integrators[i]);
        options = create(&body, kind, material, 0.2, more);
        ok(BodySetUp(body));
        ok(TSGetSNES(body->time.ts, &snes));
        ok(SNESSetConvergenceHistory(snes, NULL, NULL, 20, PETSC_TRUE));
        for (PetscInt k = 0; k < 8; k++) {
          const PetscReal *residuals;
          PetscInt         iterations;

          ok(BodyIntegrate(body));
          ok(BodySave(body));
          iterations = get_residuals(body, &residuals);
          between(iterations, 2, 5);
          for (PetscInt j = 0; j < iterations; j++) {
            const PetscReal before = residuals[j] / residuals[0], after = residuals[j + 1] / residuals[0];

            if (before > 1e-2) continue;
            between(after, 0, 50 * before * before + 1e-11);
            seen += before > 1e-5;
          }
        }
        assert_true(seen >= 4);
        bar_destroy(&body, options);
      }
}

/* Three rows at two nodes of the upper side, the second node's row askew */
#define ROWS 3
static const PetscReal row_nodes[2][9]      = {{0.5, 1.5, 0, 0.5, 1.5, 0, 1, 1.5, 0}, {0.5, 0.5, 1.5, 0.5, 0.5, 1.5, 1, 0.5, 1.5}};
static const PetscReal row_directions[2][9] = {{1, 0, 0, 0, 1, 0, 0.6, 0.8, 0}, {0, 1, 0, 0, 0, 1, 0.48, 0.64, 0.6}};

static PetscReal motion(PetscInt which, PetscReal t)
{
  return 0.1 * (1 + 0.2 * which) * PetscSinReal(t);
}

static PetscReal speed(PetscInt which, PetscReal t)
{
  return 0.1 * (1 + 0.2 * which) * PetscCosReal(t);
}

static void create_rows(Body body, PetscInt kind, NodeRows *rows)
{
  const PetscInt space = kind_dim[kind] - 2;

  touch_side(body, sides[space]);
  set_node_rows(body, ROWS, row_nodes[space], row_directions[space], rows);
}

static void fill_inputs(const NodeRows *rows, const BodyTraces *traces, PetscInt substeps, PetscReal t, PetscReal step, PetscReal scale)
{
  for (PetscInt level = 0; level <= substeps; level++)
    for (PetscInt i = 0; i < ROWS; i++) {
      const PetscReal now = t + step * level / substeps;

      set_row(rows, traces->displacement_in, level, i, scale * motion(i, now));
      set_row(rows, traces->velocity_in, level, i, scale * speed(i, now));
      set_row(rows, traces->acceleration_in, level, i, -scale * motion(i, now));
      set_row(rows, traces->force_in, level, i, scale * speed(i, now));
    }
}

/* The constrained rows' matrix follows the tangent in each iteration, or Newton's method would be slow */
static void follows_prescribed_rows(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt moved = 0; moved < 2; moved++) {
        BodyTraces   traces;
        NodeRows     rows;
        SNES         snes;
        Body         body;
        PetscOptions options = create(&body, kind, material, 0.1, moved ? "" : "-mass_redistribute 0");

        create_rows(body, kind, &rows);
        ok(BodySetUp(body));
        ok(BodyGetTraces(body, &traces));
        ok(TSGetSNES(body->time.ts, &snes));
        ok(SNESSetConvergenceHistory(snes, NULL, NULL, 20, PETSC_TRUE));
        condition_rows(body, &rows, BODY_PRESCRIBED);
        for (PetscInt k = 0; k < 10; k++) {
          const PetscReal *residuals;

          fill_inputs(&rows, &traces, 1, 0.1 * k, 0.1, 1);
          ok(BodyIntegrate(body));
          for (PetscInt i = 0; i < ROWS; i++) {
            near(get_row(&rows, traces.displacement, 1, i), motion(i, 0.1 * (k + 1)), 1e-12);
            if (!moved) near(get_row(&rows, traces.velocity, 1, i), speed(i, 0.1 * (k + 1)), 1e-12);
          }
          between(get_residuals(body, &residuals), 1, 6);
          ok(BodySave(body));
        }
        bar_destroy(&body, options);
      }
}

/* Everything that an integration leaves behind, on this rank */
typedef struct {
  PetscInt    n, rows;
  PetscScalar values[4][512], traces[4][MAX_NODE_ROWS];
  PetscReal   work;
} Result;

static void get_result(Body body, PetscInt substeps, Result *result)
{
  const Vec   vecs[]   = {body->state.u, body->state.v, body->state.a, body->state.internal_force};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration, body->traces.reaction};

  memset(result, 0, sizeof(*result));
  result->n    = body->mesh.owned_nodes * body->mesh.dim;
  result->rows = body->rows.local;
  result->work = body->state.external_work;
  assert_true(result->n <= 512);
  for (PetscInt k = 0; k < 4; k++) {
    const PetscScalar *array;
    PetscScalar       *level;

    ok(VecGetArrayRead(vecs[k], &array));
    ok(PetscArraycpy(result->values[k], array, result->n));
    ok(VecRestoreArrayRead(vecs[k], &array));
    ok(TraceGetLevel(traces[k], substeps, &level));
    ok(PetscArraycpy(result->traces[k], level, result->rows)); /* of no rows there is no array */
  }
}

static void same(const Result *a, const Result *b, PetscReal tolerance)
{
  for (PetscInt k = 0; k < 4; k++) {
    for (PetscInt i = 0; i < a->n; i++) near(a->values[k][i], b->values[k][i], tolerance);
    for (PetscInt i = 0; i < a->rows; i++) near(a->traces[k][i], b->traces[k][i], tolerance);
  }
  near(a->work, b->work, tolerance);
}

/* A body tries other inputs and conditions in each window, and does the window again; another goes straight on. Not bit for bit between
   the two: the second may be dealt out to the ranks in another way. */
static void repeats_a_window_bit_for_bit(void **state)
{
  static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE, TSSTATIC};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt i = 0; i < 3; i++)
        for (PetscInt substeps = 1; substeps <= 3; substeps += 2) {
          char         more[1024];
          Body         bodies[2];
          PetscOptions options[2];
          BodyTraces   traces[2];
          NodeRows     rows[2];
          Result       first, again;
          PetscMPIInt  size;
          PetscBool    rounded;

          /* PETSc adds what comes from two or more ranks to a matrix as it comes: round-off of some 1e-17 m, over dt^2 in accelerations */
          assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
          rounded = (PetscBool)(size > 2);

          (void)snprintf(more, sizeof(more), "%s -ts_type %s -ts_time_step %.17g", loads[kind_dim[kind] - 2], integrators[i],
                         0.06 / substeps);
          for (PetscInt b = 0; b < 2; b++) {
            options[b] = create(&bodies[b], kind, material, 0.06, more);
            create_rows(bodies[b], kind, &rows[b]);
            ok(BodySetUp(bodies[b]));
            ok(BodySetInitialState(bodies[b], Scattered, NULL));
            ok(BodyGetTraces(bodies[b], &traces[b]));
          }
          for (PetscInt k = 0; k < 4; k++) {
            const BodyCondition condition = k % 2 ? BODY_FORCED : BODY_PRESCRIBED;

            for (PetscInt b = 0; b < 2; b++) {
              condition_rows(bodies[b], &rows[b], condition);
              fill_inputs(&rows[b], &traces[b], substeps, 0.06 * k, 0.06, 0.1);
              ok(BodyIntegrate(bodies[b]));
            }
            get_result(bodies[1], substeps, &first);
            fill_inputs(&rows[1], &traces[1], substeps, 0.06 * k, 0.06, 0.3);
            ok(BodyIntegrate(bodies[1]));
            condition_rows(bodies[1], &rows[1], k % 2 ? BODY_PRESCRIBED : BODY_FREE);
            ok(BodyIntegrate(bodies[1]));
            if (k == 2) ok(BodyRestore(bodies[1]));
            condition_rows(bodies[1], &rows[1], condition);
            fill_inputs(&rows[1], &traces[1], substeps, 0.06 * k, 0.06, 0.1);
            ok(BodyIntegrate(bodies[1]));
            get_result(bodies[1], substeps, &again);
            same(&first, &again, rounded ? 1e-11 : 0);
            for (PetscInt b = 0; b < 2; b++) ok(BodySave(bodies[b])); /* where one substep's work is found */
            assert_true(bodies[0]->state.external_work != 0);
            near(bodies[1]->state.external_work, bodies[0]->state.external_work,
                 1e-12); /* round-off of forces of 1 N and ways of 1 cm, and what Newton's method leaves */
          }
          bar_destroy(&bodies[1], options[1]);
          bar_destroy(&bodies[0], options[0]);
        }
}

/* Where one iteration is all that is allowed */
static void tells_what_did_not_converge(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++) {
    Body         body;
    PetscOptions options;
    char         more[1024];

    (void)snprintf(more, sizeof(more), "%s -snes_max_it 1", loads[kind_dim[kind] - 2]);
    options = create(&body, kind, 1, 0.2, more);
    ok(BodySetUp(body));
    refused(PETSC_ERR_NOT_CONVERGED, "Newton's method|'b'|0.2 s|step 1|MAX_IT|1 iterations|-b_ts_time_step|-b_snes_monitor",
            BodyIntegrate(body));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

/* The upper side is pushed through the lower one: implicit, explicit, static. The lowest elements keep their shape while those at the top
   are inverted at once, between y or z = 1 and 1.5. */
static void names_an_inverted_element(void **state)
{
  static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE, TSSTATIC};
  static const char *const pushed[]      = {
      "-boundary_displacement ymin,ymax -boundary_displacement_ymin 0,0 -boundary_displacement_ymax free,t>0?-2:0",
      "-boundary_displacement zmin,zmax -boundary_displacement_zmin 0,0,0 -boundary_displacement_zmax free,free,t>0?-2:0"};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt i = 0; i < 3; i++) {
      Body         body;
      PetscOptions options;
      char         more[1024];

      (void)snprintf(more, sizeof(more), "%s -ts_type %s", pushed[kind_dim[kind] - 2], integrators[i]);
      options = create(&body, kind, 1, 0.05, more);
      ok(BodySetUp(body));
      refused(PETSC_ERR_FP, "'b'|element |around (|inverted|0.05 s|step 1", BodyIntegrate(body));
      ok(BodyDestroy(&body));
      options_drop(options);
    }
}

/* At the start */
static PetscErrorCode InsideOut(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt d = 0; d < dim; d++) u[d] = v[d] = 0;
  if (x[0] > 1.25) u[0] = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void names_an_element_inverted_at_the_start(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++) {
    Body         body;
    PetscOptions options = create(&body, kind, 1, 0.05, "");

    ok(BodySetUp(body));
    refused(PETSC_ERR_FP, "'b'|element |around (1|inverted|time 0|step 0", BodySetInitialState(body, InsideOut, NULL));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

/* Units in which a metre, a kilogram and a second are so much */
static const PetscReal units[][3] = {{1, 1, 1}, {1e3, 1e-3, 1e3}, {1e-3, 1e-6, 1e-6}, {1e6, 1e-9, 1e9}};
#define UNITS 4

/* A box flies as a whole, and comes through its place in the mesh, where displacements and forces vanish: what is left of the residual
   there is the round-off of the step's own displacement and of stresses that strains of size 1 would make */
static void flies_through_zero_displacement(void **state)
{
  static const PetscReal steps[] = {1e-3, 1e-5};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt unit = 0; unit < UNITS; unit++)
        for (PetscInt i = 0; i < 2; i++) {
          const PetscReal *per = units[unit], metre = per[0], pascal = per[1] / per[0] / PetscSqr(per[2]), dt = steps[i] * per[2];
          const PetscReal  speed = 10 * per[0] / per[2], start = -10 * speed * dt;
          const PetscInt   dim = kind_dim[kind];
          char             box[128], more[256];
          BodyMeasures     before, after;
          Body             body;
          PetscOptions     options;

          if (dim == 2) (void)snprintf(box, sizeof(box), "-dm_plex_box_faces 3,3 -dm_plex_box_upper %.17g,%.17g", metre, metre);
          else (void)snprintf(box, sizeof(box), "-dm_plex_box_faces 2,2,2 -dm_plex_box_upper %.17g,%.17g,%.17g", metre, metre, metre);
          (void)snprintf(more, sizeof(more), "-initial_displacement %.17g,%.17g%s -initial_velocity %.17g,%.17g%s", start, start,
                         dim == 3 ? ",0" : "", speed, speed, dim == 3 ? ",0" : "");
          options = solid_body_create(&body, "%s %s -material_type %s -density %.17g -youngs_modulus %.17g -poissons_ratio 0.3 %s",
                                      kind_options(kind), box, materials[material], 1e3 * per[1] / (metre * metre * metre), 1e9 * pascal,
                                      more);
          ok(BodySetControllerStep(body, 0, dt));
          ok(BodySetUp(body));
          ok(BodyGetMeasures(body, &before));
          for (PetscInt k = 0; k < 20; k++) {
            ok(BodyIntegrate(body));
            ok(BodySave(body));
          }
          ok(BodyGetMeasures(body, &after));
          /* round-off of 20 steps; in each the displacement of some 1e-4 m loses 1e-16 of it, and that counts as speed over the step */
          near(after.kinetic, before.kinetic, 1e-11 * before.kinetic);
          near(after.momentum[0], before.momentum[0], 1e-11 * before.momentum[0]);
          bar_destroy(&body, options);
        }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(converges_quadratically),         cmocka_unit_test(follows_prescribed_rows),
      cmocka_unit_test(repeats_a_window_bit_for_bit),    cmocka_unit_test(tells_what_did_not_converge),
      cmocka_unit_test(names_an_inverted_element),       cmocka_unit_test(names_an_element_inverted_at_the_start),
      cmocka_unit_test(flies_through_zero_displacement),
  };

  return impakt_main(argc, argv, tests);
}
