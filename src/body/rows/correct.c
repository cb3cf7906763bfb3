/* Corrections of a state by impulses on the rows: at the end of a controller step, before it is accepted, or at its start. */
#include <body/layout/bodyimpl.h>

/* Part of the acceleration of rows that may be left, and iterations to get there at most: rows that depend on each other leave round-off */
#define LEFT_OVER      1e-14
#define MAX_ITERATIONS 1000

/* change = M_L^{-1} B^T impulse with the lumped mass M_L, zero on massless nodes */
static PetscErrorCode SolveLumpedMassOfRows(Body body, const PetscScalar impulse[], Vec change)
{
  PetscFunctionBegin;
  PetscCall(BodySpreadRows(body, body->rows.free_matrix, impulse, body->work.nodes[0]));
  PetscCall(VecCopy(body->mass.row_sum, change));
  PetscCall(VecReciprocal(change)); /* leaves zeros */
  PetscCall(VecPointwiseMult(change, change, body->work.nodes[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyAddImpulses - changes the state at one end of the controller step by impulses or forces on the rows

  Collective

  Input Parameters:
+ body    - the `Body`, with inertia: integrated, where its end changes, else saved
. side    - which end; the start of a step changes in the saved state too, and the body goes back to it
. lumped  - whether the mass is taken as lumped: the momentum changes as much, and no mass matrix is solved with
. parts   - by how much of M^{-1} B^T impulse displacement, velocity and acceleration change
- impulse - one for each row of this rank

  Level: developer

  Notes:
  Massless nodes stay as they are. The end is to be changed before `BodySave()`. Traces at the end of the step follow, those at its start do
  not, see `BodyWriteStartTraces()`.

  Forward-increment Lagrange multipliers (Carpenter, Taylor, Katona 1991) act on the start: they are known only after the step that they
  begin, and a force from half a step before to half a step after changes the velocity by dt / 2 of what it changes the acceleration by.

.seealso: `Body`, `BodyComputeInverseMass()`, `BodyClearAcceleration()`, `BodySave()`
@*/
PetscErrorCode BodyAddImpulses(Body body, BodyStepSide side, PetscBool lumped, const PetscReal parts[3], const PetscScalar impulse[])
{
  const Vec   change = body->work.nodes[2], vecs[] = {body->state.u, body->state.v, body->state.a};
  const Vec   saved[]  = {body->saved.u, body->saved.v, body->saved.a};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  if (side == BODY_AT_START) PetscCall(BodyRestore(body));
  PetscCall(lumped ? SolveLumpedMassOfRows(body, impulse, change) : BodySolveMassOfRows(body, impulse, change));
  for (PetscInt k = 0; k < 3; k++) {
    if (parts[k] == 0) continue;
    PetscCall(VecAXPY(vecs[k], parts[k], change));
    if (side == BODY_AT_START) PetscCall(VecCopy(vecs[k], saved[k]));
    else PetscCall(BodyWriteTrace(body, body->rows.matrix, vecs[k], traces[k], body->time.substeps));
  }
  body->repeats = PETSC_FALSE;
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

.seealso: `Body`, `BodyAddImpulses()`
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
  PetscCall(BodyWriteTrace(body, body->rows.matrix, body->state.a, body->traces.acceleration, body->time.substeps));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
