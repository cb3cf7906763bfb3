/* Boxes with loads, and what their nodal forces add up to. */
#include "support.h"
#include <body/layout/bodyimpl.h>

/* A box of this size with its lower corner there: sides of area 12, 8, 6, or edges of length 3, 2 */
static const PetscReal box_size[] = {2, 3, 4}, box_lower[] = {0.5, -1, 0.25};

/* Kinds of boxes: bars, quadrilaterals, triangles, hexahedra, tetrahedra */
#define N_BOXES 5
static const PetscInt box_dim[N_BOXES] = {1, 2, 2, 3, 3};

static inline PetscOptions box_options(PetscInt box, const char more[])
{
  const char *const faces[] = {"5", "3,2", "3,2,3"}, *const lower[] = {"0.5", "0.5,-1", "0.5,-1,0.25"},
                    *const upper[] = {"2.5", "2.5,2", "2.5,2,4.25"};
  const PetscInt           dim     = box_dim[box];

  return options_begin("-prefix_push bar_ -dm_plex_dim %d -dm_plex_box_faces %s -dm_plex_box_lower %s -dm_plex_box_upper %s %s -density 3 "
                       "-youngs_modulus 16 %s -prefix_pop",
                       (int)dim, faces[dim - 1], lower[dim - 1], upper[dim - 1],
                       dim == 1       ? ""
                       : box % 2 == 0 ? "-dm_plex_simplex 1"
                                      : "-dm_plex_simplex 0",
                       more);
}

/* Set up, with a controller step of 0.01 s from time 0 */
static inline PetscOptions box_create(Body *body, PetscInt box, const char more[])
{
  PetscOptions options = box_options(box, more);

  ok(BodyCreate(PETSC_COMM_WORLD, "bar", body));
  ok(BodySetFromOptions(*body));
  ok(BodySetControllerStep(*body, 0, 0.01));
  ok(BodySetUp(*body));
  return options;
}

/* On every rank */
typedef struct {
  PetscReal force[3];
  PetscReal moment[3][3]; /* sum of x_i f_j */
} Total;

static inline Total total_of(Body body, Vec f)
{
  const PetscScalar *x, *values;
  Total              total = {{0}, {{0}}};
  PetscInt           n;
  Vec                positions;

  ok(BodyGetReferencePositions(body, &positions));
  ok(VecGetLocalSize(positions, &n));
  ok(VecGetArrayRead(positions, &x));
  ok(VecGetArrayRead(f, &values));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt node = i / body->mesh.dim;

    total.force[i % body->mesh.dim] += values[i];
    for (PetscInt d = 0; d < body->mesh.dim; d++) total.moment[d][i % body->mesh.dim] += x[node * body->mesh.dim + d] * values[i];
  }
  ok(VecRestoreArrayRead(f, &values));
  ok(VecRestoreArrayRead(positions, &x));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &total, 12, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return total;
}

/* Of the external force at time t */
static inline Total force_at(Body body, PetscReal t)
{
  Total total;
  Vec   f;

  ok(BodyCreateVec(body, &f));
  ok(VecZeroEntries(f));
  ok(BodyLoadsAddForce(body, t, 1, f));
  total = total_of(body, f);
  ok(VecDestroy(&f));
  return total;
}
