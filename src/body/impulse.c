/* Forces that act at the start of a step of an explicit body, as forward-increment Lagrange multipliers do. */
#include "bodyimpl.h"

/* work[2] = M^{-1} B^T force, zero on massless nodes; one force for each row of this rank */
PetscErrorCode BodySolveMassOfRows(Body body, const PetscScalar force[])
{
  PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(body->row_vec[0], &row));
  PetscCall(PetscArraycpy(row, force, body->rows.local));
  PetscCall(VecRestoreArrayWrite(body->row_vec[0], &row));
  PetscCall(MatMultTranspose(body->interface, body->row_vec[0], body->work[0]));
  PetscCall(BodyZeroHeld(body, body->work[0]));
  PetscCall(BodySolveMass(body, body->work[0], 0, PETSC_FALSE, body->work[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComputeInverseMass - velocity of the rows after unit impulses on them

  Collective

  Input Parameter:
. body - the `Body`, set up, without prescribed rows

  Output Parameter:
. matrix - B M^{-1} B^T [1/kg], all rows by all rows, by columns, on every rank; zero for massless nodes; free it with
           `PetscFree()`

  Level: developer

.seealso: `Body`, `BodyAddVelocity()`, `BodyComputeForwardCompliance()`
@*/
PetscErrorCode BodyComputeInverseMass(Body body, PetscScalar *matrix[])
{
  BodyRows          *rows = &body->rows;
  const PetscScalar *row;
  PetscScalar       *inverse, *unit;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(PetscCalloc1(rows->global * rows->global, &inverse));
  PetscCall(PetscCalloc1(rows->local, &unit));
  for (PetscInt j = 0; j < rows->global; j++) {
    const PetscInt local = j - rows->begin;

    if (local >= 0 && local < rows->local) unit[local] = 1;
    PetscCall(BodySolveMassOfRows(body, unit));
    if (local >= 0 && local < rows->local) unit[local] = 0;
    PetscCall(MatMult(body->interface, body->work[2], body->row_vec[0]));
    PetscCall(VecGetArrayRead(body->row_vec[0], &row));
    PetscCall(PetscArraycpy(inverse + j * rows->global + rows->begin, row, rows->local));
    PetscCall(VecRestoreArrayRead(body->row_vec[0], &row));
  }
  PetscCall(PetscFree(unit));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, inverse, (PetscMPIInt)(rows->global * rows->global), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *matrix = inverse;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscFunctionBegin;
  PetscCall(BodyComputeInverseMass(body, matrix));
  for (PetscInt i = 0; i < PetscSqr(body->rows.global); i++) (*matrix)[i] *= PetscSqr(body->time_step);
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
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyRestore(body));
  PetscCall(BodySolveMassOfRows(body, force));
  PetscCall(VecAXPY(body->state.a, 1, body->work[2]));
  PetscCall(VecAXPY(body->state.v, 0.5 * body->time_step, body->work[2]));
  PetscCall(VecCopy(body->state.v, body->saved.v));
  PetscCall(VecCopy(body->state.a, body->saved.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}
