/* The two-node bar, of linear and nonlinear materials, and the stable step that elements give. */
#include "solid_mesh.h"
#include <petscblaslapack.h>
#include <body/layout/bodyimpl.h>

/* Two elements on one rank: 0.5 m along the axis, and 0.25 m against it. E A = 3 Pa * 4 m^2 = 12 N */
static const PetscReal coordinates[]  = {1, 1.5, 1.75};
static const PetscInt  connectivity[] = {0, 1, 2, 1};

static Element create_bars(Material *material, PetscOptions *options)
{
  Element element;

  *options = options_begin("-bar_density 5 -bar_youngs_modulus 3 -bar_cross_section 4");
  ok(MaterialCreate(PETSC_COMM_SELF, material));
  ok(PetscObjectSetOptionsPrefix((PetscObject)*material, "bar_"));
  ok(MaterialSetFromOptions(*material));
  ok(element_create("bar_", DM_POLYTOPE_SEGMENT, *material, &element));
  ok(ElementSetUp(element, 2, connectivity, coordinates));
  return element;
}

static void destroy_bars(Element *element, Material *material, PetscOptions options)
{
  ok(ElementDestroy(element));
  ok(MaterialDestroy(material));
  options_end(options);
}

/* E A / h = 24 and 48 N/m; rho A h = 10 and 5 kg. All numbers are exact in binary but thirds and sixths. */
static void has_stiffness_and_mass_found_by_hand(void **state)
{
  const PetscReal stiffness[] = {24, 48}, mass[] = {10, 5};
  const PetscReal zero[3] = {0, 0, 0}; /* of all nodes */
  PetscReal       K[4], M[4];
  PetscOptions    options;
  Material        material;
  Element         element = create_bars(&material, &options);

  (void)state;
  assert_int_equal(element->dim, 1);
  assert_int_equal(element->nodes, 2);
  assert_int_equal(element->count, 2);
  for (PetscInt e = 0; e < 2; e++) {
    ok((*element->ops->tangent)(element, e, PETSC_FALSE, zero, K));
    ok((*element->ops->mass)(element, e, M));
    assert_true(K[0] == stiffness[e] && K[3] == stiffness[e] && K[1] == -stiffness[e] && K[2] == -stiffness[e]);
    near(M[0], mass[e] / 3, 1e-15);
    near(M[3], mass[e] / 3, 1e-15);
    near(M[1], mass[e] / 6, 1e-15);
    near(M[2], mass[e] / 6, 1e-15);
  }
  destroy_bars(&element, &material, options);
}

/* u = 0, 1/4, 1/8 m: strains 1/2 and (1/4 - 1/8) / -1/4 = -1/2, so forces of +6 and -6 N in the two bars. The first pulls its
   nodes together with 6 N, the second pushes its own apart with 6 N. */
static void pulls_its_nodes_together(void **state)
{
  const PetscReal u[] = {0, 0.25, 0.125};
  PetscReal       f[] = {100, 0, 0}; /* added to */
  PetscOptions    options;
  Material        material;
  Element         element = create_bars(&material, &options);

  (void)state;
  ok((*element->ops->internalforce)(element, u, f));
  /* internal force: what is needed to hold the nodes */
  assert_true(f[0] == 100 - 6);
  assert_true(f[1] == 6 + 6);
  assert_true(f[2] == -6);
  destroy_bars(&element, &material, options);
}

static void refuses_what_is_no_bar(void **state)
{
  const PetscReal same[] = {1, 1, 2};
  PetscOptions    options;
  Material        material;
  Element         element = create_bars(&material, &options), other;

  (void)state;
  refused(PETSC_ERR_SUP, "-bar_|pyramid|segment|triangle|quad|tetrahedron|hexahedron",
          element_create("bar_", DM_POLYTOPE_PYRAMID, material, &other));
  ok(ElementDestroy(&other));
  ok(element_create("bar_", DM_POLYTOPE_SEGMENT, material, &other));
  refused(PETSC_ERR_USER_INPUT, "x = 1|no length", ElementSetUp(other, 2, connectivity, same));
  ok(ElementDestroy(&other));
  destroy_bars(&element, &material, options);
}

/* Largest eigenvalue of an element of length h: 4 (c/h)^2 with lumped, 12 with consistent, 6 with averaged mass;
   the stable step is 2 / omega. c = 2 m/s, h = 0.25 m */
static void gives_the_stable_step(void **state)
{
  const char *const types[]    = {"lumped", "consistent", "averaged"};
  const PetscReal   multiple[] = {4, 12, 6};

  (void)state;
  for (PetscInt type = 0; type < 3; type++) {
    Body         body;
    PetscOptions options = bar_create(
        &body, "-dm_plex_box_faces 8 -dm_plex_box_upper 2 -density 3 -youngs_modulus 12 -cross_section 7 -mass_type %s", types[type]);
    PetscReal step;

    ok(BodySetControllerStep(body, 0, 0.1));
    ok(BodySetUp(body));
    ok(BodyGetStableStep(body, &step));
    near(step, 2 * 0.125 / PetscSqrtReal(multiple[type]), 1e-15); /* LAPACK on a 2 x 2 matrix */
    bar_destroy(&body, options);
  }
}

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};

/* Three bars between nodes at 0, 2, 3 and 2.5 m, one against the axis, of 0.5 m^2 */
static void nonlinear_create_bars(Mesh *mesh, Solid *solid, const char material[])
{
  static const PetscReal x[]    = {0, 2, 3, 2.5};
  static const PetscInt  ends[] = {0, 1, 1, 2, 2, 3};

  memset(mesh, 0, sizeof(*mesh));
  mesh->shape   = DM_POLYTOPE_SEGMENT;
  mesh->dim     = 1;
  mesh->nodes   = 2;
  mesh->count   = 3;
  mesh->n_nodes = 4;
  for (PetscInt i = 0; i < 4; i++) mesh->x[i] = x[i];
  for (PetscInt i = 0; i < 6; i++) mesh->connectivity[i] = ends[i];
  solid_create(solid, mesh, material, "-cross_section 0.5");
}

/* Central differences over +-1e-5 m at strains of 0.1: as for solids, see solid_elements.c */
static void energy_force_and_tangent_agree(void **state)
{
  const PetscReal h = 1e-5;
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt m = 0; m < 3; m++) {
    PetscReal u[] = {0, 0.2, 0.05, 0.2}, f[4], above[4], below[4], K[4][4] = {{0}};

    nonlinear_create_bars(&mesh, &solid, materials[m]);
    get_force(&solid, &mesh, u, f);
    assert_int_equal(solid.element->inverted, -1);
    for (PetscInt e = 0; e < 3; e++) {
      PetscReal k[4];

      ok((*solid.element->ops->tangent)(solid.element, e, PETSC_FALSE, u, k));
      for (PetscInt a = 0; a < 4; a++) K[mesh.connectivity[2 * e + a / 2]][mesh.connectivity[2 * e + a % 2]] += k[a];
    }
    for (PetscInt i = 0; i < 4; i++) {
      const PetscReal start = u[i];
      PetscReal       difference;

      u[i] = start + h;
      get_force(&solid, &mesh, u, above);
      difference = get_energy(&solid, u);
      u[i]       = start - h;
      get_force(&solid, &mesh, u, below);
      difference -= get_energy(&solid, u);
      u[i] = start;
      near(difference / (2 * h), f[i], 1e-8 * LAME);
      for (PetscInt j = 0; j < 4; j++) near((above[j] - below[j]) / (2 * h), K[j][i], 1e-7 * LAME); /* shorter than a solid's edge of 1 m */
    }
    solid_destroy(&solid);
  }
}

/* Strain 0.1 everywhere: stretch a = 1.1. Neo-Hookean with lambda = mu: J times the Cauchy stress is mu (b^2 - 1) + mu/2 (J^2 - 1) across,
   where the stretch is b; none, with J = a b^2, at a^2 b^4 + 2 b^2 - 3 = 0. Along the bar it is mu (a^2 - 1) + mu/2 (J^2 - 1) = mu (a^2 -
   b^2). Linear: E 0.1 = 20 Pa. */
static void stress_is_force_over_the_present_cross_section(void **state)
{
  const PetscReal a = 1.1, square = (PetscSqrtReal(1 + 3 * a * a) - 1) / (a * a), neo_hookean = LAME * (a * a - square) / (a * square);
  PetscReal       u[4], stress[18];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt m = 0; m < 3; m += 2) {
    nonlinear_create_bars(&mesh, &solid, materials[m]);
    for (PetscInt i = 0; i < 4; i++) u[i] = 0.1 * mesh.x[i];
    ok((*solid.element->ops->stress)(solid.element, u, stress));
    for (PetscInt e = 0; e < 3; e++)
      for (PetscInt k = 0; k < 6; k++) near(stress[6 * e + k], k ? 0 : (m ? neo_hookean : 20), 1e-13 * LAME);
    solid_destroy(&solid);
  }
}

static void turned_over_bars_are_found(void **state)
{
  const PetscReal over[] = {0, 2, 0.5, 0.5}; /* the second from 4 to 3.5 m, the third of no length */
  PetscReal       none[] = {0, 0, 0, NAN}, f[4];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt m = 0; m < 3; m++) {
    nonlinear_create_bars(&mesh, &solid, materials[m]);
    get_force(&solid, &mesh, over, f);
    assert_int_equal(solid.element->inverted, m ? 1 : -1);
    (void)get_energy(&solid, over);
    assert_int_equal(solid.element->inverted, m ? 1 : -1);
    get_force(&solid, &mesh, none, f);
    assert_int_equal(solid.element->inverted, 2);
    none[3] = 0;
    get_force(&solid, &mesh, none, f);
    assert_int_equal(solid.element->inverted, -1);
    none[3] = NAN;
    solid_destroy(&solid);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(has_stiffness_and_mass_found_by_hand),
      cmocka_unit_test(pulls_its_nodes_together),
      cmocka_unit_test(refuses_what_is_no_bar),
      cmocka_unit_test(gives_the_stable_step),
      cmocka_unit_test(energy_force_and_tangent_agree),
      cmocka_unit_test(stress_is_force_over_the_present_cross_section),
      cmocka_unit_test(turned_over_bars_are_found),
  };

  return impakt_main(argc, argv, tests);
}
