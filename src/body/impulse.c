/* Forces that act at the start of a step of an explicit body, as forward-increment Lagrange multipliers do. */
#include "bodyimpl.h"

/*@
  BodyComputeForwardCompliance - displacement of the rows after one substep for unit forces at its start

  Collective

  Input Parameter:
. body - an explicit `Body` without massless nodes

  Output Parameter:
. matrix - dt^2 B M^{-1} B^T [m/N], all rows by all rows, on every rank; free it with `PetscFree()`

  Level: developer

  Note:
  Carpenter, Taylor, Katona 1991, the matrix of the forward-increment Lagrange multipliers.

.seealso: `Body`, `BodyAddImpulse()`
@*/
PetscErrorCode BodyComputeForwardCompliance(Body body, PetscScalar *matrix[])
{
  BodyRows          *rows = &body->rows;
  const PetscScalar *row;
  PetscScalar       *compliance;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(PetscCalloc1(rows->global * rows->global, &compliance));
  for (PetscInt j = 0; j < rows->global; j++) {
    const PetscInt local = j - rows->begin;

    PetscCall(VecZeroEntries(body->row_vec[0]));
    if (local >= 0 && local < rows->local) PetscCall(VecSetValue(body->row_vec[0], j, 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(body->row_vec[0]));
    PetscCall(VecAssemblyEnd(body->row_vec[0]));
    PetscCall(MatMultTranspose(body->interface, body->row_vec[0], body->work[0]));
    PetscCall(BodySolveMass(body, body->work[0], 0, PETSC_FALSE, body->work[2]));
    PetscCall(MatMult(body->interface, body->work[2], body->row_vec[0]));
    PetscCall(VecGetArrayRead(body->row_vec[0], &row));
    for (PetscInt i = 0; i < rows->local; i++) compliance[j * rows->global + rows->begin + i] = PetscSqr(body->time_step) * row[i];
    PetscCall(VecRestoreArrayRead(body->row_vec[0], &row));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, compliance, (PetscMPIInt)(rows->global * rows->global), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *matrix = compliance;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddImpulse - changes velocity and acceleration at the start of the controller step by those of a force that acts on the
  rows from half a step before to half a step after it

  Collective

  Input Parameters:
+ body  - an explicit `Body` at its saved state, with one substep to a controller step
- force - one for each row of this rank [N]

  Level: developer

  Note:
  The saved state is changed too: the forces of the forward-increment Lagrange multiplier are known only after the step that
  they begin (Carpenter, Taylor, Katona 1991).

.seealso: `Body`, `BodyComputeForwardCompliance()`
@*/
PetscErrorCode BodyAddImpulse(Body body, const PetscScalar force[])
{
  PetscScalar *row;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyRestore(body));
  PetscCall(VecGetArrayWrite(body->row_vec[0], &row));
  PetscCall(PetscArraycpy(row, force, body->rows.local));
  PetscCall(VecRestoreArrayWrite(body->row_vec[0], &row));
  PetscCall(MatMultTranspose(body->interface, body->row_vec[0], body->work[0]));
  PetscCall(BodySolveMass(body, body->work[0], 0, PETSC_FALSE, body->work[2]));
  PetscCall(VecAXPY(body->state.a, 1, body->work[2]));
  PetscCall(VecAXPY(body->state.v, 0.5 * body->time_step, body->work[2]));
  PetscCall(VecCopy(body->state.v, body->saved.v));
  PetscCall(VecCopy(body->state.a, body->saved.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}
