/* A controller step of a nonlinear body that is made again from the saved state ends with the same bits, whatever has been tried in
   between. The body turns by more than a right angle, on which the factors of its undeformed massless layer do not serve. */
#include "solid_bodies.h"
#include <impakt/private/bodyforces.h>
#include <impakt/private/bodyrows.h>
#include <impakt/private/bodystep.h>

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
  PetscOptions options = solid_body_create(&body, BLOCK "-ts_type %s -ts_time_step %.17g %s", integrator, STEP / substeps, more);

  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, STEP));
  set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
  ok(BodySetUp(body));
  ok(BodyGetTraces(body, &traces));
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
    ok(BodyRestore(body));
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

/* Forces of rows that are the same throughout the step, of this rank's rows */
static void set_constant(Body body, const NodeRows *rows, PetscInt step, PetscReal scale)
{
  PetscReal force[ROWS], last[ROWS], none[ROWS] = {0};
  PetscInt  all[ROWS];

  for (PetscInt i = 0; i < rows->local; i++) {
    last[i]  = step ? 1e-3 * PetscSinReal(step - 1 + rows->which[i]) : 0;
    force[i] = scale * PetscSinReal(step + rows->which[i]);
    all[i]   = i;
  }
  ok(BodySetConstantForces(body, rows->local, all, force, last, none));
  ok(BodyTryIntegrateRows(body, NULL));
}

/* Largest difference of u, v, a from those at an end, in parts of the largest number there */
static PetscReal difference(Body body, const End *end)
{
  PetscReal most = 0;
  Vec       now[3];

  ok(BodyGetSolution(body, &now[0], &now[1], &now[2]));
  for (PetscInt i = 0; i < 3; i++) {
    PetscReal off, size;
    Vec       change;

    ok(VecDuplicate(now[i], &change));
    ok(VecWAXPY(change, -1, end->vecs[i], now[i]));
    ok(VecNorm(change, NORM_INFINITY, &off));
    ok(VecNorm(end->vecs[i], NORM_INFINITY, &size));
    ok(VecDestroy(&change));
    most = PetscMax(most, off / size);
  }
  return most;
}

/* Nodes with mass, one substep: other constant forces move the end of the step as if it were made again, and what they have changed in the
   saved state goes back bit for bit. Round-off of three operations; internal forces amplify that of positions: measured 3e-15. */
static void check_constant_forces(const char more[])
{
  Body         body;
  NodeRows     rows;
  End          start, end;
  PetscBool    early;
  PetscOptions options = solid_body_create(&body, BLOCK "-ts_type centraldifference -ts_time_step %.17g -mass_redistribute 0 %s", STEP,
                                           more);

  touch_side(body, "ymax");
  ok(BodySetControllerStep(body, 0, STEP));
  set_node_rows(body, ROWS, row_nodes, row_directions, &rows);
  ok(BodySetUp(body));
  ok(BodySetInitialState(body, Spinning, NULL));
  condition_rows(body, &rows, BODY_FORCED);
  create_end(body, &start);
  create_end(body, &end);
  for (PetscInt k = 0; k < 20; k++) {
    note_end(body, &start);
    set_constant(body, &rows, k, 5e-2);
    early = body->state.incomplete;
    assert_true(early);
    set_constant(body, &rows, k, 1e-3);
    ok(BodyCompleteStep(body, NULL));
    note_end(body, &end);
    ok(BodyDropStartForce(body));
    expect_same(body, &start, k, "constant forces");
    set_constant(body, &rows, k, 1e-3);
    ok(BodyCompleteStep(body, NULL));
    between(difference(body, &end), 0, 1e-12);
    ok(BodySave(body));
  }
  for (PetscInt i = 0; i < 3; i++) ok(VecDestroy(&start.vecs[i]));
  for (PetscInt i = 0; i < 3; i++) ok(VecDestroy(&end.vecs[i]));
  bar_destroy(&body, options);
}

static void other_constant_forces_move_the_end_of_a_step(void **state)
{
  (void)state;
  check_constant_forces("");
  check_constant_forces("-material_type linear_elastic");
  check_constant_forces("-damping_stiffness 0.01");
  check_constant_forces("-mass_type consistent");
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

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(explicit_bodies_repeat_as_they_turn),
      cmocka_unit_test(implicit_bodies_repeat_as_they_turn),
      cmocka_unit_test(other_constant_forces_move_the_end_of_a_step),
      cmocka_unit_test(a_lag_from_step_to_step_is_refused),
  };

  return impakt_main(argc, argv, tests);
}
