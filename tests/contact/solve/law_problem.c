/* The equations of the laws of rows: solutions against enumeration of all states, with friction, ties, singular S; where Newton's method
   goes round in a circle; and problems that have no solution. */
#include "support.h"
#include <contact/solve/lawimpl.h>
#include <math.h>
#include <petscblaslapack.h>

#define ROWS  12   /* at most */
#define MANY  520  /* so many that factors of dense Jacobians are kept */
#define CLOSE 1e-9 /* solutions have round-off of 1e-13 times the condition of S, which is at most 1e3 here: measured 2e-12 */

/* S by columns */
static PetscScalar *entries(const LawProblem *problem)
{
  PetscScalar *S, *same;

  ok(MatDenseGetArray(problem->S, &S));
  same = S;
  ok(MatDenseRestoreArray(problem->S, &S));
  return same;
}

/* Room for n rows, with a dense S of zeros */
static void resize(LawProblem *problem, PetscInt n)
{
  Mat S;

  ok(LawProblemResize(problem, n));
  problem->n_nodes = 0; /* solve() takes S again, with the nodes */
  ok(MatCreateSeqDense(PETSC_COMM_SELF, n, n, NULL, &S));
  ok(LawProblemTakeS(problem, &S, NULL));
}

/* With the entries that S has now; whether there is a solution */
static PetscBool solve(LawProblem *problem)
{
  Mat S;

  ok(MatDuplicate(problem->S, MAT_COPY_VALUES, &S));
  ok(LawProblemTakeS(problem, &S, NULL));
  ok(LawProblemSolve(problem));
  return problem->solved;
}

/* Uniform in [-1, 1] */
static PetscReal Random(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return 2 * ((*seed >> 8) / (PetscReal)(1u << 24)) - 1;
}

/* Room for n rows, `rows` of each node, S = B B^T + add I with B of n rows and `places` columns, readings without forces in [-1, 1] */
static void Fill(LawProblem *problem, const RowLaw *law, PetscInt n, PetscInt rows, PetscInt places, PetscReal add, unsigned seed,
                 PetscReal B[])
{
  resize(problem, n);
  problem->n_nodes = n / rows;
  for (PetscInt node = 0; node < problem->n_nodes; node++) problem->law[node] = law;
  for (PetscInt node = 0; node <= problem->n_nodes; node++) problem->begin[node] = node * rows;
  for (PetscInt k = 0; k < n * places; k++) B[k] = Random(&seed);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      entries(problem)[j * n + i] = i == j ? add : 0;
      for (PetscInt k = 0; k < places; k++) entries(problem)[j * n + i] += B[i * places + k] * B[j * places + k];
    }
  for (PetscInt i = 0; i < n; i++) {
    problem->read[i] = Random(&seed);
    problem->base[i] = problem->force[i] = 0;
  }
  for (PetscInt k = 0; k < 2 * problem->n_nodes; k++) problem->limit[k] = 0;
}

/* What row i reads under the forces found */
static PetscReal Reads(const LawProblem *problem, PetscInt i)
{
  PetscReal y = PetscRealPart(problem->read[i]);

  for (PetscInt j = 0; j < problem->n; j++)
    y += PetscRealPart(entries(problem)[j * problem->n + i] * (problem->force[j] - problem->base[j]));
  return y;
}

/* Solves the equations S_AA x_A = -y_A of the rows whose bits are set; the others have no force. False where S_AA is singular */
static PetscBool SolveRows(const LawProblem *problem, PetscInt set, PetscScalar x[])
{
  PetscScalar  matrix[ROWS * ROWS], right[ROWS];
  PetscInt     rows[ROWS], n = 0;
  PetscBLASInt size, one     = 1, info, pivots[ROWS];

  for (PetscInt i = 0; i < problem->n; i++) {
    x[i] = 0;
    if (set >> i & 1) rows[n++] = i;
  }
  for (PetscInt j = 0; j < n; j++) {
    right[j] = -problem->read[rows[j]];
    for (PetscInt i = 0; i < n; i++) matrix[j * n + i] = entries(problem)[rows[j] * problem->n + rows[i]];
  }
  size = (PetscBLASInt)n;
  if (n) LAPACKgesv_(&size, &one, matrix, &size, pivots, right, &size, &info);
  if (n && info) return PETSC_FALSE;
  for (PetscInt j = 0; j < n; j++) x[rows[j]] = right[j];
  return PETSC_TRUE;
}

/* The law at each node by its own words: no tension, no gap under a force, friction within its bound and against the slip */
static void CheckLaw(const LawProblem *problem, PetscReal small, PetscInt seen[3])
{
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt  first = problem->begin[node], end = problem->begin[node + 1];
    const PetscReal normal = PetscRealPart(problem->force[first]), gap = Reads(problem, first);
    const PetscReal bound  = normal > 0 ? problem->limit[2 * node] + problem->limit[2 * node + 1] * normal : 0;
    PetscReal       across = 0, slip = 0, work = 0;

    assert_true(normal >= 0 && gap >= -small && PetscAbsReal(normal * gap) <= small);
    for (PetscInt i = first + 1; i < end; i++) {
      const PetscReal force = PetscRealPart(problem->force[i]), y = Reads(problem, i);

      across += PetscSqr(force);
      slip += PetscSqr(y);
      work += force * y;
    }
    across = PetscSqrtReal(across);
    slip   = PetscSqrtReal(slip);
    assert_true(across <= bound + small);
    if (normal > small && slip > small) near(work, -bound * slip, small);
    seen[normal <= small ? 0 : slip <= small ? 1 : 2]++;
  }
}

static void without_friction_it_is_the_one_solution(void **state)
{
  LawProblem problem   = {0};
  PetscInt   pushed[2] = {0, 0};

  (void)state;
  for (PetscInt n = 1; n <= 6; n++)
    for (unsigned seed = 1; seed <= 100; seed++) {
      PetscReal   B[ROWS * ROWS];
      PetscScalar x[ROWS];
      PetscInt    found = 0;
      PetscBool   solved;

      Fill(&problem, &RowLawUnilateral, n, 1, n, 0.01, seed, B);
      for (PetscInt i = 0; i < n; i++) problem.force[i] = seed % 2; /* from no forces, and from any */
      solved = solve(&problem);
      assert_true(solved);
      for (PetscInt set = 0; set < 1 << n && !found; set++) {
        PetscReal y;

        assert_true(SolveRows(&problem, set, x));
        found = 1;
        for (PetscInt i = 0; i < n; i++) {
          y = PetscRealPart(problem.read[i]);
          for (PetscInt j = 0; j < n; j++) y += PetscRealPart(entries(&problem)[j * n + i] * x[j]);
          if (PetscRealPart(x[i]) < 0 || (!(set >> i & 1) && y < 0)) found = 0;
        }
      }
      assert_true(found);
      for (PetscInt i = 0; i < n; i++) {
        near(PetscRealPart(problem.force[i]), PetscRealPart(x[i]), CLOSE * (1 + PetscAbsScalar(x[i])));
        pushed[PetscRealPart(x[i]) > 0]++;
      }
    }
  assert_true(pushed[0] > 400 && pushed[1] > 400);
  ok(LawProblemDestroy(&problem));
}

/* From forces that are not zero, about which what is read is known */
static void base_is_where_readings_were_taken(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[ROWS * ROWS];

  (void)state;
  for (unsigned seed = 1; seed <= 20; seed++) {
    PetscScalar first[4];
    PetscBool   solved;

    Fill(&problem, &RowLawUnilateral, 4, 1, 4, 0.1, seed, B);
    solved = solve(&problem);
    assert_true(solved);
    for (PetscInt i = 0; i < 4; i++) first[i] = problem.force[i];
    for (PetscInt i = 0; i < 4; i++) {
      problem.base[i] = i - 1.5;
      for (PetscInt k = 0; k < 4; k++) problem.read[k] += entries(&problem)[i * 4 + k] * problem.base[i];
    }
    solved = solve(&problem);
    assert_true(solved);
    for (PetscInt i = 0; i < 4; i++) near(PetscRealPart(problem.force[i]), PetscRealPart(first[i]), CLOSE * (1 + PetscAbsScalar(first[i])));
  }
  ok(LawProblemDestroy(&problem));
}

static void with_friction_the_law_holds(void **state)
{
  const PetscReal limits[][2] = {{0, 0.1}, {0, 0.3}, {0, 0.8}};
  LawProblem      problem     = {0};
  PetscInt        seen[3]     = {0, 0, 0};
  PetscReal       B[ROWS * (ROWS + 4)];

  (void)state;
  for (PetscInt rows = 2; rows <= 3; rows++)
    for (size_t l = 0; l < PETSC_STATIC_ARRAY_LENGTH(limits); l++)
      for (unsigned seed = 1; seed <= 100; seed++) {
        PetscBool solved;

        Fill(&problem, &RowLawUnilateral, ROWS, rows, ROWS + 4, 0.5, seed, B);
        for (PetscInt k = 0; k < 2 * problem.n_nodes; k++) problem.limit[k] = limits[l][k % 2];
        solved = solve(&problem);
        if (!solved) {
          print_error("rows %d l %d seed %d its %d\n", (int)rows, (int)l, (int)seed, (int)problem.iterations);
          continue;
        }
        CheckLaw(&problem, CLOSE, seen);
      }
  for (PetscInt k = 0; k < 3; k++) assert_true(seen[k] > 200);
  ok(LawProblemDestroy(&problem));
}

/* A node on a plane: S is diagonal, so that the normal force is known, and the tangential one by hand */
static void a_node_sticks_and_slips_as_by_hand(void **state)
{
  const PetscReal readings[] = {0.1, 0.3, -0.3, 3}; /* across; 2 N along the normal, bound 0.6 N, 1 m/N across */
  const PetscReal expected[] = {-0.1, -0.3, 0.3, -0.6};
  LawProblem      problem    = {0};
  PetscReal       B[4];
  PetscBool       solved;

  (void)state;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(readings); k++) {
    Fill(&problem, &RowLawUnilateral, 2, 2, 1, 0, 1, B);
    entries(&problem)[0] = entries(&problem)[3] = 1;
    entries(&problem)[1] = entries(&problem)[2] = 0;
    problem.limit[1]                            = 0.3;
    problem.read[0]                             = -2;
    problem.read[1]                             = readings[k];
    solved                                      = solve(&problem);
    assert_true(solved);
    near(PetscRealPart(problem.force[0]), 2, 1e-12);
    near(PetscRealPart(problem.force[1]), expected[k], 1e-12);
  }
  ok(LawProblemDestroy(&problem));
}

static void ties_are_linear_equations(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[ROWS * ROWS];

  (void)state;
  for (PetscInt rows = 1; rows <= 3; rows++)
    for (unsigned seed = 1; seed <= 20; seed++) {
      PetscScalar x[ROWS];
      PetscBool   solved;

      Fill(&problem, &RowLawTie, 6, rows, 6, 0.1, seed, B);
      solved = solve(&problem);
      assert_true(solved && !problem.by_nodes);
      assert_true(SolveRows(&problem, (1 << 6) - 1, x));
      for (PetscInt i = 0; i < 6; i++) near(PetscRealPart(problem.force[i]), PetscRealPart(x[i]), CLOSE * (1 + PetscAbsScalar(x[i])));
      assert_true(problem.iterations <= 4); /* the proximal term: one iteration each, and one to see it vanish; measured 3 */
    }
  ok(LawProblemDestroy(&problem));
}

/* Each node has its own law: the second of three is tied, the others push; where both of these are pulled, the tie alone has forces */
static void nodes_have_laws_of_their_own(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[ROWS * ROWS];

  (void)state;
  for (unsigned seed = 1; seed <= 40; seed++)
    for (PetscInt open = 0; open < 2; open++) {
      PetscBool solved;

      Fill(&problem, &RowLawUnilateral, 3, 1, 3, 0.1, seed, B);
      problem.law[1] = &RowLawTie;
      if (open) problem.read[0] = problem.read[2] = 100;
      solved = solve(&problem);
      assert_true(solved);
      near(Reads(&problem, 1), 0, CLOSE);
      for (PetscInt i = 0; i < 3; i += 2) {
        const PetscReal force = PetscRealPart(problem.force[i]), gap = Reads(&problem, i);

        assert_true(force >= -CLOSE && gap >= -CLOSE && PetscAbsReal(force * gap) <= CLOSE);
        if (open) near(force, 0, CLOSE);
      }
      if (open) near(PetscRealPart(problem.force[1]), -PetscRealPart(problem.read[1] / entries(&problem)[4]), CLOSE);
    }
  ok(LawProblemDestroy(&problem));
}

/* Each row stands twice, as where nodes of both sides say the same: single forces are not unique, what bodies get of them is that of the
   rows that stand once */
static void doubled_rows_give_bodies_the_same(void **state)
{
  const RowLaw *const laws[] = {&RowLawUnilateral, &RowLawTie};
  LawProblem          once = {0}, twice = {0};

  (void)state;
  for (size_t law = 0; law < PETSC_STATIC_ARRAY_LENGTH(laws); law++)
    for (unsigned seed = 1; seed <= 60; seed++) {
      const PetscInt n = 5, places = 7;
      PetscReal      B[ROWS * ROWS], unused[ROWS * ROWS];
      PetscBool      solved;

      Fill(&once, laws[law], n, 1, places, 0, seed, B);
      solved = solve(&once);
      assert_true(solved);
      Fill(&twice, laws[law], 2 * n, 1, 1, 0, seed, unused);
      for (PetscInt i = 0; i < 2 * n; i++) {
        twice.read[i]  = once.read[i % n];
        twice.force[i] = seed % 3 ? Random(&seed) : 0; /* which of the many it finds depends on this */
        for (PetscInt j = 0; j < 2 * n; j++) entries(&twice)[j * 2 * n + i] = entries(&once)[(j % n) * n + i % n];
      }
      solved = solve(&twice);
      assert_true(solved);
      for (PetscInt k = 0; k < places; k++) {
        PetscReal of_once = 0, of_twice = 0, size = 0;

        for (PetscInt i = 0; i < n; i++) {
          of_once += B[i * places + k] * PetscRealPart(once.force[i]);
          of_twice += B[i * places + k] * PetscRealPart(twice.force[i] + twice.force[i + n]);
          size += PetscAbsScalar(once.force[i]);
        }
        near(of_twice, of_once, CLOSE * (1 + size));
      }
      for (PetscInt i = 0; i < 2 * n; i++) near(Reads(&twice, i), Reads(&once, i % n), 1e-11);
    }
  ok(LawProblemDestroy(&once));
  ok(LawProblemDestroy(&twice));
}

/* S of the context */
static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  Mat S;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &S));
  PetscCall(MatMult(S, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F. E. Curtis, Z. Han, D. P. Robinson, Computational Optimization and Applications 60 (2015), example of section 3: from no forces, active
   sets go {1, 2}, {1, 3}, {}, {1, 2}; the solution is {1} */
static void ExampleOfCurtis(PetscBool products)
{
  const PetscScalar S[]    = {4, 5, -5, 5, 9, -5, -5, -5, 7};
  const PetscScalar read[] = {-2, -1, 3}, expected[] = {0.5, 0, 0};
  LawProblem        problem = {0};
  PetscReal         B[3];
  Mat               near_S, shell;

  Fill(&problem, &RowLawUnilateral, 3, 1, 1, 0, 1, B);
  for (PetscInt k = 0; k < 9; k++) entries(&problem)[k] = S[k];
  for (PetscInt i = 0; i < 3; i++) problem.read[i] = read[i];
  if (products) { /* S itself is what is near it */
    ok(MatConvert(problem.S, MATSEQAIJ, MAT_INITIAL_MATRIX, &near_S));
    ok(MatCreateShell(PETSC_COMM_SELF, 3, 3, 3, 3, near_S, &shell));
    ok(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))Multiply));
    ok(LawProblemTakeS(&problem, &shell, &near_S));
  }
  if (products) ok(LawProblemSolve(&problem));
  else (void)solve(&problem);
  assert_true(problem.solved && problem.by_nodes == products); /* with entries a sweep solves, and Newton's method is not called */
  for (PetscInt i = 0; i < 3; i++) near(PetscRealPart(problem.force[i]), PetscRealPart(expected[i]), 1e-12);
  /* from the solution on there is no circle */
  if (products) ok(LawProblemSolve(&problem));
  else (void)solve(&problem);
  assert_true(problem.solved && !problem.by_nodes);
  ok(LawProblemDestroy(&problem));
}

static void sweeps_help_where_newton_cycles(void **state)
{
  (void)state;
  ExampleOfCurtis(PETSC_FALSE);
  ExampleOfCurtis(PETSC_TRUE);
}

/* A body between two walls that are nearer to each other than it is thick: no forces close both gaps */
static void what_has_no_solution_is_not_solved(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[4];
  PetscBool  solved;

  (void)state;
  for (PetscInt law = 0; law < 2; law++) {
    Fill(&problem, law ? &RowLawTie : &RowLawUnilateral, 2, 1, 1, 0, 1, B);
    entries(&problem)[0] = entries(&problem)[3] = 1;
    entries(&problem)[1] = entries(&problem)[2] = -1;
    problem.read[0] = problem.read[1] = -1;
    solved                            = solve(&problem);
    assert_false(solved);
    assert_true(problem.iterations < 100000); /* sweeps are limited: 5120, Newton's method between them */
  }
  entries(&problem)[0] = NAN;
  problem.law[0] = problem.law[1] = &RowLawUnilateral;
  solved                          = solve(&problem);
  assert_false(solved);
  entries(&problem)[0] = 1;
  problem.read[0]      = NAN;
  solved               = solve(&problem);
  assert_false(solved);
  ok(LawProblemDestroy(&problem));
}

/* Bodies may be held where a row acts: what it reads tells nothing of the forces of others */
static void a_row_that_nothing_moves_sets_no_scale(void **state)
{
  LawProblem problem = {0};

  (void)state;
  resize(&problem, 2);
  problem.n_nodes = 2;
  for (PetscInt i = 0; i < 2; i++) {
    problem.law[i]   = &RowLawUnilateral;
    problem.begin[i] = i;
    problem.base[i] = problem.force[i] = problem.limit[2 * i] = problem.limit[2 * i + 1] = 0;
  }
  problem.begin[2]     = 2;
  entries(&problem)[0] = 1e-6;
  problem.read[0]      = -1e-7; /* 0.1 N close it, and 1e13 N would be the scale of the other */
  problem.read[1]      = 1e-3;
  assert_true(solve(&problem));
  assert_float_equal(PetscRealPart(problem.force[0]), 0.1, 1e-13);
  assert_true(problem.force[1] == 0);
  ok(LawProblemDestroy(&problem));
}

/* Two nodes with forces of round-off: one is away and one, which the law would let go too, touches. Without this the first one counted as
   in contact while a disc flew off, for as long as the run went on. */
static void a_node_that_has_gone_away_has_no_force(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[2]    = {0};

  (void)state;
  Fill(&problem, &RowLawUnilateral, 2, 1, 1, 1, 1, B);
  problem.read[0]    = 1e-6;
  problem.read[1]    = 1e-16;
  problem.resolution = 1e-15;
  for (PetscInt i = 0; i < 2; i++) problem.base[i] = problem.force[i] = 1e-17;
  assert_true(solve(&problem));
  assert_true(PetscRealPart(problem.force[0]) > 0);
  ok(LawProblemLetGo(&problem, 1e-12));
  assert_true(problem.force[0] == 0);
  assert_true(PetscRealPart(problem.force[1]) == 1e-17);
  ok(LawProblemDestroy(&problem));
}

/* Numbers of any unit: S in m/N of 1e-12, gaps of nanometres */
static void units_do_not_matter(void **state)
{
  LawProblem problem = {0};
  PetscReal  B[ROWS * ROWS];

  (void)state;
  for (unsigned seed = 1; seed <= 20; seed++) {
    PetscScalar first[ROWS];
    PetscBool   solved;

    Fill(&problem, &RowLawUnilateral, 8, 2, 8, 0.1, seed, B);
    for (PetscInt node = 0; node < 4; node++) problem.limit[2 * node + 1] = 0.3;
    solved = solve(&problem);
    assert_true(solved);
    for (PetscInt i = 0; i < 8; i++) {
      first[i]         = problem.force[i];
      problem.force[i] = 0;
      problem.read[i] *= 1e-9;
      for (PetscInt j = 0; j < 8; j++) entries(&problem)[j * 8 + i] *= 1e-12;
    }
    solved = solve(&problem);
    assert_true(solved);
    for (PetscInt i = 0; i < 8; i++)
      near(PetscRealPart(problem.force[i]) * 1e-3, PetscRealPart(first[i]), CLOSE * (1 + PetscAbsScalar(first[i])));
  }
  ok(LawProblemDestroy(&problem));
}

#define NODES 25 /* of a chain */
#define CHAIN (3 * NODES)

/* S = B B^T + I / 10 of a chain of nodes, of which the rows across the normal have entries at three places of their own node and of the
   next one, and normal ones at the first of these alone: they are not coupled. Entries that are not zero; `dense`: all. */
static Mat ChainMatrix(PetscBool dense, unsigned seed)
{
  PetscReal B[CHAIN][CHAIN + 3] = {{0}};
  Mat       S;

  for (PetscInt i = 0; i < CHAIN; i++)
    for (PetscInt k = 0; k < 6; k++)
      if ((k % 3 == 0) == (i % 3 == 0)) B[i][i - i % 3 + k] = Random(&seed);
  if (dense) ok(MatCreateSeqDense(PETSC_COMM_SELF, CHAIN, CHAIN, NULL, &S));
  else ok(MatCreateSeqAIJ(PETSC_COMM_SELF, CHAIN, CHAIN, 9, NULL, &S));
  for (PetscInt i = 0; i < CHAIN; i++)
    for (PetscInt j = 0; j < CHAIN; j++) {
      PetscScalar sum = i == j ? 0.1 : 0;

      for (PetscInt k = 0; k < CHAIN + 3; k++) sum += B[i][k] * B[j][k];
      if (dense || sum != 0) ok(MatSetValue(S, i, j, sum, INSERT_VALUES));
    }
  ok(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
  return S;
}

/* Of the chain, with readings by chance; `S` is kept, and may have other values in the next call. `products`: it is only multiplied with,
   and what is near it has its diagonal alone */
static void SolveChain(LawProblem *problem, Mat S, PetscBool products, unsigned seed)
{
  Mat taken = S, diagonal = NULL;
  Vec values;

  ok(LawProblemResize(problem, CHAIN));
  problem->n_nodes = NODES;
  for (PetscInt node = 0; node <= NODES; node++) problem->begin[node] = 3 * node;
  for (PetscInt node = 0; node < NODES; node++) {
    problem->law[node]           = &RowLawUnilateral;
    problem->limit[2 * node]     = 0;
    problem->limit[2 * node + 1] = 0.4;
  }
  ok(PetscObjectReference((PetscObject)S));
  if (products) {
    ok(MatCreateVecs(S, &values, NULL));
    ok(MatGetDiagonal(S, values));
    ok(MatCreateSeqAIJ(PETSC_COMM_SELF, CHAIN, CHAIN, 1, NULL, &diagonal));
    ok(MatDiagonalSet(diagonal, values, INSERT_VALUES));
    ok(VecDestroy(&values));
    ok(MatDestroy(&taken));
    ok(MatCreateShell(PETSC_COMM_SELF, CHAIN, CHAIN, CHAIN, CHAIN, S, &taken));
    ok(MatShellSetOperation(taken, MATOP_MULT, (void (*)(void))Multiply));
  }
  ok(LawProblemTakeS(problem, &taken, products ? &diagonal : NULL));
  for (PetscInt i = 0; i < CHAIN; i++) {
    problem->read[i] = Random(&seed);
    problem->base[i] = problem->force[i] = 0;
  }
  ok(LawProblemSolve(problem));
}

/* Other values in the same matrix, and another matrix, are noticed */
static void a_sparse_S_and_products_have_the_solution_of_a_dense_one(void **state)
{
  LawProblem one = {0}, other = {0}, products = {0};

  (void)state;
  for (unsigned seed = 1; seed <= 12; seed++) {
    Mat      S[2] = {ChainMatrix(PETSC_TRUE, seed / 2), ChainMatrix(PETSC_FALSE, seed / 2)};
    PetscInt push = 0;

    for (PetscInt pass = 0; pass < 3; pass++) {
      SolveChain(&one, S[0], PETSC_FALSE, seed);
      SolveChain(&other, S[1], PETSC_FALSE, seed);
      SolveChain(&products, S[1], PETSC_TRUE, seed);
      assert_true(one.solved && other.solved && products.solved && other.sparse && !one.sparse);
      for (PetscInt i = 0; i < CHAIN; i++) {
        near(PetscRealPart(other.force[i]), PetscRealPart(one.force[i]), CLOSE);
        near(PetscRealPart(products.force[i]), PetscRealPart(one.force[i]), CLOSE);
        push += PetscRealPart(one.force[i]) > 0 && i % 3 == 0;
      }
      for (PetscInt k = 0; k < 2; k++) ok(MatScale(S[k], 1.7));
    }
    between(push, 3, 3 * NODES - 3);
    for (PetscInt k = 0; k < 2; k++) ok(MatDestroy(&S[k]));
  }
  ok(LawProblemDestroy(&one));
  ok(LawProblemDestroy(&other));
  ok(LawProblemDestroy(&products));
}

/* Readings by chance, of which a few or all change from one solution to the next: factors of earlier Jacobians, and new ones */
static void a_large_dense_S_has_the_solution_of_a_sparse_one(void **state)
{
  LawProblem problems[2] = {{0}, {0}};
  unsigned   seed        = 5;
  PetscReal  read[MANY];

  (void)state;
  for (PetscInt k = 0; k < 2; k++) {
    Mat S;

    ok(LawProblemResize(&problems[k], MANY));
    problems[k].n_nodes = MANY;
    for (PetscInt i = 0; i <= MANY; i++) problems[k].begin[i] = i;
    for (PetscInt i = 0; i < MANY; i++) problems[k].law[i] = &RowLawUnilateral;
    for (PetscInt i = 0; i < 2 * MANY; i++) problems[k].limit[i] = 0;
    if (k) ok(MatCreateSeqAIJ(PETSC_COMM_SELF, MANY, MANY, 3, NULL, &S));
    else ok(MatCreateSeqDense(PETSC_COMM_SELF, MANY, MANY, NULL, &S));
    for (PetscInt i = 0; i < MANY; i++)
      for (PetscInt j = PetscMax(0, i - 1); j <= PetscMin(MANY - 1, i + 1); j++) ok(MatSetValue(S, i, j, i == j ? 2 : 0.9, INSERT_VALUES));
    ok(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
    ok(LawProblemTakeS(&problems[k], &S, NULL));
  }
  for (PetscInt pass = 0; pass < 6; pass++) {
    for (PetscInt i = 0; i < MANY; i++)
      if (pass % 2 == 0 || i < 8) read[i] = Random(&seed);
    for (PetscInt k = 0; k < 2; k++) {
      ok(PetscArrayzero(problems[k].base, MANY));
      ok(PetscArrayzero(problems[k].force, MANY));
      for (PetscInt i = 0; i < MANY; i++) problems[k].read[i] = read[i];
      ok(LawProblemSolve(&problems[k]));
      assert_true(problems[k].solved && problems[k].sparse == (k > 0));
    }
    for (PetscInt i = 0; i < MANY; i++) near(PetscRealPart(problems[0].force[i]), PetscRealPart(problems[1].force[i]), CLOSE);
  }
  for (PetscInt k = 0; k < 2; k++) ok(LawProblemDestroy(&problems[k]));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(without_friction_it_is_the_one_solution),
      cmocka_unit_test(base_is_where_readings_were_taken),
      cmocka_unit_test(with_friction_the_law_holds),
      cmocka_unit_test(a_node_sticks_and_slips_as_by_hand),
      cmocka_unit_test(ties_are_linear_equations),
      cmocka_unit_test(nodes_have_laws_of_their_own),
      cmocka_unit_test(doubled_rows_give_bodies_the_same),
      cmocka_unit_test(sweeps_help_where_newton_cycles),
      cmocka_unit_test(what_has_no_solution_is_not_solved),
      cmocka_unit_test(a_row_that_nothing_moves_sets_no_scale),
      cmocka_unit_test(a_node_that_has_gone_away_has_no_force),
      cmocka_unit_test(units_do_not_matter),
      cmocka_unit_test(a_sparse_S_and_products_have_the_solution_of_a_dense_one),
      cmocka_unit_test(a_large_dense_S_has_the_solution_of_a_sparse_one),
  };

  return impakt_main(argc, argv, tests);
}
