/* Which files the paths of outputs stand for: through symbolic links, and compared with each other and with what the run reads. */
#define _DEFAULT_SOURCE /* realpath(), readlink() */
#include "outputpaths.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <sys/optionsfiles.h>

enum { MOST_LINKS = 40 };

/* The folder of a path with its last slash, or nothing */
static size_t FolderLength(const char path[])
{
  const char *slash = strrchr(path, '/');

  return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The path of the file itself where a path is a symbolic link: what is written goes through the link. One rank calls it. */
PetscErrorCode OutputPathResolve(const char path[], size_t size, char resolved[])
{
  char target[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(resolved, path, size));
  for (int i = 0; i < MOST_LINKS; i++) {
    const ssize_t length = readlink(resolved, target, sizeof(target) - 1);
    const size_t  folder = FolderLength(resolved);

    if (length < 0) PetscFunctionReturn(PETSC_SUCCESS); /* no link */
    target[length] = 0;
    if (target[0] == '/' || !folder) PetscCall(PetscStrncpy(resolved, target, size));
    else if (folder + (size_t)length < size) memcpy(resolved + folder, target, (size_t)length + 1);
  }
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "%s is a symbolic link that leads to itself", path);
}

/* A file by what it is, not by what it is called */
typedef struct {
  PetscBool   exists;
  struct stat status;
  char        name[2 * PETSC_MAX_PATH_LEN]; /* with the real path of its folder, where there is one */
} Identity;

static PetscErrorCode Identify(const char path[], Identity *identity)
{
  char   folder[PETSC_MAX_PATH_LEN], resolved[PETSC_MAX_PATH_LEN], *real;
  size_t length;

  PetscFunctionBegin;
  PetscCall(OutputPathResolve(path, sizeof(resolved), resolved));
  identity->exists = (PetscBool)!stat(resolved, &identity->status);
  length           = FolderLength(resolved);
  PetscCall(PetscStrncpy(folder, length ? resolved : "./", length ? length + 1 : 3));
  real = realpath(folder, NULL);
  PetscCall(PetscSNPrintf(identity->name, sizeof(identity->name), "%s/%s", real ? real : folder, resolved + length));
  free(real);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsSame(const Identity *a, const Identity *b)
{
  if (a->exists && b->exists) return (PetscBool)(a->status.st_dev == b->status.st_dev && a->status.st_ino == b->status.st_ino);
  return (PetscBool)!strcmp(a->name, b->name);
}

/* Whether a word of an option's value names the file: all of it, or what follows a colon as in file:name */
static PetscErrorCode Names(const char word[], const Identity *file, PetscBool *names)
{
  Identity    other;
  const char *colon = strchr(word, ':');

  PetscFunctionBegin;
  PetscCall(Identify(word, &other));
  *names = (PetscBool)(other.exists && IsSame(&other, file));
  if (!*names && colon && colon[1]) PetscCall(Names(colon + 1, file, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an option names an output, or, of the output `by`, what a run may well go on from and write again */
static PetscBool NamesOutput(const char name[], const char by[])
{
  return (PetscBool)(!strncmp(name + 1, "output_", 7) || !strcmp(name, "-checkpoint") ||
                     (!strcmp(name, "-restart") && !strcmp(by, "-checkpoint")));
}

/* The option by which the run reads a file that exists, the output `by`, if there is one: a mesh, a table, an options file */
static PetscErrorCode FindReader(const Identity *file, const char by[], size_t size, char option[])
{
  char     *all, *rest, *word, name[PETSC_MAX_OPTION_NAME] = "";
  PetscBool includes;

  PetscFunctionBegin;
  option[0] = 0;
  PetscCall(OptionsFilesInclude(&file->status, &includes));
  if (includes) PetscCall(PetscStrncpy(option, "-options_file", size));
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (word = strtok_r(all, " ,\"", &rest); word && !option[0]; word = strtok_r(NULL, " ,\"", &rest)) {
    PetscBool key, names = PETSC_FALSE;

    PetscCall(PetscOptionsValidKey(word, &key));
    if (key) PetscCall(PetscStrncpy(name, word, sizeof(name)));
    else if (!NamesOutput(name, by)) PetscCall(Names(word, file, &names));
    if (names) PetscCall(PetscStrncpy(option, name, size));
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is wrong with the paths, if anything is */
static PetscErrorCode Compare(PetscInt n, const char *const options[], const char *const paths[], size_t size, char error[])
{
  Identity *files;

  PetscFunctionBegin;
  error[0] = 0;
  PetscCall(PetscMalloc1(n, &files));
  for (PetscInt i = 0; i < n; i++)
    if (paths[i][0]) PetscCall(Identify(paths[i], &files[i]));
  for (PetscInt i = 0; i < n; i++) {
    char reader[PETSC_MAX_OPTION_NAME] = "";

    if (!paths[i][0]) continue;
    for (PetscInt j = i + 1; j < n; j++)
      if (paths[j][0] && IsSame(&files[i], &files[j]))
        PetscCall(PetscSNPrintf(error, size, "%s and %s are the same file, %s; give each its own", options[i], options[j], paths[i]));
    if (files[i].exists) PetscCall(FindReader(&files[i], options[i], sizeof(reader), reader));
    if (reader[0])
      PetscCall(PetscSNPrintf(error, size, "%s %s is a file that the run reads, by %s; give another path", options[i], paths[i], reader));
  }
  PetscCall(PetscFree(files));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the path "none" of an option for its absence, so that a command line overrules an options file. */
PetscErrorCode OutputPathDrop(char path[], PetscBool *given)
{
  PetscFunctionBegin;
  if (strcmp(path, "none") != 0) PetscFunctionReturn(PETSC_SUCCESS);
  path[0] = 0;
  *given  = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops with an error if two outputs are one file, or an output is one that the run reads. Collective */
PetscErrorCode OutputPathsCheck(MPI_Comm comm, PetscInt n, const char *const options[], const char *const paths[])
{
  char        error[3 * PETSC_MAX_PATH_LEN] = "";
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(Compare(n, options, paths, sizeof(error), error));
  PetscCallMPI(MPI_Bcast(error, (PetscMPIInt)sizeof(error), MPI_CHAR, 0, comm));
  PetscCheck(!error[0], comm, PETSC_ERR_USER_INPUT, "%s", error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which file a path stands for, to or from a checkpoint. `path`: the path; `NULL`: there is no such output */
PetscErrorCode OutputPathVisit(const char path[], const char name[], Checkpoint checkpoint, PetscBool *same)
{
  char own[PETSC_MAX_PATH_LEN] = "", there[PETSC_MAX_PATH_LEN] = "";

  PetscFunctionBegin;
  if (path) PetscCall(OutputPathResolve(path, sizeof(own), own));
  PetscCall(PetscStrncpy(there, own, sizeof(there)));
  PetscCall(CheckpointVisitBytes(checkpoint, name, sizeof(there), there));
  *same = (PetscBool)(path && !strcmp(own, there));
  PetscFunctionReturn(PETSC_SUCCESS);
}
