/* Displacements of nodes under unit forces on them, at the end of a controller step of many substeps of an explicit body, by these substeps
   where they count alone. In each substep a force is felt one element farther, and what is far from the nodes asked for when the step ends
   does not come back to them in time. */
#include "complianceimpl.h"
#include <impakt/private/simd.h>

#define TOGETHER SIMD_WIDTH /* columns that are made at once: of nodes near each other, as neighbours in the numbering mostly are */

typedef struct {
  PetscInt           dim, n;           /* nodes */
  const PetscInt    *begin, *columns;  /* of the stiffness, all rows of a node alike */
  const PetscScalar *values, *inverse; /* of the stiffness; of the lumped mass */
  PetscInt          *back;             /* per node: elements to the nearest one asked for; the substeps, if these are less */
  PetscInt          *away;             /* the same to the nearest one with a force in some column: the substep in which the node joins */
  PetscInt           n_moved, *moved;  /* nodes that move, in the order in which they join */
  PetscScalar       *u, *way, *a;      /* per displacement, for each column: itself; how it goes in a substep; its acceleration */
} Front;

/* A node from which distances are counted, at the end of a list of such nodes */
static void Begin(PetscInt node, PetscInt distance[], PetscInt list[], PetscInt *n)
{
  if (distance[node] == 0) return;
  distance[node] = 0;
  list[(*n)++]   = node;
}

/* Lists the nodes around those listed, with their distances, as far as substeps reach; those alone that can act `back` in time (or NULL) */
static void Reach(const Front *front, PetscInt substeps, const PetscInt back[], PetscInt distance[], PetscInt list[], PetscInt *n)
{
  for (PetscInt k = 0; k < *n; k++) {
    const PetscInt row = list[k] * front->dim, next = distance[list[k]] + 1;

    for (PetscInt e = front->begin[row]; e < front->begin[row + 1]; e += front->dim) {
      const PetscInt other = front->columns[e] / front->dim;

      if (distance[other] <= next || (back && next + back[other] >= substeps)) continue;
      distance[other] = next;
      list[(*n)++]    = other;
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

/* Substep k from displacements that are there, under a force on one of them in each column, of nodes that have joined and still count */
SIMD_CLONES static void Step(const Front *front, PetscInt k, PetscInt left, PetscInt n, const PetscInt dofs[], PetscReal force,
                             PetscReal dt)
{
  const PetscInt dim = front->dim;

  for (PetscInt m = 0; m < front->n_moved && front->away[front->moved[m]] <= k; m++) {
    const PetscInt node = front->moved[m];
    SimdReal       forces[3];

    if (front->back[node] >= left) continue;
    if (dim == 3) GetForces(front, 3, node, forces);
    else if (dim == 2) GetForces(front, 2, node, forces);
    else GetForces(front, 1, node, forces);
    for (PetscInt c = 0; c < n; c++)
      if (dofs[c] / dim == node) forces[dofs[c] % dim][c] += force;
    for (PetscInt d = 0; d < dim; d++)
      for (PetscInt c = 0; c < TOGETHER; c++) front->a[(node * dim + d) * TOGETHER + c] = forces[d][c] * front->inverse[node * dim + d];
  }
  for (PetscInt m = 0; m < front->n_moved && front->away[front->moved[m]] <= k; m++) {
    const PetscInt first = front->moved[m] * dim * TOGETHER;

    for (PetscInt i = first; i < first + dim * TOGETHER && front->back[front->moved[m]] < left; i++) {
      front->way[i] += PetscSqr(dt) * front->a[i];
      front->u[i] += front->way[i];
    }
  }
}

/* The columns of some displacements, in `u`, where the nodes asked for are */
static void MakeColumns(Front *front, PetscInt n, const PetscInt dofs[], BodyForceShape shape, PetscInt substeps, PetscReal dt)
{
  const PetscInt size = front->dim * TOGETHER;

  for (PetscInt m = 0; m < front->n_moved; m++) {
    const PetscInt node = front->moved[m];

    front->away[node] = substeps;
    for (PetscInt i = node * size; i < (node + 1) * size; i++) front->u[i] = front->way[i] = 0;
  }
  front->n_moved = 0;
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt i = dofs[c] * TOGETHER + c;

    Begin(dofs[c] / front->dim, front->away, front->moved, &front->n_moved);
    if (shape == BODY_FORCE_CONSTANT) front->u[i] = front->way[i] = 0.5 * PetscSqr(dt) * front->inverse[dofs[c]];
  }
  Reach(front, substeps, front->back, front->away, front->moved, &front->n_moved);
  for (PetscInt k = 1; k < substeps; k++)
    Step(front, k, substeps - k, n, dofs, shape == BODY_FORCE_CONSTANT ? 1 : (PetscReal)k / (PetscReal)substeps, dt);
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
  Front          front   = {.dim = body->mesh.dim, .n = body->mesh.owned_nodes};
  const PetscInt size    = front.n * front.dim * TOGETHER, *known;
  const Vec      inverse = body->work.nodes[0], column = body->work.nodes[1];
  PetscScalar   *values;
  PetscInt       n_rows, n_known, some[TOGETHER], count = 0;
  PetscBool      done;

  PetscFunctionBegin;
  PetscCall(MatGetRowIJ(stiffness, 0, PETSC_FALSE, PETSC_FALSE, &n_rows, &front.begin, &front.columns, &done));
  PetscCall(MatSeqAIJGetArrayRead(stiffness, &front.values));
  PetscCall(VecCopy(body->mass.inverse, inverse));
  PetscCall(BodyZeroHeld(body, inverse));
  PetscCall(VecGetArrayRead(inverse, &front.inverse));
  PetscCall(PetscCalloc3(size, &front.u, size, &front.way, size, &front.a));
  PetscCall(PetscMalloc3(front.n, &front.back, front.n, &front.away, front.n, &front.moved));
  for (PetscInt i = 0; i < front.n; i++) front.back[i] = front.away[i] = body->time.substeps;
  ComplianceGetRows(compliance, &n_known, &known, NULL);
  for (PetscInt i = 0; i < n_known; i++) Begin(known[i] / front.dim, front.back, front.moved, &count);
  for (PetscInt i = 0; i < n; i++) Begin(dofs[i] / front.dim, front.back, front.moved, &count);
  Reach(&front, body->time.substeps, NULL, front.back, front.moved, &count);
  count = 0;
  for (PetscInt i = 0; i < n; i++) {
    if (!ComplianceKnows(compliance, dofs[i])) some[count++] = dofs[i];
    if (!count || (count < TOGETHER && i < n - 1)) continue;
    MakeColumns(&front, count, some, shape, body->time.substeps, body->time.step);
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
  PetscCall(PetscFree3(front.back, front.away, front.moved));
  PetscCall(PetscFree3(front.u, front.way, front.a));
  PetscCall(VecRestoreArrayRead(inverse, &front.inverse));
  PetscCall(MatSeqAIJRestoreArrayRead(stiffness, &front.values));
  PetscCall(MatRestoreRowIJ(stiffness, 0, PETSC_FALSE, PETSC_FALSE, &n_rows, &front.begin, &front.columns, &done));
  PetscFunctionReturn(PETSC_SUCCESS);
}
