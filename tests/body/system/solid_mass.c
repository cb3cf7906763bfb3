/* long: 2 3 */
/* Mass of a surface layer in two and three dimensions, moved to the nodes inside: its total, its sign, its place, also where elements
   have no inner node. */
#include "solid_bodies.h"
#include "solid_mesh.h"

static const char *const types[] = {"lumped", "consistent", "averaged"};
#define TYPES 3

/* Sums over all nodes of mass, mass times position, mass times position squared */
typedef struct {
  PetscReal mass, first[3], second[3];
} Moments;

static Moments moments_of(Body body)
{
  Moments            moments = {0};
  const PetscScalar *mass;

  ok(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    const PetscReal m = mass[node * body->mesh.dim];

    for (PetscInt d = 1; d < body->mesh.dim; d++)
      near(mass[node * body->mesh.dim + d], m, 1e-14 * PetscAbsReal(m)); /* the same sums in another order */
    moments.mass += m;
    for (PetscInt d = 0; d < body->mesh.dim; d++) {
      const PetscReal x = body->mesh.coordinates[node * body->mesh.dim + d];

      moments.first[d] += m * x;
      moments.second[d] += m * x * x;
    }
  }
  ok(VecRestoreArrayRead(body->mass.row_sum, &mass));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &moments, 7, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)body)), 0);
  return moments;
}

/* M has nothing in the rows and columns of the layer, and mass at all other nodes */
static void check_layer(Body body)
{
  PetscScalar       *x;
  const PetscScalar *y, *mass;
  Vec                layer, image;

  ok(BodyCreateVec(body, &layer));
  ok(BodyCreateVec(body, &image));
  ok(VecGetArray(layer, &x));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++)
    x[i] = body->layer.contains[i / body->mesh.dim] ? scattered(&body->mesh.coordinates[i], 1, 0) : 0;
  ok(VecRestoreArray(layer, &x));
  ok(BodyMultiplyMass(body, layer, image));
  ok(VecGetArrayRead(image, &y));
  ok(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) {
    near(y[i], 0, 0);
    if (body->layer.contains[i / body->mesh.dim]) near(mass[i], 0, 0);
    else assert_true(mass[i] > 0);
  }
  ok(VecRestoreArrayRead(body->mass.row_sum, &mass));
  ok(VecRestoreArrayRead(image, &y));
  ok(VecDestroy(&layer));
  ok(VecDestroy(&image));
}

/* Rigid motions: translations, and the rotations about the origin; the first in two dimensions is that about the third axis */
#define MAX_RIGID 6
static PetscReal rigid_motion(PetscInt dim, PetscInt motion, const PetscReal x[], PetscInt component)
{
  const PetscInt axis = dim == 2 ? 2 : motion - dim;

  if (motion < dim) return motion == component;
  if (component == (axis + 1) % 3) return -((axis + 2) % 3 < dim ? x[(axis + 2) % 3] : 0);
  if (component == (axis + 2) % 3) return (axis + 1) % 3 < dim ? x[(axis + 1) % 3] : 0;
  return 0;
}

/* r_i' M r_j for all rigid motions: momenta and angular momenta of each */
static void rigid_mass(Body body, PetscReal products[MAX_RIGID][MAX_RIGID])
{
  const PetscInt dim = body->mesh.dim, n = 3 * (dim - 1);
  Vec            motions[MAX_RIGID], image;

  ok(BodyCreateVec(body, &image));
  for (PetscInt k = 0; k < n; k++) {
    PetscScalar *values;

    ok(BodyCreateVec(body, &motions[k]));
    ok(VecGetArray(motions[k], &values));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++)
      values[i] = rigid_motion(dim, k, body->mesh.coordinates + i - i % dim, i % dim);
    ok(VecRestoreArray(motions[k], &values));
  }
  for (PetscInt k = 0; k < n; k++) {
    ok(BodyMultiplyMass(body, motions[k], image));
    for (PetscInt l = 0; l < n; l++) ok(VecDot(motions[l], image, &products[k][l]));
  }
  for (PetscInt k = 0; k < n; k++) ok(VecDestroy(&motions[k]));
  ok(VecDestroy(&image));
}

/* Against the body with its mass where it was: the same mass; a centre of mass and moments of inertia that are the same or have changed by
   what the body says */
static void compare(Body moved, Body whole, PetscReal size)
{
  const PetscInt dim = moved->mesh.dim, n = 3 * (dim - 1);
  const Moments  after = moments_of(moved), before = moments_of(whole);
  PetscReal      full[MAX_RIGID][MAX_RIGID], now[MAX_RIGID][MAX_RIGID], least, largest, shift[3] = {0}, inertia, change = 0;
  PetscBool      redistributed, centred = PETSC_TRUE;

  ok(BodyIsRedistributed(moved, &redistributed));
  assert_true(redistributed);
  ok(BodyGetMassRedistribution(moved, &least, &largest, shift, &inertia));
  assert_true(least >= 0.3 && least <= 1 + 1e-12 && largest >= 1 - 1e-12);
  /* sums of some hundred terms */
  near(after.mass, before.mass, 1e-12 * before.mass);
  near(moved->mass.total, before.mass, 1e-12 * before.mass);
  for (PetscInt d = 0; d < dim; d++) {
    near(shift[d], after.first[d] / after.mass - before.first[d] / before.mass, 1e-12 * size);
    if (shift[d] != 0) centred = PETSC_FALSE;
  }
  rigid_mass(moved, now);
  rigid_mass(whole, full);
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt l = 0; l < n; l++) {
      if (k < dim || l < dim) {
        if (centred) near(now[k][l], full[k][l], 1e-12 * before.mass * size);
      } else if (inertia == 0 && centred) near(now[k][l], full[k][l], 1e-12 * before.mass * size * size);
    }
  /* about the axes through the centre, whose moments change by no more than the largest there are */
  for (PetscInt k = dim; k < n && centred; k++) change = PetscMax(change, PetscAbsReal(now[k][k] / full[k][k] - 1));
  assert_true(change <= inertia * 1.0000001 + 1e-12);
  ok(BodyGetMassRedistribution(whole, &least, &largest, shift, &inertia));
  near(least, 1, 0);
  near(largest, 1, 0);
  for (PetscInt d = 0; d < dim; d++) near(shift[d], 0, 0);
  near(inertia, 0, 0);
}

#define MATERIAL "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 "

/* Two bodies of the same mesh (options without the prefix): with the mass of the planes' nodes moved, and without; not set up */
typedef struct {
  Body         moved, whole;
  PetscOptions options[2];
} Pair;

static Pair pair_create(const char text[], PetscInt type, PetscBool is_explicit)
{
  Pair pair;
  char all[2048];

  for (PetscInt i = 0; i < 2; i++) {
    (void)snprintf(all, sizeof(all), "%s " MATERIAL "-mass_type %s -ts_type %s %s -mass_redistribute %d", text, types[type],
                   is_explicit ? TSCENTRALDIFFERENCE : TSALPHA2, is_explicit ? "-ts_time_step auto" : "", i == 0);
    pair.options[i] = solid_body_create_on(PETSC_COMM_WORLD, i ? &pair.whole : &pair.moved, all);
    ok(BodySetControllerStep(i ? pair.whole : pair.moved, 0, 0.01));
  }
  return pair;
}

static void pair_set_up(Pair *pair)
{
  ok(BodySetUp(pair->moved));
  ok(BodySetUp(pair->whole));
}

static void pair_destroy(Pair *pair)
{
  bar_destroy(&pair->whole, pair->options[1]);
  bar_destroy(&pair->moved, pair->options[0]);
}

#define BOX_2D "-dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5 "
#define BOX_3D "-dm_plex_box_faces 3,3,3 -dm_plex_box_upper 2,1.5,1 "

/* Boxes of 2 x 1.5 (x 1) m weigh 9 kg */
static void of_a_layer_is_kept(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt type = 0; type < TYPES; type++)
      for (PetscInt i = 0; i < 2; i++) {
        const PetscInt axis = kind_dim[kind] - 1;
        char           text[512];
        Pair           pair;

        (void)snprintf(text, sizeof(text), "%s %s", kind_options(kind), axis == 1 ? BOX_2D : BOX_3D);
        pair = pair_create(text, type, (PetscBool)i);
        touch_side(pair.moved, axis == 1 ? "ymax" : "zmax");
        pair_set_up(&pair);
        check_layer(pair.moved);
        compare(pair.moved, pair.whole, 2);
        near(pair.moved->mass.total, 9, 1e-12 * 9);
        /* three layers of elements: the centre stays; the one moment of inertia of plane bodies too, those of others cannot all */
        for (PetscInt d = 0; d <= axis; d++) near(pair.moved->mass.shift[d], 0, 0);
        if (axis == 1) near(pair.moved->mass.inertia_error, 0, 0);
        else between(pair.moved->mass.inertia_error, 1e-3, 0.2); /* measured: 0.08 to 0.15 */
        assert_true(!pair.moved->mass.orphans);
        pair_destroy(&pair);
      }
}

/* Rank 0 writes a mesh for Gmsh */
static void write_mesh(const char path[], const Mesh *mesh)
{
  const int   type = mesh->shape == DM_POLYTOPE_TRIANGLE        ? 2
                     : mesh->shape == DM_POLYTOPE_QUADRILATERAL ? 3
                     : mesh->shape == DM_POLYTOPE_TETRAHEDRON   ? 4
                                                                : 5;
  PetscMPIInt rank;

  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (!rank) {
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", (int)mesh->n_nodes);
    for (PetscInt node = 0; node < mesh->n_nodes; node++)
      fprintf(file, "%d %.17g %.17g %.17g\n", (int)node + 1, mesh->x[mesh->dim * node], mesh->x[mesh->dim * node + 1],
              mesh->dim == 3 ? mesh->x[mesh->dim * node + 2] : 0);
    fprintf(file, "$EndNodes\n$Elements\n%d\n", (int)mesh->count);
    for (PetscInt cell = 0; cell < mesh->count; cell++) {
      fprintf(file, "%d %d 2 0 1", (int)cell + 1, type);
      for (PetscInt a = 0; a < mesh->nodes; a++) fprintf(file, " %d", (int)mesh->connectivity[cell * mesh->nodes + a] + 1);
      fprintf(file, "\n");
    }
    fprintf(file, "$EndElements\n");
    assert_int_equal(fclose(file), 0);
  }
  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
}

/* The nodes of a distorted mesh that are the last along an axis, or all that are not inside (axis -1) */
static void touch_mesh(Body body, const Mesh *mesh, const PetscInt n[3], PetscInt axis)
{
  const PetscInt stride[] = {1, n[0] + 1, (n[0] + 1) * (n[1] + 1)};
  PetscInt       start, end, vertices[MAX_NODES], n_vertices = 0;
  DM             dm;

  ok(BodyGetDM(body, &dm));
  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  for (PetscInt v = start; v < end; v++) {
    PetscReal x[3];

    vertex_position(dm, v, x);
    for (PetscInt node = 0; node < mesh->n_nodes; node++) {
      PetscReal distance = 0;

      for (PetscInt d = 0; d < mesh->dim; d++) distance += PetscAbsReal(x[d] - mesh->x[mesh->dim * node + d]);
      if (distance > 1e-9) continue;
      if (axis < 0 ? !mesh->inner[node] : node / stride[axis] % (n[axis] + 1) == n[axis]) vertices[n_vertices++] = v;
    }
  }
  ok(BodySetContactNodes(body, n_vertices, vertices));
}

/* Each node moved by up to 0.15 of an edge */
static void of_a_layer_is_kept_on_distorted_meshes(void **state)
{
  static const PetscInt n[3] = {3, 3, 3};

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt type = 0; type < TYPES; type++)
      for (PetscInt whole = 0; whole < 2; whole++) {
        Mesh mesh;
        Pair pair;

        mesh_box(&mesh, shapes[s], n, 0.15);
        write_mesh("solid-mass.msh", &mesh);
        pair = pair_create("-dm_plex_filename solid-mass.msh", type, PETSC_TRUE);
        touch_mesh(pair.moved, &mesh, n, whole ? -1 : mesh.dim - 1);
        pair_set_up(&pair);
        check_layer(pair.moved);
        compare(pair.moved, pair.whole, 3);
        pair_destroy(&pair);
        assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0); /* before the file changes */
      }
}

static const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

/* The same on one rank: sums of some hundred terms */
static void check_alone(Body body, const char text[], PetscInt n_sides)
{
  const Moments together = moments_of(body);
  PetscOptions  options  = solid_body_create_on(PETSC_COMM_SELF, &body, text);
  Moments       alone;

  for (PetscInt side = 0; side < n_sides; side++) touch_side(body, sides[side]);
  ok(BodySetControllerStep(body, 0, 0.01));
  ok(BodySetUp(body));
  alone = moments_of(body);
  near(together.mass, alone.mass, 1e-13 * alone.mass);
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    near(together.first[d], alone.first[d], 1e-13 * 2 * alone.mass);
    near(together.second[d], alone.second[d], 1e-13 * 4 * alone.mass);
  }
  bar_destroy(&body, options);
}

/* From one side to the whole boundary: then triangles in two corners, and tetrahedra along edges, have no inner node */
static void of_elements_without_inner_nodes_goes_to_their_neighbours(void **state)
{
  PetscInt orphaned = 0;

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt type = 0; type < TYPES; type++)
      for (PetscInt n_sides = 1; n_sides <= 2 * kind_dim[kind]; n_sides++) {
        char text[1024], full[2048];
        Pair pair;

        (void)snprintf(text, sizeof(text), "%s %s", kind_options(kind), kind_dim[kind] == 2 ? BOX_2D : BOX_3D);
        (void)snprintf(full, sizeof(full), "%s " MATERIAL "-mass_type %s", text, types[type]);
        pair = pair_create(text, type, PETSC_FALSE);
        for (PetscInt side = 0; side < n_sides; side++) touch_side(pair.moved, sides[side]);
        pair_set_up(&pair);
        check_layer(pair.moved);
        compare(pair.moved, pair.whole, 2);
        check_alone(pair.moved, full, n_sides);
        if (pair.moved->mass.orphans) orphaned++;
        /* corners of quadrilaterals and hexahedra are met by elements with an inner node */
        if (kind == 0 || kind == 2) assert_true(!pair.moved->mass.orphans);
        else if (n_sides == 2 * kind_dim[kind]) assert_true(pair.moved->mass.orphans != NULL);
        pair_destroy(&pair);
      }
  assert_true(orphaned >= 2 * TYPES);
}

/* The whole boundary is the layer: of 3 kg, the inner nodes of 3 x 2 squares or 3 x 3 x 2 cubes carry equal shares, by symmetry. Fewer of
   them could not hold the rest without mass. */
static void of_all_elements_is_at_a_few_inner_nodes(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt type = 0; type < TYPES; type++) {
      const PetscInt dim     = kind_dim[kind];
      PetscReal      largest = 0;
      char           text[512];
      Pair           pair;

      (void)snprintf(text, sizeof(text), "%s -dm_plex_box_faces %s", kind_options(kind), dim == 2 ? "3,2" : "3,3,2");
      pair = pair_create(text, type, PETSC_TRUE);
      for (PetscInt side = 0; side < 2 * dim; side++) touch_side(pair.moved, sides[side]);
      pair_set_up(&pair);
      check_layer(pair.moved);
      compare(pair.moved, pair.whole, 1);
      ok(VecMax(pair.moved->mass.row_sum, NULL, &largest));
      if (kind == 0 || kind == 2) near(largest, dim == 2 ? 1.5 : 0.75, 3e-13);
      for (PetscInt d = 0; d < dim; d++) near(pair.moved->mass.shift[d], 0, 1e-13); /* a half turn brings the mesh onto itself */
      pair_destroy(&pair);
    }
}

/* One row of elements between two contact surfaces */
static void is_refused_without_an_inner_node(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++) {
    const PetscInt dim = kind_dim[kind];
    PetscOptions   options;
    Body           body;

    options = solid_body_create(&body, "%s %s -dm_plex_box_faces %s", kind_options(kind), MATERIAL, dim == 2 ? "4,1" : "3,2,1");
    touch_side(body, dim == 2 ? "ymin" : "zmin");
    touch_side(body, dim == 2 ? "ymax" : "zmax");
    ok(BodySetControllerStep(body, 0, 0.01));
    refused(PETSC_ERR_USER_INPUT, "'b'| kg of elements|contact surfaces|refine|-b_mass_redistribute", BodySetUp(body));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

/* A single node with mass cannot hold the massless rest of the body: the rest can turn about it */
static void is_refused_where_it_cannot_hold_the_layer(void **state)
{
  PetscOptions options;
  Body         body;

  (void)state;
  options = solid_body_create(&body, "%s %s -dm_plex_box_faces 2,2", kind_options(0), MATERIAL);
  touch_side(body, "xmin");
  touch_side(body, "xmax");
  touch_side(body, "ymin");
  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, 1e-4));
  refused(PETSC_ERR_USER_INPUT, "'b'|too few nodes with mass|refine|-b_mass_redistribute", BodySetUp(body));
  ok(BodyDestroy(&body));
  options_drop(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_a_layer_is_kept),
      cmocka_unit_test(of_a_layer_is_kept_on_distorted_meshes),
      cmocka_unit_test(of_elements_without_inner_nodes_goes_to_their_neighbours),
      cmocka_unit_test(of_all_elements_is_at_a_few_inner_nodes),
      cmocka_unit_test(is_refused_without_an_inner_node),
      cmocka_unit_test(is_refused_where_it_cannot_hold_the_layer),
  };

  return impakt_main(argc, argv, tests);
}
