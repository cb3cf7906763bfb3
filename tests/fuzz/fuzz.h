/* What the fuzz targets share; each is one program. A target hands bytes to one reader of Impakt's, which may refuse them but must not
   break: it defines LLVMFuzzerTestOneInput(), which libFuzzer calls (`make fuzz`), or replay.c with files (`make test`). */
#pragma once
#include <impakt.h>
#include <petsc/private/petscimpl.h>
#include <signal.h>
#include <stdint.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size);

/* Errors are what is expected: they are not printed. */
static inline PetscErrorCode FuzzIgnore(MPI_Comm comm, int line, const char function[], const char file[], PetscErrorCode code,
                                        PetscErrorType type, const char message[], void *ctx)
{
  (void)comm, (void)line, (void)function, (void)file, (void)type, (void)message, (void)ctx;
  return code;
}

/* Starts Impakt, before libFuzzer installs its signal handlers, and without the words of its command line */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  const int   fatal[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};
  static char name[] = "fuzz", *words[] = {name, NULL};
  int         n   = 1;
  char      **own = words;

  (void)argc, (void)argv;
  if (ImpaktInitialize(&n, &own) || PetscPopSignalHandler() || PetscPushErrorHandler(FuzzIgnore, NULL)) abort();
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(fatal); i++) (void)signal(fatal[i], SIG_DFL); /* MPI has handlers too */
  return 0;
}

/* Writes the bytes to a file of this process, and tells its path */
static inline void FuzzWrite(const uint8_t data[], size_t size, const char extension[], char path[], size_t length)
{
  FILE *file;

  (void)snprintf(path, length, "/dev/shm/impakt-fuzz-%d%s", (int)getpid(), extension);
  file = fopen(path, "wb");
  if (!file || fwrite(data, 1, size, file) != size || fclose(file)) abort();
}

/* An error leaves what PETSc has made until then: that is allowed, since the program ends with it */
#define FUZZ_IGNORE(call) ((void)(call))
