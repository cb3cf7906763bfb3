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

/* Changes displacement, velocity and acceleration at one end of the controller step by `parts` of M^{-1} B^T impulse, or by the lumped
   mass, which keeps the momentum too. Massless nodes stay. A changed start is saved, and the body goes back to it; a changed end needs a
   later BodySave(). Traces at the end follow, those at the start do not, see BodyWriteStartTraces(). Forward-increment Lagrange
   multipliers (Carpenter, Taylor, Katona 1991) act on the start: they are found after the step that they begin. Collective. */
PetscErrorCode BodyAddImpulses(Body body, BodyStepSide side, PetscBool lumped, const PetscReal parts[3], const PetscScalar impulse[])
{
  const Vec   change = body->work.nodes[2], vecs[] = {body->state.u, body->state.v, body->state.a};
  const Vec   saved[]  = {body->saved.u, body->saved.v, body->saved.a};
  const Trace traces[] = {body->traces.displacement, body->traces.velocity, body->traces.acceleration};

  PetscFunctionBegin;
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
  if (parts[0] != 0) body->state.force_known = body->saved.force_known = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B x on some rows, zero on the others */
static PetscErrorCode MultiplyMarked(Body body, const PetscBool marked[], Vec x, Vec y)
{
  PetscScalar *row;

  PetscFunctionBegin;
  PetscCall(MatMult(body->rows.free_matrix, x, y));
  PetscCall(VecGetArray(y, &row));
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (!marked[i]) row[i] = 0;
  PetscCall(VecRestoreArray(y, &row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a -= B^T (B B^T)^{-1} B a on some rows at the end of the controller step, by conjugate gradients, in one iteration if rows are
   orthonormal. Before BodySave(). Collective. */
PetscErrorCode BodyClearAcceleration(Body body, const PetscBool rows[])
{
  Vec         residual = body->work.rows[0], direction = body->work.rows[1], product = body->work.rows[2], change = body->work.nodes[2];
  PetscScalar square, first, last, curvature;

  PetscFunctionBegin;
  PetscCall(MultiplyMarked(body, rows, body->state.a, residual));
  PetscCall(VecCopy(residual, direction));
  PetscCall(VecDot(residual, residual, &first));
  square = first;
  for (PetscInt k = 0; k < MAX_ITERATIONS && PetscRealPart(square) > PetscSqr(LEFT_OVER) * PetscRealPart(first); k++) {
    PetscCall(MatMultTranspose(body->rows.free_matrix, direction, change));
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
