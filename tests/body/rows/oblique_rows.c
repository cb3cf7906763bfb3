/* long: 3 */
/* Prescribed rows of one node along any directions, beside displacements that are held, and more than its displacements can follow. */
#include "row_bodies.h"

/* The second and third row share a node; in the plane they are 53 degrees apart, in space so is the fourth from both */
static const PetscReal oblique[SHAPES_OF_BODIES][3 * MOST_ROWS] = {
    {0}, {0, 1, 0, 0.6, 0.8, 0, -0.28, 0.96, 0, 0, 1, 0, 0, 1, 0}, {0, 0, 1, 0, 0, 1, 0, 0.6, 0.8, 0.48, -0.64, 0.6, 0, 0, 1}};
static const BodyCondition prescribed[MOST_ROWS] = {BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED};
static const BodyCondition mixed[MOST_ROWS]      = {BODY_FORCED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_PRESCRIBED, BODY_FREE};

static void write_inputs(RowBody *b)
{
  for (PetscInt i = 0; i < b->n; i++)
    for (PetscInt level = 0; level <= b->substeps; level++) {
      set_row(&b->rows, b->traces.displacement_in, level, i,
              get_row(&b->rows, b->traces.displacement, 0, i) + 0.01 * PetscSinReal(0.3 * level * (i + 1)));
      set_row(&b->rows, b->traces.velocity_in, level, i, 0.02 * PetscSinReal(i + level));
      set_row(&b->rows, b->traces.acceleration_in, level, i, 0.03 * PetscCosReal(i + 2 * level));
      set_row(&b->rows, b->traces.force_in, level, i, 0.02 * PetscSinReal(1 + i + 2 * level));
    }
}

/* What is prescribed is what comes out */
static void check_prescribed(RowBody *b, const BodyCondition conditions[], PetscBool rates)
{
  for (PetscInt level = 1; level <= b->substeps; level++)
    for (PetscInt i = 0; i < b->n; i++) {
      if (conditions[i] != BODY_PRESCRIBED) continue;
      near(get_row(&b->rows, b->traces.displacement, level, i), get_row(&b->rows, b->traces.displacement_in, level, i), 1e-14);
      if (!rates) continue;
      near(get_row(&b->rows, b->traces.velocity, level, i), get_row(&b->rows, b->traces.velocity_in, level, i), 1e-14);
      near(get_row(&b->rows, b->traces.acceleration, level, i), get_row(&b->rows, b->traces.acceleration_in, level, i),
           1e-12); /* beside others of 1 m/s^2 and more */
    }
}

/* Under the reactions as forces, and no row prescribed, the body does the same: they hold it where it is */
static void check_reactions(RowBody *b, const BodyCondition conditions[], PetscReal tolerance)
{
  BodyCondition forced[MOST_ROWS];
  PetscReal     displacement[4][MOST_ROWS];

  for (PetscInt i = 0; i < b->n; i++) {
    forced[i] = conditions[i] == BODY_PRESCRIBED ? BODY_FORCED : conditions[i];
    for (PetscInt level = 1; level <= b->substeps; level++) {
      displacement[level - 1][i] = get_row(&b->rows, b->traces.displacement, level, i);
      if (conditions[i] == BODY_PRESCRIBED)
        set_row(&b->rows, b->traces.force_in, level, i, get_row(&b->rows, b->traces.reaction, level, i));
    }
  }
  set_row_conditions(b, forced);
  ok(BodyRestore(b->body));
  ok(BodyIntegrate(b->body));
  for (PetscInt level = 1; level <= b->substeps; level++)
    for (PetscInt i = 0; i < b->n; i++) near(get_row(&b->rows, b->traces.displacement, level, i), displacement[level - 1][i], tolerance);
}

static const char *const materials[] = {"linear_elastic", "neo_hookean"};

static void are_prescribed(void **state)
{
  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt method = 0; method < METHODS; method++)
      for (PetscInt kind = 0; kind < 2; kind++)
        for (PetscInt substeps = 1; substeps <= 4; substeps += 3) {
          const BodyCondition *conditions[] = {prescribed, mixed};
          char                 more[64];
          RowBody              b;

          snprintf(more, sizeof(more), "-material_type %s", materials[kind]);
          row_body_create(&b, shape, (Method)method, substeps, oblique[shape], more);
          row_body_start(&b);
          for (PetscInt c = 0; c < 2; c++) {
            set_row_conditions(&b, conditions[c]);
            write_inputs(&b);
            ok(BodyIntegrate(b.body));
            check_prescribed(&b, conditions[c], PETSC_FALSE);
            check_reactions(&b, conditions[c], kind ? 1e-11 : 1e-13); /* Newton's method leaves 1e-12 of the forces */
          }
          row_body_destroy(&b);
        }
}

/* With mass on them, velocities and accelerations too, whatever the mass matrix */
static void are_prescribed_with_mass(void **state)
{
  static const char *const masses[] = {"-mass_redistribute 0 -mass_type lumped", "-mass_redistribute 0 -mass_type consistent"};

  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++)
    for (PetscInt mass = 0; mass < 2; mass++)
      for (PetscInt method = 0; method < METHODS; method += EXPLICIT) {
        RowBody b;

        row_body_create(&b, shape, (Method)method, 4, oblique[shape], masses[mass]);
        row_body_start(&b);
        set_row_conditions(&b, mixed);
        write_inputs(&b);
        ok(BodyIntegrate(b.body));
        check_prescribed(&b, mixed, PETSC_TRUE);
        row_body_destroy(&b);
      }
}

/* The displacement of node (2, 1.5) along x */
static PetscReal end_displacement(Body body)
{
  const PetscScalar *position, *values;
  PetscReal          value = 0;
  PetscInt           n;
  Vec                u;

  ok(BodyGetSolution(body, &u, NULL, NULL));
  ok(VecGetLocalSize(u, &n));
  ok(VecGetArrayRead(body->positions, &position));
  ok(VecGetArrayRead(u, &values));
  for (PetscInt dof = 0; dof < n; dof += 2)
    if (PetscAbsReal(position[dof] - 2) + PetscAbsReal(position[dof + 1] - 1.5) < 1e-9) value = values[dof];
  ok(VecRestoreArrayRead(u, &values));
  ok(VecRestoreArrayRead(body->positions, &position));
  return sum_over_ranks(value);
}

/* At the end x = 2 one displacement is held: along an oblique row there, the other one does all, and the held one stays */
static void stand_beside_held_displacements(void **state)
{
  (void)state;
  for (PetscInt method = 0; method < METHODS; method++)
    for (PetscInt kind = 0; kind < 2; kind++) {
      PetscReal across[3 * MOST_ROWS];
      char      more[256];
      RowBody   b;

      for (PetscInt i = 0; i < 3 * MOST_ROWS; i++) across[i] = oblique[1][i];
      across[12] = 0.6;
      across[13] = 0.8;
      snprintf(more, sizeof(more), "-material_type %s %s", materials[kind],
               method == STATIC ? "-boundary_displacement xmax,xmin -boundary_displacement_xmax 0.02*t,free -boundary_displacement_xmin 0,0"
                                : "-boundary_displacement xmax -boundary_displacement_xmax 0.02*t,free");
      row_body_create(&b, 1, (Method)method, 1, across, more);
      row_body_start(&b);
      set_row_conditions(&b, prescribed);
      write_inputs(&b);
      ok(BodyIntegrate(b.body));
      check_prescribed(&b, prescribed, PETSC_FALSE);
      near(end_displacement(b.body), 0.02 * 2 * CONTROLLER_STEP, 1e-15);
      check_reactions(&b, prescribed, kind ? 1e-11 : 1e-13);
      near(end_displacement(b.body), 0.02 * 2 * CONTROLLER_STEP, 1e-15);
      row_body_destroy(&b);
    }
}

/* Two rows of a node with one direction: it follows their weighted mean, and each has its part of the force */
static void that_are_parallel_share(void **state)
{
  static const PetscReal parallel[3 * MOST_ROWS] = {0, 1, 0, 0.6, 0.8, 0, 0.6, 0.8, 0, 0, 1, 0, 0, 1, 0};
  PetscReal              weights[MOST_ROWS], all[MOST_ROWS] = {1, 3, 1, 1, 1};

  (void)state;
  for (PetscInt method = 0; method < METHODS; method++)
    for (PetscInt equal = 0; equal < 2; equal++) {
      const PetscReal part = equal ? 0.5 : 0.75;
      PetscReal       mean, total;
      RowBody         b;

      row_body_create(&b, 1, (Method)method, 1, parallel, "");
      row_body_start(&b);
      for (PetscInt i = 0; i < b.rows.local; i++) weights[i] = all[b.rows.which[i]];
      ok(BodySetRowWeights(b.body, equal ? NULL : weights));
      set_row_conditions(&b, mixed);
      write_inputs(&b);
      ok(BodyIntegrate(b.body));
      mean = part * get_row(&b.rows, b.traces.displacement_in, 1, 1) + (1 - part) * get_row(&b.rows, b.traces.displacement_in, 1, 2);
      near(get_row(&b.rows, b.traces.displacement, 1, 1), mean, 1e-14);
      total = get_row(&b.rows, b.traces.reaction, 1, 1) + get_row(&b.rows, b.traces.reaction, 1, 2);
      assert_true(PetscAbsReal(total) > 1e-3);
      near(get_row(&b.rows, b.traces.reaction, 1, 1), part * total, 1e-13);
      check_reactions(&b, mixed, 1e-13);
      row_body_destroy(&b);
    }
}

/* The acceleration of some rows goes, that across them stays */
static void lose_their_acceleration(void **state)
{
  (void)state;
  for (PetscInt shape = 1; shape < SHAPES_OF_BODIES; shape++) {
    static const PetscBool which[MOST_ROWS] = {PETSC_FALSE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE};
    PetscBool              mine[MOST_ROWS];
    PetscReal              before, after, change, product;
    Vec                    a, copy;
    RowBody                b;

    row_body_create(&b, shape, IMPLICIT, 1, oblique[shape], "-mass_redistribute 0");
    row_body_start(&b);
    ok(BodyIntegrate(b.body));
    ok(BodyGetSolution(b.body, NULL, NULL, &a));
    ok(VecDuplicate(a, &copy));
    ok(VecCopy(a, copy));
    before = get_row(&b.rows, b.traces.acceleration, 1, 2);
    assert_true(PetscAbsReal(before) > 1e-4);
    for (PetscInt i = 0; i < b.rows.local; i++) mine[i] = which[b.rows.which[i]];
    ok(BodyClearAcceleration(b.body, mine));
    for (PetscInt i = 1; i < b.n; i++) near(get_row(&b.rows, b.traces.acceleration, 1, i), 0, 1e-15);
    /* a projection: what is left is square to what has gone */
    ok(VecAXPY(copy, -1, a));
    ok(VecNorm(copy, NORM_2, &change));
    ok(VecNorm(a, NORM_2, &after));
    ok(VecDot(copy, a, &product));
    assert_true(change > 1e-4);
    near(product, 0, 1e-13 * change * after);
    ok(VecDestroy(&copy));
    row_body_destroy(&b);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(are_prescribed),
      cmocka_unit_test(are_prescribed_with_mass),
      cmocka_unit_test(stand_beside_held_displacements),
      cmocka_unit_test(that_are_parallel_share),
      cmocka_unit_test(lose_their_acceleration),
  };

  return impakt_main(argc, argv, tests);
}
