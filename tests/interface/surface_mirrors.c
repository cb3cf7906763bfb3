/* long: 3 */
/* Normals of nodes in planes of symmetry. */
#include "interfaces.h"

static const PetscReal nowhere[3] = {0, 0, 0};

/* All normals are tilted along x by atan(0.1) */
static void map_slope_2d(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[1] += 0.1 * X[0];
}

static void map_slope(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[2] += 0.1 * X[0];
}

/* Nodes at x = 0 are held along x, as those beside them; those at x = 1 along all axes. The normals of the first stay in the plane x = 0,
   where the surface ends: the second lie inside of it, and the third are clamped. Without held displacements all are as before. */
static void normals_stay_in_planes_of_symmetry(void **state)
{
  const char *const faces[2][2] = {{"4,1", "2,1"}, {"4,4,1", "2,2,1"}};
  const PetscBool   quads[2]    = {PETSC_FALSE, PETSC_FALSE};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++) {
    const SurfaceData *data;
    PetscInt          *dofs, n = 0, first, in_planes = 0;
    Interface          interface;

    interface_create(&interface, dim, faces[dim - 2], quads, PETSC_FALSE);
    ok(SurfaceGetData(interface.surface[0], &data));
    ok(VecGetOwnershipRange(interface.u[0], &first, NULL));
    ok(PetscMalloc1(dim * data->n_owned, &dofs));
    for (PetscInt i = 0; i < data->n_owned; i++)
      for (PetscInt d = 0; d < dim; d++)
        if ((d == 0 && data->reference[3 * i] < 0.3) || data->reference[3 * i] > 0.9) dofs[n++] = data->dofs[i] + d - first;
    ok(PetscSortInt(n, dofs));
    move_mesh(interface.dm[0], dim == 2 ? map_slope_2d : map_slope, nowhere, interface.u[0]);
    for (PetscInt held = 1; held >= 0; held--) {
      ok(SurfaceSetMirrors(interface.surface[0], held ? n : 0, dofs, first));
      ok(SurfaceUpdate(interface.surface[0], interface.u[0]));
      for (PetscInt i = 0; i < data->n_nodes; i++) {
        const PetscBool in_plane = (PetscBool)(held && data->reference[3 * i] < 1e-9);

        near(data->normals[3 * i], in_plane ? 0 : -0.1 / PetscSqrtReal(1.01), 1e-14);
        near(data->normals[3 * i + dim - 1], in_plane ? 1 : 1 / PetscSqrtReal(1.01), 1e-14);
        if (in_plane && i < data->n_owned) in_planes++;
      }
    }
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &in_planes, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
    assert_int_equal(in_planes, dim == 2 ? 1 : 5);
    ok(PetscFree(dofs));
    interface_destroy(&interface);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(normals_stay_in_planes_of_symmetry),
  };

  return impakt_main(argc, argv, tests);
}
