/* tri3, quad4, tet4, hex8: rigid motions, patch tests, energy against force against tangent, batches. */
/* ranks: 1 */
#include "solid_mesh.h"

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 3

static const PetscInt three[3] = {3, 3, 3};

/* Rotation by 1 rad about the z axis, then by 0.7 rad about the x axis, less the identity */
static void get_rotation(PetscInt dim, PetscReal gradient[3][3])
{
  const PetscReal c = PetscCosReal(1), s = PetscSinReal(1), C = dim == 3 ? PetscCosReal(0.7) : 1, S = dim == 3 ? PetscSinReal(0.7) : 0;
  const PetscReal R[3][3] = {{c, -s, 0}, {C * s, C * c, -S}, {S * s, S * c, C}};

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) gradient[i][j] = R[i][j] - (i == j);
}

/* Forces are sums of some ten stresses times areas of 1 m^2. Rounding of the positions u = G X, of some m, gives strains of some 1e-15 and
   stresses of some 1e-13 Pa: 1e-12 N is some 30 times what is measured. The energy of a finite
   rotation is a difference of terms of 80 J/m^3: as much. */
static void rigid_motion_meets_no_resistance(void **state)
{
  const PetscReal spin[3][3] = {{0, -0.3, 0.2}, {0.3, 0, 0.5}, {-0.2, -0.5, 0}};
  PetscReal       rotation[3][3], u[MAX_DOFS], f[MAX_DOFS];
  Mesh            mesh;
  Solid           solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, shapes[s], three, 0.15);
      solid_create(&solid, &mesh, materials[m], "");
      get_rotation(mesh.dim, rotation);
      set_linear(&mesh, m ? rotation : spin, u);
      get_force(&solid, &mesh, u, f);
      assert_int_equal(solid.element->inverted, -1);
      between(largest_of(mesh.dim * mesh.n_nodes, f), 0, 1e-12);
      near(get_energy(&solid, u), 0, 1e-12);
      solid_destroy(&solid);
    }
}

static const PetscReal stretch[3][3] = {{0.11, 0.05, -0.07}, {-0.02, -0.08, 0.03}, {0.04, 0.06, 0.09}};

/* Cauchy stress, xx yy zz xy yz xz, of a displacement gradient G with lambda = mu. Neo-Hookean: mu/J (F F^T - I) + lambda/(2 J) (J^2 - 1) I
   (Wriggers 2008, eq. (3.119)); Saint-Venant-Kirchhoff: F S F^T / J with S = lambda tr(E) I + 2 mu E. Plane: plane strain. */
static void get_cauchy(PetscInt dim, PetscInt material, const PetscReal G[3][3], PetscReal sigma[6])
{
  static const PetscInt row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
  PetscReal             F[3][3], E[3][3], S[3][3], J, trace = 0;

  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) F[i][j] = (i == j) + (i < dim && j < dim ? G[i][j] : 0);
  J = F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
      F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) {
      E[i][j] = -0.5 * (i == j);
      for (PetscInt k = 0; k < 3; k++) E[i][j] += 0.5 * F[k][i] * F[k][j];
      if (!material) E[i][j] = 0.5 * (F[i][j] + F[j][i]) - (i == j);
      trace += i == j ? E[i][j] : 0;
    }
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) S[i][j] = LAME * ((i == j) * trace + 2 * E[i][j]);
  for (PetscInt n = 0; n < 6; n++) {
    const PetscInt i = row[n], j = column[n];

    sigma[n] = material ? 0 : S[i][j];
    for (PetscInt k = 0; k < 3; k++) {
      if (material == 2) sigma[n] += LAME / J * F[i][k] * F[j][k];
      for (PetscInt l = 0; l < 3 && material == 1; l++) sigma[n] += F[i][k] * S[k][l] * F[j][l] / J;
    }
    if (material == 2) sigma[n] += (i == j) * LAME * (0.5 * (J - 1 / J) - 1 / J);
  }
}

/* Relative to 1e2 N and Pa; round-off of some operations on each of 8 points */
static void linear_displacement_is_exact_on_distorted_meshes(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], exact[6], stress[6 * MAX_CELLS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      mesh_box(&mesh, shapes[s], three, 0.15);
      solid_create(&solid, &mesh, materials[m], "");
      set_linear(&mesh, stretch, u);
      get_cauchy(mesh.dim, m, stretch, exact);
      ok((*solid.element->ops->stress)(solid.element, u, stress));
      for (PetscInt e = 0; e < mesh.count; e++)
        for (PetscInt k = 0; k < 6; k++) near(stress[6 * e + k], exact[k], 1e-12 * largest_of(6, exact));
      get_force(&solid, &mesh, u, f);
      between(largest_of(mesh.dim * mesh.n_nodes, f), 1, 100);
      for (PetscInt node = 0; node < mesh.n_nodes; node++)
        for (PetscInt d = 0; d < mesh.dim && mesh.inner[node]; d++)
          near(f[mesh.dim * node + d], 0, 1e-12 * largest_of(mesh.dim * mesh.n_nodes, f));
      solid_destroy(&solid);
    }
}

/* A central difference over +-1e-5 m at strains of some 0.1: error 1e-10 / 6 times a third derivative of some 10 moduli, and round-off of
   1e-16 / 1e-5 of the energy, which is of the size of the forces. */
static void force_is_the_derivative_of_the_energy(void **state)
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
    }
}

static void tangent_is_symmetric_and_the_derivative_of_the_force(void **state)
{
  const PetscInt one[3] = {1, 1, 1};
  PetscReal      u[MAX_DOFS], zero[MAX_DOFS] = {0}, f[MAX_DOFS], K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  Mesh           mesh;
  Solid          solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++)
    for (PetscInt m = 0; m < MATERIALS; m++) {
      PetscInt n;

      mesh_box(&mesh, shapes[s], one, 0.15);
      mesh.count = 1;
      n          = mesh.dim * mesh.nodes;
      solid_create(&solid, &mesh, materials[m], "");
      set_scattered(&mesh, 0.05, u);
      check_tangent(&solid, &mesh, u, 1e-8 * LAME);
      /* at rest, all materials are the linear one */
      ok((*solid.element->ops->stiffness)(solid.element, 0, zero, K));
      if (m == 0) {
        get_force(&solid, &mesh, u, f);
        for (PetscInt a = 0; a < n; a++) {
          PetscReal sum = 0;

          for (PetscInt b = 0; b < n; b++) sum += K[a * n + b] * u[mesh.dim * mesh.connectivity[b / mesh.dim] + b % mesh.dim];
          near(sum, f[mesh.dim * mesh.connectivity[a / mesh.dim] + a % mesh.dim], 1e-14 * largest_of(n * n, K));
        }
      }
      solid_destroy(&solid);
    }
}

/* Displacements of 1e-12 times those of a linear body: nonlinear terms are 1e-12 of linear ones, and so is the error, but for
   round-off. With F in place of H, of strains of 1e-13 no more than three digits would be left. */
static void small_strains_keep_their_digits(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], linear[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_box(&mesh, shapes[s], three, 0.15);
    set_scattered(&mesh, 1e-13, u);
    for (PetscInt m = 0; m < MATERIALS; m++) {
      solid_create(&solid, &mesh, materials[m], "");
      get_force(&solid, &mesh, u, m ? f : linear);
      for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes && m; i++)
        near(f[i], linear[i], 2e-12 * largest_of(mesh.dim * mesh.n_nodes, linear));
      solid_destroy(&solid);
    }
  }
}

/* Every number of elements from 1 to 17, which fills no, one and two batches and leaves any rest: the same as one element after the other
 */
static void batches_may_be_of_any_size(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], expected[MAX_DOFS], stress[6 * MAX_CELLS + 6], expected_stress[6], energy;
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_box(&mesh, shapes[s], three, 0.15);
    if (shapes[s] == DM_POLYTOPE_QUADRILATERAL) mesh_box(&mesh, shapes[s], (PetscInt[3]){5, 4, 0}, 0.15);
    solid_create(&solid, &mesh, MATERIAL_NEO_HOOKEAN, "");
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
      near(energy, 0, 1e-13 * LAME); /* other order of the sum */
      for (PetscInt k = 0; k < 6; k++) assert_true(stress[6 * count + k] == -7);
    }
    /* none at all, as on a rank without elements */
    solid.element->count = 0;
    get_force(&solid, &mesh, u, f);
    assert_true(largest_of(mesh.dim * mesh.n_nodes, f) == 0 && get_energy(&solid, u) == 0);
    assert_int_equal(solid.element->inverted, -1);
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

        ok((*solid.element->ops->stiffness)(solid.element, e, u, K));
        for (PetscInt a = 0; a < n; a++)
          for (PetscInt b = 0; b < n; b++)
            f[mesh.dim * nodes[a / mesh.dim] + a % mesh.dim] -= K[a * n + b] * u[mesh.dim * nodes[b / mesh.dim] + b % mesh.dim];
      }
      if (m == 0) between(largest_of(mesh.dim * mesh.n_nodes, f), 0, 1e-13 * largest);
      solid_destroy(&other);
      solid_destroy(&solid);
    }
}

static void forces_are_added(void **state)
{
  PetscReal u[MAX_DOFS], f[MAX_DOFS], once[MAX_DOFS];
  Mesh      mesh;
  Solid     solid;

  (void)state;
  for (PetscInt s = 0; s < SHAPES; s++) {
    mesh_box(&mesh, shapes[s], (PetscInt[3]){1, 1, 1}, 0.1);
    mesh.count = 1;
    solid_create(&solid, &mesh, MATERIAL_LINEAR_ELASTIC, "");
    set_linear(&mesh, stretch, u);
    get_force(&solid, &mesh, u, once);
    get_force(&solid, &mesh, u, f);
    ok((*solid.element->ops->internalforce)(solid.element, u, f));
    for (PetscInt i = 0; i < mesh.dim * mesh.n_nodes; i++) assert_true(f[i] == 2 * once[i]);
    solid_destroy(&solid);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_motion_meets_no_resistance),
      cmocka_unit_test(linear_displacement_is_exact_on_distorted_meshes),
      cmocka_unit_test(force_is_the_derivative_of_the_energy),
      cmocka_unit_test(tangent_is_symmetric_and_the_derivative_of_the_force),
      cmocka_unit_test(small_strains_keep_their_digits),
      cmocka_unit_test(batches_may_be_of_any_size),
      cmocka_unit_test(parallelepipeds_have_the_forces_of_other_elements),
      cmocka_unit_test(forces_are_added),
  };

  return impakt_main(argc, argv, tests);
}
