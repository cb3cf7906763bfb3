/*
   Mass of elements all of whose nodes lie on contact surfaces, as tetrahedra in corners do: there is no inner node in the element to
   take it, so it goes to the inner nodes of the elements around.

   Each contact node holds its share of such elements at first, and is so many elements away from the nearest inner node. It hands its
   mass to those of its neighbours that are one element nearer, in equal parts (a neighbour counts once for each element shared), the
   furthest nodes first.
*/
#include <body/layout/bodyimpl.h>
#include <sys/units.h>

/* Mass that would have to go further than this many elements has no place nearby */
#define MAX_DISTANCE 8

/* All in the first component of a node's block */
typedef struct {
  Vec mass;
  Vec distance; /* elements to the nearest inner node; -1: not known */
  Vec nearer;   /* neighbours that are nearer by one */
} Orphans;

static PetscErrorCode AddGhosts(Body body, Vec vec)
{
  PetscFunctionBegin;
  if (!body->mesh.ghosted) PetscFunctionReturn(PETSC_SUCCESS);
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
  if (body->mesh.ghosted) PetscCall(VecGhostGetLocalForm(vec, local));
  PetscCall(VecGetArray(*local, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CloseLocal(Body body, Vec vec, Vec *local, PetscScalar **array)
{
  PetscFunctionBegin;
  PetscCall(VecRestoreArray(*local, array));
  if (body->mesh.ghosted) PetscCall(VecGhostRestoreLocalForm(vec, local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass of orphaned elements, in equal parts on their nodes */
static PetscErrorCode CollectMass(Body body, Vec vec)
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  PetscScalar    M[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES], *mass;
  Vec            local;

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, vec, &local, &mass));
  PetscCall(PetscArrayzero(mass, body->mesh.local_nodes * dim));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    const PetscInt *nodes = body->mesh.connectivity + e * n;
    PetscInt        inner = 0;
    PetscScalar     sum   = 0;

    for (PetscInt a = 0; a < n; a++) inner += !body->layer.contains[nodes[a]];
    if (inner) continue;
    PetscCall((*body->model.element->ops->mass)(body->model.element, e, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) sum += M[a * n + b];
    for (PetscInt a = 0; a < n; a++) mass[nodes[a] * dim] += sum / n;
  }
  PetscCall(CloseLocal(body, vec, &local, &mass));
  PetscCall(AddGhosts(body, vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes that are `at` elements away, once those that are nearer are known */
static PetscErrorCode FindNodes(Body body, PetscInt at, Orphans *orphans, Vec counts)
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  PetscScalar   *distance, *nearer, *count;
  Vec            local[3];

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, orphans->distance, &local[0], &distance));
  PetscCall(OpenLocal(body, counts, &local[1], &count));
  PetscCall(PetscArrayzero(count, body->mesh.local_nodes * dim));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    const PetscInt *nodes = body->mesh.connectivity + e * n;
    PetscInt        near  = 0;

    for (PetscInt a = 0; a < n; a++) near += distance[nodes[a] * dim] == at - 1;
    for (PetscInt a = 0; a < n; a++)
      if (distance[nodes[a] * dim] < 0) count[nodes[a] * dim] += near;
  }
  PetscCall(CloseLocal(body, counts, &local[1], &count));
  PetscCall(AddGhosts(body, counts));
  PetscCall(OpenLocal(body, counts, &local[1], &count));
  PetscCall(OpenLocal(body, orphans->nearer, &local[2], &nearer));
  for (PetscInt i = 0; i < body->mesh.local_nodes * dim; i += dim) {
    if (count[i] == 0) continue;
    distance[i] = at;
    nearer[i]   = count[i];
  }
  PetscCall(CloseLocal(body, orphans->nearer, &local[2], &nearer));
  PetscCall(CloseLocal(body, counts, &local[1], &count));
  PetscCall(CloseLocal(body, orphans->distance, &local[0], &distance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Distances up to that of the furthest node with mass; `left` is the mass on nodes of which none was found [kg] */
static PetscErrorCode FindDistances(Body body, Orphans *orphans, Vec counts, PetscInt *furthest, PetscReal *left)
{
  const PetscInt dim = body->mesh.dim;
  PetscScalar   *distance, *mass;
  Vec            local;

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, orphans->distance, &local, &distance));
  for (PetscInt i = 0; i < body->mesh.local_nodes * dim; i++) distance[i] = body->layer.contains[i / dim] ? -1 : 0;
  PetscCall(CloseLocal(body, orphans->distance, &local, &distance));
  *left = 1;
  for (*furthest = 0; *furthest < MAX_DISTANCE && *left > 0;) {
    PetscCall(FindNodes(body, ++*furthest, orphans, counts));
    *left = 0;
    PetscCall(VecGetArray(orphans->distance, &distance));
    PetscCall(VecGetArray(orphans->mass, &mass));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i += dim)
      if (distance[i] < 0) *left += mass[i];
    PetscCall(VecRestoreArray(orphans->mass, &mass));
    PetscCall(VecRestoreArray(orphans->distance, &distance));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, left, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From nodes that are `from` elements away to their nearer neighbours */
static PetscErrorCode HandOn(Body body, PetscInt from, Orphans *orphans, Vec handed)
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  PetscScalar   *mass, *distance, *nearer, *given;
  Vec            local[4];

  PetscFunctionBegin;
  PetscCall(OpenLocal(body, orphans->mass, &local[0], &mass));
  PetscCall(OpenLocal(body, orphans->distance, &local[1], &distance));
  PetscCall(OpenLocal(body, orphans->nearer, &local[2], &nearer));
  PetscCall(OpenLocal(body, handed, &local[3], &given));
  PetscCall(PetscArrayzero(given, body->mesh.local_nodes * dim));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    const PetscInt *nodes = body->mesh.connectivity + e * n;

    for (PetscInt a = 0; a < n; a++) {
      const PetscInt node = nodes[a] * dim;

      if (distance[node] != from || mass[node] == 0) continue;
      for (PetscInt b = 0; b < n; b++)
        if (distance[nodes[b] * dim] == from - 1) given[nodes[b] * dim] += mass[node] / nearer[node];
    }
  }
  PetscCall(CloseLocal(body, handed, &local[3], &given));
  PetscCall(AddGhosts(body, handed));
  PetscCall(OpenLocal(body, handed, &local[3], &given));
  for (PetscInt i = 0; i < body->mesh.local_nodes * dim; i += dim) mass[i] = distance[i] == from ? 0 : mass[i] + given[i];
  PetscCall(CloseLocal(body, handed, &local[3], &given));
  PetscCall(CloseLocal(body, orphans->nearer, &local[2], &nearer));
  PetscCall(CloseLocal(body, orphans->distance, &local[1], &distance));
  PetscCall(CloseLocal(body, orphans->mass, &local[0], &mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass, found on the first component, on all components of a node */
static PetscErrorCode CopyToComponents(Body body, Vec mass)
{
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(mass, &array));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) array[i] = array[i - i % body->mesh.dim];
  PetscCall(VecRestoreArray(mass, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the mass of elements without inner nodes a place, if there is any. `homeless`: whether some finds none; NULL: that is an error. */
PetscErrorCode BodyFindOrphans(Body body, PetscBool *homeless)
{
  Orphans   orphans;
  Vec       work;
  PetscReal total, left;
  PetscInt  furthest = 0;

  PetscFunctionBegin;
  if (homeless) *homeless = PETSC_FALSE;
  PetscCall(BodyCreateVec(body, &orphans.mass));
  PetscCall(CollectMass(body, orphans.mass));
  PetscCall(VecNorm(orphans.mass, NORM_1, &total));
  if (total == 0) {
    PetscCall(VecDestroy(&orphans.mass));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  body->mass.orphans = orphans.mass;
  PetscCall(BodyCreateVec(body, &orphans.distance));
  PetscCall(BodyCreateVec(body, &orphans.nearer));
  PetscCall(BodyCreateVec(body, &work));
  PetscCall(FindDistances(body, &orphans, work, &furthest, &left));
  for (PetscInt from = furthest; from > 0; from--) PetscCall(HandOn(body, from, &orphans, work));
  PetscCall(VecDestroy(&orphans.distance));
  PetscCall(VecDestroy(&orphans.nearer));
  PetscCall(VecDestroy(&work));
  if (homeless) *homeless = (PetscBool)(left != 0);
  PetscCheck(left == 0 || homeless, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s': %g%s of elements that have all their nodes on contact surfaces find no inner node nearby to go to; refine the "
             "mesh, name smaller surfaces in -contact_pairs, or leave the choice to the body: -%smass_redistribute auto",
             body->hdr.name, (double)left, UnitsOf((PetscObject)body, UNIT_MASS), ((PetscObject)body)->prefix);
  PetscCall(CopyToComponents(body, orphans.mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}
