/* ranks: 1 2 */
/* What observers are told beside energies and contact: what holds the bodies, and points of them. A program asks for both by its own means.
 */
#include "simulation.h"

#define FORCE 0.02

static Simulation *simulation_of_a_held_bar(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  /* pulled away from its support into a wall, slowly: static */
  AddOptions(
      "-bodies bar -obstacles wall -wall_obstacle_type plane -wall_point 2.01 -wall_normal -1 -contact_pairs bar.xmax:wall -time_end 2 "
      "-time_step 1 -bar_dm_plex_dim 1 -bar_dm_plex_box_upper 2 -bar_dm_plex_box_faces 8 -bar_density 1 -bar_youngs_modulus 1 "
      "-bar_ts_type static -bar_boundary_displacement xmin -bar_boundary_displacement_xmin 0 -bar_body_force 0.02*t -bar_probe 0.6;2");
  ok(SimulationCreate(simulation));
  return simulation;
}

/* The bar gets as far as the wall under half of the first load, 0.02 N/m: u(2) = f L^2 / 2 E A = 0.04 without it. With it, at the load
   f, the wall has R = f L / 2 - E A d / L, and the support the rest. */
static void supports_and_probes(void **state)
{
  Simulation              *simulation = simulation_of_a_held_bar(state);
  const ControllerSupport *supports;
  const ControllerProbe   *probes;
  const char              *name;
  PetscReal                force[3], moment[3], position[6], displacement[6], velocity[6], stress[12], wall;
  PetscInt                 n, i;
  Obstacle                 obstacle;

  ok(ControllerSolve(simulation->controller));
  ok(ControllerGetSupports(simulation->controller, &n, &supports));
  assert_int_equal(n, 2);
  assert_int_equal(supports[0].body, 0);
  assert_string_equal(supports[0].name, "xmin");
  assert_int_equal(supports[1].body, -1);
  assert_string_equal(supports[1].name, "wall");
  wall = 2 * FORCE * 2 / 2 - 0.01 / 2;
  near(supports[1].force[0], -wall, 1e-12);
  near(supports[0].force[0], -(2 * FORCE * 2 - wall), 1e-12);
  for (PetscInt d = 1; d < 3; d++) near(supports[0].force[d], 0, 0);
  ok(BodyGetNumReactions(simulation->bodies[0], &n));
  assert_int_equal(n, 1);
  ok(BodyGetReactionSurface(simulation->bodies[0], 0, &name));
  assert_string_equal(name, "xmin");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|no surface 1", BodyGetReactionSurface(simulation->bodies[0], 1, &name));
  ok(BodyGetReactions(simulation->bodies[0], force, moment));
  near(force[0], supports[0].force[0], 0);
  ok(ContactGetNumObstacles(simulation->contact, &n));
  assert_int_equal(n, 1);
  ok(ContactGetObstacle(simulation->contact, 0, &obstacle));
  ok(ObstacleGetName(obstacle, &name));
  assert_string_equal(name, "wall");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no obstacle 1", ContactGetObstacle(simulation->contact, 1, &obstacle));
  ok(ContactGetPairObstacle(simulation->contact, 0, &i));
  assert_int_equal(i, 0);
  refused(PETSC_ERR_ARG_OUTOFRANGE, "no pair 1", ContactGetPairObstacle(simulation->contact, 1, &i));

  ok(ControllerGetProbes(simulation->controller, &n, &probes));
  assert_int_equal(n, 2);
  assert_int_equal(probes[1].body, 0);
  assert_int_equal(probes[1].number, 1);
  near(probes[1].position[0], 2.01, 1e-14);
  near(probes[1].displacement[0], 0.01, 1e-14);
  ok(BodyGetNumProbes(simulation->bodies[0], &n));
  assert_int_equal(n, 2);
  ok(BodyGetProbes(simulation->bodies[0], position, displacement, velocity, stress));
  near(position[0], 0.6 + displacement[0], 1e-15);
  near(displacement[0], probes[0].displacement[0], 0);
  /* the mean of the element from 0.5 to 0.75: support less the load up to 0.625 */
  near(stress[0], -supports[0].force[0] - 2 * FORCE * 0.625, 1e-12);
}

static void what_comes_too_early_is_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Controller  controller;
  PetscInt    n;

  (void)simulation;
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ControllerSetUp()", ControllerGetSupports(controller, &n, NULL));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ControllerSetUp()", ControllerGetProbes(controller, &n, NULL));
  ok(ControllerDestroy(&controller));
}

/* After the set-up there is no place for another one */
static void probes_come_before_the_set_up(void **state)
{
  Simulation     *simulation = simulation_of_a_held_bar(state);
  const PetscReal x[1]       = {0.5};

  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodyAddProbe()", BodyAddProbe(simulation->bodies[0], x));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar'|BodySetDamping()", BodySetDamping(simulation->bodies[0], 0, 0));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(supports_and_probes), simulation_test(what_comes_too_early_is_refused),
                                     simulation_test(probes_come_before_the_set_up)};

  return impakt_main(argc, argv, tests);
}
