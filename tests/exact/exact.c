/* Exact solutions: the closed form for two equal bars, Hoy, Tezaur, Mota, eqs. (4.1) to (4.7), and the method of characteristics. */
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
  AddOptions("-bodies left,right -time_start -2e-4 -time_end 8e-4 -time_step 1e-5 -left_density 1000 -right_density 1000 "
             "-left_youngs_modulus 1e9 -right_youngs_modulus 1e9 -left_cross_section 1e-6 -right_cross_section 1e-6");
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
  Simulation  *simulation = (Simulation *)*state;
  Exact        exact;
  ExactFigures figures;

  AddPaperBars(0);
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  ok(ExactGetFigures(exact, &figures));
  near(figures.impact, 0, 1e-18);
  near(figures.release, 5e-4, 1e-17);
  near(figures.force, 100, 1e-11);
  ok(ExactDestroy(&exact));
  assert_null(exact);
}

static void solution_of_the_paper(void **state)
{
  /* contact position, contact velocity, contact force, kinetic and potential energy, mean velocity */
  const struct {
    PetscReal time, expected[6];
  } cases[] = {
      {-2e-4, {-0.02, 100, 0, 1.25, 0, 100}},    {-1e-4, {-0.01, 100, 0, 1.25, 0, 100}},
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
  ControllerFrame  frame = {
      .n_bodies = 2, .n_pairs = 1, .bodies = bodies, .contact_positions = positions, .contact_velocities = velocities, .pairs = &pair};
  ExactSolution solution;
  Exact         exact;
  ExactErrors   errors;

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

/*
   The same by marching: in each step of 1e-6 s waves move on by one point of arrays that are the bars. Everything falls on the grid,
   and so only round-off of 3200 steps may differ. Left: c = 1000 m/s, 0.25 m, 250 points, Z = 1 kg/s. The gap of 0.04 m closes at
   200 m/s, after 200 steps.
*/
typedef struct {
  PetscInt  n;
  PetscReal impedance, out[500], in[500]; /* from the contact face on */
} Grid;

static void GridStep(Grid bars[2], PetscReal *gap, PetscReal step, PetscReal *force)
{
  PetscReal in[2], velocity[2];

  for (PetscInt side = 0; side < 2; side++) in[side] = bars[side].in[0];
  *force = *gap <= 1e-9 ? PetscMax(0, 2 * (in[0] - in[1]) / (1 / bars[0].impedance + 1 / bars[1].impedance)) : 0;
  for (PetscInt side = 0; side < 2; side++) {
    Grid           *bar = &bars[side];
    const PetscReal out = in[side] + (side ? 1 : -1) * *force / bar->impedance;

    velocity[side] = in[side] + out;
    for (PetscInt i = 0; i + 1 < bar->n; i++) bar->in[i] = bar->in[i + 1];
    bar->in[bar->n - 1] = bar->out[bar->n - 1]; /* a free end */
    for (PetscInt i = bar->n - 1; i > 0; i--) bar->out[i] = bar->out[i - 1];
    bar->out[0] = out;
  }
  *gap += step * (velocity[1] - velocity[0]);
}

static void GridMeasure(const Grid *bar, PetscReal step, PetscReal *kinetic, PetscReal *potential, PetscReal *mean)
{
  *kinetic = *potential = *mean = 0;
  for (PetscInt i = 0; i < bar->n; i++) {
    *kinetic += 0.5 * bar->impedance * step * PetscSqr(bar->out[i] + bar->in[i]);
    *potential += 0.5 * bar->impedance * step * PetscSqr(bar->out[i] - bar->in[i]);
    *mean += (bar->out[i] + bar->in[i]) / bar->n;
  }
}

static void March(Simulation *simulation, PetscInt points, PetscReal impedance, PetscReal release)
{
  const PetscReal step    = 1e-6;
  Grid            bars[2] = {{.n = 250, .impedance = 1}, {.n = points, .impedance = impedance}};
  PetscReal       gap = 0.04, impulse = 0;
  ExactFigures    figures;
  Exact           exact;

  for (PetscInt i = 0; i < 500; i++) {
    bars[0].out[i] = bars[0].in[i] = 90;
    bars[1].out[i] = bars[1].in[i] = -10;
  }
  ok(ExactCreate(simulation->controller, EXACT_CHARACTERISTICS, &exact));
  for (PetscInt k = 0; k < 3200; k++) {
    PetscReal force;

    for (PetscInt side = 0; side < 2; side++) {
      ExactSolution solution;
      PetscReal     kinetic, potential, mean;

      ok(ExactEvaluate(exact, side, -2e-4 + k * step, &solution));
      GridMeasure(&bars[side], step, &kinetic, &potential, &mean);
      near(kinetic, solution.kinetic, 1e-10); /* of some J */
      near(potential, solution.potential, 1e-10);
      near(mean, solution.mean_velocity, 1e-9); /* of 100 m/s */
    }
    GridStep(bars, &gap, step, &force);
    impulse += force * step;
    for (PetscInt side = 0; side < 2; side++) {
      ExactSolution solution;

      ok(ExactEvaluate(exact, side, -2e-4 + (k + 0.5) * step, &solution));
      near(force, solution.contact_force, 1e-9); /* of 100 N */
    }
  }
  ok(ExactGetFigures(exact, &figures));
  near(figures.impact, 0, 1e-15);
  near(figures.release, release, 1e-15);
  near(impulse, figures.impulse, 1e-12); /* of 0.05 N s */
  ok(ExactDestroy(&exact));
}

static void characteristics_by_marching(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddPaperBars(0);
  AddOptions("-left_initial_velocity 180 -right_initial_velocity -20 -time_end 3e-3");
  /* c = 2000 m/s, 0.3 m, Z = 2 kg/s: the left bar has turned round when its own wave is back, at 2 L/c = 5e-4 s */
  SimulationRepeat(simulation, "-right_dm_plex_box_upper 0.32 -right_youngs_modulus 4e9");
  March(simulation, 150, 2, 5e-4);
  /* c = 1000 m/s, 0.4 m, Z = 0.25 kg/s: the left bar pushes on, with less force after 5e-4 s, and is left when the right bar's wave is
     back, after 8e-4 s */
  SimulationRepeat(simulation, "-right_dm_plex_box_upper 0.42 -right_youngs_modulus 1e9 -right_cross_section 0.25e-6");
  March(simulation, 400, 0.25, 8e-4);
}

/*
   Equal impedances, 0.25 and 0.5 m: the left bar's wave is back after 5e-4 s, and the force ends, with both faces at -100 m/s, where they
   stay side by side until the right bar's wave is back, after 1e-3 s. Its face then flies at 100 m/s.
*/
static void characteristics_of_grazing(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  Exact         exact;
  ExactSolution bars[2];
  ExactFigures  figures;

  AddPaperBars(0);
  AddOptions("-right_dm_plex_box_upper 0.52 -time_end 1.1e-3");
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_CHARACTERISTICS, &exact));
  ok(ExactGetFigures(exact, &figures));
  near(figures.impact, 0, 1e-18);
  near(figures.release, 5e-4, 1e-15);
  near(figures.impulse, 0.05, 1e-14);
  for (PetscInt k = 1; k <= 50; k++) {
    for (PetscInt side = 0; side < 2; side++) ok(ExactEvaluate(exact, side, 5e-4 + k * 1e-5, &bars[side]));
    near(bars[0].contact_force, 0, 0);
    near(bars[1].contact_position, bars[0].contact_position, 1e-15); /* and no gap */
    near(bars[0].contact_velocity, -100, 1e-10);
    near(bars[1].contact_velocity, -100, 1e-10);
  }
  for (PetscInt side = 0; side < 2; side++) ok(ExactEvaluate(exact, side, 1.1e-3, &bars[side]));
  near(bars[1].contact_position - bars[0].contact_position, 200 * 1e-4, 1e-13);
  /* nothing moves along with the left bar; of 0.5 m, 0.4 m fly at -100 m/s, and the wave has come back through 0.1 m, at 100 m/s */
  near(bars[0].mean_velocity, -100, 1e-10);
  near(bars[1].contact_velocity, 100, 1e-10);
  refused(PETSC_ERR_ARG_OUTOFRANGE, "0.0011 s|not at 0.0012 s", ExactEvaluate(exact, 0, 1.2e-3, &bars[0]));
  ok(ExactDestroy(&exact));
}

/* Bars that touch at the start, and a run that ends before release */
static void characteristics_from_touching(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  Exact         exact;
  ExactSolution solution;
  ExactFigures  figures;

  AddBar("left", -0.25, 0, 4, 1);
  AddBar("right", 0, 0.5, 4, -1);
  AddOptions("-bodies left,right -time_step 0.01 -time_end 0.3");
  ok(SimulationCreate(simulation));
  ok(ExactCreate(simulation->controller, EXACT_CHARACTERISTICS, &exact));
  ok(ExactGetFigures(exact, &figures));
  near(figures.impact, 0, 0);
  assert_true(PetscIsNanReal(figures.release) && PetscIsNanReal(figures.force));
  /* all of the left bar is at rest and compressed after 0.25 s; then, from the free end, 0.05 m of it fly back */
  ok(ExactEvaluate(exact, 0, 0.3, &solution));
  near(solution.contact_force, 1, 1e-14);
  near(solution.mean_velocity, -0.2, 1e-14);
  near(solution.kinetic, 0.5 * 0.05, 1e-14);
  near(solution.potential, 0.5 * 0.2, 1e-14);
  ok(ExactDestroy(&exact));
}

static void other_problems_are_refused(void **state)
{
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-right_initial_velocity 100", "approach|'left' moves at 100|'right' at 100"},
      {"-right_initial_velocity -100 -bodies left,right,third -contact_pairs left:right,right:third -third_dm_plex_dim 1 "
       "-third_dm_plex_box_faces 4 -third_dm_plex_box_lower 0.3 -third_dm_plex_box_upper 0.4 -third_density 1 -third_youngs_modulus 1",
       "3 bodies and 2 pairs"},
  };
  Simulation *simulation = (Simulation *)*state;
  Exact       exact;

  AddPaperBars(0);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    SimulationRepeat(simulation, cases[i].options);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, ExactCreate(simulation->controller, EXACT_IMPACT, &exact));
  }
  refused(PETSC_ERR_USER_INPUT, "Unknown -exact 'wave'|none impact characteristics", ExactCreate(simulation->controller, "wave", &exact));
  /* waves that arrive more often than anyone can use: 2 L/c = 1.3e-8 s and more, for 1 ms */
  SimulationRepeat(simulation, "-bodies left,right -contact_pairs left:right -right_cross_section 1e-6 -right_dm_plex_box_lower 0.02 "
                               "-right_dm_plex_box_upper 0.0200127 -left_dm_plex_box_lower -0.0200061 -right_density 1 -left_density 1.3");
  refused(PETSC_ERR_USER_INPUT, "arrive at the contact more than 20000 times|-time_end",
          ExactCreate(simulation->controller, EXACT_CHARACTERISTICS, &exact));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(times_and_force),
      simulation_test(solution_of_the_paper),
      simulation_test(moving_frame),
      simulation_test(sides_swapped),
      simulation_test(errors_of_a_run),
      simulation_test(characteristics_by_marching),
      simulation_test(characteristics_of_grazing),
      simulation_test(characteristics_from_touching),
      simulation_test(other_problems_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
