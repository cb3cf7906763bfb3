/* Rows between the ends of bars: which of them face each other, at what gap. */
#include "interfaces.h"

typedef struct {
  DM           dm[2];
  Surface      surface[2];
  Transfer     transfer;
  TransferRows rows;
  PetscInt     n;                 /* rows of all ranks that have something opposite */
  PetscReal    gap, area, normal; /* of the only one */
} Bars;

static PetscReal sum_of(PetscReal mine)
{
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return mine;
}

static void bars_create(const char *const lower[], const char *const upper[], const char *const names[], PetscReal near, Bars *bars)
{
  PetscReal sums[4] = {0};
  PetscBool rebuilt;

  for (PetscInt side = 0; side < 2; side++) {
    bars->dm[side] = CreateBoxMesh(side ? "neumann" : "dirichlet", 1, side ? "3" : "4", lower[side], upper[side], PETSC_TRUE);
    ok(SurfaceCreate(bars->dm[side], names[side], &bars->surface[side]));
  }
  ok(SurfaceKeepFacing(bars->surface[0], bars->surface[1], NULL, (PetscBool)!names[0], (PetscBool)!names[1]));
  ok(TransferCreate(PETSC_COMM_WORLD, bars->surface[0], bars->surface[1], NULL, &bars->transfer));
  ok(TransferUpdate(bars->transfer, NULL, NULL, near, &rebuilt));
  assert_true(rebuilt);
  ok(TransferGetRows(bars->transfer, &bars->rows));
  for (PetscInt i = 0; i < bars->rows.n; i++) {
    if (!bars->rows.opposite[i]) continue;
    sums[0] += 1;
    sums[1] += bars->rows.gap[i];
    sums[2] += bars->rows.area[i];
    sums[3] += bars->rows.normals[i];
  }
  bars->n      = (PetscInt)sum_of(sums[0]);
  bars->gap    = sum_of(sums[1]);
  bars->area   = sum_of(sums[2]);
  bars->normal = sum_of(sums[3]);
}

static void bars_destroy(Bars *bars)
{
  ok(TransferDestroy(&bars->transfer));
  for (PetscInt side = 0; side < 2; side++) {
    ok(SurfaceDestroy(&bars->surface[side]));
    ok(DMDestroy(&bars->dm[side]));
  }
}

static void bars_that_face_each_other(void **state)
{
  /* the second time the other way round, the Dirichlet normal pointing left; then with all ends, far ones too */
  const char *const lower[] = {"0", "1.25", "0"}, *const upper[] = {"1", "2", "1"}, *const names[2][2] = {{NULL, NULL}, {"all", "all"}};
  Bars bars;

  (void)state;
  for (PetscInt order = 0; order < 2; order++)
    for (PetscInt all = 0; all < 2; all++) {
      bars_create(lower + order, upper + order, names[all], PETSC_MAX_REAL, &bars);
      assert_int_equal(bars.n, 1); /* the far ends look at each other too, but across both bars */
      assert_int_equal((PetscInt)sum_of(bars.rows.n), all ? 2 : 1);
      near(bars.gap, 0.25, 1e-15);
      near(bars.area, 1, 0);
      near(bars.normal, order ? -1 : 1, 0);
      bars_destroy(&bars);
    }
}

/* The near ends 0.1 inside each other, or at the same place; the far ends, 2 apart, are no row */
static void overlap_is_a_negative_gap(void **state)
{
  const char *const right[] = {"0.9", "1"}, *const upper[] = {"1", "2"}, *const names[2][2] = {{NULL, NULL}, {"all", "all"}};
  const PetscReal gaps[] = {-0.1, 0};
  Bars            bars;

  (void)state;
  for (PetscInt i = 0; i < 4; i++) {
    const char *const lower[] = {"0", right[i % 2]};

    bars_create(lower, upper, names[i / 2], PETSC_MAX_REAL, &bars);
    assert_int_equal(bars.n, 1);
    near(bars.gap, gaps[i % 2], 1e-15);
    bars_destroy(&bars);
  }
}

/* What is closest is known at any distance: 0.2 m is what must be known at least */
static void far_bars_are_partners(void **state)
{
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"}, *const names[] = {NULL, NULL};
  Bars bars;

  (void)state;
  bars_create(lower, upper, names, 0.2, &bars);
  assert_int_equal(bars.n, 1);
  for (PetscInt i = 0; i < bars.rows.n; i++) near(bars.rows.gap[i], 0.25, 1e-15);
  bars_destroy(&bars);
}

static void surfaces_that_do_not_face_each_other(void **state)
{
  /* both look right; both look left; they look away from each other */
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"},
                    *const names[][2] = {{"xmax", "xmax"}, {"xmin", "xmin"}, {"xmin", "xmax"}};
  Bars                     bars;

  (void)state;
  for (PetscInt i = 0; i < 3; i++) {
    bars_create(lower, upper, names[i], PETSC_MAX_REAL, &bars);
    assert_int_equal(bars.n, 0);
    bars_destroy(&bars);
  }
}

static void dimensions_must_agree(void **state)
{
  DM       dm[] = {CreateBoxMesh("line", 1, "4", "0", "1", PETSC_TRUE), CreateBoxMesh("rectangle", 2, "2,2", "0,0", "1,1", PETSC_FALSE)};
  Surface  surface[2];
  Transfer transfer;

  (void)state;
  for (PetscInt i = 0; i < 2; i++) ok(SurfaceCreate(dm[i], NULL, &surface[i]));
  refused(PETSC_ERR_USER_INPUT, "1 and 2 dimensions", TransferCreate(PETSC_COMM_WORLD, surface[0], surface[1], NULL, &transfer));
  ok(TransferDestroy(&transfer));
  refused(PETSC_ERR_USER_INPUT, "1 and 2 dimensions", SurfaceKeepFacing(surface[0], surface[1], NULL, PETSC_TRUE, PETSC_TRUE));
  for (PetscInt i = 0; i < 2; i++) {
    ok(SurfaceDestroy(&surface[i]));
    ok(DMDestroy(&dm[i]));
  }
}

/* Surfaces that are far apart have no rows with a partner until the next update, which finds them again */
static void sleeps_until_the_next_update(void **state)
{
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"}, *const names[] = {NULL, NULL};
  Obstacle  obstacle;
  Transfer  other;
  PetscBool rebuilt;
  PetscInt  n;
  Bars      bars;

  (void)state;
  bars_create(lower, upper, names, 10, &bars);
  n = bars.rows.n;
  for (PetscInt again = 0; again < 2; again++) {
    ok(TransferSleep(bars.transfer));
    ok(TransferGetRows(bars.transfer, &bars.rows));
    assert_int_equal(bars.rows.n, n);
    for (PetscInt i = 0; i < n; i++) {
      assert_false(bars.rows.opposite[i]);
      assert_int_equal(bars.rows.changed[i], !again); /* those that had a partner */
    }
  }
  ok(TransferUpdate(bars.transfer, NULL, NULL, 0, &rebuilt));
  assert_true(rebuilt);
  ok(TransferGetRows(bars.transfer, &bars.rows));
  for (PetscInt i = 0; i < n; i++) {
    assert_true(bars.rows.opposite[i]);
    near(bars.rows.gap[i], 0.25, 1e-15);
  }
  ok(TransferUpdate(bars.transfer, NULL, NULL, 0, &rebuilt));
  assert_false(rebuilt);
  ok(ObstacleCreate(PETSC_COMM_WORLD, "wall", &obstacle));
  ok(ObstacleSetPlane(obstacle, (const PetscReal[]){2, 0, 0}, (const PetscReal[]){-1, 0, 0}));
  ok(TransferCreate(PETSC_COMM_WORLD, bars.surface[0], NULL, obstacle, &other));
  refused(PETSC_ERR_ARG_WRONGSTATE, "between two surfaces", TransferSleep(other));
  ok(TransferDestroy(&other));
  ok(ObstacleDestroy(&obstacle));
  bars_destroy(&bars);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(bars_that_face_each_other), simulation_test(overlap_is_a_negative_gap),
      simulation_test(far_bars_are_partners),     simulation_test(surfaces_that_do_not_face_each_other),
      simulation_test(dimensions_must_agree),     simulation_test(sleeps_until_the_next_update),
  };

  return impakt_main(argc, argv, tests);
}
