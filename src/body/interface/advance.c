/* Integration over one controller step. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

/* Where the solver of a massless contact layer did not converge the step has failed; that of an implicit body is asked by its integrator */
static PetscErrorCode CheckSolver(Body body)
{
  KSPConvergedReason reason;

  PetscFunctionBegin;
  if (!body->solver) PetscFunctionReturn(PETSC_SUCCESS);
  reason = ConstrainedSolverTakeFailure(body->solver);
  if (reason < 0)
    PetscCall(
        StepFailureSet(&body->failure, STEP_DIVERGED_LAYER, PETSC_ERR_NOT_CONVERGED,
                       "Body '%s': the linear solver of its contact layer did not converge in the step that begins at time %.9g s: %s",
                       body->hdr.name, (double)body->saved.time, KSPConvergedReasons[reason]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The substeps that another rank makes: time and step as they are there */
static void CountSubsteps(Body body)
{
  body->time.substep     = body->time.substeps;
  body->state.step       = body->saved.step + body->time.substeps;
  body->state.time       = body->saved.time + body->time.substeps * body->time.step;
  body->state.incomplete = PETSC_FALSE;
  body->statistics.substeps += body->time.substeps;
}

/* Makes the displacements of the step, without an error where it fails: for sweeps. Output traces hold all but the acceleration. An
   explicit body whose rows are on massless nodes leaves forces of elements, acceleration and velocity to BodyCompleteStep(), since no sweep
   changes them otherwise. `reason` (or NULL) is the same on every rank but of a local body, see BodyGetStepProperties(). Collective. */
PetscErrorCode BodyTryIntegrateRows(Body body, StepConvergedReason *reason)
{
  PetscBool      done = PETSC_FALSE;
  PetscLogDouble begin, end;

  PetscFunctionBegin;
  StepFailureClear(&body->failure);
  if (reason) *reason = STEP_CONVERGED;
  if (BodyIsElsewhere(body)) {
    CountSubsteps(body);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscLogEventBegin(BODY_Integrate, body, 0, 0, 0));
  PetscCall(PetscTime(&begin));
  PetscCall(BodyCheckStableStep(body));
  if (!BodyHasStopped(body)) PetscCall(BodyRepeat(body, &done));
  if (!BodyHasStopped(body) && !done) PetscCall(BodyMakeSubsteps(body));
  PetscCall(CheckSolver(body));
  if (!done && !BodyHasStopped(body)) PetscCall(BodyNoteInputs(body));
  PetscCall(PetscTime(&end));
  body->statistics.seconds += end - begin;
  PetscCall(PetscLogEventEnd(BODY_Integrate, body, 0, 0, 0));
  if (reason) *reason = body->failure.reason;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Completes the state after BodyTryIntegrateRows(); a complete state stays as it is. `reason` (or NULL) as there. Collective. */
PetscErrorCode BodyCompleteStep(Body body, StepConvergedReason *reason)
{
  PetscLogDouble begin, end;

  PetscFunctionBegin;
  if (BodyIsElsewhere(body)) body->state.incomplete = PETSC_FALSE;
  if (body->state.incomplete && !BodyHasStopped(body)) {
    PetscCall(PetscLogEventBegin(BODY_Integrate, body, 0, 0, 0));
    PetscCall(PetscTime(&begin));
    PetscCall((*body->integrator->ops.complete)(body));
    body->state.incomplete = PETSC_FALSE;
    PetscCall(BodyEndHistory(body));
    PetscCall(BodyCheckSubstep(body));
    /* rows of massless nodes are where they were, and all that they do but for reactions and what is held is known */
    if (body->held.any || body->rows.constant || body->rows.n_prescribed || body->rows.n_robin) PetscCall(BodyWriteRest(body));
    PetscCall(PetscTime(&end));
    body->statistics.seconds += end - begin;
    PetscCall(PetscLogEventEnd(BODY_Integrate, body, 0, 0, 0));
  }
  if (reason) *reason = body->failure.reason;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyIntegrate() for those who can do something about a step that fails; `reason` is the same on every rank, or NULL */
PetscErrorCode BodyTryIntegrate(Body body, StepConvergedReason *reason)
{
  PetscFunctionBegin;
  PetscCall(BodyTryIntegrateRows(body, NULL));
  PetscCall(BodyCompleteStep(body, NULL));
  if (body->local)
    PetscCallMPI(MPI_Bcast(&body->failure, sizeof(body->failure), MPI_BYTE, body->mesh.owner, PetscObjectComm((PetscObject)body)));
  if (reason) *reason = body->failure.reason;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Integrates from the saved state to the end of the controller step, any number of times. A step that fails is an error. A linear body
   with one substep adds what changed input traces bring about to the last result, which is the same up to round-off. Collective. */
PetscErrorCode BodyIntegrate(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyTryIntegrate(body, NULL));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)body), &body->failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Squares of u - previous and of x + u, summed: four sums each, since a single one waits for every addition */
SIMD_CLONES static void SumSquares(PetscInt n, const PetscScalar u[], const PetscScalar previous[], const PetscScalar x[],
                                   PetscReal sums[2])
{
  const PetscInt whole     = n - n % 4;
  PetscReal      change[4] = {0}, position[4] = {0};

  for (PetscInt i = 0; i < whole; i += 4)
    for (PetscInt k = 0; k < 4; k++) {
      change[k] += PetscSqr(u[i + k] - previous[i + k]);
      position[k] += PetscSqr(x[i + k] + u[i + k]);
    }
  for (PetscInt i = whole; i < n; i++) {
    change[i - whole] += PetscSqr(u[i] - previous[i]);
    position[i - whole] += PetscSqr(x[i] + u[i]);
  }
  sums[0] = sums[1] = 0;
  for (PetscInt k = 0; k < 4; k++) {
    sums[0] += change[k];
    sums[1] += position[k];
  }
}

/* 2-norms of the change of all nodal positions since the last call in this controller step (infinity in the first) and of the positions
   [m]: the convergence criterion of Hoy, Tezaur, Mota, section 4.4. Collective. */
PetscErrorCode BodyGetPositionChange(Body body, PetscReal *change, PetscReal *position)
{
  const PetscInt     n = body->mesh.owned_nodes * body->mesh.dim;
  const PetscScalar *u, *x;
  PetscScalar       *previous;
  PetscReal          sums[2];

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->state.u, &u));
  PetscCall(VecGetArrayRead(body->mesh.positions, &x));
  PetscCall(VecGetArray(body->iterate.u, &previous));
  SumSquares(n, u, previous, x, sums);
  PetscCall(PetscArraycpy(previous, u, n));
  PetscCall(VecRestoreArray(body->iterate.u, &previous));
  PetscCall(VecRestoreArrayRead(body->mesh.positions, &x));
  PetscCall(VecRestoreArrayRead(body->state.u, &u));
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *change             = body->iterate.known ? PetscSqrtReal(sums[0]) : PETSC_INFINITY;
  *position           = PetscSqrtReal(sums[1]);
  body->iterate.known = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetTotalSubsteps - how many substeps the body has made in all sweeps, and in what time

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameters:
+ substeps - substeps integrated, repeated ones counted each time
- seconds  - wall time of `BodyIntegrate()` [s]

  Level: intermediate

.seealso: `Body`, `BodyIntegrate()`
@*/
PetscErrorCode BodyGetTotalSubsteps(Body body, PetscInt64 *substeps, PetscLogDouble *seconds)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  if (substeps) *substeps = body->statistics.substeps;
  if (seconds) *seconds = body->statistics.seconds;
  PetscFunctionReturn(PETSC_SUCCESS);
}
