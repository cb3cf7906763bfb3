/* Controller steps that are cut in halves. At level k the controller step is that of the set-up over 2^k, and so is each substep, whose
   number stays. A body keeps what depends on the step, effective matrix with factors and compliance of nodes, for each level apart.

   A failed step must leave no trace: a cut run ends with the bits of one that makes the same steps and none that fail. */
#include <body/rows/complianceimpl.h>

/* The compliance of a level, and its solver where that depends on the step, in place of those of the level before */
PetscErrorCode BodyTakeLevel(Body body, PetscInt number)
{
  BodyLevel *level = &body->levels[number];

  PetscFunctionBegin;
  body->levels[body->time.level].compliance = body->compliance;
  body->levels[body->time.level].solver     = body->solver;
  body->time.level                          = number;
  body->time.controller_step                = body->time.whole_step / PetscPowRealInt(2, number);
  body->time.step                           = body->time.controller_step / body->time.substeps;
  PetscCall(BodyRestore(body));
  if (level->compliance) {
    body->compliance = level->compliance;
    body->solver     = level->solver;
  } else {
    if (body->integrator->depends_on_step || !body->model.linear) PetscCall(BodyCreateCompliance(body));
    level->compliance = body->compliance;
  }
  if (body->integrator->ops.setlevel) PetscCall((*body->integrator->ops.setlevel)(body));
  level->solver = body->solver;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes back to the saved state, from where controller steps are the whole one over 2^level, with as many substeps. The first step of a
   level factors the effective matrix of a linear implicit body, which is kept. Collective. */
PetscErrorCode BodySetStepLevel(Body body, PetscInt level)
{
  PetscFunctionBegin;
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  PetscCheck(level >= 0 && level <= STEP_MAX_CUTS, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_OUTOFRANGE,
             "A controller step cannot be cut in halves %" PetscInt_FMT " times; 0 to %d", level, STEP_MAX_CUTS);
  if (level == body->time.level) {
    PetscCall(BodyRestore(body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyTakeLevel(body, level));
  PetscCall(BodyFreeRows(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energy of the saved state for steps over 2^level less that for the last step [J]: not 0 for central differences alone. Collective. */
PetscErrorCode BodyGetLevelEnergy(Body body, PetscInt level, PetscReal *energy)
{
  const PetscReal whole = body->time.whole_step / body->time.substeps;
  const PetscReal now = whole / PetscPowRealInt(2, level), last = whole / PetscPowRealInt(2, body->time.accepted_level);
  PetscReal       sum;

  PetscFunctionBegin;
  *energy = 0;
  if (body->integrator->staggered == 0 || level == body->time.accepted_level) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodySumStaggering(body, body->saved.a, &sum));
  if (body->rows.size > 1) PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  *energy = 0.5 * body->integrator->staggered * (PetscSqr(last) - PetscSqr(now)) * sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes back to the saved state after a step that is not accepted; BodyRestore() is for another integration in the same step. Collective. */
PetscErrorCode BodyStepBack(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyRestore(body));
  body->iterate.known = PETSC_FALSE;
  PetscCall(BodyFreeRows(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of the interface have new entries: those that are marked, of all ranks */
PetscErrorCode BodySetRowsOfLevels(Body body, const PetscMPIInt changed[])
{
  PetscFunctionBegin;
  if (body->solver) PetscCall(ConstrainedSolverSetRows(body->solver, body->rows.free_matrix, changed));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) {
    const BodyLevel *level = &body->levels[k];

    if (k == body->time.level || !level->compliance) continue;
    if (level->solver && level->solver != body->solver) PetscCall(ConstrainedSolverSetRows(level->solver, body->rows.free_matrix, changed));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyLevels(Body body)
{
  struct _BodyCompliance *present = body->compliance;

  PetscFunctionBegin;
  /* levels may share what they have with the first one; what is present is destroyed last */
  for (PetscInt k = STEP_MAX_CUTS; k >= 0; k--) {
    BodyLevel *level = &body->levels[k];

    if (k && level->solver == body->levels[0].solver) level->solver = NULL;
    if (level->solver != body->solver) PetscCall(ConstrainedSolverDestroy(&level->solver));
    if (k && level->compliance == body->levels[0].compliance) level->compliance = NULL;
    if (level->compliance == present) continue;
    body->compliance = level->compliance;
    PetscCall(BodyDestroyCompliance(body));
  }
  body->compliance = present;
  PetscCall(BodyDestroyCompliance(body));
  PetscCall(ConstrainedSolverDestroy(&body->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}
