/* ranks: 1 */
/* Loads allocate nothing once they are set up: the C library's allocator is replaced by one that counts. */
#include "loads.h"
#include "count_allocations.h"

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
  const struct CMUnitTest tests[] = {cmocka_unit_test(loads_do_not_allocate)};

  return impakt_main(argc, argv, tests);
}
