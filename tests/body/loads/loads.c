/* ranks: 1 3 */
/* long: 3 */
/* Forces from outside: tractions, body forces and gravity. Prescribed displacements: which dofs are held, where and how fast they go. */
#include "loads.h"

/* Totals are sums of some hundred terms of size up to 100: round-off below 1e-12 */
#define ROUND_OFF 1e-12

static const char *const sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

static PetscReal volume(PetscInt dim)
{
  PetscReal v = 1;

  for (PetscInt d = 0; d < dim; d++) v *= box_size[d];
  return v;
}

static PetscReal area(PetscInt dim, PetscInt axis)
{
  return volume(dim) / box_size[axis];
}

/* 7, -5, 3 Pa on each side in turn: the area of the side times that, at its centre */
static void traction_is_area_times_traction(void **state)
{
  const char *const components[] = {"7", "7,-5", "7,-5,3"};
  const PetscReal   traction[]   = {7, -5, 3};

  (void)state;
  for (PetscInt box = 0; box < N_BOXES; box++)
    for (PetscInt side = 0; side < 2 * box_dim[box]; side++) {
      const PetscInt dim = box_dim[box];
      PetscOptions   options;
      char           text[256];
      Total          total;
      PetscBool      force;
      Body           body;

      ok(PetscSNPrintf(text, sizeof(text), "-boundary_traction %s -boundary_traction_%s %s", sides[side], sides[side],
                       components[dim - 1]));
      options = box_create(&body, box, text);
      ok(BodyHasForces(body, &force));
      assert_true(force);
      total = force_at(body, 0.3);
      for (PetscInt j = 0; j < dim; j++) {
        near(total.force[j], area(dim, side / 2) * traction[j], ROUND_OFF);
        for (PetscInt i = 0; i < dim; i++) {
          const PetscReal centre = box_lower[i] + box_size[i] * (i == side / 2 ? side % 2 : 0.5);

          near(total.moment[i][j], centre * total.force[j], ROUND_OFF);
        }
      }
      bar_destroy(&body, options);
    }
}

/* Cross-section of bars, thickness of plane bodies */
static void traction_knows_cross_section_and_thickness(void **state)
{
  PetscOptions options;
  Body         body;

  (void)state;
  options = box_create(&body, 0, "-cross_section 0.25 -boundary_traction xmax -boundary_traction_xmax 8");
  near(force_at(body, 0).force[0], 2, ROUND_OFF);
  bar_destroy(&body, options);
  for (PetscInt box = 1; box < 3; box++) {
    options = box_create(&body, box, "-thickness 0.25 -boundary_traction xmax -boundary_traction_xmax 8,t*y");
    near(force_at(body, 0).force[0], 0.25 * 3 * 8, ROUND_OFF);
    near(force_at(body, 2).force[1], 0.25 * 2 * 1.5, ROUND_OFF); /* int y dy from -1 to 2 */
    bar_destroy(&body, options);
  }
}

/* A pressure of 2 Pa on each side pushes against its normal; also where the box is turned by 30 degrees about the z axis */
static void pressure_pushes_inwards(void **state)
{
  const char *const components[] = {"-2*nx", "-2*nx,-2*ny", "-2*nx,-2*ny,-2*nz"}, *const turns[] = {"", "-rotate 30", "-rotate 0,0,1,30"};
  const PetscReal c[2] = {1, PetscSqrtReal(0.75)}, s[2] = {0, 0.5};

  (void)state;
  for (PetscInt box = 0; box < N_BOXES; box++)
    for (PetscInt turned = 0; turned < (box_dim[box] > 1 ? 2 : 1); turned++)
      for (PetscInt side = 0; side < 2 * box_dim[box]; side++) {
        const PetscInt  dim = box_dim[box], axis = side / 2;
        const PetscReal push        = (side % 2 ? -2 : 2) * area(dim, axis);
        const PetscReal expected[3] = {axis == 0   ? c[turned] * push
                                       : axis == 1 ? -s[turned] * push
                                                   : 0,
                                       axis == 0   ? s[turned] * push
                                       : axis == 1 ? c[turned] * push
                                                   : 0,
                                       axis == 2 ? push : 0};
        PetscOptions    options;
        char            text[256];
        Total           total;
        Body            body;

        ok(PetscSNPrintf(text, sizeof(text), "-boundary_traction %s -boundary_traction_%s %s %s", sides[side], sides[side],
                         components[dim - 1], turned ? turns[dim - 1] : ""));
        options = box_create(&body, box, text);
        total   = force_at(body, 0);
        for (PetscInt j = 0; j < dim; j++) near(total.force[j], expected[j], ROUND_OFF);
        bar_destroy(&body, options);
      }
}

/* tx = 1 + 2 y + 4 z on x = 2.5: int y tx, int z tx. With Y = int y = (b^2 - a^2) / 2 and Y2 = int y^2 = (b^3 - a^3) / 3 over the edge
   from a to b, Z and Z2 likewise: int y tx = Y H + 2 Y2 H + 4 Y Z, where the edges are B = 3 and H = 4 long. */
static void linear_traction_has_its_moment(void **state)
{
  const PetscReal a = -1, b = 2, c = 0.25, d = 4.25, B = 3, H = 4;
  const PetscReal Y = (b * b - a * a) / 2, Y2 = (b * b * b - a * a * a) / 3, Z = (d * d - c * c) / 2, Z2 = (d * d * d - c * c * c) / 3;

  (void)state;
  for (PetscInt box = 1; box < N_BOXES; box++) {
    PetscOptions options;
    Total        total;
    Body         body;

    options = box_create(&body, box,
                         box < 3 ? "-boundary_traction xmax -boundary_traction_xmax 1+2*y,0"
                                 : "-boundary_traction xmax -boundary_traction_xmax 1+2*y+4*z,0,0");
    total   = force_at(body, 0);
    if (box < 3) {
      near(total.force[0], B + 2 * Y, ROUND_OFF);
      near(total.moment[1][0], Y + 2 * Y2, ROUND_OFF);
    } else {
      near(total.force[0], B * H + 2 * Y * H + 4 * B * Z, ROUND_OFF);
      near(total.moment[1][0], Y * H + 2 * Y2 * H + 4 * Y * Z, 10 * ROUND_OFF);
      near(total.moment[2][0], B * Z + 2 * Y * Z + 4 * B * Z2, 10 * ROUND_OFF);
    }
    bar_destroy(&body, options);
  }
}

/* fx = 2 + 3 x over the box: V (2 + 3 m) with the mean position m; its moment int x fx: A (2 (b^2 - a^2) / 2 + 3 (b^3 - a^3) / 3);
   steady, growing in time, and both at once */
static void body_force_is_density_times_volume(void **state)
{
  const char *const components[] = {"2+3*x", "(2+3*x)*t,5*t", "2+3*x,5*t,t<1?0:x"};
  const PetscReal   a = 0.5, b = 2.5;

  (void)state;
  for (PetscInt box = 0; box < N_BOXES; box++) {
    const PetscInt  dim = box_dim[box];
    const PetscReal t = dim == 2 ? 2 : 1, V = volume(dim);
    PetscOptions    options;
    char            text[256];
    Total           total;
    Body            body;

    ok(PetscSNPrintf(text, sizeof(text), "-body_force %s", components[dim - 1]));
    options = box_create(&body, box, text);
    total   = force_at(body, t);
    near(total.force[0], (dim == 2 ? t : 1) * V * (2 + 3 * 1.5), 4 * ROUND_OFF);
    near(total.moment[0][0], (dim == 2 ? t : 1) * area(dim, 0) * ((b * b - a * a) + (b * b * b - a * a * a)), 4 * ROUND_OFF);
    if (dim > 1) near(total.force[1], V * 5 * t, 4 * ROUND_OFF);
    if (dim > 2) near(total.force[2], V * 1.5, 4 * ROUND_OFF);
    if (dim > 2) near(force_at(body, 0).force[2], 0, 0);
    bar_destroy(&body, options);
  }
}

/* Sum of the forces with weights that tell all nodes apart: the same body may be divided among the ranks in another way */
static PetscReal fingerprint(Body body, Vec f)
{
  const PetscScalar *x, *values;
  PetscReal          sum = 0;
  PetscInt           n;
  Vec                positions;

  ok(BodyGetReferencePositions(body, &positions));
  ok(VecGetLocalSize(positions, &n));
  ok(VecGetArrayRead(positions, &x));
  ok(VecGetArrayRead(f, &values));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal phase = i % body->mesh.dim;

    for (PetscInt d = 0; d < body->mesh.dim; d++) phase += (3 + 4 * d) * x[i / body->mesh.dim * body->mesh.dim + d];
    sum += (2 + PetscSinReal(phase)) * values[i];
  }
  ok(VecRestoreArrayRead(f, &values));
  ok(VecRestoreArrayRead(positions, &x));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return sum;
}

/* The same loads written as steady, as functions of time, of time and place, and as tables give the same nodal forces at that time,
   on top of what is there; -2 times as much with a scale of -2 */
static void steady_and_varying_are_the_same_force(void **state)
{
  const char *const formulas[] = {"6", "3*t", "3*t+0*x", "table:loads-table.txt"};
  PetscMPIInt       rank;

  (void)state;
  assert_int_equal(MPI_Comm_rank(PETSC_COMM_WORLD, &rank), 0);
  if (!rank) {
    FILE *file = fopen("loads-table.txt", "w");

    assert_non_null(file);
    fprintf(file, "0 0\n4 12\n");
    assert_int_equal(fclose(file), 0);
  }
  assert_int_equal(MPI_Barrier(PETSC_COMM_WORLD), 0);
  for (PetscInt box = 1; box < N_BOXES; box++) {
    PetscReal first = 0;

    for (size_t k = 0; k < sizeof(formulas) / sizeof(formulas[0]); k++) {
      PetscOptions options;
      char         text[512];
      PetscReal    norm, print;
      Body         body;
      Vec          f, negative;

      ok(PetscSNPrintf(text, sizeof(text), "-boundary_traction ymax -boundary_traction_ymax 0,%s%s -body_force %s,1%s", formulas[k],
                       box < 3 ? "" : ",2", formulas[k], box < 3 ? "" : ",x"));
      options = box_create(&body, box, text);
      ok(BodyCreateVec(body, &f));
      ok(BodyCreateVec(body, &negative));
      ok(VecSet(f, 5));
      ok(BodyLoadsAddForce(body, 2, 1, f));
      ok(VecShift(f, -5));
      ok(VecZeroEntries(negative));
      ok(BodyLoadsAddForce(body, 2, -2, negative));
      print = fingerprint(body, f);
      if (!k) first = print;
      assert_true(PetscAbsReal(first) > 1);
      near(print, first, ROUND_OFF);
      ok(VecAXPY(negative, 2, f));
      ok(VecNorm(negative, NORM_INFINITY, &norm));
      near(norm, 0, 1e-14 * 20); /* forces of up to 10 N */
      ok(VecDestroy(&f));
      ok(VecDestroy(&negative));
      bar_destroy(&body, options);
    }
  }
}

static void bodies_without_loads_have_none(void **state)
{
  PetscOptions    options;
  const PetscInt *dofs;
  PetscBool       force;
  PetscInt        n;
  Body            body;

  (void)state;
  options = box_create(&body, 1, "-initial_velocity 1,2");
  assert_null(body->loads);
  ok(BodyHasForces(body, &force));
  assert_false(force);
  ok(BodyGetHeldDofs(body, &n, &dofs));
  assert_int_equal(n, 0);
  near(force_at(body, 0).force[0], 0, 0);
  bar_destroy(&body, options);
}

static void refuses_bad_forces(void **state)
{
  const struct {
    const char *options, *words;
  } cases[] = {
      {"-boundary_traction xmax", "-bar_boundary_traction|'xmax'|-bar_boundary_traction_xmax"},
      {"-boundary_traction", "-bar_boundary_traction|no value"},
      {"-boundary_traction xmax,,ymax -boundary_traction_xmax 1,2 -boundary_traction_ymax 1,2", "-bar_boundary_traction|empty name"},
      {"-boundary_traction xmax,xmin,XMAX -boundary_traction_xmax 1,2 -boundary_traction_xmin 1,2", "-bar_boundary_traction|twice"},
      {"-boundary_traction top -boundary_traction_top 1,2", "bar|'top'|xmin"},
      {"-boundary_traction zmax -boundary_traction_zmax 1,2", "bar|'zmax'"},
      {"-boundary_traction xmax -boundary_traction_xmax 1", "-bar_boundary_traction_xmax|1 component;|'bar'|2-dimensional"},
      {"-boundary_traction xmax -boundary_traction_xmax 1,2,3", "-bar_boundary_traction_xmax|3 components|'bar'|2-dimensional"},
      {"-boundary_traction xmax -boundary_traction_xmax 1,free", "-bar_boundary_traction_xmax|'free'"},
      {"-boundary_traction xmax -boundary_traction_xmax 1,2*q", "-bar_boundary_traction_xmax|'2*q'|\"q\"|x, y, z"},
      {"-boundary_traction xmax -boundary_traction_xmax 1,table:nowhere.txt", "-bar_boundary_traction_xmax|'nowhere.txt'|No such file"},
      {"-boundary_traction xmax -boundary_traction_xmax -x,0", "-bar_boundary_traction_xmax|no value|parentheses"},
      {"-gravity 9.81", "-bar_gravity|1 component;|2-dimensional"},
      {"-gravity 0,x", "-bar_gravity|'0,x'|numbers|-bar_body_force"},
      {"-body_force 1,2,3", "-bar_body_force|3 components"},
      {"-body_force nx,0", "-bar_body_force|nx|tractions"},
      {"-initial_velocity 1,2,3", "-bar_initial_velocity|3 components|'bar'|2-dimensional"},
      {"-initial_velocity 1,t", "-bar_initial_velocity|vary in time"},
      {"-initial_displacement nx,0", "-bar_initial_displacement|nx"},
      {"-initial_displacement 1,y+", "-bar_initial_displacement|'y+'"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    PetscOptions options = box_options(1, cases[i].options);
    Body         body;

    ok(BodyCreate(PETSC_COMM_WORLD, "bar", &body));
    refused(PETSC_ERR_USER_INPUT, cases[i].words, BodySetFromOptions(body));
    ok(BodyDestroy(&body));
    options_drop(options);
  }
}

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

  ok(BodyGetHeldDofs(body, &n, &dofs));
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
    ok(BodyHasForces(body, &force));
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
      cmocka_unit_test(traction_is_area_times_traction),
      cmocka_unit_test(traction_knows_cross_section_and_thickness),
      cmocka_unit_test(pressure_pushes_inwards),
      cmocka_unit_test(linear_traction_has_its_moment),
      cmocka_unit_test(body_force_is_density_times_volume),
      cmocka_unit_test(steady_and_varying_are_the_same_force),
      cmocka_unit_test(bodies_without_loads_have_none),
      cmocka_unit_test(refuses_bad_forces),
      cmocka_unit_test(held_dofs_are_those_of_the_surfaces),
      cmocka_unit_test(held_dofs_go_as_prescribed),
      cmocka_unit_test(rates_begin_at_the_start),
      cmocka_unit_test(the_last_in_the_list_wins),
      cmocka_unit_test(refuses_bad_displacements),
  };

  return impakt_main(argc, argv, tests);
}
