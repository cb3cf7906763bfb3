/* ranks: 1 3 */
/* long: 3 */
/* The time loop: its steps, the one that resolves contact, its observers, what it refuses; steps that fail are made again in halves: when,
   how often, what observers see, and what is left when no cut helps. */
#include "simulation.h"

/* What a monitor has seen, and in which order among others */
typedef struct {
  PetscInt *clock; /* counts the calls of all monitors */
  PetscInt  calls, last_clock, destroyed;
  PetscReal last_time;
} Watch;

static PetscErrorCode Observe(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Watch    *watch = (Watch *)ctx;
  PetscInt  steps;
  PetscReal start, time_step;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, &start, &time_step, &steps));
  assert_int_equal(frame->step, watch->calls); /* 0 is the initial state; no step comes twice, none is left out */
  assert_int_equal(frame->steps, steps);
  near(frame->time, start + frame->step * time_step, 0);
  assert_int_equal(frame->n_bodies, 2);
  assert_int_equal(frame->n_pairs, 1);
  watch->last_time  = frame->time;
  watch->last_clock = (*watch->clock)++;
  watch->calls++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Forget(void **ctx)
{
  PetscFunctionBegin;
  ((Watch *)*ctx)->destroyed++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void monitors_see_every_accepted_step_once(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscInt    clock      = 0;
  Watch       first = {.clock = &clock}, second = {.clock = &clock};

  AddCollision(4, 3, 0); /* 10 steps, in most of which the bodies are integrated several times */
  ok(SimulationCreate(simulation));
  ok(ControllerMonitorSet(simulation->controller, Observe, &first, Forget));
  ok(ControllerMonitorSet(simulation->controller, Observe, &second, NULL));
  ok(ControllerSolve(simulation->controller));
  assert_int_equal(first.calls, 11);
  assert_int_equal(second.calls, 11);
  assert_int_equal(second.last_clock, 21); /* in the order in which they were set */
  assert_int_equal(first.last_clock, 20);
  assert_int_equal(first.destroyed, 0);
  ok(ControllerDestroy(&simulation->controller));
  assert_null(simulation->controller);
  assert_int_equal(first.destroyed, 1);
  assert_int_equal(second.destroyed, 0);
}

static void monitors_are_limited(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscInt    clock      = 0;
  Watch       watch      = {.clock = &clock};

  ok(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
  for (PetscInt i = 0; i < 16; i++) ok(ControllerMonitorSet(simulation->controller, Observe, &watch, Forget));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "at most 16", ControllerMonitorSet(simulation->controller, Observe, &watch, Forget));
  ok(ControllerDestroy(&simulation->controller));
  assert_int_equal(watch.destroyed, 16);
}

static void number_of_steps(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const struct {
    const char *options;
    PetscInt    steps;
  } cases[] = {
      {"-time_start 0 -time_end 1 -time_step 0.25", 4},
      {"-time_start 0 -time_end 1 -time_step 0.3", 4},                   /* the run ends with the first step that reaches the end */
      {"-time_start 0 -time_end 0.3 -time_step 0.1", 3},                 /* 0.3 / 0.1 is below 3 by a rounding */
      {"-time_start 0 -time_end 0.30000000000000004 -time_step 0.1", 3}, /* and this above it */
      {"-time_start -2e-4 -time_end 8e-4 -time_step 1e-7", 10000},       /* the paper's */
      {"-time_start -0.5 -time_end 0.1 -time_step 1", 1},
  };
  PetscInt steps;

  AddCollision(4, 3, 0);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    SimulationRepeat(simulation, cases[i].options);
    ok(ControllerGetTimes(simulation->controller, NULL, NULL, &steps));
    assert_int_equal(steps, cases[i].steps);
  }
}

static void bad_times_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-time_start 0 -time_end 1 -time_step 0", "-time_step 0|must be positive"},
      {"-time_start 0 -time_end 1 -time_step -1", "-time_step -1|must be positive"},
      {"-time_start 2 -time_end 1 -time_step 0.1", "-time_end 1|later than -time_start 2"},
      {"-time_start 1 -time_end 1 -time_step 0.1", "-time_end 1|later than -time_start 1"},
      {"-time_start 0 -time_end 1 -time_step 1e-12", "-time_step 1e-12 s is too small"},
  };

  AddCollision(4, 3, 0);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    AddOptions(cases[i].options);
    refused(PETSC_ERR_USER_INPUT, cases[i].words, SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
  }
}

static void times_are_needed(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddBar("left", 0, 1, 4, 0);
  AddOptions("-bodies left -time_end 1");
  refused(PETSC_ERR_USER_INPUT, "-time_step is missing|-time_step auto", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  ok(PetscOptionsClearValue(NULL, "-time_end"));
  AddOptions("-time_step 0.1");
  refused(PETSC_ERR_USER_INPUT, "-time_end is missing", SimulationCreate(simulation));
}

static void bodies_are_needed(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-time_step 0.1 -time_end 1");
  refused(PETSC_ERR_USER_INPUT, "-bodies is missing", SimulationCreate(simulation));
}

static void names_must_differ(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-bodies left,right,left");
  refused(PETSC_ERR_USER_INPUT, "-bodies|'left' twice", SimulationCreate(simulation));
}

static void named_bodies_must_be_described(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-bodies left,rihgt");
  refused(PETSC_ERR_USER_INPUT, "'rihgt'|no mesh|-rihgt_dm_plex_box_faces", SimulationCreate(simulation));
}

static void options_come_before_set_up(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  ok(ControllerCreate(PETSC_COMM_WORLD, &simulation->controller));
  refused(PETSC_ERR_ARG_WRONGSTATE, "ControllerSetFromOptions()", ControllerSetUp(simulation->controller));
}

/* Bars of density and modulus 1, in which waves run at 1 m/s: elements of h m have the mass h and the stiffness 1/h for each unit of area
 */
#define H_LEFT  (0.999 / 8)
#define H_RIGHT (0.999 / 13)

static PetscReal ChosenStep(Simulation *simulation, const char options[], PetscInt *steps)
{
  PetscReal step;

  SimulationRepeat(simulation, options);
  ok(ControllerGetTimes(simulation->controller, NULL, &step, steps));
  return step;
}

static void transit_of_contact_elements(void **state)
{
  Simulation     *simulation = (Simulation *)*state;
  const PetscReal resolved   = PetscSqrtReal(H_LEFT * H_RIGHT); /* (h1 + h2) / (1/h1 + 1/h2) = h1 h2 */
  PetscReal       step;
  PetscInt        steps;

  AddCollision(8, 13, 0);
  AddOptions("-time_end 1");
  step = ChosenStep(simulation, "-time_step auto", &steps);
  assert_int_equal(steps, (PetscInt)PetscCeilReal(1 / resolved));
  near(step, 1.0 / steps, 1e-15);
  /* four times the modulus: half the time through elements of the right bar, of four times the stiffness */
  step = ChosenStep(simulation, "-right_youngs_modulus 4 -time_end 100", &steps);
  near(step, PetscSqrtReal((H_LEFT + H_RIGHT / 4) / (1 / H_LEFT + 1 / H_RIGHT)), 2e-3 * step); /* rounded to divide 100 s */
  assert_true(step <= PetscSqrtReal((H_LEFT + H_RIGHT / 4) / (1 / H_LEFT + 1 / H_RIGHT)));
}

static void substeps_divide_it(void **state)
{
  Simulation   *simulation = (Simulation *)*state;
  ContactTraits traits;
  PetscInt      substeps;

  AddCollision(8, 13, 0);
  near(ChosenStep(simulation, "-time_step auto -left_ts_time_step 0.03 -right_ts_time_step 0.015", NULL), 0.09, 1e-15);
  /* the bodies have three times in common in a controller step, which is made in so many parts: a body tells its substeps in one of them */
  ok(ContactGetTraits(simulation->contact, &traits));
  ok(BodyGetSubsteps(simulation->bodies[1], &substeps));
  assert_int_equal(traits.parts, 3);
  assert_int_equal(traits.parts * substeps, 6);
  /* even one substep may be longer than what resolves contact */
  near(ChosenStep(simulation, "-left_ts_time_step 0.12 -right_ts_time_step 0.12", NULL), 0.12, 1e-15);
  /* explicit bodies without a substep get one that is stable */
  (void)ChosenStep(simulation, "-left_ts_time_step 0.01 -right_ts_time_step auto -right_ts_type centraldifference", NULL);
  ok(BodyGetSubsteps(simulation->bodies[1], &substeps));
  assert_true(substeps > 1);
}

/* At 10 m/s each, ten times the speed of waves, whatever the frame */
static void closing_speed(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  PetscReal   step;

  AddCollision(8, 13, 0);
  AddOptions("-time_end 100 -time_step auto");
  step = ChosenStep(simulation, "-left_initial_velocity 10 -right_initial_velocity -10", NULL);
  near(step, 0.25 * H_RIGHT / 20, 1e-4 * step);
  near(ChosenStep(simulation, "-left_initial_velocity 30 -right_initial_velocity 10", NULL), step, 1e-15);
}

static void nothing_to_choose_by(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 13, 0);
  AddOptions("-time_step auto -contact_pairs none");
  refused(PETSC_ERR_USER_INPUT, "-time_step auto|give -time_step", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-time_step soon");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "soon", SimulationCreate(simulation));
}

/* Two neo-Hookean bars at half the speed of sound each: stress that Newton's method finds in 3 iterations at 0.02 s, and in 2 at a quarter
 * of it
 */
static void AddFastCollision(void)
{
  AddBar("left", -1, -1e-3, 8, 0.5);
  AddBar("right", 1e-3, 1, 13, -0.5);
  AddOptions("-bodies left,right -contact_pairs left:right -time_step 0.02 -time_end 1 -left_material_type neo_hookean "
             "-right_material_type neo_hookean -contact_type alternation");
}

typedef struct {
  PetscInt  frames, cuts;
  PetscReal energy; /* at the end [J] */
} Seen;

static PetscErrorCode CutsObserve(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Seen     *seen = (Seen *)ctx;
  PetscReal start, time_step;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, &start, &time_step, NULL));
  assert_int_equal(frame->step, seen->frames++); /* whole steps alone */
  near(frame->time, start + frame->step * time_step, 0);
  seen->cuts += frame->step_cuts;
  seen->energy = 0;
  for (PetscInt b = 0; b < frame->n_bodies; b++) seen->energy += frame->bodies[b].kinetic + frame->bodies[b].potential;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static Seen Solve(Simulation *simulation, const char options[], ControllerCuts *cuts)
{
  Seen seen = {0};

  SimulationRepeat(simulation, options);
  ok(ControllerMonitorSet(simulation->controller, CutsObserve, &seen, NULL));
  ok(ControllerSolve(simulation->controller));
  ok(ControllerGetCuts(simulation->controller, cuts));
  assert_int_equal(seen.cuts, cuts->cuts);
  return seen;
}

static void newton(void **state)
{
  Simulation    *simulation = (Simulation *)*state;
  ControllerCuts cuts;
  Seen           seen;

  AddFastCollision();
  /* fast enough that Newton's method needs a third iteration in half a step too */
  AddOptions("-left_snes_max_it 2 -left_initial_velocity 0.6 -right_initial_velocity -0.6");
  SimulationRepeat(simulation, "-controller_step_cuts 0");
  refused(PETSC_ERR_NOT_CONVERGED, "Newton's method|'left'|MAX_IT after 2 iterations", ControllerSolve(simulation->controller));
  SimulationRepeat(simulation, "-controller_step_cuts 1");
  refused(PETSC_ERR_NOT_CONVERGED, "Newton's method|'left'|MAX_IT after 2 iterations|cut in halves 1 time, to 0.01 s",
          ControllerSolve(simulation->controller));
  seen = Solve(simulation, "-controller_step_cuts 4", &cuts);
  assert_int_equal(seen.frames, 51);
  between(cuts.steps, 1, 50);
  assert_true(cuts.cuts >= cuts.steps);
  near(cuts.smallest_step, 0.005, 1e-15);
  assert_int_equal(cuts.lossy_steps, 0);
}

/* The solver inside Newton's method, where the matrix is not constant; with that of a linear body no step helps, and it is an error at once
 */
static void linear_solver(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddFastCollision();
  AddOptions("-left_ksp_type cg -left_pc_type none -left_ksp_max_it 2 -controller_step_cuts 1");
  SimulationRepeat(simulation, "");
  refused(PETSC_ERR_NOT_CONVERGED, "linear solver in Newton's method|'left'|DIVERGED_ITS|cut in halves 1 time, to 0.01 s",
          ControllerSolve(simulation->controller));
}

/* An element that a step of 0.2 s inverts, at 0.6 of the speed of sound */
static void inverted_element(void **state)
{
  Simulation    *simulation = (Simulation *)*state;
  ControllerCuts cuts;

  AddFastCollision();
  AddOptions("-time_step 0.2 -left_initial_velocity 0.6 -right_initial_velocity -0.6 -contact_energy_tolerance 100");
  SimulationRepeat(simulation, "-controller_step_cuts 0");
  refused(PETSC_ERR_FP, "element |is inverted", ControllerSolve(simulation->controller));
  (void)Solve(simulation, "-controller_step_cuts 4", &cuts);
  assert_true(cuts.cuts > 0);
}

static void outer_iteration(void **state)
{
  Simulation    *simulation = (Simulation *)*state;
  ContactCounts  counts;
  ControllerCuts cuts;

  AddFastCollision();
  AddOptions("-schwarz_snes_max_it 1 -controller_step_cuts 2 -contact_energy_tolerance 100");
  SimulationRepeat(simulation, "");
  refused(PETSC_ERR_NOT_CONVERGED, "Schwarz iteration did not converge|-schwarz_unconverged accept|cut in halves 2 times, to 0.005 s",
          ControllerSolve(simulation->controller));
  /* cuts come first, acceptance after the last one */
  (void)Solve(simulation, "-schwarz_unconverged accept", &cuts);
  ok(ContactGetCounts(simulation->contact, &counts));
  assert_true(counts.unconverged_steps > 0);
  near(cuts.smallest_step, 0.005, 1e-15);
  (void)Solve(simulation, "-controller_step_cuts 0", &cuts);
  ok(ContactGetCounts(simulation->contact, &counts));
  assert_true(counts.unconverged_steps > 0);
  assert_int_equal(cuts.cuts, 0);
}

/* Linear bars, of which the left one's contact element takes 1/8 s for a wave: a step of 0.1 s changes the energy by more than 1e-3, its
   parts leave less of an error */
static void energy(void **state)
{
  Simulation    *simulation = (Simulation *)*state;
  ControllerCuts cuts;
  PetscReal      before, whole, cut;

  AddCollision(8, 13, 0);
  AddOptions("-time_step 0.1 -time_end 4");
  SimulationRepeat(simulation, "-controller_step_cuts 0");
  before = TotalEnergy(simulation);
  whole  = PetscAbsReal(Solve(simulation, "", &cuts).energy / before - 1);
  assert_int_equal(cuts.cuts, 0);
  near(cuts.smallest_step, 0.1, 0);
  cut = PetscAbsReal(Solve(simulation, "-controller_step_cuts 4", &cuts).energy / before - 1);
  assert_true(cuts.cuts > 0);
  assert_true(cut < 0.2 * whole);
  /* a tolerance that cannot be met: all cuts are used, and what is accepted is counted */
  (void)Solve(simulation, "-contact_energy_tolerance 1e-14", &cuts);
  assert_true(cuts.lossy_steps > 0);
  near(cuts.smallest_step, 0.1 / 16, 1e-15);
}

/* Their multipliers change the start of a step */
static void forward_increments_are_not_cut(void **state)
{
  Simulation    *simulation = (Simulation *)*state;
  ControllerCuts cuts;

  AddCollision(8, 13, 0);
  AddOptions("-contact_type lagrange -left_ts_type centraldifference -right_ts_type centraldifference -left_mass_redistribute 0 "
             "-right_mass_redistribute 0 -contact_energy_tolerance 1e-14");
  (void)Solve(simulation, "", &cuts);
  assert_int_equal(cuts.cuts, 0);
}

static void wrong_options_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(8, 13, 0);
  AddOptions("-controller_step_cuts -1");
  refused(PETSC_ERR_USER_INPUT, "-controller_step_cuts -1|0 to 20", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-controller_step_cuts 21");
  refused(PETSC_ERR_USER_INPUT, "-controller_step_cuts 21|0 to 20", SimulationCreate(simulation));
  ok(ControllerDestroy(&simulation->controller));
  AddOptions("-controller_step_cuts 1 -contact_energy_tolerance 0");
  refused(PETSC_ERR_USER_INPUT, "-contact_energy_tolerance 0|must be positive", SimulationCreate(simulation));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(monitors_see_every_accepted_step_once),
      simulation_test(monitors_are_limited),
      simulation_test(number_of_steps),
      simulation_test(bad_times_are_refused),
      simulation_test(times_are_needed),
      simulation_test(bodies_are_needed),
      simulation_test(names_must_differ),
      simulation_test(named_bodies_must_be_described),
      simulation_test(options_come_before_set_up),
      simulation_test(transit_of_contact_elements),
      simulation_test(substeps_divide_it),
      simulation_test(closing_speed),
      simulation_test(nothing_to_choose_by),
      simulation_test(newton),
      simulation_test(linear_solver),
      simulation_test(inverted_element),
      simulation_test(outer_iteration),
      simulation_test(energy),
      simulation_test(forward_increments_are_not_cut),
      simulation_test(wrong_options_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
