/* The time loop: its steps, its observers, and what it refuses. */
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

/* The frame of the initial state is that of the options */
static PetscErrorCode ObserveStart(Controller controller, const ControllerFrame *frame, void *ctx)
{
  PetscFunctionBegin;
  (void)controller;
  (void)ctx;
  if (frame->step) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < 2; b++) {
    const PetscReal sign = b ? -1 : 1, mass = 1 - COLLISION_GAP / 2;

    near(frame->contact_positions[3 * b], -sign * COLLISION_GAP / 2, 1e-15);
    near(frame->contact_velocities[3 * b], sign * COLLISION_SPEED, 0);
    near(frame->bodies[b].momentum[0], sign * mass * COLLISION_SPEED, 1e-15);
    near(frame->bodies[b].mean_velocity[0], sign * COLLISION_SPEED, 1e-15);
    near(frame->bodies[b].kinetic, 0.5 * mass * COLLISION_SPEED * COLLISION_SPEED, 1e-15);
    near(frame->bodies[b].potential, 0, 0);
  }
  near(frame->pairs[0].gap, COLLISION_GAP, 1e-15);
  near(frame->pairs[0].force, 0, 0);
  assert_int_equal(frame->pairs[0].active, 0);
  assert_int_equal(frame->sweeps, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void initial_frame(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(ControllerMonitorSet(simulation->controller, ObserveStart, NULL, NULL));
  ok(ControllerSolve(simulation->controller));
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
  refused(PETSC_ERR_USER_INPUT, "-time_end and -time_step", SimulationCreate(simulation));
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(monitors_see_every_accepted_step_once),
      simulation_test(monitors_are_limited),
      simulation_test(initial_frame),
      simulation_test(number_of_steps),
      simulation_test(bad_times_are_refused),
      simulation_test(times_are_needed),
      simulation_test(bodies_are_needed),
      simulation_test(names_must_differ),
      simulation_test(named_bodies_must_be_described),
      simulation_test(options_come_before_set_up),
  };

  return impakt_main(argc, argv, tests);
}
