/* ranks: 1 2 3 */
/* The order in which bodies are integrated where any will do. */
#include "simulation.h"
#include <contact/parts.h>

#define BODIES 6

/* Boxes in a row, each small enough to lie whole on one rank, with a pair between each two */
static void create_row(Simulation *simulation)
{
  char options[512];

  for (PetscInt b = 0; b < BODIES; b++) {
    ok(PetscSNPrintf(options, sizeof(options),
                     "-prefix_push b%d_ -mesh_division whole -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 3,%d -dm_plex_box_lower "
                     "%d,0 -dm_plex_box_upper "
                     "%d,1 -density 1 -youngs_modulus 1 -ts_type centraldifference "
                     "-prefix_pop",
                     (int)b, (int)(3 + b), (int)b, (int)(b + 1)));
    AddOptions(options);
  }
  AddOptions("-bodies b0,b1,b2,b3,b4,b5 -contact_pairs b0~b1,b1~b2,b2~b3,b3~b4,b4~b5 -time_step 0.01 -time_end 0.1");
  ok(SimulationCreate(simulation));
}

/* Bodies with rows on another rank than their mesh take a word of several ranks, for which each rank waits: they come first, or a rank
   would wait for all that the other does by itself before */
static void bodies_that_wait_come_first(void **state)
{
  Simulation *simulation   = (Simulation *)*state;
  PetscBool   seen[BODIES] = {PETSC_FALSE};
  PetscInt    waiting      = 0;
  PetscMPIInt size;

  create_row(simulation);
  ok(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  for (PetscInt k = 0; k < BODIES; k++) {
    const PetscInt b = simulation->contact->ranks.visits[k];
    PetscMPIInt    rank;
    PetscBool      at_home;

    assert_in_range(b, 0, BODIES - 1);
    assert_false(seen[b]);
    seen[b] = PETSC_TRUE;
    ok(ContactIsAtHome(simulation->contact, b, &rank, &at_home));
    if (at_home) continue;
    assert_int_equal(waiting, k);
    waiting++;
  }
  if (size == 1) assert_int_equal(waiting, 0);
  else assert_in_range(waiting, 1, BODIES - 1);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {simulation_test(bodies_that_wait_come_first)};

  return impakt_main(argc, argv, tests);
}
