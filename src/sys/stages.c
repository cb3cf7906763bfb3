/* Stages of a run for -log_view. */
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

/* Begins a stage if anything is logged: stages take 5 % of steps of small bodies. `logged` is for StageEnd(): it may change. */
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
