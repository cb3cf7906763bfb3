/* Steps of TSRIGID: a function makes them, and the clock goes on. */
#include "support.h"

/* Both go up by what time passes */
static PetscErrorCode Advance(TS ts, PetscReal t, PetscReal dt, Vec U, Vec V, void *ctx)
{
  PetscFunctionBegin;
  (void)ts;
  *(PetscReal *)ctx = t;
  PetscCall(VecShift(U, dt));
  PetscCall(VecShift(V, 2 * dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void lets_a_function_make_steps(void **state)
{
  PetscReal t = -1, time, largest;
  TS        ts;
  Vec       u, v;

  (void)state;
  ok(VecCreateMPI(PETSC_COMM_WORLD, 2, PETSC_DETERMINE, &u));
  ok(VecDuplicate(u, &v));
  ok(TSCreate(PETSC_COMM_WORLD, &ts));
  ok(TSSetType(ts, TSRIGID));
  ok(TSSetSolution(ts, u)); /* displacements alone */
  refused(PETSC_ERR_ARG_WRONGSTATE, "TS2SetSolution()", TSSetUp(ts));
  ok(TS2SetSolution(ts, u, v));
  refused(PETSC_ERR_ARG_WRONGSTATE, "TSRigidSetAdvance()", TSSetUp(ts));
  ok(TSRigidSetAdvance(ts, Advance, &t));
  ok(TSSetMaxTime(ts, 1e300));
  ok(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  ok(TSSetUp(ts));
  ok(TSSecondOrderSetState(ts, 1, 0.25, 0));
  for (PetscInt k = 0; k < 3; k++) ok(TSStep(ts));
  near(t, 1.5, 0);
  ok(TSGetTime(ts, &time));
  near(time, 1.75, 0);
  ok(VecMax(u, NULL, &largest));
  near(largest, 0.75, 0);
  ok(VecMax(v, NULL, &largest));
  near(largest, 1.5, 0);
  ok(TSDestroy(&ts));
  ok(VecDestroy(&u));
  ok(VecDestroy(&v));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(lets_a_function_make_steps)};

  return impakt_main(argc, argv, tests);
}
