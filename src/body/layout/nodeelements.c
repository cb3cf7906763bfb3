/* The elements around each node of a body, and how many elements nodes are away from some of them. */
#include <body/layout/bodyimpl.h>

/* They stay with the body */
PetscErrorCode BodyGetNodeElements(Body body, NodeElements *result)
{
  const Element  element = body->model.element;
  const PetscInt n = body->mesh.local_nodes, entries = element->count * element->nodes;
  NodeElements   around;

  PetscFunctionBegin;
  *result = body->mesh.around;
  if (*result) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&around));
  *result = body->mesh.around = around;
  around->nodes               = element->nodes;
  around->count               = element->count;
  around->connectivity        = body->mesh.connectivity;
  PetscCall(PetscCalloc1(n + 1, &around->begin));
  PetscCall(PetscMalloc1(entries, &around->elements));
  for (PetscInt i = 0; i < entries; i++) around->begin[around->connectivity[i]]++;
  for (PetscInt i = 0; i < n; i++) around->begin[i + 1] += around->begin[i];
  /* from the last to the first entry, so that `begin` ends where it should */
  for (PetscInt i = entries - 1; i >= 0; i--) around->elements[--around->begin[around->connectivity[i]]] = i / around->nodes;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeElementsDestroy(NodeElements *around)
{
  PetscFunctionBegin;
  if (!*around) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*around)->begin));
  PetscCall(PetscFree((*around)->elements));
  PetscCall(PetscFree(*around));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NodeElementsFindDistances - how many elements nodes are away from those of some displacements, dofs of dim to a node, as far as `most`.
   distance: of each node, larger ones are replaced; order: the n nodes whose distance has been found here, the nearest first */
PetscErrorCode NodeElementsFindDistances(NodeElements around, PetscInt n_dofs, PetscInt dim, const PetscInt dofs[], PetscInt most,
                                         PetscInt distance[], PetscInt *n, PetscInt order[])
{
  PetscInt   count = 0;
  PetscBool *seen;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(around->count, &seen));
  for (PetscInt i = 0; i < n_dofs; i++) {
    const PetscInt node = dofs[i] / dim;

    if (distance[node] == 0) continue;
    distance[node] = 0;
    order[count++] = node;
  }
  for (PetscInt k = 0; k < count && distance[order[k]] < most; k++) {
    const PetscInt node = order[k];

    for (PetscInt j = around->begin[node]; j < around->begin[node + 1]; j++) {
      const PetscInt *nodes = around->connectivity + around->elements[j] * around->nodes;

      for (PetscInt i = 0; i < around->nodes && !seen[around->elements[j]]; i++) {
        if (distance[nodes[i]] <= distance[node] + 1) continue;
        distance[nodes[i]] = distance[node] + 1;
        order[count++]     = nodes[i];
      }
      seen[around->elements[j]] = PETSC_TRUE;
    }
  }
  PetscCall(PetscFree(seen));
  *n = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}
