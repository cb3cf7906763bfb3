/* ranks: 1 3 */
/* Output: numbers of the summary, what energy errors are relative to, paths that are refused, and files that a program asks for without
   options. What histories and fields hold: test_output.py, test_fields.py. */
#define _POSIX_C_SOURCE 200809L
#include "simulation.h"
#include <controller/energyscale.h>
#include <io/fields.h>
#include <io/history.h>
#include <io/statisticstypes.h>
#include <jansson.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH "summary.json"

static PetscBool IsFirst(void)
{
  PetscMPIInt rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return (PetscBool)!rank;
}

/* Runs all of it, with the summary as the only file */
static void Run(Simulation *simulation, const char options[])
{
  Output output;

  AddOptions("-output_summary " PATH);
  SimulationRepeat(simulation, options);
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetFromOptions(output));
  ok(ControllerSolve(simulation->controller));
  ok(OutputReport(output));
  ok(OutputDestroy(&output));
  assert_null(output);
}

/* "a.b.c" */
static json_t *Find(json_t *root, const char path[])
{
  char    copy[256], *key, *rest = copy;
  json_t *value = root;

  snprintf(copy, sizeof(copy), "%s", path);
  while (value && (key = strtok_r(rest, ".", &rest))) value = json_object_get(value, key);
  if (!value) print_error("the summary has no %s\n", path);
  assert_non_null(value);
  return value;
}

static double Number(json_t *root, const char path[])
{
  json_t *value = Find(root, path);

  if (!json_is_number(value)) print_error("%s is not a number\n", path);
  assert_true(json_is_number(value));
  return json_number_value(value);
}

static json_t *Load(void)
{
  json_error_t error;
  json_t      *root = json_load_file(PATH, JSON_REJECT_DUPLICATES, &error);

  if (!root) print_error("%s\n", error.text);
  assert_non_null(root);
  assert_int_not_equal(access(PATH ".part", F_OK), 0);
  return root;
}

/* Bars of 0.1 kg that fly at 0.1 m/s against each other, touch in the first step and are apart again before the last one */
static void AddWholeImpact(void)
{
  AddCollision(4, 3, 0);
  AddOptions("-left_dm_plex_box_lower -0.101 -right_dm_plex_box_upper 0.101 -time_end 0.4");
}

static void keys_and_numbers(void **state)
{
  Simulation     *simulation = (Simulation *)*state;
  const PetscReal energy     = 0.5 * 0.1 * COLLISION_SPEED * COLLISION_SPEED; /* of one bar [J] */
  json_t         *root;

  AddWholeImpact();
  Run(simulation, "-controller_step_cuts 0"); /* sweeps are counted by whole steps below */
  MPI_Barrier(PETSC_COMM_WORLD);
  if (!IsFirst()) return;
  root = Load();
  assert_string_equal(json_string_value(Find(root, "version")), IMPAKT_VERSION);
  assert_string_equal(json_string_value(Find(root, "contact.type")), "schwarz");
  assert_true(json_is_object(Find(root, "timing.per_phase")));
  assert_null(json_object_get(root, "errors")); /* only with -exact */
  near(Number(root, "pairs.left:right.force_peak"), Number(root, "contact.force_peak"), 0);
  near(Number(root, "pairs.left:right.active_max"), 1, 0);
  near(Number(root, "pairs.left:right.area_max"), 1, 0); /* bars without -cross_section */
  assert_int_equal(json_array_size(Find(root, "pairs.left:right.impulse_vector")), 3);
  /* the same sum in another order */
  near(json_number_value(json_array_get(Find(root, "pairs.left:right.impulse_vector"), 0)), Number(root, "contact.impulse"), 1e-15);
  near(Number(root, "contact.first_contact_time"), COLLISION_STEP, 1e-15);
  between(Number(root, "contact.release_time"), 0.16, 0.26); /* 0.2 s after impact, but for what three elements do to the wave */
  near(Number(root, "contact.onset_time"), 0.5 * COLLISION_STEP, 1e-15); /* the gap of 2 mm closes at 0.2 m/s */
  between(Number(root, "contact.separation_time"), Number(root, "contact.release_time"),
          Number(root, "contact.release_time") + COLLISION_STEP);
  assert_true(json_is_false(Find(root, "contact.in_contact_at_end")));
  near(Number(root, "contact.onsets"), 1, 0);
  /* from the first step to the last one in contact, without a break */
  near(Number(root, "contact.steps_in_contact") * COLLISION_STEP, Number(root, "contact.release_time"), 1e-15);
  assert_true(Number(root, "contact.force_peak") >= Number(root, "contact.force_mean"));
  near(Number(root, "contact.max_penetration"), 0, 1e-12);
  /* The trapezoidal rule over the force is how the integrator changes the momentum, from 0.1 kg 0.1 m/s to what the bar has at the
     end. It gives all of it back, but for the vibration that remains. */
  near(Number(root, "contact.impulse"), 2 * 0.1 * COLLISION_SPEED, 0.1 * 2 * 0.1 * COLLISION_SPEED);
  near(Number(root, "bodies.left.dofs"), 5, 0);
  near(Number(root, "bodies.right.dofs"), 4, 0);
  assert_true(Number(root, "bodies.left.substeps") >= 20); /* one to each of the 20 steps, and more in sweeps */
  near(Number(root, "bodies.left.kinetic") + Number(root, "bodies.left.potential"), energy, 0.1 * energy);
  assert_true(Number(root, "bodies.left.peak_potential") > 0.5 * energy);
  assert_true(Number(root, "bodies.left.total_energy_error_min") <= 0);
  near(Number(root, "system.momentum_error_max"), 0, 1e-10); /* of the outer iteration, relative to 0.02 kg m/s */
  between(Number(root, "system.energy_error_final"), Number(root, "system.energy_error_min"), Number(root, "system.energy_error_max"));
  near(Number(root, "schwarz.unconverged_steps"), 0, 0);
  near(Number(root, "schwarz.mean_contact_steps") * Number(root, "contact.steps_in_contact"), Number(root, "timing.per_phase.sweeps.count"),
       3); /* but for the steps of release */
  json_decref(root);
  remove(PATH);
}

/* How many numbers an object has, with those of objects in it */
static int count(json_t *object)
{
  const char *key;
  json_t     *value;
  int         n = 0;

  json_object_foreach(object, key, value) n += json_is_object(value) ? count(value) : json_is_number(value);
  return n;
}

/* All of them are numbers, and those of the bar on the Dirichlet side stand there twice */
static void errors_against_the_exact_solution(void **state)
{
  json_t *root;

  AddWholeImpact();
  Run((Simulation *)*state, "-exact characteristics");
  MPI_Barrier(PETSC_COMM_WORLD);
  if (!IsFirst()) return;
  root = Load();
  remove(PATH);
  assert_int_equal(count(Find(root, "errors")), 18);
  near(Number(root, "errors.bodies.left.kinetic"), Number(root, "errors.kinetic"), 0);
  json_decref(root);
}

/* Refused before anything is computed, with nothing left behind */
static void paths_that_cannot_be_written(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const struct {
    PetscErrorCode code;
    const char    *options, *words;
  } cases[] = {
      {PETSC_ERR_FILE_WRITE, "-output_summary blocker/s.json", "-output_summary blocker/s.json cannot be written"},
      {PETSC_ERR_USER_INPUT, "-output_summary same.out -output_history same.out", "-output_history and -output_summary|same.out"},
      {PETSC_ERR_USER_INPUT, "-output_summary good.json -output_history good.h5 -exact wave", "-exact 'wave'|none impact"},
  };
  Output output;

  if (IsFirst()) {
    FILE *file = fopen("blocker", "w");

    assert_non_null(file);
    fclose(file);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  AddWholeImpact();
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    SimulationRepeat(simulation, cases[i].options);
    ok(OutputCreate(simulation->controller, &output));
    refused(cases[i].code, cases[i].words, OutputSetFromOptions(output));
    ok(OutputDestroy(&output));
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  assert_int_not_equal(access("same.out", F_OK), 0);
  assert_int_not_equal(access("good.json", F_OK), 0);
  assert_int_not_equal(access("good.h5", F_OK), 0);
  assert_int_not_equal(access("good.h5.part", F_OK), 0);
  if (IsFirst()) remove("blocker");
}

/* The impulse has the forces at the ends of cut steps in it, and so is what the momentum of the bar on the right has changed by */
static void impulse_of_cut_steps(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  json_t     *root;
  PetscReal   change;

  AddWholeImpact();
  SimulationRepeat(simulation, "");
  change = -Momentum(simulation, 1);
  Run(simulation, "");
  change += Momentum(simulation, 1);
  MPI_Barrier(PETSC_COMM_WORLD);
  if (!IsFirst()) return;
  root = Load();
  assert_true(Number(root, "step_control.step_cuts") > 0);
  near(Number(root, "contact.impulse"), change, 1e-12 * change);
  near(json_number_value(json_array_get(Find(root, "pairs.left:right.impulse_vector"), 0)), change, 1e-12 * change);
  json_decref(root);
  remove(PATH);
}

/* Tells the statistics of a state in which each body has so much kinetic energy and work of loads; `scale`: zeros before the first */
static void report_state(Simulation *simulation, Statistics statistics, EnergyScale *scale, PetscInt step, PetscReal kinetic,
                         PetscReal work)
{
  BodyMeasures    *bodies;
  PetscReal       *velocities;
  ContactPairState pair  = {.gap = 1};
  ControllerFrame  frame = {.step = step, .steps = 2, .time = step, .n_bodies = simulation->n_bodies, .n_pairs = 1, .pairs = &pair};

  ok(PetscCalloc2(simulation->n_bodies, &bodies, 3 * simulation->n_bodies, &velocities));
  for (PetscInt b = 0; b < simulation->n_bodies; b++) {
    ok(BodyGetMeasures(simulation->bodies[b], &bodies[b]));
    if (!step) continue;
    bodies[b].kinetic = bodies[b].kinetic_unstaggered = kinetic;
    bodies[b].external_work                           = work;
  }
  frame.bodies             = bodies;
  frame.contact_velocities = velocities;                 /* bodies that never touch: no time of contact depends on them */
  ok(EnergyScaleAdd(scale, simulation->bodies, &frame)); /* as ControllerNotify() does */
  ok(StatisticsMonitor(simulation->controller, &frame, statistics));
  ok(PetscFree2(bodies, velocities));
}

/* An energy that comes from nowhere is an error of all of it, half of that of each body */
static void is_the_largest_energy_of_bodies_that_move(void **state)
{
  Simulation              *simulation = (Simulation *)*state;
  Statistics               statistics;
  const StatisticsResults *results;
  BodyMeasures             measures;
  EnergyScale              scale = {0};

  AddCollision(4, 4, 0);
  ok(SimulationCreate(simulation));
  ok(BodyGetMeasures(simulation->bodies[0], &measures));
  assert_true(measures.kinetic > 1e-3);
  ok(StatisticsCreate(simulation->controller, &statistics));
  report_state(simulation, statistics, &scale, 0, 0, 0);
  report_state(simulation, statistics, &scale, 1, 5e9 * measures.kinetic, 0);
  report_state(simulation, statistics, &scale, 2, 1e10 * measures.kinetic, 0);
  ok(StatisticsGetResults(statistics, &results));
  near(results->energy_error_max, 1, 1e-9);
  near(results->energy_error_final, 1, 1e-9);
  near(results->bodies[0].energy_error_max, 0.5, 1e-9);
  ok(StatisticsDestroy(&statistics));
}

/* Bars at rest, one of them moved as a whole, which loads set in motion: 10 J of work each, 9 J of them found again, and at last 4 J of 4 J
 */
static void is_the_largest_energy_of_bodies_from_rest(void **state)
{
  Simulation              *simulation = (Simulation *)*state;
  Statistics               statistics;
  const StatisticsResults *results;
  EnergyScale              scale = {0};

  AddCollision(4, 4, 1);
  AddOptions("-left_initial_velocity 0 -right_initial_velocity 1e-17 -left_initial_displacement -100.1");
  ok(SimulationCreate(simulation));
  ok(StatisticsCreate(simulation->controller, &statistics));
  report_state(simulation, statistics, &scale, 0, 0, 0);
  report_state(simulation, statistics, &scale, 1, 9, 10);
  report_state(simulation, statistics, &scale, 2, 4, 4);
  ok(StatisticsGetResults(statistics, &results));
  near(results->energy_error_min, -2. / 20, 1e-12); /* of the work */
  near(results->energy_error_final, 0, 1e-12);
  near(results->bodies[0].energy_error_min, -1. / 20, 1e-12);
  ok(StatisticsDestroy(&statistics));
}

static PetscBool exists(const char path[])
{
  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  return (PetscBool)!access(path, F_OK);
}

static void drop(const char path[])
{
  PetscMPIInt rank;

  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (!rank) assert_int_equal(remove(path), 0);
}

static void files_are_written(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  json_t     *summary;
  Output      output;

  AddCollision(8, 8, 0);
  ok(SimulationCreate(simulation));
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetHistory(output, "setters.h5"));
  ok(OutputSetSummary(output, "setters.json"));
  ok(OutputSetFields(output, "setters-fields.h5", 5, OUTPUT_DOUBLE));
  ok(OutputSetExact(output, EXACT_CHARACTERISTICS));
  ok(OutputSetExactDisplacement(output, simulation->bodies[0], "0.1*t"));
  ok(ControllerSolve(simulation->controller));
  ok(OutputReport(output));
  ok(OutputDestroy(&output));
  summary = json_load_file("setters.json", 0, NULL);
  between(json_real_value(json_object_get(json_object_get(summary, "errors"), "mean_velocity")), 1e-8, 0.1); /* of two coarse bars */
  json_decref(summary);
  assert_true(exists("setters.h5") && exists("setters.json") && exists("setters-fields.h5") && exists("setters-fields.xdmf"));
  drop("setters.h5");
  drop("setters.json");
  drop("setters-fields.h5");
  drop("setters-fields.xdmf");
}

static void each_file_has_a_path_of_its_own(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Output      output;
  Body        other;

  AddCollision(4, 4, 0);
  ok(SimulationCreate(simulation));
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetHistory(output, "same.h5"));
  refused(PETSC_ERR_USER_INPUT, "same file, same.h5", OutputSetSummary(output, "same.h5"));
  refused(PETSC_ERR_USER_INPUT, "same file, same.h5", OutputSetFields(output, "same.h5", 0, OUTPUT_SINGLE));
  refused(PETSC_ERR_ARG_WRONGSTATE, "already|same.h5", OutputSetHistory(output, "other.h5"));
  refused(PETSC_ERR_USER_INPUT, "Unknown -exact 'none'|impact", OutputSetExact(output, "none"));
  ok(OutputSetExact(output, EXACT_IMPACT));
  refused(PETSC_ERR_ARG_WRONGSTATE, "already", OutputSetExact(output, EXACT_IMPACT));
  ok(BodyCreate(PETSC_COMM_WORLD, "stranger", &other));
  refused(PETSC_ERR_ARG_WRONG, "'stranger'|controller's", OutputSetExactDisplacement(output, other, "0"));
  ok(BodyDestroy(&other));
  ok(OutputDestroy(&output));
}

static void paths_of_fields(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Fields      fields;

  AddCollision(4, 3, 0);
  AddOptions("-time_end 400"); /* 20000 steps */
  ok(SimulationCreate(simulation));
  if (IsFirst()) assert_int_equal(mkdir("folder", 0777) || mkdir("other.xdmf", 0777), 0);
#define refuse(code, words, path, interval)                                                                                                \
  do {                                                                                                                                     \
    fields = NULL;                                                                                                                         \
    refused(code, words, FieldsCreate(simulation->controller, path, &(PetscInt){interval}, OUTPUT_SINGLE, &fields));                       \
    ok(FieldsDestroy(&fields));                                                                                                            \
  } while (0)
  MPI_Barrier(PETSC_COMM_WORLD);
  refuse(PETSC_ERR_FILE_WRITE, "-output_fields folder cannot be written", "folder", 0);
  refuse(PETSC_ERR_FILE_WRITE, "-output_fields, beside it, other.xdmf cannot be written", "other.h5", 0);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields needs the path", "", 0);
  refuse(PETSC_ERR_USER_INPUT, "give the path of the HDF5 file", "f.xdmf", 0);
  refuse(PETSC_ERR_USER_INPUT, "a:b.h5|choose another", "a:b.h5", 0);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields_interval -1 must be", "fields.h5", -1);
  refuse(PETSC_ERR_USER_INPUT, "-output_fields_interval 2 makes 10001 frames in this run of 20000 |10000 is the limit; give 3 or more",
         "fields.h5", 2);
  assert_false(exists("fields.h5") || exists("fields.xdmf") || exists("folder.part"));
  ok(FieldsCreate(simulation->controller, "fields.h5", &(PetscInt){3}, OUTPUT_SINGLE, &fields)); /* 6668 frames */
  ok(FieldsDestroy(&fields));
  assert_false(exists("fields.h5")); /* it has seen no frame */
  if (IsFirst()) assert_int_equal(rmdir("folder") || rmdir("other.xdmf"), 0);
}

/* What stands at the path stays until there is a record to write; directories are made */
static void directories_are_made(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  History     history;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  ok(HistoryCreate(simulation->controller, "new/folder/h.h5", &history));
  assert_true(exists("new/folder"));
  assert_false(exists("new/folder/h.h5"));
  assert_false(exists("new/folder/h.h5.part"));
  ok(HistoryDestroy(&history));
  assert_false(exists("new/folder/h.h5"));
  if (IsFirst()) assert_int_equal(rmdir("new/folder") || rmdir("new"), 0);
}

/* A file where a directory should be, a directory where the file should be: refused on all ranks, with nothing left behind */
static void paths_of_histories(void **state)
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
  assert_false(exists("folder.part"));
  if (IsFirst()) assert_int_equal(remove("blocker") || rmdir("folder"), 0); /* an rmdir() that works has found it empty */
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(keys_and_numbers),
      simulation_test(errors_against_the_exact_solution),
      simulation_test(impulse_of_cut_steps),
      simulation_test(paths_that_cannot_be_written),
      simulation_test(is_the_largest_energy_of_bodies_that_move),
      simulation_test(is_the_largest_energy_of_bodies_from_rest),
      simulation_test(files_are_written),
      simulation_test(each_file_has_a_path_of_its_own),
      simulation_test(paths_of_fields),
      simulation_test(directories_are_made),
      simulation_test(paths_of_histories),
  };

  return impakt_main(argc, argv, tests);
}
