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
  PetscCall(BodyInvalidateWindow(body));
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
  PetscCall(BodyInvalidateWindow(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
