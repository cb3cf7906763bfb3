/* Vectors of rows: each rank has a number for each row that it owns; a scatter brings them to all ranks, which all solve the law. */
#include "stepimpl.h"

PetscErrorCode ContactStepperCreateVecs(Contact contact, ContactStepper *stepper)
{
  const PetscInt n_all = PetscMax(contact->rows.n_all, 1);

  PetscFunctionBegin;
  PetscCall(VecCreateMPI(PetscObjectComm((PetscObject)contact), contact->rows.n, PETSC_DETERMINE, &stepper->x));
  PetscCall(VecDuplicate(stepper->x, &stepper->f));
  PetscCall(VecDuplicate(stepper->x, &stepper->field));
  PetscCall(VecScatterCreateToAll(stepper->x, &stepper->to_all, &stepper->of_all));
  PetscCall(PetscMalloc4(n_all, &stepper->rows, n_all, &stepper->places, n_all, &stepper->gathered, n_all, &stepper->of_assembled));
  PetscCall(PetscMalloc1(2 * n_all, &stepper->told));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperDestroyVecs(ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(VecDestroy(&stepper->x));
  PetscCall(VecDestroy(&stepper->f));
  PetscCall(VecDestroy(&stepper->field));
  PetscCall(VecDestroy(&stepper->of_all));
  PetscCall(VecScatterDestroy(&stepper->to_all));
  PetscCall(PetscFree4(stepper->rows, stepper->places, stepper->gathered, stepper->of_assembled));
  PetscCall(PetscFree(stepper->told));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of all rows, from those of this rank */
static PetscErrorCode Scatter(Contact contact, ContactStepper *stepper, const PetscReal mine[])
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(stepper->field, &values));
  for (PetscInt i = 0; i < contact->rows.n; i++) values[i] = mine[i];
  PetscCall(VecRestoreArrayWrite(stepper->field, &values));
  PetscCall(VecScatterBegin(stepper->to_all, stepper->field, stepper->of_all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(stepper->to_all, stepper->field, stepper->of_all, INSERT_VALUES, SCATTER_FORWARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of the touching rows of all ranks, from those of this rank's rows */
PetscErrorCode ContactStepperGather(Contact contact, ContactStepper *stepper, const PetscReal mine[], PetscScalar all[])
{
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(Scatter(contact, stepper, mine));
  PetscCall(VecGetArrayRead(stepper->of_all, &values));
  for (PetscInt k = 0; k < stepper->problem.n; k++) all[k] = values[stepper->rows[k]];
  PetscCall(VecRestoreArrayRead(stepper->of_all, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the touching rows of all ranks, by their numbers, and the nodes that have them */
PetscErrorCode ContactStepperListRows(Contact contact, ContactStepper *stepper)
{
  LawProblem        *problem = &stepper->problem;
  const PetscScalar *touches;
  PetscInt           n = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    stepper->mine[i] = stepper->touches[i] ? 1 + contact->rows.tied[ContactFirstRow(contact, i)] : 0; /* which law it has */
  PetscCall(Scatter(contact, stepper, stepper->mine));
  PetscCall(VecGetArrayRead(stepper->of_all, &touches));
  for (PetscInt i = 0; i < contact->rows.n_all; i++) n += touches[i] != 0;
  PetscCall(LawProblemResize(problem, n));
  n = problem->n_nodes = 0;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[i]];

    if (touches[i] == 0) continue;
    /* the rows of a node follow each other, and touch all together */
    if (!problem->n_nodes || n - problem->begin[problem->n_nodes - 1] == pair->components ||
        contact->ranks.row_pair[i] != contact->ranks.row_pair[stepper->rows[n - 1]]) {
      problem->law[problem->n_nodes]     = &stepper->laws[2 * contact->ranks.row_pair[i] + (touches[i] > 1)];
      problem->begin[problem->n_nodes++] = n;
    }
    stepper->rows[n++] = i;
  }
  problem->begin[problem->n_nodes] = n;
  PetscCall(VecRestoreArrayRead(stepper->of_all, &touches));
  PetscFunctionReturn(PETSC_SUCCESS);
}
