/*
   Forces of a controller step with friction by projected gradients, where S is only multiplied with and Newton's method does not come to an
   end. With the bound of each node's force across its normal as it is (Tresca's friction), forces are those of least energy

     1/2 (f - base)' S (f - base) + opened' (f - base)

   among those that push and are within the bounds: a convex problem, whose gradient is what rows open by. Spectral projected gradients
   (Birgin, Martinez, Raydan 2000) take the length of each step from the last one and go along it as far as the energy falls, which takes
   one product with S. The bounds follow the normal forces from time to time. That converges slowly, and need not do so to the end: Newton's
   method goes on from there.
*/
#include "frictionsolver.h"

/* Steps with the same bounds, and how often these are renewed */
#define STEPS_MOST  25
#define ROUNDS_MOST 40
/* Steps end where they would change forces by this part of the largest, and rounds where bounds have changed by no more */
#define SMALL 1e-7

/* What is within the bound of a node nearest to a force of it */
static void Project(PetscInt dim, PetscReal bound, PetscScalar force[])
{
  PetscReal size = 0;

  force[0] = PetscMax(PetscRealPart(force[0]), 0);
  for (PetscInt k = 1; k < dim; k++) size += PetscSqr(PetscRealPart(force[k]));
  size = PetscSqrtReal(size);
  for (PetscInt k = 1; k < dim && size > bound; k++) force[k] *= bound / size;
}

/* A length of steps of a row, as stiff as the rows of its node are [N/m]; 0 where nothing moves it and it is not dragged, so that it has no
   force */
static PetscReal GetStiffness(FrictionSolver solver, const FrictionProblem *problem, PetscInt i)
{
  const PetscInt  dim = problem->dim, first = i - i % dim;
  const PetscReal p = FrictionStiffness(problem, first, 0, 1), q = FrictionStiffness(problem, first, 1, dim);

  if (i == first) return p;
  if (FrictionImmovable(problem, first, i - first) && !FrictionDragged(problem, solver->open, first)) return 0;
  return q > 0 ? q : p;
}

/* The way of a step of this length: forces within the bounds, less those that are; its largest change of a force */
static PetscReal FindWay(FrictionSolver solver, const FrictionProblem *problem, PetscReal length, const PetscScalar bounds[],
                         PetscScalar way[])
{
  PetscReal most = 0;

  for (PetscInt first = 0; first < problem->n; first += problem->dim) {
    PetscScalar force[3] = {0, 0, 0};

    for (PetscInt k = 0; k < problem->dim; k++) {
      const PetscReal stiffness = GetStiffness(solver, problem, first + k);

      force[k] = stiffness > 0 ? problem->force[first + k] - length * stiffness * solver->open[first + k] : 0;
    }
    Project(problem->dim, PetscRealPart(bounds[first]), force);
    for (PetscInt k = 0; k < problem->dim; k++) {
      way[first + k] = force[k] - problem->force[first + k];
      most           = PetscMax(most, PetscAbsScalar(way[first + k]));
    }
  }
  return most;
}

/* Steps with the bounds as they are */
static PetscErrorCode SolveWithBounds(FrictionSolver solver, const FrictionProblem *problem, const PetscScalar bounds[])
{
  PetscScalar *way = solver->work[1], *opens = solver->work[0];
  PetscReal    length = 1, largest = 0;

  PetscFunctionBegin;
  for (PetscInt step = 0; step < STEPS_MOST; step++) {
    PetscReal most = FindWay(solver, problem, length, bounds, way), slope = 0, curvature = 0, scaled = 0, part;

    for (PetscInt i = 0; i < problem->n; i++) largest = PetscMax(largest, PetscAbsScalar(problem->force[i]));
    if (most <= SMALL * largest) break;
    PetscCall(FrictionProblemMultiply(problem, way, opens));
    for (PetscInt i = 0; i < problem->n; i++) {
      const PetscReal stiffness = GetStiffness(solver, problem, i);

      slope += PetscRealPart(solver->open[i] * way[i]);
      curvature += PetscRealPart(opens[i] * way[i]);
      if (stiffness > 0) scaled += PetscSqr(PetscRealPart(way[i])) / stiffness;
    }
    part = curvature > 0 ? PetscMin(1, -slope / curvature) : 1;
    if (part <= 0) break;
    for (PetscInt i = 0; i < problem->n; i++) {
      problem->force[i] += part * way[i];
      solver->open[i] += part * opens[i];
    }
    length = curvature > 0 ? scaled / curvature : 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes nearer to the forces for which the law holds; then what all rows open by */
PetscErrorCode FrictionSolveByBounds(FrictionSolver solver, const FrictionProblem *problem)
{
  PetscScalar *bounds = solver->work[2];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(bounds, problem->n));
  for (PetscInt round = 0; round < ROUNDS_MOST; round++) {
    PetscReal change = 0, largest = 0;

    for (PetscInt first = 0; first < problem->n; first += problem->dim) {
      const PetscReal bound = PetscMax(
          PetscRealPart(problem->limit[first] + problem->limit[first + 1] * PetscMax(PetscRealPart(problem->force[first]), 0)), 0);

      change        = PetscMax(change, PetscAbsReal(bound - PetscRealPart(bounds[first])));
      largest       = PetscMax(largest, bound);
      bounds[first] = bound;
    }
    if (round && change <= SMALL * largest) break;
    PetscCall(SolveWithBounds(solver, problem, bounds));
    PetscCall(FrictionOpen(solver, problem));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
