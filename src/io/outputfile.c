/* Output files are written as `<path>.part` and then renamed to `<path>`, so that a file with that name is always whole. */
#define _POSIX_C_SOURCE 200809L
#include "outputfile.h"
#include "outputpaths.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COPY_BYTES ((size_t)1 << 20) /* copied at a time */
#define MOST_TRIES 3                 /* to write a file that somebody takes away while it is written */

/* Makes the directories that `path` needs; returns errno, or 0 */
static int MakeParents(const char path[])
{
  char directory[PETSC_MAX_PATH_LEN];

  if (strlen(path) >= sizeof(directory)) return ENAMETOOLONG;
  for (size_t i = 1; path[i]; i++) {
    if (path[i] != '/' || path[i - 1] == '/') continue;
    memcpy(directory, path, i);
    directory[i] = '\0';
    if (mkdir(directory, 0777) && errno != EEXIST) return errno;
  }
  return 0;
}

/* Tries whether `part` can be made and renamed to `path`; returns errno, or 0 */
static int TryToWrite(const char path[], const char part[])
{
  struct stat status;
  int         error = MakeParents(part), file;

  if (error) return error;
  if (!stat(path, &status)) {
    if (S_ISDIR(status.st_mode)) return EISDIR;
    if (!S_ISREG(status.st_mode)) return EOPNOTSUPP; /* the rename would replace a device, not write to it */
    if (access(path, W_OK)) return errno;
  }
  file = open(part, O_WRONLY | O_CREAT, 0666);
  if (file < 0) return errno;
  if (close(file) || unlink(part)) return errno;
  return 0;
}

/* The name under which a file is written until it is whole. One rank calls it. */
PetscErrorCode OutputFileGetPart(const char path[], size_t size, char part[])
{
  char   resolved[PETSC_MAX_PATH_LEN];
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(path, &length));
  PetscCheck(length + sizeof(".part") <= size, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The output path '%s' is too long: %zu characters at most", path, size - sizeof(".part"));
  PetscCall(OutputPathResolve(path, sizeof(resolved), resolved));
  PetscCall(PetscStrlen(resolved, &length));
  PetscCheck(length + sizeof(".part") <= size, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The output path '%s', to which '%s' leads, is too long: %zu characters at most", resolved, path, size - sizeof(".part"));
  PetscCall(PetscSNPrintf(part, size, "%s.part", resolved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes sure, before anything is computed, that a file can be written; makes the directories it is to be in. Collective */
PetscErrorCode OutputFileCheck(MPI_Comm comm, const char option[], const char path[])
{
  char        part[PETSC_MAX_PATH_LEN];
  int         error = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCheck(path[0], comm, PETSC_ERR_USER_INPUT, "%s needs the path of the file to write", option);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    PetscCall(OutputFileGetPart(path, sizeof(part), part));
    error = TryToWrite(path, part);
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, comm));
  PetscCheck(!error, comm, PETSC_ERR_FILE_WRITE,
             "%s %s cannot be written: %s; give the path of a file in a directory that you may write to", option, path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies all bytes from one open file to another; returns errno, or 0 */
static int CopyBytes(int from, int to, size_t size, char buffer[])
{
  for (;;) {
    const ssize_t bytes = read(from, buffer, size);

    if (bytes < 0) return errno;
    if (bytes == 0) return 0;
    for (ssize_t done = 0, now; done < bytes; done += now) {
      now = write(to, buffer + done, (size_t)(bytes - done));
      if (now < 0) return errno;
    }
  }
}

/* Makes the folders that a file is to be in, where they are gone or never were */
PetscErrorCode OutputFileMakeParents(const char path[])
{
  const int error = MakeParents(path);

  PetscFunctionBegin;
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "The folder of %s cannot be made: %s", path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* OutputFileRelease - ends what OutputFilePlace() began; -1: nothing is held */
PetscErrorCode OutputFileRelease(int *held)
{
  PetscFunctionBegin;
  if (*held >= 0) close(*held);
  *held = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputFileCopy(int held, const char part[])
{
  char *buffer;
  int   to, error;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(COPY_BYTES, &buffer));
  to    = open(part, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  error = to < 0 || lseek(held, 0, SEEK_SET) < 0 ? errno : CopyBytes(held, to, COPY_BYTES, buffer);
  if (to >= 0 && close(to) && !error) error = errno;
  PetscCall(PetscFree(buffer));
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be written: %s", part, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* OutputFileHold - keeps the contents of a file at hand, as OutputFilePlace() does: for a file that an earlier run has put in its place */
PetscErrorCode OutputFileHold(const char path[], int *held)
{
  PetscFunctionBegin;
  PetscCall(OutputFileRelease(held));
  *held = open(path, O_RDONLY | O_CLOEXEC);
  PetscCheck(*held >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read: %s", path, strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts a whole file in its place, in one step, and keeps its contents at hand even if somebody moves or deletes it then. `held`: what was
   held before, or -1; `NULL`: nothing is to be held. End with OutputFileRelease() */
PetscErrorCode OutputFilePlace(const char part[], const char path[], int *held, PetscBool *placed)
{
  char resolved[PETSC_MAX_PATH_LEN];
  int  file;

  PetscFunctionBegin;
  *placed = PETSC_FALSE;
  PetscCall(OutputPathResolve(path, sizeof(resolved), resolved)); /* else a link would be replaced by the file */
  file = open(part, O_RDONLY | O_CLOEXEC);
  if (file < 0 && errno == ENOENT) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(file >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s, just written by this run, cannot be read: %s", part, strerror(errno));
  if (rename(part, resolved)) {
    const int error = errno;

    close(file);
    if (error == ENOENT) PetscFunctionReturn(PETSC_SUCCESS);
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be renamed to %s: %s", part, path, strerror(error));
  }
  *placed = PETSC_TRUE;
  if (held) {
    PetscCall(OutputFileRelease(held));
    *held = file;
  } else close(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a whole file, and puts it in its place; again where somebody takes it or its folder away meanwhile. `held`: what was held
   before, or -1; `NULL`: nothing is to be held. A `write` that finds that its file has vanished may return before it is done */
PetscErrorCode OutputFileWrite(const char path[], OutputWriteFn *write, void *ctx, int *held)
{
  char      part[PETSC_MAX_PATH_LEN];
  PetscBool placed = PETSC_FALSE;

  PetscFunctionBegin;
  for (int i = 0; i < MOST_TRIES && !placed; i++) {
    PetscErrorCode error;

    PetscCall(OutputFileGetPart(path, sizeof(part), part));
    PetscCall(OutputFileMakeParents(part));
    error = (*write)(part, ctx);
    if (error) (void)remove(part);
    PetscCall(error);
    PetscCall(OutputFilePlace(part, path, held, &placed));
  }
  PetscCheck(placed, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be written: somebody takes it away, or its folder, time and again",
             path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A file that is held, see OutputFileWrite() */
static PetscErrorCode WriteCopy(const char part[], void *ctx)
{
  PetscFunctionBegin;
  PetscCall(OutputFileCopy(*(int *)ctx, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a file again if it is not any more where it was put */
PetscErrorCode OutputFileRestore(int held, const char path[])
{
  struct stat own, there;

  PetscFunctionBegin;
  if (held < 0 || fstat(held, &own)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!stat(path, &there) && there.st_ino == own.st_ino && there.st_dev == own.st_dev) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OutputFileWrite(path, WriteCopy, &held, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Has the contents of a file written through to the disk */
PetscErrorCode OutputFileSync(int file, const char path[])
{
  PetscFunctionBegin;
  if (file < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(!fsync(file) || errno == EINVAL || errno == EROFS, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s cannot be written: %s", path,
             strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Has the names in the folder of a file written through to the disk, where the file system can */
PetscErrorCode OutputFileSyncFolder(const char path[])
{
  char  folder[PETSC_MAX_PATH_LEN];
  char *slash;
  int   file;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(folder, path, sizeof(folder)));
  slash = strrchr(folder, '/');
  if (slash == folder) slash++;
  if (slash) *slash = '\0';
  file = open(slash ? folder : ".", O_RDONLY | O_CLOEXEC);
  if (file < 0) PetscFunctionReturn(PETSC_SUCCESS);
  (void)fsync(file);
  close(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes an error of the first rank, which has printed it, an error of all ranks. Collective */
PetscErrorCode OutputFileShareError(MPI_Comm comm, PetscErrorCode error, const char option[], const char path[], const char what[])
{
  PetscMPIInt rank, code = (PetscMPIInt)error;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, 0, comm));
  if (!rank) PetscCall(error);
  PetscCheck(!code, comm, (PetscErrorCode)code, "%s %s: the first rank cannot %s it", option, path, what);
  PetscFunctionReturn(PETSC_SUCCESS);
}
