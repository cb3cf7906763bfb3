/* ranks: 1 3 */
/* long: 3 */
/* Discs and balls from options: their volume, surfaces, grading and parts. */
#include "meshes.h"

/* The nearest and farthest vertex of the surface from a point, and how far the surface reaches from there in a direction of length 1 */
typedef struct {
  PetscReal nearest, farthest, reach;
} Extent;

static Extent extent_of(DM dm, const PetscReal centre[3], const PetscReal direction[3])
{
  Extent    extent = {PETSC_MAX_REAL, 0, -PETSC_MAX_REAL};
  PetscReal reduced[3];
  PetscInt  n, *vertices;

  ok(MeshGetNodeSet(dm, "surface", &n, &vertices));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal x[3], squared = 0, along = 0;

    position_of(dm, vertices[i], x);
    for (PetscInt d = 0; d < 3; d++) {
      squared += PetscSqr(x[d] - centre[d]);
      along += (x[d] - centre[d]) * direction[d];
    }
    extent.nearest  = PetscMin(extent.nearest, PetscSqrtReal(squared));
    extent.farthest = PetscMax(extent.farthest, PetscSqrtReal(squared));
    extent.reach    = PetscMax(extent.reach, along);
  }
  ok(PetscFree(vertices));
  reduced[0] = -extent.nearest;
  reduced[1] = extent.farthest;
  reduced[2] = extent.reach;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, reduced, 3, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD), 0);
  return (Extent){-reduced[0], reduced[1], reduced[2]};
}

static PetscReal exact_volume(PetscInt dim)
{
  return dim == 2 ? PETSC_PI : 4 * PETSC_PI / 3;
}

/* The distance from the centre to the corners of a polygon with n equal sides and the area of the unit disc */
static PetscReal polygon_radius(PetscInt n)
{
  return PetscSqrtReal(2 * PETSC_PI / n / sin(2 * PETSC_PI / n));
}

/* The volume as the elements have it, whose faces need not be flat: of a quadrilateral or hexahedron exact with two points along each axis
 */
static PetscReal integrated_volume(DM dm, PetscBool simplex)
{
  PetscQuadrature  rule;
  const PetscReal *weights;
  PetscInt         dim, start, end, n;
  PetscReal        sum = 0;

  ok(DMGetDimension(dm, &dim));
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  if (simplex) ok(PetscDTStroudConicalQuadrature(dim, 1, 1, -1, 1, &rule));
  else ok(PetscDTGaussTensorQuadrature(dim, 1, 2, -1, 1, &rule));
  ok(PetscQuadratureGetData(rule, NULL, NULL, &n, NULL, &weights));
  for (PetscInt c = start; c < end; c++) {
    PetscReal x[24], J[72], inverse[72], determinant[8];

    ok(DMPlexComputeCellGeometryFEM(dm, c, rule, x, J, inverse, determinant));
    for (PetscInt q = 0; q < n; q++) {
      assert_true(determinant[q] > 0);
      sum += weights[q] * determinant[q];
    }
  }
  ok(PetscQuadratureDestroy(&rule));
  return sum_of_ranks(sum);
}

/* Whatever the mesh, the elements have the volume of the ball to round-off, and at its pole a graded one reaches as far as the ball */
static void volume_kept(void **state)
{
  const char *const parts[]   = {"full", "half", "quarter"};
  const PetscReal   centre[3] = {0.3, -0.2, 0}, pole[3] = {0, 0.6, -0.8}, in_plane[3] = {0, -1, 0};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt part = 0; part < dim; part++)
      for (PetscInt simplex = 0; simplex < 2; simplex++)
        for (PetscReal grading = 1; grading <= 64; grading *= 8)
          for (PetscInt divisions = grading == 1 ? (part ? 2 : 1) : grading == 8 ? 4 : 8; divisions <= 8; divisions *= 2) {
            const PetscBool tilted = (PetscBool)(dim == 3 && part < 2);
            DM dm = create_mesh("-dm_plex_shape ball -dm_plex_dim %d -dm_plex_simplex %d -ball_radius 0.7 -ball_centre 0.3,-0.2%s "
                                "-ball_divisions %d -ball_grading %g -ball_part %s%s",
                                (int)dim, (int)simplex, dim == 3 ? ",0" : "", (int)divisions, (double)grading, parts[part],
                                tilted     ? " -ball_pole 0,3,-4"
                                : dim == 3 ? " -ball_pole 0,0,-1"
                                           : "");

            near(integrated_volume(dm, (PetscBool)simplex) / (exact_volume(dim) * PetscPowReal(0.7, (PetscReal)dim)), 1.0 / (1 << part),
                 1e-12);
            if (grading > 1 && (dim == 2 || tilted)) near(extent_of(dm, centre, tilted ? pole : in_plane).reach, 0.7, 1e-14);
            ok(DMDestroy(&dm));
          }
}

/* For its volume a polyhedron has its corners outside the sphere, in proportion to h^2: one twice as fine by a quarter. Of graded ones
   those opposite to the pole are outside most, and still far from that limit where they are coarse: 3.3 was measured with 4 and 8
   divisions, 3.8 with 8 and 16. */
static void nodes_near_sphere(void **state)
{
  const PetscReal origin[3] = {0}, down[2][3] = {{0, -1, 0}, {0, 0, -1}};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt grading = 1; grading <= 9; grading += 8) {
      PetscReal outside[3];

      for (PetscInt k = 0; k < 3; k++) {
        DM     dm = create_mesh("-dm_plex_shape ball -dm_plex_dim %d -ball_divisions %d -ball_grading %d", (int)dim, 4 << k, (int)grading);
        Extent extent = extent_of(dm, origin, down[dim - 2]);

        outside[k] = extent.farthest - 1;
        between(extent.nearest, 1 - 1e-14, grading == 1 ? 1 + outside[k] : 1 + 1e-14);
        if (grading > 1) near(extent.reach, 1, 1e-14);
        if (dim == 2 && grading == 1) {
          near(extent.nearest, polygon_radius(16 << k), 1e-14);
          near(extent.farthest, polygon_radius(16 << k), 1e-14);
        }
        ok(DMDestroy(&dm));
      }
      between(outside[0] / outside[1], grading == 1 ? 3.85 : 3.35, 4.05);
      between(outside[1] / outside[2], grading == 1 ? 3.95 : 3.75, 4.05);
    }
}

static void cells_and_faces(void **state)
{
  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt simplex = 0; simplex < 2; simplex++) {
      DM       dm    = create_mesh("-dm_plex_shape ball -dm_plex_dim %d -dm_plex_simplex %d -ball_radius 0.7 -ball_centre 0.3,-0.2%s "
                                   "-ball_divisions 5 -ball_layers 2 -ball_grading 7 -ball_pole 1,1%s",
                                   (int)dim, (int)simplex, dim == 3 ? ",0.1" : "", dim == 3 ? ",-3" : "");
      PetscInt cells = dim == 2 ? 25 + 20 * 2 : 125 + 150 * 2, faces = dim == 2 ? 4 * 5 : 6 * 25;

      if (simplex) cells *= dim == 2 ? 2 : 6;
      if (simplex && dim == 3) faces *= 2;
      assert_int_equal(count_cells(dm), cells);
      assert_int_equal(surface_facts(dm, "surface").n, faces);
      assert_int_equal(surface_facts(dm, NULL).n, faces); /* cells that did not fit would have others */
      near(integrated_volume(dm, (PetscBool)simplex), exact_volume(dim) * pow(0.7, (double)dim), 1e-12);
      ok(DMDestroy(&dm));
    }
}

/* From the origin, the surface's edges that leave its vertex in the direction of `pole` are seen under this angle */
static void check_edges_at(DM dm, const PetscReal pole[3], PetscReal expected)
{
  PetscInt start, end, n, *vertices, found = 0;

  ok(MeshGetNodeSet(dm, "surface", &n, &vertices));
  ok(DMPlexGetDepthStratum(dm, 1, &start, &end));
  for (PetscInt e = start; e < end; e++) {
    const PetscInt *ends;
    PetscReal       x[2][3], length[2] = {0, 0}, product = 0, angle[2], at_pole[2] = {0, 0};
    PetscInt        on_surface = 0;

    ok(DMPlexGetCone(dm, e, &ends));
    for (PetscInt i = 0; i < n; i++) on_surface += vertices[i] == ends[0] || vertices[i] == ends[1];
    if (on_surface < 2) continue;
    for (PetscInt k = 0; k < 2; k++) position_of(dm, ends[k], x[k]);
    for (PetscInt d = 0; d < 3; d++) {
      product += x[0][d] * x[1][d];
      for (PetscInt k = 0; k < 2; k++) {
        length[k] += PetscSqr(x[k][d]);
        at_pole[k] += x[k][d] * pole[d];
      }
    }
    for (PetscInt k = 0; k < 2; k++) angle[k] = acos(PetscClipInterval(at_pole[k] / PetscSqrtReal(length[k]), -1, 1));
    if (PetscMin(angle[0], angle[1]) > 1e-7) continue;
    found++;
    near(acos(product / PetscSqrtReal(length[0] * length[1])) / expected, 1, 1e-3);
  }
  ok(PetscFree(vertices));
  assert_true(sum_of_ranks((PetscReal)found) > 0);
}

/* On the sphere, the map takes the angle t from the pole to t' with tan(t'/2) = tan(t/2) / sqrt(g) (the shift of a stereographic
   projection); the first node is at t = pi/(2 n). Nodes move along their radii, but then the ball moves along its pole by the way of the
   node there. */
static void sizes_at_poles(void **state)
{
  const char *const poles[]     = {"0,-1", "1,1", "0,0,-1", "0,2,0"};
  const PetscReal   places[][3] = {{0, -1, 0}, {PETSC_SQRT2 / 2, PETSC_SQRT2 / 2, 0}, {0, 0, -1}, {0, 1, 0}};
  const PetscReal   root = PetscSqrtReal(30.0), half = tan(PETSC_PI / 32 / 2);
  const PetscReal   near_pole = 2 * atan(half / root), opposite = 2 * atan(half * root);

  (void)state;
  between(opposite / near_pole, 28, 30);
  for (PetscInt i = 0; i < 4; i++) {
    DM        dm = create_mesh("-dm_plex_shape ball -dm_plex_dim %d -ball_divisions 16 -ball_layers 4 -ball_grading 30 -ball_pole %s",
                               i < 2 ? 2 : 3, poles[i]);
    PetscReal antipode[] = {-places[i][0], -places[i][1], -places[i][2]};

    check_edges_at(dm, places[i], near_pole);
    check_edges_at(dm, antipode, opposite);
    ok(DMDestroy(&dm));
  }
}

/* Half or a quarter of the faces, with flat cut planes and no other surface */
static void check_part(PetscInt dim, PetscInt part, PetscReal grading, PetscInt simplex)
{
  const char *const parts[] = {"full", "half", "quarter"}, *const cuts[] = {"cut_x", "cut_y"};
  const char options[] = "-dm_plex_shape ball -dm_plex_dim %d -dm_plex_simplex %d -ball_divisions 4 -ball_grading %g -ball_part %s";
  DM         whole     = create_mesh(options, (int)dim, (int)simplex, (double)grading, parts[0]);
  DM         dm        = create_mesh(options, (int)dim, (int)simplex, (double)grading, parts[part]);
  PetscInt   n_faces   = surface_facts(dm, "surface").n;

  assert_int_equal(n_faces, surface_facts(whole, "surface").n >> part);
  for (PetscInt cut = 0; cut < part; cut++) {
    const SurfaceFacts facts = surface_facts(dm, cuts[cut]);

    (void)check_nodes_at(dm, cuts[cut], cut, 0);
    near(facts.centre[cut], 0, 1e-15);
    /* the disc through the ball's middle, or half of it: its corners are outside, so that it is larger: by 2.07 % of hexahedra, 2.12 % of
     * tetrahedra */
    if (dim == 3 && grading == 1) near(facts.area * part / PETSC_PI, 1.0210, 5e-4);
    n_faces += facts.n;
  }
  assert_int_equal(surface_facts(dm, NULL).n, n_faces);
  ok(DMDestroy(&whole));
  ok(DMDestroy(&dm));
}

static void symmetric_parts(void **state)
{
  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt part = 1; part < dim; part++)
      for (PetscInt simplex = 0; simplex < 2; simplex++)
        for (PetscReal grading = 1; grading < 20; grading += 9) check_part(dim, part, grading, simplex);
}

/* Half of the sphere's faces where its equator is along their edges, and of graded balls those that are wholly behind */
static void back_of_ball(void **state)
{
  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++)
    for (PetscInt grading = 1; grading <= 9; grading += 8) {
      DM dm = create_mesh("-dm_plex_shape ball -dm_plex_dim %d -dm_plex_simplex %d -ball_divisions 8 -ball_grading %d -ball_pole 0,-2%s",
                          (int)dim, (int)(grading > 1), (int)grading, dim == 3 ? ",0" : "");
      const SurfaceFacts sphere = surface_facts(dm, "surface"), back = surface_facts(dm, "back");
      PetscInt           n, *vertices;

      ok(MeshGetNodeSet(dm, "back", &n, &vertices));
      for (PetscInt i = 0; i < n; i++) {
        PetscReal x[3];

        position_of(dm, vertices[i], x);
        assert_true(x[1] >= -1e-12);
      }
      ok(PetscFree(vertices));
      if (grading == 1) {
        assert_int_equal(2 * back.n, sphere.n);
        near(back.area, sphere.area / 2, 1e-13);
      } else between(back.area / sphere.area, 0.4, 0.499); /* elements across the equator are left out: measured 0.468 and 0.409 */
      ok(DMDestroy(&dm));
    }
}

/* Centre (1, 0) and radius 0.5, all of it twice as large, then moved down by 3 */
static void placed(void **state)
{
  const PetscReal centre[3] = {2, -3, 0}, down[3] = {0, -1, 0};
  DM              dm = create_mesh("-dm_plex_shape ball -ball_radius 0.5 -ball_centre 1,0 -scale 2 -translate 0,-3");

  (void)state;
  near(extent_of(dm, centre, down).nearest, polygon_radius(16), 1e-14);
  near(extent_of(dm, centre, down).farthest, polygon_radius(16), 1e-14);
  near(volume_of(dm), PETSC_PI, 1e-13);
  ok(DMDestroy(&dm));
}

static void refused_options(void **state)
{
  const char ball[] = "-dm_plex_shape ball -dm_plex_dim 3";

  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_dm_plex_dim 1|disc (2) or a ball (3)", "-dm_plex_shape ball -dm_plex_dim 1");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_radius 0|positive", "%s -ball_radius 0", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_radius|2 numbers", "%s -ball_radius 1,2", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_centre|2 numbers|3", "%s -ball_centre 1,2", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_centre|finite", "%s -ball_centre 1,2,nan", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_divisions 0|at least 1", "%s -ball_divisions 0", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_layers -1|at least 1", "%s -ball_layers -1", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_grading 0.5|1 or more|-a_ball_pole", "%s -ball_grading 0.5", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_pole|no direction", "%s -ball_pole 0,0,0", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_pole|along y|quarter|cut plane", "%s -ball_part quarter -ball_pole 0,1,1", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_pole|along x|half|cut plane", "%s -ball_part half -ball_pole 1,0,0", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_part third|full, half", "%s -ball_part third", ball);
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_part quarter|disc", "-dm_plex_shape ball -ball_part quarter");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_ball_divisions 3|even|-a_ball_part half", "%s -ball_part half -ball_divisions 3", ball);
  /* 24 n^3 corners of cells are more than indices of 32, or of 64 bits can count */
  mesh_refused(PETSC_ERR_USER_INPUT, "'box'|-a_dm_plex_shape ball|too many", "%s -ball_divisions %s", ball,
               PetscDefined(USE_64BIT_INDICES) ? "2000000" : "2000");
  mesh_refused(PETSC_ERR_USER_INPUT, "'box'|not convex|more divisions", "%s -ball_divisions 2 -ball_grading 1e4", ball);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(volume_kept),    cmocka_unit_test(nodes_near_sphere), cmocka_unit_test(cells_and_faces),
      cmocka_unit_test(sizes_at_poles), cmocka_unit_test(symmetric_parts),   cmocka_unit_test(back_of_ball),
      cmocka_unit_test(placed),         cmocka_unit_test(refused_options),
  };

  return impakt_main(argc, argv, tests);
}
