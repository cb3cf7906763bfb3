/* Waveforms over one controller step. */
#include "support.h"

/* A trace of two numbers whose level k holds values[k] and values[k] + 10 */
static Trace make_trace(PetscInt levels, const PetscReal values[])
{
  Trace        trace;
  PetscScalar *level;

  ok(TraceCreate(2, levels, &trace));
  for (PetscInt k = 0; k <= levels; k++) {
    ok(TraceGetLevel(trace, k, &level));
    level[0] = values[k];
    level[1] = values[k] + 10;
  }
  return trace;
}

static void begins_with_zeros(void **state)
{
  Trace        trace;
  PetscScalar *level;
  PetscInt     size, levels;

  (void)state;
  ok(TraceCreate(3, 4, &trace));
  ok(TraceGetSizes(trace, &size, &levels));
  assert_int_equal(size, 3);
  assert_int_equal(levels, 4);
  for (PetscInt k = 0; k <= 4; k++) {
    ok(TraceGetLevel(trace, k, &level));
    for (PetscInt i = 0; i < 3; i++) assert_true(level[i] == 0);
  }
  ok(TraceDestroy(&trace));
  assert_null(trace);
  ok(TraceDestroy(&trace)); /* nothing to destroy is no error */
}

/* A rank without contact rows has traces as well */
static void may_be_empty(void **state)
{
  Trace       trace, other;
  PetscScalar none = 5;

  (void)state;
  ok(TraceCreate(0, 3, &trace));
  ok(TraceCreate(0, 2, &other));
  ok(TraceInterpolate(trace, 0.5, 0, 0, &none));
  ok(TraceResample(trace, 0, 0, 2, other, 0));
  assert_true(none == 5);
  ok(TraceDestroy(&trace));
  ok(TraceDestroy(&other));
}

/* Values that no arithmetic on them gives back by chance: the levels must come out as they went in, for every number of
   levels, although k / n * n is not always k */
static void is_exact_at_levels(void **state)
{
  (void)state;
  for (PetscInt levels = 1; levels <= 60; levels++) {
    PetscReal   values[61];
    PetscScalar got[2];
    Trace       trace;

    for (PetscInt k = 0; k <= levels; k++) values[k] = PetscSinReal(1e3 * k + levels) * PetscPowReal(10, k % 7 - 3);
    trace = make_trace(levels, values);
    for (PetscInt k = 0; k <= levels; k++) {
      const PetscReal time = (PetscReal)k / levels;

      ok(TraceInterpolate(trace, time, 0, 2, got));
      if (time * levels == k) {
        assert_true(got[0] == values[k]);
        assert_true(got[1] == values[k] + 10);
      } else near(got[0], values[k], 1e-12 * 1e3); /* one unit in the last place of the time, times the slope */
    }
    ok(TraceDestroy(&trace));
  }
}

/* 3, 5, 4 at times 0, 1/2, 1 */
static void is_linear_between_levels(void **state)
{
  const PetscReal values[] = {3, 5, 4};
  PetscScalar     got[2]   = {-1, -1};
  Trace           trace    = make_trace(2, values);

  (void)state;
  ok(TraceInterpolate(trace, 0.125, 0, 2, got));
  assert_true(got[0] == 3.5 && got[1] == 13.5); /* a quarter of the way from 3 to 5: exact in binary */
  ok(TraceInterpolate(trace, 0.75, 0, 2, got));
  assert_true(got[0] == 4.5 && got[1] == 14.5);
  ok(TraceInterpolate(trace, 0.1, 0, 2, got));
  near(got[0], 3.4, 4e-15); /* 0.1 is not a binary number: a few units in the last place */
  got[0] = -1;
  ok(TraceInterpolate(trace, 0.5, 1, 1, got + 1)); /* the second row only */
  assert_true(got[0] == -1 && got[1] == 15);
  ok(TraceDestroy(&trace));
}

/* 0, 4, 2 at times 0, 1/2, 1 on four intervals: 0, 2, 4, 3, 2 */
static void refines(void **state)
{
  const PetscReal values[] = {0, 4, 2}, expected[] = {0, 2, 4, 3, 2};
  Trace           coarse = make_trace(2, values), fine;
  PetscScalar    *level;

  (void)state;
  ok(TraceCreate(2, 4, &fine));
  ok(TraceResample(coarse, 0, 2, -2, fine, 0));
  for (PetscInt k = 0; k <= 4; k++) {
    ok(TraceGetLevel(fine, k, &level));
    assert_true(level[0] == -2 * expected[k] && level[1] == -2 * (expected[k] + 10));
  }
  ok(TraceDestroy(&coarse));
  ok(TraceDestroy(&fine));
}

/* The levels of a coarser trace are samples of the finer one, not means: 0, 9, 4, 9, 8 on two intervals: 0, 4, 8 */
static void coarsens(void **state)
{
  const PetscReal values[] = {0, 9, 4, 9, 8}, expected[] = {0, 4, 8};
  Trace           fine = make_trace(4, values), coarse;
  PetscScalar    *level;

  (void)state;
  ok(TraceCreate(2, 2, &coarse));
  ok(TraceGetLevel(coarse, 1, &level));
  level[1] = 77;
  ok(TraceResample(fine, 0, 1, 1, coarse, 0)); /* the first row only */
  for (PetscInt k = 0; k <= 2; k++) {
    ok(TraceGetLevel(coarse, k, &level));
    assert_true(level[0] == expected[k]);
    assert_true(level[1] == (k == 1 ? 77 : 0));
  }
  ok(TraceDestroy(&coarse));
  ok(TraceDestroy(&fine));
}

/* A value holds over the interval that it ends: 0, 3, 5 on five intervals is 0, 3, 3, 5, 5, 5, since the third one ends after the
   middle */
static void holds_values(void **state)
{
  const PetscReal values[] = {0, 3, 5}, expected[] = {0, 3, 3, 5, 5, 5};
  Trace           coarse = make_trace(2, values), fine, back;
  PetscScalar    *level;

  (void)state;
  ok(TraceCreate(2, 5, &fine));
  ok(TraceCreate(2, 2, &back));
  ok(TraceResampleConstant(coarse, 0, 1, -2, fine, 0));
  for (PetscInt k = 0; k <= 5; k++) {
    ok(TraceGetLevel(fine, k, &level));
    assert_true(level[0] == -2 * expected[k]);
    assert_true(level[1] == 0); /* the first row only */
  }
  ok(TraceResampleConstant(coarse, 0, 2, 1, back, 0));
  for (PetscInt k = 0; k <= 2; k++) {
    ok(TraceGetLevel(back, k, &level));
    assert_true(level[0] == values[k]);
  }
  ok(TraceDestroy(&coarse));
  ok(TraceDestroy(&fine));
  ok(TraceDestroy(&back));
}

static void refuses_what_makes_no_sense(void **state)
{
  const PetscReal values[] = {0, 1};
  PetscScalar     none;
  Trace           trace, other;

  (void)state;
  refused(PETSC_ERR_ARG_OUTOFRANGE, "at least one interval|0", TraceCreate(2, 0, &trace));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "at least one interval|-3", TraceCreate(2, -3, &trace));
  trace = make_trace(1, values);
  ok(TraceCreate(3, 1, &other));
  refused(PETSC_ERR_ARG_SIZ, "3 rows from number 0 on of a trace with 2 rows", TraceResample(trace, 0, 3, 1, other, 0));
  refused(PETSC_ERR_ARG_SIZ, "2 rows from number 2 on of a trace with 3 rows", TraceResampleConstant(trace, 0, 2, 1, other, 2));
  refused(PETSC_ERR_ARG_SIZ, "1 rows from number -1 on of a trace with 2 rows", TraceInterpolate(trace, 0, -1, 1, &none));
  ok(TraceDestroy(&trace));
  ok(TraceDestroy(&other));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(begins_with_zeros),
      cmocka_unit_test(may_be_empty),
      cmocka_unit_test(is_exact_at_levels),
      cmocka_unit_test(is_linear_between_levels),
      cmocka_unit_test(refines),
      cmocka_unit_test(coarsens),
      cmocka_unit_test(holds_values),
      cmocka_unit_test(refuses_what_makes_no_sense),
  };

  return impakt_main(argc, argv, tests);
}
