/* ranks: 1 3 */
/* long: 3 */
/* The massless layer of explicit bodies in two and three dimensions: in balance with what is inside and with its loads, by linear and by
   nonlinear materials; and not damped. */
#include "solid_bodies.h"
#include <impakt/private/bodystep.h>

static const char *const materials[] = {MATERIAL_LINEAR_ELASTIC, MATERIAL_NEO_HOOKEAN};
#define MATERIALS 2

/* Elements of 0.5 m; waves run at 1.4 m/s and cross an element in some 0.3 s */
#define STEP   0.05
#define COMMON "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 -ts_type centraldifference "
static const char *const boxes[] = {"-dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5",
                                    "-dm_plex_box_faces 3,2,3 -dm_plex_box_upper 1.5,1,1.5"};
static const char *const sides[] = {"ymax", "zmax"};

static void advance(Body body)
{
  ok(BodyIntegrate(body));
  ok(BodySave(body));
}

static PetscOptions create(Body *body, PetscInt kind, PetscInt material, const char more[])
{
  const PetscInt space   = kind_dim[kind] - 2;
  PetscOptions   options = solid_body_create(body, "%s %s -material_type %s " COMMON "%s", kind_options(kind), boxes[space],
                                             materials[material], more);

  touch_side(*body, sides[space]);
  ok(BodySetControllerStep(*body, 0, STEP));
  return options;
}

/* Largest internal force less that from outside on the free dofs of the layer, and the largest internal force at all [N] */
static void get_imbalance(Body body, PetscReal *left, PetscReal *largest)
{
  const PetscScalar *internal;
  PetscInt           layer = 0;
  Vec                f, rest;

  ok(BodyCreateVec(body, &f));
  ok(BodyCreateVec(body, &rest));
  ok(BodyComputeInternalForce(body, body->state.u, f));
  ok(VecNorm(f, NORM_INFINITY, largest));
  ok(VecCopy(f, rest));
  ok(BodyAddExternalForce(body, body->state.time, -1, rest));
  ok(VecGetArrayRead(rest, &internal));
  *left = 0;
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) *left = PetscMax(*left, PetscAbsReal(internal[body->layer.dofs[i]]));
  ok(VecRestoreArrayRead(rest, &internal));
  ok(VecDestroy(&f));
  ok(VecDestroy(&rest));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, left, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD), 0);
  assert_int_equal(MPI_Allreduce(&body->layer.n_dofs, &layer, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  assert_true(layer > 0);
}

/* Chord Newton's method stops where displacements change by 1e-12 of its first change; 1e-14 was measured. Linear bodies are left with
   round-off. */
static void check_balance(PetscInt kind, PetscInt material, const char loads[])
{
  PetscReal    left, largest;
  Body         body;
  PetscOptions options = create(&body, kind, material, loads);

  ok(BodySetUp(body));
  ok(BodySetInitialState(body, ScatteredState, NULL));
  get_imbalance(body, &left, &largest);
  assert_true(left > 1e-2 * largest); /* the initial state is none of balance */
  for (PetscInt k = 0; k < 30; k++) {
    advance(body);
    get_imbalance(body, &left, &largest);
    assert_true(largest > 1e-3);
    between(left, 0, 1e-12 * largest);
  }
  bar_destroy(&body, options);
}

/* Free, with a traction, and with symmetry planes and clamped sides at its edge: nodes of which some or all dofs are held */
static void is_in_balance(void **state)
{
  static const char *const cases[2][4] = {
      {"", "-boundary_traction ymax -boundary_traction_ymax 0.02*(1+t),-0.03*x",
       "-boundary_displacement xmin -boundary_displacement_xmin 0,free",
       "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0,0 -boundary_displacement_xmax 0.01*sin(t),free"},
      {"", "-boundary_traction zmax -boundary_traction_zmax 0.02*(1+t),0.01,-0.03*x",
       "-boundary_displacement xmin -boundary_displacement_xmin 0,free,free",
       "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0,0,0 -boundary_displacement_xmax 0.01*sin(t),free,free"}};

  (void)state;
  for (PetscInt kind = 0; kind < KINDS; kind++)
    for (PetscInt material = 0; material < MATERIALS; material++)
      for (PetscInt i = 0; i < 4; i++) check_balance(kind, material, cases[kind_dim[kind] - 2][i]);
}

#define ALPHA 0.7
#define BETA  0.3

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
      cmocka_unit_test(is_in_balance),
      cmocka_unit_test(leaves_massless_nodes_alone),
      cmocka_unit_test(is_checked),
  };

  return impakt_main(argc, argv, tests);
}
