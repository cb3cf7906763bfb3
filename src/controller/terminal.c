/* What a run shows on the terminal while it goes on. */
#include "controllerimpl.h"
#include <sys/statusline.h>
#include <sys/units.h>

/* How lines are printed */
typedef struct {
  PetscInt interval;
  Units    units;
} Lines;

static PetscErrorCode FreeContext(void **ctx)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*ctx));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintLine(Controller controller, const ControllerFrame *frame, void *ctx)
{
  const Lines      *lines = (const Lines *)ctx;
  MPI_Comm          comm  = PetscObjectComm((PetscObject)controller);
  PetscReal         force = 0, gap = PETSC_MAX_REAL;
  PetscInt          active = 0;
  ControllerStatics statics;

  PetscFunctionBegin;
  if (frame->step % lines->interval && frame->step != frame->steps) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < frame->n_pairs; p++) {
    force += frame->pairs[p].force;
    gap = PetscMin(gap, frame->pairs[p].gap);
    active += frame->pairs[p].active;
  }
  PetscCall(ControllerGetStatics(controller, &statics));
  PetscCall(
      PetscPrintf(comm, "step %8" PetscInt_FMT "  time %13.6e%s", frame->step, (double)frame->time, UnitsText(lines->units, UNIT_TIME)));
  if (statics.balanced)
    PetscCall(PetscPrintf(comm, "  energy error %10.3e",
                          (double)(frame->energy_scale > 0 ? frame->energy_change / frame->energy_scale : frame->energy_change)));
  if (frame->n_pairs)
    PetscCall(PetscPrintf(comm, "  gap %10.3e%s  active %" PetscInt_FMT "  force %12.5e%s  sweeps %" PetscInt_FMT, (double)gap,
                          UnitsText(lines->units, UNIT_LENGTH), active, (double)force, UnitsText(lines->units, UNIT_FORCE), frame->sweeps));
  if (frame->step_cuts) PetscCall(PetscPrintf(comm, "  cuts %" PetscInt_FMT, frame->step_cuts));
  PetscCall(PetscPrintf(comm, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ShowProgress(Controller controller, const ControllerFrame *frame, void *ctx)
{
  PetscFunctionBegin;
  (void)controller;
  (void)ctx;
  if (frame->step < frame->steps) StatusLineSetSteps(frame->step, frame->steps);
  else StatusLineEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndProgress(void **ctx)
{
  PetscFunctionBegin;
  (void)ctx;
  StatusLineEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells on standard error how far the run is: with a bar, or with lines for a log */
static PetscErrorCode TellProgress(Controller controller, PetscBool bar)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)controller), &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StatusLineBegin(bar));
  PetscCall(ControllerMonitorSet(controller, ShowProgress, NULL, EndProgress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetMonitorInterval - prints a line on the terminal every so many controller steps, and at the end

  Collective

  Input Parameters:
+ controller - the `Controller`, before its first step
- interval   - controller steps from line to line

  Options Database Key:
. -monitor_interval n - the interval; 0 (default): no lines

  Level: beginner

  Note:
  The energy error is that of the summary: the change of all energies less the work of loads, relative to the largest so far of
  kinetic energy, strain energy and work (`ControllerFrame`). It is left out where it means nothing (`ControllerStatics`). The force is the
  sum over all pairs of forces along the normals. Units are those of `-units`.

.seealso: `Controller`, `ControllerMonitorSet()`
@*/
PetscErrorCode ControllerSetMonitorInterval(Controller controller, PetscInt interval)
{
  Lines *lines;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscValidLogicalCollectiveInt(controller, interval, 2);
  PetscCheck(interval > 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_OUTOFRANGE,
             "An interval of %" PetscInt_FMT " steps must be positive", interval);
  PetscCall(PetscNew(&lines));
  lines->interval = interval;
  PetscCall(UnitsGet((PetscObject)controller, &lines->units));
  PetscCall(ControllerMonitorSet(controller, PrintLine, lines, FreeContext));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads -monitor_interval and -progress, and adds the observers they ask for */
PetscErrorCode ControllerSetUpTerminal(Controller controller)
{
  PetscInt  interval = 0;
  PetscBool bar      = StatusLineHasTerminal(), set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsInt("-monitor_interval", "Steps from line to line on the terminal, 0 for none", "ControllerSetMonitorInterval",
                            interval, &interval, NULL));
  PetscCall(PetscOptionsBool("-progress", "Progress bar on standard error", "ControllerSetFromOptions", bar, &bar, &set));
  PetscOptionsEnd();
  PetscCheck(interval >= 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT,
             "-monitor_interval %" PetscInt_FMT " must not be negative", interval);
  if (interval) PetscCall(ControllerSetMonitorInterval(controller, interval));
  if (bar || !set) PetscCall(TellProgress(controller, bar));
  PetscFunctionReturn(PETSC_SUCCESS);
}
