/* Meshes that some ranks have among them, and others nothing of. */
#include "meshes.h"

typedef struct {
  PetscMPIInt n, list[3];
} Set;

/* The sets of ranks that are tried: each alone, the first and the last, all but the first, all */
static PetscInt Sets(Set sets[6])
{
  const PetscMPIInt size = size_of_world();
  PetscInt          n    = 0;

  assert_in_range(size, 1, 3);
  for (PetscMPIInt r = 0; r < size; r++) sets[n++] = (Set){1, {r}};
  if (size == 3) sets[n++] = (Set){2, {0, 2}};
  if (size == 3) sets[n++] = (Set){2, {1, 2}};
  sets[n++] = (Set){size, {0, 1, 2}};
  return n;
}

static PetscBool Has(const Set *set, PetscMPIInt rank)
{
  for (PetscMPIInt i = 0; i < set->n; i++)
    if (set->list[i] == rank) return PETSC_TRUE;
  return PETSC_FALSE;
}

static DM CreateOn(const Set *set, const char text[])
{
  PetscOptions options = options_begin("-prefix_push a_ %s -prefix_pop", text);
  DM           dm;

  ok(MeshCreateOnRanks(PETSC_COMM_WORLD, "a_", "box", set ? set->n : 0, set ? set->list : NULL, &dm));
  options_end(options);
  return dm;
}

static PetscInt CellsHere(DM dm)
{
  PetscInt start, end;

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  return end - start;
}

/* Volume of the cells of this rank, times the squared distances of their centres from a point: it tells which they are */
static PetscReal MomentHere(DM dm)
{
  PetscInt  start, end, dim;
  PetscReal sum = 0;

  ok(DMGetCoordinateDim(dm, &dim));
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  for (PetscInt c = start; c < end; c++) {
    PetscReal volume, centre[3];

    ok(DMPlexComputeCellGeometryFVM(dm, c, &volume, centre, NULL));
    for (PetscInt d = 0; d < dim; d++) sum += volume * PetscSqr(centre[d] - 3 * (d + 1));
  }
  return sum;
}

/* Options, and a surface of the mesh */
static const char *const sources[][2] = {
    {"-dm_plex_dim 1 -dm_plex_box_faces 11", "xmax"},
    {"-dm_plex_dim 2 -dm_plex_box_faces 6,7", "ymin"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 6,4,5", "xmax"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 6,4,5 -mesh_division graph", "zmin"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 6,4,5 -petscpartitioner_type simple", "zmin"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 4,4,4 -dm_refine 1", "zmin"},
    {"-dm_plex_dim 2 -dm_plex_box_faces 6,7 -dm_plex_simplex 1", "ymax"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 4,3,5 -dm_plex_simplex 1", "ymin"},
    {"-dm_plex_dim 3 -dm_plex_box_faces 3,3,9 -dm_plex_simplex 1 -mesh_contact_surfaces zmax", "zmax"},
    {"-dm_plex_dim 2 -dm_plex_shape ball -ball_divisions 4", "surface"},
    {"-dm_plex_dim 3 -dm_plex_shape ball -ball_divisions 2 -dm_plex_simplex 1", "back"},
    {"-dm_plex_dim 3 -dm_plex_shape ball -ball_divisions 2 -dm_plex_simplex 1 -element_formulation composite", "surface"},
    {"-dm_plex_shape rod -rod_divisions 2 -rod_elements 6", "zmax"},
    {"-dm_plex_shape rod -rod_divisions 2 -rod_elements 4 -dm_plex_simplex 1 -element_formulation composite", "zmin"},
};

/* The same mesh whoever has it: cells, vertices, volume, a surface; ranks beside the set have no cell, those of it have all a share */
static void sets_have_all(void **state)
{
  Set sets[6];

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(sources); i++) {
    DM                 all = CreateOn(NULL, sources[i][0]);
    const PetscInt     n = Sets(sets), cells = count_cells(all), vertices = count_vertices(all);
    const PetscReal    volume = volume_of(all), moment = sum_of_ranks(MomentHere(all));
    const SurfaceFacts wanted = surface_facts(all, sources[i][1]);

    for (PetscInt s = 0; s < n; s++) {
      DM                 dm    = CreateOn(&sets[s], sources[i][0]);
      const SurfaceFacts facts = surface_facts(dm, sources[i][1]);

      ok(DMPlexCheckSymmetry(dm));
      ok(DMPlexCheckFaces(dm, 0));
      ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
      ok(DMPlexCheckInterfaceCones(dm));
      assert_int_equal(count_cells(dm), cells);
      assert_int_equal(count_vertices(dm), vertices);
      if (!Has(&sets[s], rank_of_world())) assert_int_equal(CellsHere(dm), 0);
      else assert_true(2 * sets[s].n * CellsHere(dm) > cells); /* half the mean at least */
      near(volume_of(dm), volume, 1e-13 * volume);             /* round-off of sums */
      near(sum_of_ranks(MomentHere(dm)), moment, 1e-12 * moment);
      assert_int_equal(facts.n, wanted.n);
      near(facts.area, wanted.area, 1e-13 * cells);
      for (PetscInt d = 0; d < 3; d++) near(facts.centre[d], wanted.centre[d], 1e-12);
      ok(DMDestroy(&dm));
    }
    ok(DMDestroy(&all));
  }
}

/* The set of all ranks is the division that there is without one, cell by cell, and what is divided among two ranks is the same parts
   whichever two these are */
static void parts_hang_on_their_number(void **state)
{
  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(sources); i++) {
    const Set everyone = {size_of_world(), {0, 1, 2}}, pairs[2] = {{2, {0, 2}}, {2, {1, 2}}};
    DM        all = CreateOn(NULL, sources[i][0]), dm = CreateOn(&everyone, sources[i][0]);
    PetscReal of[2][3] = {{0}};

    assert_int_equal(CellsHere(dm), CellsHere(all));
    assert_true(MomentHere(dm) == MomentHere(all));
    ok(DMDestroy(&all));
    ok(DMDestroy(&dm));
    for (PetscInt p = 0; p < 2 && size_of_world() == 3; p++) {
      dm                     = CreateOn(&pairs[p], sources[i][0]);
      of[p][rank_of_world()] = MomentHere(dm);
      ok(DMDestroy(&dm));
      assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, of[p], 3, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
    }
    assert_true(of[0][0] == of[1][1] && of[0][2] == of[1][2]);
  }
}

/* Faces that may touch another body are spread over the ranks of the set: half of 36, and of 72 to the three that the bisection may miss */
static void contact_faces_are_spread(void **state)
{
  const char *const bars[] = {
      "-dm_plex_dim 3 -dm_plex_box_faces 6,6,18 -mesh_contact_surfaces zmax",
      "-dm_plex_dim 3 -dm_plex_box_faces 6,6,18 -dm_plex_simplex 1 -dm_plex_box_upper 1,1,3 -mesh_contact_surfaces zmax"};
  const Set set = {2, {0, 2}};

  (void)state;
  if (size_of_world() < 3) return;
  for (PetscInt i = 0; i < 2; i++) {
    DM        dm = CreateOn(&set, bars[i]);
    PetscInt  n, *faces;
    PetscReal most;

    ok(MeshGetSurface(dm, "zmax", &n, &faces));
    ok(PetscFree(faces));
    most = n;
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD), 0);
    assert_true(i ? most <= 39 : most == 18);
    ok(DMDestroy(&dm));
  }
}

/* Bricks of a given number along each axis go to the ranks of the set in their order */
static void given_bricks(void **state)
{
  const PetscMPIInt last = size_of_world() - 1;
  const Set         set  = last == 2 ? (Set){2, {0, 2}} : (Set){1, {last}};
  DM                dm   = CreateOn(&set, last == 2 ? "-dm_plex_dim 2 -dm_plex_box_faces 3,8 -mesh_bricks 1,2"
                                                    : "-dm_plex_dim 2 -dm_plex_box_faces 3,8 -mesh_bricks 1,1");
  PetscReal         lower[3], upper[3];

  (void)state;
  assert_int_equal(CellsHere(dm), Has(&set, rank_of_world()) ? 24 / set.n : 0);
  if (set.n == 2 && CellsHere(dm)) {
    ok(DMGetLocalBoundingBox(dm, lower, upper));
    near(lower[1], rank_of_world() ? 0.5 : 0, 1e-15);
    near(upper[1], rank_of_world() ? 1 : 0.5, 1e-15);
  }
  ok(DMDestroy(&dm));
}

/* Fewer cells than ranks of the set: a rank of it has none either */
static void fewer_cells_than_ranks(void **state)
{
  const char *const one[] = {"-dm_plex_dim 2 -dm_plex_box_faces 1,1 -mesh_division bricks",
                             "-dm_plex_dim 2 -dm_plex_box_faces 1,1 -mesh_division graph"};
  const Set         set   = {2, {1, 2}};

  (void)state;
  if (size_of_world() < 3) return;
  for (PetscInt i = 0; i < 2; i++) {
    DM dm = CreateOn(&set, one[i]);

    assert_int_equal(count_cells(dm), 1);
    if (!rank_of_world()) assert_int_equal(CellsHere(dm), 0);
    near(volume_of(dm), 1, 1e-15);
    ok(DMDestroy(&dm));
  }
}

static void Refused(const Set *set, PetscErrorCode code, const char words[], const char text[])
{
  PetscOptions options = options_begin("-prefix_push a_ %s -prefix_pop", text);
  DM           dm      = NULL;

  refused(code, words, MeshCreateOnRanks(PETSC_COMM_WORLD, "a_", "box", set->n, set->list, &dm));
  ok(DMDestroy(&dm));
  options_drop(options);
}

static void bad_sets(void **state)
{
  const PetscMPIInt last = size_of_world() - 1;
  const Set         none = {1, {last + 1}}, negative = {1, {-1}}, twice = {2, {0, 0}}, descending = {2, {last, 0}}, first = {1, {0}};
  const Set         two   = {2, {0, last}};
  const char        box[] = "-dm_plex_dim 2 -dm_plex_box_faces 4,4";

  (void)state;
  Refused(&none, PETSC_ERR_ARG_OUTOFRANGE, "ascending|from 0 to", box);
  Refused(&negative, PETSC_ERR_ARG_OUTOFRANGE, "ascending|-1", box);
  Refused(&twice, PETSC_ERR_ARG_OUTOFRANGE, "ascending", box);
  Refused(&descending, PETSC_ERR_ARG_OUTOFRANGE, "ascending", box);
  Refused(&first, PETSC_ERR_USER_INPUT, "-a_dm_distribute|-a_ranks", "-dm_plex_dim 2 -dm_distribute 1");
  Refused(&first, PETSC_ERR_USER_INPUT, "-a_dm_distribute_overlap|-a_ranks", "-dm_plex_dim 2 -dm_distribute_overlap 1");
  Refused(&first, PETSC_ERR_USER_INPUT, "-a_mesh_bricks|2 bricks|axis 1", "-dm_plex_dim 2 -mesh_bricks 2,1");
  if (!last) return;
  Refused(&two, PETSC_ERR_USER_INPUT, "-a_mesh_division whole|-a_ranks names 2", "-dm_plex_dim 2 -mesh_division whole");
  Refused(&two, PETSC_ERR_USER_INPUT, "-a_mesh_bricks|1 bricks|product", "-dm_plex_dim 2 -mesh_bricks 1,1");
  Refused(&two, PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'nowhere'", "-dm_plex_dim 2 -mesh_contact_surfaces nowhere");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sets_have_all), cmocka_unit_test(parts_hang_on_their_number), cmocka_unit_test(contact_faces_are_spread),
      cmocka_unit_test(given_bricks),  cmocka_unit_test(fewer_cells_than_ranks),     cmocka_unit_test(bad_sets),
  };

  return impakt_main(argc, argv, tests);
}
