/*
   The equations of Newton's step, semismooth in the states of nodes. Of each node, with normal force l and gap g, force f and slip s across
   the normal, and the bound r(l) of f that the law has:

     open: l = 0, f = 0, g >= 0;   sticks: g = 0, s = 0, |f| <= r;   slides: g = 0, f = r e, s = -a e with a >= 0, |e| = 1.

   A node is open where l - p g <= 0, with p = 1 / S of its normal row, slides where the trial force f - q s is beyond the bound, and sticks
   else (Alart, Curnier 1991). Each row has an equation of the change d of the forces on its node, and of what that opens the node's rows
   by, y = S d.
*/
#include "frictionsolver.h"

/* A row is held whose compliance is this part of that of the other row across the normal: round-off */
#define HELD 1e-14

/* What all rows open by under the forces as they are; overwrites the right-hand side */
PetscErrorCode FrictionOpen(FrictionSolver solver, const FrictionProblem *problem)
{
  PetscBool same = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) {
    solver->rhs[i] = problem->force[i] - problem->base[i];
    same           = (PetscBool)(same && solver->rhs[i] == 0);
  }
  if (same) PetscCall(PetscArrayzero(solver->open, problem->n)); /* as each solution begins, which spares a product */
  else PetscCall(FrictionProblemMultiply(problem, solver->rhs, solver->open));
  for (PetscInt i = 0; i < problem->n; i++) solver->open[i] += problem->opened[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inverse of the largest compliance of the rows k to l - 1 of a node [N/m] */
PetscReal FrictionStiffness(const FrictionProblem *problem, PetscInt first, PetscInt k, PetscInt l)
{
  PetscReal most = 0;

  for (PetscInt i = first + k; i < first + l; i++) most = PetscMax(most, FrictionCompliance(problem, i, i));
  return most > 0 ? 1 / most : 0;
}

/* Whether no force moves the node along its row `first + k`, since it is held there, as in a plane of symmetry */
PetscBool FrictionImmovable(const FrictionProblem *problem, PetscInt first, PetscInt k)
{
  return (PetscBool)(FrictionCompliance(problem, first + k, first + k) * FrictionStiffness(problem, first, 1, problem->dim) <= HELD);
}

/* Whether the node is dragged past its partner where nothing moves it across its normal: what holds it bears the friction */
PetscBool FrictionDragged(const FrictionProblem *problem, const PetscScalar open[], PetscInt first)
{
  PetscReal square = 0;

  for (PetscInt k = 1; k < problem->dim; k++)
    if (FrictionImmovable(problem, first, k)) square += PetscSqr(PetscRealPart(open[first + k]));
  return (PetscBool)(square > PetscSqr(problem->still));
}

/* States from forces and what rows open by, with trial forces across the normal; whether any has changed, or the way that a node slides has
   turned round. `single`: the first such node alone gets its new state. */
PetscBool FrictionJudge(FrictionSolver solver, const FrictionProblem *problem, PetscBool single)
{
  const PetscInt dim     = problem->dim;
  PetscBool      changed = PETSC_FALSE;

  for (PetscInt node = 0; node < problem->n / dim; node++) {
    const PetscInt  first  = node * dim;
    const PetscReal normal = PetscRealPart(problem->force[first]), p = FrictionStiffness(problem, first, 0, 1);
    const PetscReal q      = FrictionStiffness(problem, first, 1, dim);
    const PetscReal bound  = PetscMax(PetscRealPart(problem->limit[first] + problem->limit[first + 1] * normal), 0);
    PetscReal       square = 0, along = 0; /* along the direction of before */
    PetscScalar     way[3] = {0};
    PetscBool       other;
    FrictionState   state   = FRICTION_OPEN;
    const PetscBool dragged = FrictionDragged(problem, solver->open, first);

    for (PetscInt k = 1; k < dim; k++) {
      const PetscScalar trial = dragged && q == 0 ? -solver->open[first + k] : problem->force[first + k] - q * solver->open[first + k];

      along += PetscRealPart(trial * solver->trial[first + k]);
      square += PetscSqr(PetscRealPart(trial));
      way[k] = trial;
    }
    /* a row that nothing moves is no condition */
    if (p > 0 && normal - p * PetscRealPart(solver->open[first]) > 0)
      state = dragged || square > PetscSqr(bound) ? FRICTION_SLIDES : FRICTION_STICKS;
    /* one that slides the way that its force pushes would be turned round, and back, where it sticks */
    if (state == FRICTION_SLIDES && problem->state[node] == FRICTION_SLIDES && along < 0 && !dragged) state = FRICTION_STICKS;
    other = (PetscBool)(state != problem->state[node] || (state == FRICTION_SLIDES && along < 0));
    if (single && (changed || !other)) continue;
    if (other) changed = PETSC_TRUE;
    problem->state[node] = state;
    for (PetscInt k = 1; k < dim; k++) solver->trial[first + k] = way[k];
  }
  return changed;
}

/* The equation of row `first + k` of a node that slides: f - r(l) e = 0, e = t/|t| of the trial force t = f - q s, times 1/q so that it has
   the unit of the other rows. A node that nothing moves across its normal has no t but the way that it is dragged, and no force where it
   is not. */
static void SetSliding(FrictionSolver solver, const FrictionProblem *problem, PetscInt first, PetscInt k)
{
  const PetscInt  dim = problem->dim, i = first + k;
  const PetscReal q = FrictionStiffness(problem, first, 1, dim), coefficient = PetscRealPart(problem->limit[first + 1]);
  /* below zero on the way to the solution it must not be cut off: the equation would not be the law's any more */
  const PetscReal bound = PetscRealPart(problem->limit[first] + coefficient * problem->force[first]);
  PetscReal       size = 0, e[3] = {0};

  for (PetscInt l = 1; l < dim; l++) size += PetscSqr(PetscRealPart(solver->trial[first + l]));
  size = PetscSqrtReal(size);
  for (PetscInt l = 1; l < dim && size > 0; l++) e[l] = PetscRealPart(solver->trial[first + l]) / size;
  if (q == 0) {
    const PetscReal c = FrictionCompliance(problem, first, first);

    if (problem->state[first / dim] != FRICTION_SLIDES) e[k] = 0;
    solver->of_force[i * dim + k] = c;
    solver->of_force[i * dim]     = -c * coefficient * e[k];
    solver->rhs[i]                = c * (bound * e[k] - problem->force[i]);
    return;
  }
  solver->of_force[i * dim]     = -coefficient * e[k] / q;
  solver->of_force[i * dim + k] = 1 / q;
  for (PetscInt l = 1; l < dim && dim > 2; l++) {
    const PetscReal turns = PetscMax(bound, 0) / size * ((l == k ? 1 : 0) - e[k] * e[l]);

    solver->of_force[i * dim + l] -= turns / q;
    solver->of_opening[i * dim + l] = turns;
  }
  solver->rhs[i] = (bound * e[k] - problem->force[i]) / q;
}

/* The equations of all rows, from the states, trial forces and openings as they are: of_force d + of_opening S d = rhs [m] */
void FrictionSetEquations(FrictionSolver solver, const FrictionProblem *problem)
{
  const PetscInt dim = problem->dim;

  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt  first = i - i % dim;
    const PetscReal c     = FrictionCompliance(problem, first, first);

    for (PetscInt l = 0; l < dim; l++) solver->of_force[i * dim + l] = solver->of_opening[i * dim + l] = 0;
    if (problem->state[i / dim] == FRICTION_OPEN) {
      solver->of_force[i * dim + i - first] = c > 0 ? c : 1;
      solver->rhs[i]                        = 0;
    } else if (i > first && FrictionImmovable(problem, first, i - first) && !FrictionDragged(problem, solver->open, first)) {
      /* a node that is held in one direction across its normal, and not dragged there, has no friction in that direction */
      solver->of_force[i * dim + i - first] = c;
      solver->rhs[i]                        = -c * problem->force[i];
    } else if (i > first && (problem->state[i / dim] == FRICTION_SLIDES || FrictionStiffness(problem, first, 1, dim) == 0))
      SetSliding(solver, problem, first, i - first);
    else {
      solver->of_opening[i * dim + i - first] = 1;
      solver->rhs[i]                          = -solver->open[i];
    }
  }
}

/* Takes the forces from nodes that are open; whether there were any. Those of rows that nothing moves, and that are not dragged, go too:
   they open no row. */
PetscBool FrictionDropForces(FrictionSolver solver, const FrictionProblem *problem)
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt first = i - i % problem->dim;

    if (problem->force[i] == 0) continue;
    if (problem->state[i / problem->dim] == FRICTION_OPEN) {
      problem->force[i] = 0;
      any               = PETSC_TRUE;
    } else if (i > first && FrictionImmovable(problem, first, i - first) && !FrictionDragged(problem, solver->open, first))
      problem->force[i] = 0;
  }
  return any;
}
