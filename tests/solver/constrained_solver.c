/* ranks: 1 3 */
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
  ok(ConstrainedSolverCreate(A, B, 1, "test_", PETSC_FALSE, &s->solver));
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
      cmocka_unit_test(refuses_rows_that_are_not_independent),
  };

  return impakt_main(argc, argv, tests);
}
