/* The state of a simulation, for checkpoints, and what is called when a step is over. */
#include "controllerimpl.h"
#include <contact/interface/contactvisit.h>
#include "controllervisit.h"

/*@C
  ControllerSetAfterStep - sets a function that is called after each accepted controller step, when all observers have been

  Logically Collective

  Input Parameters:
+ controller - the `Controller`
. function   - function (controller, step, ctx, stop); where it sets stop, on all ranks alike, `ControllerSolve()` ends; `NULL`: none
- ctx        - its context

  Level: intermediate

  Note:
  It is called at the start as well, with step 0, but not for the step that a run is continued from.

.seealso: `Controller`, `ControllerMonitorSet()`, `ControllerSolve()`
@*/
PetscErrorCode ControllerSetAfterStep(Controller controller, ControllerAfterStepFn *function, void *ctx)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  controller->after_step     = function;
  controller->after_step_ctx = ctx;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetStep - controller steps that have been accepted so far

  Not Collective

  Input Parameter:
. controller - the `Controller`

  Output Parameter:
. step - their number; that of `ControllerGetTimes()` after a run that was not stopped

  Level: intermediate

.seealso: `Controller`, `ControllerSolve()`, `ControllerSetAfterStep()`
@*/
PetscErrorCode ControllerGetStep(Controller controller, PetscInt *step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(step, 2);
  *step = controller->step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Start and step of the time must be the same, to the last bit: the times of steps follow from them */
static PetscErrorCode CheckTimes(Controller controller, Checkpoint checkpoint)
{
  PetscReal times[2] = {controller->time_start, controller->time_step};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitReals(checkpoint, "times", 2, times));
  PetscCheck(
      times[0] == controller->time_start && times[1] == controller->time_step, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
      "The checkpoint is of a run that starts at %.17g s with steps of %.17g s, and this one starts at %.17g s with steps of %.17g s; "
      "-restart_state begins a run of other times with its state",
      (double)times[0], (double)times[1], (double)controller->time_start, (double)controller->time_step);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all ranks have of the state of a simulation after an accepted controller step, to or from a checkpoint. A run that has been loaded
   goes on with the next step: observers are not told of the step that it goes on from. Collective */
PetscErrorCode ControllerVisit(Controller controller, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointBegin(checkpoint, "controller"));
  PetscCall(CheckTimes(controller, checkpoint));
  PetscCall(CheckpointVisitInts(checkpoint, "step", 1, &controller->step));
  PetscCall(CheckpointVisitBytes(checkpoint, "cuts", sizeof(controller->cuts), &controller->cuts));
  PetscCall(CheckpointVisitReals(checkpoint, "scale start", 1, &controller->scale.start));
  PetscCall(CheckpointVisitReals(checkpoint, "scale largest", 1, &controller->scale.largest));
  PetscCall(CheckpointVisitReals(checkpoint, "guard largest", 1, &controller->guard.largest));
  PetscCall(CheckpointVisitReals(checkpoint, "guard given", 1, &controller->guard.given));
  PetscCall(CheckpointVisitReals(checkpoint, "guard start", controller->n_bodies, controller->guard.start));
  PetscCall(ContactVisitShared(controller->contact, checkpoint));
  if (CheckpointLoads(checkpoint)) controller->goes_on = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
