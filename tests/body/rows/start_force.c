/* Contact forces at the start of a step that are not those of the end of the last one: what they do to momentum and energy. */
#include "row_bodies.h"

static const PetscReal starts[MOST_ROWS] = {0.03, -0.02, 0.05, 0.01, -0.04}, ends[MOST_ROWS] = {-0.01, 0.06, 0.02, -0.03, 0.05}; /* [N] */
static const BodyCondition all_forced[MOST_ROWS] = {BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED};

/* Under way, without forces so far, and then under `ends` at the end of each substep but those before the last */
static void begin(RowBody *b, PetscInt shape, Method method, PetscInt substeps, const char more[])
{
  row_body_create(b, shape, method, substeps, NULL, more);
  row_body_start(b);
  set_row_conditions(b, all_forced);
  for (PetscInt level = 0; level <= substeps; level++)
    for (PetscInt i = 0; i < b->n; i++) set_row(&b->rows, b->traces.force_in, level, i, level == substeps ? ends[i] : 0);
}

static void set_start_force(RowBody *b, PetscReal factor)
{
  PetscScalar mine[MOST_ROWS];

  for (PetscInt i = 0; i < b->rows.local; i++) mine[i] = factor * starts[b->rows.which[i]];
  ok(BodySetStartForce(b->body, mine, NULL));
}

static BodyMeasures integrate(RowBody *b)
{
  BodyMeasures measures;

  ok(BodyIntegrate(b->body));
  ok(BodyGetMeasures(b->body, &measures));
  return measures;
}

/* Half a substep of the forces at the start is their impulse; on the nodes inside, whether contact nodes have mass or not */
static void brings_its_impulse(void **state)
{
  static const char *const masses[] = {"-mass_redistribute true", "-mass_redistribute false", "-mass_redistribute true -mass_type averaged",
                                       "-mass_redistribute true -material_type neo_hookean"};

  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt mass = 0; mass < 4; mass++)
      for (PetscInt k = 0; k < 2; k++)
        for (PetscInt substeps = 1; substeps <= 3; substeps += 2) {
          const Method method      = k ? EXPLICIT : IMPLICIT;
          PetscReal    expected[3] = {0};
          BodyMeasures without, with;
          RowBody      b;

          begin(&b, shape, method, substeps, masses[mass]);
          without = integrate(&b);
          set_start_force(&b, 1);
          with = integrate(&b);
          for (PetscInt i = 0; i < b.n; i++)
            for (PetscInt d = 0; d < 3; d++)
              expected[d] += 0.5 * CONTROLLER_STEP / substeps * starts[i] * row_directions_of[shape][3 * i + d];
          /* momenta are some 0.1 N s; Newton's method stops at 1e-12 of the forces, which are some 0.1 N */
          for (PetscInt d = 0; d < 3; d++) near(with.momentum[d] - without.momentum[d], expected[d], 1e-13);
          row_body_destroy(&b);
        }
}

/* C of the layer alone, which is what rows of an explicit body answer by in one substep */
static void get_layer_compliance(PetscInt shape, PetscReal C[MOST_ROWS][MOST_ROWS])
{
  RowBody b;

  row_body_create(&b, shape, EXPLICIT, 1, NULL, "-mass_redistribute true");
  know_all_rows(&b);
  for (PetscInt i = 0; i < b.n; i++)
    for (PetscInt j = 0; j < b.n; j++) C[i][j] = compliance_of(&b, 0, i, j);
  row_body_destroy(&b);
}

/* dE = 1/2 (x + l1) dg - 1/2 (x - l0) C (l1 - l0) with l0 = 0, under Newmark's rule */
static void changes_energy_as_it_should(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt factor = -1; factor <= 2; factor++) {
      PetscReal C[MOST_ROWS][MOST_ROWS], before, after, expected = 0;
      RowBody   b;

      get_layer_compliance(shape, C);
      begin(&b, shape, IMPLICIT, 1, "-mass_redistribute true");
      ok(BodyComputeEnergy(b.body, &before));
      set_start_force(&b, factor);
      ok(BodyIntegrate(b.body));
      ok(BodyComputeEnergy(b.body, &after));
      for (PetscInt i = 0; i < b.n; i++) {
        const PetscReal moved = get_row(&b.rows, b.traces.displacement, 1, i) - get_row(&b.rows, b.traces.displacement, 0, i);

        expected += 0.5 * (factor * starts[i] + ends[i]) * moved;
        for (PetscInt j = 0; j < b.n; j++) expected -= 0.5 * factor * starts[i] * C[i][j] * ends[j];
      }
      near(after - before, expected, 1e-14); /* of energies of 1e-2 J, of which 1e-3 J come and go */
      assert_true(PetscAbsReal(expected) > 1e-6);
      row_body_destroy(&b);
    }
}

/* Without a change, and after one has been accepted, all is as if there had been none */
static void leaves_nothing_behind(void **state)
{
  (void)state;
  for (PetscInt k = 0; k < 2; k++) {
    BodyMeasures without, again;
    RowBody      b;

    begin(&b, 1, k ? EXPLICIT : IMPLICIT, 1, "-mass_redistribute true");
    without = integrate(&b);
    set_start_force(&b, 3);
    integrate(&b);
    set_start_force(&b, 0);
    again = integrate(&b);
    assert_true(again.kinetic == without.kinetic && again.potential == without.potential);
    row_body_destroy(&b);
  }
}

/* A body without inertia has no acceleration to begin with */
static void static_bodies_do_not_see_it(void **state)
{
  BodyMeasures without, with;
  RowBody      b;

  (void)state;
  begin(&b, 1, STATIC, 1, "");
  without = integrate(&b);
  set_start_force(&b, 1);
  with = integrate(&b);
  assert_true(with.potential == without.potential);
  row_body_destroy(&b);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(brings_its_impulse), cmocka_unit_test(changes_energy_as_it_should),
                                     cmocka_unit_test(leaves_nothing_behind), cmocka_unit_test(static_bodies_do_not_see_it)};

  return impakt_main(argc, argv, tests);
}
