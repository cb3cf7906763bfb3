/* Contact pairs, their errors, and what all contact methods share. */
#include "simulation.h"
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

    for (PetscInt p = 0; p < 3; p++) ok(ContactAddPair(contact, circles[i][p]));
    refused(PETSC_ERR_USER_INPUT, "circle", ContactSetUp(contact));
    ok(ContactDestroy(&contact));
  }
}

static void two_bodies_are_a_pair(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const char *name;
  PetscReal   normal[3], position[3], velocity[3];
  ContactType type;
  PetscInt    n;
  Body        sides[2];

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(ContactGetNumPairs(simulation->contact, &n));
  assert_int_equal(n, 1);
  ok(ContactGetPair(simulation->contact, 0, &name, &sides[0], &sides[1]));
  assert_string_equal(name, "left:right");
  for (PetscInt b = 0; b < 2; b++) {
    assert_ptr_equal(sides[b], simulation->bodies[b]);
    ok(ContactGetBodyTrace(simulation->contact, b, position, velocity));
    near(position[0], (b ? 1 : -1) * COLLISION_GAP / 2, 1e-15);
    near(velocity[0], (b ? -1 : 1) * COLLISION_SPEED, 0);
  }
  ok(ContactGetPairNormal(simulation->contact, 0, normal));
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

/* Dirichlet sides come first, whatever the order of bodies and pairs */
static void sweep_order(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddRow();
  AddOptions("-bodies c,b,a -contact_pairs b:c,a:b");
  ok(SimulationCreate(simulation));
  assert_int_equal(simulation->contact->order[0], 2);
  assert_int_equal(simulation->contact->order[1], 1);
  assert_int_equal(simulation->contact->order[2], 0);
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
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'schwartz'|augmented_lagrangian, lagrange, penalty, schwarz", SimulationCreate(simulation));
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
  PetscReal   length, force;

  AddCollision(4, 3, 0);
  AddOptions("-right_dm_plex_box_upper 0.251 -left_youngs_modulus 3 -left_cross_section 2 -right_youngs_modulus 5 -right_cross_section 1");
  ok(SimulationCreate(simulation));
  ok(ContactGetLengthScale(simulation->contact, &length));
  ok(ContactGetForceScale(simulation->contact, &force));
  near(length, 0.25, 1e-15);
  near(force, 5, 1e-14);
}

static void set_up_is_final(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetUp()", ContactAddPair(simulation->contact, "right:left"));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetUp()", ContactSetType(simulation->contact, CONTACT_LAGRANGE));
}

/* A body that touches nothing: u = v t at all nodes, for each integrator */
static void one_body_flies_freely(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const types[]    = {"-a_ts_type alpha2", "-a_ts_type centraldifference -a_mass_type lumped"};

  AddBar("a", 0, 1, 5, 2);
  AddOptions("-bodies a -time_step 0.1 -time_end 0.3");
  for (PetscInt i = 0; i < 2; i++) {
    PetscReal     smallest, largest;
    PetscInt      n;
    ContactCounts counts;
    Vec           u;

    SimulationRepeat(simulation, types[i]);
    ok(ContactGetNumPairs(simulation->contact, &n));
    assert_int_equal(n, 0);
    ok(ControllerSolve(simulation->controller));
    ok(BodyGetSolution(simulation->bodies[0], &u, NULL, NULL));
    ok(VecMin(u, NULL, &smallest));
    ok(VecMax(u, NULL, &largest));
    near(smallest, 0.6, 1e-14);
    near(largest, 0.6, 1e-14);
    near(TotalMomentum(simulation), 2, 1e-14); /* 1 kg at 2 m/s */
    ok(ContactGetCounts(simulation->contact, &counts));
    assert_int_equal(counts.total_sweeps, 0);
  }
}

/*
   Equal bars hand their velocity on: b is hit at 0.1 s, its front moves 1/4 s later, crosses its gap in 0.1 s and hits c at 0.45 s;
   a rests from 0.6 s on, b from 0.95 s, and c flies on at 0.1 m/s. b is on the Neumann side of one pair and the Dirichlet side of
   the other.
*/
static void three_bars_in_a_row(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const types[]    = {"-contact_type schwarz", "-contact_type penalty -contact_penalty 1e3"};

  AddRow();
  AddOptions("-bodies a,b,c -contact_pairs a:b,b:c");
  for (PetscInt i = 0; i < 2; i++) {
    const PetscReal momentum = 0.25 * 0.1, energy = 0.5 * 0.25 * 0.1 * 0.1;
    PetscReal       momentum_error = 0, energy_error = 0;
    PetscBool       both = PETSC_FALSE;

    SimulationRepeat(simulation, types[i]);
    for (PetscInt step = 0; step < 120; step++) {
      ContactPairState pairs[2];
      PetscReal        stored;

      pairs[0] = Step(simulation);
      ok(ContactGetPairState(simulation->contact, 1, &pairs[1]));
      if (pairs[0].active && pairs[1].active) both = PETSC_TRUE;
      ok(ContactGetPenaltyEnergy(simulation->contact, &stored));
      momentum_error = PetscMax(momentum_error, PetscAbsReal(TotalMomentum(simulation) - momentum) / momentum);
      energy_error   = PetscMax(energy_error, PetscAbsReal(TotalEnergy(simulation) + stored - energy) / energy);
    }
    assert_true(both);
    near(momentum_error, 0, 1e-10); /* the tolerance of the outer iteration, of the order 1e-12, over 120 steps */
    /* What the ramp of the force over the step in which contact begins does not see: 0.9e-3 and 1.2e-3 when this was written.
       Chatter would show as tens of percent, or growth. */
    near(energy_error, 0, 3e-3);
    near(Momentum(simulation, 0), 0, 0.02 * momentum); /* eight elements smear the wave fronts: 0.7, 0.6 and 1.4 % */
    near(Momentum(simulation, 1), 0, 0.02 * momentum);
    near(Momentum(simulation, 2), momentum, 0.02 * momentum);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(pairs_are_parsed),
      simulation_test(wrong_pairs_are_refused),
      simulation_test(circles_are_refused),
      simulation_test(two_bodies_are_a_pair),
      simulation_test(sweep_order),
      simulation_test(three_bodies_need_pairs),
      simulation_test(unknown_type_is_refused),
      simulation_test(overlap_at_the_start_is_refused),
      simulation_test(displacement_into_each_other_is_refused),
      simulation_test(tolerances_follow_the_size),
      simulation_test(set_up_is_final),
      simulation_test(one_body_flies_freely),
      simulation_test(three_bars_in_a_row),
  };

  return impakt_main(argc, argv, tests);
}
