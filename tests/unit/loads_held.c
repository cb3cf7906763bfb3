/* Prescribed displacements: which dofs are held, where and how fast they go; the state at the start. */
#include "loads.h"

/* The value of component d at the node at x, on every rank; 1e30 if there is no such node */
static PetscReal component_at(Body body, Vec vec, const PetscReal x[], PetscInt component)
{
  const PetscScalar *values;
  PetscReal          value = 1e30;

  ok(VecGetArrayRead(vec, &values));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal distance = 0;

    for (PetscInt d = 0; d < body->mesh.dim; d++) distance += PetscAbsReal(body->mesh.coordinates[node * body->mesh.dim + d] - x[d]);
    if (distance < 1e-9) value = values[node * body->mesh.dim + component];
  }
  ok(VecRestoreArrayRead(vec, &values));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPIU_REAL, MPI_MIN, PETSC_COMM_WORLD), 0);
  return value;
}

static PetscInt count_held(Body body)
{
  const PetscInt *dofs;
  PetscInt        n;

  ok(BodyLoadsGetHeld(body, &n, &dofs));
  for (PetscInt i = 0; i < n; i++) {
    assert_true(dofs[i] >= 0 && dofs[i] < body->mesh.owned_nodes * body->mesh.dim);
    if (i) assert_true(dofs[i] > dofs[i - 1]);
  }
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  return n;
}

/* Boxes have 5, 3 x 2 and 3 x 2 x 3 cells along the axes: xmin has 1, 3 and 12 nodes, ymin 4 and 16, zmin 12 */
static void held_dofs_are_those_of_the_surfaces(void **state)
{
  const struct {
    PetscInt    box, n;
    const char *options;
  } cases[] = {
      {0, 1, "-boundary_displacement xmin -boundary_displacement_xmin 0"},
      {0, 2, "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0 -boundary_displacement_xmax t"},
      {1, 6, "-boundary_displacement xmin -boundary_displacement_xmin 0,0"},
      {2, 3, "-boundary_displacement xmin -boundary_displacement_xmin free,0"},
      {2, 0, "-boundary_displacement xmin -boundary_displacement_xmin free,free"},
      {1, 6 + 3,
       "-boundary_displacement xmin,ymin -boundary_displacement_xmin 0,0 -boundary_displacement_ymin x,free"}, /* they share a node */
      {3, 36, "-boundary_displacement xmin -boundary_displacement_xmin 0,1,t"},
      {4, 12 + 16 + 12,
       "-boundary_displacement xmin,ymin,zmin -boundary_displacement_xmin 0,free,free -boundary_displacement_ymin free,0,free "
       "-boundary_displacement_zmin free,free,0"},
      {4, 12 + 16 - 4 + 12,
       "-boundary_displacement xmin,ymin,zmin -boundary_displacement_xmin 0,free,free -boundary_displacement_ymin 0,free,free "
       "-boundary_displacement_zmin free,free,0"}, /* four nodes on the edge of both */
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options;
    PetscBool    force;
    Body         body;

    options = box_create(&body, cases[i].box, cases[i].options);
    assert_int_equal(count_held(body), cases[i].n);
    ok(BodyLoadsHaveForce(body, &force));
    assert_false(force);
    bar_destroy(&body, options);
  }
}

/* u = (0.1 sin(20 t) y, free) on xmax, steady values on xmin: displacement, velocity 2 cos(20 t) y, acceleration -40 sin(20 t) y.
   20 rad/s times the step of 0.01 s is 0.2 rad, within what ExpressionEvaluateRates() states: 1e-6 of the velocity, 1e-4 of the
   acceleration. What is not held is not touched. */
static void held_dofs_go_as_prescribed(void **state)
{
  const PetscReal top[] = {2.5, 2}, bottom[] = {0.5, -1}, inside[] = {0.5 + 2. / 3, 0.5}, times[] = {0, 0.001, 0.01, 0.37, 5};

  (void)state;
  for (PetscInt box = 1; box < 3; box++) {
    PetscOptions options;
    Vec          vecs[3];
    Body         body;

    options = box_create(
        &body, box,
        "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0.5,x-y -boundary_displacement_xmax 0.1*sin(20*t)*y,free");
    for (int k = 0; k < 3; k++) ok(BodyCreateVec(body, &vecs[k]));
    for (size_t i = 0; i < sizeof(times) / sizeof(times[0]); i++) {
      const PetscReal t = times[i], expected[] = {0.2 * PetscSinReal(20 * t), 4 * PetscCosReal(20 * t), -80 * PetscSinReal(20 * t)},
                      tolerance[] = {1e-15, 4e-6, 80e-4};

      for (int k = 0; k < 3; k++) ok(VecSet(vecs[k], 77));
      ok(BodyLoadsPrescribe(body, t, vecs[0], vecs[1], vecs[2]));
      for (int k = 0; k < 3; k++) {
        near(component_at(body, vecs[k], top, 0), expected[k], tolerance[k]);
        near(component_at(body, vecs[k], top, 1), 77, 0);
        near(component_at(body, vecs[k], bottom, 0), k ? 0 : 0.5, 0);
        near(component_at(body, vecs[k], bottom, 1), k ? 0 : 1.5, 0);
        near(component_at(body, vecs[k], inside, 0), 77, 0);
      }
      /* each alone */
      for (int k = 0; k < 3; k++) {
        const PetscReal with_others = component_at(body, vecs[k], top, 0);

        ok(VecSet(vecs[k], 77));
        ok(BodyLoadsPrescribe(body, t, k == 0 ? vecs[0] : NULL, k == 1 ? vecs[1] : NULL, k == 2 ? vecs[2] : NULL));
        near(component_at(body, vecs[k], top, 0), with_others, 0);
      }
    }
    for (int k = 0; k < 3; k++) ok(VecDestroy(&vecs[k]));
    bar_destroy(&body, options);
  }
}

/* At the start, 1 s, nothing before it is asked for: sqrt(t - 1) is not defined there */
static void rates_begin_at_the_start(void **state)
{
  const PetscReal end = 2.5;
  PetscOptions    options;
  Vec             u, v;
  Body            body;

  (void)state;
  options = box_options(
      0, "-boundary_displacement xmin,xmax -boundary_displacement_xmin 0 -boundary_displacement_xmax t<1?sqrt(t-1):3*(t-1)+(t-1)^2");
  ok(BodyCreate(PETSC_COMM_WORLD, "bar", &body));
  ok(BodySetFromOptions(body));
  ok(BodySetControllerStep(body, 1, 0.01));
  ok(BodySetUp(body));
  ok(BodyCreateVec(body, &u));
  ok(BodyCreateVec(body, &v));
  ok(BodyLoadsPrescribe(body, 1, NULL, u, v));
  near(value_at(body, u, end), 3, 1e-9); /* round-off of t - 1, epsilon / h with h = 0.0025, times the sum of the weights, 31: 3e-12 */
  near(value_at(body, v, end), 2, 1e-8); /* 3 epsilon / h^2 times 102: 1e-8 at the worst */
  ok(VecDestroy(&u));
  ok(VecDestroy(&v));
  bar_destroy(&body, options);
}

/* On the corner (0.5, -1), which belongs to xmin and ymin */
static void the_last_in_the_list_wins(void **state)
{
  const PetscReal corner[] = {0.5, -1};
  const struct {
    const char *options;
    PetscReal   x, y;
  } cases[] = {
      {"-boundary_displacement xmin,ymin -boundary_displacement_xmin 1,2 -boundary_displacement_ymin 3,4", 3, 4},
      {"-boundary_displacement ymin,xmin -boundary_displacement_xmin 1,2 -boundary_displacement_ymin 3,4", 1, 2},
      {"-boundary_displacement xmin,ymin -boundary_displacement_xmin 1,2*t -boundary_displacement_ymin 3*t,free", 1.5, 1},
      {"-boundary_displacement ymin,xmin -boundary_displacement_xmin 1,2*t -boundary_displacement_ymin 3*t,free", 1, 1},
      {"-boundary_displacement xmin,ymin -boundary_displacement_xmin 1,7 -boundary_displacement_ymin free,7", 1, 7},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options;
    Body         body;
    Vec          u;

    options = box_create(&body, 1, cases[i].options);
    ok(BodyCreateVec(body, &u));
    ok(VecSet(u, 0));
    ok(BodyLoadsPrescribe(body, 0.5, u, NULL, NULL));
    near(component_at(body, u, corner, 0), cases[i].x, 0);
    near(component_at(body, u, corner, 1), cases[i].y, 0);
    ok(VecDestroy(&u));
    bar_destroy(&body, options);
  }
}

/* Formulas of the reference position; prescribed values win */
static void the_state_at_the_start_is_that_of_the_options(void **state)
{
  const PetscReal inside[] = {0.5 + 2. / 3, 0.5}, held[] = {2.5, 0.5};
  PetscOptions    options;
  Body            body;
  Vec             u, v;

  (void)state;
  options = box_create(
      &body, 1,
      "-initial_displacement 0.01*x,-0.02*y -initial_velocity 3,x*y -boundary_displacement xmax -boundary_displacement_xmax 5*t+0.1,free");
  ok(BodyGetSolution(body, &u, &v, NULL));
  near(component_at(body, u, inside, 0), 0.01 * inside[0], 1e-17);
  near(component_at(body, u, inside, 1), -0.01, 1e-17);
  near(component_at(body, v, inside, 0), 3, 0);
  near(component_at(body, v, inside, 1), inside[0] * inside[1], 1e-15);
  near(component_at(body, u, held, 0), 0.1, 0);
  near(component_at(body, u, held, 1), -0.01, 1e-17);
  near(component_at(body, v, held, 0), 5, 1e-11); /* differences of 0.1 over 0.0025 s: 40 epsilon times 31 */
  near(component_at(body, v, held, 1), 1.25, 1e-15);
  bar_destroy(&body, options);

  options = box_create(&body, 1, "");
  ok(BodyGetSolution(body, &u, &v, NULL));
  near(component_at(body, u, inside, 0), 0, 0);
  near(component_at(body, v, inside, 1), 0, 0);
  bar_destroy(&body, options);
}

static void refuses_bad_displacements(void **state)
{
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-boundary_displacement xmax", "-bar_boundary_displacement|'xmax'|-bar_boundary_displacement_xmax"},
      {"-boundary_displacement top -boundary_displacement_top 1,2", "bar|'top'|xmin"},
      {"-boundary_displacement xmin,top -boundary_displacement_xmin 1,2 -boundary_displacement_top 1,2", "bar|'top'|xmin"},
      {"-boundary_displacement xmax,xmax -boundary_displacement_xmax 1,2", "-bar_boundary_displacement|twice"},
      {"-boundary_displacement xmax, -boundary_displacement_xmax 1,2", "-bar_boundary_displacement|empty name"},
      {"-boundary_displacement xmax -boundary_displacement_xmax 1",
       "-bar_boundary_displacement_xmax|1 component;|'bar'|2-dimensional|free"},
      {"-boundary_displacement xmax -boundary_displacement_xmax 1,free,free", "-bar_boundary_displacement_xmax|3 components|2-dimensional"},
      {"-boundary_displacement xmax -boundary_displacement_xmax 1,Free", "-bar_boundary_displacement_xmax|'Free'"},
      {"-boundary_displacement xmax -boundary_displacement_xmax nx,0", "-bar_boundary_displacement_xmax|nx|tractions"},
      {"-boundary_displacement xmax -boundary_displacement_xmax 1/0,0", "-bar_boundary_displacement_xmax|finite"},
      {"-dm_plex_box_faces 1,1 -boundary_displacement xmin,xmax -boundary_displacement_xmin 0,0 -boundary_displacement_xmax t,0",
       "-bar_boundary_displacement|all components of all nodes|'bar'"},
  };
  PetscMPIInt size;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options;
    Body         body;

    if (size > 1 && !strncmp(cases[i].options, "-dm_plex", 8)) continue; /* one cell is too little for several ranks */
    options = box_options(1, cases[i].options);
    ok(BodyCreate(PETSC_COMM_WORLD, "bar", &body));
    refused(PETSC_ERR_USER_INPUT, cases[i].words, BodySetFromOptions(body));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(held_dofs_are_those_of_the_surfaces),
      cmocka_unit_test(held_dofs_go_as_prescribed),
      cmocka_unit_test(rates_begin_at_the_start),
      cmocka_unit_test(the_last_in_the_list_wins),
      cmocka_unit_test(the_state_at_the_start_is_that_of_the_options),
      cmocka_unit_test(refuses_bad_displacements),
  };

  return impakt_main(argc, argv, tests);
}
