/* How errors reach the user of the program, and the exit code that goes with them. */
#include <impakt.h>
#include <string.h>
#include <unistd.h>
#include "errors.h"
#include "optionvalues.h"
#include "sharedoptions.h"
#include "statusline.h"

/* Errors whose message says all that the user can do about them: those too that PETSc has with the words of an option */
static PetscBool IsUsersBusiness(const char *function, PetscErrorCode code)
{
  if (function && strncmp(function, "PetscOptions", strlen("PetscOptions")) == 0 && code != PETSC_ERR_PLIB && code != PETSC_ERR_MEM)
    return PETSC_TRUE;
  switch (code) {
  case PETSC_ERR_USER_INPUT:
  case PETSC_ERR_ARG_UNKNOWN_TYPE:
  case PETSC_ERR_NOT_CONVERGED:
  case PETSC_ERR_MAT_LU_ZRPVT:
  case PETSC_ERR_FILE_OPEN:
  case PETSC_ERR_FILE_WRITE:
  case PETSC_ERR_FILE_UNEXPECTED:
  case PETSC_ERR_FP:
    return PETSC_TRUE;
  default:
    return PETSC_FALSE;
  }
}

/* One line to the user in place of PETSc's stack trace; for what is not the user's fault, with the place in the source too */
PetscErrorCode ImpaktReportError(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code, PetscErrorType type,
                                 const char *message, void *ctx)
{
  PetscMPIInt rank = 0, size = 1, initialized = 0;
  char        text[4096], shared[2048] = "";
  PetscBool   explained = PETSC_FALSE, running = PETSC_FALSE;

  (void)ctx;
  if (type != PETSC_ERROR_INITIAL) return code;
  StatusLineEnd();
  if (function && message && OptionsExplain(function, code, message, text, sizeof(text), &explained)) explained = PETSC_FALSE;
  if (explained) { /* all ranks read the same options */
    message = text;
    comm    = PETSC_COMM_WORLD;
  }
  if (!explained && message && code == PETSC_ERR_MAT_LU_ZRPVT && strncmp(message, "Zero pivot", strlen("Zero pivot")) == 0) {
    snprintf(text, sizeof(text),
             "The matrix of a body is singular to round-off (%.200s): check units, -time_step and the constants of materials", message);
    message = text;
  }
  MPI_Initialized(&initialized);
  if (initialized && comm != MPI_COMM_NULL && comm != MPI_COMM_SELF) MPI_Comm_rank(comm, &rank);
  if (initialized && comm == MPI_COMM_SELF) MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (rank) return code;
  if (!message || PetscInitialized(&running) || !running || OptionsExplainShared(message, shared, sizeof(shared))) shared[0] = 0;
  if (size > 1) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    fprintf(stderr, "impakt: error on rank %d: %s%s%s\n", rank, message ? message : "", shared[0] ? "; here " : "", shared);
  } else fprintf(stderr, "impakt: error: %s%s%s\n", message ? message : "", shared[0] ? "; here " : "", shared);
  if (!explained && !IsUsersBusiness(function, code))
    fprintf(stderr, "impakt: in %s() at %s:%d, PETSc error %d\n", function, file, line, (int)code);
  (void)fflush(stderr);
  return code;
}

/*@
  ImpaktExit - ends the program with an exit code, on all ranks even where an error came up on one alone

  Not Collective

  Input Parameter:
. error - 0, or the error that stopped the program

  Level: developer

  Note:
  The error has been printed when it came up.

.seealso: `ImpaktInitialize()`
@*/
int ImpaktExit(PetscErrorCode error)
{
  PetscMPIInt initialized, finalized, size = 1, rank = 0;

  if (!error) return 0;
  if (MPI_Initialized(&initialized) || !initialized) return (int)error;
  if (MPI_Finalized(&finalized) || finalized) return (int)error;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (size == 1) return (int)error;
  /* an error on all ranks is printed by the first: let it speak before the others end the job */
  if (rank) sleep(1);
  MPI_Abort(MPI_COMM_WORLD, (int)error);
  return (int)error;
}
