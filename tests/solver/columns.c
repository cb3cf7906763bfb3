/* Rows that become known many at a time: their compliance B A^{-1} B^T in closed form, for factors that solve for blocks and those that do
 * not. */
#include "support.h"
#include <solver/constrainedsolver.h>

#define SIZE 400 /* unknowns */
#define ROWS 300 /* more than are solved for together */

/* Of the tridiagonal matrix -1, 2, -1 */
static PetscReal inverse(PetscInt i, PetscInt j)
{
  return (PetscReal)(PetscMin(i, j) + 1) * (SIZE - PetscMax(i, j)) / (SIZE + 1);
}

/* Each row takes a part of another unknown, which may be on another rank */
static PetscInt first(PetscInt row)
{
  return row;
}

static PetscInt second(PetscInt row)
{
  return (row + SIZE / 2) % SIZE;
}

static PetscReal exact(PetscInt k, PetscInt l)
{
  return inverse(first(k), first(l)) - 0.5 * (inverse(first(k), second(l)) + inverse(second(k), first(l))) +
         0.25 * inverse(second(k), second(l));
}

typedef struct {
  ConstrainedSolver solver;
  Compliance        compliance;
  PetscOptions      options;
} System;

/* at_home: the last rank has all unknowns, and all ranks have rows */
static void create(System *s, PetscBool at_home, const char options[])
{
  PetscInt    begin, end, local, row;
  PetscMPIInt rank, size;
  Mat         A, B;

  ok(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  ok(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  s->options = options_begin("%s", options);
  local      = at_home ? (rank == size - 1 ? SIZE : 0) : PETSC_DECIDE;
  ok(MatCreateAIJ(PETSC_COMM_WORLD, local, local, SIZE, SIZE, 3, NULL, 2, NULL, &A));
  ok(MatGetOwnershipRange(A, &begin, &end));
  for (PetscInt i = begin; i < end; i++)
    for (PetscInt j = PetscMax(0, i - 1); j <= PetscMin(SIZE - 1, i + 1); j++) ok(MatSetValue(A, i, j, i == j ? 2 : -1, INSERT_VALUES));
  ok(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  ok(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, end - begin, ROWS, SIZE, 2, NULL, 2, NULL, &B));
  ok(MatGetOwnershipRange(B, &row, &end));
  ok(MatGetLocalSize(B, &local, NULL));
  ok(ComplianceCreate(PETSC_COMM_WORLD, local, row, ROWS, 1, &s->compliance));
  for (PetscInt r = row; r < end; r++) {
    ok(MatSetValue(B, r, first(r), 1, INSERT_VALUES));
    ok(MatSetValue(B, r, second(r), -0.5, INSERT_VALUES));
  }
  ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  ok(ConstrainedSolverCreate(A, B, 1, "columns_", s->compliance, &s->solver));
  ok(MatDestroy(&A));
  ok(MatDestroy(&B));
}

static void destroy(System *s)
{
  ok(ConstrainedSolverDestroy(&s->solver));
  ok(ComplianceDestroy(&s->compliance));
  options_drop(s->options);
}

/* All rows that are known, and how many they are */
static void check(System *s, PetscInt known)
{
  const PetscScalar *W;
  const PetscInt    *rows;
  PetscInt           n, leading;

  ComplianceGetRows(s->compliance, &n, &rows, NULL);
  assert_int_equal(n, known);
  ComplianceGetMatrix(s->compliance, 0, &leading, &W);
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) /* numbers up to 100, and the matrix loses five digits */
      near(W[j * leading + i], exact(rows[i], rows[j]), 1e-9);
}

/* Odd rows first, the last one first; then the even ones, one of them by itself */
static void know_all(System *s)
{
  PetscInt rows[ROWS], n = 0;

  for (PetscInt r = ROWS - 1; r > 0; r -= 2) rows[n++] = r;
  ok(ConstrainedSolverExtend(s->solver, n, rows));
  check(s, ROWS / 2);
  rows[0] = 0;
  ok(ConstrainedSolverExtend(s->solver, 1, rows));
  check(s, ROWS / 2 + 1);
  n = 0;
  for (PetscInt r = 2; r < ROWS; r += 2) rows[n++] = r;
  ok(ConstrainedSolverExtend(s->solver, n, rows));
  check(s, ROWS);
}

static void blocks_and_single_columns_are_exact(void **state)
{
  static const char *const factors[] = {
      "-columns_pc_type cholesky -columns_pc_factor_mat_solver_type mumps",
      "-columns_pc_type redundant -columns_redundant_pc_type lu",
      "-columns_ksp_type cg -columns_pc_type jacobi -columns_ksp_rtol 1e-13",
  };

  (void)state;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(factors); k++) {
    System s;

    create(&s, PETSC_FALSE, factors[k]);
    know_all(&s);
    destroy(&s);
  }
}

/* More rows at once than one block has */
static void more_rows_than_a_block_are_exact(void **state)
{
  System   s;
  PetscInt rows[ROWS];

  (void)state;
  create(&s, PETSC_FALSE, "-columns_pc_type cholesky -columns_pc_factor_mat_solver_type mumps");
  for (PetscInt r = 0; r < ROWS; r++) rows[r] = r;
  ok(ConstrainedSolverExtend(s.solver, ROWS, rows));
  check(&s, ROWS);
  destroy(&s);
}

/* Where one of several ranks has the matrix its factors are there, and blocks are solved for without the others */
static void blocks_of_one_rank_are_exact(void **state)
{
  static const char *const factors[] = {"-columns_sub_pc_type cholesky -columns_sub_pc_factor_mat_solver_type mumps", ""};

  (void)state;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(factors); k++) {
    PetscMPIInt    size;
    PetscLogDouble one, many;
    System         s;

    ok(MPI_Comm_size(PETSC_COMM_WORLD, &size));
    create(&s, PETSC_TRUE, factors[k]);
    one  = ConstrainedSolverGetFlops(s.solver);
    many = ConstrainedSolverGetExtendFlops(s.solver, ROWS);
    assert_true(one < 100 * SIZE); /* that of a matrix of three diagonals, and not a guess */
    if (k == 0 && size > 1) assert_true(many < ROWS * one / 4);
    else near(many, ROWS * one, 0);
    know_all(&s);
    destroy(&s);
  }
}

/* What decides whether dense matrices are worth their columns */
static void columns_of_a_block_count_less(void **state)
{
  PetscLogDouble one, many;
  System         s;

  (void)state;
  create(&s, PETSC_FALSE, "-columns_pc_type cholesky -columns_pc_factor_mat_solver_type mumps");
  one  = ConstrainedSolverGetExtendFlops(s.solver, 1);
  many = ConstrainedSolverGetExtendFlops(s.solver, ROWS);
  near(one, ConstrainedSolverGetFlops(s.solver), 0);
  assert_true(many < ROWS * one / 4);
  destroy(&s);
  create(&s, PETSC_FALSE, "-columns_pc_type redundant -columns_redundant_pc_type lu");
  many = ConstrainedSolverGetExtendFlops(s.solver, ROWS);
  near(many, ROWS * ConstrainedSolverGetFlops(s.solver), 0);
  destroy(&s);
}

/* A full matrix has so many entries in its factors that columns are kept: their sum is what a solution gives */
static void kept_columns_give_what_a_solution_gives(void **state)
{
  static const char *const factors[] = {"-columns_pc_type cholesky -columns_pc_factor_mat_solver_type mumps",
                                        "-columns_pc_type redundant -columns_redundant_pc_type lu"};
  const PetscInt           kept      = 40;

  (void)state;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(factors); k++) {
    PetscOptions      options = options_begin("%s", factors[k]);
    PetscInt          begin, end, row, local, rows[40];
    Mat               A, B;
    Vec               x, y, force, rhs;
    PetscScalar      *values;
    PetscReal         target[40] = {0}, difference, size;
    PetscBool         none[40]   = {PETSC_FALSE};
    Compliance        compliance;
    ConstrainedSolver solver;

    ok(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, SIZE, SIZE, SIZE, NULL, SIZE, NULL, &A));
    ok(MatGetOwnershipRange(A, &begin, &end));
    for (PetscInt i = begin; i < end; i++)
      for (PetscInt j = 0; j < SIZE; j++) ok(MatSetValue(A, i, j, PetscExpReal(-PetscAbsReal((PetscReal)(i - j)) / 50), INSERT_VALUES));
    ok(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
    ok(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, end - begin, kept, SIZE, 2, NULL, 2, NULL, &B));
    ok(MatGetOwnershipRange(B, &row, &end));
    for (PetscInt r = row; r < end; r++) {
      ok(MatSetValue(B, r, first(r), 1, INSERT_VALUES));
      ok(MatSetValue(B, r, second(r), -0.5, INSERT_VALUES));
    }
    ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
    ok(MatGetLocalSize(B, &local, NULL));
    ok(ComplianceCreate(PETSC_COMM_WORLD, local, row, kept, 1, &compliance));
    ok(ConstrainedSolverCreate(A, B, 1, "columns_", compliance, &solver));
    ok(ConstrainedSolverSetConstraints(solver, none, NULL));
    ok(MatCreateVecs(A, &x, &rhs));
    ok(VecDuplicate(x, &y));
    ok(MatCreateVecs(B, NULL, &force));
    ok(VecGetArrayWrite(force, &values));
    for (PetscInt i = 0; i < local; i++) values[i] = PetscSinReal(1 + row + i);
    ok(VecRestoreArrayWrite(force, &values));
    for (PetscInt r = 0; r < kept; r++) rows[r] = r;
    ok(MatMultTranspose(B, force, rhs));
    ok(ConstrainedSolverSolveFree(solver, rhs, y));
    for (PetscInt pass = 0; pass < 2; pass++) { /* without columns, then with all of them */
      ok(VecGetArray(force, &values));
      ok(ConstrainedSolverBring(solver, values, target));
      ok(ConstrainedSolverCorrect(solver, target, x));
      ok(VecRestoreArray(force, &values));
      ok(VecAXPY(x, -1, y));
      ok(VecNorm(x, NORM_INFINITY, &difference));
      ok(VecNorm(y, NORM_INFINITY, &size));
      assert_true(size > 1);
      near(difference / size, 0, pass ? 1e-12 : 0); /* the sum rounds otherwise; a solution is the same one */
      if (!pass) ok(ConstrainedSolverExtend(solver, kept, rows));
      else assert_true(difference > 0); /* else it was no sum of columns */
    }
    ok(VecDestroy(&force));
    ok(VecDestroy(&y));
    ok(VecDestroy(&x));
    ok(VecDestroy(&rhs));
    ok(MatDestroy(&A));
    ok(MatDestroy(&B));
    ok(ConstrainedSolverDestroy(&solver));
    ok(ComplianceDestroy(&compliance));
    options_drop(options);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blocks_and_single_columns_are_exact),     cmocka_unit_test(blocks_of_one_rank_are_exact),
      cmocka_unit_test(more_rows_than_a_block_are_exact),        cmocka_unit_test(columns_of_a_block_count_less),
      cmocka_unit_test(kept_columns_give_what_a_solution_gives),
  };

  return impakt_main(argc, argv, tests);
}
