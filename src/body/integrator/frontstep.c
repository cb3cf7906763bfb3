/*
   A controller step of an explicit body that is made again under other contact forces, in the nodes that the change has reached. In each
   substep it gets one element farther. What all nodes near enough did when the step was made before is recorded: where each was in a
   substep, and with which velocity at its middle. A node joins where one of the two turns out otherwise, in any bit, so that the state at
   the end is to the last bit that of a step of all nodes.

   Nodes that have joined act on their neighbours. These are stepped as well, and their forces need all elements around them, and the
   displacements of the nodes of these. So there are three rings of nodes, each one element farther than the one before.
*/
#include "explicitimpl.h"
#include <impakt/private/simd.h>

#define MOST_VECTORS 40 /* a record that takes more room than so many vectors of the body is not made */

typedef enum { STEP_WHOLE, STEP_RECORDED, STEP_FRONT } Mode;
typedef enum { RING_FAR, RING_READ, RING_STEPPED, RING_JOINED } Ring;

struct _n_FrontStep {
  Mode     mode;   /* of the controller step that is being made */
  PetscInt passes; /* so often that from the saved state has been made */
  /* which step the record is of: states of displacement and velocity that it begins in, and its substeps */
  PetscObjectState of[2];
  PetscReal        dt;
  PetscInt         substeps, n_start, *start; /* dofs of contact nodes, which the change comes from */
  PetscBool        valid;
  /* nodes that are recorded, by their distance from contact nodes in elements; place of each among them, or -1; numbers of them that are in
     each substep, and where its part of the record begins */
  PetscInt     n, *order, *place, *count;
  size_t      *at, room;
  PetscScalar *record; /* displacement, then velocity of each */
  BodyState    last;   /* at the end */
  Vec          a;      /* acceleration at the start */
  /* the front */
  PetscInt     n_stepped, *stepped, n_read, *read; /* nodes as they have come; read ones may be stepped meanwhile */
  Ring        *ring;                               /* of each node */
  Ring        *reached;                            /* of each element: that all of its nodes are in at least */
  PetscBool   *skips;                              /* per batch of elements: none of them has a stepped node */
  PetscInt64   elements;                           /* whose forces have been computed in this controller step */
  NodeElements around;                             /* of the body */
};

PetscErrorCode FrontStepDestroy(FrontStep *front)
{
  FrontStep f = *front;

  PetscFunctionBegin;
  if (!f) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyStateDestroy(&f->last));
  PetscCall(VecDestroy(&f->a));
  PetscCall(PetscFree(f->start));
  PetscCall(PetscFree(f->record));
  PetscCall(PetscFree2(f->count, f->at));
  PetscCall(PetscFree5(f->order, f->place, f->stepped, f->read, f->ring));
  PetscCall(PetscFree2(f->reached, f->skips));
  PetscCall(PetscFree(*front));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether contact forces that go over from other rows act within the step */
static PetscBool HandsOver(Body body)
{
  if (!BodyHandsOver(body)) return PETSC_FALSE;
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (body->rows.handover.rest[i] != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether nodes that the change of contact forces has not reached are as they were, and nothing is summed up over all nodes */
static PetscBool IsPossible(Body body)
{
  const BodyRows *rows = &body->rows;

  if (body->mesh.ghosted || body->mesh.whole || body->time.substeps == 1 || !BodyAnswersByNodes(body)) return PETSC_FALSE;
  if (!rows->global || !rows->n_forced || rows->n_prescribed || rows->n_robin || rows->any_by_mean || rows->nodal_force ||
      rows->exchange.open)
    return PETSC_FALSE;
  return (PetscBool) !(body->loads || body->held.any || body->history || body->state.damping || body->unloaded || HandsOver(body));
}

static PetscErrorCode Create(Body body, FrontStep *front)
{
  const PetscInt n = body->mesh.owned_nodes, count = body->model.element->count;
  FrontStep      f;

  PetscFunctionBegin;
  PetscCall(PetscNew(front));
  f = *front;
  PetscCall(BodyGetNodeElements(body, &f->around));
  PetscCall(BodyStateCreate(body, PETSC_TRUE, &f->last));
  PetscCall(BodyCreateVec(body, &f->a));
  PetscCall(PetscMalloc1(n * body->mesh.dim, &f->start));
  PetscCall(PetscMalloc5(n, &f->order, n, &f->place, n, &f->stepped, n, &f->read, n, &f->ring));
  PetscCall(PetscMalloc2(count, &f->reached, count / SIMD_WIDTH + 1, &f->skips));
  for (PetscInt i = 0; i < n; i++) f->ring[i] = RING_FAR;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which nodes a record of the step has to have in each substep: those that may be read; none where they are too many */
static PetscErrorCode FindNodes(Body body, FrontStep front)
{
  const PetscInt dim = body->mesh.dim, substeps = body->time.substeps;
  PetscBool      same     = (PetscBool)(front->n_start == body->nodes.n && front->substeps == substeps);
  PetscInt      *distance = front->place;
  size_t         size     = 0;

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(front->start, body->nodes.dofs, body->nodes.n, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  if (front->substeps != substeps) {
    PetscCall(PetscFree2(front->count, front->at));
    PetscCall(PetscMalloc2(substeps + 1, &front->count, substeps + 1, &front->at));
  }
  front->n_start  = body->nodes.n;
  front->substeps = substeps;
  PetscCall(PetscArraycpy(front->start, body->nodes.dofs, body->nodes.n));
  for (PetscInt i = 0; i < body->mesh.owned_nodes; i++) distance[i] = PETSC_INT_MAX;
  front->n = 0;
  PetscCall(NodeElementsFindDistances(front->around, front->n_start, dim, front->start, substeps + 1, distance, &front->n, front->order));
  for (PetscInt k = 1, n = 0; k <= substeps; k++) {
    while (n < front->n && distance[front->order[n]] <= k + 1) n++;
    front->count[k] = n;
    front->at[k]    = size;
    size += (size_t)(2 * dim * n);
  }
  for (PetscInt i = 0; i < body->mesh.owned_nodes; i++) front->place[i] = -1;
  for (PetscInt k = 0; k < front->n; k++) front->place[front->order[k]] = k;
  if (size > (size_t)MOST_VECTORS * (size_t)(body->mesh.owned_nodes * dim)) front->n = 0;
  else if (size > front->room) {
    PetscCall(PetscFree(front->record));
    PetscCall(PetscMalloc1(size, &front->record));
    front->room = size;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscScalar *Recorded(FrontStep front, PetscInt dim, PetscInt substep, PetscInt node)
{
  return front->record + front->at[substep] + (size_t)(2 * dim * front->place[node]);
}

/* The elements around a node are wanted, which reads all of their nodes */
static void StepNode(FrontStep front, PetscInt node)
{
  const NodeElements around = front->around;

  if (front->ring[node] >= RING_STEPPED) return;
  front->ring[node]                  = RING_STEPPED;
  front->stepped[front->n_stepped++] = node;
  for (PetscInt k = around->begin[node]; k < around->begin[node + 1]; k++) {
    const PetscInt e = around->elements[k];

    if (front->reached[e] >= RING_READ) continue;
    front->reached[e]            = RING_READ;
    front->skips[e / SIMD_WIDTH] = PETSC_FALSE;
    for (PetscInt i = 0; i < around->nodes; i++) {
      const PetscInt other = around->connectivity[e * around->nodes + i];

      if (front->ring[other] != RING_FAR) continue;
      front->ring[other]           = RING_READ;
      front->read[front->n_read++] = other;
    }
  }
}

static void JoinNode(FrontStep front, PetscInt node)
{
  const NodeElements around = front->around;

  front->ring[node] = RING_JOINED;
  for (PetscInt k = around->begin[node]; k < around->begin[node + 1]; k++) {
    const PetscInt e = around->elements[k];

    if (front->reached[e] >= RING_STEPPED) continue;
    for (PetscInt i = 0; i < around->nodes; i++) StepNode(front, around->connectivity[e * around->nodes + i]);
    front->reached[e] = RING_STEPPED;
  }
}

/* No node but contact nodes, whose forces may be others. Whether others begin with another acceleration. */
static PetscErrorCode BeginFront(Body body, FrontStep front, PetscBool *others)
{
  const PetscInt     dim = body->mesh.dim, n = body->mesh.owned_nodes;
  const PetscScalar *a;
  PetscScalar       *start;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < front->n_read; k++) front->ring[front->read[k]] = RING_FAR;
  for (PetscInt k = 0; k < front->n_stepped; k++) front->ring[front->stepped[k]] = RING_FAR;
  for (PetscInt e = 0; e < front->around->count; e++) {
    front->reached[e]            = RING_FAR;
    front->skips[e / SIMD_WIDTH] = PETSC_TRUE;
  }
  front->n_read = front->n_stepped = 0;
  for (PetscInt k = 0; k < front->n_start; k++) StepNode(front, front->start[k] / dim);
  *others = PETSC_FALSE;
  PetscCall(VecGetArrayRead(body->state.a, &a));
  PetscCall(VecGetArray(front->a, &start));
  for (PetscInt i = 0; i < n * dim; i++) {
    if (start[i] != a[i] && front->ring[i / dim] != RING_STEPPED) *others = PETSC_TRUE;
    start[i] = a[i];
  }
  PetscCall(VecRestoreArray(front->a, &start));
  PetscCall(VecRestoreArrayRead(body->state.a, &a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How the controller step that begins is made. The first one from a state is recorded where the last one was made more than once. */
static PetscErrorCode Begin(Body body, FrontStep *at)
{
  const Vec        saved[2] = {body->saved.u, body->saved.v};
  PetscObjectState of[2];
  FrontStep        front = *at;
  PetscBool        same = (PetscBool)(front && front->dt == body->time.step), others = PETSC_TRUE;
  PetscInt         passes = front ? front->passes : 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscObjectStateGet((PetscObject)saved[k], &of[k]));
    same = (PetscBool)(same && of[k] == front->of[k]);
  }
  if (!front) {
    PetscCall(Create(body, at));
    front = *at;
  }
  PetscCall(PetscArraycpy(front->of, of, 2));
  front->dt       = body->time.step;
  front->passes   = same ? passes + 1 : 1;
  front->elements = 0;
  if (!body->nodes.force) PetscCall(BodyListContactDofs(body));
  if (same && front->valid && front->substeps == body->time.substeps && front->n_start == body->nodes.n) {
    PetscCall(PetscArraycmp(front->start, body->nodes.dofs, body->nodes.n, &same));
    if (same) PetscCall(BeginFront(body, front, &others));
  }
  front->valid = PETSC_FALSE;
  front->mode  = !others ? STEP_FRONT : passes > 1 || front->passes > 1 ? STEP_RECORDED : STEP_WHOLE;
  if (front->mode != STEP_RECORDED) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindNodes(body, front));
  if (!front->n) front->mode = STEP_WHOLE;
  else PetscCall(VecCopy(body->state.a, front->a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Records where nodes are when the forces of a substep of all nodes are computed; V: the velocity at its middle */
PetscErrorCode FrontStepNote(FrontStep front, Body body, Vec U, Vec V)
{
  const PetscInt     dim = body->mesh.dim, substep = body->time.substep + 1;
  const PetscScalar *u, *v;

  PetscFunctionBegin;
  if (!front || front->mode != STEP_RECORDED) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(U, &u));
  PetscCall(VecGetArrayRead(V, &v));
  for (PetscInt k = 0; k < front->count[substep]; k++) {
    const PetscInt node   = front->order[k];
    PetscScalar   *record = front->record + front->at[substep] + (size_t)(2 * dim * k);

    for (PetscInt d = 0; d < dim; d++) {
      record[d]       = u[node * dim + d];
      record[dim + d] = v[node * dim + d];
    }
  }
  PetscCall(VecRestoreArrayRead(V, &v));
  PetscCall(VecRestoreArrayRead(U, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where stepped nodes get, which of them join, and where the nodes around them are */
static PetscErrorCode Move(Body body, FrontStep front)
{
  const PetscInt     dim = body->mesh.dim, substep = body->time.substep + 1, n_stepped = front->n_stepped;
  const PetscReal    dt = body->time.step, half = 0.5 * dt;
  const PetscScalar *a;
  PetscScalar       *u, *v;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->state.a, &a));
  PetscCall(VecGetArray(body->state.u, &u));
  PetscCall(VecGetArray(body->state.v, &v));
  for (PetscInt k = 0; k < n_stepped; k++) {
    const PetscInt node   = front->stepped[k];
    PetscScalar   *record = Recorded(front, dim, substep, node);

    for (PetscInt i = node * dim; i < (node + 1) * dim; i++) {
      v[i] += half * a[i];
      u[i] += dt * v[i];
    }
    if (front->ring[node] != RING_JOINED) {
      PetscBool same[2];

      PetscCall(PetscArraycmp(record, u + node * dim, dim, &same[0]));
      PetscCall(PetscArraycmp(record + dim, v + node * dim, dim, &same[1]));
      if (!same[0] || !same[1]) JoinNode(front, node);
    }
    PetscCall(PetscArraycpy(record, u + node * dim, dim));
    PetscCall(PetscArraycpy(record + dim, v + node * dim, dim));
  }
  for (PetscInt k = n_stepped; k < front->n_stepped; k++) {
    const PetscInt node = front->stepped[k];

    PetscCall(PetscArraycpy(v + node * dim, Recorded(front, dim, substep, node) + dim, dim));
    PetscCall(PetscArraycpy(u + node * dim, Recorded(front, dim, substep, node), dim));
  }
  for (PetscInt k = 0; k < front->n_read; k++) {
    const PetscInt node = front->read[k];

    if (front->ring[node] == RING_READ) PetscCall(PetscArraycpy(u + node * dim, Recorded(front, dim, substep, node), dim));
  }
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.u, &u));
  PetscCall(VecRestoreArrayRead(body->state.a, &a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The internal forces on stepped nodes */
static PetscErrorCode ComputeForces(Body body, FrontStep front)
{
  Element element;

  PetscFunctionBegin;
  PetscCall(BodyGetElement(body, &element));
  element->skips = front->skips;
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->state.internal_force));
  front->elements += ElementCountWanted(element);
  element->skips = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Accelerate(Body body, FrontStep front)
{
  const PetscInt     dim  = body->mesh.dim;
  const PetscReal    half = 0.5 * body->time.step, position = (PetscReal)(body->time.substep + 1) / body->time.substeps;
  const PetscScalar *outside, *internal, *inverse;
  PetscScalar       *a, *v;
  Vec                force = body->work.nodes[0];

  PetscFunctionBegin;
  PetscCall(BodyComputeOutsideForce(body, body->state.time, position, PETSC_TRUE, body->state.u, force));
  PetscCall(VecGetArrayRead(force, &outside));
  PetscCall(VecGetArrayRead(body->state.internal_force, &internal));
  PetscCall(VecGetArrayRead(body->mass.inverse, &inverse));
  PetscCall(VecGetArray(body->state.a, &a));
  PetscCall(VecGetArray(body->state.v, &v));
  for (PetscInt k = 0; k < front->n_stepped; k++)
    for (PetscInt i = front->stepped[k] * dim; i < (front->stepped[k] + 1) * dim; i++) {
      a[i] = (outside[i] - internal[i]) * inverse[i];
      v[i] += half * a[i];
    }
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArrayRead(body->mass.inverse, &inverse));
  PetscCall(VecRestoreArrayRead(body->state.internal_force, &internal));
  PetscCall(VecRestoreArrayRead(force, &outside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state at the end is that of the step that was made before, but for stepped nodes */
static PetscErrorCode End(Body body, FrontStep front)
{
  const Vec      now[]    = {body->state.u, body->state.v, body->state.a, body->state.internal_force};
  const Vec      before[] = {front->last.u, front->last.v, front->last.a, front->last.internal_force};
  const PetscInt dim      = body->mesh.dim;
  PetscReal      norm;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < 4; j++) {
    const PetscScalar *from;
    PetscScalar       *to;

    if (front->mode == STEP_FRONT) {
      PetscCall(VecGetArrayRead(now[j], &from));
      PetscCall(VecGetArray(before[j], &to));
      for (PetscInt k = 0; k < front->n_stepped; k++)
        PetscCall(PetscArraycpy(to + front->stepped[k] * dim, from + front->stepped[k] * dim, dim));
      PetscCall(VecRestoreArray(before[j], &to));
      PetscCall(VecRestoreArrayRead(now[j], &from));
      PetscCall(VecCopy(before[j], now[j]));
    } else PetscCall(VecCopy(now[j], before[j]));
  }
  PetscCall(BodyGetNorm(body, body->state.v, &norm));
  front->valid = (PetscBool)!PetscIsInfOrNanReal(norm);
  if (front->mode == STEP_FRONT)
    PetscCall(PetscInfo(body, "body '%s': step made again with %" PetscInt64_FMT " of %" PetscInt64_FMT " forces of elements\n",
                        ((PetscObject)body)->name, front->elements, (PetscInt64)front->around->count * body->time.substeps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A substep, by the TS or in the nodes of the front */
PetscErrorCode FrontStepMake(FrontStep *at, Body body)
{
  FrontStep front;

  PetscFunctionBegin;
  if (!IsPossible(body)) {
    if (*at) (*at)->mode = STEP_WHOLE;
    PetscCall(TSStep(body->time.ts));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!body->time.substep) PetscCall(Begin(body, at));
  front = *at;
  if (front->mode == STEP_FRONT) {
    PetscCall(Move(body, front));
    PetscCall(ComputeForces(body, front));
    PetscCall(Accelerate(body, front));
  } else PetscCall(TSStep(body->time.ts));
  if (front->mode != STEP_WHOLE && body->time.substep == body->time.substeps - 1) PetscCall(End(body, front));
  PetscFunctionReturn(PETSC_SUCCESS);
}
