/* Option hygiene: an option that nobody has read is refused, with the nearest known one. */
#include "simulation.h"

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

/* A body's options belong to bodies that there are */
static void options_of_other_bodies_are_refused(void **state)
{
  (void)state;
  AddOptions("-middle_density 1");
  refused(PETSC_ERR_USER_INPUT, "-middle_density", ImpaktCheckOptions(2, names));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(read_options_pass),
      simulation_test(late_options_pass),
      simulation_test(misspelt_options_are_refused),
      simulation_test(all_unread_options_are_named),
      simulation_test(options_without_effect_are_refused),
      simulation_test(options_of_other_bodies_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
