/* Meshes that the first rank has and that are divided so that contact faces lie on all ranks. */
#include "meshes.h"

/* Cells, and faces of a surface, on the rank that has most of them */
static void CountMost(DM dm, const char surface[], PetscInt most[2])
{
  PetscInt  start, end, n, *faces;
  PetscReal counts[2];

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  ok(MeshGetSurface(dm, surface, &n, &faces));
  ok(PetscFree(faces));
  counts[0] = (PetscReal)(end - start);
  counts[1] = (PetscReal)n;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD), 0);
  for (PetscInt i = 0; i < 2; i++) most[i] = (PetscInt)counts[i];
}

static void CheckMesh(DM dm, PetscInt n_cells, PetscReal volume)
{
  ok(DMPlexCheckSymmetry(dm));
  ok(DMPlexCheckFaces(dm, 0));
  ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
  assert_int_equal(count_cells(dm), n_cells);
  near(volume_of(dm), volume, 1e-13 * n_cells);
}

/* Tetrahedra of a bar that touches something with one end: 72 faces there, all of them on one rank where the bar is cut across its axis. A
   column of cells has 12 faces there, and the halves need not be columns, since triangles are cut by their centres. */
static void faces_of_a_bar_are_spread(void **state)
{
  const char *const ways[] = {"-mesh_contact_surfaces zmax", "-mesh_contact_surfaces 2",
                              "-mesh_contact_surfaces zmax -mesh_contact_cost 0"};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(ways); i++) {
    DM       dm = create_mesh("-dm_plex_dim 3 -dm_plex_simplex 1 -dm_plex_box_faces 6,6,18 -dm_plex_box_upper 1,1,3 %s", ways[i]);
    PetscInt most[2];

    CheckMesh(dm, 6 * 648, 3);
    CountMost(dm, "zmax", most);
    if (i < 2) {
      assert_int_equal(most[0], 6 * 648 / size_of_world());
      assert_true(most[1] <= 72 / size_of_world() + 3);
    } else assert_true(size_of_world() == 1 || most[1] > 72 / size_of_world() + 3);
    ok(DMDestroy(&dm));
  }
}

/* An option of the partitioner has the last word: this one leaves all cells to the first rank */
static void options_go_first(void **state)
{
  DM dm = create_mesh(
      "-dm_plex_dim 3 -dm_plex_simplex 1 -dm_plex_box_faces 2,2,6 -mesh_contact_surfaces zmax -petscpartitioner_type gather");
  PetscInt start, end;

  (void)state;
  CheckMesh(dm, 6 * 24, 1);
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  assert_int_equal(end - start, rank_of_world() ? 0 : 6 * 24);
  ok(DMDestroy(&dm));
}

/* All around a ball normals look everywhere: it is divided as a graph, and so are cells fewer than ranks */
static void others_are_graphs(void **state)
{
  const char *const ways[]  = {"-dm_plex_shape ball -ball_divisions 2 -mesh_contact_surfaces surface",
                               "-dm_plex_shape box -dm_plex_simplex 1 -dm_plex_box_faces 1,1 -mesh_contact_surfaces xmin"};
  const PetscInt    cells[] = {12, 2};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(ways); i++) {
    DM dm = create_mesh("-dm_plex_dim 2 %s", ways[i]);

    assert_int_equal(count_cells(dm), cells[i]);
    ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
    ok(DMDestroy(&dm));
  }
}

/* A surface that there is not, a name of PETSc's own labels among them, is named, on any number of ranks and on any mesh */
static void surfaces_must_be_there(void **state)
{
  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'nowhere'|-contact_pairs",
               "-dm_plex_dim 2 -dm_plex_shape ball -ball_divisions 2 -mesh_contact_surfaces surface,nowhere");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface '7'", "-dm_plex_dim 2 -mesh_contact_surfaces 7");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'depth'", "-dm_plex_dim 3 -mesh_contact_surfaces zmax,depth");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(faces_of_a_bar_are_spread),
      cmocka_unit_test(options_go_first),
      cmocka_unit_test(others_are_graphs),
      cmocka_unit_test(surfaces_must_be_there),
  };

  return impakt_main(argc, argv, tests);
}
