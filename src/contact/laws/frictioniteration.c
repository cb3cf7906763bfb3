/*
   Forces of a controller step with friction, where S is only multiplied with: rows are too many for a matrix.

   Newton's method with the equations of frictionequations.c, each step by GMRES: one product with S for each iteration. While states change
   a step need not be exact; with states that stay it is solved as far as the law is to hold. What preconditions is what is known of the
   inverse of S, on the rows that are to be closed; the force of a node that slides follows from that along its normal,

     d_e = q x_e + mu d_N,   d_a = (1 - w) q x_a + w P x_a,

   along the way e of its force and across that, w being the part of the bound in the trial force: with a slip that is small beside q a node
   sticks across its way, with one that is large it follows.

   Where that does not come to an end, projected gradients with the bounds as they are, renewed from time to time, go nearer to the solution
   (frictionbounds.c), and Newton's method goes on from there.
*/
#include "frictionsolver.h"

/* Newton's steps before the bounds of forces are held, each time, and in all */
#define NEWTON_FIRST 15
#define NEWTON_MOST  60
/* Iterations of GMRES before it forgets, and for one step */
#define RESTART        60
#define MAX_ITERATIONS 600
/* By how much equations may be missed, in parts of what the largest force opens its own row by: Newton's method ends below the first; below
   the second where a step makes it no better than by the factor, since round-off keeps it there */
#define NEWTON_RTOL      1e-12
#define NEWTON_ROUND_OFF 1e-10
#define NEWTON_FALLS     0.3
/* What a step leaves of that while states change; and in the end, in parts of what Newton's method ends with */
#define FORCING 1e-2
#define LEAVES  0.3

/* y = (of_force + of_opening S) x */
static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  FrictionSolver         solver;
  const FrictionProblem *problem;
  const PetscScalar     *change;
  PetscScalar           *result, *opening;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &solver));
  problem = solver->problem;
  opening = solver->work[0];
  PetscCall(VecGetArrayRead(x, &change));
  PetscCall(FrictionProblemMultiply(problem, change, opening));
  PetscCall(VecGetArray(y, &result));
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt first = i - i % problem->dim;

    result[i] = 0;
    for (PetscInt l = 0; l < problem->dim; l++)
      result[i] += solver->of_force[i * problem->dim + l] * change[first + l] +
                   solver->of_opening[i * problem->dim + l] * opening[first + l];
  }
  for (PetscInt i = problem->n; i < solver->iterated; i++) result[i] = change[i];
  PetscCall(VecRestoreArray(y, &result));
  PetscCall(VecRestoreArrayRead(x, &change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a node that slides the way e of its force, and w: the part of the bound in the trial force */
static PetscReal GetWay(FrictionSolver solver, PetscInt first, PetscReal e[])
{
  const FrictionProblem *problem = solver->problem;
  const PetscReal        bound   = PetscRealPart(problem->limit[first] + problem->limit[first + 1] * problem->force[first]);
  PetscReal              size    = 0;

  for (PetscInt k = 1; k < problem->dim; k++) size += PetscSqr(PetscRealPart(solver->trial[first + k]));
  size = PetscSqrtReal(size);
  for (PetscInt k = 1; k < problem->dim; k++) e[k] = size > 0 ? PetscRealPart(solver->trial[first + k]) / size : 0;
  return size > 0 ? PetscMin(PetscMax(bound, 0) / size, 1) : 0;
}

/* The rows that P is for: of all nodes that touch those along normals, and those across them that have no equation of a force alone */
static PetscErrorCode ChooseRows(FrictionSolver solver)
{
  const FrictionProblem *problem = solver->problem;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) {
    solver->chosen[i] = PETSC_FALSE;
    for (PetscInt l = 0; l < problem->dim; l++)
      if (solver->of_opening[i * problem->dim + l] != 0) solver->chosen[i] = PETSC_TRUE;
  }
  if (problem->products->choose) PetscCall((*problem->products->choose)(problem->products->data, solver->chosen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What P gets of a node */
static void GoIn(FrictionSolver solver, PetscInt first, const PetscScalar x[], PetscScalar in[])
{
  const FrictionProblem *problem = solver->problem;
  const PetscInt         dim     = problem->dim;
  PetscReal              e[3], w;
  PetscScalar            along = 0;

  for (PetscInt k = 0; k < dim; k++) in[first + k] = x[first + k];
  if (problem->state[first / dim] != FRICTION_SLIDES) return;
  w = GetWay(solver, first, e);
  for (PetscInt k = 1; k < dim; k++) along += e[k] * x[first + k];
  for (PetscInt k = 1; k < dim; k++) in[first + k] = dim > 2 ? w * (x[first + k] - along * e[k]) : 0;
}

/* What becomes of its answer there. Rows with an equation of their own force alone are solved by themselves. */
static void ComeOut(FrictionSolver solver, PetscInt first, const PetscScalar x[], const PetscScalar out[], PetscScalar y[])
{
  const FrictionProblem *problem = solver->problem;
  const PetscInt         dim     = problem->dim;
  const PetscReal        q       = FrictionStiffness(problem, first, 1, dim);
  PetscReal              e[3], w;
  PetscScalar            along[2] = {0, 0};

  for (PetscInt k = 0; k < dim; k++)
    y[first + k] = solver->chosen[first + k] ? out[first + k] : x[first + k] / solver->of_force[(first + k) * dim + k];
  if (problem->state[first / dim] != FRICTION_SLIDES) return;
  w = GetWay(solver, first, e);
  if (q == 0) { /* dragged where nothing moves it */
    for (PetscInt k = 1; k < dim; k++) y[first + k] += problem->limit[first + 1] * e[k] * y[first];
    return;
  }
  for (PetscInt k = 1; k < dim; k++) {
    along[0] += e[k] * x[first + k];
    along[1] += e[k] * out[first + k];
  }
  for (PetscInt k = 1; k < dim; k++) {
    y[first + k] = e[k] * (q * along[0] + problem->limit[first + 1] * y[first]);
    if (dim > 2) y[first + k] += (1 - w) * q * (x[first + k] - along[0] * e[k]) + out[first + k] - along[1] * e[k];
  }
}

static PetscErrorCode Precondition(PC pc, Vec X, Vec Y)
{
  FrictionSolver         solver;
  const FrictionProblem *problem;
  const PetscScalar     *x;
  PetscScalar           *y, *in, *out;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &solver));
  problem = solver->problem;
  in      = solver->work[1];
  out     = solver->work[2];
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(VecGetArray(Y, &y));
  for (PetscInt first = 0; first < problem->n; first += problem->dim) GoIn(solver, first, x, in);
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscReal c = FrictionCompliance(problem, i, i);

    out[i] = c > 0 ? in[i] / c : 0;
  }
  if (problem->products->precondition) PetscCall((*problem->products->precondition)(problem->products->data, in, out));
  for (PetscInt first = 0; first < problem->n; first += problem->dim) ComeOut(solver, first, x, out, y);
  for (PetscInt i = problem->n; i < solver->iterated; i++) y[i] = x[i];
  PetscCall(VecRestoreArray(Y, &y));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options of the solver are read here, in the set-up. It has the same vectors on each rank, and is one of one rank. */
PetscErrorCode FrictionIterationCreate(FrictionSolver solver)
{
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_SELF, &solver->ksp));
  PetscCall(KSPSetOptionsPrefix(solver->ksp, "friction_"));
  PetscCall(KSPSetType(solver->ksp, KSPGMRES));
  PetscCall(KSPGMRESSetRestart(solver->ksp, RESTART));
  PetscCall(KSPSetPCSide(solver->ksp, PC_RIGHT));
  PetscCall(KSPGetPC(solver->ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, solver));
  PetscCall(PCShellSetApply(pc, Precondition));
  PetscCall(PCShellSetName(pc, "about the inverse of the compliance"));
  PetscCall(KSPSetTolerances(solver->ksp, PETSC_CURRENT, PETSC_CURRENT, PETSC_CURRENT, MAX_ITERATIONS));
  PetscCall(KSPSetFromOptions(solver->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FreeRoom(FrictionSolver solver)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(solver->work[0], solver->work[1], solver->work[2], solver->chosen));
  PetscCall(VecDestroy(&solver->step));
  PetscCall(VecDestroy(&solver->residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionIterationDestroy(FrictionSolver solver)
{
  PetscFunctionBegin;
  PetscCall(FreeRoom(solver));
  PetscCall(KSPDestroy(&solver->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for as many rows as the solver has; beyond those of the problem vectors are zero */
static PetscErrorCode MakeRoom(FrictionSolver solver)
{
  const PetscInt n = solver->room;
  Mat            shell;

  PetscFunctionBegin;
  if (n <= solver->iterated) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FreeRoom(solver));
  solver->iterated = n;
  PetscCall(PetscMalloc4(n, &solver->work[0], n, &solver->work[1], n, &solver->work[2], n, &solver->chosen));
  PetscCall(KSPReset(solver->ksp));
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, solver, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatCreateVecs(shell, &solver->step, &solver->residual));
  PetscCall(KSPSetOperators(solver->ksp, shell, shell));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much the equations are missed at most, and what the largest force opens its own row by [m] */
static void Measure(FrictionSolver solver, PetscReal *missed, PetscReal *scale)
{
  const FrictionProblem *problem = solver->problem;

  *missed = *scale = 0;
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt first = i - i % problem->dim;

    *missed = PetscMax(*missed, PetscAbsScalar(solver->rhs[i]));
    *scale  = PetscMax(*scale, FrictionCompliance(problem, first, first) * PetscAbsScalar(problem->force[i]));
  }
}

/* One step of Newton's method, with equations that are solved until they are missed by `rtol` of what they are now or by `atol` */
static PetscErrorCode Step(FrictionSolver solver, PetscReal rtol, PetscReal atol)
{
  const FrictionProblem *problem = solver->problem;
  const PetscScalar     *step;
  PetscScalar           *rhs;
  PetscInt               iterations;

  PetscFunctionBegin;
  PetscCall(ChooseRows(solver));
  PetscCall(VecZeroEntries(solver->residual));
  PetscCall(VecGetArray(solver->residual, &rhs));
  PetscCall(PetscArraycpy(rhs, solver->rhs, problem->n));
  PetscCall(VecRestoreArray(solver->residual, &rhs));
  PetscCall(KSPSetTolerances(solver->ksp, rtol, atol, PETSC_CURRENT, PETSC_CURRENT));
  PetscCall(KSPSolve(solver->ksp, solver->residual, solver->step));
  PetscCall(KSPGetIterationNumber(solver->ksp, &iterations));
  solver->iterations += iterations;
  PetscCall(VecGetArrayRead(solver->step, &step));
  for (PetscInt i = 0; i < problem->n; i++) problem->force[i] += step[i];
  PetscCall(VecRestoreArrayRead(solver->step, &step));
  PetscCall(FrictionOpen(solver, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same as FrictionSolverSolve(), where S is no matrix */
PetscErrorCode FrictionIterate(FrictionSolver solver, const FrictionProblem *problem, PetscBool *solved, PetscBool *by_bounds)
{
  PetscBool changed = PETSC_TRUE;
  PetscReal last    = PETSC_MAX_REAL;

  PetscFunctionBegin;
  solver->problem = problem;
  PetscCall(MakeRoom(solver));
  PetscCall(FrictionOpen(solver, problem));
  PetscCall(PetscArrayzero(solver->trial, problem->n));
  (void)FrictionJudge(solver, problem, PETSC_FALSE);
  for (PetscInt step = 0; step <= NEWTON_MOST; step++) {
    PetscReal missed, scale, forcing;

    if (FrictionDropForces(solver, problem)) PetscCall(FrictionOpen(solver, problem));
    FrictionSetEquations(solver, problem);
    Measure(solver, &missed, &scale);
    PetscCall(PetscInfo(solver->ksp, "friction: step %" PetscInt_FMT ", states %s, equations missed by %g of %g m\n", step,
                        changed ? "change" : "stay", (double)missed, (double)scale));
    *solved = (PetscBool)(!changed &&
                          (missed <= NEWTON_RTOL * scale || (missed <= NEWTON_ROUND_OFF * scale && missed > NEWTON_FALLS * last)));
    if (*solved || step == NEWTON_MOST || PetscIsInfOrNanReal(missed)) break;
    if (step && step % NEWTON_FIRST == 0) {
      *by_bounds = PETSC_TRUE;
      PetscCall(FrictionSolveByBounds(solver, problem));
      changed = PETSC_TRUE;
      (void)FrictionJudge(solver, problem, PETSC_FALSE);
      continue;
    }
    /* in space what a step leaves goes with the square of what was missed before, in the plane it leaves nothing */
    forcing = problem->dim == 2 && !changed ? 0 : scale > 0 ? PetscMin(FORCING, missed / scale) : FORCING;
    PetscCall(Step(solver, forcing, LEAVES * NEWTON_RTOL * scale));
    last    = missed;
    changed = FrictionJudge(solver, problem, PETSC_FALSE);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
