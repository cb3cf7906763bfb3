/* Rotations as vectors and as matrices, a rigid body as a program makes it, and steps of TSRIGID: a function makes them, and the clock goes
 * on. */
#include "support.h"
#include <body/integrator/rigidmotion.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodystep.h>
#include <impakt/private/tssecondorder.h>

static void is_a_rotation(const PetscReal R[9])
{
  for (PetscInt i = 0; i < 3; i++)
    for (PetscInt j = 0; j < 3; j++) near(R[3 * i] * R[3 * j] + R[3 * i + 1] * R[3 * j + 1] + R[3 * i + 2] * R[3 * j + 2], i == j, 1e-15);
}

/* To the matrix and back, for angles from round-off to nearly pi, about any axis */
static void vectors_and_matrices_agree(void **state)
{
  const PetscReal angles[]  = {0, 1e-12, 1e-5, 9e-4, 1.1e-3, 0.7, 2, 3.1, 3.14159};
  const PetscReal axes[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0, -0.8}, {-2. / 3, 1. / 3, 2. / 3}};

  (void)state;
  for (size_t i = 0; i < 9; i++)
    for (size_t k = 0; k < 5; k++) {
      PetscReal v[3], R[9], back[3], rotated[3];

      for (PetscInt d = 0; d < 3; d++) v[d] = angles[i] * axes[k][d];
      RigidExponential(v, R);
      is_a_rotation(R);
      RigidMultiply(R, axes[k], rotated); /* stays */
      for (PetscInt d = 0; d < 3; d++) near(rotated[d], axes[k][d], 1e-15);
      RigidFindVector(R, back);
      for (PetscInt d = 0; d < 3; d++) near(back[d], v[d], 1e-14);
    }
}

/* Against differences of the matrix: R' = w x R */
static void spin_is_the_rate(void **state)
{
  const PetscReal v[2][3] = {{0.4, -0.9, 1.3}, {1e-4, 2e-4, -1e-4}}, rate[3] = {0.7, 0.2, -0.5}, h = 1e-6;

  (void)state;
  for (PetscInt k = 0; k < 2; k++) {
    PetscReal before[9], after[9], R[9], spin[3], ahead[3], behind[3];

    for (PetscInt d = 0; d < 3; d++) {
      ahead[d]  = v[k][d] + h * rate[d];
      behind[d] = v[k][d] - h * rate[d];
    }
    RigidExponential(v[k], R);
    RigidExponential(ahead, after);
    RigidExponential(behind, before);
    RigidSpin(v[k], rate, spin);
    for (PetscInt j = 0; j < 3; j++) {
      const PetscReal column[3] = {R[j], R[3 + j], R[6 + j]};
      PetscReal       moved[3];

      RigidCross(spin, column, moved);
      for (PetscInt i = 0; i < 3; i++) near((after[3 * i + j] - before[3 * i + j]) / (2 * h), moved[i], 1e-9);
    }
  }
}

#define BOX "-b_dm_plex_dim 2 -b_dm_plex_box_upper 2,1 -b_dm_plex_box_faces 4,2 -b_density 3 "

static Body create_body(const char more[])
{
  Body body;

  ok(PetscOptionsInsertString(NULL, BOX));
  ok(PetscOptionsInsertString(NULL, more));
  ok(BodyCreate(PETSC_COMM_WORLD, "b", &body));
  return body;
}

/* By the program in place of options; a unit square's worth of loads is refused where it is not rigid */
static void a_program_makes_one(void **state)
{
  Body         body = create_body("");
  BodyMeasures measures;
  PetscBool    rigid, led, wholly;
  PetscInt     n;
  const char  *name;
  PetscReal    mass, force[3], moment[3];

  (void)state;
  ok(BodySetRigid(body, PETSC_TRUE));
  ok(BodySetFromOptions(body));
  ok(BodyIsRigid(body, &rigid));
  assert_true(rigid);
  ok(BodyGetLed(body, &led, &wholly));
  assert_false(led);
  ok(BodySetRigidRotation(body, "0.1*t"));
  ok(BodyGetLed(body, &led, &wholly));
  assert_true(led);
  assert_false(wholly);
  ok(BodySetRigidDisplacement(body, "0,t^2/2"));
  ok(BodyGetLed(body, NULL, &wholly));
  assert_true(wholly);
  ok(BodySetControllerStep(body, 0, 0.1));
  ok(BodySetUp(body));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'b'|BodySetUp()", BodySetRigidRotation(body, "0"));
  refused(PETSC_ERR_ARG_WRONGSTATE, "'b'|BodySetUp()", BodySetRigid(body, PETSC_FALSE));
  for (PetscInt k = 0; k < 3; k++) {
    ok(BodyIntegrate(body));
    ok(BodySave(body));
  }
  ok(BodyGetMass(body, &mass));
  near(mass, 6, 1e-13);
  ok(BodyGetMeasures(body, &measures));
  near(measures.place[0], 1, 1e-13);
  near(measures.place[1], 0.5 + 0.045, 1e-13);
  near(measures.orientation[2], 0.03, 1e-13);
  near(measures.angular_velocity[2], 0.1, 1e-11);
  near(measures.potential, 0, 0);
  near(measures.kinetic, 0.5 * 6 * 0.09 + 0.5 * 6 * (4 + 1) / 12. * 0.01, 1e-10); /* m (a^2 + b^2) / 12 */
  ok(BodyGetNumReactions(body, &n));
  assert_int_equal(n, 1);
  ok(BodyGetReactionSurface(body, 0, &name));
  assert_string_equal(name, "rigid");
  ok(BodyGetReactions(body, force, moment));
  near(force[1], 6, 1e-8);
  ok(BodyDestroy(&body));
}

/* From rigid to elastic and back before the set-up: a modulus is missing then */
static void can_be_made_to_deform_again(void **state)
{
  Body      body = create_body("-b_youngs_modulus 1e6");
  PetscBool rigid, linear;

  (void)state;
  ok(BodySetRigid(body, PETSC_TRUE));
  ok(BodySetFromOptions(body));
  ok(BodyIsLinear(body, &linear));
  assert_false(linear);
  ok(BodySetRigid(body, PETSC_FALSE));
  ok(BodyIsRigid(body, &rigid));
  assert_false(rigid);
  refused(PETSC_ERR_ARG_WRONGSTATE, "'b'|BodySetRigid()", BodySetRigidDisplacement(body, "0,0"));
  ok(BodyDestroy(&body));
}

/* Both go up by what time passes */
static PetscErrorCode Advance(TS ts, PetscReal t, PetscReal dt, Vec U, Vec V, void *ctx)
{
  PetscFunctionBegin;
  (void)ts;
  *(PetscReal *)ctx = t;
  PetscCall(VecShift(U, dt));
  PetscCall(VecShift(V, 2 * dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void lets_a_function_make_steps(void **state)
{
  PetscReal t = -1, time, largest;
  TS        ts;
  Vec       u, v;

  (void)state;
  ok(VecCreateMPI(PETSC_COMM_WORLD, 2, PETSC_DETERMINE, &u));
  ok(VecDuplicate(u, &v));
  ok(TSCreate(PETSC_COMM_WORLD, &ts));
  ok(TSSetType(ts, TSRIGID));
  ok(TSSetSolution(ts, u)); /* displacements alone */
  refused(PETSC_ERR_ARG_WRONGSTATE, "TS2SetSolution()", TSSetUp(ts));
  ok(TS2SetSolution(ts, u, v));
  refused(PETSC_ERR_ARG_WRONGSTATE, "TSRigidSetAdvance()", TSSetUp(ts));
  ok(TSRigidSetAdvance(ts, Advance, &t));
  ok(TSSetMaxTime(ts, 1e300));
  ok(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  ok(TSSetUp(ts));
  ok(TSSecondOrderSetState(ts, 1, 0.25, 0));
  for (PetscInt k = 0; k < 3; k++) ok(TSStep(ts));
  near(t, 1.5, 0);
  ok(TSGetTime(ts, &time));
  near(time, 1.75, 0);
  ok(VecMax(u, NULL, &largest));
  near(largest, 0.75, 0);
  ok(VecMax(v, NULL, &largest));
  near(largest, 1.5, 0);
  ok(TSDestroy(&ts));
  ok(VecDestroy(&u));
  ok(VecDestroy(&v));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vectors_and_matrices_agree),  cmocka_unit_test(spin_is_the_rate),           cmocka_unit_test(a_program_makes_one),
      cmocka_unit_test(can_be_made_to_deform_again), cmocka_unit_test(lets_a_function_make_steps),
  };

  return impakt_main(argc, argv, tests);
}
