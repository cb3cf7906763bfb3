/* Stages of a run for -log_view, and the same as a table at its end. */
#include <petscviewer.h>
#include "stages.h"

static const char *const names[N_STAGES] = {"Set-up", "Search", "Rows", "Sweeps", "Interface", "Output"};

/* Numbers that PETSc has given to the stages, as events have them */
static PetscLogStage stages[N_STAGES];
static PetscBool     StagesInitialized = PETSC_FALSE;

static PetscErrorCode Finalize(void)
{
  PetscFunctionBegin;
  StagesInitialized = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Calls beyond the first do nothing. A stage that another library has registered under the same name is that one. */
PetscErrorCode StagesInitialize(void)
{
  PetscFunctionBegin;
  if (StagesInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt s = 0; s < N_STAGES; s++) {
    PetscCall(PetscLogStageGetId(names[s], &stages[s]));
    if (stages[s] < 0) PetscCall(PetscLogStageRegister(names[s], &stages[s]));
  }
  StagesInitialized = PETSC_TRUE;
  PetscCall(PetscRegisterFinalize(Finalize));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Begins a stage where anything is logged: steps of small bodies take microseconds, of which stages would be 5 %. `logged` is for
   StageEnd(), since logging may begin or end in between. */
PetscErrorCode StageBegin(Stage stage, PetscBool *logged)
{
  PetscFunctionBegin;
  PetscCall(PetscLogIsActive(logged));
  if (!*logged) PetscFunctionReturn(PETSC_SUCCESS);
  if (!StagesInitialized) PetscCall(StagesInitialize());
  PetscCall(PetscLogStagePush(stages[stage]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StageEnd(PetscBool logged)
{
  PetscFunctionBegin;
  if (logged) PetscCall(PetscLogStagePop());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Time of the slowest rank in each stage and the operations of all ranks, where they are logged (-log_view); else nothing */
PetscErrorCode StagesView(MPI_Comm comm, PetscViewer viewer)
{
  PetscLogHandler handler;
  double          seconds[N_STAGES], operations[N_STAGES], total = 0;

  PetscFunctionBegin;
  PetscCall(PetscLogGetDefaultHandler(&handler));
  if (!handler || !StagesInitialized) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt s = 0; s < N_STAGES; s++) {
    PetscEventPerfInfo info;

    PetscCall(PetscLogStageGetPerfInfo(stages[s], &info));
    seconds[s]    = (double)info.time;
    operations[s] = (double)info.flops;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, seconds, N_STAGES, MPI_DOUBLE, MPI_MAX, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, operations, N_STAGES, MPI_DOUBLE, MPI_SUM, comm));
  for (PetscInt s = 0; s < N_STAGES; s++) total += seconds[s];
  PetscCall(PetscViewerASCIIPrintf(viewer, "stages\n"));
  for (PetscInt s = 0; s < N_STAGES; s++)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %-32s %13.6g s    %5.1f %%  %.3g GFLOP\n", names[s], seconds[s],
                                     total > 0 ? 100 * seconds[s] / total : 0., 1e-9 * operations[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
