/* long: 3 */
/* Rows between non-matching surfaces in two and three dimensions: what they reproduce and conserve, and when they are built. */
#include "interfaces.h"

#define QUADS     PETSC_FALSE
#define SIMPLICES PETSC_TRUE
#define PAIRS     5
static const PetscInt    pair_dim[PAIRS]      = {2, 2, 3, 3, 3};
static const char *const pair_faces[PAIRS][2] = {
    {"2,1", "4,1"}, {"3,1", "5,1"}, {"2,2,1", "4,4,1"}, {"3,3,1", "2,2,1"}, {"3,2,1", "2,2,1"}};
static const PetscBool pair_simplex[PAIRS][2] = {{QUADS, QUADS}, {QUADS, SIMPLICES}, {QUADS, QUADS}, {QUADS, QUADS}, {QUADS, SIMPLICES}};

static const PetscReal nowhere[3] = {0, 0, 0};

static Map straight_map(PetscInt dim, PetscInt which)
{
  return !which ? map_nothing : dim == 2 ? map_oblique_2d : map_oblique;
}

static void open_pair(Interface *interface, PetscInt pair, PetscBool flip, Map map)
{
  interface_create(interface, pair_dim[pair], pair_faces[pair], pair_simplex[pair], flip);
  for (PetscInt side = 0; side < 2; side++) move_mesh(interface->dm[side], map, nowhere, interface->u[side]);
  assert_true(interface_update(interface, PETSC_MAX_REAL, 1));
}

/* Patch test: a uniform pressure on the Dirichlet side is one on the Neumann side, whose nodes get the integrals of their functions. To the
   round-off of about a hundred terms of size 1; Dunavant's weights have 15 digits. */
static void uniform_pressure_stays_uniform(void **state)
{
  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++)
    for (PetscInt variant = 0; variant < 4; variant++) {
      const SurfaceData *data;
      const PetscScalar *f;
      PetscInt           start;
      Interface          interface;
      Vec                force;

      open_pair(&interface, pair, (PetscBool)(variant % 2), straight_map(pair_dim[pair], variant / 2));
      force = interface_force(&interface, 1, PETSC_TRUE);
      ok(SurfaceGetData(interface.surface[1], &data));
      ok(VecGetOwnershipRange(force, &start, NULL));
      ok(VecGetArrayRead(force, &f));
      for (PetscInt i = 0; i < data->n_owned; i++)
        for (PetscInt d = 0; d < interface.dim; d++) near(f[data->dofs[i] - start + d], -data->areas[i] * data->normals[3 * i + d], 1e-13);
      ok(VecRestoreArrayRead(force, &f));
      ok(VecDestroy(&force));
      interface_destroy(&interface);
    }
}

/* Every node has something opposite, at no distance; the areas are those of the surface */
static void flat_rows(void **state)
{
  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++)
    for (PetscInt variant = 0; variant < 4; variant++) {
      const SurfaceData *data;
      Interface          interface;

      open_pair(&interface, pair, (PetscBool)(variant % 2), straight_map(pair_dim[pair], variant / 2));
      ok(SurfaceGetData(interface.surface[0], &data));
      assert_int_equal(interface.rows.n, data->n_owned);
      for (PetscInt i = 0; i < interface.rows.n; i++) {
        assert_true(interface.rows.opposite[i]);
        assert_true(interface.rows.changed[i]);
        near(interface.rows.area[i], data->areas[i], 1e-14);
        near(interface.rows.dip[i], 0, 1e-14); /* no point of the partner is closer than the row says */
        if (variant < 2) near(interface.rows.gap[i], 0, 1e-14);
      }
      interface_destroy(&interface);
    }
}

/* All components of sum_j P_ij u_j - u_i of a field linear in x are zero, since the surfaces are in the same place: the tied rows */
static void linear_fields_are_reproduced(void **state)
{
  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++) {
    Interface interface;
    Vec       field[2], moved[2];
    PetscReal difference, size;

    open_pair(&interface, pair, PETSC_FALSE, map_nothing);
    (void)interface_update(&interface, PETSC_MAX_REAL, interface.dim);
    for (PetscInt side = 0; side < 2; side++) {
      const SurfaceData *data;

      ok(MatCreateVecs(interface.matrix[side], &field[side], &moved[side]));
      ok(SurfaceGetData(interface.surface[side], &data));
      for (PetscInt i = 0; i < data->n_owned; i++)
        for (PetscInt d = 0; d < interface.dim; d++) {
          const PetscReal *x = data->reference + 3 * i;

          ok(VecSetValue(field[side], data->dofs[i] + d, 0.3 + (d + 1) * (0.7 * x[0] - 0.4 * x[1] + 0.2 * x[2]), INSERT_VALUES));
        }
      ok(VecAssemblyBegin(field[side]));
      ok(VecAssemblyEnd(field[side]));
      ok(MatMult(interface.matrix[side], field[side], moved[side]));
    }
    ok(VecNorm(moved[0], NORM_INFINITY, &size));
    assert_true(size > 0.5);
    ok(VecAXPY(moved[1], -1, moved[0]));
    ok(VecNorm(moved[1], NORM_INFINITY, &difference));
    near(difference, 0, 1e-13);
    for (PetscInt side = 0; side < 2; side++) {
      ok(VecDestroy(&field[side]));
      ok(VecDestroy(&moved[side]));
    }
    interface_destroy(&interface);
  }
}

/* Forces of any pressure have one resultant and moment on both sides */
static void check_balance(Interface *interface)
{
  PetscReal sums[2][6];

  for (PetscInt side = 0; side < 2; side++) {
    Vec force = interface_force(interface, side, PETSC_FALSE);

    interface_resultant(interface, side, force, sums[side]);
    ok(VecDestroy(&force));
  }
  assert_true(PetscAbsReal(sums[0][interface->dim - 1]) > 0.1);
  for (PetscInt i = 0; i < 6; i++) near(sums[1][i], sums[0][i], 1e-13);
}

/* Any pressure on a curved interface whose two sides do not fit: the same force and moment on both sides */
static void force_and_moment_are_conserved(void **state)
{
  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++)
    for (PetscInt flip = 0; flip < 2; flip++) {
      Interface interface;

      open_pair(&interface, pair, (PetscBool)flip, pair_dim[pair] == 2 ? map_curved_2d : map_curved);
      assert_true(interface.n_opposite > 2);
      check_balance(&interface);
      interface_destroy(&interface);
    }
}

/* Moved together or by less than the bounds: nothing is built. Beyond them: all is, and only rows that differ are said to have changed */
static void rows_are_built_when_needed(void **state)
{
  const PetscReal small[3] = {0.01, 0, 0}, slip[3] = {0.03, 0, 0}, far[3] = {7, 8, 9};
  TransferCounts  counts;
  PetscInt        changed = 0;
  Interface       interface;

  (void)state;
  open_pair(&interface, 2, PETSC_FALSE, map_nothing);
  for (PetscInt side = 0; side < 2; side++) move_mesh(interface.dm[side], map_nothing, far, interface.u[side]);
  assert_false(interface_update(&interface, PETSC_MAX_REAL, 1));
  move_mesh(interface.dm[0], map_nothing, nowhere, interface.u[0]);
  move_mesh(interface.dm[1], map_nothing, small, interface.u[1]);
  assert_false(interface_update(&interface, PETSC_MAX_REAL, 1)); /* faces of size 1/2: the bound is 0.025 */
  move_mesh(interface.dm[1], map_nothing, slip, interface.u[1]);
  assert_true(interface_update(&interface, PETSC_MAX_REAL, 1));
  for (PetscInt i = 0; i < interface.rows.n; i++) changed += interface.rows.changed[i];
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  assert_int_equal(changed, 9);
  assert_false(interface_update(&interface, PETSC_MAX_REAL, 1));
  ok(TransferSetBounds(interface.transfer, 0, 0));
  move_mesh(interface.dm[1], map_nothing, small, interface.u[1]);
  assert_true(interface_update(&interface, PETSC_MAX_REAL, 1));
  ok(TransferGetCounts(interface.transfer, &counts));
  assert_int_equal(counts.builds, 3);
  interface_destroy(&interface);
}

/* Half of the partner gone to the side: rows beyond its end are empty but for those that guard it, and the areas sum up to what is covered
 */
static void ends_are_covered_in_part(void **state)
{
  const PetscReal aside[3] = {0.6, 0, 0};
  PetscReal       area     = 0;
  Interface       interface;

  (void)state;
  interface_create(&interface, 3, pair_faces[3], pair_simplex[3], PETSC_FALSE);
  move_mesh(interface.dm[1], map_nothing, aside, interface.u[1]);
  (void)interface_update(&interface, 0.1, 1);
  assert_int_equal(interface.n_opposite, 12); /* of the nodes at x = 0, 1/3, 2/3, 1 all but those at 0; the partner ends at 0.6 */
  for (PetscInt i = 0; i < interface.rows.n; i++) area += interface.rows.area[i];
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &area, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  near(area, 0.4, 1e-13);
  interface_destroy(&interface);
}

/* Two entries for each edge of the Dirichlet surface and each component */
static void neighbours_share_an_edge(void **state)
{
  const PetscInt edges[PAIRS] = {2, 3, 12, 24, 17};

  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++) {
    PetscInt    row_begin = 0, n;
    PetscScalar sum;
    Interface   interface;
    Mat         neighbours;
    Vec         ones, counts;

    open_pair(&interface, pair, PETSC_FALSE, map_nothing);
    n = 2 * interface.rows.n;
    assert_int_equal(MPI_Scan(&n, &row_begin, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
    ok(MatCreate(PETSC_COMM_WORLD, &neighbours));
    ok(MatSetSizes(neighbours, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
    ok(MatSetUp(neighbours));
    ok(TransferSetNeighbours(interface.transfer, row_begin - n, 2, PETSC_MAX_REAL, neighbours));
    ok(MatAssemblyBegin(neighbours, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(neighbours, MAT_FINAL_ASSEMBLY));
    ok(MatCreateVecs(neighbours, &ones, &counts));
    ok(VecSet(ones, 1));
    ok(MatMult(neighbours, ones, counts));
    ok(VecSum(counts, &sum));
    assert_int_equal((PetscInt)PetscRealPart(sum), 2 * 2 * edges[pair]);
    ok(VecDestroy(&ones));
    ok(VecDestroy(&counts));
    ok(MatDestroy(&neighbours));
    interface_destroy(&interface);
  }
}

/* 0.02 apart at x = 0, and further where x is larger */
static void map_tilted_2d(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[1] += 0.02 + 0.1 * X[0];
}

static void map_tilted(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[2] += 0.02 + 0.1 * X[0];
}

/* A narrower partner that tilts toward its end at x = 0.6: the gap of the nodes before it, at 1/2 or 1/3, is that of the end, as is that of
   no row without guards; other gaps are those of the straight partner, 0.06 at x = 1. Resultant and moment agree. */
static void ends_are_guarded(void **state)
{
  const PetscReal aside[3] = {0.6, 0, 0};

  (void)state;
  for (PetscInt variant = 0; variant < 4; variant++) {
    const PetscBool    guards = (PetscBool)(variant % 2 == 0);
    const PetscInt     pair   = variant < 2 ? 0 : 3;
    const SurfaceData *data;
    const PetscScalar *gaps;
    PetscReal          smallest = 1;
    Interface          interface;
    Vec                moved;

    interface_create(&interface, pair_dim[pair], pair_faces[pair], pair_simplex[pair], PETSC_FALSE);
    ok(TransferSetGuards(interface.transfer, guards));
    move_mesh(interface.dm[1], pair_dim[pair] == 2 ? map_tilted_2d : map_tilted, aside, interface.u[1]);
    (void)interface_update(&interface, 1, 1);
    refused(PETSC_ERR_ARG_WRONGSTATE, "before TransferUpdate", TransferSetGuards(interface.transfer, guards));
    assert_int_equal(interface.n_opposite, pair == 0 ? 1 + guards : 4 * (2 + guards));
    ok(SurfaceGetData(interface.surface[0], &data));
    ok(MatCreateVecs(interface.matrix[1], NULL, &moved));
    ok(MatMult(interface.matrix[1], interface.u[1], moved));
    ok(VecGetArrayRead(moved, &gaps));
    for (PetscInt i = 0; i < interface.rows.n; i++) {
      const PetscReal x = data->positions[3 * i], gap = interface.rows.gap[i] + PetscRealPart(gaps[i]);

      if (!interface.rows.opposite[i]) continue;
      assert_int_equal(interface.rows.beyond[i], x < 0.6);
      if (guards) near(gap, x < 0.6 ? 0.02 : 0.02 + 0.1 * (x - 0.6), 1e-13);
      smallest = PetscMin(smallest, gap);
    }
    ok(VecRestoreArrayRead(moved, &gaps));
    ok(VecDestroy(&moved));
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPIU_REAL, MPI_MIN, PETSC_COMM_WORLD), 0);
    if (!guards) assert_true(smallest > 0.0225); /* a mean over what is covered, above the gap at the end */
    check_balance(&interface);
    interface_destroy(&interface);
  }
}

/* Twice as many faces in each direction, four times as many pairs that are compared, but for the edges */
static void search_costs_in_proportion(void **state)
{
  const char *const coarse[2] = {"8,8,1", "9,9,1"}, *const fine[2] = {"16,16,1", "18,18,1"};
  TransferCounts counts[2];

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    Interface interface;

    interface_create(&interface, 3, i ? fine : coarse, pair_simplex[2], PETSC_FALSE);
    (void)interface_update(&interface, 0.1, 1);
    ok(TransferGetCounts(interface.transfer, &counts[i]));
    interface_destroy(&interface);
  }
  between((PetscReal)counts[1].segments / (PetscReal)counts[0].segments, 3.5, 4.5);
  between((PetscReal)counts[1].candidates / (PetscReal)counts[0].candidates, 3.2, 5.5);
  assert_true(counts[1].candidates < 20 * 16 * 16);
}

/* What matrices of rows are made with: as many entries as they get, neither fewer nor more */
static void entries_are_counted(void **state)
{
  (void)state;
  for (PetscInt pair = 0; pair < PAIRS; pair++) {
    Interface interface;
    PetscInt *counts[2];

    open_pair(&interface, pair, PETSC_FALSE, map_nothing);
    ok(PetscMalloc2(interface.rows.n, &counts[0], interface.rows.n, &counts[1]));
    ok(TransferCountValues(interface.transfer, counts[0], counts[1]));
    for (PetscInt i = 0; i < interface.rows.n; i++)
      for (PetscInt side = 0; side < 2; side++) {
        PetscInt n;

        ok(MatGetRow(interface.matrix[side], interface.begin + i, &n, NULL, NULL));
        assert_int_equal(counts[side][i], n);
        if (!side) assert_int_equal(n, interface.dim);
        ok(MatRestoreRow(interface.matrix[side], interface.begin + i, &n, NULL, NULL));
      }
    ok(PetscFree2(counts[0], counts[1]));
    interface_destroy(&interface);
  }
}

/* Rows that have been put aside come back to the last bit, however often: whether they have followed the surfaces since, have been built
   again, or have done neither between two times that they were put aside */
static void rows_come_back(void **state)
{
  const PetscReal slips[] = {0.005, 0.01, 0.2, 0.005}; /* m; rows are built again from 0.0125 on */

  (void)state;
  for (PetscInt pair = 0; pair < 2; pair++) {
    Interface  interface;
    Mat        first[2];
    PetscBool *touches, follows;

    open_pair(&interface, pair, PETSC_FALSE, map_nothing);
    ok(PetscMalloc1(interface.rows.n, &touches));
    for (PetscInt i = 0; i < interface.rows.n; i++) touches[i] = PETSC_TRUE;
    for (PetscInt side = 0; side < 2; side++) ok(MatDuplicate(interface.matrix[side], MAT_COPY_VALUES, &first[side]));
    for (PetscInt i = 0; i < 4; i++) {
      const PetscReal slip[3] = {slips[i], 0, 0};
      PetscBool       rebuilt, same;

      ok(TransferSave(interface.transfer));
      for (PetscInt again = 0; again < 2; again++) {
        move_mesh(interface.dm[1], map_nothing, slip, interface.u[1]);
        ok(TransferUpdate(interface.transfer, interface.u[0], interface.u[1], PETSC_MAX_REAL, &rebuilt));
        assert_int_equal(rebuilt, slips[i] > 0.1);
        ok(TransferFollow(interface.transfer, touches, 1, 0, PETSC_FALSE, 1, 1, &follows));
        /* it tells of this rank's rows, and there may be none */
        assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &follows, 1, MPI_C_BOOL, MPI_LOR, PETSC_COMM_WORLD), 0);
        assert_true(follows);
        ok(TransferRestore(interface.transfer));
        move_mesh(interface.dm[1], map_nothing, nowhere, interface.u[1]);
        assert_false(interface_update(&interface, PETSC_MAX_REAL, 1));
        for (PetscInt side = 0; side < 2; side++) {
          ok(MatEqual(first[side], interface.matrix[side], &same));
          assert_true(same);
        }
      }
    }
    ok(PetscFree(touches));
    for (PetscInt side = 0; side < 2; side++) ok(MatDestroy(&first[side]));
    interface_destroy(&interface);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(uniform_pressure_stays_uniform),
      simulation_test(flat_rows),
      simulation_test(linear_fields_are_reproduced),
      simulation_test(force_and_moment_are_conserved),
      simulation_test(rows_are_built_when_needed),
      simulation_test(ends_are_covered_in_part),
      simulation_test(neighbours_share_an_edge),
      simulation_test(ends_are_guarded),
      simulation_test(search_costs_in_proportion),
      simulation_test(entries_are_counted),
      simulation_test(rows_come_back),
  };

  return impakt_main(argc, argv, tests);
}
