/* The substeps of a controller step. */
#include <body/layout/bodyimpl.h>

/* Notes body, time and step where a substep failed or its solution has NaN or infinity in it. Both get into the velocity from
   wherever they arise. Its 2-norm is checked, since a sum over ranks keeps the NaN of one, which a maximum may lose. */
PetscErrorCode BodyCheckSubstep(Body body)
{
  TSConvergedReason reason;
  PetscReal         norm;

  PetscFunctionBegin;
  PetscCall(TSGetConvergedReason(body->time.ts, &reason));
  PetscCall(BodyGetNorm(body, body->state.v, &norm));
  if (body->integrator->ops.checksubstep) PetscCall((*body->integrator->ops.checksubstep)(body));
  if (PetscIsInfOrNanReal(norm)) PetscCall(BodyNoteInverted(body, BodyStepsAlone(body)));
  if (reason < 0 || PetscIsInfOrNanReal(norm))
    PetscCall(StepFailureSet(&body->failure, STEP_DIVERGED_NAN, PETSC_ERR_FP,
                             "The displacement of body '%s' is not a number at time %.9g s (its step %" PetscInt_FMT
                             "); is a time step too large, or a penalty too stiff for it?",
                             body->hdr.name, (double)body->state.time, body->state.step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Massless nodes have the mean velocity of the substep, and no acceleration. On all ranks, or PETSc would remember norms on some. */
PetscErrorCode BodyFinishLayer(Body body)
{
  const PetscScalar *u0, *u1;
  PetscScalar       *v1, *a1;

  PetscFunctionBegin;
  if (!body->layer.exists) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(body->substep_start.u, &u0));
  PetscCall(VecGetArrayRead(body->state.u, &u1));
  PetscCall(VecGetArray(body->state.v, &v1));
  PetscCall(VecGetArray(body->state.a, &a1));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++) {
    const PetscInt dof = body->layer.dofs[i];

    v1[dof] = (u1[dof] - u0[dof]) / body->time.step;
    a1[dof] = 0;
  }
  PetscCall(VecRestoreArray(body->state.a, &a1));
  PetscCall(VecRestoreArray(body->state.v, &v1));
  PetscCall(VecRestoreArrayRead(body->state.u, &u1));
  PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All substeps, by the TS; those after a failed one are left out, and the state is good for nothing then but to be restored */
PetscErrorCode BodyMakeSubsteps(Body body)
{
  PetscFunctionBegin;
  if (body->state.step != body->saved.step) PetscCall(BodyRestore(body));
  for (body->time.substep = 0; body->time.substep < body->time.substeps; body->time.substep++) {
    if (body->substep_start.u && body->time.substeps > 1) {
      PetscCall(VecCopy(body->state.u, body->substep_start.u));
      PetscCall(VecCopy(body->state.v, body->substep_start.v));
    }
    if (body->substep_start.damping) PetscCall(VecCopy(body->state.damping, body->substep_start.damping));
    if (body->rows.any_by_mean) PetscCall(BodyTurnToMeanForce(body));
    PetscCall(BodyHistoryBegin(body));
    if (body->integrator->ops.step) PetscCall((*body->integrator->ops.step)(body));
    else PetscCall(TSStep(body->time.ts));
    body->state.step++;
    body->state.time = body->saved.time + (body->time.substep + 1) * body->time.step;
    PetscCall(BodyCheckSubstep(body));
    if (BodyHasStopped(body)) break;
    if (body->rows.any_by_mean) PetscCall(BodyEndMeanForce(body));
    if (body->integrator->ops.finishsubstep) PetscCall((*body->integrator->ops.finishsubstep)(body));
    if (!body->state.incomplete) PetscCall(BodyEndHistory(body));
    PetscCall(BodyWriteTraces(body, body->time.substep + 1));
    if (body->time.substeps > 1) {
      PetscCall(BodyAddWork(body, body->substep_start.u));
      PetscCall(BodyAddDampingWork(body));
    }
  }
  body->time.stepped = PETSC_TRUE;
  body->statistics.substeps += body->time.substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
