/* The problem of one controller step with friction: its arrays, and how well forces fulfil the law in it. */
#include "friction.h"
#include "rowlaw.h"
#include <solver/densefactor.h>

/* Where S is no matrix: nodes that are looked at for more than one solution, and what mu^2 S_TT is of S_NN at least where these are, half
   of what may be since both are means over all nodes */
#define LOOKED_AT      8
#define LEAST_COUPLING 0.5

/* Gives the problem n rows, with a matrix S of them, or with products in its place. Room grows by doubling, up to `most` rows, so that
   a step with more rows than any before seldom allocates. */
PetscErrorCode FrictionProblemResize(FrictionProblem *problem, PetscInt n, PetscInt most, const FrictionProducts *products)
{
  const PetscInt room = PetscMax(n, PetscMin(2 * problem->room, most));

  PetscFunctionBegin;
  if (n > problem->room) {
    PetscCall(FrictionProblemDestroy(problem));
    PetscCall(PetscMalloc6(room, &problem->opened, room, &problem->base, room, &problem->limit, room, &problem->force, room,
                           &problem->state, room, &problem->diagonal));
    PetscCall(PetscMalloc3(room, &problem->change, room, &problem->told, room, &problem->answer));
    problem->room = room;
  }
  if (!products && (n > problem->square || !problem->matrix)) {
    problem->square = PetscMax(n, PetscMin(2 * problem->square, most));
    PetscCall(PetscFree(problem->matrix));
    PetscCall(PetscMalloc1(problem->square * problem->square, &problem->matrix));
  }
  if (products && !problem->secants) PetscCall(PetscMalloc1(2 * FRICTION_SECANTS * problem->room, &problem->secants));
  problem->S         = products ? NULL : problem->matrix;
  problem->products  = products;
  problem->n_secants = 0;
  problem->n         = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionProblemDestroy(FrictionProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(problem->change, problem->told, problem->answer));
  PetscCall(PetscFree6(problem->opened, problem->base, problem->limit, problem->force, problem->state, problem->diagonal));
  PetscCall(PetscFree(problem->matrix));
  PetscCall(PetscFree(problem->secants));
  problem->S = NULL;
  problem->n = problem->room = problem->square = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = S x */
PetscErrorCode FrictionProblemMultiply(const FrictionProblem *problem, const PetscScalar x[], PetscScalar y[])
{
  const PetscInt n   = problem->n;
  PetscBool      any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n && !any; i++) any = (PetscBool)(x[i] != 0);
  if (problem->S || !any) {
    PetscCall(PetscArrayzero(y, n));
    if (any) PetscCall(DenseMultiplyAdd(n, n, problem->S, 1, x, y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall((*problem->products->multiply)(problem->products->data, x, y));
  for (PetscInt k = 0; k < 2 * problem->n_secants; k++) {
    const PetscScalar *secant = problem->secants + k * n;
    PetscScalar        along  = 0;

    for (PetscInt i = 0; i < n; i++) along += secant[i] * x[i];
    for (PetscInt i = 0; i < n; i++) y[i] += (k % 2 ? -along : along) * secant[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much nodes without cohesion miss the law where rows open by `open` [m] */
PetscReal FrictionProblemGetResidual(const FrictionProblem *problem, const PetscScalar open[])
{
  PetscReal most = 0;

  for (PetscInt first = 0; first < problem->n; first += problem->dim) {
    const PetscReal c = FrictionCompliance(problem, first, first), mu = PetscRealPart(problem->limit[first + 1]);

    if (c > 0 && PetscRealPart(problem->limit[first]) == 0)
      most = PetscMax(most, CoulombGetResidual(problem->dim, mu, c, problem->force + first, open + first));
  }
  return most;
}

/* Whether a node may be so, which is in contact */
static PetscBool MayBeAmbiguous(const FrictionProblem *problem, PetscInt first)
{
  const PetscReal mu = PetscRealPart(problem->limit[first + 1]);

  if (problem->state[first / problem->dim] == FRICTION_OPEN) return PETSC_FALSE;
  if (problem->S) return PETSC_TRUE;
  return (PetscBool)(PetscSqr(mu) * FrictionCompliance(problem, first + 1, first + 1) >=
                     LEAST_COUPLING * FrictionCompliance(problem, first, first));
}

/* Whether one node is so, by the column of S of its normal row */
static PetscBool IsAmbiguous(const FrictionProblem *problem, PetscInt first, const PetscScalar column[])
{
  PetscReal coupling = 0;

  for (PetscInt k = 1; k < problem->dim; k++) coupling += PetscSqr(PetscRealPart(column[first + k]));
  return (PetscBool)(PetscRealPart(problem->limit[first + 1]) * PetscSqrtReal(coupling) >= PetscRealPart(column[first]));
}

/* Whether a node in contact could be in another state under the same loads. One that slides answers to its normal force by a gap of
   S_NN - mu S_NT.e, e being the way of its force: with mu |S_NT| >= S_NN more force may open it less, or nothing (Klarbring 1990). S_NT is
   at most (S_NN S_TT)^(1/2). Where S is no matrix that leaves out nodes with usual coefficients; of the others some are looked at, evenly
   among them. Overwrites `change` and `told`. */
PetscErrorCode FrictionProblemIsAmbiguous(FrictionProblem *problem, PetscBool *ambiguous)
{
  const PetscInt dim = problem->dim, n = problem->n;
  PetscInt       may = 0, seen = 0;

  PetscFunctionBegin;
  *ambiguous = PETSC_FALSE;
  for (PetscInt first = 0; first < n; first += dim) may += MayBeAmbiguous(problem, first);
  if (!may) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt first = 0; first < n && !*ambiguous; first += dim) {
    if (!MayBeAmbiguous(problem, first)) continue;
    if (problem->S) *ambiguous = IsAmbiguous(problem, first, problem->S + first * n);
    else if (seen * PetscMin(may, LOOKED_AT) % may < PetscMin(may, LOOKED_AT)) {
      PetscCall(PetscArrayzero(problem->change, n));
      problem->change[first] = 1;
      PetscCall(FrictionProblemMultiply(problem, problem->change, problem->told));
      *ambiguous = IsAmbiguous(problem, first, problem->told);
    }
    seen++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the forces as they were where the law holds for them: with nothing that changes any more all nodes are at the brink of another
   state, and their states go round. The law may be missed by `atol` [m]. */
PetscErrorCode FrictionProblemKeepForces(FrictionProblem *problem, PetscReal atol, PetscBool *kept)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
  *kept = (PetscBool)(FrictionProblemGetResidual(problem, problem->opened) <= atol);
  for (PetscInt first = 0; first < problem->n && *kept; first += problem->dim) {
    const PetscReal bound  = PetscRealPart(problem->limit[first] + problem->limit[first + 1] * problem->force[first]);
    PetscReal       square = 0;

    for (PetscInt k = 1; k < problem->dim; k++) square += PetscSqr(PetscRealPart(problem->force[first + k]));
    problem->state[first / problem->dim] = PetscRealPart(problem->force[first]) <= 0 ? FRICTION_OPEN
                                           : square < PetscSqr(bound)                ? FRICTION_STICKS
                                                                                     : FRICTION_SLIDES;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
