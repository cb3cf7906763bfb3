/* What rows read under forces, what the laws of nodes make of it, and how readings are weighed against forces; see lawproblem.c. */
#include "lawimpl.h"
#include <petsc/private/petscimpl.h>

#define OF_MANY    4   /* 1/r of many rows, in parts of the diagonal of S */
#define GAPS_ALONE 1e4 /* r, in parts of the stiffness of glue, with which trial forces have what is read as their gap */

/* out = S in, which is there where the last product was this one */
PetscErrorCode LawProblemMultiply(LawProblem *problem, const PetscScalar in[], PetscScalar out[])
{
  const PetscScalar *product;
  PetscScalar       *x;
  PetscObjectState   state;
  PetscBool          same, zero = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n && zero; i++) zero = (PetscBool)(in[i] == 0);
  PetscCall(PetscObjectStateGet((PetscObject)problem->S, &state));
  PetscCall(VecGetArray(problem->in, &x));
  PetscCall(PetscArraycmp(x, in, problem->n, &same));
  PetscCall(PetscArraycpy(x, in, problem->n));
  PetscCall(VecRestoreArray(problem->in, &x));
  if (zero) PetscCall(VecZeroEntries(problem->out));
  else if (!same || problem->product_of != state) PetscCall(MatMult(problem->S, problem->in, problem->out));
  problem->product_of = state;
  PetscCall(VecGetArrayRead(problem->out, &product));
  PetscCall(PetscArraycpy(out, product, problem->n));
  PetscCall(VecRestoreArrayRead(problem->out, &product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What rows read, without the proximal term */
PetscErrorCode LawProblemRead(LawProblem *problem, const PetscScalar force[], PetscScalar y[])
{
  PetscScalar *change = problem->work + 2 * problem->n;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) change[i] = force[i] - problem->base[i];
  PetscCall(LawProblemMultiply(problem, change, y));
  for (PetscInt i = 0; i < problem->n; i++) y[i] += problem->read[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 1/r of the rows of a node that is glued: the same for all of them, so that the law is one of vectors. Where the force falls as the gap
   grows, r is beyond that slope, by as much again: else a trial force would have several gaps. */
static void WeighGlue(LawProblem *problem, PetscInt node)
{
  const RowLaw *law    = problem->law[node];
  RowLawGlue   *glue   = &problem->glue[node];
  PetscReal     weight = PETSC_MAX_REAL;

  for (PetscInt i = problem->begin[node]; i < problem->begin[node + 1]; i++)
    if (problem->diagonal[i] > PETSC_SMALL * problem->largest) weight = PetscMin(weight, problem->diagonal[i]);
  if (weight == PETSC_MAX_REAL) weight = PETSC_SMALL * problem->largest;
  if (law->softening) {
    const PetscReal slope = (*law->softening)(glue->parameters), k = (*law->stiffness)(glue->parameters, glue->history);

    weight           = PetscMin(weight, glue->times / ((problem->secant ? GAPS_ALONE * (k + slope) : 2 * slope) * glue->area));
    problem->softens = PETSC_TRUE;
  }
  glue->secant = problem->secant;
  for (PetscInt i = problem->begin[node]; i < problem->begin[node + 1]; i++) problem->weight[i] = weight;
  glue->r = glue->times / weight;
}

/* 1/r of all rows. Rows across the normal of a node have the same r: else friction would not point against the slip. Where S is products
   there are many rows, which move their neighbours, and Newton's method goes round in circles with a larger r. */
void LawProblemFindWeights(LawProblem *problem)
{
  const PetscReal times = LawProblemHasProducts(problem) ? OF_MANY : 1;

  problem->largest = 0;
  problem->softens = PETSC_FALSE;
  for (PetscInt i = 0; i < problem->n; i++) problem->largest = PetscMax(problem->largest, problem->diagonal[i]);
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt first = problem->begin[node], end = problem->begin[node + 1];
    PetscReal      across = 0;

    for (PetscInt i = first + 1; i < end; i++) across = PetscMax(across, problem->diagonal[i]);
    for (PetscInt i = first; i < end; i++) /* of a row that is held all of the diagonal is zero */
      problem->weight[i] = PetscMax(times * (i == first ? problem->diagonal[i] : across), PETSC_SMALL * problem->largest);
    if (problem->law[node]->stiffness) WeighGlue(problem, node);
  }
}

/* The trial forces lambda - r y of a node's rows */
void LawProblemGetTrial(const LawProblem *problem, PetscInt node, const PetscScalar force[], const PetscScalar y[], PetscReal p[])
{
  for (PetscInt i = problem->begin[node]; i < problem->begin[node + 1]; i++)
    p[i - problem->begin[node]] = PetscRealPart(force[i] - y[i] / problem->weight[i] - problem->proximal * (force[i] - problem->centre[i]));
}
