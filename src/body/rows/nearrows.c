/* Rows near contact. Callers who know which rows may have a force say so, and a step costs what these cost, not what all contact nodes do:
   of a sheet that falls these are all of its nodes, though a corner touches. Output traces of other rows are old. */
#include <body/layout/bodyimpl.h>

/* Whether near rows of all ranks have forces that are all zero, as far as one rank knows */
PetscBool BodyNearRowsAreZero(Body body, const PetscScalar values[])
{
  const BodyRows *rows = &body->rows;
  PetscBool       zero = (PetscBool)(rows->size == 1);

  for (PetscInt k = 0; k < rows->near.n && zero; k++) zero = (PetscBool)(values[rows->near.numbers[k]] == 0);
  return zero;
}

/* f += B^T values, of near rows */
PetscErrorCode BodyAddNearRows(Body body, const PetscScalar values[], Vec f)
{
  const RowList *near = &body->rows.near;
  PetscScalar   *row;

  PetscFunctionBegin;
  if (BodyNearRowsAreZero(body, values)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(near->values, &row));
  for (PetscInt k = 0; k < near->n; k++) row[k] = values[near->numbers[k]];
  PetscCall(VecRestoreArrayWrite(near->values, &row));
  PetscCall(MatMultTransposeAdd(near->matrix, near->values, f, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyComputeForceChange - how much more constant forces on the rows are at the start of a step than those that the last one ended with, on
   the nodes; `any`: whether the substep that has been made last is the first one of such a step */
PetscErrorCode BodyComputeForceChange(Body body, PetscBool *any, Vec change)
{
  PetscFunctionBegin;
  *any = (PetscBool)(body->rows.constant && body->state.step - body->saved.step == 1);
  if (!*any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(change));
  PetscCall(BodyAddNearRows(body, body->rows.excess, change));
  PetscFunctionReturn(PETSC_SUCCESS);
}
