/* ranks: 1 3 */
/* Discs, balls and rods of simplices, whose cells are mirror images of their neighbours: faces fit together, and meshes are their own
 * image. */
#include "meshes.h"

static const char *const meshes[] = {
    "-dm_plex_shape ball -dm_plex_dim 2 -ball_divisions 4 -ball_layers 3",
    "-dm_plex_shape ball -dm_plex_dim 2 -ball_divisions 3 -ball_layers 2",
    "-dm_plex_shape ball -dm_plex_dim 2 -ball_divisions 6 -ball_part half -ball_grading 3",
    "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions 4 -ball_layers 1",
    "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions 3 -ball_layers 2 -ball_grading 2",
    "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions 5 -ball_layers 1",
    "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions 6 -ball_layers 2 -ball_part half",
    "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions 4 -ball_part quarter -ball_grading 3",
    "-dm_plex_shape rod -dm_plex_dim 3 -rod_divisions 4 -rod_elements 3",
    "-dm_plex_shape rod -dm_plex_dim 3 -rod_divisions 3 -rod_layers 3 -rod_elements 2",
    "-dm_plex_shape rod -dm_plex_dim 3 -rod_divisions 6 -rod_layers 2 -rod_elements 3 -rod_part half",
    "-dm_plex_shape rod -dm_plex_dim 3 -rod_divisions 4 -rod_elements 4 -rod_part quarter",
};

/* What faces of the boundary enclose, by the divergence theorem */
static PetscReal enclosed_volume(DM dm, PetscReal area[3])
{
  PetscInt  n, *faces, dim;
  PetscReal volume = 0;

  ok(DMGetDimension(dm, &dim));
  ok(MeshGetSurface(dm, NULL, &n, &faces));
  for (PetscInt d = 0; d < 3; d++) area[d] = 0;
  for (PetscInt f = 0; f < n; f++) {
    const PetscInt *cells;
    PetscInt        count;
    PetscReal       size, centre[3], normal[3], of_cell[3], outward = 0;

    ok(DMPlexGetSupportSize(dm, faces[f], &count));
    assert_int_equal(count, 1);
    ok(DMPlexGetSupport(dm, faces[f], &cells));
    ok(DMPlexComputeCellGeometryFVM(dm, faces[f], &size, centre, normal));
    ok(DMPlexComputeCellGeometryFVM(dm, cells[0], NULL, of_cell, NULL));
    for (PetscInt d = 0; d < dim; d++) outward += normal[d] * (centre[d] - of_cell[d]);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal along = (outward > 0 ? 1 : -1) * size * normal[d];

      area[d] += along;
      volume += along * centre[d] / (PetscReal)dim;
    }
  }
  ok(PetscFree(faces));
  for (PetscInt d = 0; d < 3; d++) area[d] = sum_of_ranks(area[d]);
  return sum_of_ranks(volume);
}

/* Cells that cut a common face along unlike diagonals would have four triangles of the boundary there, which no surface has, and which
   quadrilaterals have not. All volumes are positive (volume_of()), and they are what the boundary encloses, which is closed. */
static void faces_fit_together(void **state)
{
  const char *const surfaces[] = {"surface", "cut_x", "cut_y", "zmin", "zmax"};

  (void)state;
  for (size_t m = 0; m < PETSC_STATIC_ARRAY_LENGTH(meshes); m++) {
    DM        dm = create_mesh("-dm_plex_simplex 1 %s", meshes[m]), boxes = create_mesh("-dm_plex_simplex 0 %s", meshes[m]);
    PetscInt  dim, named                                                  = 0;
    PetscReal area[3], volume                                             = volume_of(dm);

    ok(DMGetDimension(dm, &dim));
    assert_int_equal(count_cells(dm), (dim == 2 ? 2 : 6) * count_cells(boxes));
    assert_int_equal(surface_facts(dm, NULL).n, (dim == 2 ? 1 : 2) * surface_facts(boxes, NULL).n);
    for (PetscInt s = 0; s < 5; s++) {
      const PetscBool rod = (PetscBool)(strstr(meshes[m], "rod") != NULL), cut = (PetscBool)(strstr(meshes[m], "part") != NULL);

      if (s == 0 || (s == 1 && cut) || (s == 2 && strstr(meshes[m], "quarter")) || (s > 2 && rod))
        named += surface_facts(dm, surfaces[s]).n;
    }
    assert_int_equal(surface_facts(dm, NULL).n, named);
    near(enclosed_volume(dm, area), volume, 1e-12);
    for (PetscInt d = 0; d < 3; d++) near(area[d], 0, 1e-12);
    ok(DMDestroy(&boxes));
    ok(DMDestroy(&dm));
  }
}

/* Whether there is a cell, with its centroid at a place */
static PetscBool has_cell_at(PetscInt n, const PetscReal centroids[], const PetscReal x[3])
{
  for (PetscInt c = 0; c < n; c++) {
    PetscReal squares = 0;

    for (PetscInt d = 0; d < 3; d++) squares += PetscSqr(centroids[3 * c + d] - x[d]);
    if (squares < PetscSqr(1e-12)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscInt get_centroids(DM dm, PetscReal **centroids)
{
  PetscInt start, end;

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  ok(PetscCalloc1(3 * (end - start), centroids));
  for (PetscInt c = start; c < end; c++) ok(DMPlexComputeCellGeometryFVM(dm, c, NULL, *centroids + 3 * (c - start), NULL));
  return end - start;
}

/* Cells of a mesh whose image in a plane is no cell: across an axis (0 to 2; of rods of length 1 in their middle along z), or that of x = y
 */
static PetscInt count_unlike(DM dm, PetscInt plane, PetscReal middle)
{
  PetscReal *centroids;
  PetscInt   n = get_centroids(dm, &centroids), unlike = 0;

  for (PetscInt c = 0; c < n; c++) {
    const PetscReal *from = centroids + 3 * c;
    PetscReal        x[3] = {from[0], from[1], from[2]};

    if (plane < 3) x[plane] = 2 * middle - x[plane];
    else {
      x[0] = from[1];
      x[1] = from[0];
    }
    unlike += !has_cell_at(n, centroids, x);
  }
  ok(PetscFree(centroids));
  return unlike;
}

/* With an even number of divisions; of tetrahedra that lean one way in all cells none was one. A box is made of such. */
static void meshes_are_their_own_image(void **state)
{
  const char *const balls[] = {"-dm_plex_shape ball -dm_plex_dim 2 -ball_divisions %d",
                               "-dm_plex_shape ball -dm_plex_dim 3 -ball_divisions %d",
                               "-dm_plex_shape rod -dm_plex_dim 3 -rod_elements 4 -rod_divisions %d"};
  DM                box;

  (void)state;
  skip_beyond_ranks(1);
  for (PetscInt body = 0; body < 3; body++)
    for (PetscInt divisions = 2; divisions <= 6; divisions += 2) {
      char text[256];
      DM   dm;

      (void)snprintf(text, sizeof(text), balls[body], (int)divisions);
      dm = create_mesh("-dm_plex_simplex 1 %s", text);
      for (PetscInt plane = 0; plane < (body ? 3 : 2); plane++)
        assert_int_equal(count_unlike(dm, plane, body == 2 && plane == 2 ? 0.5 : 0), 0);
      assert_int_equal(count_unlike(dm, 3, 0), 0);
      ok(DMDestroy(&dm));
    }
  box = create_mesh("-dm_plex_simplex 1 -dm_plex_dim 3 -dm_plex_box_faces 2,2,2");
  between(count_unlike(box, 0, 0.5), 1, count_cells(box));
  ok(DMDestroy(&box));
}

/* Nodes inside a disc or a rod by the number of their edges: cells are images of their neighbours where all that are even, or odd, along
   each axis have 8 in the plane and 26 in space, and all others 4 and 10. Only at the four corners of the central block, and above them,
   three cells meet. With all cells alike there are 6 and 14, which were those where blocks touch of a half or a quarter with an odd number
   of cells in half the central block; a rod of 6 divisions and 48 elements that flattened on a wall then turned an element beside its axis
   inside out. */
static void neighbours_are_images(void **state)
{
  (void)state;
  skip_beyond_ranks(1);
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt divisions = 2; divisions <= 8; divisions += 2)
      for (PetscInt part = 0; part < 2; part++) {
        const PetscInt sections = 4, corners = (dim == 2 ? 1 : sections - 1) * (part ? 2 : 4);
        PetscInt       n, start, end, others = 0, *boundary;
        DM             dm;

        if (dim == 2)
          dm = create_mesh("-dm_plex_simplex 1 -dm_plex_shape ball -ball_divisions %d -ball_part %s", (int)divisions,
                           part ? "half" : "full");
        else
          dm = create_mesh("-dm_plex_simplex 1 -dm_plex_shape rod -dm_plex_dim 3 -rod_elements %d -rod_divisions %d -rod_part %s",
                           (int)sections, (int)divisions, part ? "half" : "full");
        ok(MeshGetNodeSet(dm, NULL, &n, &boundary));
        ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
        for (PetscInt v = start; v < end; v++) {
          PetscInt edges, at;

          ok(PetscFindInt(v, n, boundary, &at));
          if (at >= 0) continue;
          ok(DMPlexGetSupportSize(dm, v, &edges));
          others += dim == 2 ? edges != 4 && edges != 8 : edges != 10 && edges != 26;
        }
        assert_int_equal(others, corners);
        ok(PetscFree(boundary));
        ok(DMDestroy(&dm));
      }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(faces_fit_together),
      cmocka_unit_test(meshes_are_their_own_image),
      cmocka_unit_test(neighbours_are_images),
  };

  return impakt_main(argc, argv, tests);
}
