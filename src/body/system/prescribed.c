/* Degrees of freedom whose displacement the user prescribes: put in, zeroed, and taken out of matrices. */
#include <body/layout/bodyimpl.h>

/* Held dofs of any of u, v, a at time t */
PetscErrorCode BodyPrescribeHeld(Body body, PetscReal t, Vec u, Vec v, Vec a)
{
  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  if (body->unloaded) {
    if (u) PetscCall(BodyZeroHeld(body, u));
    if (v) PetscCall(BodyZeroHeld(body, v));
    if (a) PetscCall(BodyZeroHeld(body, a));
  } else PetscCall(BodyLoadsPrescribe(body, t, u, v, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyZeroHeld(Body body, Vec vec)
{
  PetscScalar *array;

  PetscFunctionBegin;
  if (!body->any_held) PetscFunctionReturn(PETSC_SUCCESS); /* on all ranks alike, see BodyLoadsPrescribe() */
  PetscCall(VecGetArray(vec, &array));
  for (PetscInt i = 0; i < body->n_held; i++) array[body->held_dofs[i]] = 0;
  PetscCall(VecRestoreArray(vec, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows and columns of held dofs become those of the identity */
PetscErrorCode BodyEliminateHeld(Body body, Mat A)
{
  PetscInt rstart, *rows;

  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  PetscCall(PetscMalloc1(body->n_held, &rows));
  for (PetscInt i = 0; i < body->n_held; i++) rows[i] = rstart + body->held_dofs[i];
  PetscCall(MatZeroRowsColumns(A, body->n_held, rows, 1, NULL, NULL));
  PetscCall(PetscFree(rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}
