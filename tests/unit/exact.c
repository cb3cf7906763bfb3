/* The closed-form impact of two equal bars: Hoy, Tezaur, Mota, eqs. (4.1) to (4.7). */
#include "simulation.h"

/*
   The high-speed problem, table 4.2: rho = 1000 kg/m^3, E = 1e9 Pa, so c = sqrt(E/rho) = 1000 m/s; A = 1e-6 m^2; L = 0.25 m, a mass
   of 2.5e-4 kg; v_0 = 100 m/s; a gap of 2 g = 0.04 m at t_0 = -2e-4 s. By hand:

     t_imp = t_0 + g/v_0 = 0,   t_1 = L/c = 2.5e-4 s,   t_rel = 2 L/c = 5e-4 s,   f = v_0 sqrt(E rho) A = 100 N,
     energy 1/2 m v_0^2 = 1.25 J.
*/
static void AddPaperBars(PetscReal frame)
{
  AddBar("left", -0.27, -0.02, 4, frame + 100);
  AddBar("right", 0.02, 0.27, 4, frame - 100);
  AddOptions("-bodies left,right -time_start -2e-4 -time_end 8e-4 -time_step 1e-5 -left_density 1000 -right_density 1000 -left_youngs_modulus 1e9 -right_youngs_modulus 1e9 -left_cross_section 1e-6 -right_cross_section 1e-6");
}

/* Everything but a rounding or two of numbers of size `scale` */
static void CheckSolution(Exact exact, PetscReal time, const PetscReal expected[6])
{
  ExactSolution    solution;
  const PetscReal *values = (const PetscReal *)&solution, scales[] = {0.3, 200, 100, 10, 10, 200};

  ok(ExactEvaluate(exact, 0, time, &solution));
  for (PetscInt i = 0; i < 6; i++) near(values[i], expected[i], 1e-12 * scales[i]);
}

static void times_and_force(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Exact       exact;
  PetscReal   impact, release, force;

  AddPaperBars(0);
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  ok(ExactGetTimes(exact, &impact, &release));
  ok(ExactGetForce(exact, &force));
  near(impact, 0, 1e-18);
  near(release, 5e-4, 1e-17);
  near(force, 100, 1e-11);
  ok(ExactDestroy(&exact));
  assert_null(exact);
}

static void solution_of_the_paper(void **state)
{
  /* contact position, contact velocity, contact force, kinetic and potential energy, mean velocity */
  const struct {
    PetscReal time, expected[6];
  } cases[] = {
      {-2e-4, {-0.02, 100, 0, 1.25, 0, 100}},
      {-1e-4, {-0.01, 100, 0, 1.25, 0, 100}},
      {1.25e-4, {0, 0, 100, 0.625, 0.625, 50}},  /* the wave has met half of the bar */
      {2e-4, {0, 0, 100, 0.25, 1, 20}},          /* 4/5 of it */
      {2.5e-4, {0, 0, 100, 0, 1.25, 0}},         /* all */
      {3.75e-4, {0, 0, 100, 0.625, 0.625, -50}}, /* half of it flies back */
      {5e-4, {0, 0, 100, 1.25, 0, -100}},        /* at the jump: the value before */
      {6e-4, {-0.01, -100, 0, 1.25, 0, -100}},
  };
  Simulation *simulation = (Simulation *)*state;
  Exact       exact;

  AddPaperBars(0);
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) CheckSolution(exact, cases[i].time, cases[i].expected);
  ok(ExactDestroy(&exact));
}

/*
   Both bars fly along at 50 m/s, too: the left one's front begins at -0.02 m; at impact, 2e-4 s later, it is at 0.01 m, the mean of
   both, and from there on at 0.01 m + 50 m/s t. When half of the bar has stopped, in the frame, one half flies at 150 m/s and one
   at 50 m/s: 1/2 2.5e-4 (150^2 + 50^2)/2 = 1.5625 J.
*/
static void moving_frame(void **state)
{
  const PetscReal before[] = {-0.02, 150, 0, 2.8125, 0, 150}, half[] = {0.01 + 50 * 1.25e-4, 50, 100, 1.5625, 0.625, 100};
  Simulation     *simulation = (Simulation *)*state;
  Exact           exact;

  AddPaperBars(50);
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  CheckSolution(exact, -2e-4, before);
  CheckSolution(exact, 1.25e-4, half);
  ok(ExactDestroy(&exact));
}

/* Told of the right bar, along its own normal, to the left: the mirror image */
static void sides_swapped(void **state)
{
  const PetscReal before[] = {-0.02, 100, 0, 1.25, 0, 100}, after[] = {-0.01, -100, 0, 1.25, 0, -100};
  Simulation     *simulation = (Simulation *)*state;
  Exact           exact;

  AddPaperBars(0);
  AddOptions("-contact_pairs right:left");
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  CheckSolution(exact, -2e-4, before);
  CheckSolution(exact, 6e-4, after);
  ok(ExactDestroy(&exact));
}

/* A run that is the solution times 1.1 is wrong by 0.1 in everything that has a size */
static void errors_of_a_run(void **state)
{
  Simulation      *simulation   = (Simulation *)*state;
  BodyMeasures     bodies[2]    = {0};
  PetscReal        positions[6] = {0}, velocities[6] = {0};
  ContactPairState pair  = {0};
  ControllerFrame  frame = {.n_bodies = 2, .n_pairs = 1, .bodies = bodies, .contact_positions = positions, .contact_velocities = velocities, .pairs = &pair};
  ExactSolution    solution;
  Exact            exact;
  ExactErrors      errors;

  AddPaperBars(0);
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  ok(ExactGetErrors(exact, &errors));
  assert_true(PetscIsNanReal(errors.contact_force) && PetscIsNanReal(errors.release_time) && PetscIsNanReal(errors.peak_potential));
  for (frame.step = 0; frame.step <= 16; frame.step++) {
    frame.time = -2e-4 + frame.step * 5e-5;
    ok(ExactEvaluate(exact, 0, frame.time, &solution));
    positions[0]               = 1.1 * solution.contact_position; /* the point of impact is 0 */
    velocities[0]              = 1.1 * solution.contact_velocity;
    bodies[0].kinetic          = 1.1 * solution.kinetic;
    bodies[0].potential        = 1.1 * solution.potential;
    bodies[0].mean_velocity[0] = 1.1 * solution.mean_velocity;
    pair.force                 = 1.1 * solution.contact_force;
    pair.active                = frame.time > 0 && frame.time < 4.4e-4; /* three steps of 1e-5 s too early */
    ok(ExactMonitor(simulation->controller, &frame, exact));
  }
  ok(ExactGetErrors(exact, &errors));
  near(errors.contact_position, 0.1, 1e-12);
  near(errors.contact_velocity, 0.1, 1e-12);
  near(errors.contact_force, 0.1, 1e-12);
  near(errors.kinetic, 0.1, 1e-12);
  near(errors.potential, 0.1, 1e-12);
  near(errors.mean_velocity, 0.1, 1e-12);
  near(errors.peak_potential, 0.1, 1e-12); /* 2.5e-4 s, when all energy is potential, is the end of a step */
  near(errors.release_time, -0.2, 1e-12);  /* the last step in contact ends at 4e-4 s: (4e-4 - 5e-4) / 5e-4 */
  ok(ExactDestroy(&exact));
}

static void other_problems_are_refused(void **state)
{
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-right_density 1001", "density of 'left' is 1000 kg/m^3|'right' 1001"},
      {"-right_density 1000 -right_youngs_modulus 2e9", "uniaxial modulus|1000000000 Pa|2000000000 Pa"},
      {"-right_youngs_modulus 1e9 -right_dm_plex_box_upper 0.3", "length of 'left' is 0.25 m|0.28 m"},
      {"-right_dm_plex_box_upper 0.27 -right_cross_section 2e-6", "mass of 'left'|0.0005 kg"},
      {"-right_cross_section 1e-6 -right_initial_velocity 100", "approach|'left' moves at 100|'right' at 100"},
      {"-right_initial_velocity -100 -bodies left,right,third -contact_pairs left:right,right:third -third_dm_plex_dim 1 -third_dm_plex_box_faces 4 -third_dm_plex_box_lower 0.3 -third_dm_plex_box_upper 0.4 -third_density 1 -third_youngs_modulus 1", "3 bodies and 2 pairs"},
  };
  Simulation *simulation = (Simulation *)*state;
  Exact       exact;

  AddPaperBars(0);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    SimulationRepeat(simulation, cases[i].options);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(times_and_force),
      simulation_test(solution_of_the_paper),
      simulation_test(moving_frame),
      simulation_test(sides_swapped),
      simulation_test(errors_of_a_run),
      simulation_test(other_problems_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
