/* The mass matrix of one element: its lumped and its consistent part, and their sum as the body has it. */
#include <body/layout/bodyimpl.h>

/* The two parts that the mass matrix of one element is the sum of, before any factor, and the same for each component: lumped, by nodes,
   and consistent, nodes x nodes, or zero where the type has none. All mass is where it is; or that of contact nodes is moved to the inner
   nodes, in each part by itself: what these have is scaled to the mass of the element, with the coupling between them, so that the mass
   does not spread along the layer. Without inner nodes nothing is left: BodyFindMassFactor() makes up for it. */
PetscErrorCode BodyGetElementMassParts(Body body, PetscInt e, PetscBool move, PetscScalar lumped[], PetscScalar consistent[])
{
  const PetscInt   n     = body->model.element->nodes;
  const PetscInt  *nodes = body->mesh.connectivity + e * n;
  const PetscReal  share = body->mass.type == BODY_MASS_LUMPED ? 1 : body->mass.type == BODY_MASS_CONSISTENT ? 0 : 0.5;
  const PetscBool *layer = body->layer.contains;
  PetscScalar      all = 0, inner[2] = {0}, scale[2] = {share, 1 - share};
  PetscBool        moves = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall((*body->model.element->ops->mass)(body->model.element, e, consistent));
  for (PetscInt a = 0; a < n; a++) {
    lumped[a] = 0;
    for (PetscInt b = 0; b < n; b++) lumped[a] += consistent[a * n + b];
    if (move && layer[nodes[a]]) moves = PETSC_TRUE;
  }
  if (moves) {
    for (PetscInt a = 0; a < n; a++) {
      all += lumped[a];
      if (layer[nodes[a]]) lumped[a] = 0;
      inner[0] += lumped[a];
      for (PetscInt b = 0; b < n; b++) {
        if (layer[nodes[a]] || layer[nodes[b]]) consistent[a * n + b] = 0;
        inner[1] += consistent[a * n + b];
      }
    }
    for (PetscInt k = 0; k < 2; k++) scale[k] *= inner[k] != 0 ? all / inner[k] : 0;
  }
  for (PetscInt a = 0; a < n; a++) lumped[a] *= scale[0];
  for (PetscInt i = 0; i < n * n; i++) consistent[i] *= scale[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factor on the consistent part of an element: the mean over its inner nodes */
static PetscReal MeanFactor(Body body, const PetscInt nodes[])
{
  PetscReal sum   = 0;
  PetscInt  inner = 0;

  for (PetscInt a = 0; a < body->model.element->nodes; a++) {
    if (body->layer.contains[nodes[a]]) continue;
    sum += body->mass.factor[nodes[a]];
    inner++;
  }
  return inner ? sum / inner : 0;
}

/* The mass matrix of an element in the body, nodes x nodes, the same for each component; its full mass where the body extrapolates. */
PetscErrorCode BodyGetElementMass(Body body, PetscInt e, PetscScalar M[])
{
  const PetscInt  n     = body->model.element->nodes;
  const PetscInt *nodes = body->mesh.connectivity + e * n;
  PetscScalar     lumped[ELEMENT_MAX_NODES];
  PetscReal       mean = 1;

  PetscFunctionBegin;
  PetscCall(BodyGetElementMassParts(body, e, (PetscBool)(body->mass.redistribute && !body->mass.extrapolation), lumped, M));
  if (body->mass.factor) mean = MeanFactor(body, nodes);
  for (PetscInt i = 0; i < n * n && mean != 1; i++) M[i] *= mean;
  for (PetscInt a = 0; a < n; a++) M[a * n + a] += body->mass.factor ? body->mass.factor[nodes[a]] * lumped[a] : lumped[a];
  PetscFunctionReturn(PETSC_SUCCESS);
}
