/* A failed step: its reason and its message, until they become an error or the step is made again. */
#include <impakt/private/stepfailure.h>
#include <stdarg.h>

/* A step begins */
void StepFailureClear(StepFailure *failure)
{
  failure->reason = STEP_CONVERGED;
}

/* What a body could not do, its contact could not do either; the first failure stays */
void StepFailureCopy(const StepFailure *from, StepFailure *to)
{
  if (from->reason < 0 && to->reason >= 0) *to = *from;
}

/* Notes why a step could not be made; the first failure stays. All ranks that share the step must call this. */
PetscErrorCode StepFailureSet(StepFailure *failure, StepConvergedReason reason, PetscErrorCode code, const char format[], ...)
{
  va_list arguments;

  PetscFunctionBegin;
  if (failure->reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  failure->reason = reason;
  failure->code   = code;
  va_start(arguments, format);
  PetscCall(PetscVSNPrintf(failure->message, sizeof(failure->message), format, NULL, arguments));
  va_end(arguments);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error where a step has failed */
PetscErrorCode StepFailureRaise(MPI_Comm comm, const StepFailure *failure)
{
  PetscFunctionBegin;
  PetscCheck(failure->reason >= 0, comm, failure->code, "%s", failure->message);
  PetscFunctionReturn(PETSC_SUCCESS);
}
