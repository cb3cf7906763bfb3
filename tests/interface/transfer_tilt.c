/* By how much rows are turned from the surfaces, which have turned since they were built, in two and three dimensions. */
#include "interfaces.h"

static void map_turned_2d(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[1] += 0.1 * X[0];
}

static void map_turned(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[2] += 0.1 * X[0];
}

/* One of the surfaces turns by atan(0.1) after rows were built within wide bounds. If it is that with the nodes of the rows they are tilted
   by that angle, if it is the other not at all; by its share of it where rows count with bends. Built again they are not tilted. */
static void tilts_are_told(void **state)
{
  const PetscReal   angle = PetscAtanReal(0.1), nowhere[3] = {0, 0, 0};
  const char *const faces[2][2] = {{"2,1", "4,1"}, {"2,2,1", "4,4,1"}};
  const PetscBool   quads[2]    = {PETSC_FALSE, PETSC_FALSE};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt variant = 0; variant < 6; variant++) {
      const PetscInt  turned = variant % 2;
      const PetscBool curved = (PetscBool)(variant / 2);
      const PetscReal share  = !curved ? 0 : variant < 4 ? 0.5 : 1;
      const PetscReal tilt   = angle * (turned ? share : 1 - share);
      PetscReal      *tilts;
      Interface       interface;

      interface_create(&interface, dim, faces[dim - 2], quads, PETSC_FALSE);
      ok(TransferSetCurved(interface.transfer, curved));
      ok(TransferSetNormalShare(interface.transfer, share));
      ok(TransferSetBounds(interface.transfer, 0.025, 1));
      for (PetscInt side = 0; side < 2; side++) move_mesh(interface.dm[side], map_nothing, nowhere, interface.u[side]);
      assert_true(interface_update(&interface, PETSC_MAX_REAL, 1));
      ok(PetscMalloc1(interface.rows.n, &tilts));
      move_mesh(interface.dm[turned], dim == 2 ? map_turned_2d : map_turned, nowhere, interface.u[turned]);
      ok(SurfaceUpdate(interface.surface[turned], interface.u[turned]));
      ok(TransferGetTilts(interface.transfer, tilts));
      for (PetscInt i = 0; i < interface.rows.n; i++) near(tilts[i], tilt, 1e-12); /* of sums of some unit vectors */
      ok(TransferSetBounds(interface.transfer, 0, 0));
      assert_true(interface_update(&interface, PETSC_MAX_REAL, 1));
      ok(TransferGetTilts(interface.transfer, tilts));
      for (PetscInt i = 0; i < interface.rows.n; i++) near(tilts[i], 0, 1e-12);
      ok(PetscFree(tilts));
      interface_destroy(&interface);
    }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(tilts_are_told),
  };

  return impakt_main(argc, argv, tests);
}
