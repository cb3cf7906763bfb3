/* When the history is flushed: after two seconds, or later where flushing takes long; by a clock that the tests set. */
/* ranks: 1 */
#include "simulation.h"
#include <hdf5.h>
#include <petsctime.h>

static double now, each_look; /* s; how much of it passes while somebody looks at the clock */

static PetscErrorCode SimulatedTime(PetscLogDouble *time)
{
  now += each_look;
  *time = now;
  return PETSC_SUCCESS;
}

/* The functions under test are compiled here, with that clock */
#define PetscTime SimulatedTime
#undef _POSIX_C_SOURCE /* as the system has it, not as the file */
#include <io/history.c>
#undef PetscTime

#define PATH  "history.h5"
#define STEPS 10

/* What time it is at each step, and how many records there are in the file then */
typedef struct {
  double  times[STEPS + 1];
  int     records[STEPS + 1];
  History history;
} Plan;

static int Records(void)
{
  hid_t   file = H5Fopen(PATH, H5F_ACC_RDONLY, H5P_DEFAULT), times, space;
  hsize_t length;

  assert_true(file >= 0);
  times = H5Dopen2(file, "/time", H5P_DEFAULT);
  space = H5Dget_space(times);
  assert_int_equal(H5Sget_simple_extent_dims(space, &length, NULL), 1);
  H5Sclose(space);
  H5Dclose(times);
  H5Fclose(file);
  return (int)length;
}

static PetscErrorCode FollowPlan(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Plan *plan = (Plan *)ctx;

  PetscFunctionBegin;
  now = 1000 + plan->times[frame->step];
  PetscCall(HistoryMonitor(controller, frame, plan->history));
  assert_int_equal(Records(), plan->records[frame->step]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Run(Simulation *simulation, Plan *plan)
{
  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(HistoryCreate(simulation->controller, PATH, &plan->history));
  ok(ControllerMonitorSet(simulation->controller, FollowPlan, plan, NULL));
  ok(ControllerSolve(simulation->controller));
  ok(HistoryDestroy(&plan->history));
  assert_int_equal(Records(), STEPS + 1);
  remove(PATH);
}

/* At once the first record, later ones when more than two seconds have passed */
static void every_two_seconds(void **state)
{
  Plan plan = {.times = {0, 1, 1.99, 2.01, 2.02, 4, 4.02, 6.01, 10, 11.99, 12.01}, .records = {1, 1, 1, 4, 4, 4, 7, 7, 9, 9, 11}};

  each_look = 0;
  Run((Simulation *)*state, &plan);
}

/* 0.1 s, 2 % of five seconds, which begin when it has ended: 0.3 s later than the step */
static void seldom_where_it_takes_long(void **state)
{
  Plan plan = {.times = {0, 2.1, 5, 5.15, 5.25, 8, 10.3, 10.4, 10.6, 15, 15.7}, .records = {1, 1, 1, 1, 5, 5, 5, 5, 9, 9, 9}};

  each_look = 0.1;
  Run((Simulation *)*state, &plan);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(every_two_seconds), simulation_test(seldom_where_it_takes_long)};

  return impakt_main(argc, argv, tests);
}
