/* A x = b with some rows of B x held at zero, against a dense solution of [A B^T; B 0]. */
#include "support.h"
#include <solver/constrainedsolver.h>

#define SIZE 12
#define ROWS 4

/* A is tridiagonal and, being diagonally dominant, positive definite */
static PetscReal a_entry(PetscInt i, PetscInt j)
{
  if (i == j) return 4 + 0.1 * i;
  return i == j + 1 || j == i + 1 ? -1 : 0;
}

/* One node, two nodes at an angle, one node again, and a copy of the first row */
static PetscReal b_entry(PetscInt row, PetscInt j)
{
  const PetscReal half = PetscSqrtReal(0.5);

  if (row == 1) return j == 3 || j == 7 ? half : 0;
  return j == (row == 2 ? 10 : 0);
}

static PetscReal rhs_entry(PetscInt i, PetscInt seed)
{
  return PetscSinReal(1 + 3 * i + 7 * seed);
}

/* Gauss elimination with row pivots, in place */
static void solve_dense(PetscInt n, PetscReal A[], PetscReal b[])
{
  for (PetscInt k = 0; k < n; k++) {
    PetscInt best = k;

    for (PetscInt i = k + 1; i < n; i++)
      if (PetscAbsReal(A[i * n + k]) > PetscAbsReal(A[best * n + k])) best = i;
    for (PetscInt j = 0; j < n; j++) {
      const PetscReal swap = A[k * n + j];

      A[k * n + j]    = A[best * n + j];
      A[best * n + j] = swap;
    }
    {
      const PetscReal swap = b[k];

      b[k]    = b[best];
      b[best] = swap;
    }
    for (PetscInt i = 0; i < n; i++) {
      const PetscReal factor = i == k ? 0 : A[i * n + k] / A[k * n + k];

      for (PetscInt j = 0; j < n; j++) A[i * n + j] -= factor * A[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  for (PetscInt k = 0; k < n; k++) b[k] /= A[k * n + k];
}

/* [A B^T; B -F] for rows with flexibilities F, 0 where they are held */
static void solve_reference(const PetscBool held[ROWS], const PetscReal flexibility[ROWS], PetscInt seed, PetscReal x[])
{
  PetscReal A[(SIZE + ROWS) * (SIZE + ROWS)] = {0};
  PetscInt  n                                = SIZE, which[ROWS];

  for (PetscInt r = 0; r < ROWS; r++)
    if (held[r]) which[n++ - SIZE] = r;
  for (PetscInt i = 0; i < SIZE; i++) {
    for (PetscInt j = 0; j < SIZE; j++) A[i * n + j] = a_entry(i, j);
    for (PetscInt r = SIZE; r < n; r++) A[i * n + r] = A[r * n + i] = b_entry(which[r - SIZE], i);
    x[i] = rhs_entry(i, seed);
  }
  for (PetscInt r = SIZE; r < n; r++) {
    A[r * n + r] = -flexibility[which[r - SIZE]];
    x[r]         = 0;
  }
  solve_dense(n, A, x);
}

typedef struct {
  ConstrainedSolver solver;
  Vec               x, b;
  PetscInt          begin, end; /* rows of B of this rank */
} System;

/* All rows of B on one rank, or (owner < 0) as PETSc deals them out */
static void create_system(System *s, PetscMPIInt owner)
{
  PetscMPIInt rank;
  PetscInt    begin, end;
  Mat         A, B;

  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  ok(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, SIZE, SIZE, 3, NULL, 2, NULL, &A));
  ok(MatGetOwnershipRange(A, &begin, &end));
  for (PetscInt i = begin; i < end; i++)
    for (PetscInt j = PetscMax(0, i - 1); j <= PetscMin(SIZE - 1, i + 1); j++) ok(MatSetValue(A, i, j, a_entry(i, j), INSERT_VALUES));
  ok(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  ok(MatCreateAIJ(PETSC_COMM_WORLD, owner < 0 ? PETSC_DECIDE : rank == owner ? ROWS : 0, end - begin, ROWS, SIZE, 2, NULL, 2, NULL, &B));
  ok(MatGetOwnershipRange(B, &s->begin, &s->end));
  for (PetscInt i = s->begin; i < s->end; i++)
    for (PetscInt j = 0; j < SIZE; j++)
      if (b_entry(i, j) != 0) ok(MatSetValue(B, i, j, b_entry(i, j), INSERT_VALUES));
  ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  ok(MatCreateVecs(A, &s->x, &s->b));
  ok(ConstrainedSolverCreate(A, B, 1, "test_", NULL, &s->solver));
  ok(MatDestroy(&A));
  ok(MatDestroy(&B));
}

static void destroy_system(System *s)
{
  ok(ConstrainedSolverDestroy(&s->solver));
  assert_null(s->solver);
  ok(VecDestroy(&s->x));
  ok(VecDestroy(&s->b));
}

static void hold(System *s, const PetscBool held[ROWS])
{
  ok(ConstrainedSolverSetConstraints(s->solver, held + s->begin, NULL));
}

/* Round-off: A has a condition number of 3, numbers are of the order of 1 */
static void check_flexible_solution(System *s, const PetscBool held[ROWS], const PetscReal flexibility[ROWS], PetscInt seed)
{
  PetscReal          reference[SIZE + ROWS];
  const PetscScalar *x;
  PetscInt           begin, end;

  solve_reference(held, flexibility, seed, reference);
  ok(VecGetOwnershipRange(s->b, &begin, &end));
  for (PetscInt i = begin; i < end; i++) ok(VecSetValue(s->b, i, rhs_entry(i, seed), INSERT_VALUES));
  ok(VecAssemblyBegin(s->b));
  ok(VecAssemblyEnd(s->b));
  ok(ConstrainedSolverSolve(s->solver, s->b, s->x));
  ok(VecGetArrayRead(s->x, &x));
  for (PetscInt i = begin; i < end; i++) near(x[i - begin], reference[i], 1e-14);
  ok(VecRestoreArrayRead(s->x, &x));
}

static void check_solution(System *s, const PetscBool held[ROWS], PetscInt seed)
{
  const PetscReal none[ROWS] = {0};

  check_flexible_solution(s, held, none, seed);
}

static const PetscBool sets[][ROWS] = {
    {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE}, {PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE},
    {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_FALSE},    {PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE},
    {PETSC_FALSE, PETSC_FALSE, PETSC_TRUE, PETSC_TRUE},   {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE},
    {PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE},
};

/* One after the other with one and the same factors; wherever the rows of B live: also all of them on one rank of several */
static void solves_with_any_set_of_rows_held(void **state)
{
  PetscMPIInt size;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  for (PetscMPIInt owner = -1; owner < size; owner++) {
    System s;

    create_system(&s, owner);
    check_solution(&s, sets[0], 0); /* before any has been held */
    for (size_t k = 0; k < sizeof(sets) / sizeof(sets[0]); k++) {
      hold(&s, sets[k]);
      check_solution(&s, sets[k], (PetscInt)k);
      check_solution(&s, sets[k], (PetscInt)k + 20); /* another right-hand side */
    }
    destroy_system(&s);
  }
}

/* Rows on springs, alone, beside held ones, and (the first and its copy) two on one node; and back to held ones */
static void solves_with_rows_on_springs(void **state)
{
  const PetscBool all[ROWS]           = {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_TRUE};
  const PetscReal flexibility[][ROWS] = {{0.5, 0, 0, 2}, {0.1, 3, 0, 0.2}, {4, 1, 10, 0.3}};
  PetscMPIInt     size;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  for (PetscMPIInt owner = -1; owner < size; owner++) {
    System s;

    create_system(&s, owner);
    for (PetscInt k = 0; k < 3; k++) {
      ok(ConstrainedSolverSetConstraints(s.solver, all + s.begin, flexibility[k] + s.begin));
      check_flexible_solution(&s, all, flexibility[k], k);
      hold(&s, sets[2]);
      check_solution(&s, sets[2], k);
    }
    destroy_system(&s);
  }
}

/* Constraint forces by conjugate gradients, to 1e-13 of some tenths, held rows and springs alike */
static void conjugate_gradients_give_the_same(void **state)
{
  const PetscReal flexibility[ROWS] = {0.5, 0, 3, 0};
  System          s;

  (void)state;
  create_system(&s, -1);
  ok(ConstrainedSolverSetDenseLimit(s.solver, 0));
  for (size_t k = 0; k < sizeof(sets) / sizeof(sets[0]); k++) {
    PetscBool springs[ROWS];

    hold(&s, sets[k]);
    check_solution(&s, sets[k], (PetscInt)k);
    for (PetscInt r = 0; r < ROWS; r++) springs[r] = sets[k][r];
    ok(ConstrainedSolverSetConstraints(s.solver, springs + s.begin, flexibility + s.begin));
    {
      PetscReal soft[ROWS];

      for (PetscInt r = 0; r < ROWS; r++) soft[r] = springs[r] ? flexibility[r] : 0;
      check_flexible_solution(&s, springs, soft, (PetscInt)k + 20);
    }
  }
  destroy_system(&s);
}

/* Bit for bit, by conjugate gradients as by dense factors: what has been solved in between leaves no trace */
static void repeats_bit_for_bit(void **state)
{
  (void)state;
  for (PetscInt limit = 0; limit <= ROWS; limit += ROWS) {
    System    s;
    Vec       first;
    PetscBool equal;

    create_system(&s, -1);
    ok(ConstrainedSolverSetDenseLimit(s.solver, limit));
    hold(&s, sets[2]);
    check_solution(&s, sets[2], 1);
    ok(VecDuplicate(s.x, &first));
    ok(VecCopy(s.x, first));
    check_solution(&s, sets[2], 2);
    check_solution(&s, sets[2], 1);
    ok(VecEqual(s.x, first, &equal));
    assert_true(equal);
    ok(VecDestroy(&first));
    destroy_system(&s);
  }
}

/* Rows 1 and 2 change places, the others stay: the columns of what stays know what they do to the new rows */
static void rows_may_change(void **state)
{
  const PetscInt place[ROWS] = {0, 2, 1, 3};

  (void)state;
  for (PetscInt limit = 0; limit < 2; limit++)
    for (PetscInt all = 0; all < 2; all++) {
      PetscInt    begin, end;
      PetscMPIInt changed[ROWS] = {all, 1, 1, all};
      System      s;
      Mat         B;

      create_system(&s, -1);
      if (!limit) ok(ConstrainedSolverSetDenseLimit(s.solver, 0));
      hold(&s, sets[2]); /* columns of rows 0, 1, 2 are there */
      check_solution(&s, sets[2], 1);
      ok(VecGetOwnershipRange(s.b, &begin, &end));
      ok(MatCreateAIJ(PETSC_COMM_WORLD, s.end - s.begin, end - begin, ROWS, SIZE, 2, NULL, 2, NULL, &B));
      for (PetscInt i = s.begin; i < s.end; i++)
        for (PetscInt j = 0; j < SIZE; j++)
          if (b_entry(place[i], j) != 0) ok(MatSetValue(B, i, j, b_entry(place[i], j), INSERT_VALUES));
      ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
      ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
      ok(ConstrainedSolverSetRows(s.solver, B, changed));
      ok(MatDestroy(&B));
      for (size_t k = 0; k < sizeof(sets) / sizeof(sets[0]); k++) {
        PetscBool moved[ROWS];

        for (PetscInt r = 0; r < ROWS; r++) moved[r] = sets[k][place[r]];
        hold(&s, moved);
        check_solution(&s, sets[k], (PetscInt)k);
      }
      destroy_system(&s);
    }
}

/* The matrix is factored once, whatever is held */
static void never_factors_again(void **state)
{
  PetscObjectState before, after;
  System           s;
  KSP              ksp;
  PC               pc;
  Mat              factors;
  PetscMPIInt      size;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  if (size > 1) skip(); /* the factors are inside a PCREDUNDANT there */
  create_system(&s, -1);
  ok(ConstrainedSolverGetKSP(s.solver, &ksp));
  ok(KSPGetPC(ksp, &pc));
  ok(PCFactorGetMatrix(pc, &factors));
  ok(PetscObjectStateGet((PetscObject)factors, &before));
  for (size_t k = 0; k < sizeof(sets) / sizeof(sets[0]); k++) {
    hold(&s, sets[k]);
    check_solution(&s, sets[k], 1);
  }
  ok(PetscObjectStateGet((PetscObject)factors, &after));
  assert_true(before == after);
  destroy_system(&s);
}

/* The last row is a copy of the first: held together they determine no force. The solver can be used on afterwards. */
static void refuses_rows_that_are_not_independent(void **state)
{
  const PetscBool both[ROWS] = {PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, PETSC_TRUE};
  System          s;

  (void)state;
  create_system(&s, -1);
  refused(PETSC_ERR_MAT_LU_ZRPVT, "not independent|two contact pairs", ConstrainedSolverSetConstraints(s.solver, both + s.begin, NULL));
  hold(&s, sets[2]);
  check_solution(&s, sets[2], 3);
  destroy_system(&s);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solves_with_any_set_of_rows_held),
      cmocka_unit_test(solves_with_rows_on_springs),
      cmocka_unit_test(conjugate_gradients_give_the_same),
      cmocka_unit_test(repeats_bit_for_bit),
      cmocka_unit_test(rows_may_change),
      cmocka_unit_test(never_factors_again),
      cmocka_unit_test(refuses_rows_that_are_not_independent),
  };

  return impakt_main(argc, argv, tests);
}
