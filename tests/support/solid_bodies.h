/* Bodies in two and three dimensions, their contact nodes, rows at single nodes, and sums over their nodes. */
#pragma once
#include "support.h"
#include <impakt/private/mesh.h>
#include <body/layout/bodyimpl.h>
#include <impakt/private/bodymesh.h>
#include <impakt/private/bodyrows.h>

/* Quadrilaterals, triangles, hexahedra, tetrahedra */
#define KINDS 4
static const PetscInt     kind_dim[KINDS] = {2, 2, 3, 3};
static inline const char *kind_options(PetscInt kind)
{
  static const char *const options[KINDS] = {"-dm_plex_dim 2 -dm_plex_simplex 0", "-dm_plex_dim 2 -dm_plex_simplex 1",
                                             "-dm_plex_dim 3 -dm_plex_simplex 0", "-dm_plex_dim 3 -dm_plex_simplex 1"};

  return options[kind];
}

/* A body named b on a communicator, its options read (printf-like, without the prefix), not set up; bar_destroy() ends it */
static inline PetscOptions solid_body_create_on(MPI_Comm comm, Body *body, const char text[])
{
  PetscOptions options = options_begin("-prefix_push b_ %s -prefix_pop", text);

  ok(BodyCreate(comm, "b", body));
  ok(BodySetFromOptions(*body));
  return options;
}

static inline PetscOptions solid_body_create(Body *body, const char format[], ...)
{
  char    text[2048];
  va_list args;

  va_start(args, format);
  vsnprintf(text, sizeof(text), format, args);
  va_end(args);
  return solid_body_create_on(PETSC_COMM_WORLD, body, text);
}

/* The nodes of a side of a box, by its name */
static inline void touch_side(Body body, const char side[])
{
  PetscInt n, *vertices;
  DM       dm;

  ok(BodyGetDM(body, &dm));
  ok(MeshGetNodeSet(dm, side, &n, &vertices));
  ok(BodySetContactNodes(body, n, vertices));
  ok(PetscFree(vertices));
}

static inline PetscReal sum_over_ranks(PetscReal mine)
{
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD), 0);
  return mine;
}

/* A sequence without pattern, between -1 and 1, that depends on a position alone: the same on any number of ranks */
static inline PetscReal scattered(const PetscReal x[], PetscInt dim, PetscInt which)
{
  PetscReal phase = 1 + 2.3 * which;

  for (PetscInt d = 0; d < dim; d++) phase += (7.1 + 3.7 * d + 1.3 * which) * x[d];
  return PetscSinReal(phase);
}

/* A state with strains of some hundredths in bodies of some metres */
static inline PetscErrorCode ScatteredState(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = 0.01 * scattered(x, dim, d);
    v[d] = 0.02 * scattered(x, dim, 3 + d);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows at single nodes, each along a direction */
#define MAX_NODE_ROWS 16
typedef struct {
  PetscInt n, local;
  PetscInt which[MAX_NODE_ROWS]; /* of each row of this rank: its number among those asked for */
} NodeRows;

/* The rows of a body in more dimensions; the nodes, at x[3 i], must be contact nodes by their own call */
static inline void set_node_rows(Body body, PetscInt n, const PetscReal x[], const PetscReal direction[], NodeRows *rows)
{
  const PetscInt     dim = body->mesh.dim;
  const PetscScalar *position;
  PetscInt           begin, size, first;
  PetscInt           node[MAX_NODE_ROWS];
  Mat                B;

  assert_true(n <= MAX_NODE_ROWS);
  rows->n     = n;
  rows->local = 0;
  ok(VecGetLocalSize(body->mesh.positions, &size));
  ok(VecGetOwnershipRange(body->mesh.positions, &first, NULL));
  ok(VecGetArrayRead(body->mesh.positions, &position));
  for (PetscInt k = 0; k < size / dim; k++)
    for (PetscInt i = 0; i < n; i++) {
      PetscReal distance = 0;

      for (PetscInt d = 0; d < dim; d++) distance += PetscAbsReal(position[k * dim + d] - x[3 * i + d]);
      if (distance > 1e-9) continue;
      node[rows->local]          = k;
      rows->which[rows->local++] = i;
    }
  ok(VecRestoreArrayRead(body->mesh.positions, &position));
  assert_int_equal((PetscInt)sum_over_ranks(rows->local), n);
  ok(MatCreateAIJ(PETSC_COMM_WORLD, rows->local, size, n, PETSC_DETERMINE, dim, NULL, dim, NULL, &B));
  ok(MatGetOwnershipRange(B, &begin, NULL));
  for (PetscInt i = 0; i < rows->local; i++)
    for (PetscInt d = 0; d < dim; d++)
      ok(MatSetValue(B, begin + i, first + node[i] * dim + d, direction[3 * rows->which[i] + d], INSERT_VALUES));
  ok(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  ok(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  ok(BodySetInterface(body, B));
  ok(MatDestroy(&B));
}

/* All rows mean the same */
static inline void condition_rows(Body body, const NodeRows *rows, BodyCondition condition)
{
  BodyCondition mine[MAX_NODE_ROWS];

  for (PetscInt i = 0; i < rows->local; i++) mine[i] = condition;
  ok(BodySetConditions(body, mine));
}

static inline void set_row(const NodeRows *rows, Trace trace, PetscInt level, PetscInt which, PetscReal value)
{
  PetscScalar *values;

  ok(TraceGetLevel(trace, level, &values));
  for (PetscInt i = 0; i < rows->local; i++)
    if (rows->which[i] == which) values[i] = value;
}

/* The value on every rank */
static inline PetscReal get_row(const NodeRows *rows, Trace trace, PetscInt level, PetscInt which)
{
  PetscScalar *values;
  PetscReal    value = 0;

  ok(TraceGetLevel(trace, level, &values));
  for (PetscInt i = 0; i < rows->local; i++)
    if (rows->which[i] == which) value = values[i];
  return sum_over_ranks(value);
}
