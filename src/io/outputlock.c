/* Locks on outputs, which keep a second run away while this one lives.

   Beside an output lies <path>.lock, locked in the kernel, so that the lock ends with the process however that ends. */
#define _DEFAULT_SOURCE /* flock() */
#include "outputlock.h"
#include "outputimpl.h"
#include "outputfile.h"
#include "outputpaths.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Opens and locks a file; returns errno, EWOULDBLOCK if somebody else has the lock, or 0 */
static int LockFile(const char path[], int *file)
{
  for (;;) {
    struct stat held, there;
    int         error = 0;

    *file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (*file < 0) return errno;
    if (flock(*file, LOCK_EX | LOCK_NB)) error = errno;
    /* whoever held the lock before may have removed the file after it was opened here */
    if (!error && !fstat(*file, &held) && !stat(path, &there) && held.st_ino == there.st_ino && held.st_dev == there.st_dev) return 0;
    if (error == EWOULDBLOCK) return error; /* open, to be read */
    close(*file);
    *file = -1;
    if (error) return error;
  }
}

static void Sign(int file)
{
  char text[64], host[32] = "";

  if (gethostname(host, sizeof(host) - 1)) host[0] = 0;
  snprintf(text, sizeof(text), "process %ld on %s\n", (long)getpid(), host);
  if (ftruncate(file, 0) || write(file, text, strlen(text)) < 0) return; /* a courtesy */
}

static void ReadHolder(int file, size_t size, char holder[])
{
  const ssize_t bytes = pread(file, holder, size - 1, 0);

  holder[bytes > 0 ? bytes : 0] = 0;
  holder[strcspn(holder, "\n")] = 0;
}

/* Keeps other runs from writing to a path; an error if one does now. Where the file system has no locks, none is taken. Collective */
static PetscErrorCode TakeLock(MPI_Comm comm, OutputLocks *locks, const char option[], const char path[])
{
  char        holder[64] = "", resolved[PETSC_MAX_PATH_LEN];
  int         error      = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCheck(locks->n < OUTPUT_LOCKS, comm, PETSC_ERR_PLIB, "There are more outputs than locks");
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    int file;

    PetscCall(OutputFileMakeParents(path)); /* which may be gone since they were checked */
    PetscCall(OutputPathResolve(path, sizeof(resolved), resolved));
    PetscCall(PetscSNPrintf(locks->path[locks->n], sizeof(locks->path[0]), "%s.lock", resolved));
    error = LockFile(locks->path[locks->n], &file);
    if (!error) {
      Sign(file);
      locks->file[locks->n++] = file;
    } else if (error == EWOULDBLOCK) {
      ReadHolder(file, sizeof(holder), holder);
      close(file);
    }
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, comm));
  PetscCheck(error != EWOULDBLOCK, comm, PETSC_ERR_FILE_WRITE,
             "%s %s is being written by another run%s%s%s: give each run a path of its own, or wait", option, path, holder[0] ? " (" : "",
             holder, holder[0] ? ")" : "");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* OutputLocksRelease - lets others write to the paths; not Collective */
PetscErrorCode OutputLocksRelease(OutputLocks *locks)
{
  PetscFunctionBegin;
  for (int i = 0; i < locks->n; i++) {
    (void)remove(locks->path[i]); /* before the lock ends, so that nobody removes what another has locked */
    close(locks->file[i]);
  }
  locks->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputLock(Output output)
{
  MPI_Comm          comm      = PetscObjectComm((PetscObject)output);
  const char *const options[] = {"-output_history", "-output_summary", "-output_fields", "-checkpoint"};
  const char *const paths[]   = {output->history_path, output->summary_path, output->fields_path, output->checkpoints.path};

  PetscFunctionBegin;
  if (output->locked) PetscFunctionReturn(PETSC_SUCCESS);
  output->locked = PETSC_TRUE;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(paths); i++)
    if (paths[i][0]) PetscCall(TakeLock(comm, &output->locks, options[i], paths[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
