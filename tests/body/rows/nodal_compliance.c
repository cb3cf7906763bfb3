/* ranks: 1 3 */
/* long: 3 */
/* Displacements under unit forces on nodes: of few by controller steps, which are right; of many as a slab at the surface answers, or, with
   substeps, by these where forces are felt. */
#include "solid_bodies.h"
#include <impakt/private/bodyforces.h>
#include <impakt/private/bodystep.h>

/* 2 m of 8 elements along each edge. Waves run at 1.36 m/s: they cross an element in 0.18 s. */
#define BLOCK                                                                                                                              \
  "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 8,8,8 -dm_plex_box_upper 2,2,2 -density 3 -youngs_modulus 5 -poissons_ratio 0.2 "  \
  "-mass_type lumped "
#define HELD "-boundary_displacement xmin -boundary_displacement_xmin 0,free,free"
#define SIDE 243 /* displacements of the contact nodes */
#define FEW  45

typedef struct {
  const char    *what;
  PetscReal      step; /* of the controller [s] */
  PetscInt       substeps;
  BodyForceShape shape;
  PetscReal      apart; /* these and controller steps, in parts of the largest displacement */
} Case;

/* Measured beside the bounds. One substep of the trapezoidal rule has its own A, of which a coarse grid far from the surface misses what
   waves bring that cross many elements. Explicit substeps are made where waves are; the 20 of 1 s carry a force through the whole block. */
static const Case cases[] = {
    {"-ts_type alpha2 -mass_redistribute false", 0.1, 1, BODY_FORCE_CONSTANT, 1e-9},                  /* 1.1e-10 */
    {"-ts_type alpha2 -mass_redistribute false", 2, 1, BODY_FORCE_CONSTANT, 4e-3},                    /* 2.8e-3 */
    {"-ts_type alpha2", 0.1, 1, BODY_FORCE_LINEAR, 1e-9},                                             /* 1.8e-10 */
    {"-ts_type alpha2", 2, 1, BODY_FORCE_LINEAR, 4e-3},                                               /* 2.8e-3 */
    {"-ts_type alpha2 -mass_redistribute false", 0.1, 3, BODY_FORCE_CONSTANT, 1e-14},                 /* 0: controller steps */
    {"-ts_type centraldifference -mass_redistribute false", 0.1, 3, BODY_FORCE_CONSTANT, 1e-13},      /* 1.3e-16 */
    {"-ts_type centraldifference -mass_redistribute false", 1, 20, BODY_FORCE_CONSTANT, 1e-13},       /* 1.3e-15 */
    {"-ts_type centraldifference -mass_redistribute false " HELD, 1, 20, BODY_FORCE_CONSTANT, 1e-13}, /* 1.3e-15 */
    {"-ts_type centraldifference -mass_redistribute false -material_type neo_hookean", 1, 20, BODY_FORCE_LINEAR, 1e-12}, /* 1e-15 */
    {"-ts_type centraldifference", 0.1, 3, BODY_FORCE_LINEAR, 1e-14}, /* 0: controller steps */
};
#define CASES ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(cases))

/* The displacements of the upper side, by their numbers among those of all ranks, on all ranks */
static void list_side(Body body, PetscInt dofs[SIDE])
{
  const PetscScalar *x;
  PetscInt           n, begin, mine[SIDE], count      = 0;
  PetscMPIInt        size, sent, counts[8], places[8] = {0};

  ok(VecGetLocalSize(body->mesh.positions, &n));
  ok(VecGetOwnershipRange(body->mesh.positions, &begin, NULL));
  ok(VecGetArrayRead(body->mesh.positions, &x));
  for (PetscInt i = 0; i < n; i += 3)
    for (PetscInt d = 0; d < 3 && PetscAbsReal(PetscRealPart(x[i + 2]) - 2) < 1e-9; d++) mine[count++] = begin + i + d;
  ok(VecRestoreArrayRead(body->mesh.positions, &x));
  sent = (PetscMPIInt)count;
  assert_int_equal(MPI_Comm_size(PETSC_COMM_WORLD, &size), 0);
  assert_in_range(size, 1, 8);
  assert_int_equal(MPI_Allgather(&sent, 1, MPI_INT, counts, 1, MPI_INT, PETSC_COMM_WORLD), 0);
  for (PetscMPIInt rank = 1; rank < size; rank++) places[rank] = places[rank - 1] + counts[rank - 1];
  assert_int_equal(places[size - 1] + counts[size - 1], SIDE);
  assert_int_equal(MPI_Allgatherv(mine, sent, MPIU_INT, dofs, counts, places, MPIU_INT, PETSC_COMM_WORLD), 0);
}

/* W of the first FEW of n displacements that are asked for */
static void get_compliance(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], PetscReal W[FEW * FEW])
{
  const PetscInt    *place;
  const PetscScalar *matrix;
  PetscInt           leading;

  ok(BodyGetNodalCompliance(body, shape, n, dofs, &place, &leading, &matrix));
  for (PetscInt j = 0; j < FEW; j++)
    for (PetscInt i = 0; i < FEW; i++) W[j * FEW + i] = PetscRealPart(matrix[place[dofs[j]] * leading + place[dofs[i]]]);
}

static PetscReal largest_apart(const PetscReal a[], const PetscReal b[], PetscBool transposed)
{
  PetscReal off = 0, largest = 0;

  for (PetscInt j = 0; j < FEW; j++)
    for (PetscInt i = 0; i < FEW; i++) {
      off     = PetscMax(off, PetscAbsReal(a[j * FEW + i] - b[transposed ? i * FEW + j : j * FEW + i]));
      largest = PetscMax(largest, PetscAbsReal(a[j * FEW + i]));
    }
  assert_true(largest > 0);
  return off / largest;
}

static void check(const Case *c)
{
  static const PetscReal x[] = {1, 1, 2}, up[] = {0, 0, 1};
  PetscReal              exact[FEW * FEW], slab[FEW * FEW], again[FEW * FEW];
  PetscInt               dofs[SIDE];
  PetscOptions           options;
  NodeRows               rows;
  Body                   body;

  options = solid_body_create(&body, BLOCK "%s -ts_time_step %.17g", c->what, c->step / c->substeps);
  touch_side(body, "zmax");
  set_node_rows(body, 1, x, up, &rows);
  ok(BodySetControllerStep(body, 0, c->step));
  ok(BodySetUp(body));
  condition_rows(body, &rows, BODY_FORCED);
  ok(BodySave(body));
  list_side(body, dofs);
  get_compliance(body, c->shape, FEW, dofs, exact);
  get_compliance(body, c->shape, SIDE, dofs, slab);
  get_compliance(body, c->shape, FEW, dofs, again);
  assert_true(largest_apart(exact, exact, PETSC_TRUE) < 1e-10);
  assert_true(largest_apart(slab, slab, PETSC_TRUE) < 1e-10);
  if (!(largest_apart(exact, slab, PETSC_FALSE) < c->apart))
    fail_msg("%s, step %g s in %d substeps: %g apart", c->what, (double)c->step, (int)c->substeps,
             (double)largest_apart(exact, slab, PETSC_FALSE));
  assert_true(largest_apart(slab, again, PETSC_FALSE) == 0); /* it stays */
  bar_destroy(&body, options);
}

static void many_answer_as_a_slab(void **state)
{
  (void)state;
  for (PetscInt i = 0; i < CASES; i++) check(&cases[i]);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(many_answer_as_a_slab),
  };

  return impakt_main(argc, argv, tests);
}
