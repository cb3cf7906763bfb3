/* The penalty method, forces in proportion to the penetration, and the augmented Lagrangian, in which they add up until the gap is closed.
 */
#include "simulation.h"

#define PENALTY 50.0 /* N/m, some times the stiffness of an element, 8 and 10 N/m */

static const char *const integrators[] = {
    "-left_ts_type alpha2 -right_ts_type alpha2",
    "-left_ts_type alpha2 -right_ts_type centraldifference",
    "-left_ts_type centraldifference -right_ts_type centraldifference",
};

/* Three steps in contact, compared with the gap at their ends */
static void CheckSprings(Simulation *simulation)
{
  PetscReal last = 0;

  for (PetscInt step = 0; step < 3; step++) {
    const PetscReal  before[] = {Momentum(simulation, 0), Momentum(simulation, 1)};
    ContactPairState pair     = Step(simulation);
    PetscReal        energy;
    ContactCounts    counts;

    assert_int_equal(pair.active, 1);
    assert_true(pair.force > 0);
    near(pair.force, -PENALTY * pair.gap, 1e-9 * pair.force);
    ok(ContactGetCounts(simulation->contact, &counts));
    energy = counts.spring_energy;
    near(energy, 0.5 * PENALTY * pair.gap * pair.gap, 3e-9 * energy); /* twice the relative error of the force */
    /* both integrators change the momentum by dt/2 (F_0 + F_1) */
    near(Momentum(simulation, 1) - before[1], 0.5 * COLLISION_STEP * (last + pair.force), 1e-15);
    near(Momentum(simulation, 0) - before[0], -0.5 * COLLISION_STEP * (last + pair.force), 1e-15);
    last = pair.force;
  }
}

static void springs_with_massless_layers(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty 50");
  for (PetscInt i = 0; i < 3; i++) {
    SimulationRepeat(simulation, integrators[i]);
    CheckSprings(simulation);
  }
}

/* Explicit nodes with mass do not feel the force of the step in which they penetrate: they are where they fly to */
static void first_explicit_step(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty 50 -left_mass_redistribute 0 -right_mass_redistribute 0 -left_mass_type lumped "
             "-right_mass_type lumped");
  SimulationRepeat(simulation, integrators[2]);
  near(Step(simulation).force, PENALTY * (2 * COLLISION_SPEED * COLLISION_STEP - COLLISION_GAP), 1e-12);
}

/* Without -contact_penalty: as many times the stiffness of an element on each side, E A / h, one behind the other */
static void springs_from_elements(void **state)
{
  Simulation      *simulation = (Simulation *)*state;
  const PetscReal  length = 1 - COLLISION_GAP / 2, stiffness = 3 / (length / 8 + length / 10); /* 3 times, with E A = 1 N */
  ContactPairState pair;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty_scale 3");
  SimulationRepeat(simulation, integrators[0]);
  pair = Step(simulation);
  assert_true(pair.gap < 0);
  near(pair.force, -stiffness * pair.gap, 1e-9 * pair.force);
}

/* The springs hold nothing before and after contact */
static void energy_of_the_springs(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  PetscReal     energy, largest = 0, start;
  ContactCounts counts;

  AddCollision(4, 4, 0);
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101 -contact_type penalty -contact_penalty 500");
  ok(SimulationCreate(simulation));
  start = TotalEnergy(simulation);
  near(start, 0.5 * 0.2 * COLLISION_SPEED * COLLISION_SPEED, 1e-15); /* 0.2 kg in both bars */
  ok(ContactGetCounts(simulation->contact, &counts));
  energy = counts.spring_energy;
  near(energy, 0, 0);
  for (PetscInt step = 0; step < 20; step++) {
    Step(simulation);
    ok(ContactGetCounts(simulation->contact, &counts));
    energy  = counts.spring_energy;
    largest = PetscMax(largest, energy);
  }
  assert_true(largest > 0);
  near(energy, 0, 0); /* apart again after 0.2 s */
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty_scale 0");
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty_scale 0|positive", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  ok(PetscOptionsClearValue(NULL, "-contact_penalty_scale"));
  AddOptions("-contact_penalty -5");
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty -5|positive", SimulationCreate(simulation));
}

static void unconverged_steps_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 10, 0);
  AddOptions("-contact_type penalty -contact_penalty 50 -schwarz_snes_max_it 0 -time_start 1 -time_end 1.2");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_NOT_CONVERGED, "time 1.02 s|in 1 passes|-schwarz_snes_max_it", ContactStep(simulation->contact));
}

#define TOLERANCE 1e-13 /* -contact_augmentation_tolerance [m] */

static void AddAugmented(const char more[])
{
  AddCollision(8, 10, 0);
  AddOptions("-contact_type augmented_lagrangian -contact_penalty 1e3 -contact_augmentation_tolerance 1e-13");
  AddOptions(more);
}

/* Whatever the penalty parameter, the forces are the Lagrange multipliers */
static void agrees_with_lagrange(void **state)
{
  static const char *const penalties[] = {"-contact_penalty 100", "-contact_penalty 1e4", "-contact_penalty 1e8"};
  static const char *const bodies[]    = {"-right_ts_type alpha2", "-right_ts_type centraldifference"};
  Simulation              *simulation  = (Simulation *)*state;
  PetscReal                forces[5];

  AddAugmented("");
  for (PetscInt i = 0; i < 2; i++) {
    AddOptions("-contact_type lagrange");
    SimulationRepeat(simulation, bodies[i]);
    for (PetscInt step = 0; step < 5; step++) forces[step] = Step(simulation).force;
    AddOptions("-contact_type augmented_lagrangian");
    for (PetscInt k = 0; k < 3; k++) {
      SimulationRepeat(simulation, penalties[k]);
      for (PetscInt step = 0; step < 5; step++) {
        const ContactPairState pair = Step(simulation);

        near(pair.gap, 0, TOLERANCE);
        near(pair.force, forces[step], 1e-10); /* the tolerance over the least compliance, 1/20 m/N, over five steps */
      }
    }
  }
}

static void energy_in_springs_is_none(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  PetscReal     energy;
  ContactCounts counts;

  AddAugmented("");
  ok(SimulationCreate(simulation));
  Step(simulation);
  ok(ContactGetCounts(simulation->contact, &counts));
  energy = counts.spring_energy;
  near(energy, 0, 0);
}

static void augmented_wrong_options_are_refused(void **state)
{
  static const char *const wrong[] = {"-contact_augmentation_tolerance 0", "-contact_augmentation_max_it 0", "-contact_constraint gap_rate",
                                      "-contact_penalty -3"};
  Simulation              *simulation = (Simulation *)*state;

  AddAugmented("-contact_augmentation_max_it 50 -contact_constraint gap");
  for (PetscInt k = 0; k < 4; k++) {
    AddOptions("-contact_augmentation_tolerance 1e-13 -contact_augmentation_max_it 50 -contact_constraint gap -contact_penalty 1e3");
    AddOptions(wrong[k]);
    refused(PETSC_ERR_USER_INPUT, wrong[k], SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
  }
  AddOptions("-contact_penalty 1e3 -left_ts_type centraldifference -right_ts_type centraldifference -left_mass_redistribute 0 "
             "-right_mass_redistribute 0 -left_mass_type lumped -right_mass_type lumped");
  refused(PETSC_ERR_USER_INPUT, "-contact_type augmented_lagrangian|left:right|-left_mass_redistribute true", SimulationCreate(simulation));
}

static void augmented_unconverged_steps_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddAugmented("-contact_penalty 1 -contact_augmentation_max_it 3 -time_start 1 -time_end 1.2");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_NOT_CONVERGED, "time 1.02 s|after 3 augmentations|-contact_penalty|-contact_augmentation_max_it",
          ContactStep(simulation->contact));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(springs_with_massless_layers),
      simulation_test(first_explicit_step),
      simulation_test(springs_from_elements),
      simulation_test(energy_of_the_springs),
      simulation_test(wrong_options_are_refused),
      simulation_test(unconverged_steps_are_refused),
      simulation_test(agrees_with_lagrange),
      simulation_test(energy_in_springs_is_none),
      simulation_test(augmented_wrong_options_are_refused),
      simulation_test(augmented_unconverged_steps_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
