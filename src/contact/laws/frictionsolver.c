/*
   Forces of a controller step with friction, where S is a matrix.

   Newton's method, with LU factors. In two dimensions the problem is linear as long as the states stay, so that they decide. Where that
   does not come to an end, nodes are solved one after another, each exactly, until forces stay (block Gauss-Seidel), and Newton's method
   goes on from there. Rounds of a hundred nodes that a band strings together do not come to an end, and states that all change at once go
   round in circles. So in two dimensions the last resort is that only the first node that would change its state does so (the least-index
   rule of Murty 1974, which comes to an end where there is no friction, and mostly with it).
*/
#include "frictionsolver.h"

/* Newton's steps before nodes are solved one after another, and in all */
#define NEWTON_FIRST 12
#define NEWTON_MOST  60
/* Steps in which one node changes its state */
#define ONE_BY_ONE_MOST 100
/* Rounds of nodes that are solved one after another, and the change of forces at which these end, relative to the largest */
#define ROUNDS_MOST 4000
#define ROUNDS_RTOL 1e-13
/* Newton's method ends where forces change by this part of the largest, with states as they were; or where the round-off of the factors,
   below the second of these, keeps changes from falling any more: by less than the factor, while Newton's method squares them */
#define NEWTON_RTOL      1e-14
#define NEWTON_ROUND_OFF 1e-10
#define NEWTON_FALLS     0.1

PetscErrorCode FrictionSolverCreate(FrictionSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(solver));
  PetscCall(FrictionIterationCreate(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FreeRoom(FrictionSolver solver)
{
  PetscFunctionBegin;
  PetscCall(PetscFree6(solver->open, solver->trial, solver->rhs, solver->in, solver->of_force, solver->of_opening));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionSolverDestroy(FrictionSolver *solver)
{
  PetscFunctionBegin;
  if (!*solver) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FreeRoom(*solver));
  PetscCall(DenseFactorDestroy(&(*solver)->factor));
  PetscCall(FrictionIterationDestroy(*solver));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeRoom(FrictionSolver solver, const FrictionProblem *problem)
{
  PetscInt n = problem->n;

  PetscFunctionBegin;
  if (n <= solver->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FreeRoom(solver));
  solver->room = PetscMax(n, 2 * solver->room);
  n            = solver->room;
  PetscCall(PetscMalloc6(n, &solver->open, n, &solver->trial, n, &solver->rhs, n, &solver->in, problem->dim * n, &solver->of_force,
                         problem->dim * n, &solver->of_opening));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One step of Newton's method with the states as they are; `change`: the largest of a force, relative to the largest force */
static PetscErrorCode Step(FrictionSolver solver, const FrictionProblem *problem, PetscBool *singular, PetscReal *change)
{
  const PetscInt dim = problem->dim, n = problem->n;
  PetscReal      largest = 0, most = 0;
  PetscInt       n_in = 0;

  PetscFunctionBegin;
  *singular = PETSC_FALSE;
  /* forces of nodes that open are gone, which opens all others by something */
  for (PetscInt i = 0; i < n; i++)
    if (problem->state[i / dim] == FRICTION_OPEN) most = PetscMax(most, PetscAbsScalar(problem->force[i]));
    else solver->in[n_in++] = i;
  if (FrictionDropForces(solver, problem)) PetscCall(FrictionOpen(solver, problem));
  FrictionSetEquations(solver, problem);
  PetscCall(DenseFactorResize(&solver->factor, n_in, n));
  for (PetscInt row = 0; row < n_in; row++) {
    const PetscInt     i = solver->in[row], first = i - i % dim;
    const PetscScalar *of_force = solver->of_force + i * dim, *of_opening = solver->of_opening + i * dim;
    PetscScalar       *entry = solver->factor.values + row;

    for (PetscInt j = 0; j < n_in; j++) entry[j * n_in] = 0;
    for (PetscInt l = 0; l < dim; l++)
      for (PetscInt j = 0; j < n_in && of_opening[l] != 0; j++)
        entry[j * n_in] += of_opening[l] * problem->S[solver->in[j] * n + first + l];
    /* the rows of a node that touches are all in, one after the other */
    for (PetscInt l = 0; l < dim; l++) entry[(row - i + first + l) * n_in] += of_force[l];
    solver->rhs[row] = solver->rhs[i];
  }
  if (n_in) PetscCall(DenseFactorCompute(&solver->factor, singular));
  if (*singular) PetscFunctionReturn(PETSC_SUCCESS);
  if (n_in) PetscCall(DenseFactorSolve(&solver->factor, solver->rhs));
  for (PetscInt row = 0; row < n_in; row++) {
    PetscScalar *force = &problem->force[solver->in[row]];

    *force += solver->rhs[row];
    most    = PetscMax(most, PetscAbsScalar(solver->rhs[row]));
    largest = PetscMax(largest, PetscAbsScalar(*force));
  }
  *change = largest > 0 ? most / largest : 0;
  PetscCall(FrictionOpen(solver, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of one node. One that is held in one of two directions across its normal, and not dragged there, is one in the plane. */
static PetscErrorCode SolveNode(const FrictionProblem *problem, PetscInt first, PetscBool dragged, const PetscReal S[],
                                const PetscReal open[], const PetscReal limit[], PetscReal force[])
{
  const PetscBool held[2] = {FrictionImmovable(problem, first, 1), (PetscBool)(problem->dim > 2 && FrictionImmovable(problem, first, 2))};
  const PetscInt  moves   = held[0] && problem->dim > 2 ? 2 : 1;
  const PetscReal S_plane[4]    = {S[0], S[moves], S[problem->dim * moves], S[problem->dim * moves + moves]},
                  open_plane[2] = {open[0], open[moves]};
  PetscReal       force_plane[2];

  PetscFunctionBegin;
  if (problem->dim == 2 || dragged || held[0] == held[1]) {
    PetscCall(FrictionSolveNode(problem->dim, S, open, limit, force));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FrictionSolveNode(2, S_plane, open_plane, limit, force_plane));
  force[0]         = force_plane[0];
  force[moves]     = force_plane[1];
  force[3 - moves] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes one after another, each exactly, until forces stay; then what all rows open by */
static PetscErrorCode SolveByNodes(FrictionSolver solver, const FrictionProblem *problem)
{
  const PetscInt dim = problem->dim, n = problem->n;
  PetscReal      change = 1, largest = 1;

  PetscFunctionBegin;
  PetscCall(FrictionOpen(solver, problem));
  for (PetscInt round = 0; round < ROUNDS_MOST && change > ROUNDS_RTOL * largest; round++) {
    change = largest = 0;
    for (PetscInt first = 0; first < n; first += dim) {
      PetscReal       S[9], open[3], force[3];
      const PetscReal limit[2] = {PetscRealPart(problem->limit[first]), PetscRealPart(problem->limit[first + 1])};

      for (PetscInt k = 0; k < dim; k++) {
        open[k] = PetscRealPart(solver->open[first + k]);
        for (PetscInt l = 0; l < dim; l++) {
          S[l * dim + k] = PetscRealPart(problem->S[(first + l) * n + first + k]);
          open[k] -= S[l * dim + k] * PetscRealPart(problem->force[first + l]);
        }
      }
      PetscCall(SolveNode(problem, first, FrictionDragged(problem, solver->open, first), S, open, limit, force));
      if (FrictionStiffness(problem, first, 1, dim) == 0 && FrictionDragged(problem, solver->open, first) && force[0] > 0) {
        PetscReal way = 0;

        for (PetscInt k = 1; k < dim; k++) way += PetscSqr(open[k]);
        for (PetscInt k = 1; k < dim; k++) force[k] = -PetscMax(limit[0] + limit[1] * force[0], 0) * open[k] / PetscSqrtReal(way);
      }
      for (PetscInt k = 0; k < dim; k++) {
        const PetscReal step = force[k] - PetscRealPart(problem->force[first + k]);

        change                    = PetscMax(change, PetscAbsReal(step));
        largest                   = PetscMax(largest, PetscAbsReal(force[k]));
        problem->force[first + k] = force[k];
        for (PetscInt i = 0; i < n && step != 0; i++) solver->open[i] += problem->S[(first + k) * n + i] * step;
      }
    }
  }
  PetscCall(FrictionOpen(solver, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of GMRES, in the last FrictionSolverSolve(); none where S is a matrix */
PetscInt FrictionSolverGetIterations(FrictionSolver solver)
{
  return solver->iterations;
}

/* Finds the forces and states of a step. `by_nodes`: Newton's method alone did not; `solved`: false where nothing did. The same on every
 * rank. */
PetscErrorCode FrictionSolverSolve(FrictionSolver solver, const FrictionProblem *problem, PetscBool *solved, PetscBool *by_nodes)
{
  PetscBool changed, singular;
  PetscReal change = PETSC_MAX_REAL;

  PetscFunctionBegin;
  *solved = *by_nodes = PETSC_FALSE;
  solver->iterations  = 0;
  PetscCall(MakeRoom(solver, problem));
  if (!problem->S) {
    PetscCall(FrictionIterate(solver, problem, solved, by_nodes));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FrictionOpen(solver, problem));
  PetscCall(PetscArrayzero(solver->trial, problem->n));
  (void)FrictionJudge(solver, problem, PETSC_FALSE);
  for (PetscInt step = 1; step <= NEWTON_MOST && !*solved; step++) {
    const PetscReal last = change;

    PetscCall(Step(solver, problem, &singular, &change));
    changed = FrictionJudge(solver, problem, PETSC_FALSE);
    *solved = (PetscBool)(!singular && !changed &&
                          (problem->dim == 2 || change <= NEWTON_RTOL || (change <= NEWTON_ROUND_OFF && change > NEWTON_FALLS * last)));
    if (singular || step == NEWTON_FIRST) {
      if (*by_nodes && singular) break;
      if (*solved) break;
      *by_nodes = PETSC_TRUE;
      PetscCall(SolveByNodes(solver, problem));
      (void)FrictionJudge(solver, problem, PETSC_FALSE);
    }
  }
  for (PetscInt step = 0; step < ONE_BY_ONE_MOST && !*solved && problem->dim == 2; step++) {
    PetscCall(Step(solver, problem, &singular, &change));
    if (singular) break;
    *solved = (PetscBool)!FrictionJudge(solver, problem, PETSC_TRUE);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
