/* Controller steps that fail are made again in halves: when, how often, what observers see, and what is left when no cut helps. */
#include "simulation.h"

/* Two neo-Hookean bars at half the speed of sound each: stress that Newton's method finds in 3 iterations at 0.02 s, and in 2 at a quarter
 * of it
 */
static void AddFastCollision(void)
{
  AddBar("left", -1, -1e-3, 8, 0.5);
  AddBar("right", 1e-3, 1, 13, -0.5);
  AddOptions("-bodies left,right -contact_pairs left:right -time_step 0.02 -time_end 1 -left_material_type neo_hookean "
             "-right_material_type neo_hookean");
}

typedef struct {
  PetscInt  frames, cuts;
  PetscReal energy; /* at the end [J] */
} Seen;

static PetscErrorCode Observe(Controller controller, const ControllerFrame *frame, void *ctx)
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
  ok(ControllerMonitorSet(simulation->controller, Observe, &seen, NULL));
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
