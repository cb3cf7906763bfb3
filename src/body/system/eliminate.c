/* Degrees of freedom whose displacement the user prescribes (held dofs), taken out of vectors and matrices. */
#include <body/layout/bodyimpl.h>

PetscErrorCode BodyZeroHeld(Body body, Vec vec)
{
  PetscScalar *array;

  PetscFunctionBegin;
  if (!body->held.any) PetscFunctionReturn(PETSC_SUCCESS); /* on all ranks alike, see BodyLoadsPrescribe() */
  PetscCall(VecGetArray(vec, &array));
  for (PetscInt i = 0; i < body->held.n; i++) array[body->held.dofs[i]] = 0;
  PetscCall(VecRestoreArray(vec, &array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCopyHeld(Body body, Vec from, Vec to)
{
  const PetscScalar *source;
  PetscScalar       *target;

  PetscFunctionBegin;
  if (!body->held.any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(from, &source));
  PetscCall(VecGetArray(to, &target));
  for (PetscInt i = 0; i < body->held.n; i++) target[body->held.dofs[i]] = source[body->held.dofs[i]];
  PetscCall(VecRestoreArray(to, &target));
  PetscCall(VecRestoreArrayRead(from, &source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows and columns of held dofs become those of the identity */
PetscErrorCode BodyEliminateHeld(Body body, Mat A)
{
  PetscInt rstart, *rows;

  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  PetscCall(PetscMalloc1(body->held.n, &rows));
  for (PetscInt i = 0; i < body->held.n; i++) rows[i] = rstart + body->held.dofs[i];
  PetscCall(MatZeroRowsColumns(A, body->held.n, rows, 1, NULL, NULL));
  PetscCall(PetscFree(rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}
