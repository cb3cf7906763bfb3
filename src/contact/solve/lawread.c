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

/* P of the trial forces lambda - r y of a node's rows, and its derivative */
void LawProblemProject(const LawProblem *problem, PetscInt node, const PetscScalar force[], const PetscScalar y[], PetscReal projected[],
                       PetscReal derivative[])
{
  const PetscInt first = problem->begin[node], rows = problem->begin[node + 1] - first;
  PetscReal      p[ROW_LAW_ROWS];

  for (PetscInt i = first; i < first + rows; i++)
    p[i - first] = PetscRealPart(force[i] - y[i] / problem->weight[i] - problem->proximal * (force[i] - problem->centre[i]));
  (*problem->law[node]->project)(rows, problem->limit + 2 * node, &problem->glue[node], p, projected, derivative);
}

/* Gives a matrix near S the trace of S, for weights of laws: by x x^T S with random signs x (M. F. Hutchinson,
   Communications in Statistics - Simulation and Computation 19, 1990), the same on all ranks. */
PetscErrorCode LawProblemMatchTrace(Mat S, Mat near)
{
  PetscScalar *signs, ours, its;
  PetscInt     n;
  Vec          x, y;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(near, &x, &y));
  PetscCall(VecSetRandom(x, NULL)); /* from 0 to 1, the same each time */
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArray(x, &signs));
  for (PetscInt i = 0; i < n; i++) signs[i] = PetscRealPart(signs[i]) < 0.5 ? -1 : 1;
  PetscCall(VecRestoreArray(x, &signs));
  PetscCall(MatMult(near, x, y));
  PetscCall(VecDot(x, y, &ours));
  PetscCall(MatMult(S, x, y));
  PetscCall(VecDot(x, y, &its));
  if (PetscRealPart(its) > 0 && PetscRealPart(ours) > 0) PetscCall(MatScale(near, its / ours));
  PetscCall(PetscInfo(S, "a matrix near S for %" PetscInt_FMT " rows, made %g times as large\n", n, (double)PetscRealPart(its / ours)));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
