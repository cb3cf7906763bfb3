/* ranks: 1 2 */
/* The forces of dashpots, C v, of linear and nonlinear bodies of all shapes: as a product with the matrix C, against the stiffness at zero
   strain, and under rigid motions. */
#include "solid_bodies.h"

#define ALPHA  0.7
#define BETA   0.3
#define SHAPES (KINDS + 2) /* quadrilaterals in plane stress, and bars */

static const char *shape_options(PetscInt shape)
{
  static const char *const sizes[] = {"-dm_plex_box_faces 3,2 -dm_plex_box_upper 1.5,1",
                                      "-dm_plex_box_faces 2,2,1 -dm_plex_box_upper 1.5,1,0.5"};
  static char              text[256];

  if (shape == KINDS + 1) return "-dm_plex_dim 1 -dm_plex_box_faces 5 -dm_plex_box_upper 1.5";
  (void)snprintf(text, sizeof(text), "%s %s %s", kind_options(shape % KINDS), sizes[kind_dim[shape % KINDS] - 2],
                 shape == KINDS ? "-plane_stress" : "");
  return text;
}

static PetscOptions create(Body *body, PetscInt shape, const char more[])
{
  PetscOptions options = solid_body_create(body, "%s -density 3 -youngs_modulus 5 -poissons_ratio %g %s", shape_options(shape),
                                           shape == KINDS + 1 ? 0. : 0.3, more);

  ok(BodySetControllerStep(*body, 0, 0.01));
  ok(BodySetUp(*body));
  return options;
}

/* A field without any pattern, or a rigid one: v = w x (X + u) + c, about z in two dimensions */
static void fill(Body body, PetscReal size, PetscInt which, Vec vec)
{
  const PetscInt dim = body->mesh.dim;
  PetscScalar   *values;

  ok(VecGetArrayWrite(vec, &values));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++)
    values[i] = size * scattered(body->mesh.coordinates + i / dim * dim, dim, which + i % dim);
  ok(VecRestoreArrayWrite(vec, &values));
}

static void fill_rigid(Body body, Vec u, Vec v)
{
  static const PetscReal spin[3] = {0.4, -0.7, 1.1};
  const PetscInt         dim     = body->mesh.dim;
  const PetscScalar     *displacement;
  PetscScalar           *values;

  ok(VecGetArrayRead(u, &displacement));
  ok(VecGetArrayWrite(v, &values));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i += dim) {
    PetscReal x[3] = {0};

    for (PetscInt d = 0; d < dim; d++) x[d] = body->mesh.coordinates[i + d] + displacement[i + d];
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt a = (d + 1) % 3, b = (d + 2) % 3;

      values[i + d] = 0.5;
      if (dim == 3) values[i + d] += spin[a] * x[b] - spin[b] * x[a];
      if (dim == 2) values[i + d] += d ? spin[2] * x[0] : -spin[2] * x[1];
    }
  }
  ok(VecRestoreArrayWrite(v, &values));
  ok(VecRestoreArrayRead(u, &displacement));
}

static PetscReal largest(Vec vec)
{
  PetscReal norm;

  ok(VecNorm(vec, NORM_INFINITY, &norm));
  return norm;
}

static void is_what_the_matrix_makes_of_the_velocity(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES; shape++)
    for (PetscInt nonlinear = 0; nonlinear < 2; nonlinear++) {
      char         more[256];
      Body         body;
      Vec          u, v, force, product;
      Mat          C;
      PetscReal    power;
      PetscOptions options;

      (void)snprintf(more, sizeof(more), "-damping_mass %g -damping_stiffness %g %s", ALPHA, BETA,
                     nonlinear ? "-material_type neo_hookean" : "");
      options = create(&body, shape, more);
      ok(BodyCreateVec(body, &u));
      ok(BodyCreateVec(body, &v));
      ok(BodyCreateVec(body, &force));
      ok(BodyCreateVec(body, &product));
      fill(body, 0.1, 0, u);
      fill(body, 1, 5, v);
      ok(BodyMultiplyDamping(body, u, v, force));
      ok(BodyCreateMatrix(body, &C));
      ok(BodyAssembleTangent(body, NULL, C));
      ok(MatZeroEntries(C));
      ok(BodyAddDampingMatrix(body, u, 2, C));
      ok(MatMult(C, v, product));
      ok(VecDot(force, v, &power));
      assert_true(power > 0);
      ok(VecAXPY(product, -2, force));
      near(largest(product), 0, 1e-13 * largest(force));
      /* at zero strain, or of a linear body anywhere: the stiffness */
      ok(VecZeroEntries(u));
      ok(BodyMultiplyDamping(body, u, v, force));
      ok(BodyAssembleTangent(body, NULL, C));
      ok(MatMult(C, v, product));
      ok(VecAXPY(force, -BETA, product));
      ok(BodyMultiplyMass(body, v, product));
      ok(VecAXPY(force, -ALPHA, product));
      near(largest(force), 0, 1e-13 * 5);
      ok(MatDestroy(&C));
      ok(VecDestroy(&u));
      ok(VecDestroy(&v));
      ok(VecDestroy(&force));
      ok(VecDestroy(&product));
      bar_destroy(&body, options);
    }
}

/* A strained body that turns and moves as a whole */
static void lets_rigid_motions_pass(void **state)
{
  (void)state;
  for (PetscInt shape = 0; shape < SHAPES; shape++) {
    char         more[256];
    Body         body;
    Vec          u, v, force;
    PetscOptions options;

    (void)snprintf(more, sizeof(more), "-damping_stiffness %g -material_type saint_venant_kirchhoff", BETA);
    options = create(&body, shape, more);
    ok(BodyCreateVec(body, &u));
    ok(BodyCreateVec(body, &v));
    ok(BodyCreateVec(body, &force));
    fill(body, 0.1, 0, u);
    fill_rigid(body, u, v);
    ok(BodyMultiplyDamping(body, u, v, force));
    near(largest(force), 0, 1e-14 * 5);
    ok(VecDestroy(&u));
    ok(VecDestroy(&v));
    ok(VecDestroy(&force));
    bar_destroy(&body, options);
  }
}

/* Elements at massless nodes have none, and translations pass; nodes further inside have forces */
static void leaves_massless_nodes_alone(void **state)
{
  (void)state;
  for (PetscInt nonlinear = 0; nonlinear < 2; nonlinear++) {
    static const PetscReal node[] = {0, 0, 0}, direction[] = {-1, 0, 0};
    const PetscScalar     *f;
    PetscReal              inside = 0, layer = 0;
    Body                   body;
    NodeRows               rows;
    Vec                    v;
    PetscOptions options = solid_body_create(&body,
                                             "-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,2 -dm_plex_box_upper 2,1 -density 3 "
                                             "-youngs_modulus 5 -damping_mass %g -damping_stiffness %g %s",
                                             ALPHA, BETA, nonlinear ? "-material_type neo_hookean" : "");

    touch_side(body, "xmin");
    set_node_rows(body, 1, node, direction, &rows);
    ok(BodySetControllerStep(body, 0, 0.01));
    ok(BodySetUp(body));
    ok(BodyCreateVec(body, &v));
    fill(body, 1, 0, v);
    ok(BodyMultiplyDamping(body, body->state.u, v, body->state.damping));
    ok(VecGetArrayRead(body->state.damping, &f));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * 2; i++) {
      const PetscBool massless = (PetscBool)(body->mesh.coordinates[i / 2 * 2] < 0.25);

      if (massless) layer = PetscMax(layer, PetscAbsReal(f[i]));
      else inside = PetscMax(inside, PetscAbsReal(f[i]));
    }
    ok(VecRestoreArrayRead(body->state.damping, &f));
    near(layer, 0, 0);
    if (body->mesh.owned_nodes) assert_true(inside > 0);
    ok(VecDestroy(&v));
    bar_destroy(&body, options);
  }
}

static void is_checked(void **state)
{
  Body         body;
  PetscReal    mass, stiffness;
  PetscOptions options;

  (void)state;
  options = solid_body_create(&body, "%s -density 3 -youngs_modulus 5 -damping_mass 0.25", shape_options(0));
  ok(BodyGetDamping(body, &mass, &stiffness));
  near(mass, 0.25, 0);
  near(stiffness, 0, 0);
  refused(PETSC_ERR_ARG_OUTOFRANGE, "Body 'b'|negative", BodySetDamping(body, -1, 0));
  refused(PETSC_ERR_ARG_OUTOFRANGE, "Body 'b'|negative", BodySetDamping(body, 0, -1));
  ok(BodySetDamping(body, 0, 0.5));
  ok(BodyGetDamping(body, NULL, &stiffness));
  near(stiffness, 0.5, 0);
  ok(BodyDestroy(&body));
  options_drop(options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_what_the_matrix_makes_of_the_velocity),
      cmocka_unit_test(lets_rigid_motions_pass),
      cmocka_unit_test(leaves_massless_nodes_alone),
      cmocka_unit_test(is_checked),
  };

  return impakt_main(argc, argv, tests);
}
