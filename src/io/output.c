/* What a run writes and prints: the class, its options, report and end. */
#include "fieldsfile.h"
#include "outputimpl.h"
#include "outputpaths.h"
#include "report.h"
#include "stopsignals.h"
#include "summary.h"
#include "xdmf.h"
#include <sys/package.h>

PetscClassId OUTPUT_CLASSID = 0;

PetscErrorCode OutputInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Output", &OUTPUT_CLASSID, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LockFiles(Controller controller, const ControllerFrame *frame, void *context)
{
  PetscFunctionBegin;
  (void)controller;
  (void)frame;
  PetscCall(OutputLock((Output)context));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputCreate - observes a controller and gathers the figures of its run

  Collective

  Input Parameter:
. controller - the `Controller`, set up, before its first step

  Output Parameter:
. output - the `Output`, to be destroyed after the last step and before the controller

  Level: beginner

.seealso: `Output`, `OutputSetHistory()`, `OutputSetFromOptions()`, `OutputReport()`, `OutputDestroy()`
@*/
PetscErrorCode OutputCreate(Controller controller, Output *output)
{
  const Body *bodies;
  PetscInt    n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(output, 2);
  PetscCall(OutputInitializePackage());
  PetscCall(PetscHeaderCreate(*output, OUTPUT_CLASSID, "Output", "Files and table of a run", "Output",
                              PetscObjectComm((PetscObject)controller), OutputDestroy, OutputView));
  (*output)->controller = controller;
  PetscCall(OutputStartClock(*output));
  PetscCall(ControllerMonitorSet(controller, LockFiles, *output, NULL));
  PetscCall(StatisticsCreate(controller, &(*output)->statistics));
  PetscCall(ControllerMonitorSet(controller, StatisticsMonitor, (*output)->statistics, NULL));
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  (*output)->n_displacements = 3 * n;
  PetscCall(PetscCalloc1(3 * n, &(*output)->displacements));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadExactDisplacements(Output output)
{
  const Body *bodies;
  PetscInt    n;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(output->controller, &n, &bodies));
  for (PetscInt b = 0; b < n; b++) {
    char      text[2048];
    PetscBool set;

    PetscObjectOptionsBegin((PetscObject)bodies[b]);
    PetscCall(PetscOptionsString("-exact_displacement", "Formulas to compare with at the end [m]", "OutputSetExactDisplacement", "", text,
                                 sizeof(text), &set));
    PetscOptionsEnd();
    if (set) PetscCall(OutputSetExactDisplacement(output, bodies[b], text));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -check has one frame to write, and not over the frames of a run */
static PetscErrorCode LeaveFramesOfRun(Output output, const char path[], PetscBool *write)
{
  MPI_Comm    comm     = PetscObjectComm((PetscObject)output);
  PetscInt    n_frames = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(FieldsFileCount(path, &n_frames));
  PetscCallMPI(MPI_Bcast(&n_frames, 1, MPIU_INT, 0, comm));
  *write = (PetscBool)(n_frames <= 1);
  if (!*write)
    PetscCall(PetscFPrintf(comm, stderr,
                           "impakt: warning: -check leaves %s as it is, which has the fields of a run; for the frame of the start give "
                           "-output_fields another path\n",
                           path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetFromOptions - reads what to write and what to compare with, and makes sure that the files can be written

  Collective

  Input Parameter:
. output - the `Output`

  Options Database Keys:
+ -check (true|false)                 - the set-up alone, and what to expect of the run: see `OutputCheck()`
. -output_history, _summary, _fields  - the files of the run, see `OutputSetHistory()`, `OutputSetSummary()`, `OutputSetFields()`
. -checkpoint, -restart, ...          - see `OutputSetCheckpoint()` and `OutputRestart()`
- -exact, -<body>_exact_displacement  - what to compare with; all of them are in options/README.md, which `impakt -help` prints too

  Level: beginner

  Note:
  Missing directories of the paths are made. A file that is there already stays until its successor is whole.

.seealso: `Output`, `OutputSetExact()`, `OutputSetSummary()`, `OutputSetHistory()`, `OutputSetFields()`, `OutputSetCheckpoint()`,
          `OutputRestart()`, `OutputReport()`
@*/
PetscErrorCode OutputSetFromOptions(Output output)
{
  char            exact[64] = "none", history[PETSC_MAX_PATH_LEN] = "", summary[PETSC_MAX_PATH_LEN] = "", fields[PETSC_MAX_PATH_LEN] = "";
  PetscInt        interval  = 0;
  OutputPrecision precision = OUTPUT_SINGLE;
  PetscBool       has_history, has_summary, has_fields, none, checks = output->checks;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscObjectOptionsBegin((PetscObject)output);
  PetscCall(PetscOptionsBool("-check", "The set-up alone, and what to expect of the run", "OutputSetCheck", checks, &checks, NULL));
  PetscCall(PetscOptionsString("-exact", "Exact solution to compare with (none|impact|characteristics)", "OutputSetExact", exact, exact,
                               sizeof(exact), NULL));
  PetscCall(PetscOptionsString("-output_history", "HDF5 file with every controller step", "OutputSetHistory", history, history,
                               sizeof(history), &has_history));
  PetscCall(PetscOptionsString("-output_summary", "JSON file with the figures of the run", "OutputSetSummary", summary, summary,
                               sizeof(summary), &has_summary));
  PetscCall(PetscOptionsString("-output_fields", "HDF5 file with fields of all bodies over time, an XDMF file beside it", "OutputSetFields",
                               fields, fields, sizeof(fields), &has_fields));
  if (has_fields) {
    PetscCall(PetscOptionsInt("-output_fields_interval", "A frame every n controller steps; 0: at most 100 frames", "OutputSetFields",
                              interval, &interval, NULL));
    PetscCall(PetscOptionsEnum("-output_fields_precision", "Of the numbers in the frames", "OutputSetFields", OutputPrecisions,
                               (PetscEnum)precision, (PetscEnum *)&precision, NULL));
  }
  PetscOptionsEnd();
  PetscCall(OutputPathDrop(history, &has_history));
  PetscCall(OutputPathDrop(summary, &has_summary));
  PetscCall(OutputPathDrop(fields, &has_fields));
  PetscCall(OutputCheckPaths(PetscObjectComm((PetscObject)output), summary, history, fields, ""));
  PetscCall(OutputSetCheck(output, checks));
  if (checks) has_summary = has_history = PETSC_FALSE;
  if (checks && has_fields) PetscCall(LeaveFramesOfRun(output, fields, &has_fields));
  PetscCall(PetscStrcmp(exact, "none", &none));
  if (!none) PetscCall(OutputSetExact(output, exact));
  PetscCall(ReadExactDisplacements(output));
  if (has_summary) PetscCall(OutputSetSummary(output, summary));
  if (has_history) PetscCall(OutputSetHistory(output, history));
  if (has_fields) PetscCall(OutputSetFields(output, fields, interval, precision));
  PetscCall(OutputReadCheckpoints(output));
  PetscCall(PetscObjectViewFromOptions((PetscObject)output, NULL, "-output_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputReport - writes what is left to write, prints the results table, and warns of what is amiss with the results

  Collective

  Input Parameter:
. output - the `Output`, after the last controller step

  Level: beginner

.seealso: `Output`, `OutputSetFromOptions()`
@*/
PetscErrorCode OutputReport(Output output)
{
  const StatisticsResults *results;
  const Body              *bodies;
  PetscViewer              viewer;
  Verdict                  verdict;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscCall(StatisticsGetResults(output->statistics, &results));
  PetscCall(StatisticsAddOverlaps(output->statistics));
  PetscCall(ControllerGetBodies(output->controller, NULL, &bodies));
  PetscCall(StatisticsSetDeviation(output->statistics, bodies, output->displacements));
  if (output->history) PetscCall(HistoryFlush(output->history));
  if (output->fields) PetscCall(FieldsFinish(output->fields));
  PetscCall(VerdictMake(output->controller, results, &verdict));
  if (output->summary_path[0]) PetscCall(SummaryWrite(output->controller, results, output->exact, &verdict, output->summary_path));
  PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)output), &viewer));
  PetscCall(ReportView(output->controller, results, output->exact, &verdict, viewer));
  PetscCall(OutputView(output, viewer));
  PetscCall(VerdictPrint(PetscObjectComm((PetscObject)output), &verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputCheck - the start of a run and what to expect of it, in place of `ControllerSolve()` and `OutputReport()`

  Collective

  Input Parameter:
. output - the `Output`, after `OutputSetCheck()` and all that says what is to be written

  Options Database Key:
. -check - this in place of a run

  Level: beginner

  Note:
  Of all files the fields alone are written, with the frame of the start.

.seealso: `Output`, `OutputSetCheck()`, `ControllerCheck()`
@*/
PetscErrorCode OutputCheck(Output output)
{
  PetscViewer viewer;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscCheck(output->checks, PetscObjectComm((PetscObject)output), PETSC_ERR_ARG_WRONGSTATE, "Call OutputSetCheck() first");
  PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)output), &viewer));
  PetscCall(ControllerCheck(output->controller, viewer));
  if (output->fields) PetscCall(FieldsFinish(output->fields));
  PetscCall(OutputView(output, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputView - prints which files are written

  Collective

  Input Parameters:
+ output - the `Output`
- viewer - an ASCII viewer, `NULL` for standard output

  Level: intermediate

.seealso: `Output`, `OutputReport()`
@*/
PetscErrorCode OutputView(Output output, PetscViewer viewer)
{
  char      xdmf[PETSC_MAX_PATH_LEN];
  PetscBool ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)output), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  if (output->history || output->summary_path[0] || output->fields || output->checkpoints.path[0])
    PetscCall(PetscViewerASCIIPrintf(viewer, "files\n"));
  if (output->history) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "history", output->history_path));
  if (output->summary_path[0]) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "summary", output->summary_path));
  if (output->fields) {
    PetscCall(XdmfGetPath(output->fields_path, XDMF_BODIES, sizeof(xdmf), xdmf));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "fields", xdmf));
  }
  if (output->checkpoints.path[0]) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "checkpoint", output->checkpoints.path));
  if (!output->history && !output->summary_path[0] && !output->fields)
    PetscCall(PetscViewerASCIIPrintf(viewer, "not written: history, summary and fields; -output_history h.h5 -output_summary s.json "
                                             "-output_fields f.h5 write them\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputDestroy - frees the output, after writing what history and fields have not written yet

  Collective

  Input Parameter:
. output - the `Output`, set to `NULL`; its controller makes no step after that

  Level: beginner

.seealso: `Output`, `OutputCreate()`
@*/
PetscErrorCode OutputDestroy(Output *output)
{
  PetscErrorCode errors[2];

  PetscFunctionBegin;
  if (!*output) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*output, OUTPUT_CLASSID, 1);
  if (--((PetscObject)*output)->refct > 0) {
    *output = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(StatisticsDestroy(&(*output)->statistics));
  errors[0] = HistoryDestroy(&(*output)->history);
  errors[1] = FieldsDestroy(&(*output)->fields);
  PetscCall(ExactDestroy(&(*output)->exact));
  for (PetscInt i = 0; i < (*output)->n_displacements; i++) PetscCall(ExpressionDestroy(&(*output)->displacements[i]));
  PetscCall(PetscFree((*output)->displacements));
  if ((*output)->checkpoints.catches) StopSignalsRelease();
  PetscCall(OutputLocksRelease(&(*output)->locks)); /* even where the files cannot be written, so that no lock is left beside them */
  PetscCall(errors[0]);
  PetscCall(errors[1]);
  PetscCall(PetscHeaderDestroy(output));
  PetscFunctionReturn(PETSC_SUCCESS);
}
