/* ranks: 1 3 */
/* Meshes of boxes from options, their place in space, their surfaces and node sets; Gmsh and Exodus files: mesh_files.c. */
#include "meshes.h"

/* [0,1] x [0,2] x [0,3] as far as it has dimensions, with 2 x 3 x 2 cells or 2, 6 or 6 times as many simplices */
static DM CreateBox(PetscInt dim, PetscBool simplex, const char more[])
{
  const char *const faces[] = {"6", "2,3", "2,3,2"}, *const upper[] = {"1", "1,2", "1,2,3"};

  return create_mesh("-dm_plex_dim %d -dm_plex_box_faces %s -dm_plex_box_upper %s %s %s", (int)dim, faces[dim - 1], upper[dim - 1],
                     dim > 1 ? (simplex ? "-dm_plex_simplex 1" : "-dm_plex_simplex 0") : "", more);
}

/* A mesh that did not fit at inner faces would have these on its boundary too */
static void CheckBoundary(DM dm, PetscInt dim, PetscInt parts)
{
  const char *const names[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  const PetscInt    cells[] = {2, 3, 2};
  PetscInt          total   = 0;
  PetscReal         area    = 0;

  for (PetscInt side = 0; side < 2 * dim; side++) {
    const SurfaceFacts facts        = surface_facts(dm, names[side]);
    PetscInt           n_expected   = dim == 3 ? parts : 1;
    PetscReal          area_of_side = 1;

    for (PetscInt d = 0; d < dim; d++)
      if (d != side / 2) {
        n_expected *= cells[d];
        area_of_side *= d + 1;
      }
    assert_int_equal(facts.n, n_expected);
    near(facts.area, area_of_side, 1e-13); /* round-off of some additions of numbers of size 1 */
    if (dim > 1) near(facts.centre[side / 2], side % 2 ? side / 2 + 1 : 0, 1e-14);
    total += facts.n;
    area += facts.area;
  }
  assert_int_equal(surface_facts(dm, NULL).n, total);
  near(surface_facts(dm, "").area, area, 1e-12);
}

static void boxes_of_all_shapes(void **state)
{
  const PetscInt cells[] = {6, 6, 12}, per_cell[] = {1, 2, 6};
  const double   volume[] = {1, 2, 6};

  (void)state;
  for (PetscInt dim = 1; dim <= 3; dim++)
    for (PetscInt simplex = dim > 1 ? 0 : 1; simplex < 2; simplex++) {
      DM       dm = CreateBox(dim, (PetscBool)simplex, "");
      PetscInt found;

      ok(DMGetDimension(dm, &found));
      assert_int_equal(found, dim);
      ok(DMGetCoordinateDim(dm, &found));
      assert_int_equal(found, dim);
      assert_int_equal(count_cells(dm), cells[dim - 1] * (simplex ? per_cell[dim - 1] : 1));
      near(volume_of(dm), volume[dim - 1], 1e-13);
      CheckBoundary(dm, dim, simplex ? 2 : 1);
      ok(DMDestroy(&dm));
    }
}

/* DMPLEX's numbers: 4, 2, 1, 3 in two dimensions, 6, 5, 3, 4, 1, 2 in three for xmin, xmax, ymin ..., also for simplices */
static void numbers_of_sides(void **state)
{
  const char *const numbers[2][6] = {{"4", "2", "1", "3"}, {"6", "5", "3", "4", "1", "2"}};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt simplex = 0; simplex < 2; simplex++) {
      DM dm = CreateBox(dim, (PetscBool)simplex, "");

      for (PetscInt side = 0; side < 2 * dim; side++) {
        const SurfaceFacts facts = surface_facts(dm, numbers[dim - 2][side]);

        near(facts.centre[side / 2], side % 2 ? side / 2 + 1 : 0, 1e-14);
      }
      assert_int_equal(surface_facts(dm, "marker").n, surface_facts(dm, NULL).n);
      ok(DMDestroy(&dm));
    }
}

static void parts_of_ranks(void **state)
{
  DM       dm = create_mesh("-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 6,6,6");
  PetscInt start, end, vstart, vend;

  (void)state;
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  ok(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  assert_true(end > start);
  if (size_of_world() > 1) {
    assert_true(end - start < 0.7 * 216); /* a half or a third, and what the partitioner is off by */
    assert_true(vend - vstart < 0.8 * 343);
  }
  ok(DMDestroy(&dm));
}

/* Scaled by 2, turned by a right angle about the line x = 1, y = 0 (x goes to y, y to -x), lifted by 5 */
static void place_in_space(void **state)
{
  DM dm = create_mesh(
      "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 3,2,2 -scale 2 -rotate 0,0,3,90 -rotate_centre 1,0,0 -translate 0,0,5");
  const PetscReal    expected[2][3] = {{-1, -1, 5}, {1, 1, 7}};
  PetscReal          lower[3], upper[3];
  const SurfaceFacts side = surface_facts(dm, "xmin");

  (void)state;
  ok(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < 3; d++) {
    near(lower[d], expected[0][d], 1e-14);
    near(upper[d], expected[1][d], 1e-14);
  }
  /* its middle (0, 1, 1) is at (-1, 1, 1) from the centre, turned at (-1, -1, 1) */
  assert_int_equal(side.n, 4);
  near(side.centre[0], 0, 1e-14);
  near(side.centre[1], -1, 1e-14);
  near(side.centre[2], 6, 1e-14);
  near(volume_of(dm), 8, 1e-13);
  ok(DMDestroy(&dm));
}

/* By 120 degrees about the diagonal, axes change places: x to y, y to z, z to x */
static void turn_about_diagonal(void **state)
{
  DM              dm         = CreateBox(3, PETSC_TRUE, "-rotate 1,1,1,120");
  const PetscReal expected[] = {3, 1, 2};
  PetscReal       lower[3], upper[3];

  (void)state;
  ok(DMGetBoundingBox(dm, lower, upper));
  for (PetscInt d = 0; d < 3; d++) {
    near(lower[d], 0, 1e-14);
    near(upper[d], expected[d], 1e-14);
  }
  near(surface_facts(dm, "xmax").centre[1], 1, 1e-14);
  ok(DMDestroy(&dm));
}

static void place_in_plane(void **state)
{
  DM                 dm   = CreateBox(2, PETSC_FALSE, "-rotate 30 -translate 1,0");
  const SurfaceFacts side = surface_facts(dm, "ymin");

  (void)state;
  /* its middle, (1/2, 0), turned by 30 degrees */
  near(side.centre[0], 1 + PetscSqrtReal(3.0) / 4, 1e-14);
  near(side.centre[1], 0.25, 1e-14);
  near(side.area, 1, 1e-14);
  ok(DMDestroy(&dm));
}

static void nodes_of_sides(void **state)
{
  (void)state;
  for (PetscInt simplex = 0; simplex < 2; simplex++) {
    DM       dm = CreateBox(3, (PetscBool)simplex, "");
    PetscInt n, *vertices, start, end;

    (void)check_nodes_at(dm, "xmin", 0, 0);
    (void)check_nodes_at(dm, "zmax", 2, 3);
    (void)check_nodes_at(dm, "4", 1, 2); /* ymax, by its number in "Face Sets" */
    ok(MeshGetNodeSet(dm, NULL, &n, &vertices));
    ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
    for (PetscInt v = start, i = 0; v < end; v++) {
      PetscReal x[3];
      PetscBool on = PETSC_FALSE;

      position_of(dm, v, x);
      for (PetscInt d = 0; d < 3; d++) on = (PetscBool)(on || x[d] < 1e-12 || x[d] > d + 1 - 1e-12);
      assert_int_equal(i < n && vertices[i] == v, on);
      i += on;
    }
    ok(PetscFree(vertices));
    ok(DMDestroy(&dm));
  }
  {
    DM dm = CreateBox(1, PETSC_TRUE, "");

    (void)check_nodes_at(dm, "xmax", 0, 1);
    ok(DMDestroy(&dm));
  }
}

static void unknown_names(void **state)
{
  DM       dm = CreateBox(2, PETSC_FALSE, "");
  PetscInt n, *points;

  (void)state;
  refused(PETSC_ERR_USER_INPUT, "'box'|surface 'top'|xmin, xmax, ymin, ymax, 1, 2, 3, 4", MeshGetSurface(dm, "top", &n, &points));
  refused(PETSC_ERR_USER_INPUT, "'box'|'zmin'", MeshGetSurface(dm, "zmin", &n, &points));
  refused(PETSC_ERR_USER_INPUT, "'box'|'5'", MeshGetSurface(dm, "5", &n, &points));
  refused(PETSC_ERR_USER_INPUT, "'box'|'depth'", MeshGetSurface(dm, "depth", &n, &points));
  refused(PETSC_ERR_USER_INPUT, "'box'|'top'", MeshGetNodeSet(dm, "top", &n, &points));
  ok(DMDestroy(&dm));
}

static void bad_boxes(void **state)
{
  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_dim 4", "-dm_plex_dim 4");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_box_faces|2 numbers|3", "-dm_plex_dim 3 -dm_plex_box_faces 2,2");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_box_faces|positive", "-dm_plex_dim 2 -dm_plex_box_faces 2,0");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_box_upper|1 number", "-dm_plex_dim 2 -dm_plex_box_upper 1");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_box_lower|axis 2", "-dm_plex_dim 2 -dm_plex_box_lower 0,1 -dm_plex_box_upper 1,1");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_blocks|-a_dm_plex_filename", "-dm_plex_dim 2 -mesh_blocks a");
}

static void bad_places(void **state)
{
  const char box[] = "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 3,3,3", plane[] = "-dm_plex_dim 2 -dm_plex_box_faces 3,3";

  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate|axis|(0, 0, 0)", "%s -rotate 0,0,0,30", box);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate|1 number|4", "%s -rotate 30", box);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate|4 numbers|1 ", "%s -rotate 0,0,1,30", plane);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate|one-dimensional", "-dm_plex_dim 1 -dm_plex_box_faces 9 -rotate 30");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate_centre|2 numbers|3", "%s -rotate 0,0,1,30 -rotate_centre 1,1", box);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate_centre without -a_rotate", "%s -rotate_centre 1,1,1", box);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_translate|3 numbers|2 ", "%s -translate 1,1,1", plane);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_scale 0|positive", "%s -scale 0", box);
}

/* Beyond all proportion: the option is blamed that did it, or could mend it */
static void bad_sizes(void **state)
{
  const char *const boxes[] = {"-dm_plex_dim 1 -dm_plex_box_faces 3", "-dm_plex_dim 2 -dm_plex_box_faces 3,3",
                               "-dm_plex_dim 3 -dm_plex_box_faces 3,3,3"};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(boxes); i++) {
    mesh_refused(PETSC_ERR_USER_INPUT, "1e-30 m large after -a_scale 1e-30|between 1e-15 and 1e+22 m", "%s -scale 1e-30", boxes[i]);
    mesh_refused(PETSC_ERR_USER_INPUT, "1e+30 m large after -a_scale 1e+30", "%s -scale 1e30", boxes[i]);
    mesh_refused(PETSC_ERR_USER_INPUT, "m large and lies|from the origin|-a_translate", "%s -translate %s", boxes[i],
                 i == 0   ? "1e12"
                 : i == 1 ? "0,-1e12"
                          : "0,0,1e12");
  }
  mesh_refused(PETSC_ERR_USER_INPUT, "1e-30 m large: its mesh must be between 1e-15 and 1e+22 m|-a_scale", "%s -dm_plex_box_upper 1e-30",
               boxes[0]);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_rotate: 1e+09 degrees are out of all proportion", "%s -rotate 1e9", boxes[1]);
}

/* Whoever computes in nanometres or in kilometres has bodies that are as large as these */
static void small_and_large(void **state)
{
  const char *const scales[] = {"1e-13", "1e16"};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scales); i++) {
    DM        dm = create_mesh("-dm_plex_dim 3 -dm_plex_box_faces 2,2,2 -scale %s", scales[i]);
    PetscReal low[3], high[3];

    ok(DMGetBoundingBox(dm, low, high));
    for (PetscInt d = 0; d < 3; d++) near((high[d] - low[d]) / strtod(scales[i], NULL), 1, 1e-14);
    ok(DMDestroy(&dm));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_of_all_shapes), cmocka_unit_test(numbers_of_sides),    cmocka_unit_test(parts_of_ranks),
      cmocka_unit_test(place_in_space),      cmocka_unit_test(turn_about_diagonal), cmocka_unit_test(place_in_plane),
      cmocka_unit_test(nodes_of_sides),      cmocka_unit_test(unknown_names),       cmocka_unit_test(bad_boxes),
      cmocka_unit_test(bad_places),          cmocka_unit_test(bad_sizes),           cmocka_unit_test(small_and_large),
  };

  return impakt_main(argc, argv, tests);
}
