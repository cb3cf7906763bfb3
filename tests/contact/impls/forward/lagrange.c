/* Lagrange multipliers: forward increments of explicit bodies with mass, and at the end of the step between massless contact nodes. */
#include "simulation.h"

static void AddExplicitCollision(PetscReal frame)
{
  AddCollision(8, 10, frame);
  AddOptions("-contact_type lagrange -left_ts_type centraldifference -right_ts_type centraldifference -left_mass_redistribute 0 "
             "-right_mass_redistribute 0 -left_mass_type lumped -right_mass_type lumped");
}

/*
   The force of a step acts on the contact nodes from half a step before it to half a step after its start, as an impulse dt f. Nodes
   of mass m, half an element each, move by dt^2 f / m: in the first step f = (2 v dt - gap) / (dt^2 (1/m_1 + 1/m_2)).
*/
static void first_step(void **state)
{
  Simulation      *simulation = (Simulation *)*state;
  const PetscReal  length = 1 - COLLISION_GAP / 2, masses[] = {length / 8 / 2, length / 10 / 2};
  const PetscReal  force = (2 * COLLISION_SPEED * COLLISION_STEP - COLLISION_GAP) /
                           (PetscSqr(COLLISION_STEP) * (1 / masses[0] + 1 / masses[1]));
  ContactPairState pair;

  AddExplicitCollision(0);
  ok(SimulationCreate(simulation));
  pair = Step(simulation);
  assert_int_equal(pair.active, 1);
  near(pair.force, force, 1e-11 * force); /* round-off in a gap of 1e-3 m between positions of 1 m */
}

static void contact_without_gap(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddExplicitCollision(0);
  ok(SimulationCreate(simulation));
  for (PetscInt step = 0; step < 5; step++) {
    const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
    ContactPairState pair     = Step(simulation);

    assert_int_equal(pair.active, 1);
    near(pair.gap, 0, 1e-14); /* one linear solve, between positions of 1 m */
    near(Momentum(simulation, 1) - before[1], COLLISION_STEP * pair.force, 1e-14);
    near(Momentum(simulation, 0) - before[0], -COLLISION_STEP * pair.force, 1e-14);
  }
}

/* No force pulls: bars of 0.1 m come apart after 0.2 s */
static void forces_never_pull(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   momentum, gap = 0;

  AddExplicitCollision(0);
  /* 4 elements of 0.025 m: stable up to 0.025 s, so that the step of 0.02 s is */
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101 -left_dm_plex_box_faces 4 -right_dm_plex_box_faces 4");
  ok(SimulationCreate(simulation));
  momentum = TotalMomentum(simulation);
  for (PetscInt step = 0; step < 20; step++) {
    ContactPairState pair = Step(simulation);

    assert_true(pair.force >= 0);
    assert_true(pair.gap > -1e-14);
    near(TotalMomentum(simulation), momentum, 1e-15);
    gap = pair.gap;
  }
  assert_true(gap > 0.01); /* 9 steps at 2 * 0.1 m/s make 0.036 m */
}

/* Explicit bodies with mass that make substeps suit neither the forward increment nor forces at the end of the step */
static void other_bodies_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddExplicitCollision(0);
  AddOptions("-left_ts_time_step 0.01");
  refused(PETSC_ERR_USER_INPUT, "left:right|-left_mass_redistribute true|-time_step as their -<body>_ts_time_step",
          SimulationCreate(simulation));
}

static const char *const pairings[] = {
    "-left_ts_type alpha2 -right_ts_type alpha2",
    "-left_ts_type centraldifference -right_ts_type centraldifference",
    "-left_ts_type alpha2 -right_ts_type centraldifference",
    "-left_ts_type centraldifference -right_ts_type alpha2",
};

/* The gap is closed while there is a force, and both bodies feel that force: the integrators change momentum by dt/2 (F_0 + F_1) */
static void gap_is_closed(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange");
  for (PetscInt i = 0; i < 4; i++) {
    PetscReal last = 0;

    SimulationRepeat(simulation, pairings[i]);
    for (PetscInt step = 0; step < 5; step++) {
      const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
      ContactPairState pair     = Step(simulation);

      assert_int_equal(pair.active, 1);
      assert_true(pair.force > 0);
      near(pair.gap, 0, 1e-12);
      near(Momentum(simulation, 1) - before[1], 0.5 * COLLISION_STEP * (last + pair.force), 1e-14);
      near(Momentum(simulation, 0) - before[0], -0.5 * COLLISION_STEP * (last + pair.force), 1e-14);
      last = pair.force;
    }
  }
}

/* Mass on one side is enough; on the implicit one, or on the explicit one */
static void mass_on_one_side(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -right_mass_redistribute 0 -right_mass_type lumped");
  for (PetscInt i = 0; i < 4; i++) {
    SimulationRepeat(simulation, pairings[i]);
    for (PetscInt step = 0; step < 5; step++) {
      const ContactPairState pair = Step(simulation);

      assert_true(pair.force >= 0);
      assert_true(pair.gap > -1e-12);
    }
  }
}

static void unconverged_steps_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -schwarz_snes_max_it 0 -time_start 1 -time_end 1.2");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_NOT_CONVERGED, "time 1.02 s|in 1 passes|-schwarz_snes_max_it", ContactStep(simulation->contact));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(first_step),
      simulation_test(contact_without_gap),
      simulation_test(forces_never_pull),
      simulation_test(other_bodies_are_refused),
      simulation_test(gap_is_closed),
      simulation_test(mass_on_one_side),
      simulation_test(unconverged_steps_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
