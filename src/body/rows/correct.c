/* Corrections of a state by impulses on the rows: at the end of a controller step, before it is accepted, or at its start. */
#include <body/layout/bodyimpl.h>

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
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a -= B^T (B B^T)^{-1} B a at the end of the controller step, on rows prescribed under these conditions. Before BodySave(). Collective. */
PetscErrorCode BodyClearAcceleration(Body body, BodyCondition conditions[])
{
  BodyRows            *rows         = &body->rows;
  BodyCondition *const own          = rows->conditions;
  const PetscInt       n_prescribed = rows->n_prescribed;

  PetscFunctionBegin;
  rows->conditions   = conditions;
  rows->n_prescribed = 1;
  PetscCall(BodyUpdateGram(body));
  PetscCall(BodyPrescribe(body, NULL, 0, body->state.a));
  rows->conditions   = own;
  rows->n_prescribed = n_prescribed;
  PetscCall(BodyUpdateGram(body));
  PetscCall(BodyWriteTrace(body, rows->matrix, body->state.a, body->traces.acceleration, body->time.substeps));
  body->repeats = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
