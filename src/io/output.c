/* What a run writes and prints, from its options. */
#include <io.h>
#include <exact.h>
#include "deviation.h"
#include "history.h"
#include "outputfile.h"
#include "report.h"
#include "summary.h"

struct _n_Output {
  Controller controller; /* borrowed */
  Statistics statistics;
  History    history;
  Exact      exact;
  Deviation  deviation;
  char       summary[PETSC_MAX_PATH_LEN]; /* its path; empty: none */
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
. -exact (none|impact|characteristics) - exact solution to compare with
- -<body>_exact_displacement ux[,uy,uz] - exact displacement of a body to compare with at the end, functions of x, y, z, t [m]

  Level: beginner

  Note:
  Missing directories of the paths are made. What is at the paths stays until there is something new to put there.

.seealso: `Output`, `OutputReport()`, `ExactCreate()`
@*/
PetscErrorCode OutputSetFromOptions(Output output)
{
  MPI_Comm  comm      = PetscObjectComm((PetscObject)output->controller);
  char      exact[64] = "none", history[PETSC_MAX_PATH_LEN] = "";
  PetscBool has_history, has_summary, same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, "Output", "Output");
  PetscCall(PetscOptionsString("-exact", "Exact solution to compare with (none|impact|characteristics)", "ExactCreate", exact, exact, sizeof(exact), NULL));
  PetscCall(PetscOptionsString("-output_history", "HDF5 file with every controller step", "OutputSetFromOptions", history, history, sizeof(history), &has_history));
  PetscCall(PetscOptionsString("-output_summary", "JSON file with the figures of the run", "OutputSetFromOptions", output->summary, output->summary, sizeof(output->summary), &has_summary));
  PetscOptionsEnd();
  if (has_history && has_summary) PetscCall(PetscStrcmp(history, output->summary, &same));
  PetscCheck(!same, comm, PETSC_ERR_USER_INPUT, "-output_history and -output_summary are the same file, %s; give each its own", history);
  PetscCall(CreateExact(output, exact));
  PetscCall(DeviationCreate(output->controller, &output->deviation));
  if (has_summary) PetscCall(OutputFileCheck(comm, "-output_summary", output->summary));
  if (has_history) {
    PetscCall(HistoryCreate(output->controller, history, &output->history));
    PetscCall(ControllerMonitorSet(output->controller, HistoryMonitor, output->history, NULL));
  }
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
  const char              *history;

  PetscFunctionBegin;
  PetscCall(StatisticsGetResults(output->statistics, &results));
  if (output->deviation) PetscCall(StatisticsSetDeviation(output->statistics, output->deviation));
  if (output->history) PetscCall(HistoryFlush(output->history));
  if (output->summary[0]) PetscCall(SummaryWrite(output->controller, results, output->exact, output->summary));
  PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)output->controller), &viewer));
  PetscCall(ReportView(output->controller, results, output->exact, viewer));
  if (output->history || output->summary[0]) PetscCall(PetscViewerASCIIPrintf(viewer, "files\n"));
  if (output->history) {
    PetscCall(HistoryGetPath(output->history, &history));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "history", history));
  }
  if (output->summary[0]) PetscCall(PetscViewerASCIIPrintf(viewer, "  %-20s %s\n", "summary", output->summary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputDestroy - frees the output, after writing what the history still holds

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
  PetscCall(ExactDestroy(&(*output)->exact));
  PetscCall(DeviationDestroy(&(*output)->deviation));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}
