/* Corrections of a state by impulses on the rows: at the end of a controller step, before it is accepted, or at its start. */
#include <body/layout/bodyimpl.h>

/* Part of the acceleration of rows that may be left, and iterations to get there at most: rows that depend on each other leave round-off */
#define LEFT_OVER      1e-14
#define MAX_ITERATIONS 1000

/* The rows of a corrected vector, at the end of the controller step */
static PetscErrorCode WriteEnd(Body body, Vec vec, Trace trace)
{
  PetscFunctionBegin;
  PetscCall(BodyWriteTrace(body, body->rows.matrix, vec, trace, body->time.substeps));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddVelocity - changes the velocity at the end of the controller step by impulses on the rows

  Collective

  Input Parameters:
+ body    - the `Body`, integrated
- impulse - one for each row of this rank [N s]

  Level: developer

  Note:
  v += M^{-1} B^T impulse; massless nodes keep their velocity. To be called before `BodySave()`.

.seealso: `Body`, `BodyComputeInverseMass()`, `BodyAddAcceleration()`
@*/
PetscErrorCode BodyAddVelocity(Body body, const PetscScalar impulse[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodySolveMassOfRows(body, impulse, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.v, 1, body->work.nodes[2]));
  PetscCall(WriteEnd(body, body->state.v, body->traces.velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddAcceleration - changes the acceleration at the end of the controller step by that of forces on the rows

  Collective

  Input Parameters:
+ body  - the `Body`, integrated
- force - one for each row of this rank [N]

  Level: developer

  Note:
  a += M^{-1} B^T force; massless nodes keep none. To be called before `BodySave()`.

.seealso: `Body`, `BodyAddVelocity()`, `BodyClearAcceleration()`
@*/
PetscErrorCode BodyAddAcceleration(Body body, const PetscScalar force[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodySolveMassOfRows(body, force, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.a, 1, body->work.nodes[2]));
  PetscCall(WriteEnd(body, body->state.a, body->traces.acceleration));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyChangeStart - changes velocity and acceleration at the start of the simulation by impulses and forces on the rows

  Collective

  Input Parameters:
+ body    - the `Body`, before its first step
. impulse - one for each row of this rank [N s]
- force   - one for each row of this rank [N]

  Level: developer

  Note:
  v += M^{-1} B^T impulse and a += M^{-1} B^T force. The saved state and the traces at the start change with it; the forces are the
  reactions there.

.seealso: `Body`, `BodySetInitialState()`, `BodyMultiplyInverseMass()`
@*/
PetscErrorCode BodyChangeStart(Body body, const PetscScalar impulse[], const PetscScalar force[])
{
  PetscScalar *reaction;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup && !body->state.step, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE,
             "Call after BodySetUp(), before the first step");
  PetscCall(BodySolveMassOfRows(body, impulse, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.v, 1, body->work.nodes[2]));
  PetscCall(BodySolveMassOfRows(body, force, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.a, 1, body->work.nodes[2]));
  PetscCall(BodyWriteTraces(body, 0));
  if (body->rows.global) {
    PetscCall(TraceGetLevel(body->traces.reaction, 0, &reaction));
    PetscCall(PetscArraycpy(reaction, force, body->rows.local));
  }
  PetscCall(BodySave(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* vec += M_L^{-1} B^T force with the lumped mass M_L, zero on massless nodes */
static PetscErrorCode AddLumped(Body body, const PetscScalar force[], Vec vec)
{
  const PetscInt     n = body->mesh.owned_nodes * body->mesh.dim;
  const PetscScalar *mass, *applied;
  PetscScalar       *row, *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(body->work.rows[0], &row));
  PetscCall(PetscArraycpy(row, force, body->rows.local));
  PetscCall(VecRestoreArrayWrite(body->work.rows[0], &row));
  PetscCall(MatMultTranspose(body->rows.free_matrix, body->work.rows[0], body->work.nodes[0]));
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  PetscCall(VecGetArrayRead(body->work.nodes[0], &applied));
  PetscCall(VecGetArray(vec, &values));
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(mass[i]) > 0) values[i] += applied[i] / mass[i];
  PetscCall(VecRestoreArray(vec, &values));
  PetscCall(VecRestoreArrayRead(body->work.nodes[0], &applied));
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddLumpedVelocity - changes the velocity at the end of the controller step by impulses on the rows, as if the mass were lumped

  Collective

  Input Parameters:
+ body    - the `Body`, integrated
- impulse - one for each row of this rank [N s]

  Level: developer

  Note:
  v += M_L^{-1} B^T impulse; the momentum changes by the sum of the impulses, as under `BodyAddVelocity()`, and no mass matrix is solved
  with. To be called before `BodySave()`.

.seealso: `Body`, `BodyComputeInverseLumpedMass()`, `BodyAddLumpedAcceleration()`
@*/
PetscErrorCode BodyAddLumpedVelocity(Body body, const PetscScalar impulse[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddLumped(body, impulse, body->state.v));
  PetscCall(WriteEnd(body, body->state.v, body->traces.velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddLumpedAcceleration - changes the acceleration at the end of the controller step by forces on the rows, as if the mass were lumped

  Collective

  Input Parameters:
+ body  - the `Body`, integrated
- force - one for each row of this rank [N]

  Level: developer

  Note:
  a += M_L^{-1} B^T force. To be called before `BodySave()`.

.seealso: `Body`, `BodyComputeInverseLumpedMass()`, `BodyAddLumpedVelocity()`
@*/
PetscErrorCode BodyAddLumpedAcceleration(Body body, const PetscScalar force[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddLumped(body, force, body->state.a));
  PetscCall(WriteEnd(body, body->state.a, body->traces.acceleration));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B x on some rows, zero on the others */
static PetscErrorCode MultiplyMarked(Body body, const PetscBool marked[], Vec x, Vec y)
{
  PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(body->rows.matrix, x, y));
  PetscCall(VecGetArray(y, &row));
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (!marked[i]) row[i] = 0;
  PetscCall(VecRestoreArray(y, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyClearAcceleration - takes some rows out of the acceleration at the end of the controller step

  Collective

  Input Parameters:
+ body - the `Body`, integrated
- rows - for each row of this rank, whether its acceleration becomes zero

  Level: developer

  Note:
  a -= B^T (B B^T)^{-1} B a on these rows, the nearest that has none of them: by conjugate gradients, in one iteration if they are
orthonormal. To be called before `BodySave()`.

.seealso: `Body`, `BodyAddAcceleration()`
@*/
PetscErrorCode BodyClearAcceleration(Body body, const PetscBool rows[])
{
  Vec         residual = body->work.rows[0], direction = body->work.rows[1], product = body->work.rows[2], change = body->work.nodes[2];
  PetscScalar square, first, last, curvature;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(MultiplyMarked(body, rows, body->state.a, residual));
  PetscCall(VecCopy(residual, direction));
  PetscCall(VecDot(residual, residual, &first));
  square = first;
  for (PetscInt k = 0; k < MAX_ITERATIONS && PetscRealPart(square) > PetscSqr(LEFT_OVER) * PetscRealPart(first); k++) {
    PetscCall(MatMultTranspose(body->rows.matrix, direction, change));
    PetscCall(MultiplyMarked(body, rows, change, product));
    PetscCall(VecDot(direction, product, &curvature));
    PetscCall(VecAXPY(body->state.a, -square / curvature, change));
    PetscCall(VecAXPY(residual, -square / curvature, product));
    last = square;
    PetscCall(VecDot(residual, residual, &square));
    PetscCall(VecAYPX(direction, square / last, residual));
  }
  PetscCall(WriteEnd(body, body->state.a, body->traces.acceleration));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyShiftStart - moves the state at the start of the controller step, at unchanged velocity

  Collective

  Input Parameters:
+ body  - the `Body`, saved
- shift - one for each row of this rank [kg m]

  Level: developer

  Note:
  u += M^{-1} B^T shift, a projection in the norm of the mass if the shift comes from `BodyComputeInverseMass()`. The saved state
  is changed too.

.seealso: `Body`, `BodyComputeInverseMass()`
@*/
PetscErrorCode BodyShiftStart(Body body, const PetscScalar shift[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(BodyRestore(body));
  PetscCall(BodySolveMassOfRows(body, shift, body->work.nodes[2]));
  PetscCall(VecAXPY(body->state.u, 1, body->work.nodes[2]));
  PetscCall(VecCopy(body->state.u, body->saved.u));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
