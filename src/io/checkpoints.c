/* When a run writes checkpoints, and when it ends before its time. */
#include "outputimpl.h"
#include "outputfile.h"
#include <contact/interface/contactvisit.h>
#include <controller/controllervisit.h>
#include <exact/exactvisit.h>
#include "stopsignals.h"
#include <petsctime.h>

/* Ranks agree whether a signal has come, or the time is over, about so often [s]: a message to all of them costs as much as a small step */
#define LOOK_EVERY 0.05
/* One rank asks for signals no more often than this [s]: the system takes 1 us for it, a tenth of a small step */
#define ASK_EVERY 1e-3
/* Part of -max_wall_time that is left for the last checkpoint and the summary */
#define TIME_LEFT 0.01
/* Larger than the number of any signal */
#define LAST_SIGNAL 64

/* What all ranks have in a checkpoint: the simulation, and what observers have gathered. `same_ranks`: as many ranks as before */
PetscErrorCode OutputVisitShared(Output output, PetscBool same_ranks, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  PetscCall(ControllerVisit(output->controller, checkpoint));
  PetscCall(StatisticsVisit(output->statistics, checkpoint));
  if (output->exact) PetscCall(ExactVisit(output->exact, checkpoint));
  PetscCall(CheckpointBegin(checkpoint, "files"));
  PetscCall(HistoryVisit(output->history, checkpoint));
  PetscCall(FieldsVisit(output->fields, PetscObjectComm((PetscObject)output), same_ranks, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The run begins: what came before, reading meshes and setting up, counts as well */
PetscErrorCode OutputStartClock(Output output)
{
  Checkpoints   *c = &output->checkpoints;
  PetscLogDouble now;
  ControllerCost cost;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  PetscCall(ControllerGetCost(output->controller, &cost));
  c->begin      = now - cost.setup;
  c->written    = now;
  c->looked     = c->begin;
  c->look_every = 1;
  c->last_step  = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a checkpoint, unless the last one is of this step. Collective. */
static PetscErrorCode Write(Output output, PetscInt step)
{
  Checkpoints       *c    = &output->checkpoints;
  MPI_Comm           comm = PetscObjectComm((PetscObject)output);
  CheckpointInfo     info = {.step = step};
  PetscInt           steps;
  PetscReal          start, dt;
  Contact            contact;
  CheckpointContents contents;

  PetscFunctionBegin;
  if (!c->path[0] || c->last_step == step) PetscFunctionReturn(PETSC_SUCCESS);
  if (output->history) PetscCall(HistorySync(output->history));
  if (output->fields) PetscCall(FieldsSync(output->fields));
  PetscCall(ControllerGetTimes(output->controller, &start, &dt, &steps));
  info.time = start + step * dt;
  PetscCallMPI(MPI_Comm_size(comm, &info.ranks));
  PetscCall(PetscOptionsGetAll(NULL, &info.options));
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(CheckpointCreate(comm, &contents.shared));
  PetscCall(OutputVisitShared(output, PETSC_TRUE, contents.shared));
  PetscCall(CheckpointCreate(comm, &contents.state));
  PetscCall(ContactVisit(contact, contents.state));
  PetscCall(TablesCreate(comm, PETSC_FALSE, &contents.tables));
  PetscCall(ContactVisitTables(contact, contents.tables));
  PetscCall(ControllerGetBodies(output->controller, &contents.n_bodies, &contents.bodies));
  PetscCall(CheckpointFileWrite(comm, c->path, &info, &contents));
  PetscCall(CheckpointDestroy(&contents.shared));
  PetscCall(CheckpointDestroy(&contents.state));
  PetscCall(TablesDestroy(&contents.tables));
  PetscCall(PetscFree(info.options));
  c->last_step = step;
  PetscCall(PetscTime(&c->written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What any rank has been asked for, and whether times are over by the clock of the slowest; the same on all ranks */
static PetscErrorCode Look(Output output, PetscInt step, StopSignals *signals, PetscBool *late, PetscBool *due)
{
  Checkpoints   *c    = &output->checkpoints;
  MPI_Comm       comm = PetscObjectComm((PetscObject)output);
  PetscLogDouble now;
  double         values[5] = {0}; /* the signal that ends the run, a checkpoint; seconds since begin, checkpoint, last look */
  PetscMPIInt    size;
  PetscBool      asks;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  asks = (PetscBool)(size > 1 || now - c->looked >= ASK_EVERY);
  if (asks && c->catches) StopSignalsTake(signals);
  values[0] = signals->stop ? LAST_SIGNAL - signals->stop : 0; /* what the user does counts before SIGTERM, which mpiexec sends beside it */
  values[1] = signals->checkpoint;
  values[2] = now - c->begin;
  values[3] = now - c->written;
  values[4] = now - c->looked;
  if (size > 1) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, 5, MPI_DOUBLE, MPI_MAX, comm));
    if (values[4] < LOOK_EVERY) c->look_every = PetscMin(2 * c->look_every, 1 << 16);
    else c->look_every = PetscMax(1, (PetscInt)((double)c->look_every * LOOK_EVERY / values[4]));
  }
  signals->stop       = values[0] > 0 ? LAST_SIGNAL - (int)values[0] : 0;
  signals->checkpoint = (PetscBool)(values[1] > 0);
  *late               = (PetscBool)(c->max_wall_time > 0 && values[2] >= (1 - TIME_LEFT) * c->max_wall_time);
  *due                = (PetscBool)(c->wall_interval > 0 && values[3] >= c->wall_interval);
  c->next_look        = step + c->look_every;
  if (asks) c->looked = now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The one line that says how to continue */
static PetscErrorCode TellEnd(Output output, PetscInt step, const char reason[])
{
  const Checkpoints *c    = &output->checkpoints;
  MPI_Comm           comm = PetscObjectComm((PetscObject)output);
  PetscInt           steps;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(output->controller, NULL, NULL, &steps));
  if (c->path[0])
    PetscCall(PetscFPrintf(comm, stderr,
                           "impakt: ended by %s after controller step %" PetscInt_FMT " of %" PetscInt_FMT
                           "; to continue, give the same command with -restart %s\n",
                           reason, step, steps, c->path));
  else
    PetscCall(PetscFPrintf(comm, stderr,
                           "impakt: ended by %s after controller step %" PetscInt_FMT " of %" PetscInt_FMT
                           "; without -checkpoint the run cannot be continued\n",
                           reason, step, steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `ControllerAfterStepFn` */
static PetscErrorCode AfterStep(Controller controller, PetscInt step, void *context, PetscBool *stop)
{
  Output       output  = (Output)context;
  Checkpoints *c       = &output->checkpoints;
  StopSignals  signals = {0, PETSC_FALSE};
  PetscBool    late = PETSC_FALSE, due = PETSC_FALSE;
  PetscInt     steps;
  PetscMPIInt  size;

  PetscFunctionBegin;
  PetscCall(ControllerGetTimes(controller, NULL, NULL, &steps));
  if (step < steps && step >= c->next_look) PetscCall(Look(output, step, &signals, &late, &due));
  if (signals.stop || late) {
    *stop = c->stopped = PETSC_TRUE;
    PetscCall(Write(output, step));
    PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)output), &size));
    PetscCall(TellEnd(output, step, late ? "-max_wall_time" : StopSignalName(signals.stop, (PetscBool)(size > 1))));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (step == steps || signals.checkpoint || due || (c->interval && step && step % c->interval == 0)) PetscCall(Write(output, step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetCheckpoint - has checkpoints written, from which the run can be continued

  Collective

  Input Parameters:
+ output   - the `Output`, before the first controller step
. path     - HDF5 file; missing directories are made
. interval - controller steps from one to the next; 0: by time alone
- minutes  - the same by the clock [min]; 0: by steps alone

  Options Database Keys:
+ -checkpoint path             - the file
. -checkpoint_interval n       - the interval
- -checkpoint_wall_interval t  - the interval by the clock [min], 15 unless -checkpoint_interval is given

  Level: beginner

  Notes:
  The last two are kept: that before the last one as c.prev.h5 beside c.h5. Each is written beside the last one, through to the disk, and
  renamed, so that a run which is killed at any moment leaves one that is whole. One more is written at the end of the run.

  The first rank makes the file in memory, which takes about twice its size there.

.seealso: `Output`, `OutputSetRestart()`, `OutputRestart()`, `OutputCatchSignals()`, `OutputSetMaxWallTime()`
@*/
PetscErrorCode OutputSetCheckpoint(Output output, const char path[], PetscInt interval, PetscReal minutes)
{
  Checkpoints *c;
  MPI_Comm     comm;
  Contact      contact;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  PetscValidLogicalCollectiveInt(output, interval, 3);
  PetscValidLogicalCollectiveReal(output, minutes, 4);
  c    = &output->checkpoints;
  comm = PetscObjectComm((PetscObject)output);
  PetscCheck(interval >= 0 && minutes >= 0 && (interval || minutes > 0), comm, PETSC_ERR_ARG_OUTOFRANGE,
             "Checkpoints every %" PetscInt_FMT " controller steps or %g minutes: one of them must be positive, and none negative",
             interval, (double)minutes);
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCheck(ContactHasVisit(contact), comm, PETSC_ERR_SUP, "-checkpoint: the contact method does not tell its state");
  PetscCall(OutputCheckPaths(comm, output->summary_path, output->history_path, output->fields_path, path));
  PetscCall(OutputFileCheck(comm, "-checkpoint", path));
  PetscCall(PetscStrncpy(c->path, path, sizeof(c->path)));
  c->interval      = interval;
  c->wall_interval = 60 * minutes;
  PetscCall(ControllerSetAfterStep(output->controller, AfterStep, output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetMaxWallTime - ends the run after some time, with a checkpoint where there are any

  Logically Collective

  Input Parameters:
+ output  - the `Output`, before the first controller step
- seconds - by the clock, from the set-up of the controller on [s]; 0: never

  Options Database Key:
. -max_wall_time (minutes|h:mm:ss) - the time, for batch queues

  Level: beginner

  Note:
  The run ends after the step in which 99 % of that time are over.

.seealso: `Output`, `OutputSetCheckpoint()`, `OutputIsStopped()`
@*/
PetscErrorCode OutputSetMaxWallTime(Output output, PetscReal seconds)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(output, seconds, 2);
  PetscCheck(seconds >= 0, PetscObjectComm((PetscObject)output), PETSC_ERR_ARG_OUTOFRANGE, "A time of %g s must not be negative",
             (double)seconds);
  output->checkpoints.max_wall_time = seconds;
  PetscCall(ControllerSetAfterStep(output->controller, AfterStep, output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputCatchSignals - has SIGINT, SIGTERM and SIGHUP end the run in good order, and SIGUSR1 write a checkpoint

  Logically Collective

  Input Parameter:
. output - the `Output`, before the first controller step

  Level: intermediate

  Notes:
  The step under way is finished, a checkpoint is written where there are any, and `ControllerSolve()` returns. A second SIGINT ends the
  process at once. What handled these signals before is replaced; `OutputDestroy()` has them do what they do by default.

  The ranks of a run look at the same step, every 0.05 s or at each step if these take longer. If SIGTERM comes while nobody reads what they
  print, as of Open MPI's mpiexec, the output from then on is dropped.

.seealso: `Output`, `OutputSetCheckpoint()`, `OutputIsStopped()`
@*/
PetscErrorCode OutputCatchSignals(Output output)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  output->checkpoints.catches = PETSC_TRUE;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)output), &size));
  StopSignalsCatch((PetscBool)(size > 1));
  PetscCall(ControllerSetAfterStep(output->controller, AfterStep, output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputIsStopped - whether the run has ended before its time, by a signal or by `OutputSetMaxWallTime()`

  Not Collective

  Input Parameter:
. output - the `Output`, after `ControllerSolve()`

  Output Parameter:
. stopped - true if there are steps left

  Level: intermediate

.seealso: `Output`, `OutputCatchSignals()`
@*/
PetscErrorCode OutputIsStopped(Output output, PetscBool *stopped)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(stopped, 2);
  *stopped = output->checkpoints.stopped;
  PetscFunctionReturn(PETSC_SUCCESS);
}
