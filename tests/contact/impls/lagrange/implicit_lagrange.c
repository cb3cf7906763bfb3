/* Lagrange multipliers at the end of the step: implicit bodies, massless contact nodes. */
#include "simulation.h"

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
      near(pair.gap, 0, 1e-12); /* -lagrange_snes_atol */
      near(Momentum(simulation, 1) - before[1], 0.5 * COLLISION_STEP * (last + pair.force), 1e-14);
      near(Momentum(simulation, 0) - before[0], -0.5 * COLLISION_STEP * (last + pair.force), 1e-14);
      last = pair.force;
    }
  }
}

/* Between massless layers the multipliers are what the Schwarz iteration converges to */
static void agrees_with_schwarz(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   forces[6];

  AddCollision(8, 10, 5);
  AddOptions("-schwarz_snes_atol 1e-15 -lagrange_snes_atol 1e-15");
  for (PetscInt i = 0; i < 4; i++) {
    AddOptions("-contact_type schwarz");
    SimulationRepeat(simulation, pairings[i]);
    for (PetscInt step = 0; step < 6; step++) forces[step] = Step(simulation).force;
    AddOptions("-contact_type lagrange");
    SimulationRepeat(simulation, pairings[i]);
    for (PetscInt step = 0; step < 6; step++)
      near(Step(simulation).force, forces[step], 1e-12); /* 1e-15 m over an element's 1/8 m/N, times growth */
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

/* No force pulls, and none is left when the bars of 0.1 m have come apart after 0.2 s */
static void release(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   momentum, gap = 0, energy;

  AddCollision(4, 4, 0);
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101 -contact_type lagrange");
  for (PetscInt i = 0; i < 2; i++) {
    SimulationRepeat(simulation, i ? "-lagrange_snes_type vinewtonssls" : "-lagrange_snes_type vinewtonrsls");
    momentum = TotalMomentum(simulation);
    energy   = TotalEnergy(simulation);
    for (PetscInt step = 0; step < 20; step++) {
      const ContactPairState pair = Step(simulation);

      assert_true(pair.force >= 0);
      assert_true(pair.gap > -1e-12);
      near(TotalMomentum(simulation), momentum, 1e-14);
      gap = pair.gap;
    }
    assert_true(gap > 0.01); /* 9 steps at 2 * 0.1 m/s make 0.036 m */
    assert_true(TotalEnergy(simulation) < energy * 1.01);
  }
}

/* Substeps of massless explicit bodies: the force rises linearly over them */
static void substeps(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -right_ts_type centraldifference -right_ts_time_step 0.005 -left_ts_time_step 0.01");
  ok(SimulationCreate(simulation));
  for (PetscInt step = 0; step < 5; step++) {
    const ContactPairState pair = Step(simulation);

    assert_int_equal(pair.active, 1);
    near(pair.gap, 0, 1e-12);
  }
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -lagrange_snes_type newtonls");
  refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "-lagrange_snes_type 'newtonls'|vinewtonrsls, vinewtonssls", SimulationCreate(simulation));
}

static void unconverged_steps_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -lagrange_snes_max_it 0 -time_start 1 -time_end 1.2");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_NOT_CONVERGED, "time 1.02 s|after 1 evaluations|-lagrange_snes_max_it", ContactStep(simulation->contact));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(gap_is_closed),
      simulation_test(agrees_with_schwarz),
      simulation_test(mass_on_one_side),
      simulation_test(release),
      simulation_test(substeps),
      simulation_test(wrong_options_are_refused),
      simulation_test(unconverged_steps_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
