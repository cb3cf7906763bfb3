/* The program: everything from options, run, report. */
#include <impakt.h>

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
  PetscBool      list = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-help_options", &list, NULL));
  if (list) {
    PetscCall(ImpaktPrintOptions());
    PetscFunctionReturn(PETSC_SUCCESS);
  }
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

int main(int argc, char **argv)
{
  PetscErrorCode error = ImpaktInitialize(&argc, &argv);

  if (!error) error = Run();
  if (!error) error = ImpaktFinalize();
  return ImpaktExit(error);
}
