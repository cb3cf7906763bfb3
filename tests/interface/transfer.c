/* ranks: 1 3 */
/* Rows between the ends of bars, between non-matching surfaces in two and three dimensions, and over rigid obstacles: which nodes face each
   other, at what gap, what rows reproduce and conserve, and when they are built. */
#include "interfaces.h"

typedef struct {
  DM           dm[2];
  Surface      surface[2], whole[2];
  Transfer     transfer;
  TransferRows rows;
  PetscInt     n;                 /* rows of all ranks that have something opposite */
  PetscReal    gap, area, normal; /* of the only one */
} Bars;

static PetscReal sum_of(PetscReal mine)
{
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return mine;
}

static void bars_create(const char *const lower[], const char *const upper[], const char *const names[], PetscReal near, Bars *bars)
{
  PetscReal       sums[4] = {0};
  TransferOptions options = bounds;
  PetscBool       rebuilt;

  for (PetscInt side = 0; side < 2; side++) {
    bars->dm[side] = CreateBoxMesh(side ? "neumann" : "dirichlet", 1, side ? "3" : "4", lower[side], upper[side], PETSC_TRUE);
    ok(SurfaceCreate(bars->dm[side], names[side], &bars->surface[side]));
    ok(SurfaceCreate(bars->dm[side], NULL, &bars->whole[side]));
    options.boundaries[side] = bars->whole[side];
  }
  ok(SurfaceKeepFacing(bars->surface[0], bars->surface[1], NULL, (PetscBool)!names[0], (PetscBool)!names[1]));
  ok(TransferCreate(PETSC_COMM_WORLD, bars->surface[0], bars->surface[1], NULL, &options, &bars->transfer));
  ok(TransferUpdate(bars->transfer, NULL, NULL, near, &rebuilt));
  assert_true(rebuilt);
  ok(TransferGetRows(bars->transfer, &bars->rows));
  for (PetscInt i = 0; i < bars->rows.n; i++) {
    if (!bars->rows.opposite[i]) continue;
    sums[0] += 1;
    sums[1] += bars->rows.gap[i];
    sums[2] += bars->rows.area[i];
    sums[3] += bars->rows.normals[i];
  }
  bars->n      = (PetscInt)sum_of(sums[0]);
  bars->gap    = sum_of(sums[1]);
  bars->area   = sum_of(sums[2]);
  bars->normal = sum_of(sums[3]);
}

static void bars_destroy(Bars *bars)
{
  ok(TransferDestroy(&bars->transfer));
  for (PetscInt side = 0; side < 2; side++) {
    ok(SurfaceDestroy(&bars->surface[side]));
    ok(SurfaceDestroy(&bars->whole[side]));
    ok(DMDestroy(&bars->dm[side]));
  }
}

static void bars_that_face_each_other(void **state)
{
  /* the second time the other way round, the Dirichlet normal pointing left; then with all ends, far ones too */
  const char *const lower[] = {"0", "1.25", "0"}, *const upper[] = {"1", "2", "1"}, *const names[2][2] = {{NULL, NULL}, {"all", "all"}};
  Bars bars;

  (void)state;
  for (PetscInt order = 0; order < 2; order++)
    for (PetscInt all = 0; all < 2; all++) {
      bars_create(lower + order, upper + order, names[all], PETSC_MAX_REAL, &bars);
      assert_int_equal(bars.n, 1); /* the far ends look at each other too, but across both bars */
      assert_int_equal((PetscInt)sum_of(bars.rows.n), all ? 2 : 1);
      near(bars.gap, 0.25, 1e-15);
      near(bars.area, 1, 0);
      near(bars.normal, order ? -1 : 1, 0);
      bars_destroy(&bars);
    }
}

/* The near ends 0.1 inside each other, or at the same place; the far ends, 2 apart, are no row */
static void overlap_is_a_negative_gap(void **state)
{
  const char *const right[] = {"0.9", "1"}, *const upper[] = {"1", "2"}, *const names[2][2] = {{NULL, NULL}, {"all", "all"}};
  const PetscReal gaps[] = {-0.1, 0};
  Bars            bars;

  (void)state;
  for (PetscInt i = 0; i < 4; i++) {
    const char *const lower[] = {"0", right[i % 2]};

    bars_create(lower, upper, names[i / 2], PETSC_MAX_REAL, &bars);
    assert_int_equal(bars.n, 1);
    near(bars.gap, gaps[i % 2], 1e-15);
    bars_destroy(&bars);
  }
}

static void surfaces_that_do_not_face_each_other(void **state)
{
  /* both look right; both look left; they look away from each other */
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"},
                    *const names[][2] = {{"xmax", "xmax"}, {"xmin", "xmin"}, {"xmin", "xmax"}};
  Bars                     bars;

  (void)state;
  for (PetscInt i = 0; i < 3; i++) {
    bars_create(lower, upper, names[i], PETSC_MAX_REAL, &bars);
    assert_int_equal(bars.n, 0);
    bars_destroy(&bars);
  }
}

static void dimensions_must_agree(void **state)
{
  DM       dm[] = {CreateBoxMesh("line", 1, "4", "0", "1", PETSC_TRUE), CreateBoxMesh("rectangle", 2, "2,2", "0,0", "1,1", PETSC_FALSE)};
  Surface  surface[2];
  Transfer transfer;

  (void)state;
  for (PetscInt i = 0; i < 2; i++) ok(SurfaceCreate(dm[i], NULL, &surface[i]));
  refused(PETSC_ERR_USER_INPUT, "1 and 2 dimensions", TransferCreate(PETSC_COMM_WORLD, surface[0], surface[1], NULL, &bounds, &transfer));
  ok(TransferDestroy(&transfer));
  refused(PETSC_ERR_USER_INPUT, "1 and 2 dimensions", SurfaceKeepFacing(surface[0], surface[1], NULL, PETSC_TRUE, PETSC_TRUE));
  for (PetscInt i = 0; i < 2; i++) {
    ok(SurfaceDestroy(&surface[i]));
    ok(DMDestroy(&dm[i]));
  }
}

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
   round-off of about a hundred terms of size 1; Dunavant's weights have 15 digits. Every node has something opposite, at no distance; the
   areas are those of the surface. */
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
      ok(SurfaceGetData(interface.surface[0], &data));
      assert_int_equal(interface.rows.n, data->n_owned);
      for (PetscInt i = 0; i < interface.rows.n; i++) {
        assert_true(interface.rows.opposite[i] && interface.rows.changed[i]);
        near(interface.rows.area[i], data->areas[i], 1e-14);
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
    ok(VecAXPY(moved[1], 1, moved[0]));
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
  for (PetscInt i = 0; i < 6; i++) near(sums[1][i], -sums[0][i], 1e-13);
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
    const PetscBool       guards  = (PetscBool)(variant % 2 == 0);
    const TransferOptions options = {.slip_bound = 0.05, .angle_bound = 0.02, .unguarded = (PetscBool)!guards};
    const PetscInt        pair    = variant < 2 ? 0 : 3;
    const SurfaceData    *data;
    const PetscScalar    *gaps;
    PetscReal             smallest = 1;
    Interface             interface;
    Vec                   moved;

    interface_create(&interface, pair_dim[pair], pair_faces[pair], pair_simplex[pair], PETSC_FALSE);
    ok(TransferDestroy(&interface.transfer));
    ok(TransferCreate(PETSC_COMM_WORLD, interface.surface[0], interface.surface[1], NULL, &options, &interface.transfer));
    move_mesh(interface.dm[1], pair_dim[pair] == 2 ? map_tilted_2d : map_tilted, aside, interface.u[1]);
    (void)interface_update(&interface, 1, 1);
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

/* distance and normal at a point, by hand */
static void check(Obstacle obstacle, const PetscReal point[3], PetscReal expected, const PetscReal direction[3])
{
  PetscReal distance, normal[3];

  ok(ObstacleGetGap(obstacle, point, &distance, normal));
  near(distance, expected, 1e-14);
  for (PetscInt d = 0; d < 3; d++) near(normal[d], direction[d], 1e-14);
}

static void distances(void **state)
{
  Obstacle obstacle;

  (void)state;
  AddOptions("-p_obstacle_type plane -p_point 1,2,3 -p_normal 0,3,4 -s_obstacle_type sphere -s_point 1,0,0 -s_radius 2 -c_obstacle_type "
             "cylinder -c_point 0,0,5 -c_axis 0,2,0 -c_radius 1 -d_obstacle_type cylinder -d_point 1,1 -d_radius 0.5");
  ok(ObstacleCreate(PETSC_COMM_WORLD, "p", &obstacle));
  ok(ObstacleSetFromOptions(obstacle));
  check(obstacle, (PetscReal[3]){7, 7, 3}, 3, (PetscReal[3]){0, 0.6, 0.8}); /* 0.6 (7 - 2) */
  check(obstacle, (PetscReal[3]){0, 2, -2}, -4, (PetscReal[3]){0, 0.6, 0.8});
  ok(ObstacleDestroy(&obstacle));
  assert_null(obstacle);
  ok(ObstacleCreate(PETSC_COMM_WORLD, "s", &obstacle));
  ok(ObstacleSetFromOptions(obstacle));
  check(obstacle, (PetscReal[3]){1, 3, 4}, 3, (PetscReal[3]){0, 0.6, 0.8});
  check(obstacle, (PetscReal[3]){0, 0, 0}, -1, (PetscReal[3]){-1, 0, 0});
  ok(ObstacleDestroy(&obstacle));
  ok(ObstacleCreate(PETSC_COMM_WORLD, "c", &obstacle));
  ok(ObstacleSetFromOptions(obstacle));
  check(obstacle, (PetscReal[3]){3, 100, 9}, 4, (PetscReal[3]){0.6, 0, 0.8});
  ok(ObstacleDestroy(&obstacle));
  ok(ObstacleCreate(PETSC_COMM_WORLD, "d", &obstacle));
  ok(ObstacleSetFromOptions(obstacle));
  check(obstacle, (PetscReal[3]){1, 3, 0}, 1.5, (PetscReal[3]){0, 1, 0});
  ok(ObstacleDestroy(&obstacle));
}

static void bad_values_are_refused(void **state)
{
  static const char *const options[][2] = {
      {"", "-floor_obstacle_type"},
      {"-floor_obstacle_type plane", "-floor_point"},
      {"-floor_obstacle_type plane -floor_point 0,0,0", "-floor_normal"},
      {"-floor_obstacle_type plane -floor_point 0,0,0 -floor_normal 0,0,0", "zero vector"},
      {"-floor_obstacle_type sphere -floor_point 0,0,0", "-floor_radius"},
      {"-floor_obstacle_type sphere -floor_point 0,0,0 -floor_radius -1", "positive radius"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(options) / sizeof(options[0]); i++) {
    PetscOptions own = options_begin("%s", options[i][0]);
    Obstacle     obstacle;

    ok(ObstacleCreate(PETSC_COMM_WORLD, "floor", &obstacle));
    refused(PETSC_ERR_USER_INPUT, options[i][1], ObstacleSetFromOptions(obstacle));
    ok(ObstacleDestroy(&obstacle));
    options_drop(own);
  }
}

/* A square over a floor 0.1 below it, and over a disc: rows of its lower side alone, whose gaps follow u as the matrix says */
static void rows_over_obstacles(void **state)
{
  const PetscReal down[3] = {0.02, -0.05, 0};

  (void)state;
  AddOptions(
      "-floor_obstacle_type plane -floor_point 0,-0.1 -floor_normal 0,1 -disc_obstacle_type cylinder -disc_point 0.5,-1.1 -disc_radius 1");
  for (PetscInt disc = 0; disc < 2; disc++) {
    DM                 dm = CreateBoxMesh("square", 2, "4,3", "0,0", "1,1", PETSC_FALSE);
    const SurfaceData *data;
    const PetscScalar *moved;
    PetscInt           n, start;
    PetscBool          rebuilt;
    TransferRows       rows;
    Obstacle           obstacle;
    Surface            surface;
    Transfer           transfer;
    Vec                u, change;
    Mat                matrix;

    ok(ObstacleCreate(PETSC_COMM_WORLD, disc ? "disc" : "floor", &obstacle));
    ok(ObstacleSetFromOptions(obstacle));
    ok(SurfaceCreate(dm, NULL, &surface));
    ok(SurfaceKeepFacing(surface, NULL, obstacle, PETSC_TRUE, PETSC_FALSE));
    ok(SurfaceGetData(surface, &data));
    n = data->n_owned;
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
    if (!disc) assert_int_equal(n, 5);
    ok(TransferCreate(PETSC_COMM_WORLD, surface, NULL, obstacle, &bounds, &transfer));
    ok(TransferSetBounds(transfer, 0.05, 1e-6)); /* every row whose normal has turned is built again */
    ok(DMCreateGlobalVector(dm, &u));
    for (PetscInt moves = 0; moves < 2; moves++) {
      if (moves) move_mesh(dm, map_nothing, down, u);
      ok(TransferUpdate(transfer, u, NULL, PETSC_MAX_REAL, &rebuilt));
      assert_int_equal(rebuilt, !moves || disc); /* the normal of a plane never turns; that of the disc by 0.02 / 1.1 or more at its top */
    }
    ok(TransferGetRows(transfer, &rows));
    ok(VecGetLocalSize(u, &n));
    ok(MatCreateAIJ(PETSC_COMM_WORLD, rows.n, n, PETSC_DETERMINE, PETSC_DETERMINE, 2, NULL, 2, NULL, &matrix));
    ok(MatGetOwnershipRange(matrix, &start, NULL));
    ok(TransferSetValues(transfer, (const PetscInt[]){start, 0}, 1, NULL, (const Mat[]){matrix, NULL}));
    ok(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    ok(MatCreateVecs(matrix, NULL, &change));
    ok(MatMult(matrix, u, change));
    ok(VecGetArrayRead(change, &moved));
    for (PetscInt i = 0; i < rows.n; i++) {
      PetscReal distance, normal[3];

      if (!rows.opposite[i]) continue;
      ok(ObstacleGetGap(obstacle, data->positions + 3 * i, &distance, normal));
      near(rows.gap[i] + moved[i], distance, 1e-14);
      for (PetscInt d = 0; d < 2; d++) near(rows.normals[2 * i + d], -normal[d], 1e-14);
      near(rows.area[i], data->areas[i], 0);
    }
    ok(VecRestoreArrayRead(change, &moved));
    ok(VecDestroy(&change));
    ok(VecDestroy(&u));
    ok(MatDestroy(&matrix));
    ok(TransferDestroy(&transfer));
    ok(SurfaceDestroy(&surface));
    ok(ObstacleDestroy(&obstacle));
    ok(DMDestroy(&dm));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(bars_that_face_each_other),
      simulation_test(overlap_is_a_negative_gap),
      simulation_test(surfaces_that_do_not_face_each_other),
      simulation_test(dimensions_must_agree),
      simulation_test(uniform_pressure_stays_uniform),
      simulation_test(linear_fields_are_reproduced),
      simulation_test(force_and_moment_are_conserved),
      simulation_test(rows_are_built_when_needed),
      simulation_test(ends_are_covered_in_part),
      simulation_test(ends_are_guarded),
      simulation_test(distances),
      simulation_test(bad_values_are_refused),
      simulation_test(rows_over_obstacles),
  };

  return impakt_main(argc, argv, tests);
}
