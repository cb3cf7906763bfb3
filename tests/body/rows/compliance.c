/* long: 2 3 */
/* The interface compliance of a body, against integrations under unit hats; rows that become known, are forgotten, and change. */
#include "row_bodies.h"

typedef struct {
  PetscReal at[4][MOST_ROWS]; /* per substep and row */
} Answer;

static Answer answer_to_forces(RowBody *b)
{
  Answer answer = {{{0}}};

  ok(BodyIntegrate(b->body));
  for (PetscInt k = 0; k < b->substeps; k++)
    for (PetscInt i = 0; i < b->n; i++) answer.at[k][i] = get_row(&b->rows, b->traces.displacement, k + 1, i);
  return answer;
}

/* Smooth forces of no pattern, and on one row (or -1) a hat of `size` at the end of substep `at` */
static void load_rows(RowBody *b, PetscInt at, PetscInt row, PetscReal size)
{
  for (PetscInt level = 0; level <= b->substeps; level++)
    for (PetscInt i = 0; i < b->n; i++)
      set_row(&b->rows, b->traces.force_in, level, i, 0.01 * PetscSinReal(1 + i + 2. * level) + (i == row && level == at ? size : 0));
}

/* The difference that a hat makes to a linear body under way, whenever it comes */
static void check_hats(RowBody *b)
{
  static const BodyCondition forced[MOST_ROWS] = {BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED};
  Answer                     base;
  PetscReal                  largest = 0;

  row_body_start(b);
  know_all_rows(b);
  set_row_conditions(b, forced);
  load_rows(b, 0, -1, 0);
  base = answer_to_forces(b);
  for (PetscInt j = 0; j < b->n; j++)
    for (PetscInt at = 1; at <= b->substeps; at++) {
      Answer hat;

      load_rows(b, at, j, 1);
      hat = answer_to_forces(b);
      for (PetscInt k = 0; k < b->substeps; k++)
        for (PetscInt i = 0; i < b->n; i++) {
          const PetscReal expected = k + 1 < at ? 0 : compliance_of(b, k + 1 - at, i, j);

          largest = PetscMax(largest, PetscAbsReal(expected));
          /* round-off: an element gives way by about 1 / (E h^(dim - 2)) = 0.2 to 0.4 m/N */
          near(hat.at[k][i] - base.at[k][i], expected, 1e-13);
        }
    }
  assert_true(largest > 0.05);
}

static void is_what_a_hat_brings(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        RowBody b;

        row_body_create(&b, shape, (Method)method, substeps, NULL, "");
        check_hats(&b);
        row_body_destroy(&b);
      }
}

/* Of which a row of the bar, and a part of one of the others, is held */
static void is_what_a_hat_brings_to_a_body_held_and_loaded(void **state)
{
  static const char *const loads[SHAPES_OF_BODIES] = {
      "-gravity 0.3", "-gravity 0.1,-0.3 -boundary_traction xmax -boundary_traction_xmax 0.02*(1+t),0.01",
      "-gravity 0,0,-0.3 -boundary_traction xmax -boundary_traction_xmax 0.02*(1+t),0.01,0"};

  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        char    more[512];
        RowBody b;

        (void)snprintf(more, sizeof(more), "%s %s", method == STATIC ? "" : supports[shape], loads[shape]);
        row_body_create(&b, shape, (Method)method, substeps, NULL, more);
        check_hats(&b);
        row_body_destroy(&b);
      }
}

/* Rows one after the other, from the last, and some twice, against all at once: the same body, solved for the same right-hand sides.
   Symmetric by
   Maxwell and Betti. */
static void may_be_asked_for_in_any_order(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        RowBody together, apart;

        row_body_create(&together, shape, (Method)method, substeps, NULL, "");
        row_body_create(&apart, shape, (Method)method, substeps, NULL, "");
        know_all_rows(&together);
        for (PetscInt i = apart.n - 1; i >= 0; i--) {
          const PetscInt pair[2] = {apart.global[i], apart.global[PetscMin(i + 1, apart.n - 1)]};

          ok(BodyExtendCompliance(apart.body, i < apart.n - 1 ? 2 : 1, pair));
        }
        for (PetscInt k = 0; k < substeps; k++)
          for (PetscInt i = 0; i < apart.n; i++)
            for (PetscInt j = 0; j < apart.n; j++) {
              near(compliance_of(&apart, k, i, j), compliance_of(&together, k, i, j), 1e-13);
              near(compliance_of(&apart, k, i, j), compliance_of(&apart, k, j, i), 1e-13);
            }
        row_body_destroy(&apart);
        row_body_destroy(&together);
      }
}

/* What is forgotten is not there any more, and what is left is what it was, wherever it has moved to */
static void forgets_rows(void **state)
{
  static const PetscInt forgotten[MOST_ROWS] = {1, 0, 1, 0, 0};

  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        PetscMPIInt        changed[MOST_ROWS];
        PetscReal          before[4][MOST_ROWS][MOST_ROWS];
        const PetscScalar *matrix;
        const PetscInt    *place;
        PetscInt           leading;
        RowBody            b;

        row_body_create(&b, shape, (Method)method, substeps, NULL, "");
        know_all_rows(&b);
        for (PetscInt k = 0; k < substeps; k++)
          for (PetscInt i = 0; i < b.n; i++)
            for (PetscInt j = 0; j < b.n; j++) before[k][i][j] = compliance_of(&b, k, i, j);
        for (PetscInt i = 0; i < b.n; i++) changed[b.global[i]] = (PetscMPIInt)forgotten[i];
        ok(BodyForgetCompliance(b.body, changed));
        ok(BodyGetCompliance(b.body, 0, &place, &leading, &matrix));
        for (PetscInt i = 0; i < b.n; i++) assert_int_equal(place[b.global[i]] < 0, forgotten[i]);
        for (PetscInt pass = 0; pass < 2; pass++) {
          for (PetscInt k = 0; k < substeps; k++)
            for (PetscInt i = 0; i < b.n; i++)
              for (PetscInt j = 0; j < b.n; j++)
                if (pass || (!forgotten[i] && !forgotten[j])) near(compliance_of(&b, k, i, j), before[k][i][j], 1e-14);
          know_all_rows(&b);
        }
        row_body_destroy(&b);
      }
}

/* Rows of all the bodies' nodes as NodeRows has them, along other directions */
static Mat turn_rows(RowBody *b, const PetscReal directions[])
{
  const PetscInt  dim = b->body->mesh.dim;
  PetscInt        n;
  const PetscInt *columns;
  Mat             B;

  ok(MatDuplicate(b->body->rows.matrix, MAT_COPY_VALUES, &B));
  for (PetscInt i = 0; i < b->rows.local; i++) {
    PetscInt first = -1, row = b->body->rows.begin + i;

    ok(MatGetRow(b->body->rows.matrix, row, &n, &columns, NULL));
    first = columns[0] - columns[0] % dim;
    ok(MatRestoreRow(b->body->rows.matrix, row, &n, &columns, NULL));
    for (PetscInt d = 0; d < dim; d++) ok(MatSetValue(B, row, first + d, directions[3 * b->rows.which[i] + d], INSERT_VALUES));
  }
  ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  return B;
}

/* Two of the rows turn, and the body goes on as one whose rows have been so from the beginning: compliance, traces, and integration with
   rows held */
static void follows_rows_that_turn(void **state)
{
  static const BodyCondition conditions[MOST_ROWS] = {BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_FORCED, BODY_PRESCRIBED};

  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt held = 0; held < 2; held++)
        for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
          PetscReal   directions[3 * MOST_ROWS];
          PetscBool   changed[MOST_ROWS], known = (PetscBool)(substeps == 1);
          RowBody     turned, fresh;
          Mat         B;
          const char *more = held && method != STATIC ? supports[shape] : "";

          for (PetscInt i = 0; i < 3 * MOST_ROWS; i++) directions[i] = row_directions_of[shape][i];
          /* the first turns in the plane of the last two axes, the last one gets another normal */
          for (PetscInt i = 0; i < MOST_ROWS; i += MOST_ROWS - 1) {
            directions[3 * i + shape]     = 0.8;
            directions[3 * i + shape - 1] = i ? 0.6 : -0.6;
          }
          row_body_create(&fresh, shape, (Method)method, substeps, directions, more);
          row_body_create(&turned, shape, (Method)method, substeps, NULL, more);
          row_body_start(&fresh);
          row_body_start(&turned);
          if (known) know_all_rows(&turned);
          set_row_conditions(&turned, conditions); /* columns of all rows that are held are there */
          ok(BodyIntegrate(turned.body));
          ok(BodyRestore(turned.body));
          B = turn_rows(&turned, directions);
          for (PetscInt i = 0; i < turned.rows.local; i++)
            changed[i] = (PetscBool)(turned.rows.which[i] == 0 || turned.rows.which[i] == MOST_ROWS - 1);
          ok(BodyUpdateInterface(turned.body, B, changed));
          ok(MatDestroy(&B));
          for (PetscInt i = 0; i < turned.n; i++)
            near(get_row(&turned.rows, turned.traces.displacement, 0, i), get_row(&fresh.rows, fresh.traces.displacement, 0, i), 1e-15);
          know_all_rows(&turned);
          know_all_rows(&fresh);
          for (PetscInt k = 0; k < substeps; k++)
            for (PetscInt i = 0; i < turned.n; i++)
              for (PetscInt j = 0; j < turned.n; j++) near(compliance_of(&turned, k, i, j), compliance_of(&fresh, k, i, j), 1e-14);
          set_row_conditions(&fresh, conditions);
          for (PetscInt body = 0; body < 2; body++) {
            RowBody *b = body ? &fresh : &turned;

            load_rows(b, 0, -1, 0);
            for (PetscInt level = 0; level <= substeps; level++)
              for (PetscInt i = 0; i < b->n; i++)
                set_row(&b->rows, b->traces.displacement_in, level, i, 0.01 * PetscSinReal(2 + 3 * i + level));
            ok(BodyIntegrate(b->body));
          }
          for (PetscInt level = 1; level <= substeps; level++)
            for (PetscInt i = 0; i < turned.n; i++) {
              near(get_row(&turned.rows, turned.traces.displacement, level, i), get_row(&fresh.rows, fresh.traces.displacement, level, i),
                   1e-13);
              /* forces of some tenths of N */
              near(get_row(&turned.rows, turned.traces.reaction, level, i), get_row(&fresh.rows, fresh.traces.reaction, level, i), 1e-12);
            }
          row_body_destroy(&turned);
          row_body_destroy(&fresh);
        }
}

/* A body at rest gives way as the linear one with its small-strain moduli does, before it has ever been factored for another state */
static void of_a_nonlinear_body_at_rest_is_that_of_the_linear_one(void **state)
{
  static const char *const materials[] = {"neo_hookean", "saint_venant_kirchhoff"};

  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3)
        for (PetscInt material = 0; material < 2; material++) {
          char      more[64];
          PetscBool exact;
          RowBody   linear, nonlinear;

          (void)snprintf(more, sizeof(more), "-material_type %s", materials[material]);
          row_body_create(&linear, shape, (Method)method, substeps, NULL, "");
          row_body_create(&nonlinear, shape, (Method)method, substeps, NULL, more);
          ok(BodyComplianceIsExact(linear.body, &exact));
          assert_true(exact);
          ok(BodyComplianceIsExact(nonlinear.body, &exact));
          assert_false(exact);
          know_all_rows(&linear);
          know_all_rows(&nonlinear);
          for (PetscInt k = 0; k < substeps; k++)
            for (PetscInt i = 0; i < linear.n; i++)
              for (PetscInt j = 0; j < linear.n; j++) near(compliance_of(&nonlinear, k, i, j), compliance_of(&linear, k, i, j), 1e-13);
          row_body_destroy(&nonlinear);
          row_body_destroy(&linear);
        }
}

/* A body is as it was when its compliance has been asked for in the middle of a controller step, and so is what it does afterwards. Sums
   over nodes may differ by round-off: a mesh need not be dealt out twice in the same way. */
static void leaves_no_trace(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        static const BodyCondition conditions[MOST_ROWS] = {BODY_PRESCRIBED, BODY_FORCED, BODY_FREE, BODY_PRESCRIBED, BODY_FREE};
        BodyMeasures               measures[2];
        Answer                     first[2], second[2];
        PetscInt64                 count[2];
        Vec                        u;
        PetscReal                  norm[2];

        for (PetscInt asks = 0; asks < 2; asks++) {
          RowBody b;

          row_body_create(&b, shape, (Method)method, substeps, NULL,
                          shape == 1 ? "-gravity 0.1,-0.3 -boundary_traction xmax -boundary_traction_xmax 0.02*(1+t),0.01" : "");
          row_body_start(&b);
          set_row_conditions(&b, conditions);
          load_rows(&b, 1, 0, 0.02);
          for (PetscInt level = 0; level <= substeps; level++)
            for (PetscInt i = 0; i < b.n; i++) set_row(&b.rows, b.traces.displacement_in, level, i, 0.01 * PetscSinReal(2 + 3 * i + level));
          first[asks] = answer_to_forces(&b);
          if (asks) know_all_rows(&b);
          ok(BodySave(b.body));
          second[asks] = answer_to_forces(&b);
          ok(BodySave(b.body));
          ok(BodyGetMeasures(b.body, &measures[asks]));
          ok(BodyGetTotalSubsteps(b.body, &count[asks], NULL));
          ok(BodyGetSolution(b.body, &u, NULL, NULL));
          ok(VecNorm(u, NORM_2, &norm[asks]));
          row_body_destroy(&b);
        }
        for (PetscInt k = 0; k < substeps; k++)
          for (PetscInt i = 0; i < n_rows_of[shape]; i++) {
            near(first[1].at[k][i], first[0].at[k][i], 1e-13);
            near(second[1].at[k][i], second[0].at[k][i], 1e-13);
          }
        near(norm[1], norm[0], 1e-13);
        near(measures[1].external_work, measures[0].external_work, 1e-13);
        near(measures[1].kinetic, measures[0].kinetic, 1e-13);
        near(measures[1].potential, measures[0].potential, 1e-13);
        assert_int_equal(count[0], count[1]);
      }
}

static void levels_it_has_not_are_refused(void **state)
{
  const PetscScalar *matrix;
  const PetscInt    *place;
  PetscInt           leading;
  RowBody            b;

  (void)state;
  row_body_create(&b, 1, IMPLICIT, 2, NULL, "");
  ok(BodyGetCompliance(b.body, 0, &place, &leading, &matrix)); /* of no row yet */
  for (PetscInt i = 0; i < b.n; i++) assert_int_equal(place[b.global[i]], -1);
  know_all_rows(&b);
  refused(PETSC_ERR_ARG_OUTOFRANGE, "Level 2|2 substeps", BodyGetCompliance(b.body, 2, &place, &leading, &matrix));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "Level -2", BodyGetCompliance(b.body, -2, &place, &leading, &matrix));
  row_body_destroy(&b);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_what_a_hat_brings),
      cmocka_unit_test(is_what_a_hat_brings_to_a_body_held_and_loaded),
      cmocka_unit_test(may_be_asked_for_in_any_order),
      cmocka_unit_test(forgets_rows),
      cmocka_unit_test(follows_rows_that_turn),
      cmocka_unit_test(of_a_nonlinear_body_at_rest_is_that_of_the_linear_one),
      cmocka_unit_test(leaves_no_trace),
      cmocka_unit_test(levels_it_has_not_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
