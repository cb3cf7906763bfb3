/* ranks: 1 */
/* Factors of sparse matrices: the solution of a known one, units, and what has none. */
#include "support.h"
#include <solver/sparsefactor.h>

#define SIDE  12
#define ORDER (SIDE * SIDE)

/* Springs between neighbours of a square grid, and one from each node to the ground, scaled */
static Mat create(PetscReal scale, PetscReal ground)
{
  Mat A;

  ok(MatCreateSeqAIJ(PETSC_COMM_SELF, ORDER, ORDER, 5, NULL, &A));
  for (PetscInt i = 0; i < ORDER; i++) {
    ok(MatSetValue(A, i, i, scale * ground, ADD_VALUES));
    for (PetscInt direction = 0; direction < 2; direction++) {
      const PetscInt j = direction ? i + SIDE : i % SIDE == SIDE - 1 ? ORDER : i + 1;

      if (j >= ORDER) continue;
      ok(MatSetValue(A, i, i, scale, ADD_VALUES));
      ok(MatSetValue(A, j, j, scale, ADD_VALUES));
      ok(MatSetValue(A, i, j, -scale, ADD_VALUES));
      ok(MatSetValue(A, j, i, -scale, ADD_VALUES));
    }
  }
  ok(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  return A;
}

static void solves_in_any_unit(void **state)
{
  static const PetscReal scales[] = {1, 1e-15, 1e12};
  SparseFactor           factor   = {0};

  (void)state;
  for (size_t k = 0; k < 3; k++) {
    Mat         A = create(scales[k], 0.5);
    PetscScalar solution[ORDER], x[ORDER];
    PetscBool   singular;
    Vec         s, b;

    for (PetscInt i = 0; i < ORDER; i++) solution[i] = 1 + PetscSinReal(2.0 * i);
    ok(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, ORDER, solution, &s));
    ok(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, ORDER, x, &b));
    ok(MatMult(A, s, b));
    ok(SparseFactorCompute(&factor, A, &singular));
    assert_false(singular);
    ok(SparseFactorSolve(&factor, x));
    for (PetscInt i = 0; i < ORDER; i++) near(x[i], solution[i], 1e-13); /* a condition number of 17 */
    ok(VecDestroy(&s));
    ok(VecDestroy(&b));
    ok(MatDestroy(&A));
  }
  ok(SparseFactorDestroy(&factor));
}

/* Springs that hang on nothing; a diagonal that is not positive. What is solved for next is not spoilt. */
static void tells_a_singular_matrix(void **state)
{
  SparseFactor factor = {0};

  (void)state;
  for (PetscInt bad = 2; bad >= 0; bad--) {
    Mat         A = create(1, bad == 1 ? 0 : 1);
    PetscScalar x[ORDER];
    PetscBool   singular;

    if (bad == 2) {
      ok(MatSetValue(A, 7, 7, -9, INSERT_VALUES));
      ok(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
      ok(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
    }
    for (PetscInt i = 0; i < ORDER; i++) x[i] = 1;
    ok(SparseFactorCompute(&factor, A, &singular));
    assert_int_equal(singular, bad > 0);
    if (bad) refused(PETSC_ERR_ARG_WRONGSTATE, "SparseFactorCompute()", SparseFactorSolve(&factor, x));
    else ok(SparseFactorSolve(&factor, x));
    for (PetscInt i = 0; i < ORDER && !bad; i++) near(x[i], 1, 1e-13); /* all move alike: the springs to the ground alone */
    ok(MatDestroy(&A));
  }
  ok(SparseFactorDestroy(&factor));
}

/* Never fewer than there are entries, and more than in proportion to the order */
static void operations_are_counted(void **state)
{
  (void)state;
  near(SparseFactorFlops(0, 0), 0, 0);
  near(SparseFactorFlops(1, 1), 1, 0);
  assert_true(SparseFactorFlops(2000, 24000) > 2 * SparseFactorFlops(1000, 12000));
  assert_true(SparseFactorFlops(2000, 24000) < 1e8);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solves_in_any_unit),
      cmocka_unit_test(tells_a_singular_matrix),
      cmocka_unit_test(operations_are_counted),
  };

  return impakt_main(argc, argv, tests);
}
