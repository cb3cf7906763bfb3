/* The problem of a controller step with friction, from the rows of nodes that may touch and back to them. */
#include "frictionstep.h"

/* The rows that are marked, their compliance and the bounds that the law has for them */
static PetscErrorCode ListRows(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;
  PetscInt      n;
  PetscBool     dense;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorSetRows(step->S, step->marks, 1));
  InterfaceOperatorGetRows(step->S, &n, NULL, &dense);
  PetscCall(FrictionProblemResize(&step->problem, n, contact->rows.n_all, dense ? NULL : &step->products));
  for (PetscInt i = 0; i < contact->rows.n; i++) step->mine[i] = step->flexibility[i];
  PetscCall(InterfaceOperatorGather(step->S, step->mine, step->problem.opened));
  if (dense) {
    PetscCall(InterfaceOperatorAssemble(step->S, INTERFACE_GAP, step->problem.S));
    for (PetscInt i = 0; i < n; i++) step->problem.S[i * (n + 1)] += step->problem.opened[i];
  } else {
    PetscCall(FrictionFindDiagonal(contact));
    for (PetscInt i = 0; i < n; i++) step->problem.diagonal[i] += step->problem.opened[i];
  }
  for (PetscInt i = 0; i < contact->rows.n; i += contact->dim) {
    PetscReal limit[2];

    (*contact->friction.law.getlimit)(contact, contact->friction.law.data, i, contact->friction.speed[i], &limit[0], &limit[1]);
    for (PetscInt k = 0; k < contact->dim; k++) step->mine[i + k] = k < 2 ? limit[k] : 0;
  }
  PetscCall(InterfaceOperatorGather(step->S, step->mine, step->problem.limit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What rows open by at the end of the step as the bodies have made it: gaps along normals, slips across them */
PetscErrorCode FrictionGatherOpened(Contact contact, PetscScalar opened[])
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    step->mine[i] = i % contact->dim ? contact->friction.slip[i] : contact->end.gap[i] + FrictionGive(contact, i);
  PetscCall(InterfaceOperatorGather(step->S, step->mine, opened));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The problem of the rows that are listed now, from the bodies as they are under the forces `end` */
PetscErrorCode FrictionStartProblem(Contact contact)
{
  FrictionStep    *step    = (FrictionStep *)contact->data;
  FrictionProblem *problem = &step->problem;

  PetscFunctionBegin;
  PetscCall(ListRows(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) step->mine[i] = contact->end.force[i];
  PetscCall(InterfaceOperatorGather(step->S, step->mine, problem->base));
  PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
  PetscCall(FrictionGatherOpened(contact, problem->opened));
  for (PetscInt node = 0; node < problem->n / problem->dim; node++) problem->state[node] = FRICTION_OPEN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces that have been found, on this rank's rows */
PetscErrorCode FrictionTakeForces(Contact contact)
{
  FrictionStep          *step    = (FrictionStep *)contact->data;
  const FrictionProblem *problem = &step->problem;
  const PetscInt        *rows;

  PetscFunctionBegin;
  InterfaceOperatorGetRows(step->S, NULL, &rows, NULL);
  PetscCall(PetscArrayzero(contact->end.force, contact->rows.n));
  PetscCall(PetscArrayzero(contact->end.active, contact->rows.n));
  PetscCall(PetscArrayzero(contact->friction.slides, contact->rows.n));
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscInt mine = rows[i] - contact->rows.begin;

    if (mine < 0 || mine >= contact->rows.n) continue;
    contact->end.force[mine]       = PetscRealPart(problem->force[i]);
    contact->end.active[mine]      = (PetscBool)(problem->state[i / problem->dim] != FRICTION_OPEN);
    contact->friction.slides[mine] = (PetscBool)(problem->state[i / problem->dim] == FRICTION_SLIDES);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
