/* long: 3 */
/* Forces from outside: tractions, body forces and gravity. */
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
      ok(BodyLoadsHaveForce(body, &force));
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

/* A pressure that grows as 3 z + 5 all around: buoyancy, the volume times the slope, through the centre of the volume (divergence
   theorem); the same while it grows in time */
static void pressure_of_a_fluid_is_buoyancy(void **state)
{
  const char *const formulas[] = {"-(3*z+5)", "-(3*z+5)*t/4"};

  (void)state;
  for (PetscInt box = 3; box < N_BOXES; box++)
    for (int formula = 0; formula < 2; formula++) {
      const PetscReal lift       = -3 * volume(3);
      char            text[1024] = "-boundary_traction xmin,xmax,ymin,ymax,zmin,zmax", one[128];
      PetscOptions    options;
      Total           total;
      Body            body;

      for (int side = 0; side < 6; side++) {
        ok(PetscSNPrintf(one, sizeof(one), " -boundary_traction_%s %s*nx,%s*ny,%s*nz", sides[side], formulas[formula], formulas[formula],
                         formulas[formula]));
        ok(PetscStrlcat(text, one, sizeof(text)));
      }
      options = box_create(&body, box, text);
      total   = force_at(body, 4);
      for (int j = 0; j < 3; j++) {
        near(total.force[j], j == 2 ? lift : 0, 10 * ROUND_OFF);
        if (j < 2) near(total.moment[j][2] - total.moment[2][j], (box_lower[j] + box_size[j] / 2) * lift, 10 * ROUND_OFF);
      }
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

/* Weight is M g: m g in all, and free fall has the acceleration g at every node, whatever the mass matrix */
static void gravity_is_free_fall(void **state)
{
  const char *const g[] = {"-9.81", "1.5,-9.81", "1.5,2.5,-9.81"}, *const masses[] = {"lumped", "consistent", "averaged"};
  const PetscReal values[3][3] = {{-9.81}, {1.5, -9.81}, {1.5, 2.5, -9.81}};

  (void)state;
  for (PetscInt box = 0; box < N_BOXES; box++)
    for (int mass = 0; mass < 3; mass++) {
      const PetscInt     dim = box_dim[box];
      const PetscScalar *accelerations;
      PetscOptions       options;
      char               text[256];
      Total              total;
      PetscInt           n;
      Body               body;
      Vec                a;

      ok(PetscSNPrintf(text, sizeof(text), "-gravity %s -mass_type %s", g[dim - 1], masses[mass]));
      options = box_create(&body, box, text);
      total   = force_at(body, 0);
      for (PetscInt d = 0; d < dim; d++)
        near(total.force[d], 3 * volume(dim) * values[dim - 1][d], 700 * ROUND_OFF); /* 3 * 24 * 9.81 = 706 */
      ok(BodyGetSolution(body, NULL, NULL, &a));
      ok(VecGetLocalSize(a, &n));
      ok(VecGetArrayRead(a, &accelerations));
      for (PetscInt i = 0; i < n; i++)
        near(accelerations[i], values[dim - 1][i % dim], 1e-10); /* a solve with the mass matrix, whose condition number is below 100 */
      ok(VecRestoreArrayRead(a, &accelerations));
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
    PetscReal phase = i % body->dim;

    for (PetscInt d = 0; d < body->dim; d++) phase += (3 + 4 * d) * x[i / body->dim * body->dim + d];
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
  ok(BodyLoadsHaveForce(body, &force));
  assert_false(force);
  ok(BodyLoadsGetHeld(body, &n, &dofs));
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(traction_is_area_times_traction),
      cmocka_unit_test(traction_knows_cross_section_and_thickness),
      cmocka_unit_test(pressure_pushes_inwards),
      cmocka_unit_test(pressure_of_a_fluid_is_buoyancy),
      cmocka_unit_test(linear_traction_has_its_moment),
      cmocka_unit_test(body_force_is_density_times_volume),
      cmocka_unit_test(gravity_is_free_fall),
      cmocka_unit_test(steady_and_varying_are_the_same_force),
      cmocka_unit_test(bodies_without_loads_have_none),
      cmocka_unit_test(refuses_bad_forces),
  };

  return impakt_main(argc, argv, tests);
}
