/* ranks: 1 3 */
/* What contact does to bodies: resultants of pairs, and forces, pressures, gaps of nodes; tied surfaces that start in balance. */
#include "simulation.h"
#include <impakt/private/bodymeasures.h>
#include <math.h>

#define MAX_NODES 16

/* Three plates in a row, the first of which flies at the others: 0.9 m long, from 0.2 to 0.6 m across (so that forces have moments
   about the origin) and 0.5 m thick; waves run at 1 m/s. The second gap closes later than the first. */
#define STEPS     70
#define AREA      (0.4 * 0.5)
#define CENTRE    0.4
#define THICKNESS "0.5"

/* Forces of 0.01 N summed over 70 steps come from an outer iteration that stops at 1e-12 m; E A / h = 0.7 N/m */
#define IMPULSE_TOLERANCE 1e-13
static void AddPlates(const char more[])
{
  const char *const names[] = {"a", "b", "c"};

  for (int i = 0; i < 3; i++) {
    char text[512];

    snprintf(text, sizeof(text),
             "-%s_dm_plex_dim 2 -%s_dm_plex_simplex 0 -%s_dm_plex_box_faces 3,2 -%s_dm_plex_box_lower %g,0.2 -%s_dm_plex_box_upper %g,0.6 "
             "-%s_thickness " THICKNESS " -%s_density 1 -%s_youngs_modulus 1",
             names[i], names[i], names[i], names[i], 0.901 * i, names[i], 0.901 * i + 0.9, names[i], names[i], names[i]);
    AddOptions(text);
  }
  AddOptions("-all_mass_redistribute true -a_initial_velocity 0.1,0 -bodies a,b,c -contact_pairs a.xmax:b.xmin,b.xmax:c.xmin -time_step "
             "0.02 -time_end 1.4");
  AddOptions(more);
}

static void CheckPair(const ContactPairState *pair)
{
  /* plane waves along x press uniformly; forces of 0.01 N or so come from an outer iteration that stops at 1e-12 m */
  near(pair->force_vector[0], pair->force, 1e-15);
  near(pair->force_vector[1], 0, 1e-15);
  near(pair->force_vector[2], 0, 0);
  near(pair->moment[0], 0, 0);
  near(pair->moment[1], 0, 0);
  near(pair->moment[2], -CENTRE * pair->force, 1e-11);
  near(pair->area, pair->active ? AREA : 0, 1e-15);
  assert_true(pair->active == 0 || pair->active == 3);
}

/* Sums over the nodes of a body, and its uniform pressure and gap at x = face in the reference configuration */
static void CheckFace(Simulation *simulation, PetscInt b, PetscReal face, PetscInt sign, const ContactPairState *pair)
{
  PetscReal          values[MAX_NODES * CONTACT_FIELDS_SIZE], sums[4] = {0};
  const PetscScalar *x;
  PetscInt           n;
  Vec                positions;

  ok(BodyGetReferencePositions(simulation->bodies[b], &positions));
  ok(VecGetLocalSize(positions, &n));
  assert_in_range(n, 0, 2 * MAX_NODES);
  ok(ContactGetFields(simulation->contact, b, values));
  ok(VecGetArrayRead(positions, &x));
  for (PetscInt i = 0; i < n / 2; i++) {
    const PetscReal *node = values + CONTACT_FIELDS_SIZE * i, *force = node + CONTACT_FIELDS_FORCE;

    assert_true(force[2] == 0);
    if (PetscAbsReal(x[2 * i] - face) < 1e-9) {
      near(node[CONTACT_FIELDS_PRESSURE], pair->force / AREA, 1e-10);
      near(node[CONTACT_FIELDS_GAP], pair->gap, 1e-10);
      near(node[CONTACT_FIELDS_ACTIVE], pair->active ? 1 : 0, 0);
      for (PetscInt d = 0; d < 2; d++) sums[d] += force[d];
      sums[2] += 1;
    } else if (PetscAbsReal(x[2 * i] - 0.901 - 0.45) > 0.449 - 1e-9) { /* on no contact surface: not b's other end */
      continue;
    } else {
      assert_true(force[0] == 0 && force[1] == 0 && node[CONTACT_FIELDS_PRESSURE] == 0 && isnan(node[CONTACT_FIELDS_GAP]) &&
                  node[CONTACT_FIELDS_ACTIVE] == 0);
      sums[3] += 1;
    }
  }
  ok(VecRestoreArrayRead(positions, &x));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD), 0);
  near(sums[2], 3, 0);
  if (b == 1) near(sums[3], 6, 0); /* its inner nodes */
  for (PetscInt d = 0; d < 2; d++) near(sums[d], sign * pair->force_vector[d], 1e-15);
}

static void forces_gaps_and_pressures(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscBool   touched[2] = {PETSC_FALSE, PETSC_FALSE}, apart = PETSC_FALSE;

  AddPlates("");
  ok(SimulationCreate(simulation));
  for (PetscInt step = 0; step <= STEPS; step++) {
    ContactPairState pairs[2];

    if (step) {
      ok(ContactStep(simulation->contact));
      ok(ContactAccept(simulation->contact));
    }
    ok(ContactGetPairStates(simulation->contact, pairs));
    for (PetscInt p = 0; p < 2; p++) {
      CheckPair(&pairs[p]);
      CheckFace(simulation, p, 0.901 * p + 0.9, -1, &pairs[p]);
      CheckFace(simulation, p + 1, 0.901 * (p + 1), 1, &pairs[p]);
      if (pairs[p].force > 1e-3) touched[p] = PETSC_TRUE;
    }
    if (pairs[0].active && !pairs[1].active) apart = PETSC_TRUE;
  }
  assert_true(touched[0] && touched[1] && apart);
}

/* What the bodies get from each other is the change of their momenta. The trapezoidal rule is Newmark's with gamma = 1/2 in an
   implicit body without damping */
static void impulses_are_changes_of_momentum(void **state)
{
  Simulation      *simulation = (Simulation *)*state;
  const PetscReal  start      = 0.9 * AREA * 0.1; /* of a [kg m/s] */
  ContactPairState pairs[2];

  AddPlates("");
  ok(SimulationCreate(simulation));
  for (PetscInt step = 1; step <= STEPS; step++) {
    ok(ContactStep(simulation->contact));
    ok(ContactGetPairStates(simulation->contact, pairs));
    if (step == 1) assert_true(pairs[0].impulse[0] == 0); /* not before the step is accepted */
    ok(ContactAccept(simulation->contact));
    ok(ContactGetPairStates(simulation->contact, pairs));
    near(start - pairs[0].impulse[0], Momentum(simulation, 0), IMPULSE_TOLERANCE);
    near(pairs[0].impulse[0] - pairs[1].impulse[0], Momentum(simulation, 1), IMPULSE_TOLERANCE);
    near(pairs[1].impulse[0], Momentum(simulation, 2), IMPULSE_TOLERANCE);
    for (PetscInt p = 0; p < 2; p++) near(pairs[p].impulse[1], 0, 1e-15);
  }
  /* rho c v / 2 = 0.05 Pa from 0.92 s on would be 0.27 of it; three elements smear the front of the wave, which comes later: 0.18 */
  between(pairs[1].impulse[0], 0.16 * start, 0.2 * start);
}

/* Not before there is anything to compute from, not of bodies that there are not */
static void misuse_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   values[1];
  Contact     contact;

  AddPlates("");
  ok(SimulationCreate(simulation));
  ok(ContactCreate(PETSC_COMM_WORLD, &contact));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ContactSetUp() first", ContactGetFields(contact, 0, values));
  ok(ContactDestroy(&contact));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no body 3; there are 3", ContactGetFields(simulation->contact, 3, values));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no body -1", ContactGetFields(simulation->contact, -1, values));
}

#define STRETCHED                                                                                                                          \
  "-dm_plex_dim 2 -density 1 -youngs_modulus 3 -poissons_ratio 0.3 -mass_redistribute true -initial_displacement 0.01*x*x,0.02*x*y "

/* The program's own choice; the force of the first state is that which the first step goes on from, or there is none */
static void start_in_balance(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-prefix_push a_ " STRETCHED "-dm_plex_box_faces 4,4 -dm_plex_box_lower 0,0 -dm_plex_box_upper 1,1 -prefix_pop "
             "-prefix_push b_ " STRETCHED "-dm_plex_box_faces 5,5 -dm_plex_box_lower 1,0 -dm_plex_box_upper 2,1 -prefix_pop "
             "-bodies a,b -contact_pairs b:a -contact_law tied -time_step 1e-3 -time_end 1e-2 -petscpartitioner_type simple");
  for (PetscInt balanced = 0; balanced < 2; balanced++) {
    ContactPairState start, end;
    PetscReal        before = 0, after = 0;
    PetscInt         n;
    const Body      *bodies;

    ok(ControllerDestroy(&simulation->controller));
    ok(PetscOptionsSetValue(NULL, "-contact_balanced_start", PetscBools[balanced]));
    ok(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
    ok(ControllerSetFromOptions(simulation->controller));
    ok(ControllerGetContact(simulation->controller, &simulation->contact));
    ok(ControllerSetUp(simulation->controller));
    ok(ContactGetPairStates(simulation->contact, &start));
    ok(ControllerGetBodies(simulation->controller, &n, &bodies));
    for (PetscInt b = 0; b < n; b++) {
      PetscReal sums[BODY_MEASURE_SUMS], energy;

      ok(BodyComputeEnergies(1, &bodies[b], sums, &energy));
      before += energy;
    }
    ok(ContactStep(simulation->contact));
    ok(ContactGetPairStates(simulation->contact, &end));
    for (PetscInt b = 0; b < n; b++) {
      PetscReal sums[BODY_MEASURE_SUMS], energy;

      ok(BodyComputeEnergies(1, &bodies[b], sums, &energy));
      after += energy;
    }
    if (balanced) {
      near(start.force_vector[0], end.force_vector[0], 1e-3 * PetscAbsReal(end.force_vector[0])); /* a step of 1/140 of a transit */
      near(after, before, 1e-12 * before);
      assert_int_equal(start.active, end.active);
    } else {
      near(start.force_vector[0], 0, 0);
      assert_true(after < before * (1 - 1e-4));
    }
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(forces_gaps_and_pressures),
      simulation_test(impulses_are_changes_of_momentum),
      simulation_test(misuse_is_refused),
      simulation_test(start_in_balance),
  };

  return impakt_main(argc, argv, tests);
}
