/* Displacements of nodes under unit forces on them, at the end of a controller step of many substeps of an explicit body, by these substeps
   where they count alone. In each substep a force is felt one element farther, and what is far from the nodes asked for when the step ends
   does not come back to them in time. Ahead of the wave displacements fall below round-off: nodes join as their neighbours have moved. */
#include "complianceimpl.h"
#include <impakt/private/simd.h>

/* Neighbours of a node below this part of the largest displacement do not move. Columns of nonlinear bodies, undeformed, err more. */
#define STILL           1e-12
#define STILL_NONLINEAR 1e-5
#define TOGETHER        SIMD_WIDTH /* columns that are made at once: of nodes near each other, as neighbours in the numbering mostly are */

typedef struct {
  PetscInt           dim, n;           /* nodes */
  const PetscInt    *begin, *columns;  /* of the stiffness, all rows of a node alike */
  const PetscScalar *values, *inverse; /* of the stiffness; of the lumped mass */
  PetscInt          *distance;         /* per node: elements to the nearest one asked for */
  PetscInt           n_moved, *moved;  /* nodes that move, in the order in which they have joined */
  PetscBool         *moves, *spreads;  /* per node: it does; its neighbours do */
  PetscScalar       *u, *way, *a;      /* per displacement, for each column: itself; how it goes in a substep; its acceleration */
} Front;

static void Join(Front *front, PetscInt node)
{
  if (front->moves[node]) return;
  front->moves[node]             = PETSC_TRUE;
  front->moved[front->n_moved++] = node;
}

static PetscReal Largest(const Front *front, PetscInt node)
{
  const PetscInt n       = front->dim * TOGETHER;
  PetscReal      largest = 0;

  for (PetscInt i = node * n; i < (node + 1) * n; i++) largest = PetscMax(largest, PetscAbsScalar(front->u[i]));
  return largest;
}

/* Neighbours of nodes that have moved join, as long as they can act on nodes asked for in the substeps that are left */
static void Spread(Front *front, PetscInt left, PetscReal least)
{
  const PetscInt dim = front->dim;

  for (PetscInt k = 0, n = front->n_moved; k < n; k++) {
    const PetscInt node = front->moved[k];

    if (front->spreads[node] || front->distance[node] > left || Largest(front, node) <= least) continue;
    front->spreads[node] = PETSC_TRUE;
    for (PetscInt e = front->begin[node * dim]; e < front->begin[node * dim + 1]; e += dim) {
      const PetscInt other = front->columns[e] / dim;

      if (front->distance[other] < left) Join(front, other);
    }
  }
}

/* The force on a node in each column but for the unit force. The rows of a node have their entries in the same places. */
SIMD_INLINE void GetForces(const Front *front, PetscInt dim, PetscInt node, SimdReal forces[])
{
  const PetscInt     first = front->begin[node * dim], n = front->begin[node * dim + 1] - first;
  const PetscScalar *values = front->values + first;

  for (PetscInt d = 0; d < dim; d++)
    for (PetscInt c = 0; c < TOGETHER; c++) forces[d][c] = 0;
  for (PetscInt e = 0; e < n; e++) {
    const PetscScalar *u = front->u + front->columns[first + e] * TOGETHER;

    for (PetscInt d = 0; d < dim; d++)
      for (PetscInt c = 0; c < TOGETHER; c++) forces[d][c] -= values[d * n + e] * u[c];
  }
}

/* One substep from displacements that are there, under a force on one of them in each column */
SIMD_CLONES static void Step(const Front *front, PetscInt left, PetscInt n, const PetscInt dofs[], PetscReal force, PetscReal dt)
{
  const PetscInt dim = front->dim;

  for (PetscInt k = 0; k < front->n_moved; k++) {
    const PetscInt node = front->moved[k];
    SimdReal       forces[3];

    if (front->distance[node] > left) continue;
    if (dim == 3) GetForces(front, 3, node, forces);
    else if (dim == 2) GetForces(front, 2, node, forces);
    else GetForces(front, 1, node, forces);
    for (PetscInt c = 0; c < n; c++)
      if (dofs[c] / dim == node) forces[dofs[c] % dim][c] += force;
    for (PetscInt d = 0; d < dim; d++)
      for (PetscInt c = 0; c < TOGETHER; c++) front->a[(node * dim + d) * TOGETHER + c] = forces[d][c] * front->inverse[node * dim + d];
  }
  for (PetscInt k = 0; k < front->n_moved; k++) {
    const PetscInt first = front->moved[k] * dim * TOGETHER;

    for (PetscInt i = first; i < first + dim * TOGETHER && front->distance[front->moved[k]] <= left; i++) {
      front->way[i] += PetscSqr(dt) * front->a[i];
      front->u[i] += front->way[i];
    }
  }
}

/* The columns of some displacements, in `u`, where the nodes asked for are */
static void MakeColumns(Front *front, PetscInt n, const PetscInt dofs[], BodyForceShape shape, PetscInt substeps, PetscReal dt,
                        PetscReal still)
{
  const PetscInt size = front->dim * TOGETHER;

  for (PetscInt k = 0; k < front->n_moved; k++) {
    const PetscInt node = front->moved[k];

    front->moves[node] = front->spreads[node] = PETSC_FALSE;
    for (PetscInt i = node * size; i < (node + 1) * size; i++) front->u[i] = front->way[i] = front->a[i] = 0;
  }
  front->n_moved = 0;
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt i = dofs[c] * TOGETHER + c;

    Join(front, dofs[c] / front->dim);
    if (shape == BODY_FORCE_CONSTANT) front->u[i] = front->way[i] = 0.5 * PetscSqr(dt) * front->inverse[dofs[c]];
  }
  for (PetscInt k = 1; k < substeps; k++) {
    PetscReal largest = 0;

    for (PetscInt c = 0; c < n; c++) largest = PetscMax(largest, Largest(front, dofs[c] / front->dim));
    Spread(front, substeps - k, still * largest);
    Step(front, substeps - k, n, dofs, shape == BODY_FORCE_CONSTANT ? 1 : (PetscReal)k / (PetscReal)substeps, dt);
  }
}

/* How many nodes away each node is from those of some displacements, as far as the substeps reach; `queue`: room for all nodes */
static void FindDistances(Front *front, PetscInt n, const PetscInt dofs[], PetscInt most, PetscInt queue[])
{
  PetscInt count = 0;

  for (PetscInt i = 0; i < n; i++) {
    if (front->distance[dofs[i] / front->dim] == 0) continue;
    front->distance[dofs[i] / front->dim] = 0;
    queue[count++]                        = dofs[i] / front->dim;
  }
  for (PetscInt k = 0; k < count && front->distance[queue[k]] < most; k++) {
    const PetscInt row = queue[k] * front->dim, next = front->distance[queue[k]] + 1;

    for (PetscInt e = front->begin[row]; e < front->begin[row + 1]; e += front->dim) {
      const PetscInt other = front->columns[e] / front->dim;

      if (front->distance[other] <= next) continue;
      front->distance[other] = next;
      queue[count++]         = other;
    }
  }
}

/* FrontCreateMatrix - stiffness of the undeformed body at nodes from which waves from contact nodes come back within a controller step */
PetscErrorCode FrontCreateMatrix(Body body, Mat *stiffness)
{
  const PetscInt n = body->model.element->nodes, count = body->model.element->count, *nodes = body->mesh.connectivity;
  PetscBool     *marked, *reached;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(body->mesh.local_nodes, &reached));
  PetscCall(PetscCalloc1(count, &marked));
  PetscCall(PetscArraycpy(reached, body->layer.contains, body->mesh.local_nodes));
  for (PetscInt ring = 0; ring <= (body->time.substeps + 1) / 2; ring++) {
    for (PetscInt i = 0; i < count * n; i++) marked[i / n] = (PetscBool)(marked[i / n] || reached[nodes[i]]);
    for (PetscInt i = 0; i < count * n; i++) reached[nodes[i]] = (PetscBool)(reached[nodes[i]] || marked[i / n]);
  }
  PetscCall(BodyCreateMatrix(body, marked, stiffness));
  PetscCall(BodyAssembleTangent(body, NULL, marked, *stiffness));
  PetscCall(PetscFree(marked));
  PetscCall(PetscFree(reached));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FrontProbe - columns of displacements, of a body on one rank with its stiffness, where all forces are but those on dashpots */
PetscErrorCode FrontProbe(Body body, Mat stiffness, BodyForceShape shape, PetscInt n, const PetscInt dofs[], Compliance compliance)
{
  Front           front   = {.dim = body->mesh.dim, .n = body->mesh.owned_nodes};
  const PetscInt  size    = front.n * front.dim * TOGETHER, *known;
  const PetscReal still   = body->model.linear ? STILL : STILL_NONLINEAR;
  const Vec       inverse = body->work.nodes[0], column = body->work.nodes[1];
  PetscScalar    *values;
  PetscInt        n_rows, n_known, some[TOGETHER], count = 0;
  PetscBool       done;

  PetscFunctionBegin;
  PetscCall(MatGetRowIJ(stiffness, 0, PETSC_FALSE, PETSC_FALSE, &n_rows, &front.begin, &front.columns, &done));
  PetscCall(MatSeqAIJGetArrayRead(stiffness, &front.values));
  PetscCall(VecCopy(body->mass.inverse, inverse));
  PetscCall(BodyZeroHeld(body, inverse));
  PetscCall(VecGetArrayRead(inverse, &front.inverse));
  PetscCall(PetscCalloc3(size, &front.u, size, &front.way, size, &front.a));
  PetscCall(PetscCalloc2(front.n, &front.moves, front.n, &front.spreads));
  PetscCall(PetscMalloc2(front.n, &front.distance, front.n, &front.moved));
  for (PetscInt i = 0; i < front.n; i++) front.distance[i] = PETSC_INT_MAX;
  ComplianceGetRows(compliance, &n_known, &known, NULL);
  FindDistances(&front, n_known, known, body->time.substeps, front.moved);
  FindDistances(&front, n, dofs, body->time.substeps, front.moved);
  for (PetscInt i = 0; i < n; i++) {
    if (!ComplianceKnows(compliance, dofs[i])) some[count++] = dofs[i];
    if (!count || (count < TOGETHER && i < n - 1)) continue;
    MakeColumns(&front, count, some, shape, body->time.substeps, body->time.step, still);
    PetscCall(VecGetArrayWrite(column, &values));
    for (PetscInt c = 0; c < count; c++) {
      ComplianceGetRows(compliance, &n_known, &known, NULL);
      for (PetscInt k = 0; k < n_known; k++) values[known[k]] = front.u[known[k] * TOGETHER + c];
      values[some[c]] = front.u[some[c] * TOGETHER + c];
      PetscCall(ComplianceSetColumn(compliance, some[c], values));
    }
    PetscCall(VecRestoreArrayWrite(column, &values));
    count = 0;
  }
  PetscCall(PetscFree2(front.distance, front.moved));
  PetscCall(PetscFree2(front.moves, front.spreads));
  PetscCall(PetscFree3(front.u, front.way, front.a));
  PetscCall(VecRestoreArrayRead(inverse, &front.inverse));
  PetscCall(MatSeqAIJRestoreArrayRead(stiffness, &front.values));
  PetscCall(MatRestoreRowIJ(stiffness, 0, PETSC_FALSE, PETSC_FALSE, &n_rows, &front.begin, &front.columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}
