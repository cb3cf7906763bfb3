/* -contact_constraint: gap, its rate, or both. -contact_stabilization: naive, and contact-stabilised Newmark. */
#include "simulation.h"

#define DAMPING 5.0 /* N s/m; the impedance of the bars is 1 */

static const char lumped[]       = "-left_mass_redistribute 0 -right_mass_redistribute 0 -left_mass_type lumped -right_mass_type lumped";
static const char all_explicit[] = "-left_ts_type centraldifference -right_ts_type centraldifference";

/* Rate of the gap by the velocities at the end of the step */
static PetscReal GapRate(Simulation *simulation)
{
  PetscReal positions[6], velocities[6];

  ok(ContactGetBodyTraces(simulation->contact, positions, velocities));
  return velocities[3] - velocities[0];
}

/* Force of damper, or of spring and damper, against the gaps at both ends of the step */
static void CheckDampers(Simulation *simulation, PetscReal penalty)
{
  PetscReal last = COLLISION_GAP;

  for (PetscInt step = 0; step < 4; step++) {
    const ContactPairState pair   = Step(simulation);
    const PetscReal        wanted = -penalty * pair.gap - DAMPING * (pair.gap - last) / COLLISION_STEP;
    PetscReal              energy;
    ContactCounts          counts;

    assert_true(wanted > 0);
    assert_int_equal(pair.active, 1);
    near(pair.force, wanted, 1e-9 * pair.force);
    ok(ContactGetCounts(simulation->contact, &counts));
    energy = counts.spring_energy;
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
      near(pair.gap, COLLISION_GAP, (step + 1) * 1e-12);
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

/* The same by the alternation, whatever is exchanged and at however many substeps */
static void gap_is_kept_by_the_alternation(void **state)
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
      between(counts.sweeps, 1, 4); /* measured: 3 */
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

/* The whole contact force of the end of the step acts over all of it: dt F_1, not dt/2 (F_0 + F_1). Gap closed, no energy gained. */
static void contact_stabilized(void **state)
{
  static const char *const masses[]   = {"-left_mass_type lumped -right_mass_type lumped",
                                         "-left_mass_type averaged -right_mass_type consistent"};
  Simulation              *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0.5);
  AddOptions("-contact_type lagrange -contact_stabilization contact_stabilized");
  AddOptions(lumped);
  for (PetscInt k = 0; k < 2; k++) {
    PetscReal energy;

    SimulationRepeat(simulation, masses[k]);
    energy = TotalEnergy(simulation);
    for (PetscInt step = 0; step < 8; step++) {
      const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
      ContactPairState pair     = Step(simulation);

      assert_true(pair.gap > -1e-12);
      assert_true(pair.force >= 0);
      near(Momentum(simulation, 1) - before[1], COLLISION_STEP * pair.force, 1e-14);
      near(Momentum(simulation, 0) - before[0], -COLLISION_STEP * pair.force, 1e-14);
      assert_true(TotalEnergy(simulation) <= energy * (1 + 1e-12));
      energy = TotalEnergy(simulation);
    }
    assert_true(energy > 0);
  }
}

/*
   The first step by hand. Nodes of mass m, half an element h each, fly at v; the prediction penetrates by p = 2 v dt - gap, and is put
   back in the norm of the mass: by p m_2 / (m_1 + m_2) and p m_1 / (m_1 + m_2). The contact force then balances the mean internal
   force: nothing else moves the nodes that touch. With one element in each bar and equal bars the projected shift is p / 2, and the
   node would have strain p / (4 h) on average over the step, if the far node did not move: force p / (4 h), less O(dt^2 / h^2).
*/
static void first_step_by_hand(void **state)
{
  Simulation     *simulation = (Simulation *)*state;
  const PetscReal p = 2 * COLLISION_SPEED * COLLISION_STEP - COLLISION_GAP, h = 1 - COLLISION_GAP / 2, mass = h / 2;
  /* elongation over the step: from 0 to u_1 - w_1, contact node at gap/2, far node w_1 = v dt + dt^2/2 / mass * mean strain */
  const PetscReal moved = COLLISION_GAP / 2, free = COLLISION_SPEED * COLLISION_STEP, k = 0.5 * PetscSqr(COLLISION_STEP) / mass / h / 2;
  const PetscReal squeeze = (free - moved) / (1 + k); /* (w_1 - u_1) = free - moved - k (w_1 - u_1) */

  skip_beyond_ranks(1);
  AddCollision(1, 1, 0);
  AddOptions("-contact_type lagrange -contact_stabilization contact_stabilized");
  AddOptions(lumped);
  ok(SimulationCreate(simulation));
  near(p / 2, free - moved, 1e-15);
  near(Step(simulation).force, squeeze / h / 2,
       1e-11); /* mean of 0 and squeeze / h; 1e-12 m over dt^2 / (2 m), 4e-4 m/N, is 2e-9 at most */
}

static void stabilization_wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_stabilization naive");
  refused(PETSC_ERR_USER_INPUT, "-contact_stabilization naive|massless|-<body>_mass_redistribute false", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization contact_stabilized -right_mass_redistribute 0");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|-contact_type lagrange|alternation", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_type lagrange");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left'|-left_mass_redistribute false", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions(lumped);
  AddOptions("-left_ts_time_step 0.01");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left' makes 2 substeps|-left_ts_time_step", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-left_ts_time_step 0.02 -left_ts_alpha_radius 0.8");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|trapezoidal|'left'|-left_ts_alpha_", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-left_ts_alpha_radius 1 -left_ts_type centraldifference");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|'left' is explicit|-left_ts_type alpha2", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-right_ts_type centraldifference");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|explicit|-<body>_ts_type alpha2", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization naive");
  refused(PETSC_ERR_USER_INPUT, "naive|forward-increment|-contact_type schwarz", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-contact_stabilization contact_stabilized -left_ts_type alpha2 -right_ts_type alpha2 -contact_constraint both");
  refused(PETSC_ERR_USER_INPUT, "contact_stabilized|-contact_constraint at gap", SimulationCreate(simulation));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(dampers),
      simulation_test(gap_is_kept),
      simulation_test(gap_and_rate),
      simulation_test(impulses_are_told),
      simulation_test(gap_is_kept_by_the_alternation),
      simulation_test(schwarz_refuses_both),
      simulation_test(wrong_options_are_refused),
      simulation_test(contact_stabilized),
      simulation_test(first_step_by_hand),
      simulation_test(stabilization_wrong_options_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
