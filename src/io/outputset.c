/* What a program asks of the output beside its options. */
#include "outputimpl.h"
#include "outputfile.h"
#include "outputpaths.h"
#include "xdmf.h"

/* Each file has a path of its own, and is none that the run reads; empty: it is not written */
PetscErrorCode OutputCheckPaths(MPI_Comm comm, const char summary[], const char history[], const char fields[], const char checkpoint[])
{
  const char *const options[5] = {"-output_history", "-output_summary", "-output_fields", "the XDMF file of -output_fields", "-checkpoint"};
  char              xdmf[PETSC_MAX_PATH_LEN] = "";
  const char *const paths[5]                 = {history, summary, fields, xdmf, checkpoint};

  PetscFunctionBegin;
  if (fields[0]) PetscCall(XdmfGetPath(fields, XDMF_BODIES, sizeof(xdmf), xdmf));
  PetscCall(OutputPathsCheck(comm, 5, options, paths));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetExact - compares the run with an exact solution

  Collective

  Input Parameters:
+ output - the `Output`, before the first controller step
- type   - its name, see `ExactType`

  Options Database Key:
. -exact (none|impact|characteristics) - the solution

  Level: beginner

.seealso: `Output`, `ExactType`
@*/
PetscErrorCode OutputSetExact(Output output, ExactType type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscCheck(!output->exact, PetscObjectComm((PetscObject)output), PETSC_ERR_ARG_WRONGSTATE, "The run is compared with a solution already");
  PetscCall(ExactCreate(output->controller, type, &output->exact));
  PetscCall(ControllerMonitorSet(output->controller, ExactMonitor, output->exact, NULL));
  PetscCall(PetscObjectViewFromOptions((PetscObject)output->exact, (PetscObject)output, "-exact_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetExactDisplacement - compares the displacement of a body at the end with formulas

  Collective

  Input Parameters:
+ output     - the `Output`
. body       - one of the controller's
- components - for each dimension an expression in x, y, z, t [m], with commas between them

  Options Database Key:
. -<body>_exact_displacement ux[,uy,uz] - the formulas

  Level: intermediate

.seealso: `Output`, `OutputSetExact()`
@*/
PetscErrorCode OutputSetExactDisplacement(Output output, Body body, const char components[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)output);
  char        option[256];
  const char *prefix;
  const Body *bodies;
  PetscInt    n, dim, b = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscValidHeaderSpecific(body, BODY_CLASSID, 2);
  PetscAssertPointer(components, 3);
  PetscCall(ControllerGetBodies(output->controller, &n, &bodies));
  while (b < n && bodies[b] != body) b++;
  PetscCheck(b < n, comm, PETSC_ERR_ARG_WRONG, "Body '%s' is none of the controller's", ((PetscObject)body)->name);
  PetscCall(PetscObjectGetOptionsPrefix((PetscObject)body, &prefix));
  PetscCall(PetscSNPrintf(option, sizeof(option), "%sexact_displacement", prefix));
  PetscCall(BodyGetDimension(body, &dim));
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&output->displacements[3 * b + d]));
  PetscCall(ExpressionListCreate(comm, option, components, dim, PETSC_FALSE, output->displacements + 3 * b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetCheck - looks at the start of a run alone

  Logically Collective

  Input Parameters:
+ output - the `Output`, before it has been told what to write
- checks - `PETSC_TRUE`: of all files the fields alone are to be written, with one frame; the program calls `OutputCheck()`

  Options Database Key:
. -check (true|false) - whether

  Level: beginner

.seealso: `Output`, `OutputCheck()`, `OutputGetCheck()`
@*/
PetscErrorCode OutputSetCheck(Output output, PetscBool checks)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscValidLogicalCollectiveBool(output, checks, 2);
  PetscCheck(!checks || (!output->history && !output->summary_path[0] && !output->fields), PetscObjectComm((PetscObject)output),
             PETSC_ERR_ARG_WRONGSTATE, "Call OutputSetCheck() before functions that say what is to be written");
  output->checks = checks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputGetCheck - whether the start of the run is looked at alone

  Not Collective

  Input Parameter:
. output - the `Output`

  Output Parameter:
. checks - as given to `OutputSetCheck()`

  Level: beginner

.seealso: `Output`, `OutputSetCheck()`
@*/
PetscErrorCode OutputGetCheck(Output output, PetscBool *checks)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(checks, 2);
  *checks = output->checks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetSummary - writes the figures of the run to a file

  Collective

  Input Parameters:
+ output - the `Output`
- path   - JSON file; missing directories are made

  Options Database Key:
. -output_summary path - the file

  Level: beginner

  Note:
  The file is written by `OutputReport()`.

.seealso: `Output`, `OutputSetHistory()`, `OutputSetFields()`
@*/
PetscErrorCode OutputSetSummary(Output output, const char path[])
{
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  comm = PetscObjectComm((PetscObject)output);
  PetscCall(OutputCheckPaths(comm, path, output->history_path, output->fields_path, output->checkpoints.path));
  PetscCall(OutputFileCheck(comm, "-output_summary", path));
  PetscCall(PetscStrncpy(output->summary_path, path, sizeof(output->summary_path)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetHistory - writes every controller step to a file

  Collective

  Input Parameters:
+ output - the `Output`, before the first controller step
- path   - HDF5 file; missing directories are made

  Options Database Key:
. -output_history path - the file

  Level: beginner

.seealso: `Output`, `OutputSetSummary()`, `OutputSetFields()`
@*/
PetscErrorCode OutputSetHistory(Output output, const char path[])
{
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  comm = PetscObjectComm((PetscObject)output);
  PetscCheck(!output->history, comm, PETSC_ERR_ARG_WRONGSTATE, "The history is written to %s already", output->history_path);
  PetscCall(OutputCheckPaths(comm, output->summary_path, path, output->fields_path, output->checkpoints.path));
  PetscCall(HistoryCreate(output->controller, path, &output->history));
  PetscCall(ControllerMonitorSet(output->controller, HistoryMonitor, output->history, NULL));
  PetscCall(PetscStrncpy(output->history_path, path, sizeof(output->history_path)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  OutputSetFields - writes the fields of all bodies to a file

  Collective

  Input Parameters:
+ output    - the `Output`, before the first controller step
. path      - HDF5 file; an XDMF file is written beside it; missing directories are made
. interval  - a frame every so many controller steps, and at the end; 0: at most 100 frames
- precision - of the numbers in the frames

  Options Database Keys:
+ -output_fields path                        - the file
. -output_fields_interval n                  - the interval
- -output_fields_precision (single|double) - the precision

  Level: beginner

.seealso: `Output`, `OutputPrecision`, `OutputSetHistory()`, `OutputSetSummary()`
@*/
PetscErrorCode OutputSetFields(Output output, const char path[], PetscInt interval, OutputPrecision precision)
{
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(output, OUTPUT_CLASSID, 1);
  PetscAssertPointer(path, 2);
  PetscValidLogicalCollectiveInt(output, interval, 3);
  PetscValidLogicalCollectiveEnum(output, precision, 4);
  comm = PetscObjectComm((PetscObject)output);
  PetscCheck(!output->fields, comm, PETSC_ERR_ARG_WRONGSTATE, "The fields are written to %s already", output->fields_path);
  PetscCall(OutputCheckPaths(comm, output->summary_path, output->history_path, path, output->checkpoints.path));
  PetscCall(FieldsCreate(output->controller, path, &interval, precision, &output->fields));
  if (output->checks) FieldsKeepFirst(output->fields);
  PetscCall(ControllerMonitorSet(output->controller, FieldsMonitor, output->fields, NULL));
  PetscCall(StatisticsSetFrames(output->statistics, interval));
  PetscCall(PetscStrncpy(output->fields_path, path, sizeof(output->fields_path)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
