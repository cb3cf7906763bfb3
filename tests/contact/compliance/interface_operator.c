/* S, the operator from contact forces to gaps: dense and by products alone, whole and in part, and when it changes from one to the other.
 */
#include "operators.h"

static const InterfaceSettings dense     = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 100, .few = 100};
static const InterfaceSettings iterative = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 0};
static const InterfaceSettings sparse    = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 0, .direct = PETSC_TRUE};
static const InterfaceSettings chooses   = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 100, .few = 0};

static void fill(const Contact contact, PetscScalar x[])
{
  for (PetscInt i = 0; i < contact->rows.n; i++) x[i] = force_on(contact->rows.begin + i);
}

/* Forces of some N bring some m: round-off, and what conjugate gradients leave */
static void products_are_the_same(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op[2];
  Contact           contact;

  create_blocks(simulation);
  contact = simulation->contact;
  for (PetscInt leave = 0; leave < 2; leave++) {
    PetscScalar x[MOST_ROWS], gap[MOST_ROWS], side[2][MOST_ROWS], other[MOST_ROWS];

    op[0] = set_up_operator(simulation, &dense, (PetscBool)leave);
    op[1] = set_up_operator(simulation, &iterative, (PetscBool)leave);
    fill(contact, x);
    for (PetscInt map = 0; map < 4; map++) {
      ok(InterfaceOperatorMultiply(op[0], (InterfaceMap)map, x, gap));
      ok(InterfaceOperatorMultiply(op[1], (InterfaceMap)map, x, other));
      for (PetscInt i = 0; i < contact->rows.n; i++) {
        near(gap[i], other[i], 1e-12);
        if (leave && contact->rows.begin + i == contact->rows.n_all - 1) near(gap[i], 0, 0);
        else assert_true(gap[i] != 0 || map == INTERFACE_NEUMANN_DIRICHLET); /* where both sides are apart */
      }
    }
    /* the gap is what both sides do, the Dirichlet side under forces against it, the other one under what is left of S */
    ok(InterfaceOperatorMultiply(op[0], INTERFACE_GAP, x, gap));
    ok(InterfaceOperatorMultiply(op[0], INTERFACE_DIRICHLET, x, side[0]));
    ok(InterfaceOperatorMultiply(op[0], INTERFACE_NEUMANN_GAP, x, side[1]));
    for (PetscInt i = 0; i < contact->rows.n; i++) near(gap[i], side[0][i] - side[1][i], 1e-13);
    for (PetscInt k = 0; k < 2; k++) ok(InterfaceOperatorDestroy(&op[k]));
  }
}

/* With springs on the diagonal, and rows that are taken out for the time being */
static void solutions_are_the_same(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Contact     contact;

  create_blocks(simulation);
  contact = simulation->contact;
  for (PetscInt which = 0; which < 2; which++) {
    InterfaceOperator op = set_up_operator(simulation, which ? &iterative : &dense, PETSC_FALSE);
    PetscScalar       x[MOST_ROWS], gap[MOST_ROWS], found[MOST_ROWS] = {0};
    PetscReal         springs[MOST_ROWS];
    PetscBool         in[MOST_ROWS];

    for (PetscInt some = 0; some < 2; some++) {
      for (PetscInt i = 0; i < contact->rows.n; i++) {
        in[i]      = (PetscBool)(!some || (contact->rows.begin + i) % 2);
        springs[i] = some ? 0.3 + 0.1 * i : 0;
        x[i]       = in[i] ? force_on(contact->rows.begin + i) : 0;
      }
      ok(InterfaceOperatorMultiply(op, INTERFACE_GAP, x, gap));
      for (PetscInt i = 0; i < contact->rows.n; i++) gap[i] += springs[i] * x[i];
      ok(InterfaceOperatorFactor(op, some ? in : NULL, some ? springs : NULL));
      ok(InterfaceOperatorSolve(op, gap, found));
      for (PetscInt i = 0; i < contact->rows.n; i++) near(found[i], x[i], 1e-10);
    }
    ok(InterfaceOperatorDestroy(&op));
  }
}

/* Where both bodies have massless layers, sparse factors take over from conjugate gradients after three solutions for the same rows; other
   rows, springs, and another layer begin anew */
static void sparse_factors_solve_the_same(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op;
  Contact           contact;
  Mat               K;

  AddOptions("-a_ts_type centraldifference");
  create_blocks(simulation);
  contact = simulation->contact;
  ok(BodyGetLayerMatrices(contact->bodies[0], &K, NULL));
  assert_non_null(K);
  op = set_up_operator(simulation, &sparse, PETSC_FALSE);
  for (PetscInt round = 0; round < 4; round++) { /* all rows, with and without springs; some of them; with the first layer made anew */
    PetscScalar x[MOST_ROWS], gap[MOST_ROWS];
    PetscReal   springs[MOST_ROWS];
    PetscBool   in[MOST_ROWS];

    for (PetscInt i = 0; i < contact->rows.n; i++) {
      in[i]      = (PetscBool)(round < 2 || (contact->rows.begin + i) % 2);
      springs[i] = round ? 0.3 + 0.1 * i : 0;
      x[i]       = in[i] ? force_on(contact->rows.begin + i) : 0;
    }
    ok(InterfaceOperatorMultiply(op, INTERFACE_GAP, x, gap));
    for (PetscInt i = 0; i < contact->rows.n; i++) gap[i] += springs[i] * x[i];
    if (round < 3) ok(InterfaceOperatorFactor(op, in, springs));
    else ok(PetscObjectStateIncrease((PetscObject)K));
    for (PetscInt time = 0; time < 5; time++) {
      const PetscInt before           = contact->counts.inner_iterations;
      PetscScalar    found[MOST_ROWS] = {0};

      ok(InterfaceOperatorSolve(op, gap, found));
      assert_int_equal(contact->counts.inner_iterations > before, time < 3);
      for (PetscInt i = 0; i < contact->rows.n; i++) near(found[i], x[i], 1e-10);
    }
  }
  ok(InterfaceOperatorDestroy(&op));
}

/* Rows are dense once iterations have cost as much as columns and factors would, and never before; solutions stay what they are */
static void becomes_dense_when_that_has_paid(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op;
  Contact           contact;
  PetscScalar       gap[MOST_ROWS], first[MOST_ROWS], found[MOST_ROWS] = {0};
  InterfaceMark     marks[MOST_ROWS];
  PetscBool         is_dense;
  PetscInt          solutions = 0;

  create_blocks(simulation);
  contact = simulation->contact;
  fill(contact, gap);
  op = set_up_operator(simulation, &chooses, PETSC_FALSE);
  InterfaceOperatorGetRows(op, NULL, NULL, &is_dense);
  assert_false(is_dense);
  ok(InterfaceOperatorSolve(op, gap, first));
  while (!InterfaceOperatorWantsDense(op) && solutions < 100) {
    ok(InterfaceOperatorSolve(op, gap, found));
    solutions++;
  }
  /* a column for each row costs as one iteration does, and an iteration closes one gap at least */
  between(solutions, 0, 3);
  for (PetscInt i = 0; i < contact->rows.n; i++) marks[i] = INTERFACE_SOLVED;
  ok(InterfaceOperatorSetRows(op, marks, 1));
  InterfaceOperatorGetRows(op, NULL, NULL, &is_dense);
  assert_true(is_dense);
  assert_false(InterfaceOperatorWantsDense(op));
  ok(InterfaceOperatorSolve(op, gap, found));
  for (PetscInt i = 0; i < contact->rows.n; i++) near(found[i], first[i], 1e-10);
  ok(InterfaceOperatorDestroy(&op));
}

/* A method may give S itself: a diagonal with one pair of other entries, which two rows of the same rank or of different ones have */
static void may_be_a_sparse_matrix(void **state)
{
  Simulation *simulation = (Simulation *)*state;
  Contact     contact;
  Mat         S;

  create_blocks(simulation);
  contact = simulation->contact;
  ok(MatCreateAIJ(PETSC_COMM_WORLD, contact->rows.n, contact->rows.n, contact->rows.n_all, contact->rows.n_all, 2, NULL, 2, NULL, &S));
  for (PetscInt i = contact->rows.begin; i < contact->rows.begin + contact->rows.n; i++) {
    ok(MatSetValue(S, i, i, 2 + i, INSERT_VALUES));
    if (i == 0) ok(MatSetValue(S, i, contact->rows.n_all - 1, 1, INSERT_VALUES));
    if (i == contact->rows.n_all - 1) ok(MatSetValue(S, i, 0, 1, INSERT_VALUES));
  }
  ok(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
  for (PetscInt which = 0; which < 2; which++) {
    InterfaceOperator op;
    InterfaceMark     marks[MOST_ROWS];
    PetscScalar       gap[MOST_ROWS], found[MOST_ROWS] = {0};

    ok(InterfaceOperatorCreate(contact, which ? &iterative : &dense, &op));
    ok(InterfaceOperatorSetMatrix(op, S));
    for (PetscInt i = 0; i < contact->rows.n; i++) {
      const PetscInt row = contact->rows.begin + i, last = contact->rows.n_all - 1;

      marks[i] = INTERFACE_SOLVED;
      gap[i]   = (2 + row) * force_on(row) + (row == 0 ? force_on(last) : row == last ? force_on(0) : 0);
    }
    ok(InterfaceOperatorSetRows(op, marks, 1));
    ok(InterfaceOperatorSolve(op, gap, found));
    for (PetscInt i = 0; i < contact->rows.n; i++) near(found[i], force_on(contact->rows.begin + i), 1e-12);
    ok(InterfaceOperatorDestroy(&op));
    assert_null(op);
  }
  ok(MatDestroy(&S));
}

/* Blocks in a line, each pressed by its neighbours: sparse factors of one group with more rows than may be
   dense give the forces that dense ones give: all, without those of one pair, with springs */
static void many_bodies_have_sparse_factors(void **state)
{
  static const InterfaceSettings wholes  = {.prefix = "operator_", .tolerance = 1e-14, .dense_limit = 1000, .few = 1000};
  static const InterfaceSettings sparses = {
      .prefix = "operator_", .tolerance = 1e-14, .dense_limit = 10, .few = 0, .at_once = 100, .sparse = PETSC_TRUE};
  Simulation       *simulation = (Simulation *)*state;
  const PetscInt    n_blocks   = 40;
  Contact           contact;
  InterfaceOperator whole, many;
  InterfaceMark    *marks;
  PetscScalar      *gap, *expected, *found;
  PetscReal        *springs;
  PetscBool        *in, is_dense;
  char              options[8192] = "-time_step 0.04 -time_end 1 -bodies ", pairs[4096] = "";
  PetscInt          n;

  for (PetscInt k = 0; k < n_blocks; k++) {
    char body[512];

    ok(PetscSNPrintf(body, sizeof(body), "%sb%d", k ? "," : "", (int)k));
    ok(PetscStrlcat(options, body, sizeof(options)));
    if (k) {
      ok(PetscSNPrintf(body, sizeof(body), "%sb%d.xmax:b%d.xmin", k > 1 ? "," : "", (int)k - 1, (int)k));
      ok(PetscStrlcat(pairs, body, sizeof(pairs)));
    }
    ok(PetscSNPrintf(body, sizeof(body),
                     "-prefix_push b%d_ -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 2,4 -dm_plex_box_lower %d,0 "
                     "-dm_plex_box_upper %d,1 -density 1 -youngs_modulus 1 -poissons_ratio 0.25 -ts_type centraldifference -prefix_pop",
                     (int)k, (int)k, (int)k + 1));
    AddOptions(body);
  }
  AddOptions(options);
  ok(PetscSNPrintf(options, sizeof(options), "-contact_pairs %s", pairs));
  AddOptions(options);
  ok(SimulationCreate(simulation));
  contact = simulation->contact;
  n       = contact->rows.n;
  ok(PetscMalloc6(n, &marks, n, &gap, n, &expected, n, &found, n, &springs, n, &in));
  for (PetscInt i = 0; i < n; i++) marks[i] = INTERFACE_SOLVED;
  ok(InterfaceOperatorCreate(contact, &wholes, &whole));
  ok(InterfaceOperatorCreate(contact, &sparses, &many));
  ok(InterfaceOperatorSetRows(whole, marks, 1));
  ok(InterfaceOperatorSetRows(many, marks, 1));
  InterfaceOperatorGetRows(many, NULL, NULL, &is_dense);
  assert_true(is_dense);
  fill(contact, gap);
  for (PetscInt round = 0; round < 3; round++) {
    PetscReal largest = 0;

    for (PetscInt i = 0; i < n; i++) {
      in[i]      = (PetscBool)(!round || contact->rows.pair[i] != 7);
      springs[i] = round == 2 ? 0.3 : 0;
    }
    ok(InterfaceOperatorFactor(whole, in, springs));
    ok(InterfaceOperatorFactor(many, in, springs));
    ok(InterfaceOperatorSolve(whole, gap, expected));
    ok(InterfaceOperatorSolve(many, gap, found));
    for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, PetscAbsScalar(expected[i]));
    for (PetscInt i = 0; i < n; i++) {
      near(found[i], expected[i], 1e-11 * largest); /* round-off, times a condition number of some hundred */
      if (!in[i]) near(found[i], 0, 0);
    }
    ok(InterfaceOperatorMultiply(many, INTERFACE_GAP, found, expected));
    for (PetscInt i = 0; i < n; i++)
      if (in[i]) near(expected[i] + springs[i] * found[i], gap[i], 1e-11 * largest);
  }
  ok(InterfaceOperatorDestroy(&whole));
  ok(InterfaceOperatorDestroy(&many));
  ok(PetscFree6(marks, gap, expected, found, springs, in));
}

/* Conjugate gradients that stop early end the run, and say what is left and what to do */
static void iterations_that_do_not_converge_are_an_error(void **state)
{
  Simulation       *simulation = (Simulation *)*state;
  InterfaceOperator op;
  PetscScalar       gap[MOST_ROWS], found[MOST_ROWS] = {0};

  create_blocks(simulation);
  AddOptions("-operator_ksp_max_it 1");
  fill(simulation->contact, gap);
  op = set_up_operator(simulation, &iterative, PETSC_FALSE);
  refused(PETSC_ERR_NOT_CONVERGED, "Conjugate gradients for the contact forces|after 1 iterations|-operator_ksp_max_it",
          InterfaceOperatorSolve(op, gap, found));
  ok(InterfaceOperatorDestroy(&op));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      simulation_test(products_are_the_same),
      simulation_test(solutions_are_the_same),
      simulation_test(sparse_factors_solve_the_same),
      simulation_test(becomes_dense_when_that_has_paid),
      simulation_test(may_be_a_sparse_matrix),
      simulation_test(many_bodies_have_sparse_factors),
      simulation_test(iterations_that_do_not_converge_are_an_error),
  };

  return impakt_main(argc, argv, tests);
}
