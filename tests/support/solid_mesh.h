/* Small meshes of one shape, elements on them, and displacements for tests of solid elements. */
#pragma once
#include "support.h"
#include <impakt/private/elementimpl.h>

#define MAX_NODES 64
#define MAX_CELLS 162
#define MAX_DOFS  (3 * MAX_NODES)

typedef struct {
  DMPolytopeType shape;
  PetscInt       dim, nodes, count, n_nodes; /* nodes: of one element */
  PetscReal      x[MAX_DOFS];
  PetscBool      inner[MAX_NODES];
  PetscInt       connectivity[8 * MAX_CELLS];
} Mesh;

static const DMPolytopeType shapes[] = {DM_POLYTOPE_TRIANGLE, DM_POLYTOPE_QUADRILATERAL, DM_POLYTOPE_TETRAHEDRON, DM_POLYTOPE_HEXAHEDRON};
#define SHAPES 4

/* A sequence without pattern, between -1 and 1 */
static inline PetscReal scatter(PetscInt k)
{
  return PetscSinReal(12.9 * k * k + 4.1 * k + 1);
}

static inline void add_cell(Mesh *mesh, const PetscInt corners[], const PetscInt which[])
{
  for (PetscInt a = 0; a < mesh->nodes; a++) mesh->connectivity[mesh->count * mesh->nodes + a] = corners[which[a]];
  mesh->count++;
}

/* A box of n0 x n1 (x n2) quads or hexahedra of edge 1 m, each cut into 2 triangles or 6 tetrahedra where asked; all nodes moved by up to
   `distortion` along each axis */
static inline void mesh_box(Mesh *mesh, DMPolytopeType shape, const PetscInt n[3], PetscReal distortion)
{
  static const PetscInt whole[]     = {0, 1, 2, 3, 4, 5, 6, 7};
  static const PetscInt halves[][3] = {{0, 1, 2}, {0, 2, 3}};
  /* about the diagonal from 0 to 6 */
  static const PetscInt sixths[][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  const PetscInt        dim = DMPolytopeTypeGetDim(shape), layers = dim == 3 ? n[2] : 1, m0 = n[0] + 1, m1 = n[1] + 1,
                        m2 = dim == 3 ? n[2] + 1 : 1;

  memset(mesh, 0, sizeof(*mesh));
  mesh->shape   = shape;
  mesh->dim     = dim;
  mesh->nodes   = DMPolytopeTypeGetNumVertices(shape);
  mesh->n_nodes = m0 * m1 * m2;
  assert_true(mesh->n_nodes <= MAX_NODES);
  for (PetscInt node = 0; node < mesh->n_nodes; node++) {
    const PetscInt at[3] = {node % m0, node / m0 % m1, node / m0 / m1};

    mesh->inner[node] = PETSC_TRUE;
    for (PetscInt d = 0; d < dim; d++) {
      mesh->x[dim * node + d] = at[d] + distortion * scatter(dim * node + d);
      if (at[d] == 0 || at[d] == n[d]) mesh->inner[node] = PETSC_FALSE;
    }
  }
  for (PetscInt cell = 0; cell < n[0] * n[1] * layers; cell++) {
    const PetscInt i = cell % n[0], j = cell / n[0] % n[1], k = cell / n[0] / n[1], o = (k * m1 + j) * m0 + i, up = m0 * m1;
    const PetscInt corners[] = {o, o + 1, o + m0 + 1, o + m0, o + up, o + up + 1, o + up + m0 + 1, o + up + m0};

    if (shape == DM_POLYTOPE_TRIANGLE)
      for (PetscInt c = 0; c < 2; c++) add_cell(mesh, corners, halves[c]);
    else if (shape == DM_POLYTOPE_TETRAHEDRON)
      for (PetscInt c = 0; c < 6; c++) add_cell(mesh, corners, sixths[c]);
    else add_cell(mesh, corners, whole);
  }
  assert_true(mesh->count <= MAX_CELLS);
}

/* One element, of edges that are the columns of a matrix; its volume is its determinant, over dim! for simplices */
static inline void mesh_parallel(Mesh *mesh, DMPolytopeType shape, const PetscReal edges[3][3])
{
  const PetscInt one[3] = {1, 1, 1};
  PetscInt       dim;

  mesh_box(mesh, shape, one, 0);
  dim = mesh->dim;
  for (PetscInt node = 0; node < mesh->n_nodes; node++) {
    PetscReal at[3] = {0};

    for (PetscInt d = 0; d < dim; d++) at[d] = mesh->x[dim * node + d];
    for (PetscInt i = 0; i < dim; i++) {
      mesh->x[dim * node + i] = 0.3 + i;
      for (PetscInt d = 0; d < dim; d++) mesh->x[dim * node + i] += edges[i][d] * at[d];
    }
  }
  mesh->count = 1;
}

/* u = c + G X at all nodes */
static inline void set_linear(const Mesh *mesh, const PetscReal gradient[3][3], PetscReal u[])
{
  for (PetscInt node = 0; node < mesh->n_nodes; node++)
    for (PetscInt i = 0; i < mesh->dim; i++) {
      u[mesh->dim * node + i] = 0.01 * (1 + i);
      for (PetscInt j = 0; j < mesh->dim; j++) u[mesh->dim * node + i] += gradient[i][j] * mesh->x[mesh->dim * node + j];
    }
}

static inline void set_scattered(const Mesh *mesh, PetscReal size, PetscReal u[])
{
  for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) u[i] = size * scatter(1000 + i);
}

static inline PetscReal largest_of(PetscInt n, const PetscReal a[])
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, PetscAbsReal(a[i]));
  return largest;
}

typedef struct {
  Material     material;
  Element      element;
  PetscOptions options;
} Solid;

/* Young's modulus 200 Pa and Poisson's ratio 0.25, so lambda = mu = 80 Pa; density 3 kg/m^3 */
#define LAME 80.

/* Without set-up */
static inline void solid_begin(Solid *solid, const Mesh *mesh, const char material[], const char more[])
{
  solid->options = options_begin("-prefix_push b_ -density 3 -youngs_modulus 200 -poissons_ratio 0.25 -material_type %s %s -prefix_pop",
                                 material, more);
  ok(MaterialCreate(PETSC_COMM_SELF, &solid->material));
  ok(PetscObjectSetOptionsPrefix((PetscObject)solid->material, "b_"));
  ok(MaterialSetFromOptions(solid->material));
  ok(element_create("b_", mesh->shape, solid->material, &solid->element));
}

static inline void solid_create(Solid *solid, const Mesh *mesh, const char material[], const char more[])
{
  solid_begin(solid, mesh, material, more);
  ok(ElementSetUp(solid->element, mesh->count, mesh->connectivity, mesh->x));
  assert_int_equal(solid->element->dim, mesh->dim);
  assert_int_equal(solid->element->nodes, mesh->nodes);
}

static inline void solid_destroy(Solid *solid)
{
  ok(ElementDestroy(&solid->element));
  ok(MaterialDestroy(&solid->material));
  options_end(solid->options);
}

static inline void get_force(const Solid *solid, const Mesh *mesh, const PetscReal u[], PetscReal f[])
{
  for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) f[i] = 0;
  ok((*solid->element->ops->internalforce)(solid->element, u, f));
}

static inline PetscReal get_energy(const Solid *solid, const PetscReal u[])
{
  PetscReal energy = -1;

  ok((*solid->element->ops->energy)(solid->element, u, &energy));
  return energy;
}

/* Displacements to each side of those at which a derivative is wanted [m] */
#define DIFFERENCE 1e-5

/* The force is the derivative of the energy, by central differences; u comes back as it was */
static inline void check_force(const Solid *solid, const Mesh *mesh, PetscReal u[], PetscReal bound)
{
  PetscReal f[MAX_DOFS];

  get_force(solid, mesh, u, f);
  assert_int_equal(solid->element->inverted, -1);
  for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) {
    const PetscReal start = u[i];
    PetscReal       above, below;

    u[i]  = start + DIFFERENCE;
    above = get_energy(solid, u);
    u[i]  = start - DIFFERENCE;
    below = get_energy(solid, u);
    u[i]  = start;
    near((above - below) / (2 * DIFFERENCE), f[i], bound);
  }
}

/* The stiffness of the first element of the mesh, the only one at its nodes, is symmetric and the derivative of the force likewise */
static inline void check_tangent(const Solid *solid, const Mesh *mesh, PetscReal u[], PetscReal bound)
{
  const PetscInt n = mesh->dim * mesh->nodes;
  PetscReal      above[MAX_DOFS], below[MAX_DOFS], K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];

  ok((*solid->element->ops->tangent)(solid->element, 0, PETSC_FALSE, u, K));
  for (PetscInt b = 0; b < n; b++) {
    const PetscInt  dof   = mesh->dim * mesh->connectivity[b / mesh->dim] + b % mesh->dim;
    const PetscReal start = u[dof];

    u[dof] = start + DIFFERENCE;
    get_force(solid, mesh, u, above);
    u[dof] = start - DIFFERENCE;
    get_force(solid, mesh, u, below);
    u[dof] = start;
    for (PetscInt a = 0; a < n; a++) {
      const PetscInt at = mesh->dim * mesh->connectivity[a / mesh->dim] + a % mesh->dim;

      near((above[at] - below[at]) / (2 * DIFFERENCE), K[a * n + b], bound);
      near(K[a * n + b], K[b * n + a], 1e-14 * largest_of(n * n, K));
    }
  }
}

/* Every number of elements from 1 to 17, which fills no, one and two batches and leaves any rest: the same as one element after the other;
   none at all, as on a rank without elements */
static inline void check_batches(const Solid *solid, const Mesh *mesh, const PetscReal u[], PetscReal bound)
{
  PetscReal f[MAX_DOFS], expected[MAX_DOFS], stress[6 * MAX_CELLS + 6], expected_stress[6], energy;

  for (PetscInt count = 1; count <= 17; count++) {
    for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) expected[i] = 0;
    for (PetscInt k = 0; k < 6; k++) stress[6 * count + k] = -7;
    solid->element->count = count;
    ok((*solid->element->ops->stress)(solid->element, u, stress));
    get_force(solid, mesh, u, f);
    energy                = get_energy(solid, u);
    solid->element->count = 1;
    for (PetscInt e = 0; e < count; e++) {
      solid->element->connectivity = mesh->connectivity + e * mesh->nodes;
      ok((*solid->element->ops->internalforce)(solid->element, u, expected));
      ok((*solid->element->ops->stress)(solid->element, u, expected_stress));
      for (PetscInt k = 0; k < 6; k++) assert_true(stress[6 * e + k] == expected_stress[k]);
      energy -= get_energy(solid, u);
    }
    solid->element->connectivity = mesh->connectivity;
    for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) assert_true(f[i] == expected[i]);
    near(energy, 0, bound); /* other order of the sum */
    for (PetscInt k = 0; k < 6; k++) assert_true(stress[6 * count + k] == -7);
  }
  solid->element->count = 0;
  get_force(solid, mesh, u, f);
  assert_true(largest_of(mesh->dim * mesh->n_nodes, f) == 0 && get_energy(solid, u) == 0);
  assert_int_equal(solid->element->inverted, -1);
}

/* Displacements of 1e-12 times those of a linear body: nonlinear terms are 1e-12 of linear ones, and so is the error, but for round-off.
   With F in place of H, of strains of 1e-13 no more than three digits would be left. */
static inline void check_small_strains(const Mesh *mesh, const char options[])
{
  static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_SAINT_VENANT_KIRCHHOFF, MATERIAL_NEO_HOOKEAN};
  PetscReal                u[MAX_DOFS], f[MAX_DOFS], linear[MAX_DOFS];

  set_scattered(mesh, 1e-13, u);
  for (PetscInt m = 0; m < 3; m++) {
    Solid solid;

    solid_create(&solid, mesh, materials[m], options);
    get_force(&solid, mesh, u, m ? f : linear);
    for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes && m; i++)
      near(f[i], linear[i], 2e-12 * largest_of(mesh->dim * mesh->n_nodes, linear));
    solid_destroy(&solid);
  }
}

/* Dashpots of the first element, the only one at its nodes: the force is the matrix times the velocity, to round-off, and takes energy */
static inline void check_viscosity(const Solid *solid, const Mesh *mesh, const PetscReal u[], PetscReal bound)
{
  const PetscInt n = mesh->dim * mesh->nodes;
  PetscReal      v[MAX_DOFS], f[MAX_DOFS], C[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], power = 0;

  for (PetscInt i = 0; i < mesh->dim * mesh->n_nodes; i++) {
    v[i] = scatter(77 + i);
    f[i] = 0;
  }
  ok((*solid->element->ops->viscousforce)(solid->element, u, v, f));
  ok((*solid->element->ops->tangent)(solid->element, 0, PETSC_TRUE, u, C));
  for (PetscInt a = 0; a < n; a++) {
    const PetscInt at  = mesh->dim * mesh->connectivity[a / mesh->dim] + a % mesh->dim;
    PetscReal      sum = 0;

    for (PetscInt b = 0; b < n; b++) {
      sum += C[a * n + b] * v[mesh->dim * mesh->connectivity[b / mesh->dim] + b % mesh->dim];
      near(C[a * n + b], C[b * n + a], 1e-13 * largest_of(n * n, C));
    }
    near(sum, f[at], bound);
    power += f[at] * v[at];
  }
  assert_true(power > 1);
}
