/* ranks: 1 3 */
/* The mass of bodies whose massless contact nodes move as inner nodes do (-mass_redistribute auto): E^T M E. */
#include "frequencies.h"
#include "solid_bodies.h"
#include <impakt/private/bodymass.h>

static const char *const types[] = {"lumped", "consistent", "averaged"};
static const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

#define TYPES    3
#define MATERIAL "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 "
/* The same mesh with its mass extrapolated, and where it is */
#define AUTO 0
#define KEPT 1

static PetscOptions create(Body *body, const char text[], PetscInt type, PetscBool is_explicit, PetscInt how)
{
  PetscOptions options = solid_body_create(body, "%s " MATERIAL "-mass_type %s -ts_type %s %s -mass_redistribute %s", text, types[type],
                                           is_explicit ? TSCENTRALDIFFERENCE : TSALPHA2, is_explicit ? "-ts_time_step auto" : "",
                                           how == AUTO ? "auto" : "false");

  ok(BodySetControllerStep(*body, 0, 0.01));
  return options;
}

static void touch_all_sides(Body body)
{
  for (PetscInt side = 0; side < 2 * body->mesh.dim; side++) touch_side(body, sides[side]);
}

/* A velocity whose component `component` is 1 or a coordinate: number `field` */
static void set_affine(Body body, PetscInt component, PetscInt field, Vec v)
{
  const PetscInt dim = body->mesh.dim;
  PetscScalar   *values;

  ok(VecGetArray(v, &values));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++) {
    values[i] = 0;
    if (i % dim == component) values[i] = field == 0 ? 1 : body->mesh.coordinates[i - component + field - 1];
  }
  ok(VecRestoreArray(v, &values));
}

/* v' M w for all pairs of affine fields */
static void get_products(Body body, PetscReal products[12 * 12])
{
  const PetscInt dim = body->mesh.dim, n = dim * (dim + 1);
  Vec            v, w, image;

  ok(BodyCreateVec(body, &v));
  ok(BodyCreateVec(body, &w));
  ok(BodyCreateVec(body, &image));
  for (PetscInt k = 0; k < n; k++) {
    set_affine(body, k / (dim + 1), k % (dim + 1), v);
    ok(BodyMultiplyMass(body, v, image));
    for (PetscInt l = 0; l < n; l++) {
      set_affine(body, l / (dim + 1), l % (dim + 1), w);
      ok(VecDot(w, image, &products[k * n + l]));
    }
  }
  ok(VecDestroy(&image));
  ok(VecDestroy(&w));
  ok(VecDestroy(&v));
}

/* No row or column of a contact node has an entry; a velocity of inner nodes without pattern has energy */
static void check_layer(Body body)
{
  PetscReal          energy, layer = 0;
  PetscScalar       *v;
  const PetscScalar *image;
  Vec                velocity, product;

  ok(BodyCreateVec(body, &velocity));
  ok(BodyCreateVec(body, &product));
  for (PetscInt inner = 0; inner < 2; inner++) {
    ok(VecGetArray(velocity, &v));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++)
      v[i] = body->layer.contains[i / body->mesh.dim] != inner ? scattered(&body->mesh.coordinates[i], 1, 0) : 0;
    ok(VecRestoreArray(velocity, &v));
    ok(BodyMultiplyMass(body, velocity, product));
    ok(VecGetArrayRead(product, &image));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++)
      if (!inner || body->layer.contains[i / body->mesh.dim]) layer = PetscMax(layer, PetscAbsReal(image[i]));
    ok(VecRestoreArrayRead(product, &image));
    ok(VecDot(velocity, product, &energy));
    if (inner) assert_true(energy > 0);
  }
  near(layer, 0, 0);
  ok(VecDestroy(&product));
  ok(VecDestroy(&velocity));
}

/* Boxes of three elements and more in each direction, whose whole boundary may touch: mass, centre, moments of inertia and all products of
   affine velocities are those of the full mass. Tolerance: sums of some hundred terms. */
static void keeps_all_moments(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt type = 0; type < TYPES; type++) {
      const PetscBool is_explicit = (PetscBool)((kind + type) % 2);
      const PetscInt  dim = kind_dim[kind], n = dim * (dim + 1);
      const char     *box = dim == 2 ? "-dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5"
                                     : "-dm_plex_box_faces 3,3,3 -dm_plex_box_upper 2,1.5,1";
      PetscReal       products[2][12 * 12], shift[3], inertia, step[2] = {0};
      char            text[512];

      (void)snprintf(text, sizeof(text), "%s %s", kind_options(kind), box);
      for (PetscInt how = AUTO; how <= KEPT; how++) {
        PetscBool    keeps;
        Body         body;
        PetscOptions options = create(&body, text, type, is_explicit, how);

        touch_all_sides(body);
        ok(BodyChooseMass(body, 0, NULL, &keeps));
        assert_true(how == KEPT ? body->mass.n_contact == 0 : body->mass.n_contact > 0);
        assert_true(!keeps);
        ok(BodySetUp(body));
        get_products(body, products[how]);
        if (how == AUTO) check_layer(body);
        assert_int_equal(body->mass.extrapolation != NULL, how == AUTO);
        ok(BodyGetMassRedistribution(body, NULL, NULL, shift, &inertia));
        for (PetscInt d = 0; d < dim; d++) near(shift[d], 0, 0);
        near(inertia, 0, 0);
        if (is_explicit) ok(BodyGetStableStep(body, &step[how]));
        bar_destroy(&body, options);
      }
      for (PetscInt k = 0; k < n * n; k++) near(products[AUTO][k], products[KEPT][k], 1e-12 * 9 * 4); /* 9 kg, (2 m)^2 */
      assert_true(step[AUTO] >= step[KEPT] * (1 - 1e-12));                                            /* round-off of equal eigenvalues */
    }
}

/* A bar of two elements of 6 kg each, lumped: nodes of 3, 6 and 3 kg, the last massless, a quarter of the mass. v_2 = 2 v_1 - v_0: 3 v_0^2
   + 6 v_1^2 + 3 (2 v_1 - v_0)^2 */
static void is_that_found_by_hand(void **state)
{
  const PetscReal expected[3][3] = {{6, -6, 0}, {-6, 18, 0}, {0, 0, 0}}, end = 2;
  Body            body;
  PetscOptions    options;
  PetscBool       keeps;
  Rows            rows;

  (void)state;
  options = bar_create(&body, "-dm_plex_box_faces 2 -dm_plex_box_upper 2 -density 3 -cross_section 2 -youngs_modulus 1 -mass_type lumped "
                              "-mass_redistribute auto");
  set_rows(body, 1, &end, &rows);
  ok(BodySetControllerStep(body, 0, 0.1));
  ok(BodyChooseMass(body, 0, NULL, &keeps));
  assert_true(!keeps);
  ok(BodySetUp(body));
  for (PetscInt j = 0; j < 3; j++) {
    PetscScalar       *unit;
    const PetscScalar *x;
    Vec                e, Me;

    ok(BodyCreateVec(body, &e));
    ok(BodyCreateVec(body, &Me));
    ok(VecGetArrayRead(body->mesh.positions, &x));
    ok(VecGetArray(e, &unit));
    for (PetscInt i = 0; i < body->mesh.owned_nodes; i++) unit[i] = PetscAbsReal(x[i] - j) < 1e-9;
    ok(VecRestoreArray(e, &unit));
    ok(VecRestoreArrayRead(body->mesh.positions, &x));
    ok(BodyMultiplyMass(body, e, Me));
    for (PetscInt i = 0; i < 3; i++) near(value_at(body, Me, i), expected[i][j], 1e-12);
    ok(VecDestroy(&Me));
    ok(VecDestroy(&e));
  }
  bar_destroy(&body, options);
}

/* Plates with both faces in contact: inner nodes of two elements lie in a plane, of one there are none. All contact nodes keep their mass,
   and the body is one without redistribution. Three elements span. */
static void keeps_mass_of_thin_bodies(void **state)
{
  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt layers = 1; layers <= 3; layers++) {
      const PetscInt dim = kind_dim[kind];
      PetscBool      keeps, redistributed;
      char           text[512];
      Body           body;
      PetscOptions   options;

      (void)snprintf(text, sizeof(text), "%s -dm_plex_box_faces 6,%s%d -dm_plex_box_upper 6,%s%d", kind_options(kind), dim == 3 ? "5," : "",
                     (int)layers, dim == 3 ? "5," : "", (int)layers);
      options = create(&body, text, 0, PETSC_FALSE, AUTO);
      touch_side(body, dim == 2 ? "ymin" : "zmin");
      touch_side(body, dim == 2 ? "ymax" : "zmax");
      ok(BodyChooseMass(body, 0, NULL, &keeps));
      assert_int_equal(body->mass.n_contact, dim == 2 ? 14 : 84);
      assert_int_equal(body->mass.n_keep, layers == 3 ? 0 : body->mass.n_contact);
      assert_int_equal(keeps, layers < 3);
      ok(BodySetUp(body));
      ok(BodyIsRedistributed(body, &redistributed));
      assert_int_equal(redistributed, layers == 3);
      bar_destroy(&body, options);
    }
}

/* M^{-1} M a = a on inner nodes that are not held, by factors of the block near the surface on one rank, of the whole matrix on several.
   One component of some nodes is held, so that components have different blocks; held dofs of the force are their acceleration. */
static void is_solved_with(void **state)
{
  PetscScalar       *values;
  const PetscScalar *expected, *found;
  PetscInt           held = 0;
  Vec                a, f, solution;
  PetscOptions       options;
  Body               body;

  (void)state;
  options = create(
      &body,
      "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 5,4,4 -boundary_displacement xmin,ymax -boundary_displacement_xmin 0,free,free "
      "-boundary_displacement_ymax free,0,free",
      0, PETSC_TRUE, AUTO);
  touch_side(body, "xmax");
  touch_side(body, "ymin");
  touch_side(body, "zmin");
  touch_side(body, "zmax");
  ok(BodySetUp(body));
  assert_non_null(body->mass.extrapolation);
  ok(BodyCreateVec(body, &a));
  ok(BodyCreateVec(body, &f));
  ok(BodyCreateVec(body, &solution));
  ok(VecGetArray(a, &values));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * 3; i++)
    values[i] = body->layer.contains[i / 3] ? 0 : scattered(&body->mesh.coordinates[i - i % 3], 3, i % 3);
  ok(VecRestoreArray(a, &values));
  ok(BodyZeroHeld(body, a));
  ok(BodyMultiplyMass(body, a, f));
  ok(BodyZeroHeld(body, f));
  ok(BodySolveMass(body, f, solution));
  assert_int_equal(body->mass.blocks != NULL, body->rows.size == 1);
  ok(VecGetArrayRead(a, &expected));
  ok(VecGetArrayRead(solution, &found));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * 3; i++) near(found[i], expected[i], 1e-12); /* round-off of numbers below 1 */
  ok(VecRestoreArrayRead(solution, &found));
  ok(VecRestoreArrayRead(a, &expected));
  for (PetscInt i = 0; i < body->held.n; i++) held += !body->layer.contains[body->held.dofs[i] / 3];
  assert_true(sum_over_ranks(held) > 0);
  ok(VecDestroy(&solution));
  ok(VecDestroy(&f));
  ok(VecDestroy(&a));
  bar_destroy(&body, options);
}

/* A factor near one on the masses that are left is chosen where it keeps centre and inertia: then the body is that with moved mass */
static void leaves_fine_bodies_to_factors(void **state)
{
  PetscReal least[2];

  (void)state;
  for (PetscInt how = 0; how < 2; how++) {
    Body         body;
    PetscOptions options = solid_body_create(&body, "%s -dm_plex_box_faces 24,24 " MATERIAL "-mass_redistribute %s", kind_options(0),
                                             how ? "true" : "auto");

    touch_all_sides(body);
    ok(BodySetControllerStep(body, 0, 0.01));
    ok(BodySetUp(body));
    assert_null(body->mass.extrapolation);
    ok(BodyGetMassRedistribution(body, &least[how], NULL, NULL, NULL));
    bar_destroy(&body, options);
  }
  assert_true(least[0] == least[1]);
  between(least[0], 0.9, 1); /* measured: 0.947 */
}

/* Bars and plates of three elements and more whose whole surface is massless: the first six frequencies against the full mass. What is
   asked for is 3 %. */
static void leaves_frequencies(void **state)
{
  const struct {
    const char *mesh;
    PetscReal   most; /* behind: measured */
  } cases[] = {
      {"-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 30,3 -dm_plex_box_upper 0.1,0.01", 0.025},          /* 0.0201 */
      {"-dm_plex_dim 2 -dm_plex_simplex 1 -dm_plex_box_faces 30,4 -dm_plex_box_upper 0.1,0.01", 0.02},           /* 0.0147 */
      {"-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 18,3,3 -dm_plex_box_upper 0.1,0.015,0.012", 0.028}, /* 0.0232 */
  };

  (void)state;
  skip_beyond_ranks(1);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscReal frequency[2][6 + MODES], worst = 0;
    PetscInt  rigid = 0;

    for (PetscInt how = AUTO; how <= KEPT; how++) {
      Body         body;
      PetscOptions options = solid_body_create(
          &body, "%s -density 2700 -youngs_modulus 7e10 -poissons_ratio 0.3 -mass_type lumped -mass_redistribute %s", cases[i].mesh,
          how == AUTO ? "auto" : "false");

      touch_all_sides(body);
      ok(BodySetControllerStep(body, 0, 1e-7));
      ok(BodySetUp(body));
      rigid = body->mesh.dim == 2 ? 3 : 6;
      get_frequencies(body, rigid + MODES, frequency[how]);
      bar_destroy(&body, options);
    }
    for (PetscInt k = rigid; k < rigid + MODES; k++) worst = PetscMax(worst, PetscAbsReal(frequency[AUTO][k] / frequency[KEPT][k] - 1));
    assert_true(worst < cases[i].most);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(keeps_all_moments),         cmocka_unit_test(is_that_found_by_hand),         cmocka_unit_test(is_solved_with),
      cmocka_unit_test(keeps_mass_of_thin_bodies), cmocka_unit_test(leaves_fine_bodies_to_factors), cmocka_unit_test(leaves_frequencies),
  };

  return impakt_main(argc, argv, tests);
}
