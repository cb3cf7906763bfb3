/* The program: everything from options, run, report. */
#include <impakt.h>
#include <sys/help.h>

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

static PetscErrorCode Run(void)
{
  Controller     controller;
  Output         output;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(ControllerCreate(PETSC_COMM_WORLD, &controller));
  PetscCall(ControllerSetFromOptions(controller));
  PetscCall(ControllerSetUp(controller));
  PetscCall(OutputCreate(controller, &output));
  PetscCall(OutputSetFromOptions(output));
  PetscCall(CheckOptions(controller));
  PetscCall(ControllerView(controller, PETSC_VIEWER_STDOUT_WORLD));
  error = ControllerSolve(controller);
  if (error) (void)OutputDestroy(&output); /* what was recorded until then helps to find out why */
  PetscCall(error);
  PetscCall(OutputReport(output));
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

int main(int argc, char **argv)
{
  PetscBool      done, asked = PETSC_TRUE;
  const int      n_words = argc;
  PetscErrorCode error   = ImpaktHelp(argc, argv, &done);

  if (error || done) return ImpaktExit(error);
  error = ImpaktInitialize(&argc, &argv);
  if (!error) error = CheckAsked(n_words, &asked);
  if (!error && asked) error = Run();
  if (!error) error = ImpaktFinalize();
  return error || asked ? ImpaktExit(error) : 1;
}
