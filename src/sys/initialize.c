/* Start and end of the library: the packages of its classes. */
#define _POSIX_C_SOURCE 200809L /* setenv() */
#include <impakt.h>
#include <hdf5.h>
#include <stdlib.h>
#include "errors.h"
#include "petsccompat.h"
#include <impakt/private/elementimpl.h>
#include <impakt/private/transfer.h>
#include <sys/stages.h>

static const char help[] = "Impakt: dynamic contact by the Schwarz alternating method; `impakt -help` on the command line tells more.\n";

/* Between ImpaktInitialize() and ImpaktFinalize() */
static struct {
  PetscInt  depth;       /* calls of ImpaktInitialize() not yet undone by ImpaktFinalize() */
  PetscBool began_petsc; /* the first of them has started PETSc */
} library = {0, PETSC_FALSE};

/* Every class registers itself when it is first used. All are registered at the start so that the order of classes and events, and with it
   that of -log_view, does not hang on what a program does first. */
static PetscErrorCode RegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(BodyInitializePackage());
  PetscCall(MaterialInitializePackage());
  PetscCall(ElementInitializePackage());
  PetscCall(ExpressionInitializePackage());
  PetscCall(ObstacleInitializePackage());
  PetscCall(InterfaceInitializePackage());
  PetscCall(ContactInitializePackage());
  PetscCall(ControllerInitializePackage());
  PetscCall(ExactInitializePackage());
  PetscCall(OutputInitializePackage());
  PetscCall(StagesInitialize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PetscFinalize() calls this: whoever started PETSc, nothing of Impakt outlives it */
static PetscErrorCode Forget(void)
{
  PetscFunctionBegin;
  library.depth       = 0;
  library.began_petsc = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ImpaktInitialize - starts Impakt, and PETSc where it does not run yet

  Collective on `PETSC_COMM_WORLD`

  Input Parameters:
+ argc - of main(), or `NULL`
- argv - of main(), or `NULL`

  Level: beginner

  Notes:
  In a program that has called `PetscInitialize()` itself, PETSc stays as that program has set it up: its options database is used as
  it is (`argc` and `argv` are not looked at), its error handler stays. Otherwise PETSc is started with the arguments, and errors are
  printed as one line to the user.

  Calls may be nested: each wants a call of `ImpaktFinalize()`, of which the last one ends what the first call began. After that the
  library may be started again. (MPI itself cannot: a program that starts and ends PETSc repeatedly has to call `MPI_Init()` first.)

.seealso: `ImpaktFinalize()`, `ImpaktInitialized()`, `ImpaktExit()`
@*/
PetscErrorCode ImpaktInitialize(int *argc, char ***argv)
{
  PetscBool running, began = PETSC_FALSE;

  PetscFunctionBegin;
  if (library.depth > 0) {
    library.depth++;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscInitialized(&running));
  if (!running) {
    PetscCall(PetscPushErrorHandler(ImpaktReportError, NULL)); /* first, for what is wrong with the options file */
    (void)H5dont_atexit(); /* at exit HDF5 would try to finish a file that a full disk has left unfinished, and crash */
    /* with threads SCOTCH divides a mesh by how busy cores are, and a run could not be continued bit for bit */
    (void)setenv("SCOTCH_PTHREAD_NUMBER", "1", 0);
    PetscCall(PetscInitialize(argc, argv, NULL, help));
    began = PETSC_TRUE;
  }
  PetscCall(RegisterAll());
  PetscCall(PetscRegisterFinalize(Forget));
  library.depth       = 1;
  library.began_petsc = began;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ImpaktInitialized - whether Impakt has been started, and not ended

  Not Collective

  Output Parameter:
. initialized - `PETSC_TRUE` between `ImpaktInitialize()` and the `ImpaktFinalize()` that belongs to it

  Level: beginner

.seealso: `ImpaktInitialize()`, `ImpaktFinalize()`
@*/
PetscErrorCode ImpaktInitialized(PetscBool *initialized)
{
  PetscFunctionBegin;
  PetscAssertPointer(initialized, 1);
  *initialized = (PetscBool)(library.depth > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ImpaktFinalize - ends what `ImpaktInitialize()` began

  Collective on `PETSC_COMM_WORLD`

  Level: beginner

  Notes:
  `PetscFinalize()` is called only where `ImpaktInitialize()` has called `PetscInitialize()`. A program that has started PETSc itself
  ends it itself, before or after this call; all memory of Impakt's registries is freed then.

.seealso: `ImpaktInitialize()`
@*/
PetscErrorCode ImpaktFinalize(void)
{
  PetscBool ended;

  PetscFunctionBegin;
  if (library.depth == 0) {
    PetscCall(PetscFinalized(&ended));
    PetscCheck(ended, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "ImpaktFinalize() without ImpaktInitialize(): call that first");
    PetscFunctionReturn(PETSC_SUCCESS); /* ended by the program's own PetscFinalize() */
  }
  if (--library.depth > 0 || !library.began_petsc) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFinalize());
  (void)PetscPopErrorHandler();
  /* PetscFunctionReturn() would need PETSc */
  return PETSC_SUCCESS;
}

/*@C
  ImpaktGetVersion - the version of the library as text

  Not Collective

  Input Parameter:
. length - room in `version`, 64 are enough

  Output Parameter:
. version - as in "Impakt 0.1.0"

  Level: beginner

  Note:
  The macros `IMPAKT_VERSION`, `IMPAKT_VERSION_MAJOR`, `IMPAKT_VERSION_GE()`, ... tell the version of the headers.

.seealso: `ImpaktInitialize()`
@*/
PetscErrorCode ImpaktGetVersion(char version[], size_t length)
{
  PetscFunctionBegin;
  PetscAssertPointer(version, 1);
  PetscCall(PetscSNPrintf(version, length, "Impakt %s", IMPAKT_VERSION));
  PetscFunctionReturn(PETSC_SUCCESS);
}
