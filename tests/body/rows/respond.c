/* long: 3 */
/* Rows through a controller step by the compliance alone, against an integration under the same conditions. */
#include "row_bodies.h"

/* Prescribed, loaded and free rows, the first two beside each other and on one node */
#define CASES 4
static const BodyCondition cases[CASES][MOST_ROWS] = {
    {BODY_PRESCRIBED, BODY_FORCED, BODY_PRESCRIBED, BODY_FREE, BODY_FORCED},
    {BODY_FORCED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_FREE},
    {BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED},
    {BODY_FORCED, BODY_FORCED, BODY_FREE, BODY_FREE, BODY_FORCED},
};
static const BodyCondition all_forced[MOST_ROWS] = {BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED, BODY_FORCED};

static void write_inputs(RowBody *b, PetscInt seed)
{
  for (PetscInt i = 0; i < b->n; i++) {
    const PetscReal start = get_row(&b->rows, b->traces.displacement, 0, i);

    for (PetscInt level = 0; level <= b->substeps; level++) {
      set_row(&b->rows, b->traces.displacement_in, level, i, start + 0.01 * PetscSinReal(level * (1 + seed) * 0.3 * (i + 1)));
      set_row(&b->rows, b->traces.force_in, level, i, 0.02 * PetscSinReal(1 + i + 2 * level + 5 * seed));
    }
  }
}

typedef struct {
  PetscReal displacement[4][MOST_ROWS], reaction[4][MOST_ROWS];
} Outputs;

static Outputs get_outputs(RowBody *b)
{
  Outputs outputs;

  for (PetscInt k = 0; k < b->substeps; k++)
    for (PetscInt i = 0; i < b->n; i++) {
      outputs.displacement[k][i] = get_row(&b->rows, b->traces.displacement, k + 1, i);
      outputs.reaction[k][i]     = get_row(&b->rows, b->traces.reaction, k + 1, i);
    }
  return outputs;
}

static void compare(RowBody *b, const Outputs *responded, const Outputs *integrated, const BodyCondition roles[])
{
  for (PetscInt k = 0; k < b->substeps; k++)
    for (PetscInt i = 0; i < b->n; i++) {
      near(responded->displacement[k][i], integrated->displacement[k][i], 1e-12);
      /* of some tenths of N; round-off of displacements of 1e-2 m against stiffnesses of 5 N/m, the heavier against inertia 4 m / dt^2
         where steps are short */
      if (roles[i] == BODY_PRESCRIBED) near(responded->reaction[k][i], integrated->reaction[k][i], 1e-11);
      else assert_true(responded->reaction[k][i] == 0);
    }
}

/* With a base of no contact, and one under forces */
static void check_responses(RowBody *b, PetscBool free_base)
{
  row_body_start(b);
  know_all_rows(b);
  for (PetscInt base = 0; base < 2; base++)
    for (PetscInt c = 0; c < CASES; c++)
      for (PetscInt seed = 1; seed < 3; seed++) {
        static const BodyCondition none[MOST_ROWS] = {BODY_FREE, BODY_FREE, BODY_FREE, BODY_FREE, BODY_FREE};
        Outputs                    responded, integrated;

        set_row_conditions(b, base ? all_forced : none);
        write_inputs(b, 0);
        if (free_base && !base) ok(BodySetFreeBase(b->body));
        else {
          ok(BodyIntegrate(b->body));
          ok(BodySetBase(b->body));
        }
        set_row_roles(b, cases[c]);
        write_inputs(b, seed);
        ok(BodyRespond(b->body));
        responded = get_outputs(b);
        set_row_conditions(b, cases[c]);
        write_inputs(b, seed);
        ok(BodyIntegrate(b->body));
        integrated = get_outputs(b);
        compare(b, &responded, &integrated, cases[c]);
      }
}

static void is_what_an_integration_brings(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        RowBody   b;
        PetscBool has;

        if (shape == 0 && method == STATIC) continue; /* one of its rows is held */
        row_body_create(&b, shape, (Method)method, substeps, NULL, "");
        ok(BodyHasFreeRows(b.body, &has));
        assert_int_equal(has, method == EXPLICIT && substeps == 1);
        check_responses(&b, has);
        row_body_destroy(&b);
      }
}

/* Dashpots act on what has mass alone, and on held dofs that move */
static void is_what_an_integration_brings_with_dashpots(void **state)
{
  static const char *const loads[SHAPES_OF_BODIES] = {"", "-boundary_displacement ymin -boundary_displacement_ymin 0.01*t,free",
                                                      "-gravity 0,0,-0.3"};

  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        char      options[512];
        RowBody   b;
        PetscBool has;

        if (method == STATIC) continue; /* it has no dashpots */
        (void)snprintf(options, sizeof(options), "-damping_mass 0.7 -damping_stiffness 0.02 %s", loads[shape]);
        row_body_create(&b, shape, (Method)method, substeps, NULL, options);
        ok(BodyHasFreeRows(b.body, &has));
        check_responses(&b, has);
        row_body_destroy(&b);
      }
}

/* Weight acts on what has mass, and tractions on the side across; nothing from outside acts on the contact nodes */
static void is_what_an_integration_brings_under_loads(void **state)
{
  static const char *const loads[SHAPES_OF_BODIES] = {
      "-gravity 0.3", "-gravity 0.1,-0.3 -boundary_displacement ymin -boundary_displacement_ymin 0.01*t,free",
      "-gravity 0,0,-0.3 -boundary_displacement zmin -boundary_displacement_zmin 0.01*t,free,0"};

  (void)state;
  for (PetscInt shape = 0; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
        RowBody   b;
        PetscBool has;

        if (method == STATIC) continue; /* it has no mass to take from its contact nodes, which gravity pulls at */
        row_body_create(&b, shape, (Method)method, substeps, NULL, loads[shape]);
        ok(BodyHasFreeRows(b.body, &has));
        check_responses(&b, has);
        row_body_destroy(&b);
      }
}

static void rows_that_are_not_known_are_refused(void **state)
{
  RowBody b;

  (void)state;
  row_body_create(&b, 1, IMPLICIT, 1, NULL, "");
  refused(PETSC_ERR_ARG_WRONGSTATE, "BodySetBase()", BodyRespond(b.body));
  ok(BodyExtendCompliance(b.body, 1, b.global));
  refused(PETSC_ERR_ARG_WRONGSTATE, "body 'b'|not known|BodyExtendCompliance()", set_roles(&b, cases[0]));
  refused(PETSC_ERR_SUP, "'b'|not explicit", BodySetFreeBase(b.body));
  row_body_destroy(&b);
}

/* A row that is there twice determines no force */
static void rows_that_are_not_independent_are_refused(void **state)
{
  PetscReal directions[3 * MOST_ROWS];
  RowBody   b;

  (void)state;
  for (PetscInt i = 0; i < 3 * MOST_ROWS; i++) directions[i] = row_directions_of[1][i];
  directions[6] = 0.6;
  directions[7] = 0.8;
  row_body_create(&b, 1, IMPLICIT, 1, directions, "");
  know_all_rows(&b);
  refused(PETSC_ERR_MAT_LU_ZRPVT, "body 'b'|not independent|two contact pairs", set_roles(&b, cases[2]));
  row_body_destroy(&b);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_what_an_integration_brings),
      cmocka_unit_test(is_what_an_integration_brings_under_loads),
      cmocka_unit_test(is_what_an_integration_brings_with_dashpots),
      cmocka_unit_test(rows_that_are_not_known_are_refused),
      cmocka_unit_test(rows_that_are_not_independent_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
