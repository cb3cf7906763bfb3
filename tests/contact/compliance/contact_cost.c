/* What a changing active set costs: no factorisation. */
/* ranks: 1 */
#include "simulation.h"

#define BLOCK "-dm_plex_dim 2 -dm_plex_simplex 0 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 "

static int factorisations(void)
{
  static const char *const names[] = {"MatLUFactorNum", "MatCholFctrNum"};
  int                      sum     = 0;
  PetscInt                 n_stages;
  PetscLogState            state;

  ok(PetscLogGetState(&state));
  ok(PetscLogStateGetNumStages(state, &n_stages));
  for (int i = 0; i < 2; i++) {
    PetscEventPerfInfo info;
    PetscLogEvent      event;

    ok(PetscLogEventGetId(names[i], &event));
    if (event < 0) continue;
    for (PetscLogStage stage = 0; stage < n_stages; stage++) {
      ok(PetscLogEventGetPerfInfo(stage, event, &info));
      sum += info.count;
    }
  }
  return sum;
}

static const char *const ways[]        = {"-schwarz_condense 1", "-schwarz_condense 0", "-schwarz_condense auto -schwarz_dense_limit 0"};
static const char *const integrators[] = {"-a_ts_type alpha2", "-a_ts_type centraldifference"};

/* A block rolls over a disc: nodes come into contact and leave it, one after the other */
static void a_changing_set_factors_nothing(void **state)
{
  Simulation *simulation = (Simulation *)*state;

  AddOptions("-prefix_push a_ " BLOCK
             "-dm_plex_box_faces 12,4 -dm_plex_box_lower 0,0.01 -dm_plex_box_upper 2,0.61 -initial_velocity 0.02,-0.1-0.05*x -prefix_pop "
             "-bodies a -obstacles disc -disc_obstacle_type cylinder -disc_point 0.7,-3 -disc_radius 3 -time_step 0.02 -time_end 4");
  for (size_t way = 0; way < sizeof(ways) / sizeof(ways[0]); way++)
    for (size_t i = 0; i < 2; i++) {
      ContactCounts counts;
      PetscInt      most = 0, least_after = 100, changes = 0, last = 0;
      int           before;

      AddOptions(integrators[i]);
      SimulationRepeat(simulation, ways[way]);
      before = factorisations();
      for (PetscInt step = 0; step < 100; step++) {
        const ContactPairState pair = Step(simulation);

        changes += pair.active != last;
        last = pair.active;
        most = PetscMax(most, pair.active);
        if (most > 2) least_after = PetscMin(least_after, pair.active);
      }
      ok(ContactGetCounts(simulation->contact, &counts));
      assert_true(most >= 3 && changes >= 4);
      assert_true(least_after < most);
      assert_int_equal(factorisations() - before, 0);
    }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(a_changing_set_factors_nothing),
  };

  return impakt_main_logged(argc, argv, tests);
}
