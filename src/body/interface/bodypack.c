/* The state of a body as a table of its nodes, by which a run is continued on another number of ranks: to round-off, since what solvers and
   compliance know is found anew. */
#include <body/layout/bodyimpl.h>
#include "bodyvisit.h"

/* The vectors of the state that are packed; a state without loads has no applied forces, one without dashpots none of theirs */
enum { N_VECS = 5 };

static void GetVecs(BodyState *state, Vec vecs[N_VECS])
{
  vecs[0] = state->u;
  vecs[1] = state->v;
  vecs[2] = state->a;
  vecs[3] = state->applied;
  vecs[4] = state->damping;
}

static void GetKey(Body body, PetscInt node, PetscReal key[TABLES_KEY])
{
  for (PetscInt d = 0; d < TABLES_KEY; d++) key[d] = d < body->mesh.dim ? body->mesh.coordinates[node * body->mesh.dim + d] : 0;
}

/*
  BodyPack - adds the table of a body

  Collective

  Input Parameters:
+ body   - the `Body`, after an accepted step
- tables - the tables
*/
PetscErrorCode BodyPack(Body body, Tables tables)
{
  const PetscInt dim = body->mesh.dim, n = body->mesh.owned_nodes, width = TABLES_KEY + N_VECS * dim;
  PetscReal     *packed;
  Vec            vecs[N_VECS];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * width, &packed));
  GetVecs(&body->state, vecs);
  for (PetscInt i = 0; i < n; i++) GetKey(body, i, packed + i * width);
  for (PetscInt k = 0; k < N_VECS; k++) {
    const PetscScalar *values;

    if (!vecs[k]) continue;
    PetscCall(VecGetArrayRead(vecs[k], &values));
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt d = 0; d < dim; d++) packed[i * width + TABLES_KEY + k * dim + d] = PetscRealPart(values[i * dim + d]);
    PetscCall(VecRestoreArrayRead(vecs[k], &values));
  }
  PetscCall(TablesAdd(tables, body->hdr.name, n, width, packed));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  BodyUnpack - the state of a body from the table of a run with any number of ranks

  Collective

  Input Parameters:
+ body   - the `Body`, in its first state, whose numbers for all ranks have been loaded by BodyVisitShared()
- tables - the tables
*/
PetscErrorCode BodyUnpack(Body body, Tables tables)
{
  const PetscInt   dim = body->mesh.dim, n = body->mesh.owned_nodes, width = TABLES_KEY + N_VECS * dim;
  const PetscReal *packed;
  PetscInt         n_all, *rows;
  Vec              vecs[N_VECS];

  PetscFunctionBegin;
  PetscCall(TablesGet(tables, body->hdr.name, width, &n_all, &packed));
  PetscCall(PetscMalloc1(n, &rows));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal key[TABLES_KEY];

    GetKey(body, i, key);
    PetscCall(TablesFind(tables, body->hdr.name, key, &rows[i]));
  }
  GetVecs(&body->state, vecs);
  for (PetscInt k = 0; k < N_VECS; k++) {
    PetscScalar *values;

    if (!vecs[k]) continue;
    PetscCall(VecGetArrayWrite(vecs[k], &values));
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt d = 0; d < dim; d++) values[i * dim + d] = packed[rows[i] * width + TABLES_KEY + k * dim + d];
    PetscCall(VecRestoreArrayWrite(vecs[k], &values));
  }
  PetscCall(PetscFree(rows));
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  PetscCall(BodyStateCopy(&body->state, &body->saved));
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  if (!body->model.linear && body->integrator->ops.renew) PetscCall((*body->integrator->ops.renew)(body));
  if (body->integrator->ops.save) PetscCall((*body->integrator->ops.save)(body, BODY_SLOT_SAVED));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyTakeRows - the rows of BodyUpdateInterface() are those of the last accepted step; after BodyUnpack() */
PetscErrorCode BodyTakeRows(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyHandoverEnd(body));
  body->start.changed = body->iterate.known = body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyVisitShared - what all ranks have of the state of a body, to or from a checkpoint */
PetscErrorCode BodyVisitShared(Body body, Checkpoint checkpoint)
{
  BodyState *state = &body->state;

  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, body->hdr.name));
  PetscCall(CheckpointCheckInts(checkpoint, "dimensions", 1, &body->mesh.dim));
  PetscCall(CheckpointCheckInts(checkpoint, "substeps of a step", 1, &body->time.substeps));
  PetscCall(CheckpointVisitReals(checkpoint, "external work", 1, &state->external_work));
  PetscCall(CheckpointVisitReals(checkpoint, "damping work", 1, &state->damping_work));
  PetscCall(CheckpointVisitReals(checkpoint, "time", 1, &state->time));
  PetscCall(CheckpointVisitInts(checkpoint, "step", 1, &state->step));
  PetscCall(CheckpointVisitInts(checkpoint, "accepted level", 1, &body->time.accepted_level));
  PetscCall(CheckpointVisitInt64s(checkpoint, "substeps", 1, &body->statistics.substeps));
  body->saved.external_work = state->external_work;
  body->saved.damping_work  = state->damping_work;
  body->saved.time          = state->time;
  body->saved.step          = state->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}
