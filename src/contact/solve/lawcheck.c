/* What is told of a step with friction: by how much nodes miss the law, and whether forces may have been others. */
#include "lawproblem.h"

/* Whether the rows of a node slide, or may */
static PetscBool HasFriction(const LawProblem *problem, PetscInt node)
{
  return (PetscBool)(problem->begin[node + 1] > problem->begin[node] + 1 && !problem->law[node]->pulls &&
                     problem->limit[2 * node + 1] > 0 && problem->limit[2 * node] == 0);
}

/* By how much nodes miss the law with the forces and readings of the last pass [m]: de Saxce's residual. With the slip s of a node,
   v = (g + mu |s|, s) and the compliance c of its normal row that is c |f - P(f - v/c)|, P being the projection onto the cone of friction.
 */
PetscReal LawProblemGetFrictionResidual(const LawProblem *problem)
{
  PetscReal most = 0;

  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt  first = problem->begin[node], rows = problem->begin[node + 1] - first;
    const PetscReal c = problem->diagonal[first], mu = problem->limit[2 * node + 1];
    PetscReal       slip = 0, f[ROW_LAW_ROWS] = {0}, t[ROW_LAW_ROWS] = {0}, size = 0, normal, bound, square;

    if (!HasFriction(problem, node) || !(c > 0)) continue;
    for (PetscInt k = 1; k < rows; k++) slip += PetscSqr(PetscRealPart(problem->read[first + k]));
    slip = PetscSqrtReal(slip);
    for (PetscInt k = 0; k < rows; k++) {
      f[k] = PetscRealPart(problem->base[first + k]);
      t[k] = f[k] - (PetscRealPart(problem->read[first + k]) + (k ? 0 : mu * slip)) / c;
      if (k) size += PetscSqr(t[k]);
    }
    size   = PetscSqrtReal(size);
    normal = t[0];
    bound  = size;
    if (size > mu * t[0]) { /* outside the cone: onto its side, or its tip */
      normal = PetscMax((t[0] + mu * size) / (1 + mu * mu), 0);
      bound  = mu * normal;
    }
    square = PetscSqr(f[0] - normal);
    for (PetscInt k = 1; k < rows; k++) square += PetscSqr(f[k] - (size > 0 ? bound / size * t[k] : 0));
    most = PetscMax(most, c * PetscSqrtReal(square));
  }
  return most;
}

/* Whether a node in contact could be in another state under the same loads. One that slides answers to its normal force by a gap of
   S_NN - mu S_NT.e, e being the way of its force: with mu |S_NT| >= S_NN more force may open it less, or nothing (Klarbring 1990). Where S
   is products, the matrix near it tells. */
PetscErrorCode LawProblemIsAmbiguous(const LawProblem *problem, PetscBool *ambiguous)
{
  PetscFunctionBegin;
  *ambiguous = PETSC_FALSE;
  for (PetscInt node = 0; node < problem->n_nodes && !*ambiguous; node++) {
    const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;
    PetscReal      coupling = 0;

    if (!HasFriction(problem, node) || problem->base[first] == 0) continue;
    for (PetscInt k = 1; k < rows; k++) {
      PetscScalar value;

      PetscCall(MatGetValue(problem->entries, first + k, first, &value));
      coupling += PetscSqr(PetscRealPart(value));
    }
    *ambiguous = (PetscBool)(problem->limit[2 * node + 1] * PetscSqrtReal(coupling) >= problem->diagonal[first]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
