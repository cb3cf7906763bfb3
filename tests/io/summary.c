/* The summary: its keys, its numbers, and paths that are refused. */
#define _POSIX_C_SOURCE 200809L
#include "simulation.h"
#include <jansson.h>
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

static const char *const keys[] = {
    "contact.first_contact_time",
    "contact.release_time",
    "contact.onset_time",
    "contact.separation_time",
    "contact.onsets",
    "contact.steps_in_contact",
    "contact.force_mean",
    "contact.force_std",
    "contact.force_peak",
    "contact.impulse",
    "contact.max_penetration",
    "contact.overlap_unfelt",
    "contact.gap_final",
    "schwarz.max",
    "schwarz.mean_all_steps",
    "schwarz.mean_contact_steps",
    "schwarz.unconverged_steps",
    "schwarz.limited_steps",
    "schwarz.unlimited_steps",
    "schwarz.energy_attempts",
    "schwarz.inner_iterations",
    "schwarz.rebuilds",
    "step_control.step_cuts",
    "step_control.steps_cut",
    "step_control.smallest_step",
    "step_control.lossy_steps",
    "bodies.left.dofs",
    "bodies.left.mass.total",
    "bodies.left.mass.factor_min",
    "bodies.left.mass.factor_max",
    "bodies.left.mass.inertia_error",
    "bodies.left.kinetic",
    "bodies.left.potential",
    "bodies.left.peak_potential",
    "bodies.left.total_energy_error_min",
    "bodies.left.total_energy_error_max",
    "bodies.left.substeps",
    "bodies.right.dofs",
    "bodies.right.mass.total",
    "bodies.right.mass.factor_min",
    "bodies.right.mass.factor_max",
    "bodies.right.mass.inertia_error",
    "bodies.right.kinetic",
    "bodies.right.potential",
    "bodies.right.peak_potential",
    "bodies.right.total_energy_error_min",
    "bodies.right.total_energy_error_max",
    "bodies.right.substeps",
    "system.energy_error_min",
    "system.energy_error_max",
    "system.energy_error_final",
    "system.momentum_error_max",
    "timing.wall",
};

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
  for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++) Number(root, keys[i]);
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

static const char *const errors[] = {
    "errors.contact_position",
    "errors.contact_velocity",
    "errors.contact_force",
    "errors.kinetic",
    "errors.potential",
    "errors.mean_velocity",
    "errors.peak_potential",
    "errors.release_time",
    "errors.bodies.left.kinetic",
    "errors.bodies.left.potential",
    "errors.bodies.left.mean_velocity",
    "errors.bodies.left.kinetic_max",
    "errors.bodies.left.potential_max",
    "errors.bodies.right.kinetic",
    "errors.bodies.right.potential",
    "errors.bodies.right.mean_velocity",
    "errors.bodies.right.kinetic_max",
    "errors.bodies.right.potential_max",
};

/* Both kinds are the same solution for these bars, and so give the same errors, to the round-off of times */
static void errors_against_the_exact_solution(void **state)
{
  const char *const options[]  = {"-exact impact", "-exact characteristics"};
  const PetscInt    n          = (PetscInt)PETSC_STATIC_ARRAY_LENGTH(errors);
  Simulation       *simulation = (Simulation *)*state;
  PetscReal         values[2][PETSC_STATIC_ARRAY_LENGTH(errors)];

  AddWholeImpact();
  for (PetscInt kind = 0; kind < 2; kind++) {
    Run(simulation, options[kind]);
    MPI_Barrier(PETSC_COMM_WORLD);
    if (IsFirst()) {
      json_t *root = Load();

      for (PetscInt i = 0; i < n; i++) values[kind][i] = Number(root, errors[i]);
      near(Number(root, "errors.bodies.left.kinetic"), Number(root, "errors.kinetic"), 0);
      json_decref(root);
      remove(PATH);
    }
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  if (IsFirst())
    for (PetscInt i = 0; i < n; i++) near(values[1][i], values[0][i], 1e-10);
}

/* Bars that never touch: what does not exist is null, and what is counted is zero */
static void without_contact(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  json_t     *root;

  AddWholeImpact();
  Run(simulation, "-left_initial_velocity -0.1 -right_initial_velocity 0.1");
  MPI_Barrier(PETSC_COMM_WORLD);
  if (!IsFirst()) return;
  root = Load();
  assert_true(json_is_null(Find(root, "contact.first_contact_time")));
  assert_true(json_is_null(Find(root, "contact.release_time")));
  assert_true(json_is_null(Find(root, "contact.force_mean")));
  near(Number(root, "contact.onsets"), 0, 0);
  near(Number(root, "contact.impulse"), 0, 0);
  near(Number(root, "contact.max_penetration"), 0, 0);
  near(Number(root, "schwarz.max"), 0, 0);
  near(Number(root, "system.energy_error_max"), 0, 1e-13); /* round-off of 20 free steps */
  json_decref(root);
  remove(PATH);
}

/* Two pairs: each has its own figures beside those of all */
static void figures_of_each_pair(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  json_t     *root;

  AddWholeImpact();
  AddBar("third", 0.2, 0.3, 4, 0);
  Run(simulation, "-bodies left,right,third -contact_pairs left:right,right:third");
  MPI_Barrier(PETSC_COMM_WORLD);
  if (!IsFirst()) return;
  root = Load();
  near(Number(root, "pairs.left:right.onsets"), Number(root, "contact.onsets"), 0);
  near(Number(root, "pairs.right:third.onsets"), 0, 0); /* 0.1 m off: 1 s away */
  near(Number(root, "bodies.third.kinetic"), 0, 0);
  json_decref(root);
  remove(PATH);
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(keys_and_numbers),     simulation_test(errors_against_the_exact_solution),
      simulation_test(without_contact),      simulation_test(figures_of_each_pair),
      simulation_test(impulse_of_cut_steps), simulation_test(paths_that_cannot_be_written),
  };

  return impakt_main(argc, argv, tests);
}
