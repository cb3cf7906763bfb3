/* What energy errors are relative to: the initial energy, or, where all bodies start at rest without strain, the largest. */
#include "simulation.h"
#include <controller/energyscale.h>
#include <io/statistics.h>

/* Tells the statistics of a state in which each body has so much kinetic energy and work of loads */
static void report_state(Simulation *simulation, Statistics statistics, PetscInt step, PetscReal kinetic, PetscReal work)
{
  BodyMeasures    *bodies;
  PetscReal       *velocities;
  ContactPairState pair  = {.gap = 1};
  ControllerFrame  frame = {.step = step, .steps = 2, .time = step, .n_bodies = simulation->n_bodies, .n_pairs = 1, .pairs = &pair};

  ok(PetscCalloc2(simulation->n_bodies, &bodies, 3 * simulation->n_bodies, &velocities));
  for (PetscInt b = 0; b < simulation->n_bodies; b++) {
    ok(BodyGetMeasures(simulation->bodies[b], &bodies[b]));
    if (!step) continue;
    bodies[b].kinetic       = kinetic;
    bodies[b].external_work = work;
  }
  frame.bodies             = bodies;
  frame.contact_velocities = velocities; /* bodies that never touch: no time of contact depends on them */
  ok(EnergyScaleAdd(ControllerGetEnergyScale(simulation->controller), simulation->controller, &frame)); /* as ControllerNotify() does */
  ok(StatisticsMonitor(simulation->controller, &frame, statistics));
  ok(PetscFree2(bodies, velocities));
}

/* An energy of 10^10 times that at the start is an error of 10^10, not one of a part of itself */
static void is_the_initial_energy_of_bodies_that_move(void **state)
{
  Simulation              *simulation = (Simulation *)*state;
  Statistics               statistics;
  const StatisticsResults *results;
  BodyMeasures             measures;

  AddCollision(4, 4, 0);
  ok(SimulationCreate(simulation));
  ok(BodyGetMeasures(simulation->bodies[0], &measures));
  assert_true(measures.kinetic > 1e-3);
  ok(StatisticsCreate(simulation->controller, &statistics));
  report_state(simulation, statistics, 0, 0, 0);
  report_state(simulation, statistics, 1, 5e9 * measures.kinetic, 0);
  report_state(simulation, statistics, 2, 1e10 * measures.kinetic, 0);
  ok(StatisticsGetResults(statistics, &results));
  near(results->energy_error_max, 1e10, 10);
  near(results->energy_error_final, 1e10, 10);
  near(results->bodies[0].energy_error_max, 1e10, 10);
  ok(StatisticsDestroy(&statistics));
}

/* Strained bars at rest */
static void is_the_initial_energy_of_bodies_with_strain(void **state)
{
  Simulation              *simulation = (Simulation *)*state;
  Statistics               statistics;
  const StatisticsResults *results;
  BodyMeasures             measures;

  AddCollision(4, 4, 1);
  AddOptions("-left_initial_velocity 0 -right_initial_velocity 0 -left_initial_displacement 1e-3*x");
  ok(SimulationCreate(simulation));
  ok(BodyGetMeasures(simulation->bodies[0], &measures));
  assert_true(measures.potential > 1e-9);
  ok(StatisticsCreate(simulation->controller, &statistics));
  report_state(simulation, statistics, 0, 0, 0);
  report_state(simulation, statistics, 1, 5e2, 0);
  ok(StatisticsGetResults(statistics, &results));
  near(results->energy_error_max, 1e3 / measures.potential, 1e-6 * 1e3 / measures.potential);
  ok(StatisticsDestroy(&statistics));
}

/* Bars at rest, one of them moved as a whole, which loads set in motion: 10 J of work each, 9 J of them found again, and at last 4 J of 4 J
 */
static void is_the_largest_energy_of_bodies_from_rest(void **state)
{
  Simulation              *simulation = (Simulation *)*state;
  Statistics               statistics;
  const StatisticsResults *results;

  AddCollision(4, 4, 1);
  AddOptions("-left_initial_velocity 0 -right_initial_velocity 1e-17 -left_initial_displacement -100.1");
  ok(SimulationCreate(simulation));
  ok(StatisticsCreate(simulation->controller, &statistics));
  report_state(simulation, statistics, 0, 0, 0);
  report_state(simulation, statistics, 1, 9, 10);
  report_state(simulation, statistics, 2, 4, 4);
  ok(StatisticsGetResults(statistics, &results));
  near(results->energy_error_min, -2. / 38, 1e-12); /* largest: 19 J each */
  near(results->energy_error_final, 0, 1e-12);
  near(results->bodies[0].energy_error_min, -1. / 38, 1e-12);
  ok(StatisticsDestroy(&statistics));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(is_the_initial_energy_of_bodies_that_move),
      simulation_test(is_the_initial_energy_of_bodies_with_strain),
      simulation_test(is_the_largest_energy_of_bodies_from_rest),
  };

  return impakt_main(argc, argv, tests);
}
