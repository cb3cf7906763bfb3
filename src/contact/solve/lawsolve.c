/* How the equations of laws are solved: Newton's method, sweeps node by node, and the proximal term of singular S; see lawproblem.c. */
#include "lawimpl.h"
#include <sys/petsccompat.h>

#define VANISHES      1e-12 /* of what rows read, by themselves or by their own force */
#define MOST_PROXIMAL 20
#define LESS          1e-3 /* of the weights of that term, where S has no factors that need it: it vanishes one solution sooner */
#define FIRST_SWEEPS  5
#define MOST_NEAR     80  /* sweeps with a matrix near S, each of which takes a product */
#define ENOUGH        0.5 /* linear iterations leave this part of the tolerance of Newton's method, */
#define MEAN          0.2 /* or, in the mean, this part of what readings are right to */

/* By one of the solvers, from `force` on, in so many iterations at most, or as many as it has */
static PetscErrorCode SolveBy(LawProblem *problem, SNES snes, PetscInt most, SNESConvergedReason *reason)
{
  PetscInt iterations, own;

  PetscFunctionBegin;
  PetscCall(SNESGetTolerances(snes, NULL, NULL, NULL, &own, NULL));
  PetscCall(SNESSetTolerances(snes, PETSC_CURRENT, PETSC_CURRENT, PETSC_CURRENT, most, PETSC_CURRENT));
  PetscCall(VecPlaceArray(problem->x, problem->force));
  PetscCall(SNESSolve(snes, NULL, problem->x));
  PetscCall(VecResetArray(problem->x));
  PetscCall(SNESSetTolerances(snes, PETSC_CURRENT, PETSC_CURRENT, PETSC_CURRENT, own, PETSC_CURRENT));
  PetscCall(SNESGetConvergedReason(snes, reason));
  PetscCall(SNESGetIterationNumber(snes, &iterations));
  problem->iterations += iterations;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Iterations with the Jacobian of glue that keeps its present stiffness. The energy of glue is concave in the square of the gap, so that
   each of them lowers the energy of all, and leads over where the last state has no neighbour: nodes of a coarse mesh break one by one, all
   at once (majorise and minimise; Bourdin, Francfort, Marigo 2000 alternate so between gaps and damage). */
static PetscErrorCode SolveBySecants(LawProblem *problem, PetscInt iterations, SNESConvergedReason *reason)
{
  PetscFunctionBegin;
  for (PetscInt back = 0; back < 2; back++) {
    problem->secant      = (PetscBool)!back;
    problem->jacobian_of = -1;
    LawProblemFindWeights(problem);
    if (!back) PetscCall(SolveBy(problem, problem->newton, iterations, reason));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes that do not move each other: a sweep solves, after which another one changes nothing, for less than PETSc's solvers take to begin.
   Neither needs the proximal term. */
static PetscErrorCode SweepFirst(LawProblem *problem)
{
  const PetscReal proximal = problem->proximal;
  PetscScalar    *before   = problem->work + problem->n;
  PetscReal       change   = 0;

  PetscFunctionBegin;
  problem->proximal = 0;
  PetscCall(PetscArraycpy(problem->centre, problem->force, problem->n));
  PetscCall(LawProblemHolds(problem, &problem->solved));
  if (!problem->solved && !problem->softens && !LawProblemHasProducts(problem)) {
    PetscCall(LawProblemSweep(problem, problem->force));
    PetscCall(LawProblemHolds(problem, &problem->solved)); /* which what is no number does not */
    PetscCall(PetscArraycpy(before, problem->force, problem->n));
    if (problem->solved) PetscCall(LawProblemSweep(problem, problem->force));
    for (PetscInt i = 0; i < problem->n; i++) change = PetscMax(change, PetscAbsScalar(problem->force[i] - before[i]));
    problem->solved     = (PetscBool)(problem->solved && change <= PETSC_MACHINE_EPSILON * LawProblemForceScale(problem, problem->force));
    problem->iterations = problem->solved;
  }
  if (!problem->solved) PetscCall(PetscArraycpy(problem->force, problem->centre, problem->n)); /* as it was */
  problem->proximal = proximal;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By Newton's method; where that goes round in a circle, from where a few sweeps lead, or
   secants of glue that softens, more of them each time */
static PetscErrorCode SolveOnce(LawProblem *problem)
{
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscScalar        *start  = problem->work + problem->n;
  PetscInt            sweeps = FIRST_SWEEPS, most;
  PetscReal           rtol, enough;
  KSP                 ksp;

  PetscFunctionBegin;
  PetscCall(LawProblemHolds(problem, &problem->solved));
  if (problem->solved) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SNESGetKSP(problem->newton, &ksp));
  PetscCall(SNESGetTolerances(problem->newton, NULL, &rtol, NULL, NULL, NULL));
  enough = ENOUGH * rtol * LawProblemForceScale(problem, problem->force);
  /* each product takes solutions with the bodies' matrices: no more of them than the mean of rows needs */
  if (LawProblemHasProducts(problem))
    enough = MEAN * PetscSqrtReal((PetscReal)problem->n) * PetscMax(enough / ENOUGH, problem->resolution / problem->largest);
  PetscCall(KSPSetTolerances(ksp, PETSC_CURRENT, enough, PETSC_CURRENT, PETSC_CURRENT));
  PetscCall(PetscArraycpy(start, problem->force, problem->n));
  PetscCall(SNESGetTolerances(problem->nodes, NULL, NULL, NULL, &most, NULL));
  PetscCall(SolveBy(problem, problem->newton, PETSC_CURRENT, &reason));
  for (; reason < 0 && sweeps <= (LawProblemHasProducts(problem) ? PetscMin(most, MOST_NEAR) : most); sweeps *= 4) {
    PetscCall(PetscInfo(
        problem->newton, "law of %" PetscInt_FMT " rows: %s after %" PetscInt_FMT " iterations, now %" PetscInt_FMT " sweeps %s\n",
        problem->n, SNESConvergedReasons[reason], problem->iterations, sweeps, problem->softens ? "with secants" : "node by node"));
    problem->by_nodes = PETSC_TRUE;
    PetscCall(PetscArraycpy(problem->force, start, problem->n));
    if (problem->softens) PetscCall(SolveBySecants(problem, sweeps, &reason));
    else PetscCall(SolveBy(problem, problem->nodes, sweeps, &reason));
    if (reason == SNES_DIVERGED_NAN) break;
    PetscCall(PetscArraycpy(start, problem->force, problem->n));
    if (reason < 0 || reason == SNES_CONVERGED_ITS) PetscCall(SolveBy(problem, problem->newton, PETSC_CURRENT, &reason));
  }
  problem->solved = (PetscBool)(reason > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the proximal term is negligible beside readings, or their round-off: never where no forces close the rows */
static PetscBool ProximalVanishes(const LawProblem *problem, PetscReal part)
{
  PetscReal off = 0, scale = 0;

  for (PetscInt i = 0; i < problem->n; i++) {
    off   = PetscMax(off, problem->proximal * problem->weight[i] * PetscAbsScalar(problem->force[i] - problem->centre[i]));
    scale = PetscMax(scale, PetscMax(PetscAbsScalar(problem->read[i]), PetscAbsScalar(problem->diagonal[i] * problem->force[i])));
  }
  return (PetscBool)(off <= part * scale + problem->resolution);
}

/* The forces of all rows with one weight of the proximal term, from `force` on; whether it has vanished or can, and does so slowly */
static PetscErrorCode SolveProximal(LawProblem *problem, PetscBool *slow)
{
  PetscFunctionBegin;
  *slow = PETSC_FALSE;
  for (PetscInt k = 0; k < MOST_PROXIMAL; k++) {
    PetscReal pull = 0;

    PetscCall(PetscArraycpy(problem->centre, problem->force, problem->n));
    PetscCall(SolveOnce(problem));
    if (!problem->solved) PetscFunctionReturn(PETSC_SUCCESS);
    for (PetscInt i = 0; i < problem->n; i++) pull = PetscMax(pull, PetscAbsScalar(problem->force[i] - problem->centre[i]));
    if (problem->proximal * pull <= LAW_TOLERANCE * LawProblemForceScale(problem, problem->force) || ProximalVanishes(problem, 0))
      PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(PetscInfo(problem->newton, "law of %" PetscInt_FMT " rows: forces of dependent rows change by %g N, solved again\n",
                        problem->n, (double)pull));
  }
  problem->solved = ProximalVanishes(problem, VANISHES);
  *slow           = (PetscBool)!problem->solved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of all rows, from `force` on, and whether they have been found. Where a weight of the proximal term is too small for Newton's
   method, or so large that the term does not vanish, which is where the stiffnesses of bodies are far apart, there are others. A sparse S,
   whose linear solver needs no factors, is tried without the term first: that is one solution where the term takes two. */
PetscErrorCode LawProblemSolve(LawProblem *problem)
{
  const PetscReal proximal[] = {0, 1e-8, 1e-10, 1e-6}; /* of the diagonal of S */
  const PetscBool none       = (PetscBool)(problem->regular || (problem->sparse && !LawProblemHasProducts(problem)));
  PetscBool       slow       = PETSC_TRUE;

  PetscFunctionBegin;
  problem->iterations = 0;
  problem->by_nodes   = PETSC_FALSE;
  LawProblemFindWeights(problem);
  PetscCall(SweepFirst(problem));
  if (problem->solved && !problem->asked) PetscFunctionReturn(PETSC_SUCCESS);
  problem->solved = PETSC_FALSE;
  for (size_t k = !none; k < PETSC_STATIC_ARRAY_LENGTH(proximal) && !problem->solved; k++) {
    const PetscReal part = LawProblemHasProducts(problem) ? LESS : 1;

    if (problem->proximal != part * proximal[k]) problem->jacobian_of = -1; /* it has this weight in it */
    problem->proximal = part * proximal[k];
    if (!slow) PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
    PetscCall(SolveProximal(problem, &slow));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
