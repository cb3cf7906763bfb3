/* ranks: 1 */
/* LU factors of dense matrices that become larger and smaller. */
#include "support.h"
#include <solver/densefactor.h>

#define MOST 30

/* No entry is small, and the largest of a column is not on the diagonal, so that rows change places */
static PetscScalar entry(PetscInt n, PetscInt i, PetscInt j)
{
  return PetscCosReal(1 + 2.3 * i * j + 0.7 * i) + (i == (j + 1) % n ? n : 0);
}

static void solve(DenseFactor *factor, PetscInt n)
{
  PetscScalar solution[MOST], x[MOST];
  PetscBool   singular;

  ok(DenseFactorResize(factor, n, MOST));
  assert_int_equal(factor->n, n);
  between(factor->room, n, MOST);
  for (PetscInt j = 0; j < n; j++) solution[j] = 1 - 0.3 * j;
  for (PetscInt i = 0; i < n; i++) {
    x[i] = 0;
    for (PetscInt j = 0; j < n; j++) {
      factor->values[j * n + i] = entry(n, i, j);
      x[i] += entry(n, i, j) * solution[j];
    }
  }
  ok(DenseFactorCompute(factor, &singular));
  assert_false(singular);
  ok(DenseFactorSolve(factor, x));
  for (PetscInt j = 0; j < n; j++) near(x[j], solution[j], 1e-13); /* round-off of numbers up to 8 */
}

static void solves_whatever_its_order(void **state)
{
  static const PetscInt orders[] = {1, 3, 2, 7, 0, MOST, 5};
  DenseFactor           factor   = {0};

  (void)state;
  for (size_t k = 0; k < sizeof(orders) / sizeof(orders[0]); k++) solve(&factor, orders[k]);
  assert_int_equal(factor.room, MOST);
  ok(DenseFactorDestroy(&factor));
  assert_int_equal(factor.room, 0);
  solve(&factor, 4);
  ok(DenseFactorDestroy(&factor));
}

/* Of one row, which is no matter for LAPACK, and of three, whose last column is the sum of the others */
static void tells_a_singular_matrix(void **state)
{
  static const PetscInt orders[] = {1, 3};
  DenseFactor           factor   = {0};

  (void)state;
  for (size_t k = 0; k < 2; k++) {
    const PetscInt n    = orders[k];
    PetscScalar    x[3] = {1, 2, 3};
    PetscBool      singular;

    ok(DenseFactorResize(&factor, n, MOST));
    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) factor.values[j * n + i] = n == 1 ? 0 : j < 2 ? 1 + i * j : 2 + i;
    ok(DenseFactorCompute(&factor, &singular));
    assert_true(singular);
    refused(PETSC_ERR_ARG_WRONGSTATE, "DenseFactorCompute()", DenseFactorSolve(&factor, x));
  }
  solve(&factor, 3);
  ok(DenseFactorDestroy(&factor));
}

/* Two rows of the same node and direction, whose entries differ by round-off in one place, in whatever unit */
static void tells_a_matrix_that_is_singular_but_for_round_off(void **state)
{
  static const PetscReal units[] = {1e-30, 1, 1e30};
  DenseFactor            factor  = {0};

  (void)state;
  for (size_t k = 0; k < 3; k++) {
    PetscBool singular;

    for (PetscInt apart = 0; apart < 2; apart++) {
      ok(DenseFactorResize(&factor, 2, MOST));
      for (PetscInt e = 0; e < 4; e++) factor.values[e] = 0.1 * units[k];
      factor.values[3] *= 1 + (apart ? 1e-12 : PETSC_MACHINE_EPSILON);
      ok(DenseFactorCompute(&factor, &singular));
      assert_int_equal(singular, !apart);
    }
  }
  ok(DenseFactorDestroy(&factor));
}

/* Blocks of 3, 0, 1 and 5 rows are solved for as matrices by themselves, and what lies outside does not count; one singular block is told
 */
static void diagonal_blocks_are_factored_by_themselves(void **state)
{
  static const PetscInt orders[] = {3, 0, 1, 5};
  DenseFactor           factor   = {0};
  PetscBool             singular;

  (void)state;
  for (PetscInt bad = 0; bad < 2; bad++) {
    PetscScalar solution[9], x[9];
    PetscInt    begin = 0;

    ok(DenseFactorResizeBlocks(&factor, 4, orders, MOST));
    assert_int_equal(factor.n, 9);
    for (PetscInt j = 0; j < 9; j++) solution[j] = 1 - 0.3 * j;
    for (PetscInt k = 0; k < 4; begin += orders[k++]) {
      PetscInt     order;
      PetscScalar *block = DenseFactorGetBlock(&factor, k, &order);

      assert_int_equal(order, orders[k]);
      for (PetscInt i = 0; i < orders[k]; i++) {
        x[begin + i] = 0;
        for (PetscInt j = 0; j < orders[k]; j++) {
          const PetscScalar value = bad && k == 3 ? 1 : entry(orders[k], i, j);

          block[j * order + i] = value;
          x[begin + i] += value * solution[begin + j];
        }
      }
    }
    ok(DenseFactorCompute(&factor, &singular));
    assert_int_equal(singular, bad);
    if (bad) continue;
    ok(DenseFactorSolve(&factor, x));
    for (PetscInt j = 0; j < 9; j++) near(x[j], solution[j], 1e-13); /* round-off of numbers up to 6 */
  }
  solve(&factor, 4);
  ok(DenseFactorDestroy(&factor));
}

static void a_part_of_a_larger_matrix_is_multiplied_with(void **state)
{
  const PetscScalar A[] = {1, 2, 100, 3, 4, 100}, x[] = {10, -1};
  PetscScalar       y[] = {7, 8};

  (void)state;
  ok(DenseMultiplyAdd(2, 3, A, -2, x, y));
  near(y[0], 7 - 2 * (10 - 3), 0);
  near(y[1], 8 - 2 * (20 - 4), 0);
  ok(DenseMultiplyAdd(0, 0, NULL, 1, NULL, NULL));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solves_whatever_its_order),
      cmocka_unit_test(tells_a_singular_matrix),
      cmocka_unit_test(tells_a_matrix_that_is_singular_but_for_round_off),
      cmocka_unit_test(diagonal_blocks_are_factored_by_themselves),
      cmocka_unit_test(a_part_of_a_larger_matrix_is_multiplied_with),
  };

  return impakt_main(argc, argv, tests);
}
