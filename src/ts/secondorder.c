/* What time integrators of second order share: what driving them in sweeps takes. */
#include <impakt/private/tssecondorder.h>
#include "constructors.h"
#include <petsc/private/tsimpl.h>

static PetscErrorCode RollBack(TS ts)
{
  PetscFunctionBegin;
  SETERRQ(PetscObjectComm((PetscObject)ts), PETSC_ERR_SUP,
          "A step of this integrator cannot be rolled back: keep its vectors, put them back and call TSSecondOrderSetState()");
}

/* Of an integrator that cannot roll back, when it is set up. `TSStep()` copies the solution for those that can, in a pass over memory that
   is a good part of a step; of a vector to itself it copies nothing. */
PetscErrorCode TSSecondOrderKeepNoStart(TS ts)
{
  PetscFunctionBegin;
  PetscCheck(ts->vec_sol && ts->vec_dot, PetscObjectComm((PetscObject)ts), PETSC_ERR_ARG_WRONGSTATE, "Call TS2SetSolution() first");
  PetscCall(PetscObjectReference((PetscObject)ts->vec_sol));
  PetscCall(VecDestroy(&ts->vec_sol0));
  ts->vec_sol0      = ts->vec_sol;
  ts->ops->rollback = RollBack;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At the start of a step of such an integrator: TSStep() has copied the solution to the vector that was set before it */
PetscErrorCode TSSecondOrderCheckSolution(TS ts)
{
  PetscFunctionBegin;
  PetscCheck(ts->vec_sol0 == ts->vec_sol, PetscObjectComm((PetscObject)ts), PETSC_ERR_ARG_WRONGSTATE,
             "TS2SetSolution() has set another vector after the set-up: set the entries of the first one instead");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts an integrator at a time, to go on from the vectors of `TS2SetSolution()` as they are now. `time`: current time [s]; `time_step`:
   step from here on [s]. Also switches off the restart of `TSALPHA2`, which would make two half steps with another matrix before the next
   step to estimate an acceleration. Impakt always knows the acceleration. An integrator whose last step has failed goes on as any other */
PetscErrorCode TSSecondOrderSetState(TS ts, PetscReal time, PetscReal time_step, PetscInt step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ts, TS_CLASSID, 1);
  ts->ptime       = time;
  ts->time_step   = time_step;
  ts->steps       = step;
  ts->steprestart = PETSC_FALSE;
  ts->reason      = TS_CONVERGED_ITERATING;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Has a function make the steps of a `TSALPHA2`, in place of its nonlinear solver. For linear equations, which need one solution: its
   `SNES` and its nine vectors are not made. What the function is to know comes with `TSGetI2Function()` and `TSAlpha2GetParams()`.
   `TSRollBack()` is refused, and other vectors may be set with `TS2SetSolution()` before the first step alone. `ts`: not yet set up;
   `step`: takes the vectors of TS2SetSolution() to the end of the step, and the time by TSSetTime() */
PetscErrorCode TSAlpha2SetStep(TS ts, TSAlpha2StepFn *step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ts, TS_CLASSID, 1);
  ts->ops->step  = step;
  ts->ops->setup = TSSecondOrderKeepNoStart;
  ts->usessnes   = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
