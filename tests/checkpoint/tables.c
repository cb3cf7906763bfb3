/* Tables of nodes, by which a run is continued on another number of ranks: rows are found by the places of their nodes. */
#include "support.h"
#include <checkpoint/tables.h>

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
  ok(TablesCreate(PETSC_COMM_WORLD, &tables));
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

  ok(TablesCreate(PETSC_COMM_WORLD, &tables));
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
  Tables           tables;
  PetscInt         n, width;
  const char      *name;
  const PetscReal *values;

  (void)state;
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  ok(TablesCreate(PETSC_COMM_WORLD, &tables));
  ok(TablesAddNumbers(tables, "numbers", 3, (PetscReal[]){3, -1, 0.5}));
  ok(TablesGetTable(tables, 0, &name, &n, &width, &values));
  assert_string_equal(name, "numbers");
  assert_int_equal(n, !rank);
  if (!rank) {
    ok(TablesGetNumbers(tables, "numbers", &n, &values));
    assert_int_equal(n, 3);
    near(values[0], 3, 0);
    near(values[1], -1, 0);
    near(values[2], 0.5, 0);
  }
  ok(TablesDestroy(&tables));
  tables = make_tables(4);
  refused(PETSC_ERR_FILE_UNEXPECTED, "4 rows in 'nodes'|to be one", TablesGetNumbers(tables, "nodes", &n, &values));
  ok(TablesDestroy(&tables));
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
  ok(TablesCreate(PETSC_COMM_WORLD, &tables));
  ok(PetscCalloc1(2 * WIDTH, &values));
  values[2 * WIDTH - 1] = 1;
  ok(TablesShare(tables, "crack", 2, WIDTH, values));
  refused(PETSC_ERR_SUP, "Two nodes of 'crack'|as many ranks as before", TablesLookFor(tables, "crack", (PetscReal[]){0, 0, 0}, &row));
  ok(TablesDestroy(&tables));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gathered),           cmocka_unit_test(found_by_their_places), cmocka_unit_test(of_all_ranks),
      cmocka_unit_test(of_another_problem), cmocka_unit_test(two_at_one_place),
  };

  return impakt_main(argc, argv, tests);
}
