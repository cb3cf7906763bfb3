/* mean_dilatation and enhanced: rigid motions, patch tests, energy against force against tangent, viscosity, what keeps from locking. */
/* ranks: 1 */
#include "solid_mesh.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 3

typedef struct {
  DMPolytopeType shape;
  const char    *options;
} Kind;

static const Kind kinds[] = {
    {DM_POLYTOPE_QUADRILATERAL, "-element_formulation mean_dilatation"},
    {DM_POLYTOPE_HEXAHEDRON, "-element_formulation mean_dilatation"},
    {DM_POLYTOPE_QUADRILATERAL, "-element_formulation enhanced"},
    {DM_POLYTOPE_HEXAHEDRON, "-element_formulation enhanced"},
    {DM_POLYTOPE_QUADRILATERAL, "-element_formulation enhanced -plane_stress"},
    {DM_POLYTOPE_QUADRILATERAL, "-element_formulation reduced -plane_stress"},
    {DM_POLYTOPE_QUADRILATERAL, "-element_formulation reduced"},
    {DM_POLYTOPE_HEXAHEDRON, "-element_formulation reduced"},
};
#define KINDS 8

static const PetscInt one[3] = {1, 1, 1}, three[3] = {3, 3, 3};

static const PetscReal stretch[3][3] = {{0.11, 0.05, -0.07}, {-0.02, -0.08, 0.03}, {0.04, 0.06, 0.09}};

/* Rotation by 1 rad about the z axis, less the identity */
static const PetscReal turn[3][3] = {
    {-0.45969769413186023, -0.8414709848078965, 0}, {0.8414709848078965, -0.45969769413186023, 0}, {0, 0, 0}};

/* As of the full elements, in solid_elements.c */
static void rigid_motion_meets_no_resistance(void **state)
{
  const PetscReal spin[3][3] = {{0, -0.3, 0.2}, {0.3, 0, 0.5}, {-0.2, -0.5, 0}};
  PetscReal       u[MAX_DOFS], f[MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, kinds[s].shape, three, 0.15);
      solid_create(&solid, &mesh, materials[m], kinds[s].options);
      set_linear(&mesh, m ? turn : spin, u);
      get_force(&solid, &mesh, u, f);
      assert_int_equal(solid.element->inverted, -1);
      between(largest_of(mesh.dim * mesh.n_nodes, f), 0, 2e-12);
      near(get_energy(&solid, u), 0, 1e-12);
      solid_destroy(&solid);
    }
}

/* Forces and stresses of a linear displacement are those of the full element, to round-off */
static void linear_displacement_is_as_of_the_full_element(void **state)
{
  PetscReal u[MAX_DOFS], f[2][MAX_DOFS], stress[2][6 * MAX_CELLS], energy[2];
  Mesh      mesh;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, kinds[s].shape, three, 0.15);
      set_linear(&mesh, stretch, u);
      for (PetscInt full = 0; full < 2; full++) {
        Solid       solid;
        const char *plane = s == 4 || s == 5 ? "-plane_stress" : "";

        solid_create(&solid, &mesh, materials[m], full ? plane : kinds[s].options);
        get_force(&solid, &mesh, u, f[full]);
        energy[full] = get_energy(&solid, u);
        ok((*solid.element->ops->stress)(solid.element, u, stress[full]));
        solid_destroy(&solid);
      }
      between(largest_of(mesh.dim * mesh.n_nodes, f[0]), 1, 100);
      near(energy[0], energy[1], 1e-13 * energy[1]);
      for (PetscInt node = 0; node < mesh.n_nodes; node++)
        for (PetscInt d = 0; d < mesh.dim; d++) {
          const PetscInt i = mesh.dim * node + d;

          if (mesh.inner[node]) near(f[0][i], 0, 1e-12 * largest_of(mesh.dim * mesh.n_nodes, f[0]));
          /* the forces of a boundary node are those of constant stress on any of its shapes but for the faces of distorted hexahedra, which
             full elements integrate exactly too */
          near(f[0][i], f[1][i], 1e-12 * largest_of(mesh.dim * mesh.n_nodes, f[1]));
        }
      for (PetscInt k = 0; k < 6 * mesh.count; k++) near(stress[0][k], stress[1][k], 2e-12 * largest_of(6 * mesh.count, stress[1]));
    }
}

/* Errors of the central difference as of the full element */
static void force_is_the_derivative_of_the_energy(void **state)
{
  PetscReal u[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, kinds[s].shape, one, 0.15);
      solid_create(&solid, &mesh, materials[m], kinds[s].options);
      set_scattered(&mesh, 0.05, u);
      check_force(&solid, &mesh, u, 1e-8 * LAME);
      solid_destroy(&solid);
    }
}

static void tangent_is_symmetric_and_the_derivative_of_the_force(void **state)
{
  PetscReal u[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, kinds[s].shape, one, 0.15);
      solid_create(&solid, &mesh, materials[m], kinds[s].options);
      set_scattered(&mesh, 0.05, u);
      check_tangent(&solid, &mesh, u, 1e-8 * LAME);
      solid_destroy(&solid);
    }
}

/* Nonlinear terms are 1e-12 of linear ones; the linear element knows no rounding of F */
static void small_strains_keep_their_digits(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], linear[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_box(&mesh, kinds[s].shape, three, 0.15);
    set_scattered(&mesh, 1e-13, u);
    for (PetscInt m = 0; m < MATERIALS; m++) {
      solid_create(&solid, &mesh, materials[m], kinds[s].options);
      get_force(&solid, &mesh, u, m ? f : linear);
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes && m; i++)
        near(f[i], linear[i], 2e-12 * largest_of(mesh.dim * mesh.n_nodes, linear));
      solid_destroy(&solid);
    }
  }
}

/* Volumes of neighbouring points that differ by a factor of 3: beyond the series of the cube root. The difference of energies has an error
   of 1e-10 / 6 times a third derivative of some 100 moduli. */
static void large_changes_of_volume_are_exact_too(void **state)
{
  PetscReal u[MAX_DOFS] = {0}, f[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < 2; s++) {
    mesh_box(&mesh, kinds[s].shape, one, 0);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, kinds[s].options);
    for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) u[i] = 0;
    u[mesh.dim * (mesh.n_nodes - 1)]     = 1.2;
    u[mesh.dim * (mesh.n_nodes - 1) + 1] = 1.2;
    check_force(&solid, &mesh, u, 1e-7 * LAME);
    /* turned over at one point */
    u[0] = 3;
    get_force(&solid, &mesh, u, f);
    assert_int_equal(solid.element->inverted, 0);
    solid_destroy(&solid);
  }
}

/* Elements that work in batches: the same as one after the other */
static void batches_may_be_of_any_size(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], expected[MAX_DOFS], stress[6 * MAX_CELLS + 6], expected_stress[6], energy;
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    if (s >= 2 && s <= 4) continue;
    mesh_box(&mesh, kinds[s].shape, kinds[s].shape == DM_POLYTOPE_HEXAHEDRON ? three : (PetscInt[3]){5, 4, 0}, 0.15);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    for (PetscInt count = 1; count <= 17; count++) {
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) expected[i] = 0;
      for (PetscInt k = 0; k < 6; k++) stress[6 * count + k] = -7;
      solid.element->count = count;
      ok((*solid.element->ops->stress)(solid.element, u, stress));
      get_force(&solid, &mesh, u, f);
      energy               = get_energy(&solid, u);
      solid.element->count = 1;
      for (PetscInt e = 0; e < count; e++) {
        solid.element->connectivity = mesh.connectivity + e * mesh.nodes;
        ok((*solid.element->ops->internalforce)(solid.element, u, expected));
        ok((*solid.element->ops->stress)(solid.element, u, expected_stress));
        for (PetscInt k = 0; k < 6; k++) assert_true(stress[6 * e + k] == expected_stress[k]);
        energy -= get_energy(&solid, u);
      }
      solid.element->connectivity = mesh.connectivity;
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) assert_true(f[i] == expected[i]);
      near(energy, 0, 1e-13 * LAME);
      for (PetscInt k = 0; k < 6; k++) assert_true(stress[6 * count + k] == -7);
    }
    solid.element->count = 0;
    get_force(&solid, &mesh, u, f);
    assert_true(largest_of(mesh.dim * mesh.n_nodes, f) == 0 && get_energy(&solid, u) == 0);
    solid_destroy(&solid);
  }
}

/* Dashpots: the force is the matrix times the velocity, to round-off; it takes energy, but none of a body that spins, which has moved by
   any rotation */
static void viscosity_is_objective_and_takes_energy(void **state)
{
  const PetscReal spin[3][3] = {{0, -0.3, 0}, {0.3, 0, 0}, {0, 0, 0}};
  PetscReal       u[MAX_DOFS], v[MAX_DOFS], f[MAX_DOFS], C[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    PetscReal power = 0;
    PetscInt  n;

    mesh_box(&mesh, kinds[s].shape, one, 0.15);
    n = mesh.dim * mesh.nodes;
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    for (PetscInt i = 0; i < n; i++) v[i] = scatter(77 + i), f[i] = 0;
    ok((*solid.element->ops->viscousforce)(solid.element, u, v, f));
    ok((*solid.element->ops->viscosity)(solid.element, 0, u, C));
    for (PetscInt a = 0; a < n; a++) {
      const PetscInt at  = mesh.dim * mesh.connectivity[a / mesh.dim] + a % mesh.dim;
      PetscReal      sum = 0;

      for (PetscInt b = 0; b < n; b++) {
        sum += C[a * n + b] * v[mesh.dim * mesh.connectivity[b / mesh.dim] + b % mesh.dim];
        near(C[a * n + b], C[b * n + a], 1e-13 * largest_of(n * n, C));
      }
      near(sum, f[at], 1e-12 * LAME);
      power += f[at] * v[at];
    }
    assert_true(power > 1);
    /* v = spin x with x = X + u */
    set_linear(&mesh, turn, u);
    for (PetscInt node = 0; node < mesh.n_nodes; node++)
      for (PetscInt i = 0; i < mesh.dim; i++) {
        v[mesh.dim * node + i] = f[mesh.dim * node + i] = 0;
        for (PetscInt j = 0; j < mesh.dim; j++)
          v[mesh.dim * node + i] += spin[i][j] * (mesh.x[mesh.dim * node + j] + u[mesh.dim * node + j]);
      }
    ok((*solid.element->ops->viscousforce)(solid.element, u, v, f));
    between(largest_of(n, f), 0, 1e-12 * LAME);
    solid_destroy(&solid);
  }
}

/* A beam of elements of 1 m, one of them through its height, that is bent to a curvature without shear: u_x = c x y, u_y = -c x^2 / 2. In
   plane stress E I c^2 / 2 per length with I = 1/12 m^4; the full element stores 1 + (1 - nu) / 2 times as much and more. Hexahedra bend
   about one axis with sides that are free to move by nu: with modes along y and z that is the beam's energy too. */
static void enhanced_elements_bend_as_beams(void **state)
{
  const PetscReal c = 1e-6;
  PetscReal       u[MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  mesh_box(&mesh, DM_POLYTOPE_QUADRILATERAL, one, 0);
  for (PetscInt node = 0; node < mesh.n_nodes; node++) {
    const PetscReal x = mesh.x[2 * node] - 0.5, y = mesh.x[2 * node + 1] - 0.5;

    u[2 * node]     = c * x * y;
    u[2 * node + 1] = -c * x * x / 2;
  }
  solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "-element_formulation enhanced -plane_stress");
  near(get_energy(&solid, u) / (0.5 * 200 / 12 * c * c), 1, 1e-10);
  solid_destroy(&solid);
  solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "-plane_stress");
  between(get_energy(&solid, u) / (0.5 * 200 / 12 * c * c), 1.4, 1.6);
  solid_destroy(&solid);
}

/* Of a displacement that changes the volume of points but not of the element, mean_dilatation stores no energy of lambda: for the constants
   of nu = 0.4999 it is what the shear modulus makes of it */
static void volume_does_not_lock(void **state)
{
  PetscReal u[MAX_DOFS], of_ratio[2];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < 2; s++) {
    mesh_box(&mesh, kinds[s].shape, one, 0);
    for (PetscInt node = 0; node < mesh.n_nodes; node++)
      for (PetscInt d = 0; d < mesh.dim; d++)
        u[mesh.dim * node + d] = d ? 0 : 1e-6 * (mesh.x[mesh.dim * node] - 0.5) * (mesh.x[mesh.dim * node + 1] - 0.5);
    for (PetscInt k = 0; k < 2; k++) {
      char more[128];

      ok(PetscSNPrintf(more, sizeof(more), "%s -poissons_ratio %s", kinds[s].options, k ? "0.4999" : "0"));
      solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, more);
      of_ratio[k] = get_energy(&solid, u);
      solid_destroy(&solid);
    }
    /* the shear modulus falls by 1.4999; at nu = 0 lambda is zero, but its bulk modulus is not */
    between(of_ratio[1] / of_ratio[0], 0.5, 1);
  }
}

static void defaults_and_errors(void **state)
{
  const struct {
    DMPolytopeType shape;
    const char    *options, *expected;
  } cases[] = {
      {DM_POLYTOPE_HEXAHEDRON, "-poissons_ratio 0.4", ELEMENT_FULL},
      {DM_POLYTOPE_HEXAHEDRON, "-poissons_ratio 0.41", ELEMENT_MEAN_DILATATION},
      {DM_POLYTOPE_QUADRILATERAL, "-poissons_ratio 0.49", ELEMENT_MEAN_DILATATION},
      {DM_POLYTOPE_QUADRILATERAL, "-poissons_ratio 0.49 -plane_stress", ELEMENT_FULL},
      {DM_POLYTOPE_QUADRILATERAL, "-poissons_ratio 0.49 -element_formulation full", ELEMENT_FULL},
      {DM_POLYTOPE_TETRAHEDRON, "-poissons_ratio 0.49", ELEMENT_FULL},
  };
  Mesh        mesh;
  Solid       solid;
  const char *formulation;

  (void)state;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    Element duplicate;

    mesh_box(&mesh, cases[i].shape, one, 0);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, cases[i].options);
    ok(ElementGetFormulation(solid.element, &formulation));
    assert_string_equal(formulation, cases[i].expected);
    ok(ElementDuplicate(solid.element, NULL, &duplicate));
    ok(ElementGetFormulation(duplicate, &formulation));
    assert_string_equal(formulation, cases[i].expected);
    ok(ElementDestroy(&duplicate));
    solid_destroy(&solid);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_motion_meets_no_resistance),
      cmocka_unit_test(linear_displacement_is_as_of_the_full_element),
      cmocka_unit_test(force_is_the_derivative_of_the_energy),
      cmocka_unit_test(tangent_is_symmetric_and_the_derivative_of_the_force),
      cmocka_unit_test(small_strains_keep_their_digits),
      cmocka_unit_test(large_changes_of_volume_are_exact_too),
      cmocka_unit_test(batches_may_be_of_any_size),
      cmocka_unit_test(viscosity_is_objective_and_takes_energy),
      cmocka_unit_test(enhanced_elements_bend_as_beams),
      cmocka_unit_test(volume_does_not_lock),
      cmocka_unit_test(defaults_and_errors),
  };

  return impakt_main(argc, argv, tests);
}
