/* The state of a body as tables, by which a run is continued on another number of ranks. What solvers know is found anew, to round-off.
   Factors of a nonlinear body, which depend on displacements of earlier steps, are made again where they were made. */
#include <body/rows/complianceimpl.h>
#include <checkpoint/statelist.h>
#include "bodyvisit.h"

/* What is beside the nodes: two numbers of the factors */
enum { N_FACTORS = 2 };

/* Vectors of a body, a line for each node; any of them may be NULL */
static PetscErrorCode VisitVecs(Body body, const char name[], PetscInt n_vecs, const Vec vecs[], Tables tables)
{
  const PetscInt dim = body->mesh.dim, n = body->mesh.owned_nodes;
  StateList      list = {.n = n};
  PetscReal     *keys;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(TABLES_KEY * n, &keys));
  for (PetscInt i = 0; i < n; i++) PetscCall(PetscArraycpy(keys + TABLES_KEY * i, body->mesh.coordinates + i * dim, dim));
  for (PetscInt k = 0; k < n_vecs; k++) {
    list.arrays[k].per = dim;
    if (vecs[k] && TablesLoads(tables)) PetscCall(VecGetArrayWrite(vecs[k], &list.arrays[k].reals));
    else if (vecs[k]) PetscCall(VecGetArrayRead(vecs[k], (const PetscScalar **)&list.arrays[k].reals));
  }
  PetscCall(StateListVisitNodes(&list, 0, n, 1, keys, name, tables));
  for (PetscInt k = 0; k < n_vecs; k++) {
    if (vecs[k] && TablesLoads(tables)) PetscCall(VecRestoreArrayWrite(vecs[k], &list.arrays[k].reals));
    else if (vecs[k]) PetscCall(VecRestoreArrayRead(vecs[k], (const PetscScalar **)&list.arrays[k].reals));
  }
  PetscCall(PetscFree(keys));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the factors of a nonlinear layer have been made; loading, where they are made again */
static PetscErrorCode VisitPoint(Body body, Tables tables)
{
  const PetscBool loads              = TablesLoads(tables);
  PetscReal       numbers[N_FACTORS] = {0, 0};
  Vec             point;

  PetscFunctionBegin;
  if (body->model.linear || !body->integrator->ops.copypoint) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDuplicate(body->state.u, &point));
  PetscCall(VecZeroEntries(point));
  if (!loads) PetscCall((*body->integrator->ops.copypoint)(body, PETSC_FALSE, point, numbers));
  if (!loads && body->local) PetscCallMPI(MPI_Bcast(numbers, N_FACTORS, MPIU_REAL, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  PetscCall(VisitVecs(body, "linearised at", 1, &point, tables));
  PetscCall(TablesVisitNumbers(tables, "factors", N_FACTORS, numbers));
  if (loads) PetscCall((*body->integrator->ops.copypoint)(body, PETSC_TRUE, point, numbers));
  PetscCall(VecDestroy(&point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The tables of a body after an accepted step; loading, its first state, after BodyVisitShared(). Collective. */
PetscErrorCode BodyVisitTables(Body body, Tables tables)
{
  PetscReal moves = body->integrator->has_inertia;

  PetscFunctionBegin;
  PetscCall(TablesBegin(tables, body->hdr.name));
  PetscCall(VisitVecs(body, "nodes", STATE_TABLE, body->state.vecs, tables));
  PetscCall(TablesVisitNumbers(tables, "inertia", 1, &moves));
  PetscCall(BodyVisitHistory(body, tables));
  if (TablesLoads(tables)) {
    PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
    PetscCall(BodyStateCopy(body, &body->state, &body->saved));
    PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  }
  PetscCall(VisitPoint(body, tables));
  if (TablesLoads(tables) && body->integrator->ops.save) PetscCall((*body->integrator->ops.save)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a body is to find the state that it begins with */
typedef struct {
  Tables    tables;
  PetscBool moves; /* the body had inertia there: else its velocities mean nothing */
} Start;

/* The state of the node at a place, for BodySetInitialState() */
static PetscErrorCode FindState(PetscInt dim, const PetscReal x[], PetscScalar u[], PetscScalar v[], void *context)
{
  const Start     *start           = (const Start *)context;
  PetscReal        key[TABLES_KEY] = {0};
  const PetscReal *packed;
  PetscInt         n, row;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(key, x, dim));
  PetscCall(TablesGet(start->tables, "nodes", TABLES_KEY + STATE_TABLE * dim, &n, &packed));
  PetscCall(TablesLookFor(start->tables, "nodes", key, &row));
  PetscCheck(row >= 0, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "-restart_state: the checkpoint has no node at (%.9g, %.9g, %.9g) m; the meshes must be the same", (double)key[0],
             (double)key[1], (double)key[2]);
  packed += row * (TABLES_KEY + STATE_TABLE * dim) + TABLES_KEY;
  PetscCall(PetscArraycpy(u, packed, dim));
  if (start->moves) PetscCall(PetscArraycpy(v, packed + dim, dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The start of a body from the tables of another run with the same mesh, if they have it: displacements, what its material has gone
   through, and velocities unless it had no inertia. Collective. */
PetscErrorCode BodyTakeState(Body body, Tables tables, PetscBool *found)
{
  const PetscInt dim = body->mesh.dim;
  PetscInt       width;
  PetscReal      moves;
  Start          start = {.tables = tables};

  PetscFunctionBegin;
  PetscCall(TablesBegin(tables, body->hdr.name));
  width  = TablesGetWidth(tables, "nodes");
  *found = (PetscBool)(width > 0);
  if (!*found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(width == TABLES_KEY + STATE_TABLE * dim, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-restart_state: body '%s' has %" PetscInt_FMT " dimensions there, and %" PetscInt_FMT " here", body->hdr.name,
             (width - TABLES_KEY) / STATE_TABLE, dim);
  PetscCall(TablesVisitNumbers(tables, "inertia", 1, &moves));
  start.moves = (PetscBool)(moves != 0);
  PetscCall(BodyTakeHistory(body, tables)); /* first: stresses of the displacements follow from it */
  PetscCall(BodySetInitialState(body, FindState, &start));
  PetscCall(BodyNotePlasticBefore(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of BodyUpdateInterface() are those of the last accepted step; after BodyVisitTables(). Collective. */
PetscErrorCode BodyTakeRows(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyHandoverEnd(body));
  body->start.changed = body->iterate.known = body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one rank alone knows of a local body, to all ranks */
static PetscErrorCode TellRanks(Body body)
{
  PetscReal *const values[] = {&body->state.external_work, &body->state.damping_work, &body->time.stable_now, &body->time.stable_found,
                               &body->time.thinness};
  PetscReal        told[PETSC_STATIC_ARRAY_LENGTH(values)];

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(values); k++) told[k] = *values[k];
  PetscCallMPI(
      MPI_Bcast(told, (PetscMPIInt)PETSC_STATIC_ARRAY_LENGTH(values), MPIU_REAL, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(values); k++) *values[k] = told[k];
  if (body->integrator->ops.agree) PetscCall((*body->integrator->ops.agree)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyVisitShared - what all ranks have of the state of a body, to or from a checkpoint */
PetscErrorCode BodyVisitShared(Body body, Checkpoint checkpoint)
{
  BodyState *state = &body->state;

  PetscFunctionBegin;
  if (body->local && !CheckpointLoads(checkpoint)) PetscCall(TellRanks(body));
  PetscCall(CheckpointBegin(checkpoint, body->hdr.name));
  PetscCall(CheckpointCheckInts(checkpoint, "dimensions", 1, &body->mesh.dim));
  PetscCall(CheckpointCheckInts(checkpoint, "substeps of a step", 1, &body->time.substeps));
  PetscCall(CheckpointVisitReals(checkpoint, "external work", 1, &state->external_work));
  PetscCall(CheckpointVisitReals(checkpoint, "damping work", 1, &state->damping_work));
  PetscCall(CheckpointVisitReals(checkpoint, "plastic work before", 1, &body->plastic_before));
  PetscCall(CheckpointVisitReals(checkpoint, "time", 1, &state->time));
  PetscCall(CheckpointVisitInts(checkpoint, "step", 1, &state->step));
  PetscCall(CheckpointVisitInts(checkpoint, "accepted level", 1, &body->time.accepted_level));
  PetscCall(CheckpointVisitReals(checkpoint, "stable step now", 1, &body->time.stable_now));
  PetscCall(CheckpointVisitReals(checkpoint, "stable step found", 1, &body->time.stable_found));
  PetscCall(CheckpointVisitReals(checkpoint, "thinness", 1, &body->time.thinness));
  PetscCall(CheckpointVisitInt64s(checkpoint, "substeps", 1, &body->statistics.substeps));
  body->saved.external_work = state->external_work;
  body->saved.damping_work  = state->damping_work;
  body->saved.time          = state->time;
  body->saved.step          = state->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}
