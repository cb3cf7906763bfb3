/* What a run shows on the terminal while it goes on. */
#include "controllerimpl.h"
#include <unistd.h>

/* A bar is worth its lines for runs that last */
#define PROGRESS_AFTER 1.0 /* s */
#define PROGRESS_EVERY 0.2 /* s */

typedef struct {
  PetscInt  interval;
  PetscReal initial_energy;
} Lines;

typedef struct {
  PetscLogDouble begin, last;
  PetscBool      shown;
} Progress;

static PetscErrorCode FreeContext(void **ctx)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*ctx));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintLine(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Lines    *lines  = (Lines *)ctx;
  MPI_Comm  comm   = PetscObjectComm((PetscObject)controller);
  PetscReal energy = 0, force = 0, gap = PETSC_MAX_REAL;
  PetscInt  active = 0;

  PetscFunctionBegin;
  if (frame->step % lines->interval && frame->step != frame->steps) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < frame->n_bodies; b++) energy += frame->bodies[b].kinetic + frame->bodies[b].potential;
  for (PetscInt p = 0; p < frame->n_pairs; p++) {
    force += frame->pairs[p].force;
    gap = PetscMin(gap, frame->pairs[p].gap);
    active += frame->pairs[p].active;
  }
  lines->initial_energy = controller->initial_energy;
  PetscCall(PetscPrintf(comm, "step %8" PetscInt_FMT "  time %13.6e s  energy error %10.3e", frame->step, (double)frame->time,
                        (double)(lines->initial_energy > 0 ? energy / lines->initial_energy - 1 : energy)));
  if (frame->n_pairs)
    PetscCall(PetscPrintf(comm, "  gap %10.3e m  active %" PetscInt_FMT "  force %12.5e N  sweeps %" PetscInt_FMT, (double)gap, active,
                          (double)force, frame->sweeps));
  if (frame->step_cuts) PetscCall(PetscPrintf(comm, "  cuts %" PetscInt_FMT, frame->step_cuts));
  PetscCall(PetscPrintf(comm, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ShowProgress(Controller controller, const ControllerFrame *frame, void *ctx)
{
  Progress      *progress = (Progress *)ctx;
  PetscLogDouble now;
  PetscReal      share = (PetscReal)frame->step / frame->steps;
  char           bar[41];

  PetscFunctionBegin;
  (void)controller;
  PetscCall(PetscTime(&now));
  if (progress->begin == 0) progress->begin = progress->last = now;
  if (frame->step == frame->steps) {
    if (progress->shown) fprintf(stderr, "\r%79s\r", "");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (now - progress->begin < PROGRESS_AFTER || now - progress->last < PROGRESS_EVERY) PetscFunctionReturn(PETSC_SUCCESS);
  for (int i = 0; i < 40; i++) bar[i] = i < 40 * share ? '#' : '.';
  bar[40] = 0;
  fprintf(stderr, "\r[%s] %3.0f %%  %.0f s to go  ", bar, (double)(100 * share), (double)((now - progress->begin) * (1 - share) / share));
  progress->last  = now;
  progress->shown = PETSC_TRUE;
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

.seealso: `Controller`, `ControllerMonitorSet()`, `ControllerSetProgress()`
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
  PetscCall(ControllerMonitorSet(controller, PrintLine, lines, FreeContext));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerSetProgress - shows a progress bar on standard error

  Logically Collective

  Input Parameter:
. controller - the `Controller`, before its first step

  Options Database Key:
. -progress (true|false) - whether there is one, default where standard error is a terminal

  Level: beginner

  Note:
  The first rank draws it, of runs that take more than a second.

.seealso: `Controller`, `ControllerMonitorSet()`, `ControllerSetMonitorInterval()`
@*/
PetscErrorCode ControllerSetProgress(Controller controller)
{
  Progress   *progress;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)controller), &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&progress));
  PetscCall(ControllerMonitorSet(controller, ShowProgress, progress, FreeContext));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads -monitor_interval and -progress, and adds the observers they ask for */
PetscErrorCode ControllerSetUpTerminal(Controller controller)
{
  PetscInt  interval = 0;
  PetscBool show     = (PetscBool)isatty(STDERR_FILENO);

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)controller);
  PetscCall(PetscOptionsInt("-monitor_interval", "Steps from line to line on the terminal, 0 for none", "ControllerSetMonitorInterval",
                            interval, &interval, NULL));
  PetscCall(PetscOptionsBool("-progress", "Progress bar on standard error", "ControllerSetProgress", show, &show, NULL));
  PetscOptionsEnd();
  PetscCheck(interval >= 0, PetscObjectComm((PetscObject)controller), PETSC_ERR_USER_INPUT,
             "-monitor_interval %" PetscInt_FMT " must not be negative", interval);
  if (interval) PetscCall(ControllerSetMonitorInterval(controller, interval));
  if (show) PetscCall(ControllerSetProgress(controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}
