/*
   Mass of elements all of whose nodes lie on contact surfaces, as tetrahedra in corners do: there is no inner node in the element to
   take it, so it goes to the inner nodes of the elements around.

   Each contact node holds its share of such elements at first. In a round, a node with inner neighbours hands its mass to them in
   equal parts (a neighbour counts once for each element shared); one without hands it to the other nodes of its elements, for the next
   round.
*/
#include "bodyimpl.h"

#define MAX_ROUNDS 8

static PetscErrorCode AddGhosts(Body body, Vec vec)
{
  PetscFunctionBegin;
  if (body->rows.size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGhostUpdateBegin(vec, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecGhostUpdateEnd(vec, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecGhostUpdateBegin(vec, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGhostUpdateEnd(vec, INSERT_VALUES, SCATTER_FORWARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OpenLocal(Body body, Vec vec, Vec *local, PetscScalar **array)
{
  PetscFunctionBegin;
  *local = vec;
  if (body->rows.size > 1) PetscCall(VecGhostGetLocalForm(vec, local));
  PetscCall(VecGetArray(*local, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CloseLocal(Body body, Vec vec, Vec *local, PetscScalar **array)
{
  PetscFunctionBegin;
  PetscCall(VecRestoreArray(*local, array));
  if (body->rows.size > 1) PetscCall(VecGhostRestoreLocalForm(vec, local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass of orphaned elements, in equal parts on their nodes; per node, the number of its neighbours that are inner ones, and of all.
   All are kept in the first component of a node's block. */
static PetscErrorCode CountAndCollect(Body body, Vec held, Vec inner, Vec all)
{
  const PetscInt n = body->element->nodes, dim = body->dim;
  PetscScalar    M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], *mass, *n_inner, *n_all;
  Vec            local[3];

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, held, &local[0], &mass));
  PetscCall(OpenLocal(body, inner, &local[1], &n_inner));
  PetscCall(OpenLocal(body, all, &local[2], &n_all));
  PetscCall(PetscArrayzero(mass, body->local_nodes * dim));
  PetscCall(PetscArrayzero(n_inner, body->local_nodes * dim));
  PetscCall(PetscArrayzero(n_all, body->local_nodes * dim));
  for (PetscInt e = 0; e < body->element->count; e++) {
    const PetscInt *nodes = body->connectivity + e * n;
    PetscInt        count = 0;
    PetscScalar     sum   = 0;

    for (PetscInt a = 0; a < n; a++) count += !body->in_layer[nodes[a]];
    for (PetscInt a = 0; a < n; a++) {
      n_inner[nodes[a] * dim] += count;
      n_all[nodes[a] * dim] += n - 1;
    }
    if (count) continue;
    PetscCall((*body->element->ops.mass)(body->element, e, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) sum += M[a * dim * n * dim + b * dim];
    for (PetscInt a = 0; a < n; a++) mass[nodes[a] * dim] += sum / n;
  }
  PetscCall(CloseLocal(body, all, &local[2], &n_all));
  PetscCall(CloseLocal(body, inner, &local[1], &n_inner));
  PetscCall(CloseLocal(body, held, &local[0], &mass));
  PetscCall(AddGhosts(body, held));
  PetscCall(AddGhosts(body, inner));
  PetscCall(AddGhosts(body, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One round: from `held` to `placed` (inner nodes), or to `next` (contact nodes) */
static PetscErrorCode HandOn(Body body, Vec held, Vec inner, Vec all, Vec placed, Vec next)
{
  const PetscInt n = body->element->nodes, dim = body->dim;
  PetscScalar   *mass, *n_inner, *n_all, *to_inner, *to_next;
  Vec            local[5];

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, held, &local[0], &mass));
  PetscCall(OpenLocal(body, inner, &local[1], &n_inner));
  PetscCall(OpenLocal(body, all, &local[2], &n_all));
  PetscCall(OpenLocal(body, placed, &local[3], &to_inner));
  PetscCall(OpenLocal(body, next, &local[4], &to_next));
  /* what has been placed is with the owners */
  PetscCall(PetscArrayzero(to_inner + body->owned_nodes * dim, (body->local_nodes - body->owned_nodes) * dim));
  PetscCall(PetscArrayzero(to_next, body->local_nodes * dim));
  for (PetscInt e = 0; e < body->element->count; e++) {
    const PetscInt *nodes = body->connectivity + e * n;

    for (PetscInt a = 0; a < n; a++) {
      const PetscInt from = nodes[a] * dim;

      if (mass[from] == 0) continue;
      for (PetscInt b = 0; b < n; b++) {
        const PetscInt to = nodes[b] * dim;

        if (n_inner[from] > 0 && !body->in_layer[nodes[b]]) to_inner[to] += mass[from] / n_inner[from];
        if (n_inner[from] == 0 && a != b) to_next[to] += mass[from] / n_all[from];
      }
    }
  }
  PetscCall(CloseLocal(body, next, &local[4], &to_next));
  PetscCall(CloseLocal(body, placed, &local[3], &to_inner));
  PetscCall(CloseLocal(body, all, &local[2], &n_all));
  PetscCall(CloseLocal(body, inner, &local[1], &n_inner));
  PetscCall(CloseLocal(body, held, &local[0], &mass));
  if (body->rows.size > 1) {
    PetscCall(VecGhostUpdateBegin(placed, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(placed, ADD_VALUES, SCATTER_REVERSE));
  }
  PetscCall(AddGhosts(body, next));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass, found on the first component, on all components of a node */
static PetscErrorCode CopyToComponents(Body body, Vec mass)
{
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(mass, &array));
  for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) array[i] = array[i - i % body->dim];
  PetscCall(VecRestoreArray(mass, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the mass of elements without inner nodes to the mass matrix */
PetscErrorCode BodyRedistributeOrphans(Body body)
{
  Vec       held, inner, all, next, placed;
  PetscReal total, left = 0;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &held));
  PetscCall(BodyCreateVec(body, &inner));
  PetscCall(BodyCreateVec(body, &all));
  PetscCall(CountAndCollect(body, held, inner, all));
  PetscCall(VecNorm(held, NORM_1, &total));
  if (total > 0) {
    PetscCall(BodyCreateVec(body, &placed));
    PetscCall(BodyCreateVec(body, &next));
    left = total;
    for (PetscInt round = 0; round < MAX_ROUNDS && left > 0; round++) {
      PetscCall(HandOn(body, held, inner, all, placed, next));
      PetscCall(VecSwap(held, next));
      if (body->rows.size > 1) {
        PetscCall(VecGhostUpdateBegin(held, INSERT_VALUES, SCATTER_FORWARD));
        PetscCall(VecGhostUpdateEnd(held, INSERT_VALUES, SCATTER_FORWARD));
      }
      PetscCall(VecNorm(held, NORM_1, &left));
    }
    PetscCall(CopyToComponents(body, placed));
    if (body->mass_diagonal) PetscCall(VecAXPY(body->mass_diagonal, 1, placed));
    else PetscCall(MatDiagonalSet(body->mass_matrix, placed, ADD_VALUES));
    PetscCall(VecDestroy(&next));
    body->orphan_mass = placed;
  }
  PetscCall(VecDestroy(&held));
  PetscCall(VecDestroy(&inner));
  PetscCall(VecDestroy(&all));
  PetscCheck(left == 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "Body '%s': %g kg of elements that have all their nodes on contact surfaces find no inner node nearby to go to; refine the mesh, name smaller surfaces in -contact_pairs, or set -%smass_redistribute false", body->hdr.name, (double)left, ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}
