/* Rigid motions: a step is a function of the caller, who knows what moves as one. */
#include <impakt/private/tssecondorder.h>
#include "constructors.h"
#include <petsc/private/tsimpl.h>

typedef struct {
  TSRigidFn *advance;
  void      *ctx;
} TS_Rigid;

static PetscErrorCode TSStep_Rigid(TS ts)
{
  TS_Rigid *rigid = (TS_Rigid *)ts->data;
  PetscReal next  = ts->time_step;
  PetscBool accept;

  PetscFunctionBegin;
  PetscCall(TSSecondOrderCheckSolution(ts));
  PetscCall((*rigid->advance)(ts, ts->ptime, ts->time_step, ts->vec_sol, ts->vec_dot, rigid->ctx));
  PetscCall(TSAdaptChoose(ts->adapt, ts, ts->time_step, NULL, &next, &accept));
  ts->ptime += ts->time_step;
  ts->time_step = next;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSSetUp_Rigid(TS ts)
{
  TS_Rigid *rigid = (TS_Rigid *)ts->data;

  PetscFunctionBegin;
  PetscCall(TSSecondOrderKeepNoStart(ts));
  PetscCheck(rigid->advance, PetscObjectComm((PetscObject)ts), PETSC_ERR_ARG_WRONGSTATE, "Call TSRigidSetAdvance() first");
  PetscCall(TSGetAdapt(ts, &ts->adapt));
  PetscCall(TSAdaptCandidatesClear(ts->adapt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TSDestroy_Rigid(TS ts)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(ts->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the function of a step: `advance`(ts, t, dt, U, V, ctx) takes displacement U [m] and velocity V [m/s] at time t to t + dt */
PetscErrorCode TSRigidSetAdvance(TS ts, TSRigidFn *advance, void *ctx)
{
  TS_Rigid *rigid = (TS_Rigid *)ts->data;

  PetscFunctionBegin;
  PetscValidHeaderSpecificType(ts, TS_CLASSID, 1, TSRIGID);
  rigid->advance = advance;
  rigid->ctx     = ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   TSRIGID - steps of bodies that do not deform: displacements and velocities of many nodes that follow from the few numbers of a rigid
   motion, which the function of `TSRigidSetAdvance()` knows

   Level: beginner

   Note:
   `TSRollBack()` is refused: whoever wants to undo a step keeps displacement and velocity, and calls `TSSecondOrderSetState()`.

.seealso: `TSALPHA2`, `BodySetRigid()`
M*/
PetscErrorCode TSCreate_Rigid(TS ts)
{
  TS_Rigid *rigid;

  PetscFunctionBegin;
  PetscCall(PetscNew(&rigid));
  ts->data               = rigid;
  ts->ops->setup         = TSSetUp_Rigid;
  ts->ops->step          = TSStep_Rigid;
  ts->ops->destroy       = TSDestroy_Rigid;
  ts->default_adapt_type = TSADAPTNONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
