/* What a step costs, counted rather than timed; and a changing set of contact nodes: no factorisation. */
#include "simulation.h"
#include <body/layout/bodyimpl.h>
#include <impakt/private/bodystep.h>

#define STEPS 10

static int count(const char name[])
{
  PetscEventPerfInfo info;
  PetscLogEvent      event;

  ok(PetscLogEventGetId(name, &event));
  if (event < 0) return 0; /* its package has not been used yet */
  ok(PetscLogEventGetPerfInfo(PETSC_DETERMINE, event, &info));
  return info.count;
}

static PetscOptions create(Body *body, const char more[])
{
  PetscOptions options = options_begin("-prefix_push box_ -dm_plex_dim 3 -dm_plex_box_faces 3,3,3 -density 1 -youngs_modulus 1 "
                                       "-poissons_ratio 0.3 -initial_velocity sin(x),y*z,0 %s -prefix_pop",
                                       more);

  ok(BodyCreate(PETSC_COMM_WORLD, "box", body));
  ok(BodySetFromOptions(*body));
  ok(BodySetControllerStep(*body, 0, 0.01));
  ok(BodySetUp(*body));
  return options;
}

static int factorisations(void)
{
  static const char *const names[] = {"MatLUFactorNum", "MatCholFctrNum"};
  int                      sum     = 0;
  PetscInt                 n_stages;
  PetscLogState            state;

  ok(PetscLogGetState(&state));
  ok(PetscLogStateGetNumStages(state, &n_stages));
  for (int i = 0; i < 2; i++) {
    PetscEventPerfInfo info;
    PetscLogEvent      event;

    ok(PetscLogEventGetId(names[i], &event));
    if (event < 0) continue;
    for (PetscLogStage stage = 0; stage < n_stages; stage++) {
      ok(PetscLogEventGetPerfInfo(stage, event, &info));
      sum += info.count;
    }
  }
  return sum;
}

static void advance(Body body)
{
  for (PetscInt step = 0; step < STEPS; step++) {
    ok(BodyIntegrate(body));
    ok(BodySave(body));
  }
}

/* Linear, fixed step: factored once for the run; a step is one back-substitution and one internal force, which it begins with */
static void implicit_linear(void **state)
{
  PetscOptions options;
  Body         body;
  int          solves, forces;
  const int    factors = factorisations();

  (void)state;
  options = create(&body, "");
  assert_int_equal(factorisations(),
                   factors + 1); /* the effective matrix; without initial strain there is no acceleration to find by that of the mass */
  solves = count("MatSolve");
  forces = count("BodyForce");
  advance(body);
  assert_int_equal(count("MatSolve") - solves, STEPS);
  assert_int_equal(count("BodyForce") - forces, STEPS); /* nobody asks for that of the end */
  assert_int_equal(factorisations(), factors + 1);
  ok(BodyDestroy(&body));
  options_end(options);
}

/* Explicit: one internal force in a step, and nothing factored or assembled at all */
static void explicit_lumped(void **state)
{
  PetscOptions options;
  Body         body;
  const int    factors = factorisations(), tangents = count("BodyTangent");
  int          forces;

  (void)state;
  options = create(&body, "-ts_type centraldifference");
  forces  = count("BodyForce");
  advance(body);
  assert_int_equal(count("BodyForce") - forces, STEPS);
  assert_int_equal(factorisations(), factors);
  assert_int_equal(count("BodyTangent"), tangents);
  ok(BodyDestroy(&body));
  options_end(options);
}

static const char *const integrators[] = {"-a_ts_type alpha2", "-a_ts_type centraldifference"};

/* A block rolls over a disc: nodes come into contact and leave it, one after the other */
static void a_changing_set_factors_nothing(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-prefix_push a_ -dm_plex_dim 2 -dm_plex_simplex 0 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 -dm_plex_box_faces 12,4 "
             "-dm_plex_box_lower 0,0.01 -dm_plex_box_upper 2,0.61 -initial_velocity 0.02,-0.1-0.05*x -prefix_pop "
             "-bodies a -obstacles disc -disc_obstacle_type cylinder -disc_point 0.7,-3 -disc_radius 3 -time_step 0.02 -time_end 4");
  for (size_t i = 0; i < 2; i++) {
    PetscInt most = 0, least_after = 100, changes = 0, last = 0;
    int      before;

    SimulationRepeat(simulation, integrators[i]);
    before = factorisations();
    for (PetscInt step = 0; step < 100; step++) {
      const ContactPairState pair = Step(simulation);

      changes += pair.active != last;
      last = pair.active;
      most = PetscMax(most, pair.active);
      if (most > 2) least_after = PetscMin(least_after, pair.active);
    }
    assert_true(most >= 3 && changes >= 4);
    assert_true(least_after < most);
    assert_int_equal(factorisations() - before, 0);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(implicit_linear),
      cmocka_unit_test(explicit_lumped),
      simulation_test(a_changing_set_factors_nothing),
  };

  return impakt_main_logged(argc, argv, tests);
}
