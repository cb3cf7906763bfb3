/* What unit forces on nodes of a body bring about in a controller step from rest, without loads; afterwards it is as it was. */
#include <body/layout/bodyimpl.h>

/* The substeps of a controller step under a force of 1 N, from the saved state, whose displacements become a column */
static PetscErrorCode ProbeColumn(Body body, PetscInt dof, Compliance matrices)
{
  const PetscScalar *u;

  PetscFunctionBegin;
  PetscCall(ComplianceSetUnit(body->rows.nodal_force, dof));
  if (body->rows.nodal_shape == BODY_FORCE_CONSTANT) { /* the step starts from it too */
    PetscCall(VecCopy(body->rows.nodal_force, body->work.nodes[0]));
    PetscCall(BodyAnswerAtStart(body, body->saved.a));
  }
  PetscCall(BodyRestore(body));
  StepFailureClear(&body->failure);
  PetscCall(BodyMakeSubsteps(body));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)body), &body->failure));
  body->statistics.substeps -= body->time.substeps;
  PetscCall(VecGetArrayRead(body->state.u, &u));
  PetscCall(ComplianceSetColumn(matrices, dof, u));
  PetscCall(VecRestoreArrayRead(body->state.u, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyProbeNodes - columns of displacements, by their global numbers, at the end of a controller step from rest with all rows free */
PetscErrorCode BodyProbeNodes(Body body, BodyForceShape shape, PetscInt n, const PetscInt dofs[], Compliance matrices)
{
  BodyState      state = {0}, saved = {0};
  BodyCondition *kept;
  Vec            force;

  PetscFunctionBegin;
  PetscCall(BodyStateCreate(body, PETSC_TRUE, &state));
  PetscCall(BodyStateCreate(body, PETSC_FALSE, &saved));
  PetscCall(BodyStateCopy(body, &body->state, &state));
  PetscCall(BodyStateCopy(body, &body->saved, &saved));
  PetscCall(VecZeroEntries(body->saved.u));
  PetscCall(VecZeroEntries(body->saved.v));
  PetscCall(VecZeroEntries(body->saved.a));
  body->saved.force_known = PETSC_FALSE;
  PetscCall(PetscMalloc1(body->rows.local, &kept));
  PetscCall(PetscArraycpy(kept, body->rows.conditions, body->rows.local));
  PetscCall(BodyFreeRows(body));
  body->rows.n_forced = 1;
  PetscCall(BodyPrepareLinearized(body));
  PetscCall(BodyCreateVec(body, &force));
  body->unloaded         = PETSC_TRUE;
  body->model.linearized = (PetscBool)!body->model.linear;
  body->rows.nodal_force = force;
  body->rows.nodal_shape = shape;
  for (PetscInt i = 0; i < n; i++)
    if (!ComplianceKnows(matrices, dofs[i])) PetscCall(ProbeColumn(body, dofs[i], matrices));
  body->rows.nodal_force = NULL;
  body->model.linearized = PETSC_FALSE;
  body->unloaded         = PETSC_FALSE;
  PetscCall(BodyStateCopy(body, &state, &body->state));
  PetscCall(BodyStateCopy(body, &saved, &body->saved));
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  body->rows.n_forced = 0;
  PetscCall(BodySetConditions(body, kept));
  PetscCall(PetscFree(kept));
  PetscCall(VecDestroy(&force));
  PetscCall(BodyStateDestroy(&state));
  PetscCall(BodyStateDestroy(&saved));
  PetscFunctionReturn(PETSC_SUCCESS);
}
