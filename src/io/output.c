/* What a run writes and prints, from its options. */
#include <impakt/io.h>
#include <impakt/exact.h>
#include "deviation.h"
#include "fields.h"
#include "history.h"
#include "outputfile.h"
#include "report.h"
#include "summary.h"
#include "xdmf.h"

struct _n_Output {
  Controller controller; /* borrowed */
  Statistics statistics;
  History    history;
  Fields     fields;
  Exact      exact;
  Deviation  deviation;
  char       summary[PETSC_MAX_PATH_LEN]; /* path of the summary; empty if none is written */
};

/*@
  OutputCreate - observes a controller and gathers the figures of its run

  Collective

  Input Parameter:
. controller - the `Controller`, set up, before its first step

  Output Parameter:
. output - the `Output`, to be destroyed after the last step and before the controller

  Level: beginner

.seealso: `Output`, `OutputSetFromOptions()`, `OutputReport()`, `OutputDestroy()`
@*/
PetscErrorCode OutputCreate(Controller controller, Output *output)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(output));
  (*output)->controller = controller;
  PetscCall(StatisticsCreate(controller, &(*output)->statistics));
  PetscCall(ControllerMonitorSet(controller, StatisticsMonitor, (*output)->statistics, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if two files have the same path */
static PetscErrorCode CheckDistinct(MPI_Comm comm, PetscInt n, const char *const options[], const char *const paths[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = i + 1; j < n; j++) {
      PetscBool same = PETSC_FALSE;

      if (paths[i][0]) PetscCall(PetscStrcmp(paths[i], paths[j], &same));
      PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "%s and %s are the same file, %s; give each its own", options[i], options[j], paths[i]);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateFields(Output output, const char path[])
{
  MPI_Comm        comm      = PetscObjectComm((PetscObject)output->controller);
  PetscInt        interval  = 0;
  FieldsPrecision precision = FIELDS_SINGLE;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, "Output", "Output");
  PetscCall(PetscOptionsInt("-output_fields_interval", "A frame every n controller steps; 0: at most 100 frames", "OutputSetFromOptions",
                            interval, &interval, NULL));
  PetscCall(PetscOptionsEnum("-output_fields_precision", "Of the numbers in the frames", "OutputSetFromOptions", FieldsPrecisions,
                             (PetscEnum)precision, (PetscEnum *)&precision, NULL));
  PetscOptionsEnd();
  PetscCall(FieldsCreate(output->controller, path, interval, precision, &output->fields));
  PetscCall(ControllerMonitorSet(output->controller, FieldsMonitor, output->fields, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateExact(Output output, const char type[])
{
  PetscBool none;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(type, "none", &none));
  if (none) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ExactCreate(output->controller, type, &output->exact));
  PetscCall(ControllerMonitorSet(output->controller, ExactMonitor, output->exact, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetFromOptions - reads what to write and what to compare with, and makes sure that the files can be written

  Collective

  Input Parameter:
. output - the `Output`

  Options Database Keys:
+ -output_history path - HDF5 file with every controller step
. -output_summary path - JSON file with the figures of the run
. -output_fields path  - HDF5 file with fields of all bodies over time; an XDMF file is written beside it
. -output_fields_interval n - a frame every n controller steps; default: as often as makes at most 100 frames
. -output_fields_precision (single|double) - of the numbers in the frames
. -exact (none|impact|characteristics) - exact solution to compare with
- -<body>_exact_displacement ux[,uy,uz] - exact displacement of a body to compare with at the end, functions of x, y, z, t [m]

  Level: beginner

  Note:
  Missing directories of the paths are made. A file that is there already stays until its successor is whole.

.seealso: `Output`, `OutputReport()`, `ExactCreate()`
@*/
PetscErrorCode OutputSetFromOptions(Output output)
{
  MPI_Comm  comm      = PetscObjectComm((PetscObject)output->controller);
  char      exact[64] = "none", history[PETSC_MAX_PATH_LEN] = "", fields[PETSC_MAX_PATH_LEN] = "", xdmf[PETSC_MAX_PATH_LEN] = "";
  PetscBool has_history, has_summary, has_fields;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, "Output", "Output");
  PetscCall(PetscOptionsString("-exact", "Exact solution to compare with (none|impact|characteristics)", "ExactCreate", exact, exact,
                               sizeof(exact), NULL));
  PetscCall(PetscOptionsString("-output_history", "HDF5 file with every controller step", "OutputSetFromOptions", history, history,
                               sizeof(history), &has_history));
  PetscCall(PetscOptionsString("-output_summary", "JSON file with the figures of the run", "OutputSetFromOptions", output->summary,
                               output->summary, sizeof(output->summary), &has_summary));
  PetscCall(PetscOptionsString("-output_fields", "HDF5 file with fields of all bodies over time, an XDMF file beside it",
                               "OutputSetFromOptions", fields, fields, sizeof(fields), &has_fields));
  PetscOptionsEnd();
  if (fields[0]) PetscCall(XdmfGetPath(fields, sizeof(xdmf), xdmf));
  PetscCall(CheckDistinct(comm, 4,
                          (const char *const[]){"-output_history", "-output_summary", "-output_fields", "the XDMF file of -output_fields"},
                          (const char *const[]){history, output->summary, fields, xdmf}));
  PetscCall(CreateExact(output, exact));
  PetscCall(DeviationCreate(output->controller, &output->deviation));
  if (has_summary) PetscCall(OutputFileCheck(comm, "-output_summary", output->summary));
  if (has_history) {
    PetscCall(HistoryCreate(output->controller, history, &output->history));
    PetscCall(ControllerMonitorSet(output->controller, HistoryMonitor, output->history, NULL));
  }
  if (has_fields) PetscCall(CreateFields(output, fields));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputReport - writes what is left to write, and prints the results table

  Collective

  Input Parameter:
. output - the `Output`, after the last controller step

  Level: beginner

.seealso: `Output`, `OutputSetFromOptions()`
@*/
PetscErrorCode OutputReport(Output output)
{
  const StatisticsResults *results;
  PetscViewer              viewer;
  const char              *history, *fields;

  PetscFunctionBegin;
  PetscCall(StatisticsGetResults(output->statistics, &results));
  if (output->deviation) PetscCall(StatisticsSetDeviation(output->statistics, output->deviation));
  if (output->history) PetscCall(HistoryFlush(output->history));
  if (output->fields) PetscCall(FieldsFinish(output->fields));
  if (output->summary[0]) PetscCall(SummaryWrite(output->controller, results, output->exact, output->summary));
  PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)output->controller), &viewer));
  PetscCall(ReportView(output->controller, results, output->exact, viewer));
  if (output->history || output->summary[0] || output->fields) PetscCall(PetscViewerASCIIPrintf(viewer, "files\n"));
  if (output->history) {
    PetscCall(HistoryGetPath(output->history, &history));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "history", history));
  }
  if (output->summary[0]) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "summary", output->summary));
  if (output->fields) {
    PetscCall(FieldsGetPaths(output->fields, NULL, &fields));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "fields", fields));
  }
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
  PetscFunctionBegin;
  if (!*output) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StatisticsDestroy(&(*output)->statistics));
  PetscCall(HistoryDestroy(&(*output)->history));
  PetscCall(FieldsDestroy(&(*output)->fields));
  PetscCall(ExactDestroy(&(*output)->exact));
  PetscCall(DeviationDestroy(&(*output)->deviation));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}
