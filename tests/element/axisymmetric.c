/* Rings: energy against force against tangent, uniform strains, masses and load points, viscosity, batches, what is refused. */
#include "solid_mesh.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 3

typedef struct {
  DMPolytopeType shape;
  const char    *options;
} Kind;

static const Kind kinds[] = {
    {DM_POLYTOPE_TRIANGLE, "-axisymmetric -element_formulation full"},
    {DM_POLYTOPE_QUADRILATERAL, "-axisymmetric -element_formulation full"},
    {DM_POLYTOPE_QUADRILATERAL, "-axisymmetric -element_formulation mean_dilatation"},
};

#define KINDS 3

static const PetscInt one[3] = {1, 1, 0}, three[3] = {3, 3, 0};

/* Elements of 1 m, `inside` from the axis; where that is 0, the nodes of the axis are put on it */
static void mesh_rings(Mesh *mesh, const Kind *kind, const PetscInt n[3], PetscReal distortion, PetscReal inside)
{
  mesh_box(mesh, kind->shape, n, distortion);
  for (PetscInt node = 0; node < mesh->n_nodes; node++) {
    if (inside == 0 && node % (n[0] + 1) == 0) mesh->x[2 * node] = 0;
    mesh->x[2 * node] += inside;
  }
}

/* Also that the tangent is the derivative of the force, of the first element alone */
static void force_and_tangent_are_derivatives_of_the_energy(void **state)
{
  PetscReal u[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_rings(&mesh, &kinds[s], one, 0.15, 0.7);
      mesh.count = 1;
      solid_create(&solid, &mesh, materials[m], kinds[s].options);
      set_scattered(&mesh, 0.05, u);
      check_force(&solid, &mesh, u, 1e-7 * LAME); /* 1e-8 for each metre around */
      check_tangent(&solid, &mesh, u, 1e-7 * LAME);
      solid_destroy(&solid);
    }
}

static PetscReal get_volume(const Solid *solid)
{
  PetscReal positions[8], weights[4], volume = 0;

  for (PetscInt e = 0; e < solid->element->count; e++) {
    ok((*solid->element->ops->points)(solid->element, e, positions, weights));
    for (PetscInt g = 0; g < solid->element->n_points; g++) volume += weights[g];
  }
  return volume;
}

/* A ring of 1 m x 1 m, from 0.7 m to 1.7 m: pi (1.7^2 - 0.7^2) m^3 of 3 kg/m^3; the mass of a node is half the height times the integral of
   2 pi r and its shape function, pi / 3 (2 r_a + r_b) */
static void mass_is_that_of_the_ring(void **state)
{
  const PetscReal inner = 0.7, outer = 1.7, of_inner = 1.5 * PETSC_PI / 3 * (2 * inner + outer),
                  of_outer = 1.5 * PETSC_PI / 3 * (inner + 2 * outer);
  PetscReal       M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_rings(&mesh, &kinds[s], one, 0, inner);
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, kinds[s].options);
    near(get_volume(&solid), PETSC_PI * (outer * outer - inner * inner), 1e-14);
    ok((*solid.element->ops->mass)(solid.element, 0, M));
    for (PetscInt a = 0; a < 4 && s; a++) {
      PetscReal sum = 0;

      for (PetscInt b = 0; b < 4; b++) sum += M[4 * a + b];
      near(sum, mesh.x[2 * mesh.connectivity[a]] < 1 ? of_inner : of_outer, 1e-14 * of_outer);
    }
    solid_destroy(&solid);
  }
}

static void small_strains_keep_their_digits(void **state)
{
  Mesh mesh;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_rings(&mesh, &kinds[s], three, 0.15, 0.7);
    check_small_strains(&mesh, kinds[s].options);
  }
}

/* Also that a ring that has gone through the axis is named */
static void batches_may_be_of_any_size(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_rings(&mesh, &kinds[s], (PetscInt[3]){5, 4, 0}, 0.15, 0.7);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    check_batches(&solid, &mesh, u, 1e-11 * LAME);
    solid.element->count = 9;
    for (PetscInt node = 0; node < mesh.n_nodes; node++) u[2 * node] = -2 * mesh.x[2 * node];
    get_force(&solid, &mesh, u, f);
    assert_int_equal(solid.element->inverted, 0);
    solid_destroy(&solid);
  }
}

/* None of a body that flies along its axis */
static void viscosity_takes_energy(void **state)
{
  PetscReal u[MAX_DOFS], v[MAX_DOFS], f[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < KINDS; s++) {
    mesh_rings(&mesh, &kinds[s], one, 0.15, 0.7);
    mesh.count = 1;
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, kinds[s].options);
    set_scattered(&mesh, 0.05, u);
    check_viscosity(&solid, &mesh, u, 1e-11 * LAME);
    for (PetscInt i = 0; i < 2 * mesh.n_nodes; i++) v[i] = i % 2, f[i] = 0;
    ok((*solid.element->ops->viscousforce)(solid.element, u, v, f));
    between(largest_of(2 * mesh.n_nodes, f), 0, 1e-11 * LAME);
    solid_destroy(&solid);
  }
}

static void refuse(DMPolytopeType shape, const char formulation[], const char words[])
{
  Mesh  mesh;
  Solid solid;

  mesh_box(&mesh, shape, (PetscInt[3]){1, 1, 1}, 0);
  solid_begin(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
  ok(ElementSetAxisymmetric(solid.element, PETSC_TRUE));
  if (formulation) ok(ElementSetFormulation(solid.element, formulation));
  refused(PETSC_ERR_USER_INPUT, words, ElementSetUp(solid.element, mesh.count, mesh.connectivity, mesh.x));
  solid_destroy(&solid);
}

static void nonsense_is_refused(void **state)
{
  Mesh      mesh;
  Solid     solid;
  PetscBool axisymmetric;

  (void)state;
  refuse(DM_POLYTOPE_HEXAHEDRON, NULL, "rings are made of plane meshes");
  refuse(DM_POLYTOPE_QUADRILATERAL, ELEMENT_REDUCED,
         "axisymmetric elements of shape 'quadrilateral' do not have it; they have full, mean_dilatation");
  refuse(DM_POLYTOPE_QUADRILATERAL, ELEMENT_ENHANCED, "axisymmetric elements of shape 'quadrilateral' do not have it");
  refuse(DM_POLYTOPE_TRIANGLE, ELEMENT_MEAN_DILATATION, "axisymmetric elements of shape 'triangle' do not have it; they have full");
  mesh_box(&mesh, DM_POLYTOPE_QUADRILATERAL, one, 0);
  solid_begin(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
  ok(ElementSetAxisymmetric(solid.element, PETSC_TRUE));
  ok(ElementGetAxisymmetric(solid.element, &axisymmetric));
  assert_true(axisymmetric);
  ok(ElementSetPlaneStress(solid.element, PETSC_TRUE));
  refused(PETSC_ERR_USER_INPUT, "rings have a stress along them", ElementSetUp(solid.element, mesh.count, mesh.connectivity, mesh.x));
  ok(ElementSetPlaneStress(solid.element, PETSC_FALSE));
  ok(ElementSetThickness(solid.element, 0.5));
  refused(PETSC_ERR_USER_INPUT, "rings have no thickness", ElementSetUp(solid.element, mesh.count, mesh.connectivity, mesh.x));
  solid_destroy(&solid);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(force_and_tangent_are_derivatives_of_the_energy),
      cmocka_unit_test(mass_is_that_of_the_ring),
      cmocka_unit_test(small_strains_keep_their_digits),
      cmocka_unit_test(batches_may_be_of_any_size),
      cmocka_unit_test(viscosity_takes_energy),
      cmocka_unit_test(nonsense_is_refused),
  };

  return impakt_main(argc, argv, tests);
}
