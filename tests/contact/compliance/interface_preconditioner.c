/* What preconditions S, the operator from contact forces to gaps, where it is only multiplied with. */
#include "operators.h"

static const InterfaceSettings plain          = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 0};
static const InterfaceSettings preconditioned = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 0, .precondition = PETSC_TRUE};
static const InterfaceSettings enough         = {
    .prefix = "operator_", .tolerance = 1e-14, .enough = 1e-6, .dense_limit = 0, .precondition = PETSC_TRUE};

/* Iterations of one solution for forces of some N, which close gaps of some m, on all rows or on those with odd numbers */
static PetscInt solve(InterfaceOperator op, const Contact contact, PetscBool some, PetscReal tolerance)
{
  const PetscInt before = (PetscInt)contact->counts.inner_iterations;
  PetscScalar    x[MOST_ROWS], gap[MOST_ROWS], found[MOST_ROWS] = {0};
  PetscBool      in[MOST_ROWS];

  for (PetscInt i = 0; i < contact->rows.n; i++) {
    in[i] = (PetscBool)(!some || (contact->rows.begin + i) % 2);
    x[i]  = in[i] ? force_on(contact->rows.begin + i) : 0;
  }
  ok(InterfaceOperatorFactor(op, in, NULL));
  ok(InterfaceOperatorMultiply(op, INTERFACE_GAP, x, gap));
  ok(InterfaceOperatorSolve(op, gap, found));
  for (PetscInt i = 0; i < contact->rows.n; i++) near(found[i], x[i], tolerance);
  return (PetscInt)contact->counts.inner_iterations - before;
}

/* All rows become longer, each by another factor */
static void scale_rows(const Contact contact)
{
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat          B;
    Vec          factors;
    PetscScalar *values;

    ok(BodyGetComplianceMatrices(contact->bodies[b], NULL, &B));
    ok(MatCreateVecs(B, NULL, &factors));
    ok(VecGetArrayWrite(factors, &values));
    for (PetscInt i = 0; i < contact->body_rows[b].n; i++) values[i] = 1 + (contact->rows.begin + contact->body_rows[b].rows[i]);
    ok(VecRestoreArrayWrite(factors, &values));
    ok(MatDiagonalScale(B, factors, NULL));
    ok(VecDestroy(&factors));
  }
}

/* The implicit block is four elements deep and the other one answers by its layer, so that all of both is near enough to the surface: what
   preconditions is the inverse but for springs of 10^-4 of the compliance of a row. Conjugate gradients leave 10^-14 then in four
   iterations, where some rows are left out in a few more, and stop when they are asked for less. So they do when rows have got new entries.
 */
static void preconditioned_by_both_sides(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op[2];
  Contact           contact;
  PetscInt          most, iterations, fewer;

  create_blocks(simulation);
  contact = simulation->contact;
  op[0]   = set_up_operator(simulation, &plain, PETSC_FALSE);
  op[1]   = set_up_operator(simulation, &preconditioned, PETSC_FALSE);
  assert_false(InterfaceOperatorHasPreconditioner(op[0]));
  assert_true(InterfaceOperatorHasPreconditioner(op[1]));
  most       = solve(op[0], contact, PETSC_FALSE, 1e-10);
  iterations = solve(op[1], contact, PETSC_FALSE, 1e-10);
  between(most, contact->rows.n_all - 1, 20);
  between(iterations, 3, 4);
  between(solve(op[1], contact, PETSC_TRUE, 1e-10), 3, 6);
  scale_rows(contact);
  assert_int_equal(solve(op[1], contact, PETSC_FALSE, 1e-10), iterations);
  ok(InterfaceOperatorDestroy(&op[0]));
  op[0] = set_up_operator(simulation, &enough, PETSC_FALSE);
  fewer = solve(op[0], contact, PETSC_FALSE, 1e-3);
  between(fewer, 1, iterations - 1);
  for (PetscInt k = 0; k < 2; k++) ok(InterfaceOperatorDestroy(&op[k]));
}

/* What preconditions is symmetric and positive on the rows that are chosen, and leaves others as they are */
static void preconditioner_is_symmetric(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op;
  Contact           contact;
  PetscReal         columns[MOST_ROWS][MOST_ROWS] = {{0}}; /* of all ranks, the same on each */
  PetscBool         in[MOST_ROWS];

  create_blocks(simulation);
  contact = simulation->contact;
  op      = set_up_operator(simulation, &preconditioned, PETSC_FALSE);
  for (PetscInt i = 0; i < contact->rows.n; i++) in[i] = (PetscBool)(contact->rows.begin + i != 1);
  ok(InterfaceOperatorChoose(op, in));
  for (PetscInt c = 0; c < contact->rows.n_all; c++) {
    PetscScalar x[MOST_ROWS], y[MOST_ROWS];

    for (PetscInt i = 0; i < contact->rows.n; i++) {
      x[i] = contact->rows.begin + i == c ? 1 : 0;
      y[i] = -7;
    }
    ok(InterfaceOperatorPrecondition(op, x, y));
    for (PetscInt i = 0; i < contact->rows.n; i++) columns[c][contact->rows.begin + i] = PetscRealPart(y[i]);
    ok(InterfaceOperatorSum(op, MOST_ROWS, columns[c]));
  }
  for (PetscInt c = 0; c < contact->rows.n_all; c++) {
    if (c == 1) continue;
    assert_true(columns[c][c] > 0);
    near(columns[c][1], -7, 0);
    for (PetscInt i = 0; i < c; i++)
      if (i != 1) near(columns[c][i], columns[i][c], 1e-9 * columns[c][c]);
  }
  ok(InterfaceOperatorDestroy(&op));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(preconditioned_by_both_sides),
      simulation_test(preconditioner_is_symmetric),
  };

  return impakt_main(argc, argv, tests);
}
