/* ranks: 1 2 3 */
/* long: 2 */
/* Meshes divided among the ranks: boxes of which each rank makes its own brick, and others that the first rank has and divides so that
   contact faces lie on all ranks. */
#include "meshes.h"

static DM CreateBox(PetscInt dim, const char faces[], const char more[])
{
  const char *const upper[] = {"1", "1,2", "1,2,3"};

  return create_mesh("-dm_plex_dim %d -dm_plex_box_faces %s -dm_plex_box_upper %s %s", (int)dim, faces, upper[dim - 1], more);
}

/* Cones, faces, orientations, Jacobians, and that points which two ranks share are the same: PETSc's own checks */
static void CheckMesh(DM dm)
{
  ok(DMPlexCheckSymmetry(dm));
  ok(DMPlexCheckSkeleton(dm, 0));
  ok(DMPlexCheckFaces(dm, 0));
  ok(DMPlexCheckGeometry(dm));
  ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
  ok(DMPlexCheckInterfaceCones(dm));
}

static void CheckSame(DM bricks, DM graph, PetscInt dim)
{
  const char *const names[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  PetscReal         box[2][2][3];

  assert_int_equal(count_cells(bricks), count_cells(graph));
  assert_int_equal(count_vertices(bricks), count_vertices(graph));
  near(volume_of(bricks), volume_of(graph), 1e-13); /* round-off of sums of numbers of size 1 */
  ok(DMGetBoundingBox(bricks, box[0][0], box[0][1]));
  ok(DMGetBoundingBox(graph, box[1][0], box[1][1]));
  for (PetscInt d = 0; d < dim; d++)
    for (PetscInt end = 0; end < 2; end++) assert_true(box[0][end][d] == box[1][end][d]);
  for (PetscInt side = 0; side < 2 * dim; side++) {
    const SurfaceFacts facts = surface_facts(bricks, names[side]), wanted = surface_facts(graph, names[side]);

    assert_int_equal(facts.n, wanted.n);
    for (PetscInt d = 0; d < dim; d++) near(facts.centre[d], wanted.centre[d], 1e-13);
  }
  assert_int_equal(surface_facts(bricks, "marker").n, surface_facts(graph, "marker").n);
}

static void same_as_graph(void **state)
{
  const char *const faces[] = {"7", "5,9", "3,8,4"};

  (void)state;
  for (PetscInt dim = 1; dim <= 3; dim++) {
    DM bricks = CreateBox(dim, faces[dim - 1], "-mesh_division bricks"), graph = CreateBox(dim, faces[dim - 1], "-mesh_division graph");

    CheckMesh(bricks);
    CheckSame(bricks, graph, dim);
    ok(DMDestroy(&bricks));
    ok(DMDestroy(&graph));
  }
}

/* A cell less than ranks, so that one of them has none, and a single cell */
static void more_ranks_than_cells(void **state)
{
  (void)state;
  for (PetscInt n = 1; n <= 2; n++) {
    DM       dm = CreateBox(2, n == 1 ? "1,1" : "1,2", "-mesh_division bricks");
    PetscInt end;

    CheckMesh(dm);
    assert_int_equal(count_cells(dm), n);
    near(volume_of(dm), 2, 1e-14);
    assert_int_equal(count_vertices(dm), 2 * (n + 1));
    ok(DMPlexGetHeightStratum(dm, 0, NULL, &end));
    assert_true(end <= (size_of_world() > 1 ? 1 : n));
    ok(DMDestroy(&dm));
  }
}

/* Cells and faces of zmax on the rank that has most of them */
static void CountMost(DM dm, PetscReal most[2])
{
  PetscInt start, end, n, *faces;

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  ok(MeshGetSurface(dm, "zmax", &n, &faces));
  ok(PetscFree(faces));
  most[0] = (PetscReal)(end - start);
  most[1] = (PetscReal)n;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, most, 2, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD), 0);
}

/* A bar that touches something with one end: halves across its axis leave the 36 faces there to one rank, halves along it share them. Faces
   that cost nothing change nothing, and a face that costs 0.1 elements is not worth the 72 more faces that halves along the axis share. */
static void contact_faces_are_spread(void **state)
{
  const char *const ways[] = {"-mesh_contact_surfaces zmax", "-mesh_contact_surfaces 2", "-mesh_contact_surfaces zmax -mesh_contact_cost 0",
                              "-mesh_contact_surfaces zmax -mesh_contact_cost 0.1", ""};
  const PetscBool   along[] = {PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(ways); i++) {
    DM        dm = create_mesh("-dm_plex_dim 3 -dm_plex_box_faces 6,6,18 %s", ways[i]);
    PetscReal most[2];

    CheckMesh(dm);
    CountMost(dm, most);
    assert_int_equal((int)most[0], 648 / size_of_world());
    assert_int_equal((int)most[1], along[i] ? 36 / size_of_world() : 36);
    ok(DMDestroy(&dm));
  }
}

/* Without a list it is the names of -contact_pairs, of either side, that count; other bodies' surfaces, and words alone, do not */
static void pairs_name_contact_faces(void **state)
{
  const char *const pairs[] = {
      "box.zmax:other.zmin", "other.zmin~box.zmax", "c:d,box.zmax:wall", "other.zmax:box.xmax", "auto", "box:other"};
  const PetscBool along[] = {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE, PETSC_FALSE, PETSC_FALSE, PETSC_FALSE};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(pairs); i++) {
    PetscReal    most[2];
    PetscOptions options = options_begin("-prefix_push a_ -dm_plex_dim 3 -dm_plex_box_faces 6,6,18 -prefix_pop -contact_pairs %s",
                                         pairs[i]);
    DM           dm;

    ok(MeshCreate(PETSC_COMM_WORLD, "a_", "box", &dm));
    options_end(options);
    CountMost(dm, most);
    assert_int_equal((int)most[0], 648 / size_of_world());
    assert_int_equal((int)most[1], along[i] ? 36 / size_of_world() : 36);
    ok(DMDestroy(&dm));
  }
}

/* An option of the partitioner asks for a graph; this one leaves all cells to the first rank */
static void graph_where_needed(void **state)
{
  DM       dm = CreateBox(2, "3,4", "-petscpartitioner_type gather");
  PetscInt start, end;

  (void)state;
  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  assert_int_equal(end - start, rank_of_world() ? 0 : 12);
  assert_int_equal(count_cells(dm), 12);
  ok(DMDestroy(&dm));
}

static void bad_divisions(void **state)
{
  const char box[] = "-dm_plex_dim 3 -dm_plex_box_faces 6,6,6";

  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_cost|-1", "%s -mesh_contact_cost -1", box);
}

/* Cells, and faces of a surface, on the rank that has most of them */
static void BisectionCountMost(DM dm, const char surface[], PetscInt most[2])
{
  PetscInt  start, end, n, *faces;
  PetscReal counts[2];

  ok(DMPlexGetHeightStratum(dm, 0, &start, &end));
  ok(MeshGetSurface(dm, surface, &n, &faces));
  ok(PetscFree(faces));
  counts[0] = (PetscReal)(end - start);
  counts[1] = (PetscReal)n;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD), 0);
  for (PetscInt i = 0; i < 2; i++) most[i] = (PetscInt)counts[i];
}

static void BisectionCheckMesh(DM dm, PetscInt n_cells, PetscReal volume)
{
  ok(DMPlexCheckSymmetry(dm));
  ok(DMPlexCheckFaces(dm, 0));
  ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
  assert_int_equal(count_cells(dm), n_cells);
  near(volume_of(dm), volume, 1e-13 * n_cells);
}

/* Tetrahedra of a bar that touches something with one end: 72 faces there, all of them on one rank where the bar is cut across its axis. A
   column of cells has 12 faces there, and the halves need not be columns, since triangles are cut by their centres. */
static void faces_of_a_bar_are_spread(void **state)
{
  const char *const ways[] = {"-mesh_contact_surfaces zmax", "-mesh_contact_surfaces 2",
                              "-mesh_contact_surfaces zmax -mesh_contact_cost 0"};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(ways); i++) {
    DM       dm = create_mesh("-dm_plex_dim 3 -dm_plex_simplex 1 -dm_plex_box_faces 6,6,18 -dm_plex_box_upper 1,1,3 %s", ways[i]);
    PetscInt most[2];

    BisectionCheckMesh(dm, 6 * 648, 3);
    BisectionCountMost(dm, "zmax", most);
    if (i < 2) {
      assert_int_equal(most[0], 6 * 648 / size_of_world());
      assert_true(most[1] <= 72 / size_of_world() + 3);
    } else assert_true(size_of_world() == 1 || most[1] > 72 / size_of_world() + 3);
    ok(DMDestroy(&dm));
  }
}

/* All around a ball normals look everywhere: it is divided as a graph, and so are cells fewer than ranks */
static void others_are_graphs(void **state)
{
  const char *const ways[]  = {"-dm_plex_shape ball -ball_divisions 2 -mesh_contact_surfaces surface",
                               "-dm_plex_shape box -dm_plex_simplex 1 -dm_plex_box_faces 1,1 -mesh_contact_surfaces xmin"};
  const PetscInt    cells[] = {12, 2};

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(ways); i++) {
    DM dm = create_mesh("-dm_plex_dim 2 %s", ways[i]);

    assert_int_equal(count_cells(dm), cells[i]);
    ok(DMPlexCheckPointSF(dm, NULL, PETSC_FALSE));
    ok(DMDestroy(&dm));
  }
}

/* A surface that there is not, a name of PETSc's own labels among them, is named, on any number of ranks and on any mesh */
static void surfaces_must_be_there(void **state)
{
  (void)state;
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'nowhere'|-contact_pairs",
               "-dm_plex_dim 2 -dm_plex_shape ball -ball_divisions 2 -mesh_contact_surfaces surface,nowhere");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface '7'", "-dm_plex_dim 2 -mesh_contact_surfaces 7");
  mesh_refused(PETSC_ERR_USER_INPUT, "-a_mesh_contact_surfaces|no surface 'depth'", "-dm_plex_dim 3 -mesh_contact_surfaces zmax,depth");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_graph),
      cmocka_unit_test(more_ranks_than_cells),
      cmocka_unit_test(graph_where_needed),
      cmocka_unit_test(bad_divisions),
      cmocka_unit_test(contact_faces_are_spread),
      cmocka_unit_test(pairs_name_contact_faces),
      cmocka_unit_test(faces_of_a_bar_are_spread),
      cmocka_unit_test(others_are_graphs),
      cmocka_unit_test(surfaces_must_be_there),
  };

  return impakt_main(argc, argv, tests);
}
