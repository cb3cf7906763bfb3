/* ranks: 1 3 */
/* long: 3 */
/* Prescribed rows of one node along any directions, beside displacements that are held, and more than its displacements can follow. */
#include "solid_bodies.h"
#include <impakt/private/bodyrows.h>
#include <impakt/private/bodystep.h>
#include <impakt/private/bodysweeps.h>

/* Linear bodies of quadrilaterals and hexahedra of edge 0.5 m, by their dimension less 1; 5 Pa and 3 kg/m^3, so that waves run at some 1.4
   m/s; explicit steps are stable up to some 0.25 s */
#define SHAPES_OF_BODIES 3
static const char *const meshes[SHAPES_OF_BODIES] = {
    NULL,
    "-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5 -density 3 -youngs_modulus 5 -poissons_ratio 0.2",
    "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 3,2,3 -dm_plex_box_upper 1.5,1,1.5 -density 3 -youngs_modulus 5 -poissons_ratio "
    "0.2"};
/* one node of the bottom is held along one axis or more: static bodies cannot do without */
static const char *const supports[SHAPES_OF_BODIES] = {NULL, "-boundary_displacement xmin -boundary_displacement_xmin 0.01*t,0",
                                                       "-boundary_displacement xmin -boundary_displacement_xmin 0.01*t,0,0"};

typedef enum { IMPLICIT, STATIC, EXPLICIT, METHODS } Method;
static const char *const methods[METHODS] = {"-ts_type alpha2", "-ts_type static", "-ts_type centraldifference"};

/* Rows on the side that may touch, the last of which is at its edge x = 0, which supports hold */
#define MOST_ROWS 5
static const PetscReal row_nodes_of[SHAPES_OF_BODIES][3 * MOST_ROWS] = {
    {0}, {0.5, 1.5, 0, 1, 1.5, 0, 1, 1.5, 0, 1.5, 1.5, 0, 2, 1.5, 0}, {0.5, 0.5, 1.5, 0.5, 1, 1.5, 1, 0.5, 1.5, 1, 0.5, 1.5, 1.5, 1, 1.5}};
#define CONTROLLER_STEP 0.12

typedef struct {
  Body         body;
  PetscOptions options;
  BodyTraces   traces;
  NodeRows     rows;
  PetscInt     n, substeps;
} RowBody;

/* A body at rest */
static void row_body_create(RowBody *b, PetscInt shape, Method method, PetscInt substeps, const PetscReal directions[], const char more[])
{
  b->substeps = substeps;
  b->n        = MOST_ROWS;
  b->options  = solid_body_create(&b->body, "%s %s %s -ts_time_step %.17g %s", meshes[shape], method == STATIC ? supports[shape] : "",
                                  methods[method], CONTROLLER_STEP / substeps, more);
  touch_side(b->body, shape == 1 ? "ymax" : "zmax");
  set_node_rows(b->body, b->n, row_nodes_of[shape], directions, &b->rows);
  ok(BodySetControllerStep(b->body, 0, CONTROLLER_STEP));
  ok(BodySetUp(b->body));
  ok(BodyGetTraces(b->body, &b->traces));
}

/* Under way: one controller step after a start without any pattern */
static void row_body_start(RowBody *b)
{
  if (b->body->integrator->has_inertia) ok(BodySetInitialState(b->body, ScatteredState, NULL));
  ok(BodyIntegrate(b->body));
  ok(BodySave(b->body));
}

static void row_body_destroy(RowBody *b)
{
  bar_destroy(&b->body, b->options);
}

static void set_row_conditions(RowBody *b, const BodyCondition conditions[])
{
  BodyCondition mine[MOST_ROWS];

  for (PetscInt i = 0; i < b->rows.local; i++) mine[i] = conditions[b->rows.which[i]];
  ok(BodySetConditions(b->body, mine));
}

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
  ok(VecGetArrayRead(body->mesh.positions, &position));
  ok(VecGetArrayRead(u, &values));
  for (PetscInt dof = 0; dof < n; dof += 2)
    if (PetscAbsReal(position[dof] - 2) + PetscAbsReal(position[dof + 1] - 1.5) < 1e-9) value = values[dof];
  ok(VecRestoreArrayRead(u, &values));
  ok(VecRestoreArrayRead(body->mesh.positions, &position));
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(are_prescribed),
      cmocka_unit_test(are_prescribed_with_mass),
      cmocka_unit_test(stand_beside_held_displacements),
      cmocka_unit_test(that_are_parallel_share),
  };

  return impakt_main(argc, argv, tests);
}
