/*
   Forces of a controller step with friction. Of each node, with normal force l and gap g, force f and slip s across the normal, and the
   bound r(l) of f that the law has:

     open: l = 0, f = 0, g >= 0;   sticks: g = 0, s = 0, |f| <= r;   slides: g = 0, f = r e, s = -a e with a >= 0, |e| = 1.

   Newton's method, semismooth in the state of the nodes (Alart, Curnier 1991): a node is open where l - p g <= 0, with p = 1 / S of its
   normal row, slides where the trial force f - q s is beyond the bound, and sticks else. In two dimensions the problem is linear as long as
   the states stay, so that they decide. Where that does not come to an end, nodes are solved one after another, each exactly, until forces
   stay (block Gauss-Seidel), and Newton's method goes on from there. Rounds of a hundred nodes that a band strings together do not come to
   an end, and states that all change at once go round in circles. So in two dimensions the last resort is that only the first node that
   would change its state does so (the least-index rule of Murty 1974, which comes to an end where there is no friction, and mostly with
   it).
*/
#include "friction.h"
#include <solver/densefactor.h>

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

/* A row is held whose compliance is this part of that of the other row across the normal: round-off */
#define HELD 1e-14

struct _n_FrictionSolver {
  PetscInt     room;
  DenseFactor  factor;
  PetscScalar *open, *trial, *rhs; /* what rows open by; trial forces; right-hand side, then Newton's step */
  PetscInt    *in;                 /* rows of nodes that touch */
};

PetscErrorCode FrictionSolverCreate(FrictionSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FreeRoom(FrictionSolver solver)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(solver->open, solver->trial, solver->rhs, solver->in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionSolverDestroy(FrictionSolver *solver)
{
  PetscFunctionBegin;
  if (!*solver) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FreeRoom(*solver));
  PetscCall(DenseFactorDestroy(&(*solver)->factor));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeRoom(FrictionSolver solver, PetscInt n)
{
  PetscFunctionBegin;
  if (n <= solver->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FreeRoom(solver));
  solver->room = PetscMax(n, 2 * solver->room);
  n            = solver->room;
  PetscCall(PetscMalloc4(n, &solver->open, n, &solver->trial, n, &solver->rhs, n, &solver->in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all rows open by under the forces as they are */
static PetscErrorCode Open(const FrictionProblem *problem, PetscScalar work[], PetscScalar open[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) {
    work[i] = problem->force[i] - problem->base[i];
    open[i] = problem->opened[i];
  }
  PetscCall(DenseMultiplyAdd(problem->n, problem->n, problem->S, 1, work, open));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inverse of the largest compliance of the rows k to l - 1 of a node [N/m] */
static PetscReal Stiffness(const FrictionProblem *problem, PetscInt first, PetscInt k, PetscInt l)
{
  PetscReal most = 0;

  for (PetscInt i = first + k; i < first + l; i++) most = PetscMax(most, PetscRealPart(problem->S[i * (problem->n + 1)]));
  return most > 0 ? 1 / most : 0;
}

/* Whether no force moves the node along its row `first + k`, since it is held there, as in a plane of symmetry */
static PetscBool Immovable(const FrictionProblem *problem, PetscInt first, PetscInt k)
{
  return (PetscBool)(PetscRealPart(problem->S[(first + k) * (problem->n + 1)]) * Stiffness(problem, first, 1, problem->dim) <= HELD);
}

/* Whether the node is dragged past its partner where nothing moves it across its normal: what holds it bears the friction */
static PetscBool Dragged(const FrictionProblem *problem, const PetscScalar open[], PetscInt first)
{
  PetscReal square = 0;

  for (PetscInt k = 1; k < problem->dim; k++)
    if (Immovable(problem, first, k)) square += PetscSqr(PetscRealPart(open[first + k]));
  return (PetscBool)(square > PetscSqr(problem->still));
}

/* States from forces and what rows open by, with trial forces across the normal; whether any has changed, or the way that a node slides has
   turned round. `single`: the first such node alone gets its new state. */
static PetscBool Judge(FrictionSolver solver, const FrictionProblem *problem, PetscBool single)
{
  const PetscInt dim     = problem->dim;
  PetscBool      changed = PETSC_FALSE;

  for (PetscInt node = 0; node < problem->n / dim; node++) {
    const PetscInt  first  = node * dim;
    const PetscReal normal = PetscRealPart(problem->force[first]), p = Stiffness(problem, first, 0, 1);
    const PetscReal q      = Stiffness(problem, first, 1, dim);
    const PetscReal bound  = PetscMax(PetscRealPart(problem->limit[first] + problem->limit[first + 1] * normal), 0);
    PetscReal       square = 0, along = 0; /* along the direction of before */
    PetscScalar     way[3] = {0};
    PetscBool       other;
    FrictionState   state   = FRICTION_OPEN;
    const PetscBool dragged = Dragged(problem, solver->open, first);

    for (PetscInt k = 1; k < dim; k++) {
      const PetscScalar trial = dragged && q == 0 ? -solver->open[first + k] : problem->force[first + k] - q * solver->open[first + k];

      along += PetscRealPart(trial * solver->trial[first + k]);
      square += PetscSqr(PetscRealPart(trial));
      way[k] = trial;
    }
    /* a row that nothing moves is no condition */
    if (p > 0 && normal - p * PetscRealPart(solver->open[first]) > 0)
      state = dragged || square > PetscSqr(bound) ? FRICTION_SLIDES : FRICTION_STICKS;
    other = (PetscBool)(state != problem->state[node] || (state == FRICTION_SLIDES && along < 0));
    if (single && (changed || !other)) continue;
    if (other) changed = PETSC_TRUE;
    problem->state[node] = state;
    for (PetscInt k = 1; k < dim; k++) solver->trial[first + k] = way[k];
  }
  return changed;
}

/* Row `first + k` of the matrix of a node that slides, and its right-hand side: f - r(l) e = 0, e = t/|t| of the trial force t = f - q s,
   times 1/q so that it has the unit of the other rows. A node that nothing moves across its normal has no t but the way that it is dragged,
   and no force where it is not. */
static void SetSliding(FrictionSolver solver, const FrictionProblem *problem, PetscInt first, PetscInt k, PetscInt row, PetscInt n_in)
{
  const PetscInt  dim = problem->dim, n = problem->n;
  const PetscReal q = Stiffness(problem, first, 1, dim), coefficient = PetscRealPart(problem->limit[first + 1]);
  /* below zero on the way to the solution it must not be cut off: the equation would not be the law's any more */
  const PetscReal bound  = PetscRealPart(problem->limit[first] + coefficient * problem->force[first]);
  PetscScalar    *matrix = solver->factor.values;
  PetscReal       size = 0, e[3] = {0};

  for (PetscInt l = 1; l < dim; l++) size += PetscSqr(PetscRealPart(solver->trial[first + l]));
  size = PetscSqrtReal(size);
  for (PetscInt l = 1; l < dim && size > 0; l++) e[l] = PetscRealPart(solver->trial[first + l]) / size;
  if (q == 0) {
    const PetscReal c = PetscRealPart(problem->S[first * (n + 1)]);

    if (problem->state[first / dim] != FRICTION_SLIDES) e[k] = 0;
    for (PetscInt j = 0; j < n_in; j++)
      matrix[j * n_in + row] = solver->in[j] == first + k ? c : solver->in[j] == first ? -c * coefficient * e[k] : 0;
    solver->rhs[row] = c * (bound * e[k] - problem->force[first + k]);
    return;
  }
  for (PetscInt j = 0; j < n_in; j++) {
    const PetscInt column = solver->in[j];
    PetscScalar    value  = 0;

    if (column == first) value -= coefficient * e[k];
    if (column == first + k) value += 1;
    for (PetscInt l = 1; l < dim && dim > 2; l++) {
      const PetscReal across = (l == k ? 1 : 0) - e[k] * e[l];

      value -= PetscMax(bound, 0) / size * across * ((column == first + l ? 1 : 0) - q * problem->S[column * n + first + l]);
    }
    matrix[j * n_in + row] = value / q;
  }
  solver->rhs[row] = (bound * e[k] - problem->force[first + k]) / q;
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
    if (problem->state[i / dim] == FRICTION_OPEN) {
      most              = PetscMax(most, PetscAbsScalar(problem->force[i]));
      problem->force[i] = 0;
    } else solver->in[n_in++] = i;
  PetscCall(Open(problem, solver->rhs, solver->open));
  PetscCall(DenseFactorResize(&solver->factor, n_in, n));
  for (PetscInt row = 0; row < n_in; row++) {
    const PetscInt i = solver->in[row], first = i - i % dim;

    /* a node that is held in one direction across its normal, and not dragged there, has no friction in that direction */
    if (i > first && Immovable(problem, first, i - first) && !Dragged(problem, solver->open, first)) {
      const PetscScalar c = problem->S[first * (n + 1)];

      for (PetscInt j = 0; j < n_in; j++) solver->factor.values[j * n_in + row] = j == row ? c : 0;
      solver->rhs[row] = -c * problem->force[i];
      continue;
    }
    if (i > first && (problem->state[i / dim] == FRICTION_SLIDES || Stiffness(problem, first, 1, dim) == 0)) {
      SetSliding(solver, problem, first, i - first, row, n_in);
      continue;
    }
    for (PetscInt j = 0; j < n_in; j++) solver->factor.values[j * n_in + row] = problem->S[solver->in[j] * n + i];
    solver->rhs[row] = -solver->open[i];
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
  PetscCall(Open(problem, solver->rhs, solver->open));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of one node. One that is held in one of two directions across its normal, and not dragged there, is one in the plane. */
static PetscErrorCode SolveNode(const FrictionProblem *problem, PetscInt first, PetscBool dragged, const PetscReal S[],
                                const PetscReal open[], const PetscReal limit[], PetscReal force[])
{
  const PetscBool held[2]       = {Immovable(problem, first, 1), (PetscBool)(problem->dim > 2 && Immovable(problem, first, 2))};
  const PetscInt  moves         = held[0] && problem->dim > 2 ? 2 : 1;
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
  PetscCall(Open(problem, solver->rhs, solver->open));
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
      PetscCall(SolveNode(problem, first, Dragged(problem, solver->open, first), S, open, limit, force));
      if (Stiffness(problem, first, 1, dim) == 0 && Dragged(problem, solver->open, first) && force[0] > 0) {
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
  PetscCall(Open(problem, solver->rhs, solver->open));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the forces and states of a step. `by_nodes`: Newton's method alone did not; `solved`: nothing did. The same on every rank. */
PetscErrorCode FrictionSolverSolve(FrictionSolver solver, const FrictionProblem *problem, PetscBool *solved, PetscBool *by_nodes)
{
  PetscBool changed, singular;
  PetscReal change = PETSC_MAX_REAL;

  PetscFunctionBegin;
  *solved = *by_nodes = PETSC_FALSE;
  PetscCall(MakeRoom(solver, problem->n));
  PetscCall(Open(problem, solver->rhs, solver->open));
  PetscCall(PetscArrayzero(solver->trial, problem->n));
  (void)Judge(solver, problem, PETSC_FALSE);
  for (PetscInt step = 1; step <= NEWTON_MOST && !*solved; step++) {
    const PetscReal last = change;

    PetscCall(Step(solver, problem, &singular, &change));
    changed = Judge(solver, problem, PETSC_FALSE);
    *solved = (PetscBool)(!singular && !changed &&
                          (problem->dim == 2 || change <= NEWTON_RTOL || (change <= NEWTON_ROUND_OFF && change > NEWTON_FALLS * last)));
    if (singular || step == NEWTON_FIRST) {
      if (*by_nodes && singular) break;
      if (*solved) break;
      *by_nodes = PETSC_TRUE;
      PetscCall(SolveByNodes(solver, problem));
      (void)Judge(solver, problem, PETSC_FALSE);
    }
  }
  for (PetscInt step = 0; step < ONE_BY_ONE_MOST && !*solved && problem->dim == 2; step++) {
    PetscCall(Step(solver, problem, &singular, &change));
    if (singular) break;
    *solved = (PetscBool)!Judge(solver, problem, PETSC_TRUE);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
