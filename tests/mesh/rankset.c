/* ranks: 1 3 */
/* Meshes that some ranks have among them, and others nothing of: -<body>_ranks, and what a program sets. */
#include "meshes.h"
#include <sys/petsccompat.h>

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
  if (!last) return;
  Refused(&two, PETSC_ERR_USER_INPUT, "-a_mesh_division whole|-a_ranks names 2", "-dm_plex_dim 2 -mesh_division whole");
  Refused(&two, PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'nowhere'", "-dm_plex_dim 2 -mesh_contact_surfaces nowhere");
}

/* A bar of 12 elements from these options, after what a program has set */
static PetscOptions Open(Body *body, const char text[])
{
  PetscOptions options = options_begin(
      "-prefix_push bar_ -dm_plex_dim 1 -dm_plex_box_faces 12 -density 4 -youngs_modulus 16 %s -prefix_pop", text);

  ok(BodyCreate(PETSC_COMM_WORLD, "bar", body));
  return options;
}

static PetscInt BodyCellsHere(Body body)
{
  PetscInt start, end;
  DM       dm;

  ok(BodyGetDM(body, &dm));
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  return end - start;
}

/* The body's ranks must be those whose bits are set in `mask`, each with as many cells as another; others have none */
static void ExpectRanks(Body body, unsigned mask)
{
  const PetscMPIInt *ranks;
  PetscMPIInt        whole;
  PetscInt           n;
  unsigned           found = 0;

  ok(BodyGetRanks(body, &n, &ranks));
  for (PetscInt i = 0; i < n; i++) {
    assert_true(!i || ranks[i] > ranks[i - 1]);
    found |= 1u << ranks[i];
  }
  assert_int_equal(found, mask);
  assert_int_equal(BodyCellsHere(body), mask >> rank_of_world() & 1 ? 12 / n : 0);
  ok(BodyGetMeshRank(body, &whole));
  if (n == 1 || size_of_world() == 1) assert_int_equal(whole, ranks[0]);
  else assert_int_equal(whole, PETSC_DECIDE);
}

static void lists(void **state)
{
  static const struct {
    const char *list;
    unsigned    mask;
    PetscMPIInt size; /* ranks that it needs */
  } cases[] = {
      {"0", 1, 1}, {"0-0", 1, 1}, {"00", 1, 1},  {"1", 2, 2},     {"0-1", 3, 2}, {"0,1", 3, 2}, {"1,0", 3, 2},
      {"2", 4, 3}, {"0-2", 7, 3}, {"0,2", 5, 3}, {"2,0-1", 7, 3}, {"1-2", 6, 3}, {"2,0", 5, 3}, {"0-1,2", 7, 3},
  };

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    PetscOptions options;
    Body         body;
    char         text[64];

    if (cases[i].size > size_of_world()) continue;
    ok(PetscSNPrintf(text, sizeof(text), "-ranks %s", cases[i].list));
    options = Open(&body, text);
    ok(BodySetFromOptions(body));
    ExpectRanks(body, cases[i].mask);
    bar_destroy(&body, options);
  }
}

static void bad_lists(void **state)
{
  const char *const cases[][2] = {
      {",", "'' is neither"},
      {"0,", "'' is neither"},
      {",0", "'' is neither"},
      {"0,,1", "'' is neither"},
      {"a", "'a' is neither"},
      {"0-", "'0-' is neither"},
      {"-1", "'-1' is neither"},
      {"0-a", "'0-a' is neither"},
      {"0x1", "'0x1' is neither"},
      {"0.5", "'0.5' is neither"},
      {"0-0-0", "'0-0-0' is neither"},
      {"+0", "'+0' is neither"},
      {"1-0", "1-0 ends before it begins"},
      {"0,0", "names rank 0 twice"},
      {"0-0,0", "names rank 0 twice"},
      {"3", "-bar_ranks 3: this run has"},
      {"0-7", "-bar_ranks 0-7: this run has"},
      {"99999999999999999999", "this run has"},
      {"0,0-99999999999999999999", "this run has"},
  };

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    PetscOptions options;
    Body         body;
    char         text[64], words[128];

    ok(PetscSNPrintf(text, sizeof(text), "-ranks %s", cases[i][0]));
    ok(PetscSNPrintf(words, sizeof(words), "-bar_ranks|%s", cases[i][1]));
    options = Open(&body, text);
    refused(PETSC_ERR_USER_INPUT, words, BodySetFromOptions(body));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

/* What a program sets holds as long as no option says otherwise */
static void setters(void **state)
{
  const PetscMPIInt last = size_of_world() - 1, ranks[] = {0, last};
  const PetscInt    n = last ? 2 : 1;
  PetscOptions      options;
  Body              body;

  (void)state;
  options = Open(&body, "");
  ok(BodySetRanks(body, n, ranks));
  ok(BodySetFromOptions(body));
  ExpectRanks(body, 1u | 1u << last);
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar' has a mesh|BodySetRanks()", BodySetRanks(body, n, ranks));
  bar_destroy(&body, options);
  options = Open(&body, "-ranks 0");
  ok(BodySetRanks(body, n, ranks));
  ok(BodySetFromOptions(body));
  ExpectRanks(body, 1u);
  bar_destroy(&body, options);
  options = Open(&body, "");
  ok(BodySetRanks(body, 1, &last));
  ok(BodySetFromOptions(body));
  ExpectRanks(body, 1u << last);
  bar_destroy(&body, options);
  options = Open(&body, "");
  ok(BodySetRanks(body, n, ranks));
  ok(BodySetRanks(body, 0, NULL)); /* takes it back */
  ok(BodySetFromOptions(body));
  assert_int_equal(BodyCellsHere(body), 12 / size_of_world());
  bar_destroy(&body, options);
}

static void bad_setters(void **state)
{
  const PetscMPIInt none[] = {size_of_world()}, twice[] = {0, 0}, many[] = {0, 1, 2, 3}, negative[] = {-2};
  PetscOptions      options;
  Body              body;
  DM                dm;

  (void)state;
  options = Open(&body, "");
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|rank", BodySetRanks(body, 1, none));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|rank", BodySetRanks(body, 1, negative));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|rank", BodySetRanks(body, 2, twice));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|4 ranks", BodySetRanks(body, 4, many));
  ok(BodyDestroy(&body));
  options_drop(options);
  options = Open(&body, "-ranks 0");
  ok(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 1, PETSC_FALSE, (PetscInt[]){3}, NULL, NULL, NULL, PETSC_TRUE, BOX_NOT_PERIODIC & dm));
  ok(BodySetDM(body, dm));
  ok(DMDestroy(&dm));
  refused(PETSC_ERR_USER_INPUT, "-bar_ranks|the program has set the mesh", BodySetFromOptions(body));
  ok(BodyDestroy(&body));
  options_drop(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sets_have_all), cmocka_unit_test(fewer_cells_than_ranks),
      cmocka_unit_test(bad_sets),      cmocka_unit_test(lists),
      cmocka_unit_test(bad_lists),     cmocka_unit_test(setters),
      cmocka_unit_test(bad_setters),
  };

  return impakt_main(argc, argv, tests);
}
