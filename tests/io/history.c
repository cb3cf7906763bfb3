/* The history file: what it holds, that it can be read at any time, and paths that are refused. */
#define _POSIX_C_SOURCE 200809L
#include "simulation.h"
#include <io/history.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH  "history.h5"
#define STEPS 10

static PetscBool IsFirst(void)
{
  PetscMPIInt rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return (PetscBool)!rank;
}

/* Rank 0 may be later than the others */
static PetscBool Exists(const char path[])
{
  MPI_Barrier(PETSC_COMM_WORLD);
  return (PetscBool)!access(path, F_OK);
}

static void CheckText(hid_t object, const char name[], const char expected[])
{
  hid_t attribute, type;
  char *text;

  assert_true(H5Aexists(object, name) > 0);
  attribute = H5Aopen(object, name, H5P_DEFAULT);
  type      = H5Aget_type(attribute);
  assert_true(H5Tis_variable_str(type) > 0);
  assert_true(H5Aread(attribute, type, &text) >= 0);
  assert_string_equal(text, expected);
  H5free_memory(text);
  H5Tclose(type);
  H5Aclose(attribute);
}

/* A dataset of one number for each record, or of three, with its units; the numbers */
static void CheckDataset(hid_t file, const char name[], const char units[], PetscBool integer, hsize_t length, hsize_t components,
                         double values[])
{
  hid_t   dataset = H5Dopen2(file, name, H5P_DEFAULT), space, type;
  hsize_t size[2];

  if (dataset < 0) print_error("there is no dataset %s\n", name);
  assert_true(dataset >= 0);
  space = H5Dget_space(dataset);
  type  = H5Dget_type(dataset);
  assert_int_equal(H5Sget_simple_extent_dims(space, size, NULL), components > 1 ? 2 : 1);
  assert_int_equal(size[0], length);
  if (components > 1) assert_int_equal(size[1], components);
  assert_int_equal(H5Tget_class(type), integer ? H5T_INTEGER : H5T_FLOAT);
  CheckText(dataset, "units", units);
  assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Tclose(type);
  H5Sclose(space);
  H5Dclose(dataset);
}

static void CheckSeries(hid_t file, const char name[], const char units[], PetscBool integer, hsize_t length, double values[])
{
  CheckDataset(file, name, units, integer, length, 1, values);
}

/* What the file should say */
typedef struct {
  PetscInt         steps;
  PetscReal        times[STEPS + 1];
  PetscInt         sweeps[STEPS + 1];
  ContactPairState pairs[STEPS + 1];
  BodyMeasures     bodies[STEPS + 1][2];
  PetscReal        positions[STEPS + 1][2], velocities[STEPS + 1][2];
} Record;

static PetscErrorCode Note(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Record        *record = (Record *)ctx;
  const PetscInt step   = frame->step;

  PetscFunctionBegin;
  (void)controller;
  record->steps        = step;
  record->times[step]  = frame->time;
  record->sweeps[step] = frame->sweeps;
  record->pairs[step]  = frame->pairs[0];
  for (PetscInt b = 0; b < 2; b++) {
    record->bodies[step][b]     = frame->bodies[b];
    record->positions[step][b]  = frame->contact_positions[3 * b];
    record->velocities[step][b] = frame->contact_velocities[3 * b];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CheckBody(hid_t file, const Record *record, PetscInt b, const char name[])
{
  const hsize_t n = (hsize_t)record->steps + 1;
  double        kinetic[STEPS + 1], potential[STEPS + 1], position[STEPS + 1], velocity[STEPS + 1], mean[STEPS + 1];
  char          path[64];

  snprintf(path, sizeof(path), "/body/%s/kinetic", name);
  CheckSeries(file, path, "J", PETSC_FALSE, n, kinetic);
  snprintf(path, sizeof(path), "/body/%s/potential", name);
  CheckSeries(file, path, "J", PETSC_FALSE, n, potential);
  snprintf(path, sizeof(path), "/body/%s/contact_position", name);
  CheckSeries(file, path, "m", PETSC_FALSE, n, position);
  snprintf(path, sizeof(path), "/body/%s/contact_velocity", name);
  CheckSeries(file, path, "m/s", PETSC_FALSE, n, velocity);
  snprintf(path, sizeof(path), "/body/%s/mean_velocity", name);
  CheckSeries(file, path, "m/s", PETSC_FALSE, n, mean);
  for (PetscInt i = 0; i <= record->steps; i++) {
    near(kinetic[i], record->bodies[i][b].kinetic, 0);
    near(potential[i], record->bodies[i][b].potential, 0);
    near(position[i], record->positions[i][b], 0);
    near(velocity[i], record->velocities[i][b], 0);
    near(mean[i], record->bodies[i][b].mean_velocity[0], 0);
  }
}

/* The numbers are stored as they are: bit for bit */
static void CheckFile(const Record *record)
{
  const hsize_t n    = (hsize_t)record->steps + 1;
  hid_t         file = H5Fopen(PATH, H5F_ACC_RDONLY, H5P_DEFAULT);
  double        time[STEPS + 1], iterations[STEPS + 1], force[STEPS + 1], gap[STEPS + 1], active[STEPS + 1], area[STEPS + 1];
  double        vector[STEPS + 1][3], moment[STEPS + 1][3], impulse[STEPS + 1][3];

  assert_true(file >= 0);
  CheckSeries(file, "/time", "s", PETSC_FALSE, n, time);
  CheckSeries(file, "/schwarz/iterations", "1", PETSC_TRUE, n, iterations);
  CheckSeries(file, "/contact/left:right/force", "N", PETSC_FALSE, n, force);
  CheckSeries(file, "/contact/left:right/gap", "m", PETSC_FALSE, n, gap);
  CheckSeries(file, "/contact/left:right/active", "1", PETSC_TRUE, n, active);
  CheckSeries(file, "/contact/left:right/area", "m^2", PETSC_FALSE, n, area);
  CheckDataset(file, "/contact/left:right/force_vector", "N", PETSC_FALSE, n, 3, &vector[0][0]);
  CheckDataset(file, "/contact/left:right/moment", "N m", PETSC_FALSE, n, 3, &moment[0][0]);
  CheckDataset(file, "/contact/left:right/impulse", "N s", PETSC_FALSE, n, 3, &impulse[0][0]);
  for (PetscInt i = 0; i <= record->steps; i++) {
    near(time[i], record->times[i], 0);
    near(iterations[i], record->sweeps[i], 0);
    near(force[i], record->pairs[i].force, 0);
    near(gap[i], record->pairs[i].gap, 0);
    near(active[i], record->pairs[i].active, 0);
    near(area[i], record->pairs[i].area, 0);
    for (PetscInt d = 0; d < 3; d++) {
      near(vector[i][d], record->pairs[i].force_vector[d], 0);
      near(moment[i][d], record->pairs[i].moment[d], 0);
      near(impulse[i][d], record->pairs[i].impulse[d], 0);
    }
  }
  CheckBody(file, record, 0, "left");
  CheckBody(file, record, 1, "right");
  CheckText(file, "version", IMPAKT_VERSION);
  CheckText(file, "-bodies", "left,right");
  CheckText(file, "-time_step", "0.02");
  CheckText(file, "-left_dm_plex_box_lower", "-1"); /* a value that looks like an option */
  CheckText(file, "-progress", "");                 /* an option without a value */
  H5Fclose(file);
}

static void CreateRun(Simulation *simulation, History *history, Record *record)
{
  AddCollision(4, 3, 0);
  AddOptions("-progress");
  ok(SimulationCreate(simulation));
  ok(HistoryCreate(simulation->controller, PATH, history));
  ok(ControllerMonitorSet(simulation->controller, Note, record, NULL));
  ok(ControllerMonitorSet(simulation->controller, HistoryMonitor, *history, NULL));
}

static void file_of_a_run(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  History     history;
  Record      record;
  const char *path;

  CreateRun(simulation, &history, &record);
  ok(HistoryGetPath(history, &path));
  assert_string_equal(path, PATH);
  ok(ControllerSolve(simulation->controller));
  ok(HistoryDestroy(&history));
  assert_null(history);
  assert_int_equal(record.steps, STEPS);
  assert_true(record.pairs[STEPS].force > 0); /* or the file would be as good with zeros */
  if (IsFirst()) CheckFile(&record);
  assert_true(Exists(PATH));
  assert_false(Exists(PATH ".part"));
  if (IsFirst()) remove(PATH);
}

/* Some records at a time, with the file read in between as another program would */
static PetscErrorCode ReadNowAndThen(Controller controller, const ControllerFrame *frame, void *ctx)
{
  History *history = (History *)((void **)ctx)[0];
  Record  *record  = (Record *)((void **)ctx)[1];

  PetscFunctionBegin;
  (void)controller;
  if (frame->step == 0 && IsFirst()) CheckFile(record); /* the first record is written at once */
  if (frame->step == 3 || frame->step == 4 || frame->step == 8) {
    PetscCall(HistoryFlush(*history));
    if (IsFirst()) {
      CheckFile(record);
      assert_int_not_equal(access(PATH ".part", F_OK), 0);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void file_is_whole_after_each_flush(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  History     history;
  Record      record;
  void       *both[] = {&history, &record};

  CreateRun(simulation, &history, &record);
  ok(ControllerMonitorSet(simulation->controller, ReadNowAndThen, both, NULL));
  ok(ControllerSolve(simulation->controller));
  ok(HistoryFlush(history));
  ok(HistoryFlush(history)); /* nothing to add */
  if (IsFirst()) CheckFile(&record);
  ok(HistoryDestroy(&history));
  if (IsFirst()) remove(PATH);
}

/* What stands at the path stays until there is a record to write; directories are made */
static void directories_are_made(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  History     history;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(HistoryCreate(simulation->controller, "new/folder/h.h5", &history));
  assert_true(Exists("new/folder"));
  assert_false(Exists("new/folder/h.h5"));
  assert_false(Exists("new/folder/h.h5.part"));
  ok(HistoryDestroy(&history));
  assert_false(Exists("new/folder/h.h5"));
  if (IsFirst()) assert_int_equal(rmdir("new/folder") || rmdir("new"), 0);
}

/* A file where a directory should be, a directory where the file should be: refused on all ranks, with nothing left behind */
static void paths_that_cannot_be_written(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  History     history;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  if (IsFirst()) {
    FILE *file = fopen("blocker", "w");

    assert_non_null(file);
    fclose(file);
    assert_int_equal(mkdir("folder", 0777), 0);
  }
  refused(PETSC_ERR_FILE_WRITE, "-output_history blocker/h.h5 cannot be written",
          HistoryCreate(simulation->controller, "blocker/h.h5", &history));
  refused(PETSC_ERR_FILE_WRITE, "-output_history folder cannot be written", HistoryCreate(simulation->controller, "folder", &history));
  refused(PETSC_ERR_USER_INPUT, "-output_history needs the path", HistoryCreate(simulation->controller, "", &history));
  assert_false(Exists("folder.part"));
  if (IsFirst()) assert_int_equal(remove("blocker") || rmdir("folder"), 0); /* an rmdir() that works has found it empty */
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(file_of_a_run),
      simulation_test(file_is_whole_after_each_flush),
      simulation_test(directories_are_made),
      simulation_test(paths_that_cannot_be_written),
  };

  return impakt_main(argc, argv, tests);
}
