/* Rounds of the active set on made-up contact problems, gaps = q + S forces, whose rows are shared out to the ranks. */
#include "support.h"
#include <contact/impls/schwarz/schwarzimpl.h>

#define MOST_ROWS 10

typedef struct {
  PetscInt  n;
  PetscReal S[MOST_ROWS * MOST_ROWS], q[MOST_ROWS]; /* S by rows */
  PetscBool start[MOST_ROWS];                       /* held when the step begins */
} Problem;

typedef struct {
  Contact   contact;
  Schwarz   schwarz;
  PetscReal force[MOST_ROWS], gap[MOST_ROWS]; /* of all rows, on every rank */
  PetscInt  rounds;
} Model;

static void model_create(PetscInt n, Model *m)
{
  PetscInt local = PETSC_DECIDE;

  memset(m, 0, sizeof(*m));
  ok(ContactCreate(PETSC_COMM_WORLD, &m->contact));
  ok(ContactSetTolerance(m->contact, 0)); /* nothing is set up that would find one */
  ok(PetscSplitOwnership(PETSC_COMM_WORLD, &local, &n));
  assert_int_equal(MPI_Exscan(&local, &m->contact->row_begin, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  m->contact->n_rows = local;
  m->contact->data   = &m->schwarz;
  m->schwarz.recheck = PETSC_TRUE;
  ok(PetscCalloc5(local, &m->contact->active, local, &m->contact->tied, local, &m->contact->force, local, &m->contact->gap, local,
                  &m->schwarz.rounds.kept));
  ok(PetscMalloc1((SCHWARZ_MAX_ROUNDS + 1) * local, &m->schwarz.rounds.tried));
}

static void model_destroy(Model *m)
{
  ok(PetscFree(m->schwarz.rounds.tried));
  ok(PetscFree5(m->contact->active, m->contact->tied, m->contact->force, m->contact->gap, m->schwarz.rounds.kept));
  m->contact->n_rows = 0;
  m->contact->data   = NULL;
  ok(ContactDestroy(&m->contact));
}

/* Forces that close the gaps of active rows, by elimination: the matrices need no pivots */
static void solve(const Problem *problem, Model *m)
{
  const PetscInt n                           = problem->n;
  PetscReal      a[MOST_ROWS][MOST_ROWS + 1] = {{0}};
  int            active[MOST_ROWS]           = {0};

  for (PetscInt i = 0; i < m->contact->n_rows; i++) active[m->contact->row_begin + i] = m->contact->active[i];
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, active, MOST_ROWS, MPI_INT, MPI_MAX, PETSC_COMM_WORLD), 0);
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = 0; j < n; j++) a[i][j] = active[i] && active[j] ? problem->S[i * n + j] : i == j;
    a[i][n] = active[i] ? -problem->q[i] : 0;
  }
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = n; j >= k && i != k; j--) a[i][j] -= a[i][k] / a[k][k] * a[k][j];
  for (PetscInt i = 0; i < n; i++) m->force[i] = a[i][n] / a[i][i];
  for (PetscInt i = 0; i < n; i++) {
    m->gap[i] = problem->q[i];
    for (PetscInt j = 0; j < n; j++) m->gap[i] += problem->S[i * n + j] * m->force[j];
  }
  for (PetscInt i = 0; i < m->contact->n_rows; i++) {
    m->contact->force[i] = m->force[m->contact->row_begin + i];
    m->contact->gap[i]   = m->contact->active[i] ? 0 : m->gap[m->contact->row_begin + i];
  }
}

/* One controller step; how often sets have been seen twice so far */
static PetscInt step(const Problem *problem, Model *m)
{
  PetscBool changed = PETSC_TRUE, flips;

  ok(SchwarzBeginRounds(m->contact));
  for (PetscInt i = 0; i < m->contact->n_rows; i++) m->contact->active[i] = problem->start[m->contact->row_begin + i];
  for (m->rounds = 0; changed; m->rounds++) {
    ok(SchwarzBeginRound(m->contact));
    solve(problem, m);
    ok(SchwarzUpdateActiveSet(m->contact, &changed));
    if (changed) ok(SchwarzBreakCycle(m->contact, &flips));
  }
  return m->contact->counts_made.set_cycles;
}

static void check(const Model *m, PetscInt n, const PetscReal force[])
{
  for (PetscInt i = 0; i < n; i++) {
    near(m->force[i], force[i], 1e-12); /* numbers of about 1, matrices of condition 430 at most */
    assert_true(m->gap[i] >= -1e-12);
  }
}

/* Symmetric and positive definite: the one solution is held by row 0, 4 / 2 = 0.5, gaps -1 + 5 / 2 and 3 - 5 / 2. From no contact all
   changes at once go
   {} -> {0, 1} -> {0, 2} -> {}: Curtis, Han, Robinson, "A globally convergent primal-dual active-set framework for large-scale convex
   quadratic optimization", Comput. Optim. Appl. 60, 2015, section 2, with the signs of contact. */
static const PetscReal circle_S[] = {4, 5, -5, 5, 9, -5, -5, -5, 7}, circle_q[] = {-2, -1, 3}, circle_force[] = {0.5, 0, 0};

static void a_circle_of_three_sets(void **state)
{
  Problem problem = {.n = 3};
  Model   model;

  (void)state;
  ok(PetscArraycpy(problem.S, circle_S, 9));
  ok(PetscArraycpy(problem.q, circle_q, 3));
  model_create(3, &model);
  for (PetscInt start = 0; start < 8; start++) {
    const PetscInt before = model.contact->counts_made.set_cycles;

    for (PetscInt i = 0; i < 3; i++) problem.start[i] = (PetscBool)((start >> i) & 1);
    assert_int_equal(step(&problem, &model) - before,
                     start == 1 || start == 6 ? 0 : 1); /* {0}, and {1, 2} which goes there next, are not on the circle */
    check(&model, 3, circle_force);
    between(model.rounds, 1, 12);
  }
  model_destroy(&model);
}

/* What force waveforms over substeps can do: row 0 is pulled when held, -1, and penetrates when not. Only while rows 0 and 1 are held
   together does row 2 penetrate, 1 - 3, which the round after must still see. */
static void a_row_that_flips(void **state)
{
  const PetscReal S[] = {-1, 0, 0, 3, 2, 0, 0, -3, 2}, force[] = {-1, 1, 1}, none[] = {0, 0, 0};
  Problem         problem = {.n = 3, .q = {-1, 1, 1}, .start = {PETSC_TRUE, PETSC_FALSE, PETSC_FALSE}};
  Model           model;

  (void)state;
  ok(PetscArraycpy(problem.S, S, 9));
  model_create(3, &model);
  assert_int_equal(step(&problem, &model), 1);
  check(&model, 3, force);
  assert_int_equal(model.rounds, 4); /* {0} {1} {0, 1} {0, 1, 2} */
  /* another step: the row is not held beyond the one in which it flips */
  problem.S[0] = problem.q[0] = 1;
  assert_int_equal(step(&problem, &model), 1);
  check(&model, 3, none);
  assert_int_equal(model.rounds, 3); /* {0} {1} {} */
  model_destroy(&model);
}

/* The circle, whose solution closes n more rows on which changes of the first row alone take 2^n rounds (Murty, "Computational complexity
   of complementary pivot methods", 1978: ones on the diagonal, twos above) */
static void long_way(PetscInt n, Problem *problem)
{
  problem->n = 3 + n;
  for (PetscInt i = 0; i < problem->n; i++) {
    problem->q[i] = i < 3 ? circle_q[i] : 1; /* 1 - 4 / 2 = -1 with the solution, and open on the way round */
    for (PetscInt j = 0; j < problem->n; j++)
      problem->S[problem->n * i + j] = i < 3    ? (j < 3 ? circle_S[3 * i + j] : 0)
                                       : j == 0 ? -4
                                       : j == 1 ? -10
                                       : j < 3  ? 0
                                       : j == i ? 1
                                       : j > i  ? 2
                                                : 0;
  }
}

/* All at once again, where that is allowed, makes 42 rounds of 64 and more: only the last of the 6 rows is held, 1 - 2 + 1 = 0 and 1 - 2 +
   2 = 1 */
static void fewer_wrong_rows(void **state)
{
  const PetscReal force[] = {0.5, 0, 0, 0, 0, 0, 0, 0, 1};
  Problem         problem = {0};
  Model           model;

  (void)state;
  long_way(6, &problem);
  model_create(9, &model);
  assert_int_equal(step(&problem, &model), 1);
  check(&model, 9, force);
  between(model.rounds, 1, SCHWARZ_MAX_ROUNDS / 2 - 1);
  model_destroy(&model);
}

/* With 7 of them it takes too long, and the step ends before: some rows are pulled, and nothing penetrates */
static void a_long_way_ends(void **state)
{
  Problem problem = {0};
  Model   model;

  (void)state;
  long_way(7, &problem);
  model_create(10, &model);
  assert_int_equal(step(&problem, &model), 1);
  check(&model, 3, circle_force);
  for (PetscInt i = 3; i < 10; i++) assert_true(model.gap[i] >= -1e-12);
  between(model.rounds, SCHWARZ_MAX_ROUNDS / 2, SCHWARZ_MAX_ROUNDS / 2 + 10);
  model_destroy(&model);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_circle_of_three_sets),
      cmocka_unit_test(a_row_that_flips),
      cmocka_unit_test(fewer_wrong_rows),
      cmocka_unit_test(a_long_way_ends),
  };

  return impakt_main(argc, argv, tests);
}
