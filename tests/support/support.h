/* What the unit tests share: PETSc's errors as test failures, options of one test alone, bars with rows at chosen nodes. */
#pragma once
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <impakt.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/elementimpl.h>

/* ok(call): the test fails where the call returns an error, which Impakt has printed by then */
#define ok(...) succeed((__VA_ARGS__), __FILE__, __LINE__)
static inline void succeed(PetscErrorCode error, const char file[], int line)
{
  if (!error) return;
  print_error("error %d\n", (int)error);
  _fail(file, line);
}

/* For tests of bodies with few elements, each rank of which must have one */
static inline void skip_beyond_ranks(PetscMPIInt most)
{
  PetscMPIInt size;

  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  if (size > most) skip();
}

/* near(a, b, tolerance): absolute; a NaN is never near */
#define near(a, b, tolerance) expect_near((double)(a), (double)(b), (double)(tolerance), #a, __FILE__, __LINE__)
static inline void expect_near(double a, double b, double tolerance, const char what[], const char file[], int line)
{
  if (PetscAbsReal(a - b) <= tolerance) return;
  print_error("%s is %.17g, not %.17g +- %.3g\n", what, a, b, tolerance);
  _fail(file, line);
}

#define between(a, low, high) expect_between((double)(a), (double)(low), (double)(high), #a, __FILE__, __LINE__)
static inline void expect_between(double a, double low, double high, const char what[], const char file[], int line)
{
  if (a >= low && a <= high) return;
  print_error("%s is %.9g, not between %.9g and %.9g\n", what, a, low, high);
  _fail(file, line);
}

static inline PetscErrorCode NoteMessage(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                                         PetscErrorType type, const char *message, void *ctx)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  /* the first message is the cause; on ranks where it is told by others alone, there is none */
  if (type == PETSC_ERROR_INITIAL && message) (void)PetscStrncpy((char *)ctx, message, 2048);
  return code;
}

/* refused(code, words, call): the call ends with that error, and its message has all the words (split by '|') in it */
#define refused(code, words, ...)                                                                                                          \
  do {                                                                                                                                     \
    char           message_[2048] = "";                                                                                                    \
    PetscErrorCode error_;                                                                                                                 \
    ok(PetscPushErrorHandler(NoteMessage, message_));                                                                                      \
    error_ = (__VA_ARGS__);                                                                                                                \
    ok(PetscPopErrorHandler());                                                                                                            \
    expect_message(error_, code, words, message_, __FILE__, __LINE__);                                                                     \
  } while (0)
static inline void expect_message(PetscErrorCode error, PetscErrorCode code, const char words[], const char message[], const char file[],
                                  int line)
{
  char **word;
  int    n;

  if (error != code) {
    print_error("error %d, not %d: %s\n", (int)error, (int)code, message);
    _fail(file, line);
  }
  ok(PetscStrToArray(words, '|', &n, &word));
  for (int i = 0; i < n; i++) {
    const char *found = NULL;

    ok(PetscStrstr(message, word[i], (char **)&found));
    if (found) continue;
    print_error("'%s' is not in the message: %s\n", word[i], message);
    _fail(file, line);
  }
  ok(PetscStrToArrayDestroy(n, word));
}

/* Options of this test alone: printf-like */
static inline PetscOptions options_begin(const char format[], ...)
{
  PetscOptions options;
  char         text[4096];
  va_list      args;

  va_start(args, format);
  vsnprintf(text, sizeof(text), format, args);
  va_end(args);
  ok(PetscOptionsCreate(&options));
  ok(PetscOptionsInsertString(options, text));
  ok(PetscOptionsPush(options));
  return options;
}

/* For what ends with an error, and may not have read them all */
static inline void options_drop(PetscOptions options)
{
  ok(PetscOptionsPop());
  ok(PetscOptionsDestroy(&options));
}

/* All of them must have been read */
static inline void options_end(PetscOptions options)
{
  char   **names, **values;
  PetscInt n;

  ok(PetscOptionsLeftGet(options, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) print_error("unread option -%s\n", names[i]);
  assert_int_equal(n, 0);
  ok(PetscOptionsLeftRestore(options, &n, &names, &values));
  options_drop(options);
}

/* Elements of a shape on this rank, their options read, not set up */
static inline PetscErrorCode element_create(const char prefix[], DMPolytopeType cell_type, Material material, Element *element)
{
  PetscFunctionBegin;
  PetscCall(ElementCreate(PETSC_COMM_SELF, element));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)*element, prefix));
  PetscCall(ElementSetMaterial(*element, material));
  PetscCall(ElementSetCellType(*element, cell_type));
  PetscCall(ElementSetFromOptions(*element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that each give the displacement of one node, along the first axis */
typedef struct {
  PetscInt n, local, begin;
  PetscInt which[4]; /* of each row of this rank: the number of its node among those asked for */
  PetscInt row[4];   /* of each node asked for: its row, on every rank */
} Rows;

/* Gives a body in one dimension such rows at the nodes at x, and makes them contact nodes */
static inline void set_rows(Body body, PetscInt n, const PetscReal x[], Rows *rows)
{
  PetscInt           start, end, vertices[4], dofs[4], n_vertices = 0, begin;
  PetscSection       coordinate_section, section;
  const PetscScalar *coordinates;
  Vec                local, positions;
  Mat                B;
  DM                 dm;

  ok(BodyGetDM(body, &dm));
  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  ok(DMGetCoordinateSection(dm, &coordinate_section));
  ok(DMGetCoordinatesLocal(dm, &local));
  ok(DMGetGlobalSection(dm, &section));
  ok(BodyGetReferencePositions(body, &positions));
  rows->n     = n;
  rows->local = 0;
  ok(VecGetArrayRead(local, &coordinates));
  for (PetscInt v = start; v < end; v++)
    for (PetscInt i = 0; i < n; i++) {
      PetscInt offset;

      ok(PetscSectionGetOffset(coordinate_section, v, &offset));
      if (PetscAbsReal(coordinates[offset] - x[i]) > 1e-9) continue;
      vertices[n_vertices++] = v;
      ok(PetscSectionGetOffset(section, v, &offset));
      if (offset < 0) continue; /* another rank's */
      dofs[rows->local]          = offset;
      rows->which[rows->local++] = i;
    }
  ok(VecRestoreArrayRead(local, &coordinates));
  ok(BodySetContactNodes(body, n_vertices, vertices));

  ok(VecGetLocalSize(positions, &end));
  ok(MatCreateAIJ(PETSC_COMM_WORLD, rows->local, end, n, PETSC_DETERMINE, 1, NULL, 1, NULL, &B));
  ok(MatGetOwnershipRange(B, &begin, NULL));
  rows->begin = begin;
  for (PetscInt i = 0; i < n; i++) rows->row[i] = -1;
  for (PetscInt i = 0; i < rows->local; i++) {
    rows->row[rows->which[i]] = begin + i;
    ok(MatSetValue(B, begin + i, dofs[i], 1, INSERT_VALUES));
  }
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, rows->row, (PetscMPIInt)n, MPIU_INT, MPI_MAX, PETSC_COMM_WORLD), 0);
  ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  ok(BodySetInterface(body, B));
  ok(MatDestroy(&B));
}

/* What each node's row means, in the order in which the nodes were asked for */
static inline void set_conditions(Body body, const Rows *rows, const BodyCondition conditions[])
{
  BodyCondition mine[4];

  for (PetscInt i = 0; i < rows->local; i++) mine[i] = conditions[rows->which[i]];
  ok(BodySetConditions(body, mine));
}

static inline void set_level(const Rows *rows, Trace trace, PetscInt level, PetscInt which, PetscReal value)
{
  PetscScalar *values;

  ok(TraceGetLevel(trace, level, &values));
  for (PetscInt i = 0; i < rows->local; i++)
    if (rows->which[i] == which) values[i] = value;
}

/* A body named bar, its options read (printf-like, without the prefix), not set up */
static inline PetscOptions bar_create(Body *body, const char format[], ...)
{
  PetscOptions options;
  char         text[2048];
  va_list      args;

  va_start(args, format);
  vsnprintf(text, sizeof(text), format, args);
  va_end(args);
  options = options_begin("-prefix_push bar_ -dm_plex_dim 1 %s -prefix_pop", text);
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", body));
  ok(BodySetFromOptions(*body));
  return options;
}

static inline void bar_destroy(Body *body, PetscOptions options)
{
  ok(BodyDestroy(body));
  options_end(options);
}

/* The displacement of the node at x, on every rank */
static inline PetscReal value_at(Body body, Vec vec, PetscReal x)
{
  const PetscScalar *position, *values;
  PetscReal          value = 0;
  PetscInt           n;
  Vec                positions;

  ok(BodyGetReferencePositions(body, &positions));
  ok(VecGetLocalSize(positions, &n));
  ok(VecGetArrayRead(positions, &position));
  ok(VecGetArrayRead(vec, &values));
  for (PetscInt i = 0; i < n; i++)
    if (PetscAbsReal(position[i] - x) < 1e-9) value = values[i];
  ok(VecRestoreArrayRead(vec, &values));
  ok(VecRestoreArrayRead(positions, &position));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return value;
}

/* main(): the tests of an array, between start and end of Impakt */
#define impakt_main(argc, argv, tests) run_group(argc, argv, #tests, tests, sizeof(tests) / sizeof((tests)[0]), PETSC_FALSE)
#define impakt_main_logged(argc, argv, tests)                                                                                              \
  run_group(argc, argv, #tests, tests, sizeof(tests) / sizeof((tests)[0]), PETSC_TRUE) /* for counts of events */
static inline int run_group(int argc, char **argv, const char name[], const struct CMUnitTest tests[], size_t n, PetscBool logged)
{
  int failed;

  (void)name;
  if (ImpaktInitialize(&argc, &argv)) return 1;
  if (logged && PetscLogDefaultBegin()) return 1;
  failed = _cmocka_run_group_tests(name, tests, n, NULL, NULL);
  if (ImpaktFinalize()) return 1;
  return failed;
}
