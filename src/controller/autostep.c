/* The controller step that resolves contact: chosen where the user leaves it to the program, or what a given one is compared with. */
#include "controllerimpl.h"
#include <sys/units.h>

/* A given step that is larger than this many times the one that resolves contact is worth a warning */
#define MUCH_LARGER 10
/* In a step that is larger by more than this the mass of an implicit body is lost in the round-off of its stiffness: their ratio is the
   square of the number, 1e14, and momentum would be wrong by one per cent */
#define TOO_LARGE 1e7

/* The longest substep that the user has given to a body, of which the controller step must be a multiple [s]; 0: none. An explicit body
   whose substep would be the controller step gets one that is stable. */
static PetscErrorCode GetGivenSubstep(Controller controller, PetscReal *given, const char *name[])
{
  PetscFunctionBegin;
  *given = 0;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    const Body body = controller->bodies[b];
    PetscBool  is_explicit;
    PetscReal  step;

    PetscCall(BodyGetTimeStep(body, &step));
    PetscCall(BodyIsExplicit(body, &is_explicit));
    if (step == 0 && is_explicit) PetscCall(BodySetTimeStep(body, PETSC_DETERMINE));
    if (step <= *given) continue;
    *given = step;
    PetscCall(PetscObjectGetName((PetscObject)body, name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole number of given substeps, or of controller steps in the run */
static PetscErrorCode RoundStep(Controller controller, PetscReal resolved)
{
  const PetscReal duration = controller->time_end - controller->time_start;
  char           *reason   = controller->step_reason;
  const char     *name     = NULL;
  PetscReal       given, step = resolved;
  size_t          used;

  PetscFunctionBegin;
  PetscCall(GetGivenSubstep(controller, &given, &name));
  if (given > 0) {
    step = PetscMax(PetscFloorReal(resolved / given * (1 + STEPS_ROUND_OFF)), 1) * given;
    PetscCall(PetscStrlen(reason, &used));
    PetscCall(PetscSNPrintf(reason + used, sizeof(controller->step_reason) - used, "; a multiple of -%s_ts_time_step", name));
  } else step = duration / PetscCeilReal(duration / step * (1 - STEPS_ROUND_OFF));
  PetscCall(ControllerSetTimes(controller, controller->time_start, controller->time_end, step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the step that resolves contact, if the user wants it so, before the bodies are set up. Their surfaces are known. */
PetscErrorCode ControllerChooseStep(Controller controller)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)controller);
  PetscReal resolved;

  PetscFunctionBegin;
  PetscCall(ContactGetResolvedStep(controller->contact, &resolved, sizeof(controller->step_reason), controller->step_reason));
  if (controller->chooses_step) {
    PetscCheck(resolved < PETSC_INFINITY, comm, PETSC_ERR_USER_INPUT,
               "-time_step auto takes the largest step that resolves contact, and here no bodies with inertia can come into contact; give "
               "-time_step a number");
    PetscCall(RoundStep(controller, resolved));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(
      !(resolved > 0) || controller->time_step <= TOO_LARGE * resolved, comm, PETSC_ERR_USER_INPUT,
      "-time_step %g%s is %.3g times the %.3g%s that resolve contact (%s): so large a step loses the masses of bodies in the round-off "
      "of their stiffness. Check units, or take a smaller one; -time_step auto takes %.3g%s",
      (double)controller->time_step, UnitsOf((PetscObject)controller, UNIT_TIME), (double)(controller->time_step / resolved),
      (double)resolved, UnitsOf((PetscObject)controller, UNIT_TIME), controller->step_reason, (double)resolved,
      UnitsOf((PetscObject)controller, UNIT_TIME));
  controller->resolved_step = resolved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest step that resolves contact, which -time_step auto takes. `step`: [s]; infinity without contact of bodies with inertia */
PetscErrorCode ControllerGetResolvedStep(Controller controller, PetscReal *step)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(step, 2);
  *step = controller->chooses_step ? controller->time_step : controller->resolved_step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says what is to be expected of a controller step that is much larger than one that resolves contact */
PetscErrorCode ControllerWarnOfStep(Controller controller)
{
  MPI_Comm        comm  = PetscObjectComm((PetscObject)controller);
  const PetscReal ratio = controller->resolved_step > 0 ? controller->time_step / controller->resolved_step : 0;
  const char     *unit;

  PetscFunctionBegin;
  unit = UnitsOf((PetscObject)controller, UNIT_TIME);
  if (ratio <= MUCH_LARGER) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFPrintf(
      comm, stderr,
      "impakt: warning: -time_step %g%s is %.15g times the %.3g%s that resolve contact (%s): contact that begins or ends within a "
      "step takes or brings energy%s, and its forces are means over steps; -time_step auto takes %.3g%s\n",
      (double)controller->time_step, unit, (double)PetscFloorReal(ratio + 0.5), (double)controller->resolved_step, unit,
      controller->step_reason, controller->most_cuts ? ", so that steps may have to be cut in halves" : "",
      (double)controller->resolved_step, unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}
