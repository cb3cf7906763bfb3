/* ranks: 1 3 */
/* Surfaces: which faces a name means, their areas and normals, also of nodes in planes of symmetry. */
#include "simulation.h"
#include "interfaces.h"

/* [0,1] x [0,2] x [0,3] as far as it has dimensions */
static DM CreateBox(PetscInt dim, const char faces[], PetscBool simplex)
{
  const char *const upper[] = {"1", "1,2", "1,2,3"}, *const lower[] = {"0", "0,0", "0,0,0"};

  return CreateBoxMesh("box", dim, faces, lower[dim - 1], upper[dim - 1], simplex);
}

static PetscReal TotalArea(const SurfaceData *data)
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < data->n_owned; i++) sum += data->areas[i];
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return sum;
}

/* Of all ranks */
static PetscInt Total(PetscInt mine)
{
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  return mine;
}

/* Each end of a line is a node and a face of area 1 with its normal away from the other end */
static void CheckEnd(const SurfaceData *data, PetscInt node, PetscReal position, PetscReal normal)
{
  near(data->positions[3 * node], position, 1e-15); /* a corner of the box, but for one rounding */
  near(data->areas[node], 1, 0);
  near(data->normals[3 * node], normal, 0);
  for (PetscInt f = 0; f < data->n_faces; f++)
    if (data->faces[f] == node) near(data->face_normals[3 * f], normal, 0);
}

static void line_ends_by_name(void **state)
{
  const char *const  names[]     = {"xmin", "xmax", "1", "2"}; /* PETSc puts the ends of a line into face sets 1 and 2 */
  const PetscReal    positions[] = {0, 1, 0, 1}, normals[] = {-1, 1, -1, 1};
  const SurfaceData *data;
  Surface            surface;
  DM                 dm = CreateBox(1, "5", PETSC_TRUE);

  (void)state;
  for (PetscInt i = 0; i < 4; i++) {
    ok(SurfaceCreate(dm, names[i], &surface));
    ok(SurfaceGetData(surface, &data));
    assert_int_equal(data->dim, 1);
    assert_int_equal(data->face_nodes, 1);
    assert_int_equal(Total(data->n_owned), 1);
    assert_int_equal(Total(data->n_faces), 1);
    for (PetscInt node = 0; node < data->n_nodes; node++) CheckEnd(data, node, positions[i], normals[i]);
    ok(SurfaceDestroy(&surface));
    assert_null(surface);
  }
  ok(DMDestroy(&dm));
}

/* A label that somebody put on the mesh, with any values */
static void faces_of_a_label(void **state)
{
  const SurfaceData *data;
  Surface            surface;
  DMLabel            label, sets;
  IS                 points;
  DM                 dm = CreateBox(1, "5", PETSC_TRUE);

  (void)state;
  ok(DMCreateLabel(dm, "nose"));
  ok(DMGetLabel(dm, "nose", &label));
  ok(DMGetLabel(dm, "Face Sets", &sets));
  ok(DMLabelGetStratumIS(sets, 2, &points));
  if (points) ok(DMLabelSetStratumIS(label, 7, points)); /* NULL on ranks without that end */
  ok(ISDestroy(&points));
  ok(SurfaceCreate(dm, "nose", &surface));
  ok(SurfaceGetData(surface, &data));
  assert_int_equal(Total(data->n_owned), 1);
  for (PetscInt node = 0; node < data->n_nodes; node++) CheckEnd(data, node, 1, 1);
  ok(SurfaceDestroy(&surface));
  ok(DMDestroy(&dm));
}

/* The side at 0 or 1, 2, 3 of one axis: its area is the product of the other two lengths, its normal along the axis */
static void CheckSides(DM dm, PetscInt dim, PetscInt face_nodes, const PetscInt faces[])
{
  const char *const  names[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  const SurfaceData *data;
  Surface            surface;

  for (PetscInt side = 0; side < 2 * dim; side++) {
    const PetscInt  axis = side / 2;
    const PetscReal sign = side % 2 ? 1 : -1;
    PetscReal       area = 1;

    for (PetscInt d = 0; d < dim; d++) area *= d == axis ? 1 : d + 1;
    ok(SurfaceCreate(dm, names[side], &surface));
    ok(SurfaceGetData(surface, &data));
    assert_int_equal(data->face_nodes, face_nodes);
    assert_int_equal(Total(data->n_faces), faces[axis]);
    near(TotalArea(data), area, 1e-14); /* round-off of a few additions of numbers of size 1 */
    for (PetscInt i = 0; i < data->n_nodes; i++) {
      near(data->positions[3 * i + axis], sign > 0 ? axis + 1 : 0, 1e-14);
      for (PetscInt d = 0; d < dim; d++) near(data->normals[3 * i + d], d == axis ? sign : 0, 1e-14);
    }
    for (PetscInt f = 0; f < data->n_faces; f++)
      for (PetscInt d = 0; d < dim; d++) near(data->face_normals[3 * f + d], d == axis ? sign : 0, 1e-14);
    ok(SurfaceDestroy(&surface));
  }
}

/* All sides: nodes on edges and corners belong to several, and their normals point between them */
static void CheckWholeBoundary(DM dm, PetscInt dim, PetscReal area, PetscInt nodes)
{
  const SurfaceData *data;
  Surface            surface;

  ok(SurfaceCreate(dm, NULL, &surface));
  ok(SurfaceGetData(surface, &data));
  assert_int_equal(Total(data->n_owned), nodes);
  near(TotalArea(data), area, 1e-13);
  for (PetscInt i = 0; i < data->n_nodes; i++) {
    PetscReal length = 0;

    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal x = data->positions[3 * i + d], n = data->normals[3 * i + d];

      length += n * n;
      /* outward: away from the sides that the node lies on, and along none of the others */
      if (x < 1e-12) assert_true(n < 0);
      else if (x > d + 1 - 1e-12) assert_true(n > 0);
      else near(n, 0, 1e-14);
    }
    near(length, 1, 1e-14);
    if (i && i < data->n_owned) assert_true(data->dofs[i] > data->dofs[i - 1]);
  }
  ok(SurfaceDestroy(&surface));
}

static void sides_of_a_rectangle(void **state)
{
  const PetscInt faces[] = {3, 2}; /* a side has the elements of the other direction */

  (void)state;
  for (PetscInt simplex = 0; simplex < 2; simplex++) {
    DM dm = CreateBox(2, "2,3", (PetscBool)simplex);

    CheckSides(dm, 2, 2, faces);
    CheckWholeBoundary(dm, 2, 6, 10); /* perimeter 2 (1 + 2); as many nodes as edges, 2 (2 + 3) */
    ok(DMDestroy(&dm));
  }
}

static void sides_of_a_hexahedral_box(void **state)
{
  const PetscInt faces[] = {6, 6, 4}; /* 2 x 2 x 3 elements */
  DM             dm      = CreateBox(3, "2,2,3", PETSC_FALSE);

  (void)state;
  CheckSides(dm, 3, 4, faces);
  CheckWholeBoundary(dm, 3, 22, 34); /* 2 (2 + 3 + 6); 3 x 3 x 4 nodes less the 1 x 1 x 2 inner ones */
  ok(DMDestroy(&dm));
}

static void unknown_names_are_refused(void **state)
{
  const char *const names[] = {"nose", "zmin", "99", "1x"}; /* no label, beyond the dimension, no such set, no number */
  char              words[64];
  Surface           surface;
  DM                dm = CreateBox(1, "5", PETSC_TRUE);

  (void)state;
  for (PetscInt i = 0; i < 4; i++) {
    ok(PetscSNPrintf(words, sizeof(words), "'box'|surface '%s'", names[i]));
    refused(PETSC_ERR_USER_INPUT, words, SurfaceCreate(dm, names[i], &surface));
    ok(SurfaceDestroy(&surface));
  }
  ok(DMDestroy(&dm));
}

/* A label that marks no boundary face is no surface */
static void empty_surfaces_are_refused(void **state)
{
  Surface surface;
  DM      dm = CreateBox(1, "5", PETSC_TRUE);

  (void)state;
  ok(DMCreateLabel(dm, "nowhere"));
  refused(PETSC_ERR_USER_INPUT, "'box'|'nowhere'", SurfaceCreate(dm, "nowhere", &surface));
  ok(SurfaceDestroy(&surface));
  ok(DMDestroy(&dm));
}

/* Squares side by side, apart or touching: the ends that face each other, and nothing else */
static void ends_that_face_each_other(void **state)
{
  const char *const lower[] = {"1.5,0", "1,0"};

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    DM      dm[] = {CreateBoxMesh("left", 2, "3,4", "0,0", "1,1", PETSC_FALSE),
                    CreateBoxMesh("right", 2, "3,5", lower[i], "2.5,1", PETSC_FALSE)};
    Surface surface[2];

    for (PetscInt side = 0; side < 2; side++) ok(SurfaceCreate(dm[side], NULL, &surface[side]));
    ok(SurfaceKeepFacing(surface[0], surface[1], NULL, PETSC_TRUE, PETSC_TRUE));
    for (PetscInt side = 0; side < 2; side++) {
      const SurfaceData *data;

      ok(SurfaceGetData(surface[side], &data));
      assert_int_equal(Total(data->n_faces), 4 + side);
      assert_int_equal(Total(data->n_owned), 5 + side);
      for (PetscInt f = 0; f < data->n_faces; f++) near(data->face_normals[3 * f], side ? -1 : 1, 1e-14);
      ok(SurfaceDestroy(&surface[side]));
      ok(DMDestroy(&dm[side]));
    }
  }
}

static const PetscReal nowhere[3] = {0, 0, 0};

/* All normals are tilted along x by atan(0.1) */
static void map_slope_2d(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[1] += 0.1 * X[0];
}

static void map_slope(const PetscReal X[3], PetscReal x[3])
{
  map_nothing(X, x);
  x[2] += 0.1 * X[0];
}

/* Nodes at x = 0 are held along x, as those beside them; those at x = 1 along all axes. The normals of the first stay in the plane x = 0,
   where the surface ends: the second lie inside of it, and the third are clamped. Without held displacements all are as before. */
static void normals_stay_in_planes_of_symmetry(void **state)
{
  const char *const faces[2][2] = {{"4,1", "2,1"}, {"4,4,1", "2,2,1"}};
  const PetscBool   quads[2]    = {PETSC_FALSE, PETSC_FALSE};

  (void)state;
  for (PetscInt dim = 2; dim <= 3; dim++) {
    const SurfaceData *data;
    PetscInt          *dofs, n = 0, first, in_planes = 0;
    Interface          interface;

    interface_create(&interface, dim, faces[dim - 2], quads, PETSC_FALSE);
    ok(SurfaceGetData(interface.surface[0], &data));
    ok(VecGetOwnershipRange(interface.u[0], &first, NULL));
    ok(PetscMalloc1(dim * data->n_owned, &dofs));
    for (PetscInt i = 0; i < data->n_owned; i++)
      for (PetscInt d = 0; d < dim; d++)
        if ((d == 0 && data->reference[3 * i] < 0.3) || data->reference[3 * i] > 0.9) dofs[n++] = data->dofs[i] + d - first;
    ok(PetscSortInt(n, dofs));
    move_mesh(interface.dm[0], dim == 2 ? map_slope_2d : map_slope, nowhere, interface.u[0]);
    for (PetscInt held = 1; held >= 0; held--) {
      ok(SurfaceSetMirrors(interface.surface[0], held ? n : 0, dofs, first));
      ok(SurfaceUpdate(interface.surface[0], interface.u[0]));
      for (PetscInt i = 0; i < data->n_nodes; i++) {
        const PetscBool in_plane = (PetscBool)(held && data->reference[3 * i] < 1e-9);

        near(data->normals[3 * i], in_plane ? 0 : -0.1 / PetscSqrtReal(1.01), 1e-14);
        near(data->normals[3 * i + dim - 1], in_plane ? 1 : 1 / PetscSqrtReal(1.01), 1e-14);
        if (in_plane && i < data->n_owned) in_planes++;
      }
    }
    assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &in_planes, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
    assert_int_equal(in_planes, dim == 2 ? 1 : 5);
    ok(PetscFree(dofs));
    interface_destroy(&interface);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(line_ends_by_name),          simulation_test(faces_of_a_label),
      simulation_test(sides_of_a_rectangle),       simulation_test(sides_of_a_hexahedral_box),
      simulation_test(ends_that_face_each_other),  simulation_test(unknown_names_are_refused),
      simulation_test(empty_surfaces_are_refused), simulation_test(normals_stay_in_planes_of_symmetry),
  };

  return impakt_main(argc, argv, tests);
}
