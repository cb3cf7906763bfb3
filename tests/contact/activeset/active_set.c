/* Rounds of the active set on made-up contact problems, gaps = q + S forces, whose rows are shared out to the ranks. */
#include "support.h"
#include <contact/activeset/rounds.h>

#define MOST_ROWS 10

typedef struct {
  PetscInt  n;
  PetscReal S[MOST_ROWS * MOST_ROWS], q[MOST_ROWS]; /* S by rows */
  PetscBool start[MOST_ROWS];                       /* held when the step begins */
} Problem;

typedef struct {
  Contact   contact;
  Rounds    set;
  PetscReal force[MOST_ROWS], gap[MOST_ROWS]; /* of all rows, on every rank */
  PetscReal margin[2][MOST_ROWS];             /* of rounds that are left early, of this rank's rows */
  PetscInt  rounds;
} Model;

static void model_create(PetscInt n, Model *m)
{
  PetscInt local = PETSC_DECIDE;

  memset(m, 0, sizeof(*m));
  ok(ContactCreate(PETSC_COMM_WORLD, &m->contact));
  ok(ContactSetTolerance(m->contact, 0)); /* the default one is known after ContactSetUp(), which made-up problems do without */
  ok(PetscSplitOwnership(PETSC_COMM_WORLD, &local, &n));
  assert_int_equal(MPI_Exscan(&local, &m->contact->rows.begin, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  m->contact->rows.n = local;
  ok(PetscCalloc4(local, &m->contact->end.active, local, &m->contact->rows.tied, local, &m->contact->end.force, local,
                  &m->contact->end.gap));
  ok(RoundsCreate(m->contact, m->contact->end.active, m->contact->end.force, m->contact->end.gap, &m->set));
  for (PetscInt k = 0; k < 2; k++) m->set.margin[k] = m->margin[k];
}

static void model_destroy(Model *m)
{
  ok(RoundsDestroy(&m->set));
  ok(PetscFree4(m->contact->end.active, m->contact->rows.tied, m->contact->end.force, m->contact->end.gap));
  m->contact->rows.n = 0;
  ok(ContactDestroy(&m->contact));
}

/* Forces that close the gaps of active rows, by elimination: the matrices need no pivots */
static void solve(const Problem *problem, Model *m)
{
  const PetscInt n                           = problem->n;
  PetscReal      a[MOST_ROWS][MOST_ROWS + 1] = {{0}};
  int            active[MOST_ROWS]           = {0};

  for (PetscInt i = 0; i < m->contact->rows.n; i++) active[m->contact->rows.begin + i] = m->contact->end.active[i];
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
  for (PetscInt i = 0; i < m->contact->rows.n; i++) {
    m->contact->end.force[i] = m->force[m->contact->rows.begin + i];
    m->contact->end.gap[i]   = m->contact->end.active[i] ? 0 : m->gap[m->contact->rows.begin + i];
  }
}

/* One controller step, in which rounds are left early as long as they may be, or none is; how often sets have been seen twice so far */
static PetscInt step_in(const Problem *problem, PetscBool haste, Model *m)
{
  PetscBool changed = PETSC_TRUE, flips;

  ok(RoundsBegin(&m->set));
  for (PetscInt i = 0; i < m->contact->rows.n; i++) m->contact->end.active[i] = problem->start[m->contact->rows.begin + i];
  for (m->rounds = 0; changed; m->rounds++) {
    ok(RoundsNext(&m->set));
    solve(problem, m);
    if (haste && RoundsMayLeave(&m->set)) RoundsLeaveEarly(&m->set);
    ok(RoundsChange(&m->set));
    ok(RoundsHaveChanged(&m->set, &changed));
    if (changed) ok(RoundsBreakCycle(&m->set, &flips));
  }
  return m->contact->counts.set_cycles;
}

static PetscInt step(const Problem *problem, Model *m)
{
  return step_in(problem, PETSC_FALSE, m);
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
    const PetscInt before = model.contact->counts.set_cycles;

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
  between(model.rounds, 1, ROUNDS_MAX / 2 - 1);
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
  between(model.rounds, ROUNDS_MAX / 2, ROUNDS_MAX / 2 + 10);
  model_destroy(&model);
}

/* What rounds were left with is no solution: a set that comes up again is no circle until rounds have been solved to their end */
static void hasty_rounds_are_no_circle(void **state)
{
  Problem problem = {.n = 3};
  Model   model;

  (void)state;
  memcpy(problem.S, circle_S, sizeof(circle_S));
  memcpy(problem.q, circle_q, sizeof(circle_q));
  model_create(3, &model);
  assert_int_equal(step(&problem, &model), 1);
  model.contact->counts.set_cycles = 0;
  between(model.rounds, 4, 10);
  {
    const PetscInt patient = model.rounds;

    assert_int_equal(step_in(&problem, PETSC_TRUE, &model), 1);
    check(&model, 3, circle_force);
    assert_int_equal(model.rounds, patient + 3); /* once round in haste */
    assert_true(model.set.patient && !model.set.early);
  }
  ok(RoundsBegin(&model.set));
  assert_true(RoundsMayLeave(&model.set));
  model_destroy(&model);
}

/* Rows that are wrong by less than forces and gaps may still change by are left as they are, until the round is solved to its end */
static void rounds_left_early_change_what_is_clear(void **state)
{
  static const PetscReal force[] = {-1, -0.1, 0, 0}, gap[] = {0, 0, -1, -0.1};
  static const PetscBool start[] = {PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE};
  Model                  model;

  (void)state;
  model_create(4, &model);
  for (PetscInt round = 0; round < 2; round++) {
    ok(RoundsBegin(&model.set));
    for (PetscInt i = 0; i < model.contact->rows.n; i++) {
      const PetscInt row = model.contact->rows.begin + i;

      model.contact->end.active[i] = start[row];
      model.contact->end.force[i]  = force[row];
      model.contact->end.gap[i]    = gap[row];
      model.margin[0][i] = model.margin[1][i] = 0.5;
    }
    ok(RoundsNext(&model.set));
    assert_null(RoundsBefore(&model.set));
    if (!round) RoundsLeaveEarly(&model.set);
    ok(RoundsChange(&model.set));
    for (PetscInt i = 0; i < model.contact->rows.n; i++) {
      const PetscInt row = model.contact->rows.begin + i;

      assert_int_equal(model.contact->end.active[i], round ? !start[row] : row == 1 || row == 2);
    }
    ok(RoundsNext(&model.set));
    assert_false(model.set.early);
    for (PetscInt i = 0; i < model.contact->rows.n; i++)
      assert_int_equal(RoundsBefore(&model.set)[i], start[model.contact->rows.begin + i]);
  }
  model_destroy(&model);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_circle_of_three_sets),     cmocka_unit_test(a_row_that_flips),
      cmocka_unit_test(fewer_wrong_rows),           cmocka_unit_test(a_long_way_ends),
      cmocka_unit_test(hasty_rounds_are_no_circle), cmocka_unit_test(rounds_left_early_change_what_is_clear),
  };

  return impakt_main(argc, argv, tests);
}
