/* Rigid obstacles: their distance, their rows, and what they refuse. */
#include "interfaces.h"

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
  ok(ObstacleCreateFromOptions(PETSC_COMM_WORLD, "p", &obstacle));
  check(obstacle, (PetscReal[3]){7, 7, 3}, 3, (PetscReal[3]){0, 0.6, 0.8}); /* 0.6 (7 - 2) */
  check(obstacle, (PetscReal[3]){0, 2, -2}, -4, (PetscReal[3]){0, 0.6, 0.8});
  ok(ObstacleDestroy(&obstacle));
  assert_null(obstacle);
  ok(ObstacleCreateFromOptions(PETSC_COMM_WORLD, "s", &obstacle));
  check(obstacle, (PetscReal[3]){1, 3, 4}, 3, (PetscReal[3]){0, 0.6, 0.8});
  check(obstacle, (PetscReal[3]){0, 0, 0}, -1, (PetscReal[3]){-1, 0, 0});
  ok(ObstacleDestroy(&obstacle));
  ok(ObstacleCreateFromOptions(PETSC_COMM_WORLD, "c", &obstacle));
  check(obstacle, (PetscReal[3]){3, 100, 9}, 4, (PetscReal[3]){0.6, 0, 0.8});
  ok(ObstacleDestroy(&obstacle));
  ok(ObstacleCreateFromOptions(PETSC_COMM_WORLD, "d", &obstacle));
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
    PetscOptions own      = options_begin("%s", options[i][0]);
    Obstacle     obstacle = NULL;

    refused(PETSC_ERR_USER_INPUT, options[i][1], ObstacleCreateFromOptions(PETSC_COMM_WORLD, "floor", &obstacle));
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

    ok(ObstacleCreateFromOptions(PETSC_COMM_WORLD, disc ? "disc" : "floor", &obstacle));
    ok(SurfaceCreate(dm, NULL, &surface));
    ok(SurfaceKeepFacing(surface, NULL, obstacle, PETSC_TRUE, PETSC_FALSE));
    ok(SurfaceGetData(surface, &data));
    n = data->n_owned;
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
    if (!disc) assert_int_equal(n, 5);
    ok(TransferCreate(PETSC_COMM_WORLD, surface, NULL, obstacle, &transfer));
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
    ok(TransferSetValues(transfer, (const PetscInt[]){start, 0}, 1, (const Mat[]){matrix, NULL}));
    ok(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    ok(MatCreateVecs(matrix, NULL, &change));
    ok(MatMult(matrix, u, change));
    ok(VecGetArrayRead(change, &moved));
    for (PetscInt i = 0; i < rows.n; i++) {
      PetscReal distance, normal[3];

      if (!rows.opposite[i]) continue;
      ok(ObstacleGetGap(obstacle, data->positions + 3 * i, &distance, normal));
      near(rows.gap[i] - moved[i], distance, 1e-14);
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
      simulation_test(distances),
      simulation_test(bad_values_are_refused),
      simulation_test(rows_over_obstacles),
  };

  return impakt_main(argc, argv, tests);
}
