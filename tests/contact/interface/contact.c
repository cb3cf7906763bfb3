/* Contact pairs and their sides, obstacles, settings, their errors, and what all contact methods share. */
#include "simulation.h"
#include <controller/controllerimpl.h>
#include <impakt/private/contactimpl.h>

/* Bodies that are names only, for the parsing of pairs */
static Contact CreateNames(void)
{
  const char *const names[] = {"a", "b", "c"};
  Body              bodies[3];
  Contact           contact;

  for (PetscInt b = 0; b < 3; b++) ok(BodyCreate(PETSC_COMM_WORLD, names[b], &bodies[b]));
  ok(ContactCreate(PETSC_COMM_WORLD, &contact));
  ok(ContactSetBodies(contact, 3, bodies));
  for (PetscInt b = 0; b < 3; b++) ok(BodyDestroy(&bodies[b]));
  return contact;
}

static void pairs_are_parsed(void **state)
{
  const char *name;
  Body        sides[2];
  PetscInt    n;
  Contact     contact = CreateNames();

  (void)state;
  ok(ContactAddPair(contact, "c:a"));
  ok(ContactAddPair(contact, "a.xmax:b.2"));
  ok(ContactGetNumPairs(contact, &n));
  assert_int_equal(n, 2);
  ok(ContactGetPair(contact, 0, &name, &sides[0], &sides[1]));
  assert_string_equal(name, "c:a");
  assert_ptr_equal(sides[0], contact->bodies[2]);
  assert_ptr_equal(sides[1], contact->bodies[0]);
  assert_null(contact->pairs[0].surface[0]);
  assert_null(contact->pairs[0].surface[1]);
  assert_string_equal(contact->pairs[1].surface[0], "xmax");
  assert_string_equal(contact->pairs[1].surface[1], "2");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no pair 2|there are 2", ContactGetPair(contact, 2, &name, NULL, NULL));
  ok(ContactDestroy(&contact));
}

static void wrong_pairs_are_refused(void **state)
{
  Contact contact = CreateNames();

  (void)state;
  refused(PETSC_ERR_USER_INPUT, "a:x|no body 'x'|a, b, c", ContactAddPair(contact, "a:x"));
  refused(PETSC_ERR_USER_INPUT, "no body ''", ContactAddPair(contact, ":b"));
  refused(PETSC_ERR_USER_INPUT, "ab|colon", ContactAddPair(contact, "ab"));
  refused(PETSC_ERR_USER_INPUT, "b:b|itself", ContactAddPair(contact, "b:b"));
  ok(ContactAddPair(contact, "a:b"));
  refused(PETSC_ERR_USER_INPUT, "a:b|twice", ContactAddPair(contact, "a:b"));
  ok(ContactDestroy(&contact));
}

/* Each body would wait for the reaction of the one before */
static void circles_are_refused(void **state)
{
  const char *const circles[][3] = {{"a:b", "b:c", "c:a"}, {"a:b", "b:a", "b:c"}};

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    Contact contact = CreateNames();

    ok(ContactSetType(contact, CONTACT_ALTERNATION));
    for (PetscInt p = 0; p < 3; p++) ok(ContactAddPair(contact, circles[i][p]));
    refused(PETSC_ERR_USER_INPUT, "circle", ContactSetUp(contact));
    ok(ContactDestroy(&contact));
  }
}

static void two_bodies_are_a_pair(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const char *name;
  PetscReal   normal[3], positions[6], velocities[6];
  ContactType type;
  PetscInt    n;
  Body        sides[2];

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(ContactGetNumPairs(simulation->contact, &n));
  assert_int_equal(n, 1);
  ok(ContactGetPair(simulation->contact, 0, &name, &sides[0], &sides[1]));
  assert_string_equal(name, "left:right");
  ok(ContactGetBodyTraces(simulation->contact, positions, velocities));
  for (PetscInt b = 0; b < 2; b++) {
    assert_ptr_equal(sides[b], simulation->bodies[b]);
    near(positions[3 * b], (b ? 1 : -1) * COLLISION_GAP / 2, 1e-15);
    near(velocities[3 * b], (b ? -1 : 1) * COLLISION_SPEED, 0);
  }
  ok(ContactGetPairTraits(simulation->contact, 0, NULL, NULL, normal));
  near(normal[0], 1, 0);
  near(normal[1], 0, 0);
  ok(ContactGetType(simulation->contact, &type));
  assert_string_equal(type, CONTACT_SCHWARZ);
}

/* Three bars of 1/4 m with 10 mm between them; the left one moves right at 0.1 m/s */
static void AddRow(void)
{
  AddBar("a", 0, 0.25, 8, 0.1);
  AddBar("b", 0.26, 0.51, 8, 0);
  AddBar("c", 0.52, 0.77, 8, 0);
  AddOptions("-time_step 0.01 -time_end 1.2");
}

static void three_bodies_need_pairs(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddRow();
  AddOptions("-bodies a,b,c");
  refused(PETSC_ERR_USER_INPUT, "3 bodies|-contact_pairs", SimulationCreate(simulation));
}

static void unknown_type_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-contact_type schwartz");
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'schwartz'|alternation, augmented_lagrangian, lagrange, penalty, schwarz",
          SimulationCreate(simulation));
}

static void overlap_at_the_start_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-right_dm_plex_box_lower -0.101"); /* the left bar ends at -0.001 */
  refused(PETSC_ERR_USER_INPUT, "'left'|'right'|overlap by 0.1 m", SimulationCreate(simulation));
}

/* Initial displacements count */
static void displacement_into_each_other_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-left_initial_displacement 0.052"); /* the gap is 0.002 */
  refused(PETSC_ERR_USER_INPUT, "'left'|'right'|overlap by 0.05 m", SimulationCreate(simulation));
}

/* What default tolerances are parts of: the size of the smallest body, and the least E A */
static void tolerances_follow_the_size(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-right_dm_plex_box_upper 0.251 -left_youngs_modulus 3 -left_cross_section 2 -right_youngs_modulus 5 -right_cross_section 1");
  ok(SimulationCreate(simulation));
  near(simulation->contact->scale.length, 0.25, 1e-15);
  near(simulation->contact->scale.force, 5, 1e-14);
}

static void set_up_is_final(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetUp()", ContactAddPair(simulation->contact, "right:left"));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetUp()", ContactSetType(simulation->contact, CONTACT_LAGRANGE));
}

static void bad_values_are_refused(void **state)
{
  static const char *const cases[][2] = {
      {"-contact_tolerance", "not be negative"},    {"-contact_energy_excess", "not be negative"},
      {"-contact_energy_tolerance", "be positive"}, {"-contact_tie_distance", "be positive"},
      {"-contact_slip_bound", "be positive"},       {"-contact_angle_bound", "be positive"},
  };
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    ok(PetscOptionsSetValue(NULL, cases[k][0], "-1"));
    refused(PETSC_ERR_USER_INPUT, cases[k][1], SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
    ok(PetscOptionsClearValue(NULL, cases[k][0]));
  }
}

static void of_the_controller(void **state)
{
  Controller controller;

  (void)state;
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  ok(ControllerSetEnergyGuard(controller, 0.125));
  ok(ControllerSetStepCuts(controller, 3));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "energy guard -1|negative", ControllerSetEnergyGuard(controller, -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "in halves 0 to|not -1", ControllerSetStepCuts(controller, -1));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "in halves 0 to|not 1000", ControllerSetStepCuts(controller, 1000));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "interval of 0 steps", ControllerSetMonitorInterval(controller, 0));
  near(controller->guard.part, 0.125, 0);
  assert_int_equal(controller->most_cuts, 3);
  ok(ControllerDestroy(&controller));
}

static void AddBox(const char name[], PetscInt dim, const char faces[], const char lower[], const char upper[], const char more[])
{
  char options[1024];

  ok(PetscSNPrintf(options, sizeof(options),
                   "-prefix_push %s_ -dm_plex_dim %d -dm_plex_simplex 0 -dm_plex_box_faces %s -dm_plex_box_lower %s -dm_plex_box_upper %s "
                   "-density 1 -youngs_modulus 1 -mass_redistribute true %s -prefix_pop",
                   name, (int)dim, faces, lower, upper, more));
  AddOptions(options);
}

static void check_pairs(Simulation *simulation, PetscInt n, const char *const expected[])
{
  PetscInt found;

  ok(ContactGetNumPairs(simulation->contact, &found));
  assert_int_equal(found, n);
  for (PetscInt p = 0; p < n; p++) {
    const char *name;

    ok(ContactGetPair(simulation->contact, p, &name, NULL, NULL));
    assert_string_equal(name, expected[p]);
  }
}

#define FLOOR "-floor_obstacle_type plane -floor_point 0,-1,0 -floor_normal 0,1,0 "
#define WALL  "-wall_obstacle_type plane -wall_point 9,0,0 -wall_normal -1,0,0 "

/* The implicit body, then the finer mesh, then the one named first */
static void sides_are_chosen(void **state)
{
  static const char *const finer[]           = {"a:b", "c:a", "c:b", "a:floor", "a:wall", "b:floor", "b:wall", "c:floor", "c:wall"},
                           *const implicit[] = {"a:b", "a:c", "b:c", "a:floor", "a:wall", "b:floor", "b:wall", "c:floor", "c:wall"};
  Simulation                     *simulation = (Simulation *)*state;

  AddBox("a", 2, "3,3", "0,0", "1,1", "");
  AddBox("b", 2, "3,3", "2,0", "3,1", "");
  AddBox("c", 2, "4,4", "4,0", "5,1", "");
  AddOptions(FLOOR WALL "-obstacles floor,wall -bodies a,b,c -contact_pairs auto -time_step 0.01 -time_end 0.1");
  ok(SimulationCreate(simulation));
  check_pairs(simulation, 9, finer);
  SimulationRepeat(simulation, "-c_ts_type centraldifference");
  check_pairs(simulation, 9, implicit);
  ok(ContactStep(simulation->contact));
}

/* A tilde leaves the order to the program, also of surfaces; a colon does not, and obstacles stay second */
static void tilde_leaves_the_order_open(void **state)
{
  static const char *const finer[] = {"b.xmin:a.xmax", "a:c", "b:floor"}, *const implicit[] = {"a.xmax:b.xmin", "a:c", "b:floor"};
  Simulation *simulation = (Simulation *)*state;

  AddBox("a", 2, "3,3", "0,0", "1,1", "");
  AddBox("b", 2, "4,4", "2,0", "3,1", "");
  AddBox("c", 2, "4,4", "0,2", "1,3", "");
  AddOptions(FLOOR "-obstacles floor -bodies a,b,c -contact_pairs a.xmax~b.xmin,a:c,b~floor -time_step 0.01 -time_end 0.1");
  ok(SimulationCreate(simulation));
  check_pairs(simulation, 3, finer);
  SimulationRepeat(simulation, "-b_ts_type centraldifference");
  check_pairs(simulation, 3, implicit);
}

/* Each is by less than a thousandth finer than the one before, and the last by more than the first: no circle may come of it */
static void nearly_equal_meshes_form_no_circle(void **state)
{
  static const char *const expected[] = {"a:b", "c:a", "c:b"};
  Simulation              *simulation = (Simulation *)*state;

  AddBox("a", 2, "10,3", "0,0", "1,1", "");
  AddBox("b", 2, "10,3", "2,0", "2.999,1", ""); /* the edge is the root of the area */
  AddBox("c", 2, "10,3", "4,0", "4.9978,1", "");
  AddOptions("-bodies a,b,c -contact_pairs auto -time_step 0.01 -time_end 0.1");
  ok(SimulationCreate(simulation));
  check_pairs(simulation, 3, expected);
}

/* On a line, what lies between two bodies keeps them apart: the end of a bar has one partner */
static void bars_touch_their_neighbours(void **state)
{
  static const char *const expected[] = {"a:b", "b:c", "a:floor", "c:wall"};
  const PetscReal          energy     = 0.5 * 0.1 * 0.1 * 1.9; /* of a and c [J] */
  Simulation              *simulation = (Simulation *)*state;

  AddBar("c", 3, 4, 10, -0.1);
  AddBar("a", 0.1, 1, 9, 0.1);
  AddBar("b", 1.5, 2.5, 10, 0);
  AddOptions("-floor_obstacle_type plane -floor_point 0 -floor_normal 1 -wall_obstacle_type plane -wall_point 5 -wall_normal -1 -obstacles "
             "floor,wall -bodies a,b,c -contact_pairs auto -time_step 0.1 -time_end 20");
  ok(SimulationCreate(simulation));
  check_pairs(simulation, 4, expected);
  for (PetscInt step = 0; step < 200; step++) (void)Step(simulation);
  /* all pairs have been in contact, some at the same time */
  between(TotalEnergy(simulation), 0.99 * energy, 1.01 * energy);
}

static void the_order_of_the_user_stands(void **state)
{
  static const char *const expected[] = {"a:b"};
  Simulation              *simulation = (Simulation *)*state;

  AddBox("a", 2, "2,2", "0,0", "1,1", "-ts_type centraldifference");
  AddBox("b", 2, "7,7", "2,0", "3,1", "");
  AddOptions("-bodies a,b -contact_pairs a:b -time_step 0.01 -time_end 0.1");
  ok(SimulationCreate(simulation));
  check_pairs(simulation, 1, expected);
}

static void bad_pairs_are_refused(void **state)
{
  static const struct {
    const char *options, *words;
  } cases[] = {
      {"-contact_pairs a:floor -obstacles floor " FLOOR "-floor_point 0,0.5,0", "a:floor|inside the obstacle"},
      {"-contact_type alternation -contact_pairs a:b,b:a", "circle"},
      {"-contact_pairs a.left:b", "left"},
      {"-contact_pairs a.xmin:b.xmax", "a.xmin:b.xmax|do not face each other"},
      {"-contact_pairs a:b,a:floor -obstacles floor -contact_swap_sides " FLOOR, "a:floor|no other side"},
      {"-contact_pairs a:b,a:floor -obstacles floor -schwarz_transmission robin " FLOOR, "a:floor|no other side"},
      {"-contact_pairs a:b,a:floor -obstacles floor -schwarz_transmission impedance " FLOOR, "a:floor|no other side"},
  };
  Simulation *simulation = (Simulation *)*state;

  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    AddBox("a", 2, "3,3", "0,0", "1,1", "");
    AddBox("b", 2, "3,3", "2,0", "3,1", "");
    AddOptions("-bodies a,b -time_step 0.01 -time_end 0.1");
    AddOptions(cases[i].options);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
    options_drop(simulation->options);
    simulation->options = options_begin("");
  }
}

static void bodies_of_different_dimension_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddBox("a", 2, "3,3", "0,0", "1,1", "");
  AddBox("b", 3, "3,3,3", "2,0,0", "3,1,1", "");
  AddOptions("-bodies a,b -time_step 0.01 -time_end 0.1");
  refused(PETSC_ERR_USER_INPUT, "a:b|dimension|2|3", SimulationCreate(simulation));
}

/* A body thrown at a plane, a disc, or a sphere, bounces: what it hands over as impulse it gains in momentum, along all axes, and it does
   not get in. A plane has a normal against the fall, of which only one component takes part. */
static void check_bounce(Simulation *simulation, PetscInt dim, PetscInt steps)
{
  BodyMeasures     before, after;
  PetscReal        deepest = 0;
  PetscInt         touched = 0;
  ContactPairState pair    = {0};

  ok(BodyGetMeasures(simulation->bodies[0], &before));
  for (PetscInt step = 0; step < steps; step++) {
    pair    = Step(simulation);
    deepest = PetscMin(deepest, pair.gap);
    touched += pair.active > 0;
  }
  ok(BodyGetMeasures(simulation->bodies[0], &after));
  assert_true(touched > 3);
  assert_int_equal(pair.active, 0);
  between(deepest, -1e-10, 0);
  assert_true(after.momentum[dim - 1] > 0 && before.momentum[dim - 1] < 0);
  for (PetscInt d = 0; d < dim; d++)
    near(after.momentum[d] - before.momentum[d], -pair.impulse[d], 1e-12 * PetscAbsReal(before.momentum[dim - 1])); /* round-off */
}

static const char *const integrators_of_bodies[] = {"", "-a_ts_type centraldifference"};
static const char *const planes[] = {"-o_obstacle_type plane -o_point 0 -o_normal 1 ", "-o_obstacle_type plane -o_point 0,0 -o_normal 0,1 ",
                                     "-o_obstacle_type plane -o_point 0,0,0 -o_normal 0,0,1 "};
static const char *const rounds[] = {NULL, "-o_obstacle_type cylinder -o_point 0.5,-2 -o_radius 2 ",
                                     "-o_obstacle_type sphere -o_point 0.5,0.5,-2 -o_radius 2 "};
static const char *const lying[]  = {NULL, NULL, "-o_obstacle_type cylinder -o_point 0.5,0.5,-2 -o_radius 2 -o_axis 0,1,0 "};

static void AddThrown(PetscInt dim, const char obstacle[])
{
  static const char *const faces[] = {"12", "3,4", "2,2,3"}, *const lowers[] = {"0.02", "0,0.02", "0,0,0.02"},
                           *const uppers[]     = {"1.02", "1,1.02", "1,1,1.02"},
                           *const velocities[] = {"-initial_velocity -0.1", "-initial_velocity 0.01,-0.1", "-initial_velocity 0.01,0,-0.1"};

  AddBox("a", dim, faces[dim - 1], lowers[dim - 1], uppers[dim - 1], velocities[dim - 1]);
  AddOptions(obstacle);
  AddOptions("-bodies a -obstacles o -time_step 0.04 -time_end 4 ");
}

static void thrown_bodies_bounce(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  for (PetscInt dim = 1; dim <= 3; dim++)
    for (PetscInt kind = 0; kind < 3; kind++)
      for (PetscInt i = 0; i < 2; i++) {
        const char *obstacle = kind == 0 ? planes[dim - 1] : kind == 1 ? rounds[dim - 1] : lying[dim - 1];

        if (!obstacle) continue;
        AddThrown(dim, obstacle);
        AddOptions("-contact_type schwarz");
        SimulationRepeat(simulation, integrators_of_bodies[i]);
        check_bounce(simulation, dim, 100);
        ok(ControllerDestroy(&simulation->controller));
        options_drop(simulation->options);
        simulation->options = options_begin("");
      }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(pairs_are_parsed),
      simulation_test(wrong_pairs_are_refused),
      simulation_test(circles_are_refused),
      simulation_test(two_bodies_are_a_pair),
      simulation_test(three_bodies_need_pairs),
      simulation_test(unknown_type_is_refused),
      simulation_test(overlap_at_the_start_is_refused),
      simulation_test(displacement_into_each_other_is_refused),
      simulation_test(tolerances_follow_the_size),
      simulation_test(set_up_is_final),
      simulation_test(bad_values_are_refused),
      cmocka_unit_test(of_the_controller),
      simulation_test(sides_are_chosen),
      simulation_test(tilde_leaves_the_order_open),
      simulation_test(nearly_equal_meshes_form_no_circle),
      simulation_test(bars_touch_their_neighbours),
      simulation_test(the_order_of_the_user_stands),
      simulation_test(bad_pairs_are_refused),
      simulation_test(bodies_of_different_dimension_are_refused),
      simulation_test(thrown_bodies_bounce),
  };

  return impakt_main(argc, argv, tests);
}
