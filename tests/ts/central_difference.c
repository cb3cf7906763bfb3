/*
   The explicit integrator alone, on two masses and springs: K = [[2, -1], [-1, 2]] N/m, M = diag(m, m), m = 0.5 kg.
   Modes (1, 1) and (1, -1) with omega^2 = 1/m = 2 and 3/m = 6 rad^2/s^2; stable for dt < 2/sqrt(6) = 0.816 s.
*/
#include "support.h"
#include <impakt/private/tssecondorder.h>

#define MASS 0.5

static PetscErrorCode Accelerate(TS ts, PetscReal t, Vec U, Vec V, Vec A, void *ctx)
{
  const PetscScalar *u;
  PetscScalar       *a;
  PetscInt           n;

  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)V;
  if (ctx) ++*(PetscInt *)ctx;
  PetscCall(VecGetLocalSize(U, &n));
  PetscCall(VecGetArrayRead(U, &u));
  PetscCall(VecGetArray(A, &a));
  for (PetscInt i = 0; i + 1 < n; i += 2) {
    a[i]     = -(2 * u[i] - u[i + 1]) / MASS;
    a[i + 1] = -(2 * u[i + 1] - u[i]) / MASS;
  }
  PetscCall(VecRestoreArray(A, &a));
  PetscCall(VecRestoreArrayRead(U, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  TS       ts;
  Vec      u, v, a;
  PetscInt evaluations;
} Springs;

/* Such a pair of springs on every rank, from rest at (1, 0), with the step given */
static void create_springs(Springs *s, PetscReal step)
{
  PetscScalar *u;

  s->evaluations = 0;
  ok(VecCreateMPI(PETSC_COMM_WORLD, 2, PETSC_DETERMINE, &s->u));
  ok(VecDuplicate(s->u, &s->v));
  ok(VecDuplicate(s->u, &s->a));
  ok(VecGetArray(s->u, &u));
  u[0] = 1;
  ok(VecRestoreArray(s->u, &u));
  ok(TSCreate(PETSC_COMM_WORLD, &s->ts));
  ok(TSSetType(s->ts, TSCENTRALDIFFERENCE)); /* by its name, from the registry */
  ok(TS2SetSolution(s->ts, s->u, s->v));
  ok(TSCentralDifferenceSetAcceleration(s->ts, Accelerate, s->a, &s->evaluations));
  ok(Accelerate(s->ts, 0, s->u, s->v, s->a, NULL));
  ok(TSSetTimeStep(s->ts, step));
  ok(TSSetMaxTime(s->ts, 1e300));
  ok(TSSetMaxSteps(s->ts, 1000000));
  ok(TSSetExactFinalTime(s->ts, TS_EXACTFINALTIME_STEPOVER));
  ok(TSSetUp(s->ts));
}

static void destroy_springs(Springs *s)
{
  ok(TSDestroy(&s->ts));
  ok(VecDestroy(&s->u));
  ok(VecDestroy(&s->v));
  ok(VecDestroy(&s->a));
}

static void step(Springs *s, PetscInt steps)
{
  for (PetscInt k = 0; k < steps; k++) ok(TSStep(s->ts));
}

static void get(Vec vec, PetscReal values[2])
{
  const PetscScalar *array;

  ok(VecGetArrayRead(vec, &array));
  values[0] = array[0];
  values[1] = array[1];
  ok(VecRestoreArrayRead(vec, &array));
}

/* Staggered energy 1/2 v'Mv - dt^2/8 a'Ma + 1/2 u'Ku of this rank's springs */
static PetscReal energy(Springs *s, PetscReal dt)
{
  PetscReal u[2], v[2], a[2], sum = 0;

  get(s->u, u);
  get(s->v, v);
  get(s->a, a);
  for (PetscInt i = 0; i < 2; i++) sum += 0.5 * MASS * (v[i] * v[i] - 0.25 * dt * dt * a[i] * a[i]);
  return sum + u[0] * u[0] - u[0] * u[1] + u[1] * u[1];
}

/* Mode (1, 1) alone follows u_n = cos(n phi), sin(phi / 2) = omega dt / 2: central differences' own frequency */
static void has_the_frequency_of_central_differences(void **state)
{
  const PetscReal dt = 0.5, phi = 2 * PetscAsinReal(0.5 * dt * PetscSqrtReal(2));
  PetscReal       u[2];
  Springs         s;

  (void)state;
  create_springs(&s, dt);
  ok(VecSet(s.u, 1));
  ok(Accelerate(s.ts, 0, s.u, s.v, s.a, NULL));
  for (PetscInt n = 1; n <= 100; n++) {
    step(&s, 1);
    get(s.u, u);
    near(u[0], PetscCosReal(n * phi), 1e-12); /* round-off of 100 steps, each of some 1e-16 */
    near(u[1], u[0], 1e-12);
  }
  destroy_springs(&s);
}

static void conserves_staggered_energy(void **state)
{
  const PetscReal dt = 0.4; /* half the stable step: the usual energy swings by several per cent */
  PetscReal       start, lowest, highest;
  Springs         s;

  (void)state;
  create_springs(&s, dt);
  start = lowest = highest = energy(&s, dt);
  near(start, 1 - dt * dt / 8 * MASS * (16 + 4), 1e-15); /* a = (-4, 2) */
  for (PetscInt k = 0; k < 10000; k++) {
    step(&s, 1);
    lowest  = PetscMin(lowest, energy(&s, dt));
    highest = PetscMax(highest, energy(&s, dt));
  }
  /* 1e4 steps, a few units in the last place of 1 J (1e-16 J) each, adding up at random to 1e2 or at worst to 1e4 of them */
  near(lowest, start, 1e-12);
  near(highest, start, 1e-12);
  destroy_springs(&s);
}

/* Another time, step and number of steps, and on from there */
static void can_be_put_at_another_time(void **state)
{
  PetscReal time, u[2], expected[2];
  PetscInt  n;
  Springs   s, other;

  (void)state;
  create_springs(&s, 0.3);
  create_springs(&other, 0.1);
  ok(TSSecondOrderSetState(s.ts, 5, 0.1, 17));
  step(&s, 2);
  step(&other, 2);
  ok(TSGetTime(s.ts, &time));
  near(time, 5.2, 2e-15); /* two roundings */
  ok(TSGetStepNumber(s.ts, &n));
  assert_int_equal(n, 19);
  get(s.u, u);
  get(other.u, expected);
  assert_memory_equal(u, expected, sizeof(u)); /* the force does not depend on time */
  destroy_springs(&s);
  destroy_springs(&other);
}

/* What TSStep() would copy for a step back is not kept: a step back is refused, and so is another vector to go on with */
static void refuses_to_roll_back(void **state)
{
  Springs s;
  Vec     other;

  (void)state;
  create_springs(&s, 0.1);
  ok(VecDuplicate(s.u, &other));
  step(&s, 1);
  refused(PETSC_ERR_SUP, "cannot be rolled back", TSRollBack(s.ts));
  ok(TS2SetSolution(s.ts, other, s.v));
  refused(PETSC_ERR_ARG_WRONGSTATE, "another vector", TSStep(s.ts));
  ok(VecDestroy(&other));
  destroy_springs(&s);
}

static void refuses_to_set_up_without_its_parts(void **state)
{
  Vec u, v, a;
  TS  ts;

  (void)state;
  ok(VecCreateMPI(PETSC_COMM_WORLD, 2, PETSC_DETERMINE, &u));
  ok(VecDuplicate(u, &v));
  ok(VecDuplicate(u, &a));
  ok(TSCreate(PETSC_COMM_WORLD, &ts));
  ok(TSSetType(ts, TSCENTRALDIFFERENCE));
  ok(TS2SetSolution(ts, u, v));
  refused(PETSC_ERR_ARG_WRONGSTATE, "TSCentralDifferenceSetAcceleration()", TSSetUp(ts));
  ok(TSCentralDifferenceSetAcceleration(ts, Accelerate, a, NULL));
  ok(TSSetUp(ts));
  ok(TSDestroy(&ts));

  ok(TSCreate(PETSC_COMM_WORLD, &ts));
  ok(TSSetType(ts, TSCENTRALDIFFERENCE));
  ok(TSSetSolution(ts, u)); /* displacements alone */
  ok(TSCentralDifferenceSetAcceleration(ts, Accelerate, a, NULL));
  refused(PETSC_ERR_ARG_WRONGSTATE, "TS2SetSolution()", TSSetUp(ts));
  ok(TSDestroy(&ts));
  ok(VecDestroy(&u));
  ok(VecDestroy(&v));
  ok(VecDestroy(&a));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(has_the_frequency_of_central_differences),
      cmocka_unit_test(conserves_staggered_energy),
      cmocka_unit_test(can_be_put_at_another_time),
      cmocka_unit_test(refuses_to_roll_back),
      cmocka_unit_test(refuses_to_set_up_without_its_parts),
  };

  return impakt_main(argc, argv, tests);
}
