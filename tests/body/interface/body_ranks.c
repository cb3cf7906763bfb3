/* The ranks that have the mesh of a body: -<body>_ranks, and what a program sets. */
#include "meshes.h"
#include <sys/petsccompat.h>

/* A bar of 12 elements from these options, after what a program has set */
static PetscOptions Open(Body *body, const char text[])
{
  PetscOptions options = options_begin(
      "-prefix_push bar_ -dm_plex_dim 1 -dm_plex_box_faces 12 -density 4 -youngs_modulus 16 %s -prefix_pop", text);

  ok(BodyCreate(PETSC_COMM_WORLD, "bar", body));
  return options;
}

static PetscInt CellsHere(Body body)
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
  assert_int_equal(CellsHere(body), mask >> rank_of_world() & 1 ? 12 / n : 0);
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
  refused(PETSC_ERR_ARG_WRONGSTATE, "'bar' has a mesh", BodySetMeshRank(body, 0));
  bar_destroy(&body, options);
  options = Open(&body, "-ranks 0");
  ok(BodySetRanks(body, n, ranks));
  ok(BodySetFromOptions(body));
  ExpectRanks(body, 1u);
  bar_destroy(&body, options);
  options = Open(&body, "");
  ok(BodySetMeshRank(body, last));
  ok(BodySetFromOptions(body));
  ExpectRanks(body, 1u << last);
  bar_destroy(&body, options);
  options = Open(&body, "");
  ok(BodySetRanks(body, n, ranks));
  ok(BodySetMeshRank(body, PETSC_DECIDE)); /* takes it back */
  ok(BodySetFromOptions(body));
  assert_int_equal(CellsHere(body), 12 / size_of_world());
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
  refused(PETSC_ERR_ARG_OUTOFRANGE, "'bar'|rank", BodySetMeshRank(body, none[0]));
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
      cmocka_unit_test(lists),
      cmocka_unit_test(bad_lists),
      cmocka_unit_test(setters),
      cmocka_unit_test(bad_setters),
  };

  return impakt_main(argc, argv, tests);
}
