/* What a step costs, counted rather than timed. */
/* ranks: 1 */
#include "support.h"
#include <body/layout/bodyimpl.h>

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

static void advance(Body body)
{
  for (PetscInt step = 0; step < STEPS; step++) {
    ok(BodyIntegrate(body));
    ok(BodySave(body));
  }
}

/* Linear, fixed step: factored once for the run; a step is one back-substitution and one internal force, at its end, which the next step
   begins with */
static void implicit_linear(void **state)
{
  PetscOptions options;
  Body         body;
  int          solves, forces;
  const int    factors = count("MatLUFactorNum");

  (void)state;
  options = create(&body, "");
  assert_int_equal(count("MatLUFactorNum"),
                   factors + 1); /* the effective matrix; without initial strain there is no acceleration to find by that of the mass */
  solves = count("MatSolve");
  forces = count("BodyForce");
  advance(body);
  assert_int_equal(count("MatSolve") - solves, STEPS);
  assert_int_equal(count("BodyForce") - forces, STEPS + 1); /* and that of the start */
  assert_int_equal(count("MatLUFactorNum"), factors + 1);
  ok(BodyDestroy(&body));
  options_end(options);
}

/* Explicit: one internal force in a step, and nothing factored or assembled at all */
static void explicit_lumped(void **state)
{
  PetscOptions options;
  Body         body;
  const int    factors = count("MatLUFactorNum"), tangents = count("BodyTangent");
  int          forces;

  (void)state;
  options = create(&body, "-ts_type centraldifference");
  forces  = count("BodyForce");
  advance(body);
  assert_int_equal(count("BodyForce") - forces, STEPS);
  assert_int_equal(count("MatLUFactorNum"), factors);
  assert_int_equal(count("BodyTangent"), tangents);
  ok(BodyDestroy(&body));
  options_end(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(implicit_linear),
      cmocka_unit_test(explicit_lumped),
  };

  return impakt_main_logged(argc, argv, tests);
}
