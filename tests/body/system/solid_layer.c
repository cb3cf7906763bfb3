/* long: 3 */
/* The massless layer of explicit bodies in two and three dimensions: in balance with what is inside and with its loads, by linear and by
   nonlinear materials; energy; prescribed and loaded rows on it. */
#include "solid_bodies.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 2

/* Elements of 0.5 m; waves run at 1.4 m/s and cross an element in some 0.3 s */
#define STEP   0.05
#define COMMON "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 -ts_type centraldifference "
static const char *const boxes[] = {"-dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5",
                                    "-dm_plex_box_faces 3,2,3 -dm_plex_box_upper 1.5,1,1.5"};
static const char *const sides[] = {"ymax", "zmax"};

/* Strains of some hundredths */
static PetscErrorCode Scattered(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = 0.01 * scattered(x, dim, d);
    v[d] = 0.02 * scattered(x, dim, 3 + d);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void advance(Body body)
{
  ok(BodyIntegrate(body));
  ok(BodySave(body));
}

static PetscOptions create(Body *body, PetscInt kind, PetscInt material, const char more[])
{
  const PetscInt space   = kind_dim[kind] - 2;
  PetscOptions   options = solid_body_create(body, "%s %s -material_type %s " COMMON "%s", kind_options(kind), boxes[space],
                                             materials[material], more);

  touch_side(*body, sides[space]);
  ok(BodySetControllerStep(*body, 0, STEP));
  return options;
}

/* Largest internal force less that from outside on the free dofs of the layer, and the largest internal force at all [N] */
static void get_imbalance(Body body, PetscReal *left, PetscReal *largest)
{
  const PetscScalar *internal;
  PetscInt           layer = 0;
  Vec                f, rest;

  ok(BodyCreateVec(body, &f));
  ok(BodyCreateVec(body, &rest));
  ok(BodyComputeInternalForce(body, body->state.u, f));
  ok(VecNorm(f, NORM_INFINITY, largest));
  ok(VecCopy(f, rest));
  ok(BodyAddExternalForce(body, body->state.time, -1, rest));
  ok(VecGetArrayRead(rest, &internal));
  *left = 0;
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) *left = PetscMax(*left, PetscAbsReal(internal[body->layer.dofs[i]]));
  ok(VecRestoreArrayRead(rest, &internal));
  ok(VecDestroy(&f));
  ok(VecDestroy(&rest));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, left, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD), 0);
  assert_int_equal(MPI_Allreduce(&body->layer.n_dofs, &layer, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  assert_true(layer > 0);
}

/* Chord Newton's method stops where displacements change by 1e-12 of its first change; 1e-14 was measured. Linear bodies are left with
   round-off. */
static void check_balance(PetscInt kind, PetscInt material, const char loads[])
{
  PetscReal    left, largest;
  Body         body;
  PetscOptions options = create(&body, kind, material, loads);

  ok(BodySetUp(body));
  ok(BodySetInitialState(body, Scattered, NULL));
  get_imbalance(body, &left, &largest);
  assert_true(left > 1e-2 * largest); /* the initial state is none of balance */
  for (PetscInt k = 0; k < 30; k++) {
    advance(body);
    get_imbalance(body, &left, &largest);
    assert_true(largest > 1e-3);
    between(left, 0, 1e-12 * largest);
  }
  bar_destroy(&body, options);
}

static void is_in_balance(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++) check_balance(kind, material, "");
}

static void is_in_balance_with_a_traction(void **state)
{
  static const char *const tractions[] = {"-boundary_traction ymax -boundary_traction_ymax 0.02*(1+t),-0.03*x",
                                          "-boundary_traction zmax -boundary_traction_zmax 0.02*(1+t),0.01,-0.03*x"};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++) check_balance(kind, material, tractions[kind_dim[kind] - 2]);
}

/* Symmetry planes and clamped sides at its edge: nodes of which some or all dofs are held */
static void is_in_balance_where_its_edge_is_held(void **state)
{
  static const char *const held[2][2] = {
      {"-boundary_displacement xmin -boundary_displacement_xmin 0,free",
       "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0,0 -boundary_displacement_xmax 0.01*sin(t),free"},
      {"-boundary_displacement xmin -boundary_displacement_xmin 0,free,free",
       "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0,0,0 -boundary_displacement_xmax 0.01*sin(t),free,free"}};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt i = 0; i < 2; i++) check_balance(kind, material, held[kind_dim[kind] - 2][i]);
}

/* Scattered, and 10 m/s along each axis */
static PetscErrorCode Flying(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  PetscCall(Scattered(dim, x, u, v, ctx));
  for (PetscInt d = 0; d < dim; d++) v[d] += 10;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After 5 s of flight positions are known to 1e-14 m, which no iteration of the layer can better: with Young's modulus 5 Pa, some 1e-13 N
 */
static void is_in_balance_in_flight(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++) {
      PetscReal    left, largest;
      BodyMeasures before, after;
      Body         body;
      PetscOptions options = create(&body, kind, material, "");

      ok(BodySetUp(body));
      ok(BodySetInitialState(body, Flying, NULL));
      advance(body); /* into balance */
      ok(BodyGetMeasures(body, &before));
      for (PetscInt k = 0; k < 100; k++) advance(body);
      ok(BodyGetMeasures(body, &after));
      get_imbalance(body, &left, &largest);
      between(left, 0, 1e-12);
      for (PetscInt d = 0; d < body->mesh.dim; d++)
        near(after.momentum[d], before.momentum[d], 1e-11); /* round-off of 100 kg m/s, and such forces over 5 s */
      bar_destroy(&body, options);
    }
}

static PetscReal energy_of(Body body)
{
  BodyMeasures measures;

  ok(BodyGetMeasures(body, &measures));
  return measures.kinetic + measures.potential;
}

/* Central differences keep the energy of a linear body, with staggered kinetic energy, to round-off of 300 steps; that of a nonlinear one
   swings by (omega dt)^2 with what is excited, and by less with smaller steps, but does not drift. With two substeps to a controller step
   of 0.05 s its swing is below 5e-4; nodes that carry 0.3 of their mass, as three layers of triangles have, set the largest omega. Momentum
   is kept where nothing pulls. */
static void keeps_the_energy(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++) {
      PetscReal    first, least, most, halves[2] = {0};
      BodyMeasures before, after;
      Body         body;
      PetscOptions options = create(&body, kind, material, material ? "-ts_time_step 0.025" : "");

      ok(BodySetUp(body));
      ok(BodySetInitialState(body, Scattered, NULL));
      advance(body); /* into balance */
      ok(BodyGetMeasures(body, &before));
      first = least = most = energy_of(body);
      assert_true(before.kinetic > 0.1 * first && before.potential > 0.1 * first);
      for (PetscInt k = 0; k < 300; k++) {
        PetscReal energy;

        advance(body);
        energy = energy_of(body);
        least  = PetscMin(least, energy);
        most   = PetscMax(most, energy);
        halves[k / 150] += energy / 150;
      }
      ok(BodyGetMeasures(body, &after));
      if (material == 0) between(most - least, 0, 1e-13 * first);
      else {
        between(most - least, 0, 2e-3 * first);
        near(halves[1], halves[0], 5e-4 * first);
      }
      for (PetscInt d = 0; d < body->mesh.dim; d++) near(after.momentum[d], before.momentum[d], 1e-12);
      bar_destroy(&body, options);
    }
}

/* Two nodes of the side y = 1.5, each with a row along the normal and one along the side, turned by an angle: orthonormal */
static const PetscReal row_nodes[]      = {0.5, 1.5, 0, 0.5, 1.5, 0, 1, 1.5, 0};
static const PetscReal row_directions[] = {0.6, 0.8, 0, 0.8, -0.6, 0, 0, 1, 0};
#define ROWS 3

static PetscReal motion(PetscInt which, PetscReal t)
{
  return 0.02 * PetscSinReal((1 + which) * t) - 0.01 * which * t * t;
}

/* The traces of rows over a controller step that begins at t: displacement or force */
static void fill_inputs(const NodeRows *rows, Trace trace, PetscInt substeps, PetscReal t, PetscReal scale)
{
  for (PetscInt level = 0; level <= substeps; level++)
    for (PetscInt i = 0; i < ROWS; i++) set_row(rows, trace, level, i, scale * motion(i, t + STEP * level / substeps));
}

/* Central differences change momentum by the trapezoidal rule over the forces that act on the body; those of the layer's rows are all there
   are, since a body's internal forces add up to nothing. */
static void rows_hand_over_what_the_partner_feels(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < 2; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt forced = 0; forced < 2; forced++)
        for (PetscInt substeps = 1; substeps <= 3; substeps += 2) {
          char         more[64];
          PetscReal    impulse[3] = {0}, force[2][3] = {{0}};
          BodyMeasures before, after;
          BodyTraces   traces;
          NodeRows     rows;
          Body         body;
          PetscOptions options;

          (void)snprintf(more, sizeof(more), "-ts_time_step %.17g", STEP / substeps);
          options = create(&body, kind, material, more);
          set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
          ok(BodySetUp(body));
          ok(BodyGetTraces(body, &traces));
          condition_rows(body, &rows, forced ? BODY_FORCED : BODY_PRESCRIBED);
          for (PetscInt k = 0; k < 40; k++) {
            const PetscReal t = k * STEP;

            fill_inputs(&rows, forced ? traces.force_in : traces.displacement_in, substeps, t, 1);
            ok(BodyGetMeasures(body, &before));
            ok(BodyIntegrate(body));
            ok(BodyGetMeasures(body, &after));
            for (PetscInt level = 1; level <= substeps; level++) {
              for (PetscInt d = 0; d < 2; d++) force[1][d] = 0;
              for (PetscInt i = 0; i < ROWS; i++) {
                const PetscReal lambda = get_row(&rows, forced ? traces.force_in : traces.reaction, level, i);

                if (!forced) near(get_row(&rows, traces.displacement, level, i), motion(i, t + STEP * level / substeps), 1e-15);
                for (PetscInt d = 0; d < 2; d++) force[1][d] += lambda * row_directions[3 * i + d];
              }
              for (PetscInt d = 0; d < 2; d++) {
                impulse[d] += 0.5 * STEP / substeps * (force[0][d] + force[1][d]);
                force[0][d] = force[1][d];
              }
            }
            ok(BodySave(body));
            for (PetscInt d = 0; d < 2; d++) near(after.momentum[d], impulse[d], 1e-12);
          }
          assert_true(PetscAbsReal(impulse[0]) > 1e-3 && PetscAbsReal(impulse[1]) > 1e-3);
          bar_destroy(&body, options);
        }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_in_balance),
      cmocka_unit_test(is_in_balance_with_a_traction),
      cmocka_unit_test(is_in_balance_where_its_edge_is_held),
      cmocka_unit_test(is_in_balance_in_flight),
      cmocka_unit_test(keeps_the_energy),
      cmocka_unit_test(rows_hand_over_what_the_partner_feels),
  };

  return impakt_main(argc, argv, tests);
}
