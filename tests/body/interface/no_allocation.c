/* ranks: 1 */
/* Nothing is allocated in the time loop: the C library's allocator is replaced by one that counts. */
#include <impakt.h>
#include <impakt/private/bodyrows.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include "count_allocations.h"

/* Steps at which the count is taken. The bars touch in step 4 and part in step 505: first free flight, then contact with the
   set-up of PETSc's solvers behind it (each makes its work vectors in its first solve), then all the rest with the release. */
static const PetscInt marks[] = {2, 3, 10, 510};
static long           counts[4];

static PetscErrorCode Count(Controller controller, const ControllerFrame *frame, void *ctx)
{
  PetscFunctionBegin;
  (void)controller;
  (void)ctx;
  for (int i = 0; i < 4; i++)
    if (frame->step == marks[i]) counts[i] = allocations;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void RunCase(const char options[])
{
  static const char common[] =
      "-bodies left,right -time_end 5.2e-4 -time_step 1e-6 "
      "-left_dm_plex_dim 1 -left_dm_plex_box_faces 50 -left_dm_plex_box_lower -0.2503 -left_dm_plex_box_upper -3.5e-4 -left_density 1000 "
      "-left_youngs_modulus 1e9 -left_cross_section 1e-6 -left_initial_velocity 100 "
      "-right_dm_plex_dim 1 -right_dm_plex_box_faces 40 -right_dm_plex_box_lower 3.5e-4 -right_dm_plex_box_upper 0.2503 -right_density "
      "1000 -right_youngs_modulus 1e9 -right_cross_section 1e-6 -right_initial_velocity -100 ";
  Controller controller;

  assert_int_equal(PetscOptionsClear(NULL), PETSC_SUCCESS);
  assert_int_equal(PetscOptionsInsertString(NULL, common), PETSC_SUCCESS);
  assert_int_equal(PetscOptionsInsertString(NULL, options), PETSC_SUCCESS);
  assert_int_equal(ControllerCreate(PETSC_COMM_WORLD, &controller), PETSC_SUCCESS);
  assert_int_equal(ControllerSetFromOptions(controller), PETSC_SUCCESS);
  assert_int_equal(ControllerSetUp(controller), PETSC_SUCCESS);
  assert_int_equal(ControllerMonitorSet(controller, Count, NULL, NULL), PETSC_SUCCESS);
  assert_int_equal(ControllerSolve(controller), PETSC_SUCCESS);
  assert_int_equal(ControllerDestroy(&controller), PETSC_SUCCESS);
#if defined(__SANITIZE_ADDRESS__)
  skip();
#endif
  assert_true(counts[0] > 0);
  assert_int_equal(counts[1] - counts[0], 0);
  assert_int_equal(counts[3] - counts[2], 0);
}

static void DefaultsDoNotAllocate(void **state)
{
  (void)state;
  RunCase("");
}

static void RigidDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-right_rigid true");
}

static void ExplicitDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-left_ts_type centraldifference -right_ts_type centraldifference -right_ts_time_step 5e-7");
}

static void DampingDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-left_damping_mass 10 -left_damping_stiffness 1e-8 -right_damping_stiffness 1e-8 -left_probe -0.1;-0.2 -right_probe 0.1");
  RunCase("-left_ts_type centraldifference -left_damping_stiffness 1e-8 -right_ts_type centraldifference -right_ts_time_step 5e-7 "
          "-right_damping_mass 10");
}

static void PaperDoesNotAllocate(void **state)
{
  (void)state;
  RunCase(
      "-schwarz_snes_type nrichardson -left_mass_type lumped -right_mass_type lumped -left_mass_redistribute 0 -right_mass_redistribute 0");
}

static void TransmissionsDoNotAllocate(void **state)
{
  (void)state;
  RunCase("-schwarz_transmission robin");
  RunCase("-schwarz_transmission impedance -schwarz_predictor trial -right_ts_time_step 5e-7 -contact_allow_unstable 1");
}

/* With Aitken: newtonls has a new Jacobian in each step then, and PETSc allocates work space whenever it factors one, and in each
   iteration of Anderson */
static void SwappedSidesDoNotAllocate(void **state)
{
  (void)state;
  RunCase("-contact_swap_sides -left_ts_time_step 5e-7 -schwarz_predictor extrapolate -schwarz_snes_type nrichardson -schwarz_relaxation "
          "aitken");
}

static void PenaltyDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-contact_type penalty -contact_penalty 7.5e4");
}

static void LagrangeDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-contact_type lagrange -left_ts_type centraldifference -right_ts_type centraldifference -left_mass_redistribute 0 "
          "-right_mass_redistribute 0");
}

static void RatesDoNotAllocate(void **state)
{
  (void)state;
  RunCase("-contact_type lagrange -contact_constraint both -left_ts_type centraldifference -right_ts_type centraldifference "
          "-left_mass_redistribute 0 -right_mass_redistribute 0");
}

static void NaiveStabilizationDoesNotAllocate(void **state)
{
  (void)state;
  RunCase("-contact_stabilization naive -left_mass_redistribute 0 -right_mass_redistribute 0");
}

/* A body on its own: the first steps make PETSc's work vectors, the others nothing */
static void RunSolid(const char options[])
{
  static const char common[] = "-b_dm_plex_dim 3 -b_dm_plex_box_faces 3,3,3 -b_density 3 -b_youngs_modulus 5 -b_poissons_ratio 0.2 "
                               "-b_initial_velocity 0.1*z,0,0.1*x ";
  Body              body;
  long              before = 0;

  assert_int_equal(PetscOptionsClear(NULL), PETSC_SUCCESS);
  assert_int_equal(PetscOptionsInsertString(NULL, common), PETSC_SUCCESS);
  assert_int_equal(PetscOptionsInsertString(NULL, options), PETSC_SUCCESS);
  assert_int_equal(BodyCreate(PETSC_COMM_WORLD, "b", &body), PETSC_SUCCESS);
  assert_int_equal(BodySetFromOptions(body), PETSC_SUCCESS);
  assert_int_equal(BodySetControllerStep(body, 0, 0.02), PETSC_SUCCESS);
  assert_int_equal(BodySetUp(body), PETSC_SUCCESS);
  for (int step = 0; step < 20; step++) {
    PetscReal    forces[3], moments[3];
    BodyMeasures measures;

    if (step == 3) before = allocations;
    assert_int_equal(BodyIntegrate(body), PETSC_SUCCESS);
    assert_int_equal(BodySave(body), PETSC_SUCCESS);
    assert_int_equal(BodyGetMeasures(body, &measures), PETSC_SUCCESS);
    assert_int_equal(BodyGetReactions(body, forces, moments), PETSC_SUCCESS);
    assert_true(measures.kinetic > 0);
  }
  before = allocations - before;
  assert_int_equal(BodyDestroy(&body), PETSC_SUCCESS);
#if defined(__SANITIZE_ADDRESS__)
  skip();
#endif
  assert_true(allocations > 0);
  assert_int_equal(before, 0);
}

#define SOLID_LOADS                                                                                                                        \
  "-b_gravity 0,0,-1 -b_boundary_traction xmax -b_boundary_traction_xmax 0.1*t,0,0.02*y -b_boundary_displacement zmin "                    \
  "-b_boundary_displacement_zmin 0.01*sin(t),0,free "

static void ExplicitSolidsDoNotAllocate(void **state)
{
  (void)state;
  RunSolid("-b_ts_type centraldifference");
  RunSolid("-b_ts_type centraldifference " SOLID_LOADS);
  RunSolid("-b_ts_type centraldifference -b_material_type neo_hookean");
  RunSolid("-b_ts_type centraldifference -b_material_type neo_hookean " SOLID_LOADS);
  RunSolid("-b_ts_type centraldifference -b_material_type neo_hookean -b_damping_mass 0.1 -b_damping_stiffness 0.01 " SOLID_LOADS);
}

static void ImplicitSolidsDoNotAllocate(void **state)
{
  (void)state;
  RunSolid("");
  RunSolid(SOLID_LOADS);
  RunSolid("-b_damping_mass 0.1 -b_damping_stiffness 0.01 " SOLID_LOADS);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(DefaultsDoNotAllocate),
      cmocka_unit_test(ExplicitDoesNotAllocate),
      cmocka_unit_test(RigidDoesNotAllocate),
      cmocka_unit_test(DampingDoesNotAllocate),
      cmocka_unit_test(PaperDoesNotAllocate),
      cmocka_unit_test(TransmissionsDoNotAllocate),
      cmocka_unit_test(SwappedSidesDoNotAllocate),
      cmocka_unit_test(PenaltyDoesNotAllocate),
      cmocka_unit_test(LagrangeDoesNotAllocate),
      cmocka_unit_test(RatesDoNotAllocate),
      cmocka_unit_test(NaiveStabilizationDoesNotAllocate),
      cmocka_unit_test(ExplicitSolidsDoNotAllocate),
      cmocka_unit_test(ImplicitSolidsDoNotAllocate),
  };
  int failed;

  if (ImpaktInitialize(&argc, &argv)) return 1;
  failed = cmocka_run_group_tests(tests, NULL, NULL);
  if (ImpaktFinalize()) return 1;
  return failed;
}
