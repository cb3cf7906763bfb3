/* ranks: 1 2 */
/* Meshes of composite elements: cells divided into 4 and 8, that follow each other on one rank; surfaces and node sets; nodes in the middle
 * of edges from a file. */
#include "meshes.h"

/* [0,1] x [0,2] x [0,3], of 2 x 3 x 2 cells of 2 or 6 simplices */
static DM create_box(PetscInt dim)
{
  return create_mesh(dim == 2 ? "-dm_plex_dim 2 -dm_plex_simplex 1 -dm_plex_box_faces 2,3 -dm_plex_box_upper 1,2"
                              : "-dm_plex_dim 3 -dm_plex_simplex 1 -dm_plex_box_faces 2,3,2 -dm_plex_box_upper 1,2,3");
}

static void cells_are_divided(void **state)
{
  const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++) {
    const PetscInt parts = dim == 2 ? 4 : 8;
    DM             dm    = create_box(dim), divided;
    PetscBool      is_composite;
    PetscInt       start, end;

    ok(MeshIsComposite(dm, &is_composite));
    assert_false(is_composite);
    ok(MeshCreateComposite(dm, &divided));
    ok(MeshIsComposite(divided, &is_composite));
    assert_true(is_composite);
    assert_int_equal(count_cells(divided), parts * count_cells(dm));
    near(volume_of(divided), dim == 2 ? 2 : 6, 1e-13);
    for (PetscInt side = 0; side < 2 * dim; side++) {
      const SurfaceFacts whole = surface_facts(dm, sides[side]), facts = surface_facts(divided, sides[side]);

      assert_int_equal(facts.n, (dim == 2 ? 2 : 4) * whole.n);
      near(facts.area, whole.area, 1e-13);
      near(facts.centre[side / 2], whole.centre[side / 2], 1e-14);
      (void)check_nodes_at(divided, sides[side], side / 2, side % 2 ? side / 2 + 1 : 0);
    }
    /* the parts of a cell, equal ones, follow each other: their mean centre is that of the cell */
    ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
    for (PetscInt c = start; c < end; c++) {
      PetscReal volume, of_part, centre[3] = {0}, of_cell[3] = {0};

      ok(DMPlexComputeCellGeometryFVM(dm, c, &volume, of_cell, NULL));
      for (PetscInt s = 0; s < parts; s++) {
        PetscReal x[3] = {0};

        ok(DMPlexComputeCellGeometryFVM(divided, parts * c + s, &of_part, x, NULL));
        near(of_part, volume / parts, 1e-15);
        for (PetscInt d = 0; d < dim; d++) centre[d] += x[d] / parts;
      }
      for (PetscInt d = 0; d < dim; d++) near(centre[d], of_cell[d], 1e-14);
    }
    ok(DMDestroy(&divided));
    ok(DMDestroy(&dm));
  }
}

static void other_cells_are_refused(void **state)
{
  DM dm = create_mesh("-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 3,3"), divided = NULL;

  (void)state;
  refused(PETSC_ERR_USER_INPUT,
          "'box'|composite elements are made of triangles and tetrahedra, not of cells of shape 'quadrilateral'|-dm_plex_simplex",
          MeshCreateComposite(dm, &divided));
  ok(DMDestroy(&dm));
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_element_formulation composite|'hexahedron'",
               "-dm_plex_dim 3 -dm_plex_box_faces 3,2,2 -element_formulation composite");
}

/* Two triangles of six nodes on the unit square, whose common edge bends by 0.1 m towards the lower right: nodes 1 to 4 at the corners, 5
   to 8 in the middle of the sides, 9 of the diagonal. `second` is the second triangle. */
static void write_square(const char path[], const char second[])
{
  char text[2048];

  (void)snprintf(text, sizeof(text),
                 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.5 0 0\n6 1 0.5 0\n7 0.5 1 0\n8 "
                 "0 0.5 0\n9 0.6 0.4 0\n10 0.4 0.6 0\n"
                 "$EndNodes\n$Elements\n2\n1 9 2 1 1 1 2 3 5 6 9\n2 9 2 1 1 %s\n$EndElements\n",
                 second);
  write_file(path, text);
}

static void middles_of_edges_are_those_of_the_file(void **state)
{
  PetscInt  start, end, found = 0;
  PetscBool is_composite;
  DM        dm;

  (void)state;
  skip_beyond_ranks(2);
  write_square("square.msh", "1 3 4 9 7 8");
  dm = create_mesh("-dm_plex_filename square.msh");
  ok(MeshIsComposite(dm, &is_composite));
  assert_true(is_composite);
  assert_int_equal(count_cells(dm), 8);
  near(volume_of(dm), 1, 1e-14);
  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  for (PetscInt v = start; v < end; v++) {
    PetscReal x[3];

    position_of(dm, v, x);
    if (PetscAbsReal(x[0] - 0.6) < 1e-14 && PetscAbsReal(x[1] - 0.4) < 1e-14) found++;
    assert_false(PetscAbsReal(x[0] - 0.5) < 1e-14 && PetscAbsReal(x[1] - 0.5) < 1e-14);
  }
  between(sum_of_ranks((PetscReal)found), 1, size_of_world());
  ok(DMDestroy(&dm));
}

/* Distance of a vertex from the centre, or from the axis of a rod */
static PetscReal distance_of(DM dm, PetscInt vertex, PetscBool rod)
{
  PetscReal x[3];

  position_of(dm, vertex, x);
  return PetscSqrtReal(x[0] * x[0] + x[1] * x[1] + (rod ? 0 : x[2] * x[2]));
}

/* Discs, balls and rods with their nodes on the true surface, corners and those in the middle of edges alike: what they lack of the true
   volume is that of faces, or chords, twice as short as the edges, and falls with the square of their length, measured: by 3.89 to 3.99.
   (Of balls from 4 divisions on: with 2 all diagonals on a side of them lead to its corners, with 4 half of them do.) A polygon
   of 2 m sides lacks 1 - sin(pi / m) m / pi. */
static void curved_bodies(void **state)
{
  const char *const options[] = {"-dm_plex_shape ball -dm_plex_dim 2 -ball_keep_volume false -ball_divisions %d",
                                 "-dm_plex_shape ball -dm_plex_dim 3 -ball_keep_volume false -ball_divisions %d",
                                 "-dm_plex_shape rod -dm_plex_dim 3 -rod_keep_volume false -rod_elements 2 -rod_divisions %d"};
  const PetscReal   volumes[] = {PETSC_PI, 4 * PETSC_PI / 3, PETSC_PI};

  (void)state;
  for (PetscInt body = 0; body < 3; body++) {
    PetscReal before = 0;

    for (PetscInt divisions = 2; divisions <= 8; divisions *= 2) {
      char      text[256];
      DM        dm;
      PetscInt  n, *vertices;
      PetscReal missing;

      (void)snprintf(text, sizeof(text), options[body], (int)divisions);
      dm      = create_mesh("%s -dm_plex_simplex 1 -element_formulation composite", text);
      missing = 1 - volume_of(dm) / volumes[body];
      ok(MeshGetNodeSet(dm, "surface", &n, &vertices));
      for (PetscInt i = 0; i < n; i++) near(distance_of(dm, vertices[i], (PetscBool)(body == 2)), 1, 1e-14);
      ok(PetscFree(vertices));
      if (body != 1) near(missing, 1 - sin(PETSC_PI / (4. * (double)divisions)) * 4 * (double)divisions / PETSC_PI, 1e-13);
      if (before > 0 && (body != 1 || divisions > 4)) between(before / missing, 3.85, 4.05);
      before = missing;
      ok(DMDestroy(&dm));
    }
  }
}

static void wrong_middles_are_refused(void **state)
{
  (void)state;
  write_square("wrong.msh", "1 3 4 10 7 8"); /* another node in the middle of the common edge */
  mesh_refused(PETSC_ERR_USER_INPUT, "nodes 9 and 10 are both in the middle of one edge", "-dm_plex_filename wrong.msh");
  write_square("wrong.msh", "1 3 4 9 7 5"); /* one node in the middle of two edges */
  mesh_refused(PETSC_ERR_USER_INPUT, "node 5 is in the middle of two edges", "-dm_plex_filename wrong.msh");
  write_square("wrong.msh", "1 3 4 9 7 2"); /* a corner of the other */
  mesh_refused(PETSC_ERR_USER_INPUT, "node 2 is in the middle of an edge of element 2|and a corner of another",
               "-dm_plex_filename wrong.msh");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_are_divided),
      cmocka_unit_test(other_cells_are_refused),
      cmocka_unit_test(middles_of_edges_are_those_of_the_file),
      cmocka_unit_test(curved_bodies),
      cmocka_unit_test(wrong_middles_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
