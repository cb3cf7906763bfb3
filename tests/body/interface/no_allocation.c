/* Nothing is allocated in the time loop: the C library's allocator is replaced by one that counts. */
#include "loads.h"
#include "count_allocations.h"
#include <impakt/private/bodystep.h>

/* Steps at which the count is taken. The bars touch in step 4 and part in step 505: first free flight, then contact with the
   set-up of PETSc's solvers behind it (each makes its work vectors in its first solve), then all the rest with the release. Without the
   line that tells of progress, whose thread begins when the machine lets it. */
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
      "-bodies left,right -time_end 5.2e-4 -time_step 1e-6 -progress false "
      "-left_dm_plex_dim 1 -left_dm_plex_box_faces 50 -left_dm_plex_box_lower -0.2503 -left_dm_plex_box_upper -3.5e-4 -left_density 1000 "
      "-left_youngs_modulus 1e9 -left_cross_section 1e-6 -left_initial_velocity 100 "
      "-right_dm_plex_dim 1 -right_dm_plex_box_faces 40 -right_dm_plex_box_lower 3.5e-4 -right_dm_plex_box_upper 0.2503 -right_density "
      "1000 -right_youngs_modulus 1e9 -right_cross_section 1e-6 -right_initial_velocity -100 ";
  Controller controller;

  ok(PetscOptionsClear(NULL));
  ok(PetscOptionsInsertString(NULL, common));
  ok(PetscOptionsInsertString(NULL, options));
  count_petsc_allocations(PETSC_TRUE);
  ok(ControllerCreate(PETSC_COMM_WORLD, &controller));
  ok(ControllerSetFromOptions(controller));
  ok(ControllerSetUp(controller));
  ok(ControllerMonitorSet(controller, Count, NULL, NULL));
  ok(ControllerSolve(controller));
  ok(ControllerDestroy(&controller));
  count_petsc_allocations(PETSC_FALSE);
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

  ok(PetscOptionsClear(NULL));
  ok(PetscOptionsInsertString(NULL, common));
  ok(PetscOptionsInsertString(NULL, options));
  ok(BodyCreate(PETSC_COMM_WORLD, "b", &body));
  ok(BodySetFromOptions(body));
  ok(BodySetControllerStep(body, 0, 0.02));
  ok(BodySetUp(body));
  for (int step = 0; step < 20; step++) {
    PetscReal    forces[3], moments[3];
    BodyMeasures measures;

    if (step == 3) before = allocations;
    ok(BodyIntegrate(body));
    ok(BodySave(body));
    ok(BodyGetMeasures(body, &measures));
    ok(BodyGetReactions(body, forces, moments));
    assert_true(measures.kinetic > 0);
  }
  before = allocations - before;
  ok(BodyDestroy(&body));
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

/* Steady, uniform and varying loads of each sort, and tables */
static void loads_do_not_allocate(void **state)
{
  PetscOptions options;
  Vec          f, u, v, a;
  Body         body;
  long         before;
  FILE        *file = fopen("loads-allocation.txt", "w");

  (void)state;
  assert_non_null(file);
  fprintf(file, "0 0\n1 2\n4 12\n");
  assert_int_equal(fclose(file), 0);
  options = box_create(&body, 3,
                       "-gravity 0,0,-9.81 -body_force 1,t,x*t -boundary_traction xmax,ymax -boundary_traction_xmax "
                       "-2*t*nx,0,table:loads-allocation.txt -boundary_traction_ymax 1,2,max(x,sin(t),3) "
                       "-boundary_displacement xmin,zmin -boundary_displacement_xmin 0,x*sin(t),table:loads-allocation.txt "
                       "-boundary_displacement_zmin free,free,t^2");
  ok(BodyCreateVec(body, &f));
  ok(BodyCreateVec(body, &u));
  ok(BodyCreateVec(body, &v));
  ok(BodyCreateVec(body, &a));
  ok(BodyLoadsAddForce(body, 0, 1, f));
  ok(BodyLoadsPrescribe(body, 0, u, v, a));
  before = allocations;
  for (int step = 0; step < 10; step++) {
    ok(BodyLoadsAddForce(body, 0.3 * step, 1, f));
    ok(BodyLoadsPrescribe(body, 0.3 * step, u, v, a));
  }
#if defined(__SANITIZE_ADDRESS__)
  before = allocations; /* not counted */
#endif
  assert_int_equal(allocations - before, 0);
  ok(VecDestroy(&f));
  ok(VecDestroy(&u));
  ok(VecDestroy(&v));
  ok(VecDestroy(&a));
  bar_destroy(&body, options);
#if !defined(__SANITIZE_ADDRESS__)
  assert_true(before > 0);
#endif
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(DefaultsDoNotAllocate),       cmocka_unit_test(ExplicitDoesNotAllocate),
      cmocka_unit_test(RigidDoesNotAllocate),        cmocka_unit_test(DampingDoesNotAllocate),
      cmocka_unit_test(RatesDoNotAllocate),          cmocka_unit_test(NaiveStabilizationDoesNotAllocate),
      cmocka_unit_test(ExplicitSolidsDoNotAllocate), cmocka_unit_test(ImplicitSolidsDoNotAllocate),
      cmocka_unit_test(loads_do_not_allocate),
  };

  return impakt_main(argc, argv, tests);
}
