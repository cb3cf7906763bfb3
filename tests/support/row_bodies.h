/* Linear bodies of one, two and three dimensions with rows on a contact side, some along it, one of two nodes; and integrators. */
#pragma once
#include "solid_bodies.h"

/* Bars, quadrilaterals, hexahedra of edge 0.5 m; 5 Pa and 3 kg/m^3, so that waves run at some 1.4 m/s; explicit steps are stable up to some
   0.25 s */
#define SHAPES_OF_BODIES 3
static const char *const meshes[SHAPES_OF_BODIES] = {
    "-dm_plex_dim 1 -dm_plex_box_faces 6 -dm_plex_box_upper 3 -cross_section 0.5 -density 3 -youngs_modulus 5",
    "-dm_plex_dim 2 -dm_plex_simplex 0 -dm_plex_box_faces 4,3 -dm_plex_box_upper 2,1.5 -density 3 -youngs_modulus 5 -poissons_ratio 0.2",
    "-dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_faces 3,2,3 -dm_plex_box_upper 1.5,1,1.5 -density 3 -youngs_modulus 5 -poissons_ratio "
    "0.2"};
/* one node of the bottom is held along one axis or more, where a body is to be held: static ones cannot do without */
static const char *const supports[SHAPES_OF_BODIES] = {"-boundary_displacement xmin -boundary_displacement_xmin 0.01*t",
                                                       "-boundary_displacement xmin -boundary_displacement_xmin 0.01*t,0",
                                                       "-boundary_displacement xmin -boundary_displacement_xmin 0.01*t,0,0"};

typedef enum { IMPLICIT, STATIC, EXPLICIT, METHODS } Method;
static const char *const methods[METHODS] = {"-ts_type alpha2", "-ts_type static", "-ts_type centraldifference"};

/* Rows on the side that may touch; those of a node are orthonormal. The last of the two larger bodies are at their edge x = 0, which
   supports hold: one whose dof is held altogether, and one along the other axis that is too. */
#define MOST_ROWS 5
static const PetscInt  n_rows_of[SHAPES_OF_BODIES]                   = {2, 5, 5};
static const PetscReal row_nodes_of[SHAPES_OF_BODIES][3 * MOST_ROWS] = {
    {3, 0, 0, 0, 0, 0},
    {0.5, 1.5, 0, 1, 1.5, 0, 1, 1.5, 0, 1.5, 1.5, 0, 2, 1.5, 0},
    {0.5, 0.5, 1.5, 0.5, 1, 1.5, 1, 0.5, 1.5, 1, 0.5, 1.5, 1.5, 1, 1.5}};
static const PetscReal row_directions_of[SHAPES_OF_BODIES][3 * MOST_ROWS] = {
    {1, 0, 0, 1, 0, 0}, {0, 1, 0, 0.6, 0.8, 0, 0.8, -0.6, 0, 0, 1, 0, 0, 1, 0}, {0, 0, 1, 0, 0, 1, 0, 0.6, 0.8, 0, 0.8, -0.6, 0, 0, 1}};
#define CONTROLLER_STEP 0.12

typedef struct {
  Body         body;
  PetscOptions options;
  BodyTraces   traces;
  NodeRows     rows;
  PetscInt     n, substeps, global[MOST_ROWS]; /* of each row asked for: its number, on every rank */
} RowBody;

static PetscErrorCode Moving(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  for (PetscInt d = 0; d < dim; d++) {
    u[d] = 0.01 * scattered(x, dim, d);
    v[d] = 0.02 * scattered(x, dim, 3 + d);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of the rows, which lie on the ranks of their nodes */
static inline void number_rows(RowBody *b)
{
  for (PetscInt i = 0; i < b->n; i++) b->global[i] = 0;
  for (PetscInt i = 0; i < b->rows.local; i++) b->global[b->rows.which[i]] = b->body->rows.begin + i;
  assert_int_equal(MPI_Allreduce(MPI_IN_PLACE, b->global, (PetscMPIInt)b->n, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD), 0);
}

/* A body at rest */
static inline void row_body_create(RowBody *b, PetscInt shape, Method method, PetscInt substeps, const PetscReal directions[],
                                   const char more[])
{
  b->substeps = substeps;
  b->n        = n_rows_of[shape];
  b->options  = solid_body_create(&b->body, "%s %s %s -ts_time_step %.17g %s", meshes[shape], method == STATIC ? supports[shape] : "",
                                  methods[method], CONTROLLER_STEP / substeps, more);
  if (shape) touch_side(b->body, shape == 1 ? "ymax" : "zmax");
  else {
    touch_side(b->body, "xmin");
    touch_side(b->body, "xmax");
  }
  set_node_rows(b->body, b->n, row_nodes_of[shape], directions ? directions : row_directions_of[shape], &b->rows);
  ok(BodySetControllerStep(b->body, 0, CONTROLLER_STEP));
  ok(BodySetUp(b->body));
  ok(BodyGetTraces(b->body, &b->traces));
  number_rows(b);
}

/* Under way: one controller step after a start without any pattern */
static inline void row_body_start(RowBody *b)
{
  if (b->body->integrator->has_inertia) ok(BodySetInitialState(b->body, Moving, NULL));
  ok(BodyIntegrate(b->body));
  ok(BodySave(b->body));
}

static inline void row_body_destroy(RowBody *b)
{
  bar_destroy(&b->body, b->options);
}

static inline void know_all_rows(RowBody *b)
{
  ok(BodyExtendCompliance(b->body, b->n, b->global));
}

/* Displacement of row i, k substeps after a unit hat on row j */
static inline PetscReal compliance_of(RowBody *b, PetscInt k, PetscInt i, PetscInt j)
{
  const PetscScalar *matrix;
  const PetscInt    *place;
  PetscInt           leading;

  ok(BodyGetCompliance(b->body, k, &place, &leading, &matrix));
  assert_true(place[b->global[i]] >= 0 && place[b->global[j]] >= 0);
  return matrix[place[b->global[j]] * leading + place[b->global[i]]];
}

static inline void set_row_conditions(RowBody *b, const BodyCondition conditions[])
{
  BodyCondition mine[MOST_ROWS];

  for (PetscInt i = 0; i < b->rows.local; i++) mine[i] = conditions[b->rows.which[i]];
  ok(BodySetConditions(b->body, mine));
}

static inline PetscErrorCode set_roles(RowBody *b, const BodyCondition roles[])
{
  BodyCondition mine[MOST_ROWS];
  BodyWord      word;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < b->rows.local; i++) mine[i] = roles[b->rows.which[i]];
  PetscCall(BodyProposeRoles(b->body, mine, &word));
  if (word.n)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, word.values, (PetscMPIInt)word.n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)b->body)));
  PetscCall(BodyTakeRoles(b->body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline void set_row_roles(RowBody *b, const BodyCondition roles[])
{
  ok(set_roles(b, roles));
}
