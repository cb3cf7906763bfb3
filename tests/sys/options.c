/* Option hygiene: an option that nobody has read is refused, with the nearest known one. Options that bodies share. Lists of names, of any
   length. Every class prints itself where an option asks for it. */
#include "simulation.h"
#include <sys/names.h>

static const char *const names[] = {"left", "right"};

static void read_options_pass(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-contact_type schwarz -schwarz_snes_type anderson -left_mass_type lumped -right_ts_type centraldifference -monitor_interval "
             "0 -progress 0");
  ok(SimulationCreate(simulation));
  ok(ImpaktCheckOptions(2, names));
}

/* PETSC reads these when it ends */
static void late_options_pass(void **state)
{
  (void)state;
  AddOptions("-malloc_dump -malloc_view -options_left -log_view -objects_dump -memory_view");
  ok(ImpaktCheckOptions(2, names));
}

static void misspelt_options_are_refused(void **state)
{
  const struct {
    const char *given, *words;
  } cases[] = {
      {"-left_densty 1", "Unknown option|-left_densty 1|nearest known one is -left_density)"},
      {"-contact_typ penalty", "-contact_typ penalty|nearest known one is -contact_type)"},
      {"-rihgt_youngs_modulus 1", "nearest known one is -right_youngs_modulus)"},
      {"-schwarz_snes_maxit 3", "nearest known one is -schwarz_snes_max_it)"},
      {"-time_stop 3", "nearest known one is -time_step)"},
      {"-output_historie h.h5", "nearest known one is -output_history)"},
  };
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  ok(SimulationCreate(simulation));
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options = options_begin("%s", cases[i].given);

    refused(PETSC_ERR_USER_INPUT, cases[i].words, ImpaktCheckOptions(2, names));
    options_drop(options);
  }
}

/* What a word means counts more than its letters: first of the owner that the option names, then of the run; what it needs stands beside */
static void options_are_suggested_by_meaning(void **state)
{
  const struct {
    const char *given, *words;
  } cases[] = {
      {"-left_velocity 1", "nearest known one is -left_initial_velocity)"},
      {"-velocity 1", "nearest known one is -left_initial_velocity or -all_initial_velocity)"},
      {"-friction 0.3", "nearest known one is -contact_friction, with -contact_law coulomb)"},
      {"-friction 0.3 -contact_law coulomb", "nearest known one is -contact_friction)"},
      {"-dt 1", "nearest known one is -time_step)"},
      {"-left_dt 1", "nearest known one is -left_ts_time_step)"},
      {"-output h.h5", "-output_history or -output_summary or -output_fields)"},
      {"-left_E 1", "nearest known one is -left_youngs_modulus)"},
      {"-left_nu 1", "nearest known one is -left_poissons_ratio)"},
      {"-gravity 1", "nearest known one is -left_gravity or -all_gravity)"},
      {"-right_time_end 1", "nearest known one is -time_end)"},
      {"-floor_v 1 -obstacles floor", "nearest known one is -floor_velocity)"},
      {"-contact_friction 0.3", "-contact_friction 0.3 (needs -contact_law coulomb)"},
      {"-contact_friction_left:right 0.3", "-contact_friction_left:right 0.3 (needs -contact_law coulomb)"},
      {"-contact_augmentation_max_it 3", "-contact_augmentation_max_it 3 (needs -contact_type augmented_lagrangian)"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options = options_begin("%s", cases[i].given);

    refused(PETSC_ERR_USER_INPUT, cases[i].words, ImpaktCheckOptions(2, names));
    options_drop(options);
  }
}

/* An option without a value, and several at once: all are named */
static void all_unread_options_are_named(void **state)
{
  (void)state;
  AddOptions("-progres -left_densty 1");
  refused(PETSC_ERR_USER_INPUT,
          "Unknown options,|-progres (the nearest known one is -progress)|-left_densty 1 (the nearest known one is -left_density)",
          ImpaktCheckOptions(2, names));
}

/* Options of another contact method have no effect, which the user should know */
static void options_without_effect_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-contact_type schwarz -contact_penalty 1e5");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_USER_INPUT, "-contact_penalty 1e5|without effect", ImpaktCheckOptions(2, names));
}

/* -all_ and -material_ give bodies what they do not have themselves, the material before -all_; what only some of them read is no error */
static void shared_options(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  const char *value[4];
  const char *wanted[]  = {"3", "2", "0.25", "0.125"};
  const char *options[] = {"-left_density", "-right_density", "-left_cross_section", "-right_cross_section"};

  AddCollision(4, 3, 0);
  ok(PetscOptionsClearValue(NULL, "-left_density"));
  ok(PetscOptionsClearValue(NULL, "-right_density"));
  AddOptions("-all_material brass -right_material steel -material_brass_density 3 -material_steel_density 2 -all_density 7 "
             "-all_cross_section 0.25 -right_cross_section 0.125 -all_snes_max_it 7 -left_material_type saint_venant_kirchhoff");
  ok(SimulationCreate(simulation));
  for (int i = 0; i < 4; i++) {
    ok(PetscOptionsFindPair(NULL, NULL, options[i], &value[i], NULL));
    assert_string_equal(value[i], wanted[i]);
  }
  ok(ImpaktCheckOptions(2, names));
  near(Momentum(simulation, 0), 3 * 0.25 * (1 - COLLISION_GAP / 2) * COLLISION_SPEED, 1e-14);
  near(Momentum(simulation, 1), -2 * 0.125 * (1 - COLLISION_GAP / 2) * COLLISION_SPEED, 1e-14);
}

static void shared_options_without_effect_are_refused(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddCollision(4, 3, 0);
  AddOptions("-all_thickness 2 -all_densty 3 -right_material steel -material_steel_yield_stress 4 -material_brass_density 5");
  ok(SimulationCreate(simulation));
  refused(PETSC_ERR_USER_INPUT,
          "-all_densty 3 (the nearest known one is -all_density)|-all_thickness 2|-material_steel_yield_stress 4 (needs "
          "-material_steel_material_type j2|"
          "-material_brass_density 5 (no body names this material, as in -left_material brass)",
          ImpaktCheckOptions(2, names));
}

static void names_of_shared_options_are_refused(void **state)
{
  const struct {
    const char *given, *words;
  } cases[] = {
      {"-bodies all", "-bodies: 'all' cannot be a name"},
      {"-bodies material_a", "-bodies: 'material_a' cannot be a name"},
      {"-bodies a -a_material gold -material_steel_density 1", "-a_material gold: there is no material 'gold'|there are: steel"},
      {"-bodies a -all_material gold", "-all_material gold: there is no material 'gold'|there are: none"},
  };
  Simulation *simulation = (Simulation *)*state;

  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options = options_begin("%s", cases[i].given);

    refused(PETSC_ERR_USER_INPUT, cases[i].words, SimulationCreate(simulation));
    ok(ControllerDestroy(&simulation->controller));
    options_drop(options);
  }
}

/* A body's options belong to bodies that there are */
static void options_of_other_bodies_are_refused(void **state)
{
  (void)state;
  AddOptions("-middle_density 1");
  refused(PETSC_ERR_USER_INPUT, "-middle_density", ImpaktCheckOptions(2, names));
}

#define MANY 1000

static void none_and_many(void **state)
{
  char    **names, *list;
  PetscInt  n;
  PetscBool set;

  (void)state;
  ok(NamesRead("x_", "-names", &n, &names, &set));
  assert_int_equal(n, 0);
  assert_false(set);
  assert_null(names);

  ok(PetscMalloc1(8 * MANY, &list));
  list[0] = 0;
  for (PetscInt i = 0; i < MANY; i++) {
    char name[8];

    ok(PetscSNPrintf(name, sizeof(name), "%sn%d", i ? "," : "", (int)i));
    ok(PetscStrlcat(list, name, 8 * MANY));
  }
  ok(PetscOptionsSetValue(NULL, "-x_names", list));
  ok(NamesRead("x_", "-names", &n, &names, &set));
  assert_int_equal(n, MANY);
  assert_true(set);
  assert_string_equal(names[0], "n0");
  assert_string_equal(names[MANY - 1], "n999");
  ok(NamesDestroy(n, &names));
  assert_null(names);
  ok(PetscOptionsClearValue(NULL, "-x_names"));
  ok(PetscFree(list));
}

/* The file that an option has made; removed */
static void expect_file(const char name[], const char words[])
{
  char        text[4096] = "", **word;
  int         n;
  PetscMPIInt rank;
  FILE       *file;

  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (rank) return;
  file = fopen(name, "r");
  if (!file) print_error("%s has not been made\n", name);
  assert_non_null(file);
  text[fread(text, 1, sizeof(text) - 1, file)] = 0;
  assert_int_equal(fclose(file), 0);
  assert_int_equal(remove(name), 0);
  ok(PetscStrToArray(words, '|', &n, &word));
  for (int i = 0; i < n; i++) {
    if (!strstr(text, word[i])) print_error("'%s' is not in %s: %s\n", word[i], name, text);
    assert_non_null(strstr(text, word[i]));
  }
  ok(PetscStrToArrayDestroy(n, word));
}

static void solids(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-bodies top,base -obstacles floor -contact_pairs top:base,base:floor -time_end 1 -time_step 0.1 -contact_law tied "
             "-top_dm_plex_dim 2 -top_dm_plex_box_faces 4,3 -top_dm_plex_box_lower 0,1 -top_dm_plex_box_upper 1,2 -top_density 2 "
             "-top_youngs_modulus 10 -top_thickness 0.5 -top_plane_stress "
             "-base_dm_plex_dim 2 -base_dm_plex_box_faces 6,3 -base_density 3 -base_youngs_modulus 20 -base_poissons_ratio 0.25 "
             "-floor_obstacle_type plane -floor_point 0,0 -floor_normal 0,1");
  AddOptions("-top_body_view ascii:body.txt -top_material_view ascii:material.txt -base_element_view ascii:element.txt "
             "-top_element_view ascii:plate.txt -floor_obstacle_view ascii:obstacle.txt -contact_view ascii:contact.txt "
             "-controller_view ascii:controller.txt");
  ok(SimulationCreate(simulation));
  expect_file("body.txt", "body top|40 degrees of freedom|12 cells of shape quad");
  expect_file("material.txt", "top_|linear_elastic|density 2. kg/m^3, plane stress|Young's modulus 10.");
  expect_file("element.txt", "base_|quad|thickness 1. m, plane strain");
  expect_file("plate.txt", "top_|thickness 0.5 m, plane stress");
  expect_file("obstacle.txt", "obstacle floor: plane at (0., 0., 0.) m, normal (0., 1., 0.)");
  expect_file("contact.txt", "contact schwarz: top:base base:floor|law tied");
  expect_file("controller.txt", "time 0. to 1. s, 10 controller steps|body top|body base|contact schwarz");
  assert_int_equal(simulation->n_bodies, 2);
}

static void bars_and_output(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Output      output;

  AddCollision(4, 4, 0);
  AddOptions("-exact impact -exact_view ascii:exact.txt -output_history views-history.h5 -output_view ascii:output.txt "
             "-left_element_view ascii:bar.txt");
  ok(SimulationCreate(simulation));
  expect_file("bar.txt", "left_|segment|cross-section 1. m^2");
  ok(OutputCreate(simulation->controller, &output));
  ok(OutputSetFromOptions(output));
  expect_file("exact.txt", "exact solution (impact): contact of left and right from 0.01 to");
  expect_file("output.txt", "files|history|views-history.h5");
  ok(OutputDestroy(&output));
}

static void expressions(void **state)
{
  Expression  expression;
  const char *text;

  (void)state;
  ok(ExpressionCreate(PETSC_COMM_WORLD, "speed", "2*x+t", &expression));
  ok(ExpressionGetText(expression, &text));
  assert_string_equal(text, "2*x+t");
  ok(ExpressionDestroy(&expression));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(read_options_pass),
      simulation_test(late_options_pass),
      simulation_test(misspelt_options_are_refused),
      simulation_test(options_are_suggested_by_meaning),
      simulation_test(all_unread_options_are_named),
      simulation_test(options_without_effect_are_refused),
      simulation_test(shared_options),
      simulation_test(shared_options_without_effect_are_refused),
      simulation_test(names_of_shared_options_are_refused),
      simulation_test(options_of_other_bodies_are_refused),
      cmocka_unit_test(none_and_many),
      simulation_test(solids),
      simulation_test(bars_and_output),
      simulation_test(expressions),
  };

  return impakt_main(argc, argv, tests);
}
