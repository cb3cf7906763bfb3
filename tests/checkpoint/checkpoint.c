/* ranks: 1 3 */
/* The stream of a checkpoint: what was visited comes back, and a stream of another problem is refused by its first record that differs.
   Tables of nodes, by which a run is continued on another number of ranks: rows are found by the places of their nodes. */
#include "support.h"
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>

/* One of each kind, with lengths that are no multiples of 8 bytes */
typedef struct {
  PetscReal  reals[3];
  PetscInt   ints[3];
  PetscInt64 long_ints[2];
  PetscBool  bools[3];
  char       bytes[5];
  Vec        vec;
  Trace      trace;
  Mat        mat;
} Things;

/* On each rank two rows of a matrix of tridiagonal form, with an explicit zero; all other values are `value` and more, also by rank */
static void make_things(PetscReal value, Things *things)
{
  PetscInt     begin, end, n;
  PetscMPIInt  rank;
  PetscScalar *level;

  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  value += 100 * rank;
  *things = (Things){.reals     = {value, value + 1, value + 2},
                     .ints      = {(PetscInt)value, 2, -3},
                     .long_ints = {(PetscInt64)value << 40, -1},
                     .bools     = {PETSC_TRUE, value > 5 ? PETSC_TRUE : PETSC_FALSE, PETSC_TRUE},
                     .bytes     = {'b', 'y', 't', 'e', value > 5 ? 's' : 'z'}};
  ok(VecCreateMPI(PETSC_COMM_WORLD, 3, PETSC_DETERMINE, &things->vec));
  ok(VecSet(things->vec, value));
  ok(TraceCreate(2, 3, &things->trace));
  for (PetscInt k = 0; k <= 3; k++) {
    ok(TraceGetLevel(things->trace, k, &level));
    level[0] = value + k;
    level[1] = -value;
  }
  ok(MatCreateAIJ(PETSC_COMM_WORLD, 2, 2, PETSC_DETERMINE, PETSC_DETERMINE, 3, NULL, 3, NULL, &things->mat));
  ok(MatGetOwnershipRange(things->mat, &begin, &end));
  ok(MatGetSize(things->mat, &n, NULL));
  for (PetscInt i = begin; i < end; i++)
    for (PetscInt j = PetscMax(i - 1, 0); j <= PetscMin(i + 1, n - 1); j++)
      ok(MatSetValue(things->mat, i, j, i == j ? value : 0, INSERT_VALUES));
  ok(MatAssemblyBegin(things->mat, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(things->mat, MAT_FINAL_ASSEMBLY));
}

static void drop_things(Things *things)
{
  ok(VecDestroy(&things->vec));
  ok(TraceDestroy(&things->trace));
  ok(MatDestroy(&things->mat));
}

static void visit(Checkpoint checkpoint, Things *things)
{
  ok(CheckpointBegin(checkpoint, "things"));
  ok(CheckpointVisitReals(checkpoint, "reals", 3, things->reals));
  ok(CheckpointVisitInts(checkpoint, "ints", 3, things->ints));
  ok(CheckpointVisitInt64s(checkpoint, "long", 2, things->long_ints));
  ok(CheckpointVisitBools(checkpoint, "bools", 3, things->bools));
  ok(CheckpointVisitBytes(checkpoint, "bytes", 5, things->bytes));
  ok(CheckpointVisitVec(checkpoint, "vec", things->vec));
  ok(CheckpointVisitVec(checkpoint, "no vec", NULL));
  ok(CheckpointVisitTrace(checkpoint, "trace", things->trace));
  ok(CheckpointVisitTrace(checkpoint, "no trace", NULL));
  ok(CheckpointVisitMat(checkpoint, "mat", &things->mat));
}

/* A stream that is loaded, with the bytes that another one was filled with, or the first `length` of them */
static Checkpoint begin_loading(Checkpoint filled, size_t length)
{
  const void *bytes;
  void       *copy;
  size_t      size;
  Checkpoint  loads;

  ok(CheckpointGetBytes(filled, &size, &bytes));
  size = PetscMin(size, length);
  ok(PetscMalloc(size, &copy));
  ok(PetscMemcpy(copy, bytes, size));
  ok(CheckpointCreateFromBytes(PETSC_COMM_WORLD, size, copy, &loads));
  return loads;
}

static void comes_back(void **state)
{
  Things       first, second;
  Checkpoint   fills, loads;
  PetscBool    same;
  MatInfo      info[2];
  PetscScalar *levels[2];

  (void)state;
  make_things(8, &first);
  make_things(3, &second);
  ok(CheckpointCreate(PETSC_COMM_WORLD, &fills));
  assert_false(CheckpointLoads(fills));
  visit(fills, &first);
  loads = begin_loading(fills, SIZE_MAX);
  assert_true(CheckpointLoads(loads));
  visit(loads, &second);
  ok(CheckpointFinish(loads));
  assert_memory_equal(first.reals, second.reals, sizeof(first.reals));
  assert_memory_equal(first.ints, second.ints, sizeof(first.ints));
  assert_memory_equal(first.long_ints, second.long_ints, sizeof(first.long_ints));
  assert_memory_equal(first.bools, second.bools, sizeof(first.bools));
  assert_memory_equal(first.bytes, second.bytes, sizeof(first.bytes));
  ok(VecEqual(first.vec, second.vec, &same));
  assert_true(same);
  ok(MatEqual(first.mat, second.mat, &same));
  assert_true(same);
  ok(MatGetInfo(first.mat, MAT_GLOBAL_SUM, &info[0]));
  ok(MatGetInfo(second.mat, MAT_GLOBAL_SUM, &info[1]));
  assert_true(info[0].nz_used == info[1].nz_used); /* with the zeros */
  for (PetscInt k = 0; k <= 3; k++) {
    ok(TraceGetLevel(first.trace, k, &levels[0]));
    ok(TraceGetLevel(second.trace, k, &levels[1]));
    assert_memory_equal(levels[0], levels[1], 2 * sizeof(PetscScalar));
  }
  ok(CheckpointDestroy(&fills));
  ok(CheckpointDestroy(&loads));
  ok(CheckpointDestroy(&loads)); /* nothing to destroy is no error */
  drop_things(&first);
  drop_things(&second);
}

/* A stream of three numbers, called gaps, of a body */
static Checkpoint fill_gaps(void)
{
  PetscReal  gaps[3] = {1, 2, 3};
  Checkpoint fills;

  ok(CheckpointCreate(PETSC_COMM_WORLD, &fills));
  ok(CheckpointBegin(fills, "left"));
  ok(CheckpointVisitReals(fills, "gaps", 3, gaps));
  return fills;
}

static void another_problem(void **state)
{
  const PetscErrorCode code    = PETSC_ERR_FILE_UNEXPECTED;
  PetscReal            gaps[4] = {0};
  PetscInt             ints[3] = {0};
  Checkpoint           fills   = fill_gaps(), loads;

  (void)state;
  loads = begin_loading(fills, SIZE_MAX);
  refused(code, "0 x 'left'|0 x 'right'|another problem", CheckpointBegin(loads, "right"));
  ok(CheckpointDestroy(&loads));

  loads = begin_loading(fills, SIZE_MAX);
  ok(CheckpointBegin(loads, "left"));
  refused(code, "more in it|after 'left'", CheckpointFinish(loads));
  refused(code, "3 x 'gaps'|3 x 'forces' of left", CheckpointVisitReals(loads, "forces", 3, gaps));
  refused(code, "3 x 'gaps'|2 x 'gaps' of left", CheckpointVisitReals(loads, "gaps", 2, gaps));
  refused(code, "3 x 'gaps'", CheckpointVisitInts(loads, "gaps", 3, ints)); /* as long, but of another kind */
  refused(code, "ends before 'gaps' of left", CheckpointVisitReals(loads, "gaps", 4, gaps));
  assert_true(gaps[0] == 0 && ints[0] == 0); /* what is refused changes nothing */
  ok(CheckpointVisitReals(loads, "gaps", 3, gaps));
  near(gaps[2], 3, 0);
  ok(CheckpointFinish(loads));
  refused(code, "ends before 'more' of left", CheckpointVisitReals(loads, "more", 0, gaps));
  ok(CheckpointDestroy(&loads));
  ok(CheckpointDestroy(&fills));
}

/* Wherever it is cut */
static void cut_short(void **state)
{
  PetscReal   gaps[3];
  Checkpoint  fills = fill_gaps(), loads;
  const void *bytes;
  size_t      size;

  (void)state;
  ok(CheckpointGetBytes(fills, &size, &bytes));
  for (size_t length = size / 2; length < size; length++) {
    loads = begin_loading(fills, length);
    ok(CheckpointBegin(loads, "left"));
    refused(PETSC_ERR_FILE_UNEXPECTED, "ends before 'gaps' of left", CheckpointVisitReals(loads, "gaps", 3, gaps));
    ok(CheckpointDestroy(&loads));
  }
  ok(CheckpointDestroy(&fills));
}

#define WIDTH (TABLES_KEY + 1)

/* Each rank adds two nodes at (rank, 0, 0) and (rank, 1, 0), with 10 rank and 10 rank + 1; the first rank gets all of them */
static void gathered(void **state)
{
  PetscMPIInt      rank, size;
  Tables           tables;
  PetscInt         n, width;
  const char      *name;
  const PetscReal *values;

  (void)state;
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  ok(TablesCreate(PETSC_COMM_WORLD, PETSC_FALSE, &tables));
  ok(TablesAdd(tables, "nodes", 2, WIDTH, (PetscReal[]){rank, 0, 0, 10 * rank, rank, 1, 0, 10 * rank + 1}));
  TablesGetNumber(tables, &n);
  assert_int_equal(n, 1);
  ok(TablesGetTable(tables, 0, &name, &n, &width, &values));
  assert_string_equal(name, "nodes");
  assert_int_equal(width, WIDTH);
  assert_int_equal(n, rank ? 0 : 2 * size);
  for (PetscInt i = 0; i < n; i++) {
    near(values[i * WIDTH], i / 2, 0);
    near(values[i * WIDTH + TABLES_KEY], 10 * (i / 2) + i % 2, 0);
  }
  ok(TablesDestroy(&tables));
  ok(TablesDestroy(&tables)); /* nothing to destroy is no error */
}

/* A table that all ranks have: so many nodes at (i / 3, i % 3, 0), the last ones first, with the number i */
static Tables make_tables(PetscInt n)
{
  Tables     tables;
  PetscReal *values;

  ok(TablesCreate(PETSC_COMM_WORLD, PETSC_TRUE, &tables));
  ok(PetscCalloc1(n * WIDTH, &values));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt i = n - 1 - k;

    values[k * WIDTH]              = i / 3;
    values[k * WIDTH + 1]          = i % 3;
    values[k * WIDTH + TABLES_KEY] = i;
  }
  ok(TablesShare(tables, "nodes", n, WIDTH, values));
  return tables;
}

static void found_by_their_places(void **state)
{
  const PetscInt sizes[] = {0, 1, 2, 7};

  (void)state;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(sizes); s++) {
    Tables           tables = make_tables(sizes[s]);
    const PetscReal *values;
    PetscInt         n, row;

    ok(TablesGet(tables, "nodes", WIDTH, &n, &values));
    assert_int_equal(n, sizes[s]);
    for (PetscInt i = 0; i < n; i++) {
      ok(TablesFind(tables, "nodes", (PetscReal[]){i / 3, i % 3, 0}, &row));
      near(values[row * WIDTH + TABLES_KEY], i, 0);
    }
    for (PetscInt i = -1; i < 4; i++) { /* before all of them, beside them, and after them */
      ok(TablesLookFor(tables, "nodes", (PetscReal[]){i, 0.5, 0}, &row));
      assert_int_equal(row, -1);
    }
    ok(TablesDestroy(&tables));
  }
}

/* What all ranks have alike is kept once, in a row of its own */
static void of_all_ranks(void **state)
{
  PetscMPIInt      rank;
  Tables           fills, loads;
  PetscInt         n, width;
  const char      *name;
  const PetscReal *values;
  PetscReal       *shared, numbers[3] = {3, -1, 0.5};

  (void)state;
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  ok(TablesCreate(PETSC_COMM_WORLD, PETSC_FALSE, &fills));
  assert_false(TablesLoads(fills));
  ok(TablesVisitNumbers(fills, "numbers", 3, numbers));
  ok(TablesGetTable(fills, 0, &name, &n, &width, &values));
  assert_string_equal(name, "numbers");
  assert_int_equal(n, !rank);
  assert_int_equal(width, 3);
  ok(PetscMalloc1(3, &shared));
  if (!rank) ok(PetscArraycpy(shared, values, 3));
  assert_int_equal(MPI_Bcast(shared, 3, MPIU_REAL, 0, PETSC_COMM_WORLD), 0);
  ok(TablesDestroy(&fills));
  ok(TablesCreate(PETSC_COMM_WORLD, PETSC_TRUE, &loads));
  assert_true(TablesLoads(loads));
  ok(TablesShare(loads, "numbers", 1, 3, shared));
  ok(PetscArrayzero(numbers, 3));
  ok(TablesVisitNumbers(loads, "numbers", 3, numbers));
  near(numbers[0], 3, 0);
  near(numbers[1], -1, 0);
  near(numbers[2], 0.5, 0);
  refused(PETSC_ERR_FILE_UNEXPECTED, "3 numbers for each row of 'numbers'|this run has 2",
          TablesVisitNumbers(loads, "numbers", 2, numbers));
  ok(TablesDestroy(&loads));
  loads = make_tables(4);
  refused(PETSC_ERR_FILE_UNEXPECTED, "4 rows in 'nodes'|to be one", TablesVisitNumbers(loads, "nodes", WIDTH, numbers));
  ok(TablesDestroy(&loads));
}

static void of_another_problem(void **state)
{
  const PetscErrorCode code   = PETSC_ERR_FILE_UNEXPECTED;
  Tables               tables = make_tables(4);
  const PetscReal     *values;
  PetscInt             n, row;

  (void)state;
  refused(code, "no table 'faces'|another problem", TablesGet(tables, "faces", WIDTH, &n, &values));
  refused(code, "4 numbers for each row of 'nodes'|this run has 7", TablesGet(tables, "nodes", 7, &n, &values));
  refused(code, "no node of 'nodes' at (0, 1, 0.5)|another mesh", TablesFind(tables, "nodes", (PetscReal[]){0, 1, 0.5}, &row));
  ok(TablesDestroy(&tables));
}

/* Such nodes cannot be told from each other */
static void two_at_one_place(void **state)
{
  Tables     tables;
  PetscReal *values;
  PetscInt   row;

  (void)state;
  ok(TablesCreate(PETSC_COMM_WORLD, PETSC_TRUE, &tables));
  ok(PetscCalloc1(2 * WIDTH, &values));
  values[2 * WIDTH - 1] = 1;
  ok(TablesShare(tables, "crack", 2, WIDTH, values));
  refused(PETSC_ERR_SUP, "Two nodes of 'crack'|as many ranks as before", TablesLookFor(tables, "crack", (PetscReal[]){0, 0, 0}, &row));
  ok(TablesDestroy(&tables));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(comes_back),         cmocka_unit_test(another_problem),       cmocka_unit_test(cut_short),
      cmocka_unit_test(gathered),           cmocka_unit_test(found_by_their_places), cmocka_unit_test(of_all_ranks),
      cmocka_unit_test(of_another_problem), cmocka_unit_test(two_at_one_place),
  };

  return impakt_main(argc, argv, tests);
}
