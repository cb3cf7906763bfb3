/* long: 3 */
/* -contact_constraint: gap, its rate, or both, for penalty and Lagrange multipliers. */
#include "simulation.h"

#define DAMPING 5.0 /* N s/m; the impedance of the bars is 1 */

static const char lumped[]       = "-left_mass_redistribute 0 -right_mass_redistribute 0 -left_mass_type lumped -right_mass_type lumped";
static const char all_explicit[] = "-left_ts_type centraldifference -right_ts_type centraldifference";

/* Rate of the gap by the velocities at the end of the step */
static PetscReal GapRate(Simulation *simulation)
{
  PetscReal position[3], velocity[2][3];

  for (PetscInt b = 0; b < 2; b++) ok(ContactGetBodyTrace(simulation->contact, b, position, velocity[b]));
  return velocity[1][0] - velocity[0][0];
}

/* Force of damper, or of spring and damper, against the gaps at both ends of the step */
static void CheckDampers(Simulation *simulation, PetscReal penalty)
{
  PetscReal last = COLLISION_GAP;

  for (PetscInt step = 0; step < 4; step++) {
    const ContactPairState pair   = Step(simulation);
    const PetscReal        wanted = -penalty * pair.gap - DAMPING * (pair.gap - last) / COLLISION_STEP;
    PetscReal              energy;

    assert_true(wanted > 0);
    assert_int_equal(pair.active, 1);
    near(pair.force, wanted, 1e-9 * pair.force); /* -penalty_snes_rtol */
    ok(ContactGetPenaltyEnergy(simulation->contact, &energy));
    near(energy, 0.5 * penalty * PetscSqr(PetscMin(pair.gap, 0)), 1e-12);
    last = pair.gap;
  }
}

static void dampers(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty_damping 5 -contact_penalty 50");
  for (PetscInt k = 0; k < 4; k++) {
    AddOptions(k % 2 ? "-contact_constraint both" : "-contact_constraint gap_rate");
    SimulationRepeat(simulation, k < 2 ? "-right_ts_type alpha2" : "-right_ts_type centraldifference");
    CheckDampers(simulation, k % 2 ? 50 : 0);
  }
}

/* What a damper takes is lost: the energy of the bodies never grows, and less is left than with springs alone */
static void dampers_dissipate(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   last[2], energy;

  AddCollision(4, 4, 0);
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101 -contact_type penalty -contact_penalty 500 "
             "-contact_penalty_damping 5");
  for (PetscInt k = 0; k < 2; k++) {
    SimulationRepeat(simulation, k ? "-contact_constraint both" : "-contact_constraint gap");
    energy = TotalEnergy(simulation);
    for (PetscInt step = 0; step < 20; step++) Step(simulation);
    last[k] = TotalEnergy(simulation) / energy;
  }
  assert_true(last[1] < last[0] - 0.01);
  assert_true(last[1] < 1);
}

/* The gap at the start of the step in which the bodies would meet is kept: by forward-increment and by implicit multipliers */
static void gap_is_kept(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -contact_constraint gap_rate");
  for (PetscInt k = 0; k < 2; k++) {
    if (k) AddOptions(all_explicit);
    SimulationRepeat(simulation, k ? lumped : "");
    for (PetscInt step = 0; step < 4; step++) {
      const ContactPairState pair = Step(simulation);

      assert_int_equal(pair.active, 1);
      near(pair.gap, COLLISION_GAP, (step + 1) * 1e-12); /* -lagrange_snes_atol in each step */
    }
  }
}

/* Gap and gap rate: both zero at the end of each step in contact */
static void gap_and_rate(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type lagrange -contact_constraint both");
  for (PetscInt k = 0; k < 2; k++) {
    PetscReal energy, momentum;

    if (k) AddOptions(all_explicit);
    SimulationRepeat(simulation, lumped);
    energy   = TotalEnergy(simulation);
    momentum = TotalMomentum(simulation);
    for (PetscInt step = 0; step < 3; step++) {
      const ContactPairState pair = Step(simulation);

      near(TotalMomentum(simulation), momentum, 1e-14);
      if (!pair.active) continue; /* the trapezoidal rule chatters */
      near(pair.gap, 0, 1e-12);
      near(GapRate(simulation), 0, 1e-14);
    }
    assert_true(TotalEnergy(simulation) < energy);
  }
}

/* Forward increment with impulses on the velocities: the force that is reported has all that changes the momentum, so that its sum is
   that of the gap alone. The impulse belongs to the end of the step, half of the force to its start. */
static void impulses_are_told(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions(all_explicit);
  AddOptions("-contact_type lagrange -contact_constraint both");
  SimulationRepeat(simulation, lumped);
  for (PetscInt step = 0; step < 3; step++) {
    const PetscReal        before = Momentum(simulation, 1);
    const ContactPairState pair   = Step(simulation);

    near(Momentum(simulation, 1) - before, COLLISION_STEP * pair.force, 1e-14);
  }
}

/* The same by the Schwarz method, whatever is exchanged and at however many substeps; and it needs no more sweeps for it */
static void gap_is_kept_by_schwarz(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  const char *const ways[]     = {"-schwarz_transmission dirichlet_neumann", "-schwarz_transmission robin",
                                  "-schwarz_transmission dirichlet_neumann -left_ts_time_step 0.005 -right_ts_time_step 0.01",
                                  "-contact_swap_sides"};

  AddCollision(8, 10, 3);
  AddOptions("-contact_constraint gap_rate -left_initial_displacement 1e-3"); /* 1 mm is left, and 4 mm would be gone after the step */
  for (PetscInt k = 0; k < 4; k++) {
    SimulationRepeat(simulation, ways[k]);
    for (PetscInt step = 0; step < 5; step++) {
      const ContactPairState pair = Step(simulation);
      ContactCounts          counts;

      assert_int_equal(pair.active, 1);
      assert_true(pair.force > 0);
      near(pair.gap, 1e-3, 1e-11); /* -schwarz_snes_atol in each step */
      ok(ContactGetCounts(simulation->contact, &counts));
      between(counts.sweeps, 1, 2);
    }
  }
}

static void schwarz_refuses_both(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_constraint both");
  refused(PETSC_ERR_USER_INPUT, "-contact_constraint both|gap or gap_rate", SimulationCreate(simulation));
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty 50 -contact_constraint both");
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty_damping|N s/m", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_penalty_damping -1");
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty_damping -1|positive", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_penalty_damping 50");
  AddOptions(all_explicit);
  AddOptions(lumped);
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty_damping 50|unstable", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_type lagrange -left_mass_redistribute 1 -right_mass_redistribute 1");
  refused(PETSC_ERR_USER_INPUT, "-contact_constraint both|'left' and 'right' have none|-left_mass_redistribute false",
          SimulationCreate(simulation));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(dampers),
      simulation_test(dampers_dissipate),
      simulation_test(gap_is_kept),
      simulation_test(gap_and_rate),
      simulation_test(impulses_are_told),
      simulation_test(gap_is_kept_by_schwarz),
      simulation_test(schwarz_refuses_both),
      simulation_test(wrong_options_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
