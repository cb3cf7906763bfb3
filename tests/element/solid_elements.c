/* tri3, quad4, tet4, hex8: rigid motions, patch tests, energy against force against tangent, batches; masses and load points, inverted
   elements, meshes that are refused, thickness, plane stress. */
#include "solid_mesh.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 3

static const PetscInt three[3] = {3, 3, 3};

/* A central difference over +-1e-5 m at strains of some 0.1: error 1e-10 / 6 times a third derivative of some 10 moduli, and round-off of
   1e-16 / 1e-5 of the energy, which is of the size of the forces. */
static void force_and_tangent_are_derivatives(void **state)
{
  const PetscInt one[3] = {1, 1, 1};
  PetscReal      u[MAX_DOFS];
  Mesh           mesh;
  Solid          solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, shapes[s], one, 0.15);
      solid_create(&solid, &mesh, materials[m], "");
      set_scattered(&mesh, 0.05, u);
      check_force(&solid, &mesh, u, 1e-8 * LAME);
      solid_destroy(&solid);
      mesh.count = 1;
      solid_create(&solid, &mesh, materials[m], "");
      check_tangent(&solid, &mesh, u, 1e-8 * LAME);
      solid_destroy(&solid);
    }
}

static void small_strains_keep_their_digits(void **state)
{
  Mesh mesh;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_box(&mesh, shapes[s], three, 0.15);
    check_small_strains(&mesh, "");
  }
}

static void batches_may_be_of_any_size(void **state)
{
  PetscReal u[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_box(&mesh, shapes[s], shapes[s] == DM_POLYTOPE_QUADRILATERAL ? (PetscInt[3]){5, 4, 0} : three, 0.15);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "");
    set_scattered(&mesh, 0.05, u);
    check_batches(&solid, &mesh, u, 1e-13 * LAME);
    solid_destroy(&solid);
  }
}

/* Boxes that are sheared, in which Jacobians are constant; `off`: and then moved apart, more than makes parallelepipeds of them */
static void mesh_sheared(Mesh *mesh, DMPolytopeType shape, PetscReal off)
{
  mesh_box(mesh, shape, three, 0);
  for (PetscInt node = 0; node < mesh->n_nodes; node++) {
    PetscReal at[3] = {0};

    for (PetscInt d = 0; d < mesh->dim; d++) at[d] = mesh->x[mesh->dim * node + d];
    for (PetscInt d = 0; d < mesh->dim; d++)
      mesh->x[mesh->dim * node + d] = 10.1 + 0.7 * at[d] + 0.3 * at[(d + 1) % mesh->dim] + off * scatter(mesh->dim * node + d);
  }
}

/* Elements with a constant Jacobian have loops of their own. Moved apart by 1e-9 m they have not, and differ by that times some strains; of
   a linear material forces are those of the stiffness, which has one loop for all, but for round-off. */
static void parallelepipeds_have_the_forces_of_other_elements(void **state)
{
  PetscReal      u[MAX_DOFS], f[MAX_DOFS], near_by[MAX_DOFS], K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], energy;
  PetscLogDouble flops[4];
  Mesh           mesh, moved;
  Solid          solid, other;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      const PetscBool own = (PetscBool)(shapes[s] == DM_POLYTOPE_QUADRILATERAL || shapes[s] == DM_POLYTOPE_HEXAHEDRON);
      PetscReal       largest;

      mesh_sheared(&mesh, shapes[s], 0);
      mesh_sheared(&moved, shapes[s], 1e-9);
      solid_create(&solid, &mesh, materials[m], "");
      solid_create(&other, &moved, materials[m], "");
      set_scattered(&mesh, 0.03, u);
      ok(PetscGetFlops(&flops[0]));
      get_force(&solid, &mesh, u, f);
      ok(PetscGetFlops(&flops[1]));
      get_force(&other, &moved, u, near_by);
      ok(PetscGetFlops(&flops[2]));
#if defined(PETSC_USE_LOG)
      if (own) assert_true(flops[1] - flops[0] < (m ? 0.95 : 0.6) * (flops[2] - flops[1])); /* its own loop */
      else assert_true(flops[1] - flops[0] == flops[2] - flops[1]);
#endif
      largest = largest_of(mesh.dim * mesh.n_nodes, f);
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) near(f[i], near_by[i], 2e-8 * largest);
      energy = get_energy(&solid, u);
      near(energy, get_energy(&other, u), 2e-8 * energy);
      check_force(&solid, &mesh, u, 1e-8 * LAME);
      for (PetscInt e = 0; e < mesh.count && m == 0; e++) {
        const PetscInt *nodes = mesh.connectivity + e * mesh.nodes, n = mesh.dim * mesh.nodes;

        ok((*solid.element->ops->tangent)(solid.element, e, PETSC_FALSE, u, K));
        for (PetscInt a = 0; a < n; a++)
          for (PetscInt b = 0; b < n; b++)
            f[mesh.dim * nodes[a / mesh.dim] + a % mesh.dim] -= K[a * n + b] * u[mesh.dim * nodes[b / mesh.dim] + b % mesh.dim];
      }
      if (m == 0) between(largest_of(mesh.dim * mesh.n_nodes, f), 0, 1e-13 * largest);
      solid_destroy(&other);
      solid_destroy(&solid);
    }
}

/* Of positive determinant, and so is its part in the plane */
static const PetscReal edges[3][3] = {{1.1, 0.2, -0.1}, {0.3, 1.2, 0.1}, {0.2, 0.3, 0.8}};

static PetscReal get_volume(const Mesh *mesh)
{
  const PetscReal plane = edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0];
  const PetscReal space = edges[0][0] * (edges[1][1] * edges[2][2] - edges[1][2] * edges[2][1]) -
                          edges[0][1] * (edges[1][0] * edges[2][2] - edges[1][2] * edges[2][0]) +
                          edges[0][2] * (edges[1][0] * edges[2][1] - edges[1][1] * edges[2][0]);

  if (mesh->shape == DM_POLYTOPE_TRIANGLE) return plane / 2;
  if (mesh->shape == DM_POLYTOPE_QUADRILATERAL) return plane;
  return mesh->shape == DM_POLYTOPE_TETRAHEDRON ? space / 6 : space;
}

/* How many edges lie between two nodes of a square or a cube */
static PetscInt get_edges_between(PetscInt a, PetscInt b)
{
  static const PetscInt at[8] = {0, 1, 3, 2, 4, 5, 7, 6}; /* bits: along x, y, z */
  const PetscInt        bits  = at[a] ^ at[b];

  return (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1);
}

/* Integrals of N_a N_b over simplices are V (1 + delta_ab) / ((d + 1) (d + 2)), over parallelepipeds V times 1/3 for each axis along
   which a and b are at the same end and 1/6 for each other. (Zienkiewicz and Taylor, The Finite Element Method, volume 1, app. of
   integrals) */
static void mass_is_that_of_the_book(void **state)
{
  Mesh      mesh;
  Solid     solid;
  PetscReal M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_parallel(&mesh, shapes[s], edges);
    const PetscInt  d = mesh.dim, n = mesh.nodes;
    const PetscReal mass = 3 * get_volume(&mesh) * (d == 2 ? 0.5 : 1);

    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, d == 2 ? "-thickness 0.5" : "");
    ok((*solid.element->ops->mass)(solid.element, 0, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) {
        PetscReal expected = mass;

        if (s % 2 == 0) expected *= (a == b ? 2. : 1.) / ((d + 1) * (d + 2));
        else expected *= PetscPowRealInt(1. / 3, d) * PetscPowRealInt(0.5, get_edges_between(a, b));
        near(M[a * n + b], expected, 1e-15 * mass);
      }
    solid_destroy(&solid);
  }
}

/* A row of elements with nodes of their own each, of which some are mirrored (det F = -1) */
static void mirrored_elements_are_found(void **state)
{
  static const char *const materials[] = {MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
  static const PetscInt    which[][2]  = {{0, 5}, {3, 3}, {5, 1}, {6, 6}}; /* of 7 elements */
  PetscReal                u[MAX_DOFS], f[MAX_DOFS];
  Mesh                     mesh, one;
  Solid                    solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < 2; m++) {
      mesh_parallel(&one, shapes[s], edges);
      mesh         = one;
      mesh.count   = 7;
      mesh.n_nodes = 7 * one.nodes;
      for (PetscInt e = 0; e < 7; e++)
        for (PetscInt a = 0; a < one.nodes; a++) {
          mesh.connectivity[e * one.nodes + a] = e * one.nodes + a;
          for (PetscInt i = 0; i < one.dim; i++) mesh.x[one.dim * (e * one.nodes + a) + i] = one.x[one.dim * one.connectivity[a] + i];
        }
      solid_create(&solid, &mesh, materials[m], "");
      for (PetscInt k = 0; k < 4; k++) {
        for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] = 0;
        for (PetscInt n = 0; n < 2; n++)
          for (PetscInt a = 0; a < mesh.nodes; a++) {
            const PetscInt dof = mesh.dim * (which[k][n] * mesh.nodes + a);

            u[dof] = -2 * mesh.x[dof];
          }
        get_force(&solid, &mesh, u, f);
        assert_int_equal(solid.element->inverted, PetscMin(which[k][0], which[k][1]));
        (void)get_energy(&solid, u);
        assert_int_equal(solid.element->inverted, PetscMin(which[k][0], which[k][1]));
      }
      solid_destroy(&solid);
    }
}

/* Set-up of the mesh as it is must end with the error */
static void refuse(const Mesh *mesh, const char words[])
{
  Solid solid;

  solid_begin(&solid, mesh, MATERIAL_LINEAR_ELASTIC, "");
  refused(PETSC_ERR_USER_INPUT, words, ElementSetUp(solid.element, mesh->count, mesh->connectivity, mesh->x));
  solid_destroy(&solid);
}

static void bad_meshes_are_refused(void **state)
{
  const PetscInt three[3] = {3, 3, 3};
  Mesh           mesh;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    PetscInt *cell, node;

    /* the other way round: two vertices exchanged */
    mesh_box(&mesh, shapes[s], three, 0.1);
    cell    = mesh.connectivity + 2 * mesh.nodes;
    node    = cell[0];
    cell[0] = cell[1];
    cell[1] = node;
    refuse(&mesh, "Element 2|inverted or degenerate|counterclockwise");
    /* no extent along y, but for round-off */
    mesh_parallel(&mesh, shapes[s], edges);
    for (PetscInt a = 0; a < mesh.n_nodes; a++) mesh.x[mesh.dim * a + 1] = 0.3 * mesh.x[mesh.dim * a];
    refuse(&mesh, "Element 0|inverted or degenerate");
    /* a node given twice */
    mesh_box(&mesh, shapes[s], three, 0.1);
    mesh.connectivity[mesh.nodes + 1] = mesh.connectivity[mesh.nodes];
    refuse(&mesh, "Element 1|inverted or degenerate");
    /* no position */
    mesh_box(&mesh, shapes[s], three, 0.1);
    mesh.x[mesh.dim * mesh.connectivity[0] + 1] = NAN;
    refuse(&mesh, "Element 0|inverted or degenerate");
    /* the middle is fine, one corner is not: a re-entrant one */
    if (s % 2 == 0) continue;
    mesh_parallel(&mesh, shapes[s], (const PetscReal[3][3]){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    for (PetscInt i = 0; i < mesh.dim; i++) mesh.x[mesh.dim * mesh.connectivity[0] + i] += mesh.dim == 2 ? 0.51 : 0.7;
    refuse(&mesh, "Element 0|inverted or degenerate");
  }
}

/* A slender or a flat element is none of those: 1 m by 1 um */
static void flat_elements_are_accepted(void **state)
{
  Mesh  mesh;
  Solid solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_parallel(&mesh, shapes[s], (const PetscReal[3][3]){{1, 0, 0}, {0, 1e-6, 0}, {0, 0, 1e-6}});
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
    solid_destroy(&solid);
  }
}

static void thickness_multiplies_what_is_integrated(void **state)
{
  static const char *const formulations[] = {"full", "full", "mean_dilatation", "enhanced",
                                             "reduced"}; /* of triangles, then quadrilaterals */
  PetscReal                u[MAX_DOFS], f[2][MAX_DOFS], energy[2], K[2][ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], stress[2][6 * MAX_CELLS];
  Mesh                     mesh;
  Solid                    solid;

  (void)state;
  for (PetscInt s = 0; s < 5; s++) {
    char options[128];

    mesh_box(&mesh, shapes[PetscMin(s, 1)], (PetscInt[3]){1, 1, 0}, 0.1);
    set_scattered(&mesh, 0.05, u);
    for (PetscInt thick = 0; thick < 2; thick++) { /* 1 m, which is the default, or 0.25 m */
      ok(PetscSNPrintf(options, sizeof(options), "-element_formulation %s%s", formulations[s], thick ? " -thickness 0.25" : ""));
      solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, options);
      assert_true(solid.element->cross_section == (thick ? 0.25 : 1));
      get_force(&solid, &mesh, u, f[thick]);
      energy[thick] = get_energy(&solid, u);
      ok((*solid.element->ops->tangent)(solid.element, 0, PETSC_FALSE, u, K[thick]));
      ok((*solid.element->ops->stress)(solid.element, u, stress[thick]));
      solid_destroy(&solid);
    }
    /* powers of two are exact */
    assert_true(energy[1] == 0.25 * energy[0]);
    for (PetscInt i = 0; i < 2 * mesh.n_nodes; i++) assert_true(f[1][i] == 0.25 * f[0][i]);
    for (PetscInt i = 0; i < 4 * mesh.nodes * mesh.nodes; i++) assert_true(K[1][i] == 0.25 * K[0][i]);
    for (PetscInt i = 0; i < 6 * mesh.count; i++) assert_true(stress[1][i] == stress[0][i]);
    solid_begin(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
    options_drop(solid.options);
    ok(ElementDestroy(&solid.element));
    solid.options = options_begin("-b_thickness 0");
    refused(PETSC_ERR_USER_INPUT, "-b_thickness|positive", element_create("b_", mesh.shape, solid.material, &solid.element));
    options_drop(solid.options);
    ok(ElementDestroy(&solid.element));
    ok(MaterialDestroy(&solid.material));
  }
}

/* With lambda = mu, P_zz = mu (s - 1/s) + mu/2 ((A s)^2 - 1) / s = 0 for the stretch s across, A the ratio of areas in the plane:
   s^2 = 3 / (2 + A^2). A solid with that stretch has the same Cauchy stress. */
static void nonlinear_plane_stress_is_that_of_a_solid(void **state)
{
  PetscReal gradient[3][3] = {{0.3, 0.1, 0}, {0.2, -0.2, 0}, {0, 0, 0}};
  PetscReal u[MAX_DOFS], stress[6 * MAX_CELLS], expected[6], area;
  Mesh      mesh;
  Solid     solid;

  (void)state;
  area           = (1 + gradient[0][0]) * (1 + gradient[1][1]) - gradient[0][1] * gradient[1][0];
  gradient[2][2] = PetscSqrtReal(3 / (2 + area * area)) - 1;
  mesh_parallel(&mesh, DM_POLYTOPE_HEXAHEDRON, edges);
  set_linear(&mesh, gradient, u);
  solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "");
  ok((*solid.element->ops->stress)(solid.element, u, expected));
  near(expected[2], 0, 1e-12);
  between(expected[0], 10, 100);
  solid_destroy(&solid);
  for (PetscInt s = 0; s < 2; s++) {
    mesh_box(&mesh, shapes[s], (PetscInt[3]){3, 3, 0}, 0.1);
    set_linear(&mesh, gradient, u);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "-plane_stress");
    ok((*solid.element->ops->stress)(solid.element, u, stress));
    for (PetscInt e = 0; e < mesh.count; e++)
      for (PetscInt k = 0; k < 6; k++) near(stress[6 * e + k], expected[k], 1e-12 * LAME);
    solid_destroy(&solid);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(force_and_tangent_are_derivatives),
      cmocka_unit_test(small_strains_keep_their_digits),
      cmocka_unit_test(batches_may_be_of_any_size),
      cmocka_unit_test(parallelepipeds_have_the_forces_of_other_elements),
      cmocka_unit_test(mass_is_that_of_the_book),
      cmocka_unit_test(mirrored_elements_are_found),
      cmocka_unit_test(bad_meshes_are_refused),
      cmocka_unit_test(flat_elements_are_accepted),
      cmocka_unit_test(thickness_multiplies_what_is_integrated),
      cmocka_unit_test(nonlinear_plane_stress_is_that_of_a_solid),
  };

  return impakt_main(argc, argv, tests);
}
