/* The rows that compare two surfaces: what they match, and what they conserve. */
#include "simulation.h"

/* Two boxes, the surfaces of each that may touch, and the matrices of the rows between them */
typedef struct {
  DM       dm[2];
  Surface  surface[2];
  Transfer transfer;
  PetscInt n;
  Mat      rows[2]; /* Dirichlet and Neumann side */
} Interface;

static void InterfaceCreate(PetscInt dim, const char *const faces[], const char *const lower[], const char *const upper[], const char *const names[], Interface *interface)
{
  PetscMPIInt rank;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  for (PetscInt side = 0; side < 2; side++) {
    interface->dm[side] = CreateBoxMesh(side ? "neumann" : "dirichlet", dim, faces[side], lower[side], upper[side], PETSC_TRUE);
    ok(SurfaceCreate(interface->dm[side], names[side], &interface->surface[side]));
  }
  ok(TransferCreate(PETSC_COMM_WORLD, interface->surface[0], interface->surface[1], &interface->transfer));
  ok(TransferGetSize(interface->transfer, &interface->n));
  for (PetscInt side = 0; side < 2; side++) {
    PetscInt local;
    Vec      u;

    ok(DMCreateGlobalVector(interface->dm[side], &u));
    ok(VecGetLocalSize(u, &local));
    ok(VecDestroy(&u));
    ok(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, local, interface->n, PETSC_DETERMINE, 6, NULL, 6, NULL, &interface->rows[side]));
  }
  for (PetscInt row = 0; row < interface->n && !rank; row++) ok(TransferSetValues(interface->transfer, row, row, interface->rows[0], interface->rows[1]));
  for (PetscInt side = 0; side < 2; side++) {
    ok(MatAssemblyBegin(interface->rows[side], MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(interface->rows[side], MAT_FINAL_ASSEMBLY));
  }
}

static void InterfaceDestroy(Interface *interface)
{
  ok(TransferDestroy(&interface->transfer));
  assert_null(interface->transfer);
  for (PetscInt side = 0; side < 2; side++) {
    ok(MatDestroy(&interface->rows[side]));
    ok(SurfaceDestroy(&interface->surface[side]));
    ok(DMDestroy(&interface->dm[side]));
  }
}

static void CreateBars(const char *const lower[], const char *const upper[], const char *const names[], Interface *interface)
{
  InterfaceCreate(1, (const char *const[]){"4", "3"}, lower, upper, names, interface);
}

/* [0,1] x [0,1] under [0,1] x [1.1,2]: 3 segments against 5, the nodes of neither opposite to those of the other */
static void CreateRectangles(Interface *interface)
{
  InterfaceCreate(2, (const char *const[]){"3,2", "5,2"}, (const char *const[]){"0,0", "0,1.1"}, (const char *const[]){"1,1", "1,2"}, (const char *const[]){"ymax", "ymin"}, interface);
}

/* Displacement of a node: a + b x along each axis d, with x its first coordinate */
static void SetLinearField(Interface *interface, PetscInt side, PetscReal a, PetscReal b, Vec *u)
{
  const SurfaceData *data;

  ok(SurfaceGetData(interface->surface[side], &data));
  ok(MatCreateVecs(interface->rows[side], u, NULL));
  for (PetscInt node = 0; node < data->n_nodes; node++)
    for (PetscInt d = 0; d < data->dim; d++) ok(VecSetValue(*u, data->dofs[node] + d, (d + 1) * (a + b * data->positions[node * data->dim]), INSERT_VALUES));
  ok(VecAssemblyBegin(*u));
  ok(VecAssemblyEnd(*u));
}

/* Numbers without zeros, symmetry, or smoothness */
static void SetAnything(Vec x, PetscReal seed)
{
  PetscInt begin, end;

  ok(VecGetOwnershipRange(x, &begin, &end));
  for (PetscInt i = begin; i < end; i++) ok(VecSetValue(x, i, PetscSinReal(seed + 1.7 * i * i) + 0.1, INSERT_VALUES));
  ok(VecAssemblyBegin(x));
  ok(VecAssemblyEnd(x));
}

static void bars_that_face_each_other(void **state)
{
  /* the second time the other way round, the Dirichlet normal pointing left */
  const char *const lower[] = {"0", "1.25", "0"}, *const upper[] = {"1", "2", "1"}, *const names[] = {NULL, NULL};
  const PetscReal    faces_at[] = {1, 1.25, 1};
  const SurfaceData *data;
  const PetscInt    *nodes;
  PetscInt           n, dof;
  PetscReal          gap, area;
  Interface          interface;

  (void)state;
  for (PetscInt order = 0; order < 2; order++) {
    CreateBars(lower + order, upper + order, names, &interface);
    assert_int_equal(interface.n, 1); /* the far ends look at each other too, but across both bars */
    for (PetscInt side = 0; side < 2; side++) {
      ok(TransferGetNodes(interface.transfer, (PetscBool)side, &n, &nodes));
      assert_int_equal(n, 1);
      ok(SurfaceGetData(interface.surface[side], &data));
      near(data->positions[nodes[0]], faces_at[order + side], 1e-15);
      if (!side) ok(TransferGetRow(interface.transfer, 0, &dof, &gap, &area));
      if (!side) assert_int_equal(dof, data->dofs[nodes[0]]);
    }
    near(gap, 0.25, 1e-15);
    near(area, 1, 0);
    InterfaceDestroy(&interface);
  }
}

/* The near ends 0.1 inside each other, or at the same place; the far ends, 2 apart, are no row */
static void overlap_is_a_negative_gap(void **state)
{
  const char *const right[] = {"0.9", "1"}, *const upper[] = {"1", "2"}, *const names[] = {NULL, NULL};
  const PetscReal gaps[] = {-0.1, 0};
  PetscInt        dof;
  PetscReal       gap, area;
  Interface       interface;

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    const char *const lower[] = {"0", right[i]};

    CreateBars(lower, upper, names, &interface);
    assert_int_equal(interface.n, 1);
    ok(TransferGetRow(interface.transfer, 0, &dof, &gap, &area));
    near(gap, gaps[i], 1e-15);
    InterfaceDestroy(&interface);
  }
}

static void surfaces_that_do_not_face_each_other(void **state)
{
  /* both look right; both look left; they look away from each other */
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"}, *const names[][2] = {{"xmax", "xmax"}, {"xmin", "xmin"}, {"xmin", "xmax"}};
  Interface interface;

  (void)state;
  for (PetscInt i = 0; i < 3; i++) {
    CreateBars(lower, upper, names[i], &interface);
    assert_int_equal(interface.n, 0);
    InterfaceDestroy(&interface);
  }
}

static void rows_of_segments(void **state)
{
  PetscReal total = 0;
  Interface interface;

  (void)state;
  CreateRectangles(&interface);
  assert_int_equal(interface.n, 4);
  for (PetscInt row = 0; row < 4; row++) {
    PetscInt  dof;
    PetscReal gap, area;

    ok(TransferGetRow(interface.transfer, row, &dof, &gap, &area));
    near(gap, 0.1, 1e-15);
    /* half of each segment of length 1/3 that ends there */
    between(area, 1. / 6 - 1e-15, 1. / 3 + 1e-15);
    total += area;
  }
  near(total, 1, 1e-15);
  InterfaceDestroy(&interface);
}

/* Both sides moved alike leave all gaps as they are. Linear fields too, since each node lies opposite to a point of a segment. */
static void constants_and_linear_fields_are_reproduced(void **state)
{
  const char *const lower[] = {"0", "1.25"}, *const upper[] = {"1", "2"}, *const names[] = {NULL, NULL};
  Interface interface;

  (void)state;
  for (PetscInt dim = 1; dim <= 2; dim++)
    for (PetscInt linear = 0; linear < dim; linear++) {
      Vec       u[2], moved[2];
      PetscReal difference, size;

      if (dim == 1) CreateBars(lower, upper, names, &interface);
      else CreateRectangles(&interface);
      for (PetscInt side = 0; side < 2; side++) {
        SetLinearField(&interface, side, 0.3, linear ? 0.7 : 0, &u[side]);
        ok(MatCreateVecs(interface.rows[side], NULL, &moved[side]));
        ok(MatMult(interface.rows[side], u[side], moved[side]));
      }
      ok(VecMin(moved[0], NULL, &size));
      near(size, dim * 0.3, 1e-15); /* the normal is along the last axis; the linear field is smallest at x = 0 */
      ok(VecAXPY(moved[1], -1, moved[0]));
      ok(VecNorm(moved[1], NORM_INFINITY, &difference));
      near(difference, 0, 1e-14); /* a few roundings of numbers of size 1 */
      for (PetscInt side = 0; side < 2; side++) {
        ok(VecDestroy(&u[side]));
        ok(VecDestroy(&moved[side]));
      }
      InterfaceDestroy(&interface);
    }
}

/* Work of a force on the gap is the same, taken on the rows or on the body: <B u, lambda> = <u, B' lambda> */
static void transposes_are_adjoint(void **state)
{
  Interface interface;

  (void)state;
  CreateRectangles(&interface);
  for (PetscInt side = 0; side < 2; side++) {
    Vec         u, lambda, gap, force;
    PetscScalar on_rows, on_body;

    ok(MatCreateVecs(interface.rows[side], &u, &lambda));
    ok(VecDuplicate(lambda, &gap));
    ok(VecDuplicate(u, &force));
    SetAnything(u, 0.3);
    SetAnything(lambda, 0.8);
    ok(MatMult(interface.rows[side], u, gap));
    ok(MatMultTranspose(interface.rows[side], lambda, force));
    ok(VecDot(gap, lambda, &on_rows));
    ok(VecDot(u, force, &on_body));
    assert_true(PetscAbsScalar(on_rows) > 1e-3); /* or the comparison would say nothing */
    near(on_rows, on_body, 1e-14);
    ok(VecDestroy(&u));
    ok(VecDestroy(&lambda));
    ok(VecDestroy(&gap));
    ok(VecDestroy(&force));
  }
  InterfaceDestroy(&interface);
}

/* What forces on the gaps do to one side: their resultant, which is along the normal, and its moment about x = 0, as the work on
   a translation and on a displacement that grows with x */
static void GetResultant(Interface *interface, PetscInt side, PetscReal *resultant, PetscReal *moment)
{
  Vec         translation, turn, lambda, force;
  PetscScalar work[2];

  SetLinearField(interface, side, 1, 0, &translation);
  SetLinearField(interface, side, 0, 1, &turn);
  ok(MatCreateVecs(interface->rows[side], &force, &lambda));
  SetAnything(lambda, 0.5);
  ok(MatMultTranspose(interface->rows[side], lambda, force));
  ok(VecDot(force, translation, &work[0]));
  ok(VecDot(force, turn, &work[1]));
  *resultant = PetscRealPart(work[0]) / 2; /* the fields have the factor 2 on the second axis */
  *moment    = PetscRealPart(work[1]) / 2;
  ok(VecDestroy(&translation));
  ok(VecDestroy(&turn));
  ok(VecDestroy(&lambda));
  ok(VecDestroy(&force));
}

static void resultant_and_moment_are_conserved(void **state)
{
  PetscReal resultant[2], moment[2];
  Interface interface;

  (void)state;
  CreateRectangles(&interface);
  for (PetscInt side = 0; side < 2; side++) GetResultant(&interface, side, &resultant[side], &moment[side]);
  assert_true(PetscAbsReal(resultant[0]) > 1e-3 && PetscAbsReal(moment[0]) > 1e-3);
  near(resultant[1], resultant[0], 1e-14);
  near(moment[1], moment[0], 1e-14);
  InterfaceDestroy(&interface);
}

static void dimensions_must_agree(void **state)
{
  DM       dm[] = {CreateBoxMesh("line", 1, "4", "0", "1", PETSC_TRUE), CreateBoxMesh("rectangle", 2, "2,2", "0,0", "1,1", PETSC_FALSE)};
  Surface  surface[2];
  Transfer transfer;

  (void)state;
  for (PetscInt i = 0; i < 2; i++) ok(SurfaceCreate(dm[i], NULL, &surface[i]));
  refused(PETSC_ERR_USER_INPUT, "1 and 2 dimensions", TransferCreate(PETSC_COMM_WORLD, surface[0], surface[1], &transfer));
  ok(TransferDestroy(&transfer));
  for (PetscInt i = 0; i < 2; i++) {
    ok(SurfaceDestroy(&surface[i]));
    ok(DMDestroy(&dm[i]));
  }
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(bars_that_face_each_other),
      simulation_test(overlap_is_a_negative_gap),
      simulation_test(surfaces_that_do_not_face_each_other),
      simulation_test(rows_of_segments),
      simulation_test(constants_and_linear_fields_are_reproduced),
      simulation_test(transposes_are_adjoint),
      simulation_test(resultant_and_moment_are_conserved),
      simulation_test(dimensions_must_agree),
  };

  return impakt_main(argc, argv, tests);
}
