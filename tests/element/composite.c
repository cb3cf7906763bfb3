/* Composite elements of six and ten nodes: load points, masses, linear displacements, forces against energies, nearest points, what is
 * refused. */
#include "solid_mesh.h"

#define MAX_POINTS 48

static const DMPolytopeType simplices[] = {DM_POLYTOPE_TRIANGLE, DM_POLYTOPE_TETRAHEDRON};
static const char *const    materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 3
static const PetscInt  edge_ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
static const PetscReal edges[3][3]     = {{1.1, 0.2, -0.1}, {0.3, 1.2, 0.1}, {0.2, 0.3, 0.8}};

/* One element, edges from its first corner the columns of a matrix; nodes in the middle of edges, or off it by up to `off` along each axis
 * [m] */
static void mesh_composite(Mesh *mesh, DMPolytopeType shape, PetscReal off)
{
  memset(mesh, 0, sizeof(*mesh));
  mesh->shape   = shape;
  mesh->dim     = DMPolytopeTypeGetDim(shape);
  mesh->nodes   = mesh->dim == 2 ? 6 : 10;
  mesh->n_nodes = mesh->nodes;
  mesh->count   = 1;
  for (PetscInt a = 0; a < mesh->nodes; a++) {
    mesh->connectivity[a] = a;
    for (PetscInt i = 0; i < mesh->dim; i++) {
      const PetscInt *ends = edge_ends[PetscMax(0, a - mesh->dim - 1)];

      if (a <= mesh->dim) mesh->x[mesh->dim * a + i] = 0.3 + i + (a ? edges[i][a - 1] : 0);
      else
        mesh->x[mesh->dim * a + i] = 0.5 * (mesh->x[mesh->dim * ends[0] + i] + mesh->x[mesh->dim * ends[1] + i]) +
                                     off * scatter(mesh->dim * a + i);
    }
  }
}

/* Of the element with straight edges */
static PetscReal get_volume(PetscInt dim)
{
  if (dim == 2) return (edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0]) / 2;
  return (edges[0][0] * (edges[1][1] * edges[2][2] - edges[1][2] * edges[2][1]) -
          edges[0][1] * (edges[1][0] * edges[2][2] - edges[1][2] * edges[2][0]) +
          edges[0][2] * (edges[1][0] * edges[2][1] - edges[1][1] * edges[2][0])) /
         6;
}

static void create(Solid *solid, const Mesh *mesh, const char material[], const char more[])
{
  solid_begin(solid, mesh, material, more);
  ok(ElementSetComposite(solid->element));
  ok(ElementSetUp(solid->element, mesh->count, mesh->connectivity, mesh->x));
  assert_int_equal(solid->element->nodes, mesh->nodes);
}

/* Shape functions at load points are a partition of unity, and put the points where they are, also in elements with curved edges; weights
   are positive, and their sum is the volume, times the thickness of 1 m */
static void load_points_are_where_shape_functions_say(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++)
    for (PetscInt curved = 0; curved < 2; curved++) {
      PetscReal positions[3 * MAX_POINTS], weights[MAX_POINTS], volume = 0;
      Mesh      mesh;
      Solid     solid;

      mesh_composite(&mesh, simplices[s], 0.05 * curved);
      create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
      assert_int_equal(solid.element->n_points, s ? 48 : 12);
      ok((*solid.element->ops->points)(solid.element, 0, positions, weights));
      for (PetscInt g = 0; g < solid.element->n_points; g++) {
        const PetscReal *N   = solid.element->shape + g * mesh.nodes;
        PetscReal        sum = 0;

        assert_true(weights[g] > 0);
        volume += weights[g];
        for (PetscInt a = 0; a < mesh.nodes; a++) sum += N[a];
        near(sum, 1, 1e-15);
        for (PetscInt i = 0; i < mesh.dim; i++) {
          PetscReal x = 0;

          for (PetscInt a = 0; a < mesh.nodes; a++) x += N[a] * mesh.x[mesh.dim * a + i];
          near(positions[mesh.dim * g + i], x, 2e-15); /* of some m */
        }
      }
      if (!curved) near(volume, get_volume(mesh.dim), 1e-15);
      solid_destroy(&solid);
    }
}

/* The mass matrix is symmetric; its rows, which become nodal masses, have positive sums, and are together density 3 kg/m^3 times volume;
   the first moments are those of the load points */
static void masses_are_positive_and_complete(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++)
    for (PetscInt curved = 0; curved < 2; curved++) {
      PetscReal M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], positions[3 * MAX_POINTS], weights[MAX_POINTS], mass = 0, volume = 0;
      Mesh      mesh;
      Solid     solid;

      mesh_composite(&mesh, simplices[s], 0.05 * curved);
      create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
      ok((*solid.element->ops->mass)(solid.element, 0, M));
      ok((*solid.element->ops->points)(solid.element, 0, positions, weights));
      for (PetscInt g = 0; g < solid.element->n_points; g++) volume += weights[g];
      const PetscInt d = mesh.dim;

      for (PetscInt i = 0; i < d; i++) {
        PetscReal moment = 0, expected = 0;

        mass = 0;
        for (PetscInt a = 0; a < mesh.nodes; a++) {
          PetscReal row = 0;

          for (PetscInt b = 0; b < mesh.nodes; b++) {
            near(M[a * mesh.nodes + b], M[b * mesh.nodes + a], 1e-17);
            row += M[a * mesh.nodes + b];
          }
          assert_true(row > 0.02 * 3 * volume);
          mass += row;
          moment += row * mesh.x[d * a + i];
        }
        near(mass, 3 * volume, 1e-14);
        for (PetscInt g = 0; g < solid.element->n_points; g++) expected += 3 * weights[g] * positions[d * g + i];
        near(moment, expected, 1e-14);
      }
      if (!curved) near(mass, 3 * get_volume(d), 1e-14);
      solid_destroy(&solid);
    }
}

/* Errors of the central difference as of the full elements, in solid_elements.c */
static void forces_and_tangents_are_derivatives(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++)
    for (PetscInt m = 0; m < MATERIALS; m++)
      for (PetscInt plane_stress = 0; plane_stress <= (s == 0); plane_stress++) {
        PetscReal u[MAX_DOFS];
        Mesh      mesh;
        Solid     solid;

        mesh_composite(&mesh, simplices[s], 0.05);
        create(&solid, &mesh, materials[m], plane_stress ? "-plane_stress" : "");
        set_scattered(&mesh, 0.03, u);
        check_force(&solid, &mesh, u, 1e-8 * LAME);
        check_tangent(&solid, &mesh, u, 1e-7 * LAME);
        solid_destroy(&solid);
      }
}

/* Of a point within, its place among the nodes; of one beyond a corner, that corner and its distance */
static void nearest_points_are_found(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++) {
    PetscReal N[10], distance, within[3] = {0}, beyond[3];
    Mesh      mesh;
    Solid     solid;

    mesh_composite(&mesh, simplices[s], 0.05);
    create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
    for (PetscInt i = 0; i < mesh.dim; i++) {
      for (PetscInt a = 0; a <= mesh.dim; a++) within[i] += (a + 1.) / (mesh.dim == 2 ? 6 : 10) * mesh.x[mesh.dim * a + i];
      beyond[i] = mesh.x[i] - 0.1 * (edges[i][0] + edges[i][1] + (mesh.dim == 3 ? edges[i][2] : 0));
    }
    ok((*solid.element->ops->nearest)(solid.element, 0, within, N, &distance));
    near(distance, 0, 1e-15);
    for (PetscInt i = 0; i < mesh.dim; i++) {
      PetscReal x = 0, sum = 0;

      for (PetscInt a = 0; a < mesh.nodes; a++) {
        sum += N[a];
        x += N[a] * mesh.x[mesh.dim * a + i];
      }
      near(sum, 1, 1e-15);
      near(x, within[i], 1e-15 * 10);
    }
    ok((*solid.element->ops->nearest)(solid.element, 0, beyond, N, &distance));
    for (PetscInt a = 0; a < mesh.nodes; a++) near(N[a], a == 0, 1e-15);
    for (PetscInt i = 0; i < mesh.dim; i++) distance = PetscSqrtReal(PetscMax(0, PetscSqr(distance) - PetscSqr(beyond[i] - mesh.x[i])));
    near(distance, 0, 1e-7); /* a root of round-off */
    solid_destroy(&solid);
  }
}

/* An element with a point inside out has no force, and is told by its number */
static void inverted_elements_are_told(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++)
    for (PetscInt m = 1; m < MATERIALS; m++) {
      PetscReal u[MAX_DOFS] = {0}, f[MAX_DOFS];
      Mesh      mesh;
      Solid     solid;

      mesh_composite(&mesh, simplices[s], 0);
      create(&solid, &mesh, materials[m], "");
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] = i % mesh.dim ? 0 : -2 * mesh.x[i];
      get_force(&solid, &mesh, u, f);
      assert_int_equal(solid.element->inverted, 0);
      assert_true(isnan(get_energy(&solid, u)));
      solid_destroy(&solid);
    }
}

/* More elements than a batch, all alike: each has the force of one */
static void batches_are_filled(void **state)
{
  (void)state;
  for (PetscInt s = 0; s < 2; s++) {
    PetscReal u[MAX_DOFS], one[MAX_DOFS], all[MAX_DOFS];
    Mesh      mesh;
    Solid     solid;

    mesh_composite(&mesh, simplices[s], 0.05);
    set_scattered(&mesh, 0.03, u);
    create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "");
    get_force(&solid, &mesh, u, one);
    solid_destroy(&solid);
    for (mesh.count = 1; mesh.count < 11; mesh.count++)
      for (PetscInt a = 0; a < mesh.nodes; a++) mesh.connectivity[mesh.count * mesh.nodes + a] = a;
    create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "");
    get_force(&solid, &mesh, u, all);
    for (PetscInt i = 0; i < mesh.dim * mesh.nodes; i++) near(all[i], 11 * one[i], 1e-13 * 11 * largest_of(mesh.dim * mesh.nodes, one));
    solid_destroy(&solid);
  }
}

static void refuse(const Mesh *mesh, const char more[], PetscErrorCode code, const char words[])
{
  Solid solid;

  solid_begin(&solid, mesh, MATERIAL_LINEAR_ELASTIC, more);
  ok(ElementSetComposite(solid.element));
  refused(code, words, ElementSetUp(solid.element, mesh->count, mesh->connectivity, mesh->x));
  ok(ElementDestroy(&solid.element));
  ok(MaterialDestroy(&solid.material));
  options_drop(solid.options);
}

static void bad_elements_are_refused(void **state)
{
  const PetscInt one[3] = {1, 1, 1};
  Mesh           mesh;
  Solid          solid;

  (void)state;
  for (PetscInt s = 0; s < 2; s++) {
    const PetscInt middle = s ? 4 : 3; /* of the edge between the first two corners */

    mesh_composite(&mesh, simplices[s], 0);
    for (PetscInt i = 0; i < mesh.dim; i++)
      mesh.x[mesh.dim * middle + i] = 1.2 * mesh.x[mesh.dim + i] - 0.2 * mesh.x[i]; /* beyond the second corner */
    refuse(&mesh, "", PETSC_ERR_USER_INPUT,
           s ? "Element 0|10 nodes|one of the 12 linear elements|middle of their edges"
             : "Element 0|6 nodes|one of the 4 linear elements|the area");
    mesh_composite(&mesh, simplices[s], 0);
    for (PetscInt i = 0; i < mesh.dim; i++) {
      const PetscReal first = mesh.x[i];

      mesh.x[i]            = mesh.x[mesh.dim + i];
      mesh.x[mesh.dim + i] = first;
    }
    refuse(&mesh, "", PETSC_ERR_USER_INPUT, "is inverted or degenerate");
    mesh_composite(&mesh, simplices[s], 0);
    refuse(&mesh, "-element_formulation enhanced", PETSC_ERR_USER_INPUT, "they have full, composite");
  }
  mesh_box(&mesh, DM_POLYTOPE_QUADRILATERAL, one, 0);
  solid_begin(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
  refused(PETSC_ERR_ARG_INCOMP, "-b_element_formulation composite|'quadrilateral' have none", ElementSetComposite(solid.element));
  solid_destroy(&solid);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(load_points_are_where_shape_functions_say),
      cmocka_unit_test(masses_are_positive_and_complete),
      cmocka_unit_test(forces_and_tangents_are_derivatives),
      cmocka_unit_test(nearest_points_are_found),
      cmocka_unit_test(inverted_elements_are_told),
      cmocka_unit_test(batches_are_filled),
      cmocka_unit_test(bad_elements_are_refused),
  };

  return impakt_main(argc, argv, tests);
}
