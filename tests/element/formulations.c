/* mean_dilatation and enhanced: rigid motions, patch tests, energy against force against tangent, viscosity, what keeps from locking. */
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

/* Rotation by 1 rad about the z axis, less the identity */
static const PetscReal turn[3][3] = {
    {-0.45969769413186023, -0.8414709848078965, 0}, {0.8414709848078965, -0.45969769413186023, 0}, {0, 0, 0}};

/* Errors of the central difference as of the full elements, in solid_elements.c */
static void force_and_tangent_are_derivatives(void **state)
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
      check_tangent(&solid, &mesh, u, 1e-8 * LAME);
      solid_destroy(&solid);
    }
}

static void small_strains_keep_their_digits(void **state)
{
  Mesh mesh;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_box(&mesh, kinds[s].shape, three, 0.15);
    check_small_strains(&mesh, kinds[s].options);
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

static void batches_may_be_of_any_size(void **state)
{
  PetscReal u[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    if (s >= 2 && s <= 4) continue; /* one element at a time */
    mesh_box(&mesh, kinds[s].shape, kinds[s].shape == DM_POLYTOPE_HEXAHEDRON ? three : (PetscInt[3]){5, 4, 0}, 0.15);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    check_batches(&solid, &mesh, u, 1e-13 * LAME);
    solid_destroy(&solid);
  }
}

/* Dashpots take nothing of a body that spins, which has moved by any rotation: v = spin x with x = X + u */
static void viscosity_is_objective_and_takes_energy(void **state)
{
  const PetscReal spin[3][3] = {{0, -0.3, 0}, {0.3, 0, 0}, {0, 0, 0}};
  PetscReal       u[MAX_DOFS], v[MAX_DOFS], f[MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_box(&mesh, kinds[s].shape, one, 0.15);
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    check_viscosity(&solid, &mesh, u, 1e-12 * LAME);
    set_linear(&mesh, turn, u);
    for (PetscInt node = 0; node < mesh.n_nodes; node++)
      for (PetscInt i = 0; i < mesh.dim; i++) {
        v[mesh.dim * node + i] = f[mesh.dim * node + i] = 0;
        for (PetscInt j = 0; j < mesh.dim; j++)
          v[mesh.dim * node + i] += spin[i][j] * (mesh.x[mesh.dim * node + j] + u[mesh.dim * node + j]);
      }
    ok((*solid.element->ops->viscousforce)(solid.element, u, v, f));
    between(largest_of(mesh.dim * mesh.n_nodes, f), 0, 1e-12 * LAME);
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
    ok(ElementDuplicateOn(solid.element, PETSC_COMM_SELF, solid.element->material, &duplicate));
    ok(ElementGetFormulation(duplicate, &formulation));
    assert_string_equal(formulation, cases[i].expected);
    ok(ElementDestroy(&duplicate));
    solid_destroy(&solid);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(force_and_tangent_are_derivatives),
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
