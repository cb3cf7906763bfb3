/* The controller step that resolves contact. */
#include "simulation.h"

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
  Simulation *simulation = (Simulation *)*state;
  PetscInt    substeps, parts;

  AddCollision(8, 13, 0);
  near(ChosenStep(simulation, "-time_step auto -left_ts_time_step 0.03 -right_ts_time_step 0.015", NULL), 0.09, 1e-15);
  /* the bodies have three times in common in a controller step, which is made in so many parts: a body tells its substeps in one of them */
  ok(ContactGetParts(simulation->contact, &parts));
  ok(BodyGetSubsteps(simulation->bodies[1], &substeps));
  assert_int_equal(parts, 3);
  assert_int_equal(parts * substeps, 6);
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(transit_of_contact_elements), simulation_test(substeps_divide_it),
                                     simulation_test(closing_speed), simulation_test(nothing_to_choose_by)};

  return impakt_main(argc, argv, tests);
}
