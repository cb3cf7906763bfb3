/* ranks: 1 2 */
/* A controller step of a nonlinear body that is made again from the saved state ends with the same bits, whatever has been tried in
   between. The body turns by more than a right angle, on which the factors of its undeformed massless layer do not serve. Not on three
   ranks, where the sums over a node's elements on several ranks come in any order. */
#include "solid_bodies.h"

#define STEP 0.05
/* waves run at 1.4 m/s; the corners, 1.25 m from the centre, move at 0.25 m/s, which stretches the body by some 2 % */
#define SPIN  0.2
#define STEPS 180 /* 1.8 rad */
#define BLOCK                                                                                                                              \
  "-density 3 -youngs_modulus 5 -poissons_ratio 0.2 -material_type neo_hookean -dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,3 "  \
  "-dm_plex_box_upper 2,1.5 "
static const PetscReal row_nodes[] = {0.5, 1.5, 0, 1, 1.5, 0}, row_directions[] = {0, 1, 0, 0.6, 0.8, 0};
#define ROWS 2

static PetscErrorCode Spinning(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)dim;
  (void)ctx;
  u[0] = u[1] = 0;
  v[0]        = -SPIN * (x[1] - 0.75);
  v[1]        = SPIN * (x[0] - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state at the end of a controller step */
typedef struct {
  Vec vecs[3];
} End;

static void create_end(Body body, End *end)
{
  for (PetscInt i = 0; i < 3; i++) ok(BodyCreateVec(body, &end->vecs[i]));
}

static void note_end(Body body, End *end)
{
  Vec now[3];

  ok(BodyGetSolution(body, &now[0], &now[1], &now[2]));
  for (PetscInt i = 0; i < 3; i++) ok(VecCopy(now[i], end->vecs[i]));
}

static void expect_same(Body body, const End *end, PetscInt step, const char after[])
{
  Vec now[3];

  ok(BodyGetSolution(body, &now[0], &now[1], &now[2]));
  for (PetscInt i = 0; i < 3; i++) {
    const PetscScalar *a, *b;
    PetscInt           n;
    int                differ;

    ok(VecGetLocalSize(now[i], &n));
    ok(VecGetArrayRead(now[i], &a));
    ok(VecGetArrayRead(end->vecs[i], &b));
    differ = memcmp(a, b, n * sizeof(*a)) != 0;
    ok(VecRestoreArrayRead(end->vecs[i], &b));
    ok(VecRestoreArrayRead(now[i], &a));
    if (differ) print_error("step %d, after %s: vector %d of u, v, a differs\n", (int)step, after, (int)i);
    assert_false(differ);
  }
}

/* Forces on the contact nodes that follow no pattern, and turn with nothing */
static void load(const NodeRows *rows, const BodyTraces *traces, PetscInt substeps, PetscInt step, PetscReal scale)
{
  for (PetscInt level = 0; level <= substeps; level++)
    for (PetscInt i = 0; i < ROWS; i++)
      set_row(rows, traces->force_in, level, i, scale * PetscSinReal(0.3 * (step + (PetscReal)level / substeps) + i));
}

/* How far the line from the corner at the origin to the one at (2, 0) has turned [rad] */
static PetscReal turned(Body body)
{
  const PetscScalar *x, *u;
  PetscReal          ends[2][2] = {{0}};
  PetscInt           n;
  Vec                positions, displacement;

  ok(BodyGetReferencePositions(body, &positions));
  ok(BodyGetSolution(body, &displacement, NULL, NULL));
  ok(VecGetLocalSize(positions, &n));
  ok(VecGetArrayRead(positions, &x));
  ok(VecGetArrayRead(displacement, &u));
  for (PetscInt i = 0; i < n; i += 2)
    for (PetscInt end = 0; end < 2; end++)
      if (PetscAbsReal(x[i] - 2 * end) + PetscAbsReal(x[i + 1]) < 1e-9)
        for (PetscInt d = 0; d < 2; d++) ends[end][d] = x[i + d] + u[i + d];
  ok(VecRestoreArrayRead(displacement, &u));
  ok(VecRestoreArrayRead(positions, &x));
  for (PetscInt end = 0; end < 2; end++)
    for (PetscInt d = 0; d < 2; d++) ends[end][d] = sum_over_ranks(ends[end][d]);
  return PetscAtan2Real(ends[1][1] - ends[0][1], ends[1][0] - ends[0][0]);
}

static void check(const char integrator[], const char more[], PetscInt substeps, PetscInt steps)
{
  Body         body;
  BodyTraces   traces;
  NodeRows     rows;
  End          end;
  PetscBool    free_rows;
  PetscScalar  free_displacement[ROWS];
  PetscOptions options = solid_body_create(&body, BLOCK "-ts_type %s -ts_time_step %.17g %s", integrator, STEP / substeps, more);

  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, STEP));
  set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
  ok(BodySetUp(body));
  ok(BodyGetTraces(body, &traces));
  ok(BodyHasFreeRows(body, &free_rows));
  ok(BodySetInitialState(body, Spinning, NULL));
  condition_rows(body, &rows, BODY_FORCED);
  create_end(body, &end);
  for (PetscInt k = 0; k < steps; k++) {
    load(&rows, &traces, substeps, k, 1e-3);
    ok(BodyIntegrate(body));
    note_end(body, &end);
    ok(BodyIntegrate(body));
    expect_same(body, &end, k, "the same");
    load(&rows, &traces, substeps, k, 5e-2);
    ok(BodyIntegrate(body));
    if (free_rows) ok(BodyComputeFreeRows(body, free_displacement));
    ok(BodyRestore(body));
    if (free_rows) ok(BodyComputeFreeRows(body, free_displacement));
    load(&rows, &traces, substeps, k, 1e-3);
    ok(BodyIntegrate(body));
    expect_same(body, &end, k, "another load");
    ok(BodySave(body));
  }
  between(turned(body), 0.9 * SPIN * STEP * steps, 1.1 * SPIN * STEP * steps); /* it stretches, and turns a little slower for that */
  for (PetscInt i = 0; i < 3; i++) ok(VecDestroy(&end.vecs[i]));
  bar_destroy(&body, options);
}

/* One substep, and more, in the course of which the layer's matrix may become stale */
static void explicit_bodies_repeat_as_they_turn(void **state)
{
  (void)state;
  check(TSCENTRALDIFFERENCE, "", 1, STEPS);
  check(TSCENTRALDIFFERENCE, "", 3, STEPS);
  check(TSCENTRALDIFFERENCE, "-damping_stiffness 0.01", 3, STEPS / 2);
}

static void implicit_bodies_repeat_as_they_turn(void **state)
{
  (void)state;
  check(TSALPHA2, "", 1, STEPS);
  check(TSALPHA2, "", 3, STEPS / 6);
  check(TSALPHA2, "-snes_lag_jacobian 2", 1, STEPS / 6);
  check(TSALPHA2, "-damping_stiffness 0.01", 1, STEPS);
}

/* Then the first iteration of a step would have the Jacobian of whatever was tried before */
static void a_lag_from_step_to_step_is_refused(void **state)
{
  static const char *const options[] = {"snes_lag_jacobian_persists", "snes_lag_preconditioner_persists"};

  (void)state;
  for (PetscInt i = 0; i < 2; i++) {
    Body         body;
    char         words[128];
    PetscOptions database = solid_body_create(&body, BLOCK "-%s", options[i]);

    (void)snprintf(words, sizeof(words), "-b_%s|-b_snes_lag_jacobian alone", options[i]);
    ok(BodySetControllerStep(body, 0, STEP));
    refused(PETSC_ERR_USER_INPUT, words, BodySetUp(body));
    ok(BodyDestroy(&body));
    options_drop(database);
  }
}

/* A step, in between perhaps another that is taken back, and the next step */
static BodyMeasures two_steps(const char integrator[], PetscBool tries)
{
  Body         body;
  BodyTraces   traces;
  BodyMeasures kept = {0}, other = {0}, back = {0}, end = {0};
  NodeRows     rows;
  PetscOptions options = solid_body_create(&body,
                                           BLOCK "-ts_type %s -ts_time_step %.17g -gravity 0.3,-0.2 "
                                                 "-boundary_displacement ymin -boundary_displacement_ymin 0,0.1*t "
                                                 "-damping_mass 0.1 -damping_stiffness 0.01",
                                           integrator, STEP / 3);

  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, STEP));
  set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
  ok(BodySetUp(body));
  ok(BodyGetTraces(body, &traces));
  condition_rows(body, &rows, BODY_FORCED);
  load(&rows, &traces, 3, 0, 1e-2);
  ok(BodyIntegrate(body));
  if (tries) {
    ok(BodyGetMeasures(body, &kept));
    ok(BodyKeep(body));
    load(&rows, &traces, 3, 0, 1);
    ok(BodyIntegrate(body));
    ok(BodyGetMeasures(body, &other));
    assert_true(other.external_work != kept.external_work && other.damping_work != kept.damping_work);
    ok(BodyReinstate(body));
    ok(BodyGetMeasures(body, &back));
    assert_memory_equal(&back, &kept, sizeof(kept));
  }
  ok(BodySave(body));
  load(&rows, &traces, 3, 1, 1e-2);
  ok(BodyIntegrate(body));
  ok(BodyGetMeasures(body, &end));
  bar_destroy(&body, options);
  return end;
}

/* The work of loads and what dashpots take is part of the state that BodyKeep() puts aside: with several substeps, it is counted while they
 * are made */
static void what_is_kept_comes_back_with_its_work(void **state)
{
  static const char *const integrators[] = {TSALPHA2, TSCENTRALDIFFERENCE};
  PetscMPIInt              size;

  (void)state;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  for (PetscInt i = 0; i < 2; i++) {
    const BodyMeasures straight = two_steps(integrators[i], PETSC_FALSE), tried = two_steps(integrators[i], PETSC_TRUE);

    assert_true(straight.external_work != 0 && straight.damping_work > 0);
    if (size <= 2) assert_memory_equal(&tried, &straight, sizeof(tried));
    /* PETSc adds what comes from two other ranks to the matrices of the two bodies as it comes */
    near(tried.external_work, straight.external_work, 1e-14);
    near(tried.kinetic, straight.kinetic, 1e-14);
    near(tried.potential, straight.potential, 1e-14);
  }
}

/* Rows may be asked for again and again before the step is complete: it ends as if it had been made once, under the last loads. The balance
   of a nonlinear layer is found to 1e-12 of what it moves by. */
static void a_step_is_completed_once(void **state)
{
  static const char *const materials[] = {"", "-material_type linear_elastic -damping_stiffness 0.01"};

  (void)state;
  for (PetscInt m = 0; m < 2; m++) {
    Body         body;
    BodyTraces   traces;
    NodeRows     rows;
    End          end;
    PetscScalar *row, displacement[ROWS], velocity[ROWS];
    Vec          now[3];
    PetscInt     local;
    PetscOptions options = solid_body_create(&body, BLOCK "-ts_type centraldifference -gravity 0.3,-0.2 %s", materials[m]);

    touch_side(body, "ymax");
    ok(BodySetControllerStep(body, 0, STEP));
    set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
    ok(BodySetUp(body));
    ok(BodyGetTraces(body, &traces));
    ok(TraceGetSizes(traces.displacement, &local, NULL));
    ok(BodySetInitialState(body, Spinning, NULL));
    condition_rows(body, &rows, BODY_FORCED);
    create_end(body, &end);
    for (PetscInt k = 0; k < 3; k++) {
      load(&rows, &traces, 1, k, 1e-3);
      ok(BodyIntegrate(body));
      assert_false(body->state.incomplete);
      note_end(body, &end);
      ok(BodyRestore(body));
      load(&rows, &traces, 1, k, 5e-2);
      ok(BodyTryIntegrateRows(body, NULL));
      assert_true(body->state.incomplete);
      ok(BodyKeep(body));
      load(&rows, &traces, 1, k, 1e-3);
      ok(BodyTryIntegrateRows(body, NULL));
      ok(TraceGetLevel(traces.displacement, 1, &row));
      ok(PetscArraycpy(displacement, row, local));
      ok(TraceGetLevel(traces.velocity, 1, &row));
      ok(PetscArraycpy(velocity, row, local));
      if (k == 2) { /* what has been put aside is completed as well */
        ok(BodyReinstate(body));
        assert_true(body->state.incomplete);
        load(&rows, &traces, 1, k, 5e-2);
        ok(BodyCompleteStep(body, NULL));
        assert_false(body->state.incomplete);
        load(&rows, &traces, 1, k, 1e-3);
        ok(BodyRestore(body));
        ok(BodyTryIntegrateRows(body, NULL));
      }
      ok(BodyCompleteStep(body, NULL));
      assert_false(body->state.incomplete);
      ok(BodyGetSolution(body, &now[0], &now[1], &now[2]));
      for (PetscInt i = 0; i < 3; i++) {
        PetscReal differ, size;

        ok(VecNorm(end.vecs[i], NORM_2, &size));
        ok(VecAXPY(end.vecs[i], -1, now[i]));
        ok(VecNorm(end.vecs[i], NORM_2, &differ));
        between(differ, 0, 1e-11 * size);
      }
      ok(TraceGetLevel(traces.displacement, 1, &row));
      for (PetscInt i = 0; i < local; i++) near(displacement[i], row[i], 1e-13);
      ok(TraceGetLevel(traces.velocity, 1, &row));
      for (PetscInt i = 0; i < local; i++) near(velocity[i], row[i], 1e-12);
      ok(BodySave(body));
    }
    for (PetscInt i = 0; i < 3; i++) ok(VecDestroy(&end.vecs[i]));
    bar_destroy(&body, options);
  }
}

/* What the rows of this rank do under loads of a scale, asked for as in sweeps */
static void sweep(Body body, const NodeRows *rows, const BodyTraces *traces, PetscReal scale, PetscScalar displacement[])
{
  PetscScalar *row;

  load(rows, traces, 1, 1, scale);
  ok(BodyTryIntegrateRows(body, NULL));
  ok(TraceGetLevel(traces->displacement, 1, &row));
  ok(PetscArraycpy(displacement, row, rows->local));
}

/* A linear explicit body whose rows are on a massless layer, and take forces */
static PetscOptions layered_body_create(Body *made, BodyTraces *traces, NodeRows *rows)
{
  PetscOptions options = solid_body_create(made, BLOCK "-ts_type centraldifference -material_type linear_elastic");
  Body         body    = *made;

  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, STEP));
  set_node_rows(body, ROWS, row_nodes, row_directions, rows);
  ok(BodySetUp(body));
  ok(BodyGetTraces(body, traces));
  ok(BodySetInitialState(body, Spinning, NULL));
  condition_rows(body, rows, BODY_FORCED);
  return options;
}

/* A layer that has been told where it gets under a change of forces goes there, be it true or not, if forces change so on all ranks;
   else it finds out itself */
static void an_answer_that_is_told_is_taken(void **state)
{
  Body         body;
  BodyTraces   traces;
  NodeRows     rows;
  PetscScalar *row, before[ROWS], after[ROWS], other[ROWS], told[ROWS], change[ROWS], *answer;
  Vec          u, from;
  PetscOptions options = layered_body_create(&body, &traces, &rows);

  (void)state;
  ok(BodyGetSolution(body, &u, NULL, NULL));
  ok(VecDuplicate(u, &from));
  ok(PetscMalloc1(body->layer.n_dofs, &answer));
  sweep(body, &rows, &traces, 1e-3, before);
  ok(VecCopy(u, from));
  ok(TraceGetLevel(traces.force_in, 1, &row));
  for (PetscInt i = 0; i < rows.local; i++) change[i] = -row[i];
  sweep(body, &rows, &traces, 3e-3, after);
  for (PetscInt i = 0; i < rows.local; i++) change[i] += row[i];
  ok(VecAXPY(from, -1, u));
  {
    const PetscScalar *moved;

    ok(VecGetArrayRead(from, &moved)); /* twice as far as it does */
    for (PetscInt i = 0; i < body->layer.n_dofs; i++) answer[i] = -2 * moved[body->layer.dofs[i]];
    ok(VecRestoreArrayRead(from, &moved));
  }
  sweep(body, &rows, &traces, 5e-3, other);
  for (PetscInt expected = 0; expected < 2; expected++) {
    sweep(body, &rows, &traces, 1e-3, told);
    ok(BodyExpectRepeat(body, change, answer));
    sweep(body, &rows, &traces, expected ? 3e-3 : 5e-3, told);
    for (PetscInt i = 0; i < rows.local; i++) {
      const PetscScalar should = expected ? before[i] + 2 * (after[i] - before[i]) : other[i];

      assert_true(PetscAbsScalar(after[i] - before[i]) > 1e-5);
      near(told[i], should, 1e-14);
    }
  }
  sweep(body, &rows, &traces, 1e-3, told); /* it counts once */
  sweep(body, &rows, &traces, 3e-3, told);
  for (PetscInt i = 0; i < rows.local; i++) near(told[i], after[i], 1e-14);
  ok(PetscFree(answer));
  ok(VecDestroy(&from));
  bar_destroy(&body, options);
}

/* A layer that is left off balance tells what it lacks: the solution with its stiffness, told back, takes it where it gets by itself, and
   so does another integration that is told nothing */
static void a_layer_that_is_left_gets_into_balance(void **state)
{
  Body         body;
  BodyTraces   traces;
  NodeRows     rows;
  PetscScalar  alone[ROWS], left[ROWS], back[ROWS], change[ROWS] = {0}, *missing;
  Mat          K;
  KSP          ksp;
  Vec          lacks, moves;
  PetscOptions options = layered_body_create(&body, &traces, &rows);

  (void)state;
  sweep(body, &rows, &traces, 1e-3, alone);
  ok(BodyGetLayerMatrices(body, &K, NULL));
  ok(MatCreateVecs(K, &moves, &lacks));
  ok(KSPCreate(PETSC_COMM_WORLD, &ksp));
  ok(KSPSetOperators(ksp, K, K));
  ok(KSPSetTolerances(ksp, 1e-14, PETSC_DEFAULT, PETSC_DEFAULT, 10000));
  for (PetscInt told = 0; told < 2; told++) {
    PetscReal norm;

    ok(BodyRestore(body));
    ok(BodyLeaveLayer(body));
    sweep(body, &rows, &traces, 1e-3, left);
    for (PetscInt i = 0; i < rows.local; i++) assert_true(PetscAbsScalar(left[i] - alone[i]) > 1e-8);
    ok(VecGetArrayWrite(lacks, &missing));
    ok(BodyGetLayerMissing(body, missing));
    ok(VecRestoreArrayWrite(lacks, &missing));
    ok(VecNorm(lacks, NORM_2, &norm));
    assert_true(norm > 0);
    ok(KSPSolve(ksp, lacks, moves));
    if (told) {
      const PetscScalar *array;

      ok(VecGetArrayRead(moves, &array));
      ok(BodyExpectRepeat(body, change, array));
      ok(VecRestoreArrayRead(moves, &array));
    }
    sweep(body, &rows, &traces, 1e-3, back);
    for (PetscInt i = 0; i < rows.local; i++) near(back[i], alone[i], 1e-12);
    ok(VecGetArrayWrite(lacks, &missing));
    ok(BodyGetLayerMissing(body, missing));
    ok(VecRestoreArrayWrite(lacks, &missing));
    ok(VecNorm(lacks, NORM_2, &norm));
    assert_true(norm == 0);
    ok(BodyCompleteStep(body, NULL));
  }
  ok(KSPDestroy(&ksp));
  ok(VecDestroy(&lacks));
  ok(VecDestroy(&moves));
  bar_destroy(&body, options);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(explicit_bodies_repeat_as_they_turn),    cmocka_unit_test(implicit_bodies_repeat_as_they_turn),
      cmocka_unit_test(what_is_kept_comes_back_with_its_work),  cmocka_unit_test(a_step_is_completed_once),
      cmocka_unit_test(a_lag_from_step_to_step_is_refused),     cmocka_unit_test(an_answer_that_is_told_is_taken),
      cmocka_unit_test(a_layer_that_is_left_gets_into_balance),
  };

  return impakt_main(argc, argv, tests);
}
