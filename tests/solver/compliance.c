/* Matrices of rows that become known one by one, are forgotten, and come back. */
#include "support.h"
#include <solver/compliance.h>

#define ROWS   7
#define LEVELS 3

typedef struct {
  Compliance compliance;
  PetscInt   local, begin;
} Known;

static PetscScalar entry(PetscInt level, PetscInt i, PetscInt j)
{
  return 100 * (level + 1) + 10 * PetscMin(i, j) + PetscMax(i, j);
}

/* Rows as PETSc deals them out */
static Known create(PetscInt levels)
{
  Known    known = {.local = PETSC_DECIDE};
  PetscInt n     = ROWS;

  ok(PetscSplitOwnership(PETSC_COMM_WORLD, &known.local, &n));
  assert_int_equal(MPI_Exscan(&known.local, &known.begin, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  ok(ComplianceCreate(PETSC_COMM_WORLD, known.local, known.begin, ROWS, levels, &known.compliance));
  return known;
}

static void set(Known *known, PetscInt row, PetscInt levels)
{
  PetscScalar mine[LEVELS * ROWS];

  for (PetscInt k = 0; k < levels; k++)
    for (PetscInt i = 0; i < known->local; i++) mine[k * known->local + i] = entry(k, known->begin + i, row);
  ok(ComplianceSetColumn(known->compliance, row, levels, mine));
}

/* All that is known of the listed rows, which are all that have a place */
static void check(Known *known, PetscInt n, const PetscInt rows[], PetscInt levels)
{
  const PetscInt *place;
  PetscInt        count;

  ComplianceGetRows(known->compliance, &count, NULL, &place);
  assert_int_equal(count, n);
  for (PetscInt k = 0; k < levels; k++) {
    const PetscScalar *matrix;
    PetscInt           leading;

    ComplianceGetMatrix(known->compliance, k, &leading, &matrix);
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) near(matrix[place[rows[j]] * leading + place[rows[i]]], entry(k, rows[i], rows[j]), 0);
  }
}

static void rows_bring_their_columns(void **state)
{
  static const PetscInt order[] = {4, 0, 6, 3};
  Known                 known   = create(LEVELS);

  (void)state;
  for (PetscInt n = 0; n < 4; n++) {
    const PetscInt64 before = ComplianceGetState(known.compliance);

    assert_false(ComplianceKnows(known.compliance, order[n]));
    set(&known, order[n], LEVELS);
    assert_true(ComplianceKnows(known.compliance, order[n]));
    assert_true(ComplianceGetState(known.compliance) != before);
    check(&known, n + 1, order, LEVELS);
  }
  assert_false(ComplianceKnows(known.compliance, 1));
  ok(ComplianceDestroy(&known.compliance));
  assert_null(known.compliance);
  ok(ComplianceDestroy(&known.compliance));
}

/* What a solver brings is the first level; the others come when they are asked for, to the same place */
static void a_column_may_be_known_in_part(void **state)
{
  static const PetscInt order[] = {2, 5};
  Known                 known   = create(LEVELS);

  (void)state;
  set(&known, 2, 1);
  set(&known, 5, 1);
  assert_false(ComplianceKnows(known.compliance, 2));
  check(&known, 2, order, 1);
  set(&known, 5, LEVELS);
  assert_true(ComplianceKnows(known.compliance, 5));
  assert_false(ComplianceKnows(known.compliance, 2));
  set(&known, 2, LEVELS);
  check(&known, 2, order, LEVELS);
  ok(ComplianceDestroy(&known.compliance));
}

static void rows_are_forgotten_and_come_back(void **state)
{
  static const PetscInt    order[] = {4, 0, 6, 3}, left[] = {4, 6}, all[] = {4, 6, 0, 1};
  static const PetscMPIInt changed[ROWS] = {1, 0, 0, 1, 0, 1, 0}; /* also one that never was known */
  Known                    known         = create(LEVELS);

  (void)state;
  ok(ComplianceReserve(known.compliance, 4));
  for (PetscInt n = 0; n < 4; n++) set(&known, order[n], LEVELS);
  ok(ComplianceForget(known.compliance, changed));
  assert_false(ComplianceKnows(known.compliance, 0));
  assert_true(ComplianceKnows(known.compliance, 6));
  check(&known, 2, left, LEVELS);
  set(&known, 0, LEVELS);
  set(&known, 1, LEVELS);
  check(&known, 4, all, LEVELS);
  ok(ComplianceReserve(known.compliance, ROWS - 4)); /* moves what is there */
  check(&known, 4, all, LEVELS);
  ok(ComplianceDestroy(&known.compliance));
}

/* A force that rises linearly over three substeps is 1/3, 2/3 and 1 at their ends */
static void a_ramp_is_the_sum_of_its_hats(void **state)
{
  Known              known = create(LEVELS), single = create(1);
  const PetscScalar *ramp, *matrix;
  PetscInt           leading;

  (void)state;
  for (PetscInt pass = 0; pass < 2; pass++) { /* the second time with one row more */
    const PetscInt *place;

    set(&known, 3 + pass, LEVELS);
    ComplianceGetRows(known.compliance, NULL, NULL, &place);
    ok(ComplianceGetRamp(known.compliance, &leading, &ramp));
    near(ramp[place[3] * leading + place[3 + pass]], (entry(2, 3, 3 + pass) + 2 * entry(1, 3, 3 + pass) + 3 * entry(0, 3, 3 + pass)) / 3,
         1e-12);
  }
  set(&single, 3, 1);
  ok(ComplianceGetRamp(single.compliance, &leading, &ramp));
  ComplianceGetMatrix(single.compliance, 0, &leading, &matrix);
  assert_ptr_equal(ramp, matrix);
  ok(ComplianceDestroy(&known.compliance));
  ok(ComplianceDestroy(&single.compliance));
}

/* On another number of ranks rows have other numbers: row r is number (r + 2) modulo 7 there */
static void rows_get_other_numbers(void **state)
{
  static const PetscInt order[] = {4, 0, 6};
  Known                 known = create(LEVELS), other = create(LEVELS);
  PetscInt              now[ROWS], n, width = 0;
  PetscReal            *copy;
  const PetscReal      *values;
  const PetscInt       *place;
  Tables                packed, tables;

  (void)state;
  for (PetscInt i = 0; i < 3; i++) set(&known, order[i], i == 2 ? 1 : LEVELS);
  set(&other, 5, LEVELS); /* is no more known afterwards */
  ok(TablesCreate(PETSC_COMM_WORLD, &packed));
  ok(CompliancePack(known.compliance, "w", packed));
  /* the first rank has the table; one that is read from a file all of them have */
  ok(TablesCreate(PETSC_COMM_WORLD, &tables));
  if (known.begin == 0) ok(TablesGetNumbers(packed, "w", &width, &values));
  assert_int_equal(MPI_Bcast(&width, 1, MPIU_INT, 0, PETSC_COMM_WORLD), 0);
  ok(PetscMalloc1(width, &copy));
  if (known.begin == 0) ok(PetscArraycpy(copy, values, width));
  assert_int_equal(MPI_Bcast(copy, (int)width, MPIU_REAL, 0, PETSC_COMM_WORLD), 0);
  ok(TablesShare(tables, "w", 1, width, copy));
  for (PetscInt r = 0; r < ROWS; r++) now[r] = (r + 2) % ROWS;
  ok(ComplianceUnpack(other.compliance, "w", now, tables));
  ComplianceGetRows(other.compliance, &n, NULL, &place);
  assert_int_equal(n, 3);
  assert_int_equal(place[5], -1);
  assert_true(ComplianceKnows(other.compliance, now[0]));
  assert_false(ComplianceKnows(other.compliance, now[6]));
  for (PetscInt k = 0; k < LEVELS; k++) {
    const PetscScalar *matrix;
    PetscInt           leading;

    ComplianceGetMatrix(other.compliance, k, &leading, &matrix);
    for (PetscInt i = 0; i < 2; i++)
      for (PetscInt j = 0; j < 2; j++) near(matrix[place[now[order[j]]] * leading + place[now[order[i]]]], entry(k, order[i], order[j]), 0);
    near(matrix[place[now[6]] * leading + place[now[4]]], k ? 0 : entry(0, 4, 6), 0);
  }
  ok(ComplianceReserve(other.compliance, ROWS - 3)); /* moves what is there */
  set(&other, 3, LEVELS);
  assert_true(ComplianceKnows(other.compliance, 3));
  copy[0] = ROWS + 1;
  refused(PETSC_ERR_FILE_UNEXPECTED, "numbers in 'w' for 8 rows|another problem", ComplianceUnpack(other.compliance, "w", now, tables));
  ok(TablesDestroy(&packed));
  ok(TablesDestroy(&tables));
  ok(ComplianceDestroy(&known.compliance));
  ok(ComplianceDestroy(&other.compliance));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_bring_their_columns),         cmocka_unit_test(a_column_may_be_known_in_part),
      cmocka_unit_test(rows_are_forgotten_and_come_back), cmocka_unit_test(a_ramp_is_the_sum_of_its_hats),
      cmocka_unit_test(rows_get_other_numbers),
  };

  return impakt_main(argc, argv, tests);
}
