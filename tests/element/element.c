/* The two-node bar, and the stable step that elements give. */
#include "support.h"
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
  ok(MaterialSetOptionsPrefix(*material, "bar_"));
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
    ok((*element->ops->stiffness)(element, e, zero, K));
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

static void resists_no_rigid_motion(void **state)
{
  const PetscReal u[] = {7, 7, 7};
  PetscReal       f[] = {0, 0, 0};
  PetscOptions    options;
  Material        material;
  Element         element = create_bars(&material, &options);

  (void)state;
  ok((*element->ops->internalforce)(element, u, f));
  assert_true(f[0] == 0 && f[1] == 0 && f[2] == 0);
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

#define NODES 7

/* K or M of the whole body, dense, on every rank; nodes in the order of their positions */
static void get_dense(Body body, PetscBool mass, PetscReal matrix[])
{
  const PetscScalar *x;
  PetscScalar       *unit;
  PetscInt           n;
  Vec                e, product;
  Mat                K;

  ok(BodyGetStiffness(body, &K));
  ok(VecDuplicate(body->mesh.positions, &e));
  ok(VecDuplicate(body->mesh.positions, &product));
  ok(VecGetLocalSize(e, &n));
  for (PetscInt j = 0; j < NODES; j++) {
    ok(VecGetArrayRead(body->mesh.positions, &x));
    ok(VecGetArray(e, &unit));
    for (PetscInt i = 0; i < n; i++) unit[i] = PetscAbsReal(x[i] - j) < 1e-9;
    ok(VecRestoreArray(e, &unit));
    ok(VecRestoreArrayRead(body->mesh.positions, &x));
    if (mass) ok(BodyMultiplyMass(body, e, product));
    else ok(MatMult(K, e, product));
    for (PetscInt i = 0; i < NODES; i++) matrix[i * NODES + j] = value_at(body, product, i);
  }
  ok(VecDestroy(&e));
  ok(VecDestroy(&product));
}

/* The step 2 / sqrt(largest eigenvalue) of the nodes with mass, where the last node has none: it is held, or follows its
   neighbour (static condensation: the last element then pulls at nothing) */
static PetscReal compute_stable_step(const PetscReal K[], const PetscReal M[], PetscBool condensed)
{
  PetscReal    k[(NODES - 1) * (NODES - 1)], m[(NODES - 1) * (NODES - 1)], eigenvalues[NODES - 1], work[8 * NODES];
  PetscBLASInt one = 1, n = NODES - 1, lwork = 8 * NODES, info;

  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      k[i * n + j] = K[i * NODES + j];
      m[i * n + j] = M[i * NODES + j];
      if (condensed) k[i * n + j] -= K[i * NODES + n] * K[n * NODES + j] / K[n * NODES + n];
    }
  LAPACKsygv_(&one, "N", "L", &n, k, &n, m, &n, eigenvalues, work, &lwork, &info);
  assert_int_equal(info, 0);
  return 2 / PetscSqrtReal(eigenvalues[n - 1]);
}

/* The step from the elements is a bound from below of that of the body, with the massless node held or free, and no worse
   than it must be: within 20 % */
static void gives_a_stable_step_next_to_a_massless_node(void **state)
{
  const char *const types[] = {"lumped", "consistent", "averaged"};
  const PetscReal   end     = NODES - 1;

  (void)state;
  for (PetscInt type = 0; type < 3; type++) {
    Body         body;
    PetscOptions options = bar_create(&body, "-dm_plex_box_faces %d -dm_plex_box_upper %g -density 2 -youngs_modulus 8 -mass_type %s",
                                      NODES - 1, (double)end, types[type]);
    PetscReal    K[NODES * NODES], M[NODES * NODES], step, held, loose;
    Rows         rows;

    set_rows(body, 1, &end, &rows);
    ok(BodySetControllerStep(body, 0, 0.1));
    ok(BodySetUp(body));
    ok(BodyGetStableStep(body, &step));
    get_dense(body, PETSC_FALSE, K);
    get_dense(body, PETSC_TRUE, M);
    near(M[NODES * NODES - 1], 0, 0);
    held  = compute_stable_step(K, M, PETSC_FALSE);
    loose = compute_stable_step(K, M, PETSC_TRUE);
    between(step, 0.8 * held, held * (1 + 1e-14));
    between(step, 0.8 * loose, loose * (1 + 1e-14));
    bar_destroy(&body, options);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(has_stiffness_and_mass_found_by_hand),
      cmocka_unit_test(pulls_its_nodes_together),
      cmocka_unit_test(resists_no_rigid_motion),
      cmocka_unit_test(refuses_what_is_no_bar),
      cmocka_unit_test(gives_the_stable_step),
      cmocka_unit_test(gives_a_stable_step_next_to_a_massless_node),
  };

  return impakt_main(argc, argv, tests);
}
