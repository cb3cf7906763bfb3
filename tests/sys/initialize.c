/* ranks: 1 2 */
/* long: 2 */
/* Start and end of the library: on its own, inside a program that has started PETSc itself, again and again. MPI runs all the time. */
#include "support.h"
#include <petsc/private/petscimpl.h>

static PetscBool petsc_runs(void)
{
  PetscBool runs;

  assert_int_equal(PetscInitialized(&runs), PETSC_SUCCESS);
  return runs;
}

static PetscBool impakt_runs(void)
{
  PetscBool runs;

  assert_int_equal(ImpaktInitialized(&runs), PETSC_SUCCESS);
  return runs;
}

/* A simulation of all classes, without an option: two bars that hit each other */
static void simulate(void)
{
  const PetscInt  faces[1] = {4};
  const PetscReal velocity = 1;
  Material        material;
  Controller      controller;
  Contact         contact;
  Output          output;
  PetscInt        steps;

  ok(MaterialCreate(PETSC_COMM_WORLD, &material));
  ok(MaterialSetType(material, MATERIAL_LINEAR_ELASTIC));
  ok(MaterialSetDensity(material, 1));
  ok(MaterialSetYoungsModulus(material, 1));
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  for (PetscInt b = 0; b < 2; b++) {
    const PetscReal lower[1] = {b ? 0.01 : -1}, upper[1] = {b ? 1.01 : 0}, v[1] = {b ? -velocity : velocity};
    Body            body;
    DM              dm;

    ok(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 1, PETSC_FALSE, faces, lower, upper, NULL, PETSC_TRUE, 0, PETSC_FALSE, &dm));
    ok(DMSetFromOptions(dm)); /* distributes it */
    ok(BodyCreate(PETSC_COMM_WORLD, b ? "right" : "left", &body));
    ok(BodySetDM(body, dm));
    ok(BodySetMaterial(body, material));
    ok(BodySetInitialVelocity(body, v));
    ok(ControllerAddBody(controller, body));
    ok(BodyDestroy(&body));
    ok(DMDestroy(&dm));
  }
  ok(MaterialDestroy(&material));
  ok(ControllerSetTimes(controller, 0, 0.1, 0.01));
  ok(ControllerGetContact(controller, &contact));
  ok(ContactAddPair(contact, "left:right"));
  ok(ControllerSetUp(controller));
  ok(OutputCreate(controller, &output));
  ok(ControllerSolve(controller));
  ok(OutputDestroy(&output));
  ok(ControllerGetTimes(controller, NULL, NULL, &steps));
  assert_int_equal(steps, 10);
  ok(ControllerDestroy(&controller));
}

static void begin_petsc(void)
{
  assert_int_equal(PetscInitialize(NULL, NULL, NULL, NULL), PETSC_SUCCESS);
}

static void starts_and_ends_petsc(void **state)
{
  (void)state;
  assert_false(petsc_runs());
  assert_false(impakt_runs());
  assert_int_equal(ImpaktInitialize(NULL, NULL), PETSC_SUCCESS);
  assert_true(petsc_runs());
  assert_true(impakt_runs());
  simulate();
  assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
  assert_false(petsc_runs());
  assert_false(impakt_runs());
}

static PetscErrorCode CreateNothing(Material material)
{
  PetscFunctionBegin;
  (void)material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What has been registered ends with PETSc: class ids and registries are made anew, and each time papers are cited once */
static void starts_again(void **state)
{
  char text[8192];

  (void)state;
  for (PetscInt cycle = 0; cycle < 3; cycle++) {
    char    *words[] = {"test", "-citations", "citations.txt", NULL}, **argv = words;
    int      argc = 3;
    Material material;
    FILE    *file;
    char    *first, *second;
    size_t   n;
    PetscInt rank;

    assert_int_equal(ImpaktInitialize(&argc, &argv), PETSC_SUCCESS);
    rank = PetscGlobalRank;
    ok(MaterialCreate(PETSC_COMM_WORLD, &material));
    refused(PETSC_ERR_ARG_UNKNOWN_TYPE, "'own'|known: j2, j2_small, johnson_cook, linear_elastic, mooney_rivlin, neo_hookean, saint",
            MaterialSetType(material, "own"));
    ok(MaterialRegister("own", CreateNothing));
    ok(MaterialSetType(material, "own"));
    ok(MaterialDestroy(&material));
    simulate();
    simulate();
    assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
    if (rank) continue;
    file = fopen("citations.txt", "r");
    assert_non_null(file);
    n       = fread(text, 1, sizeof(text) - 1, file);
    text[n] = 0;
    assert_int_equal(fclose(file), 0);
    first = strstr(text, "KhenousLabordeRenard2008");
    assert_non_null(first);
    second = strstr(first + 1, "KhenousLabordeRenard2008");
    assert_null(second);
    assert_non_null(strstr(text, "HoyTezaurMota2021"));
    assert_null(strstr(text, "CarpenterTaylorKatona1991")); /* not used */
    assert_null(strstr(text, "PoppGeeWall2009"));           /* not in one dimension */
    assert_int_equal(remove("citations.txt"), 0);
  }
}

static PetscErrorCode CountErrors(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code, PetscErrorType type,
                                  const char *message, void *ctx)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  (void)message;
  if (type == PETSC_ERROR_INITIAL) (*(PetscInt *)ctx)++;
  return code;
}

static PetscErrorCode Fail(void)
{
  PetscFunctionBegin;
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_USER, "an error");
}

/* The program's own error handler gets errors before, within and after; PETSc and its options are the program's */
static void works_inside_anothers_petsc(void **state)
{
  char      words[] = "-not_looked_at", *list[] = {words, words, NULL}, **argv = list;
  int       argc   = 2;
  PetscInt  errors = 0;
  PetscBool set;

  (void)state;
  begin_petsc();
  ok(PetscPushErrorHandler(CountErrors, &errors));
  for (PetscInt cycle = 0; cycle < 2; cycle++) {
    assert_int_equal(ImpaktInitialize(&argc, &argv), PETSC_SUCCESS);
    assert_true(impakt_runs());
    assert_int_equal(Fail(), PETSC_ERR_USER);
    assert_int_equal(errors, 2 * cycle + 1);
    ok(PetscOptionsHasName(NULL, NULL, "-not_looked_at", &set));
    assert_false(set);
    simulate();
    assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
    assert_false(impakt_runs());
    assert_true(petsc_runs());
    assert_int_equal(Fail(), PETSC_ERR_USER);
    assert_int_equal(errors, 2 * cycle + 2);
  }
  ok(PetscPopErrorHandler());
  assert_int_equal(PetscFinalize(), PETSC_SUCCESS);
  assert_false(petsc_runs());
}

static void calls_are_nested(void **state)
{
  (void)state;
  for (PetscInt i = 0; i < 3; i++) assert_int_equal(ImpaktInitialize(NULL, NULL), PETSC_SUCCESS);
  for (PetscInt i = 0; i < 2; i++) {
    assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
    assert_true(impakt_runs());
    assert_true(petsc_runs());
  }
  simulate();
  assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
  assert_false(petsc_runs());
}

static void end_without_start_is_refused(void **state)
{
  (void)state;
  begin_petsc();
  refused(PETSC_ERR_ARG_WRONGSTATE, "without ImpaktInitialize()", ImpaktFinalize());
  assert_int_equal(ImpaktInitialize(NULL, NULL), PETSC_SUCCESS);
  assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
  refused(PETSC_ERR_ARG_WRONGSTATE, "without ImpaktInitialize()", ImpaktFinalize());
  assert_int_equal(PetscFinalize(), PETSC_SUCCESS);
}

/* The program ends PETSc first: Impakt has ended with it, and may be started again */
static void petsc_may_end_first(void **state)
{
  (void)state;
  for (PetscInt cycle = 0; cycle < 2; cycle++) {
    begin_petsc();
    assert_int_equal(ImpaktInitialize(NULL, NULL), PETSC_SUCCESS);
    simulate();
    assert_int_equal(PetscFinalize(), PETSC_SUCCESS);
    assert_false(impakt_runs());
    assert_int_equal(ImpaktFinalize(), PETSC_SUCCESS);
  }
}

/* Each class registers itself when it is first used */
static void classes_start_themselves(void **state)
{
  (void)state;
  for (PetscInt cycle = 0; cycle < 2; cycle++) {
    begin_petsc();
    simulate();
    assert_false(impakt_runs());
    assert_int_equal(PetscFinalize(), PETSC_SUCCESS);
  }
}

#if !IMPAKT_VERSION_EQ(IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR, IMPAKT_VERSION_SUBMINOR) || IMPAKT_VERSION_LT(0, 1, 0) ||               \
    !IMPAKT_VERSION_LT(IMPAKT_VERSION_MAJOR + 1, 0, 0) || !IMPAKT_VERSION_LT(IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR + 1, 0) ||         \
    !IMPAKT_VERSION_LE(IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR, IMPAKT_VERSION_SUBMINOR) ||                                             \
    IMPAKT_VERSION_GT(IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR, IMPAKT_VERSION_SUBMINOR) ||                                              \
    IMPAKT_VERSION_GE(IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR, IMPAKT_VERSION_SUBMINOR + 1)
#  error "The version does not compare with itself and its neighbours as it should"
#endif

static void library_and_headers_have_one_version(void **state)
{
  char version[64], expected[64];

  (void)state;
  begin_petsc();
  ok(ImpaktGetVersion(version, sizeof(version)));
  ok(PetscSNPrintf(expected, sizeof(expected), "Impakt %d.%d.%d", IMPAKT_VERSION_MAJOR, IMPAKT_VERSION_MINOR, IMPAKT_VERSION_SUBMINOR));
  assert_string_equal(version, expected);
  ok(PetscSNPrintf(expected, sizeof(expected), "Impakt %s", IMPAKT_VERSION));
  assert_string_equal(version, expected);
  assert_int_equal(PetscFinalize(), PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(starts_and_ends_petsc),        cmocka_unit_test(starts_again),
      cmocka_unit_test(works_inside_anothers_petsc),  cmocka_unit_test(calls_are_nested),
      cmocka_unit_test(end_without_start_is_refused), cmocka_unit_test(petsc_may_end_first),
      cmocka_unit_test(classes_start_themselves),     cmocka_unit_test(library_and_headers_have_one_version),
  };
  int failed;

  if (MPI_Init(&argc, &argv)) return 1;
  failed = cmocka_run_group_tests(tests, NULL, NULL);
  MPI_Finalize();
  return failed;
}
