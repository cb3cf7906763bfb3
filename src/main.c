/* The program: everything from options, run, report. */
#include <impakt.h>
#include <io/stopsignals.h>
#include <sys/commandline.h>
#include <sys/example.h>
#include <sys/help.h>
#include <sys/optionvalues.h>

static PetscErrorCode CheckOptions(Controller controller)
{
  const Body  *bodies;
  const char **names;
  PetscInt     n;

  PetscFunctionBegin;
  PetscCall(ControllerGetBodies(controller, &n, &bodies));
  PetscCall(PetscMalloc1(n, &names));
  for (PetscInt b = 0; b < n; b++) PetscCall(PetscObjectGetName((PetscObject)bodies[b], &names[b]));
  PetscCall(ImpaktCheckOptions(n, names));
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `stopped`: before its end, by a signal or by -max_wall_time */
static PetscErrorCode Run(PetscBool *stopped)
{
  Controller     controller;
  Output         output;
  PetscBool      checks;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerSetFromOptions(controller));
  PetscCall(ControllerSetUp(controller));
  PetscCall(OutputCreate(controller, &output));
  PetscCall(OutputCatchSignals(output)); /* before there are files and their locks, which signals of the set-up would leave */
  PetscCall(OutputSetFromOptions(output));
  PetscCall(CheckOptions(controller));
  PetscCall(OutputRestart(output));
  PetscCall(ControllerView(controller, PETSC_VIEWER_STDOUT_WORLD));
  PetscCall(OutputGetCheck(output, &checks));
  error = checks ? OutputCheck(output) : ControllerSolve(controller);
  if (!error && !checks) error = OutputReport(output);
  if (error) (void)OutputDestroy(&output); /* what was recorded until then helps to find out why */
  PetscCall(error);
  PetscCall(OutputIsStopped(output, stopped));
  PetscCall(OutputDestroy(&output));
  PetscCall(ControllerDestroy(&controller));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without a word on the command line, and without bodies from a file or variable that PETSC reads by itself, there is nothing to run */
static PetscErrorCode CheckAsked(int argc, PetscBool *asked)
{
  PetscFunctionBegin;
  *asked = (PetscBool)(argc > 1);
  if (!*asked) PetscCall(PetscOptionsHasName(NULL, NULL, "-bodies", asked));
  if (!*asked) PetscCall(ImpaktPrintUsage(stderr));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Starts PETSc with the words of the command line, or with none where these are wrong */
static PetscErrorCode Start(CommandLine *line)
{
  int    required = MPI_THREAD_FUNNELED, provided, n = line->n;
  char **words = line->words;

  /* PetscFunctionBegin would need PETSc */
  if (MPI_Init_thread(&n, &words, required, &provided)) return PETSC_ERR_MPI;
  PetscCall(CommandLineCheckFiles(line));
  if (line->error[0]) n = 1;
  PetscCall(ImpaktInitialize(&n, &words));
  PetscCheck(!line->error[0], PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT, "%s", line->error);
  StopSignalsBegin(PetscGlobalRank, PetscGlobalSize);
  PetscCall(CommandLineInsert(line));
  PetscCall(OptionsCheckValues());
  return PETSC_SUCCESS;
}

int main(int argc, char **argv)
{
  PetscBool      done, asked = PETSC_TRUE, stopped = PETSC_FALSE;
  CommandLine    line  = {.words = NULL};
  PetscErrorCode error = ImpaktHelp(argc, argv, &done);

  if (!error && !done) error = ImpaktExample(argc, argv, &done);
  if (error || done) return ImpaktExit(error);
  error = CommandLineCreate(argc, argv, &line);
  if (!error) error = Start(&line);
  if (!error) error = CheckAsked(argc, &asked);
  if (!error && asked) error = Run(&stopped);
  if (!error) error = ImpaktFinalize();
  if (!error) (void)MPI_Finalize(); /* whoever starts MPI ends it */
  CommandLineDestroy(&line);
  if (!error && stopped) return IMPAKT_STOPPED;
  return error || asked ? ImpaktExit(error) : 1;
}
