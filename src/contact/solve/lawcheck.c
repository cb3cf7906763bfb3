/* What is told of a step with friction: by how much nodes miss the law, and whether forces may have been others. */
#include "lawimpl.h"

static PetscBool HasFriction(const LawProblem *problem, PetscInt node)
{
  return (PetscBool)(problem->begin[node + 1] > problem->begin[node] + 1 && !problem->law[node]->pulls &&
                     problem->limit[2 * node + 1] > 0 && problem->limit[2 * node] == 0);
}

/* By how much nodes miss Coulomb's law with the forces and readings of the last pass [m] */
PetscReal LawProblemGetFrictionResidual(const LawProblem *problem)
{
  PetscReal most = 0;

  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node];

    if (HasFriction(problem, node) && problem->diagonal[first] > 0)
      most = PetscMax(most, CoulombGetResidual(problem->begin[node + 1] - first, problem->limit[2 * node + 1], problem->diagonal[first],
                                               problem->base + first, problem->read + first));
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
