/* Runs that are continued from a checkpoint, and the options of all this. */
#include "outputimpl.h"
#include "outputpaths.h"
#include <body/interface/bodyvisit.h>
#include <contact/interface/contactvisit.h>
#include <stdlib.h>
#include <sys/units.h>

/* Minutes between checkpoints where the user says nothing */
#define WALL_INTERVAL 15

/*@
  OutputSetRestart - sets the checkpoint that the run is continued from

  Logically Collective

  Input Parameters:
+ output        - the `Output`
. path          - the checkpoint; a run without one there begins at its start
- allow_changes - whether the run may have other options than the one that is continued

  Options Database Keys:
+ -restart path                       - the checkpoint
- -restart_allow_changes (true|false) - whether options may differ

  Level: beginner

.seealso: `Output`, `OutputRestart()`, `OutputSetCheckpoint()`
@*/
PetscErrorCode OutputSetRestart(Output output, const char path[], PetscBool allow_changes)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  PetscValidLogicalCollectiveBool(output, allow_changes, 3);
  PetscCheck(path[0], PetscObjectComm((PetscObject)output), PETSC_ERR_USER_INPUT, "-restart needs the path of a checkpoint");
  PetscCall(PetscStrncpy(output->checkpoints.restart, path, sizeof(output->checkpoints.restart)));
  output->checkpoints.allow_changes = allow_changes;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetRestartState - sets the checkpoint whose state the bodies begin with

  Logically Collective

  Input Parameters:
+ output - the `Output`
- path   - a checkpoint of bodies with the same names and meshes

  Options Database Key:
. -restart_state path - the checkpoint

  Level: beginner

  Notes:
  The run begins at its own start, with its own loads, integrators and contact method, and on any number of ranks. Displacements, the
  history of plastic materials and velocities are those of the checkpoint, but for velocities of bodies without inertia, which begin with
their own; then ties, gaps and the balance of massless nodes are found as at any start, so that a preload is there from the first step on.
Bodies that the checkpoint does not have begin as their options say.

  `OutputRestart()` takes the state, unless it has a checkpoint to go on from.

.seealso: `Output`, `OutputRestart()`, `OutputSetRestart()`, `BodySetInitialState()`
@*/
PetscErrorCode OutputSetRestartState(Output output, const char path[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  PetscCheck(path[0], PetscObjectComm((PetscObject)output), PETSC_ERR_USER_INPUT, "-restart_state needs the path of a checkpoint");
  PetscCall(PetscStrncpy(output->checkpoints.state, path, sizeof(output->checkpoints.state)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says of which bodies, or of contact, the solvers do not repeat themselves to the last bit, so that the run does not either */
static PetscErrorCode TellSolvers(Output output)
{
  const Body *bodies;
  Contact     contact;
  PetscBool   sums;
  PetscInt    n;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(output->controller, &n, &bodies));
  for (PetscInt b = 0; b < n; b++) {
    const char *name;
    PetscBool   repeats;

    PetscCall(BodyRepeatsBits(bodies[b], &repeats));
    PetscCall(PetscObjectGetName((PetscObject)bodies[b], &name));
    if (!repeats)
      PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)output), stderr,
                             "impakt: the solver of body '%s' need not repeat itself to the last bit: the run goes on to round-off\n",
                             name));
  }
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(ContactRepeatsBits(contact, &sums));
  if (!sums)
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)output), stderr,
                           "impakt: sums of contact over three ranks or more need not repeat to the last bit: the run goes on to "
                           "round-off\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Everything but files: to the last bit on as many ranks as before, else to round-off */
static PetscErrorCode LoadState(Output output, const CheckpointFile *file, PetscBool same_ranks)
{
  MPI_Comm   comm = PetscObjectComm((PetscObject)output);
  Contact    contact;
  Checkpoint shared, state;
  Tables     tables;

  PetscFunctionBegin;
  PetscCall(ControllerGetContact(output->controller, &contact));
  PetscCall(CheckpointFileReadShared(comm, file, &shared));
  PetscCall(OutputVisitShared(output, same_ranks, shared));
  PetscCall(CheckpointFinish(shared));
  PetscCall(CheckpointDestroy(&shared));
  if (!same_ranks) {
    PetscCall(CheckpointFileReadTables(comm, file, &tables));
    PetscCall(ContactVisitTables(contact, tables));
    PetscCall(TablesDestroy(&tables));
    PetscCall(PetscFPrintf(comm, stderr, "impakt: the checkpoint is of %d ranks: on another number of them the run goes on to round-off\n",
                           file->info.ranks));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(TellSolvers(output));
  PetscCall(CheckpointFileRead(comm, file, &state));
  PetscCall(ContactVisit(contact, state));
  PetscCall(CheckpointFinish(state));
  PetscCall(CheckpointDestroy(&state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All of a checkpoint. If it is of another problem or distribution, the run's files stay as they were. */
static PetscErrorCode Load(Output output, const CheckpointFile *file, PetscBool same_ranks)
{
  PetscFunctionBegin;
  PetscCall(LoadState(output, file, same_ranks));
  PetscCall(HistoryTakeUp(output->history));
  PetscCall(FieldsTakeUp(output->fields));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Restart(Output output)
{
  Checkpoints   *c;
  MPI_Comm       comm;
  PetscBool      exists = PETSC_FALSE, same;
  CheckpointFile file;
  PetscMPIInt    size;
  char           path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  c    = &output->checkpoints;
  comm = PetscObjectComm((PetscObject)output);
  if (c->restart[0]) PetscCall(CheckpointFileFind(comm, c->restart, sizeof(path), path, &exists));
  if (!exists && c->state[0]) PetscCall(OutputTakeState(output, c->state));
  if (!c->restart[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!exists) {
    PetscCall(PetscFPrintf(comm, stderr, "impakt: there is no checkpoint %s yet: the run begins at its start\n", c->restart));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(CheckpointFileOpen(comm, "-restart", path, &file));
  PetscCall(OutputCompareOptions(comm, file.info.options, c->allow_changes, path));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(Load(output, &file, (PetscBool)(file.info.ranks == size)));
  PetscCall(PetscFPrintf(comm, stderr, "impakt: continued from %s, after controller step %" PetscInt_FMT " at time %g%s\n", path,
                         file.info.step, (double)file.info.time, UnitsOf((PetscObject)output->controller, UNIT_TIME)));
  PetscCall(PetscStrcmp(path, c->path, &same));
  if (same) c->last_step = file.info.step;
  c->next_look = file.info.step + 1;
  PetscCall(CheckpointFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputRestart - goes on from the checkpoint of `OutputSetRestart()`, if there is one

  Collective

  Input Parameter:
. output - the `Output`, with all that is to be written, before `ControllerSolve()`

  Level: beginner

  Notes:
  On as many ranks as before the run goes on to the last bit as if it had not been interrupted, with history, fields and summary: what had
  been written after the checkpoint is cut off. On another number of ranks it goes on to round-off, and fields need another path.

  Options that change the problem must be the same; those of files, terminal and -time_end may differ. Without a checkpoint yet the run
  begins at its start, or with the state of `OutputSetRestartState()`.

.seealso: `Output`, `OutputSetRestart()`, `OutputSetCheckpoint()`, `ControllerSolve()`
@*/
PetscErrorCode OutputRestart(Output output)
{
  PetscErrorCode error = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  if (output->checkpoints.restart[0]) error = OutputLock(output);
  if (!error) error = Restart(output);
  if (error) { /* a program that ends here does not destroy the output, and would leave the files of its locks */
    (void)OutputLocksRelease(&output->locks);
    output->locked = PETSC_FALSE;
  }
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Minutes, or h:mm or h:mm:ss [s] */
static PetscErrorCode ReadTime(MPI_Comm comm, const char text[], PetscReal *seconds)
{
  char  *end;
  double value = strtod(text, &end), sum = 60 * value;

  PetscFunctionBegin;
  for (int k = 0; end > text && *end == ':' && k < 2; k++) {
    if (!k) sum *= 60;
    value = strtod(text = end + 1, &end);
    sum += (k ? 1 : 60) * value;
    if (!(value >= 0 && value < 60)) end = (char *)text;
  }
  PetscCheck(end > text && !*end && sum > 0, comm, PETSC_ERR_USER_INPUT,
             "-max_wall_time needs a number of minutes, as in 90, or hours, minutes and seconds, as in 1:30:00");
  *seconds = sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputReadCheckpoints(Output output)
{
  MPI_Comm  comm                     = PetscObjectComm((PetscObject)output);
  char      path[PETSC_MAX_PATH_LEN] = "", restart[PETSC_MAX_PATH_LEN] = "", state[PETSC_MAX_PATH_LEN] = "", limit[64] = "";
  PetscInt  interval = 0;
  PetscReal minutes  = 0, seconds;
  PetscBool has, has_restart, has_state, has_limit, has_interval = PETSC_FALSE, has_minutes = PETSC_FALSE, allow = PETSC_FALSE;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)output);
  PetscCall(PetscOptionsString("-checkpoint", "HDF5 file that the run can be continued from", "OutputSetCheckpoint", path, path,
                               sizeof(path), &has));
  if (has) {
    PetscCall(PetscOptionsInt("-checkpoint_interval", "A checkpoint every n controller steps", "OutputSetCheckpoint", interval, &interval,
                              &has_interval));
    PetscCall(PetscOptionsReal("-checkpoint_wall_interval", "A checkpoint every t minutes", "OutputSetCheckpoint", minutes, &minutes,
                               &has_minutes));
  }
  PetscCall(PetscOptionsString("-restart", "Checkpoint that the run is continued from", "OutputSetRestart", restart, restart,
                               sizeof(restart), &has_restart));
  if (has_restart)
    PetscCall(PetscOptionsBool("-restart_allow_changes", "Other options than those of the run that is continued", "OutputSetRestart", allow,
                               &allow, NULL));
  PetscCall(PetscOptionsString("-restart_state", "Checkpoint whose state the bodies begin with", "OutputSetRestartState", state, state,
                               sizeof(state), &has_state));
  PetscCall(PetscOptionsString("-max_wall_time", "Minutes, or h:mm:ss, after which the run ends", "OutputSetMaxWallTime", limit, limit,
                               sizeof(limit), &has_limit));
  PetscOptionsEnd();
  PetscCall(OutputPathDrop(path, &has));
  if (output->checks && has_restart)
    PetscCall(PetscFPrintf(comm, stderr, "impakt: -check looks at the start of the run, and not at the checkpoint -restart %s\n", restart));
  if (output->checks) has = has_restart = PETSC_FALSE;
  PetscCheck(!has_interval || interval > 0, comm, PETSC_ERR_USER_INPUT,
             "-checkpoint_interval %" PetscInt_FMT " must be a number of controller steps, 1 or more", interval);
  PetscCheck(!has_minutes || minutes > 0, comm, PETSC_ERR_USER_INPUT, "-checkpoint_wall_interval %.6g must be a positive number of minutes",
             (double)minutes);
  if (has) PetscCall(OutputSetCheckpoint(output, path, interval, has_interval || has_minutes ? minutes : WALL_INTERVAL));
  if (has_restart) PetscCall(OutputSetRestart(output, restart, allow));
  if (has_state) PetscCall(OutputSetRestartState(output, state));
  if (!has_limit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ReadTime(comm, limit, &seconds));
  PetscCall(OutputSetMaxWallTime(output, seconds));
  PetscFunctionReturn(PETSC_SUCCESS);
}
