/* The augmented Lagrangian: penalty forces that add up until the gap is closed. */
#include "simulation.h"

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

  AddAugmented("-lagrange_snes_atol 1e-15");
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

/* A softer spring needs more rounds, each of which closes the gap by 1 / (1 + tau W); but of one node that is known after a few, and what
   would follow is taken at once: 4 sweeps, 8, and 8 with a spring that is a hundred times softer again */
static void rounds(void **state)
{
  static const char *const penalties[] = {"-contact_penalty 1e6", "-contact_penalty 50", "-contact_penalty 0.5"};
  Simulation              *simulation  = (Simulation *)*state;
  PetscInt                 sweeps      = 0;
  ContactCounts            counts;

  AddAugmented("");
  for (PetscInt k = 0; k < 3; k++) {
    SimulationRepeat(simulation, penalties[k]);
    Step(simulation);
    ok(ContactGetCounts(simulation->contact, &counts));
    between(counts.sweeps, k == 1 ? sweeps + 1 : sweeps, 12);
    sweeps = counts.sweeps;
  }
}

static void energy_in_springs_is_none(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   energy;

  AddAugmented("");
  ok(SimulationCreate(simulation));
  Step(simulation);
  ok(ContactGetPenaltyEnergy(simulation->contact, &energy));
  near(energy, 0, 0);
}

static void wrong_options_are_refused(void **state)
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
  refused(PETSC_ERR_USER_INPUT, "-contact_type augmented_lagrangian|'left'|'right'|-left_mass_redistribute true",
          SimulationCreate(simulation));
}

static void unconverged_steps_are_refused(void **state)
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
      simulation_test(agrees_with_lagrange),          simulation_test(rounds),
      simulation_test(energy_in_springs_is_none),     simulation_test(wrong_options_are_refused),
      simulation_test(unconverged_steps_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
