/* Two boxes whose surfaces may touch, moved in space, and the rows between them. */
#pragma once
#include "simulation.h"
#include <impakt/private/transfer.h>

typedef struct {
  PetscInt     dim;
  DM           dm[2];
  Surface      surface[2];
  Vec          u[2];
  Transfer     transfer;
  TransferRows rows;
  PetscInt     begin, n_opposite; /* first row of this rank; rows of all ranks that have something opposite */
  Mat          matrix[2];         /* Dirichlet and Neumann side */
} Interface;

typedef void (*Map)(const PetscReal[3], PetscReal[3]);

static inline void map_nothing(const PetscReal X[3], PetscReal x[3])
{
  for (PetscInt d = 0; d < 3; d++) x[d] = X[d];
}

/* By 0.5 rad about the third axis, then 0.7 rad about the first, and away from the origin */
static inline void map_oblique(const PetscReal X[3], PetscReal x[3])
{
  const PetscReal c = PetscCosReal(0.5), s = PetscSinReal(0.5), C = PetscCosReal(0.7), S = PetscSinReal(0.7), y = s * X[0] + c * X[1];

  x[0] = c * X[0] - s * X[1] + 3;
  x[1] = C * y - S * X[2] - 2;
  x[2] = S * y + C * X[2] + 1;
}

static inline void map_oblique_2d(const PetscReal X[3], PetscReal x[3])
{
  const PetscReal c = PetscCosReal(0.5), s = PetscSinReal(0.5);

  x[0] = c * X[0] - s * X[1] + 3;
  x[1] = s * X[0] + c * X[1] - 2;
  x[2] = 0;
}

/* A dome along the last axis: 0.3 high in the middle, of curvature 2.4 at most */
static inline void map_curved(const PetscReal X[3], PetscReal x[3])
{
  for (PetscInt d = 0; d < 3; d++) x[d] = X[d];
  x[2] += 1.2 * (X[0] * (1 - X[0]) + X[1] * (1 - X[1])) / 2;
}

static inline void map_curved_2d(const PetscReal X[3], PetscReal x[3])
{
  x[0] = X[0];
  x[1] = X[1] + 1.2 * X[0] * (1 - X[0]);
  x[2] = 0;
}

/* Displacements that put every vertex X of the mesh at map(X) + shift */
static inline void move_mesh(DM dm, Map map, const PetscReal shift[3], Vec u)
{
  PetscSection       section, coordinate_section;
  PetscInt           start, end, dim;
  const PetscScalar *coordinates;
  Vec                local;

  ok(DMGetCoordinateDim(dm, &dim));
  ok(DMGetGlobalSection(dm, &section));
  ok(DMGetCoordinateSection(dm, &coordinate_section));
  ok(DMGetCoordinatesLocal(dm, &local));
  ok(DMPlexGetDepthStratum(dm, 0, &start, &end));
  ok(VecGetArrayRead(local, &coordinates));
  for (PetscInt v = start; v < end; v++) {
    PetscReal X[3] = {0}, x[3];
    PetscInt  offset, at;

    ok(PetscSectionGetOffset(section, v, &at));
    ok(PetscSectionGetOffset(coordinate_section, v, &offset));
    for (PetscInt d = 0; d < dim; d++) X[d] = coordinates[offset + d];
    map(X, x);
    for (PetscInt d = 0; d < dim && at >= 0; d++) ok(VecSetValue(u, at + d, x[d] + shift[d] - X[d], INSERT_VALUES));
  }
  ok(VecRestoreArrayRead(local, &coordinates));
  ok(VecAssemblyBegin(u));
  ok(VecAssemblyEnd(u));
}

static const TransferOptions bounds = {.slip_bound = 0.05, .angle_bound = 0.02};

/* [0,1]^dim under [0,1]^(dim - 1) x [1,2] with these elements; lower box first, `flip`: the upper one is the Dirichlet side */
static inline void interface_create(Interface *interface, PetscInt dim, const char *const faces[2], const PetscBool simplex[2],
                                    PetscBool flip)
{
  static const char *const lower[2][4] = {{"", "0", "0,0", "0,0,0"}, {"", "1", "0,1", "0,0,1"}}, *const upper[2][4] = {
                                                                                                     {"", "1", "1,1", "1,1,1"},
                                                                                                     {"", "2", "1,2", "1,1,2"}};
  static const char *const names[2][4] = {{"", "xmax", "ymax", "zmax"}, {"", "xmin", "ymin", "zmin"}};

  memset(interface, 0, sizeof(*interface));
  interface->dim = dim;
  for (PetscInt box = 0; box < 2; box++) {
    const PetscInt side = flip ? 1 - box : box;

    interface->dm[side] = CreateBoxMesh(box ? "upper" : "lower", dim, faces[box], lower[box][dim], upper[box][dim], simplex[box]);
    AddOptions("-dm_refine 0"); /* what a mesh of simplices has left */
    ok(PetscOptionsClearValue(NULL, "-dm_plex_transform_type"));
    ok(SurfaceCreate(interface->dm[side], names[box][dim], &interface->surface[side]));
    ok(DMCreateGlobalVector(interface->dm[side], &interface->u[side]));
  }
  ok(TransferCreate(PETSC_COMM_WORLD, interface->surface[0], interface->surface[1], NULL, &bounds, &interface->transfer));
}

/* Rows and matrices at the displacements interface->u */
static inline PetscBool interface_update(Interface *interface, PetscReal near, PetscInt components)
{
  PetscBool rebuilt;
  PetscInt  n;

  ok(TransferUpdate(interface->transfer, interface->u[0], interface->u[1], near, &rebuilt));
  ok(TransferGetRows(interface->transfer, &interface->rows));
  n = interface->rows.n * components;
  assert_int_equal(MPI_Scan(&n, &interface->begin, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  interface->begin -= n;
  interface->n_opposite = 0;
  for (PetscInt i = 0; i < interface->rows.n; i++) interface->n_opposite += interface->rows.opposite[i] ? 1 : 0;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &interface->n_opposite, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
  for (PetscInt side = 0; side < 2; side++) {
    PetscInt local;

    ok(VecGetLocalSize(interface->u[side], &local));
    ok(MatDestroy(&interface->matrix[side]));
    ok(MatCreate(PETSC_COMM_WORLD, &interface->matrix[side]));
    ok(MatSetSizes(interface->matrix[side], n, local, PETSC_DETERMINE, PETSC_DETERMINE));
    ok(MatSetType(interface->matrix[side], MATAIJ));
    ok(MatSetUp(interface->matrix[side]));
  }
  ok(TransferSetValues(interface->transfer, (const PetscInt[]){interface->begin, interface->begin}, components, NULL, interface->matrix));
  for (PetscInt side = 0; side < 2; side++) {
    ok(MatAssemblyBegin(interface->matrix[side], MAT_FINAL_ASSEMBLY));
    ok(MatAssemblyEnd(interface->matrix[side], MAT_FINAL_ASSEMBLY));
  }
  return rebuilt;
}

static inline void interface_destroy(Interface *interface)
{
  ok(TransferDestroy(&interface->transfer));
  assert_null(interface->transfer);
  for (PetscInt side = 0; side < 2; side++) {
    ok(MatDestroy(&interface->matrix[side]));
    ok(VecDestroy(&interface->u[side]));
    ok(SurfaceDestroy(&interface->surface[side]));
    ok(DMDestroy(&interface->dm[side]));
  }
}

/* Nodal forces on one side from a pressure at each row: transpose times pressure(i) A_i; uniform, or without pattern */
static inline Vec interface_force(Interface *interface, PetscInt side, PetscBool uniform)
{
  Vec lambda, force;

  ok(MatCreateVecs(interface->matrix[side], &force, &lambda));
  for (PetscInt i = 0; i < interface->rows.n; i++) {
    const PetscReal   *x = NULL;
    const SurfaceData *data;

    ok(SurfaceGetData(interface->surface[0], &data));
    x = data->reference + 3 * i;
    ok(VecSetValue(lambda, interface->begin + i,
                   interface->rows.area[i] * (uniform ? 1 : 1.1 + PetscSinReal(5 * x[0] + 3 * x[1] + 7 * x[2])), INSERT_VALUES));
  }
  ok(VecAssemblyBegin(lambda));
  ok(VecAssemblyEnd(lambda));
  ok(MatMultTranspose(interface->matrix[side], lambda, force));
  ok(VecDestroy(&lambda));
  return force;
}

/* Resultant [0..2] and moment about the origin [3..5] of nodal forces at the present positions of a surface's nodes */
static inline void interface_resultant(Interface *interface, PetscInt side, Vec force, PetscReal sums[6])
{
  const SurfaceData *data;
  const PetscScalar *f;
  PetscInt           start;

  for (PetscInt i = 0; i < 6; i++) sums[i] = 0;
  ok(SurfaceGetData(interface->surface[side], &data));
  ok(VecGetOwnershipRange(force, &start, NULL));
  ok(VecGetArrayRead(force, &f));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    const PetscReal *x    = data->positions + 3 * i;
    PetscReal        g[3] = {0};

    for (PetscInt d = 0; d < interface->dim; d++) g[d] = f[data->dofs[i] - start + d];
    for (PetscInt d = 0; d < 3; d++) {
      sums[d] += g[d];
      sums[3 + d] += x[(d + 1) % 3] * g[(d + 2) % 3] - x[(d + 2) % 3] * g[(d + 1) % 3];
    }
  }
  ok(VecRestoreArrayRead(force, &f));
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
}
