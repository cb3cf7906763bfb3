/* Bars of nonlinear materials: energy, force, tangent, stress, inverted ones; load points. */
/* ranks: 1 */
#include "solid_mesh.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};

/* Three bars between nodes at 0, 2, 3 and 2.5 m, one against the axis, of 0.5 m^2 */
static void create_bars(Mesh *mesh, Solid *solid, const char material[])
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

    create_bars(&mesh, &solid, materials[m]);
    get_force(&solid, &mesh, u, f);
    assert_int_equal(solid.element->inverted, -1);
    for (PetscInt e = 0; e < 3; e++) {
      PetscReal k[4];

      ok((*solid.element->ops->stiffness)(solid.element, e, u, k));
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
    create_bars(&mesh, &solid, materials[m]);
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
    create_bars(&mesh, &solid, materials[m]);
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

/* Two Gauss points are exact for cubic functions: the integral of x^3 A over a bar is A (b^4 - a^4) / 4 */
static void load_points_integrate_cubic_functions(void **state)
{
  Mesh      mesh;
  Solid     solid;
  PetscReal positions[2], weights[2];

  (void)state;
  create_bars(&mesh, &solid, MATERIAL_LINEAR_ELASTIC);
  assert_int_equal(solid.element->n_points, 2);
  for (PetscInt e = 0; e < 3; e++) {
    const PetscReal a = mesh.x[mesh.connectivity[2 * e]], b = mesh.x[mesh.connectivity[2 * e + 1]];
    PetscReal       sum = 0;

    ok((*solid.element->ops->points)(solid.element, e, positions, weights));
    for (PetscInt g = 0; g < 2; g++) {
      sum += weights[g] * positions[g] * positions[g] * positions[g];
      near(positions[g], solid.element->shape[2 * g] * a + solid.element->shape[2 * g + 1] * b, 1e-15 * 3);
      near(solid.element->shape[2 * g] + solid.element->shape[2 * g + 1], 1, 1e-15);
    }
    near(sum, 0.5 * PetscAbsReal(b * b * b * b - a * a * a * a) / 4, 1e-14);
  }
  solid_destroy(&solid);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_force_and_tangent_agree),
      cmocka_unit_test(stress_is_force_over_the_present_cross_section),
      cmocka_unit_test(turned_over_bars_are_found),
      cmocka_unit_test(load_points_integrate_cubic_functions),
  };

  return impakt_main(argc, argv, tests);
}
