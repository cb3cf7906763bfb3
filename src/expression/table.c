/* Tables of a value over time, read from text files. */
#define _POSIX_C_SOURCE 200809L /* getline() */
#include "expressionimpl.h"
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

struct _n_Table {
  PetscInt   n, room;
  PetscReal *times, *values;
};

/* More lines than any table that is meant: the two arrays of numbers stay below 2 GB, and their sizes below PETSC_INT_MAX */
#define TABLE_ROWS_MAX 100000000

static PetscErrorCode AddRow(Table table, PetscReal time, PetscReal value)
{
  PetscFunctionBegin;
  if (table->n == table->room) {
    table->room = table->room ? 2 * table->room : 64;
    PetscCall(PetscRealloc(table->room * sizeof(PetscReal), &table->times));
    PetscCall(PetscRealloc(table->room * sizeof(PetscReal), &table->values));
  }
  table->times[table->n]    = time;
  table->values[table->n++] = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a number and skips what separates it from the next one (C locale); returns where that begins, or NULL without a number. */
static char *ReadNumber(char text[], PetscReal *value)
{
  char *end;

  *value = strtod(text, &end);
  if (end == text || !(PetscAbsReal(*value) <= PETSC_MAX_REAL)) return NULL;
  if (*end && !strchr(" \t,", *end)) return NULL;
  end += strspn(end, " \t");
  if (*end == ',') end += 1 + strspn(end + 1, " \t");
  return end;
}

/* Reads a table. If the file is none, `problem` says why. */
static PetscErrorCode ReadRows(FILE *file, Table table, char problem[], size_t size)
{
  char    *line   = NULL;
  PetscInt number = 0;
  size_t   room   = 0;
  ssize_t  length;

  PetscFunctionBegin;
  errno = 0;
  while (!problem[0] && (length = getline(&line, &room, file)) >= 0) {
    PetscReal time, value;
    char     *rest;

    number++;
    while (length && strchr("\r\n", line[length - 1])) line[--length] = 0;
    for (ssize_t i = 0; i < length; i++)
      if (!line[i] || line[i] == '\r') line[0] = '?'; /* binary, or lines that end as no system's do any more */
    line[strcspn(line, "#")] = 0;
    rest                     = line + strspn(line, " \t");
    if (!*rest) continue;
    rest = ReadNumber(rest, &time);
    if (rest) rest = ReadNumber(rest, &value);
    if (!rest || *rest)
      PetscCall(PetscSNPrintf(
          problem, size, "line %" PetscInt_FMT " is not a time and a value, two finite numbers separated by blanks or a comma", number));
    else if (table->n && time <= table->times[table->n - 1])
      PetscCall(PetscSNPrintf(problem, size,
                              "line %" PetscInt_FMT ": time %g does not come after %g, that of the line before; times must ascend", number,
                              (double)time, (double)table->times[table->n - 1]));
    else if (table->n == TABLE_ROWS_MAX) PetscCall(PetscSNPrintf(problem, size, "it has more than %d lines", TABLE_ROWS_MAX));
    else PetscCall(AddRow(table, time, value));
  }
  free(line);
  if (problem[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (ferror(file)) PetscCall(PetscSNPrintf(problem, size, "it cannot be read: %s", strerror(errno)));
  else if (!table->n) PetscCall(PetscSNPrintf(problem, size, "there is no line with a time and a value in it"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFile(const char path[], Table table, char problem[], size_t size)
{
  struct stat status;
  FILE       *file;

  PetscFunctionBegin;
  if (!stat(path, &status) && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) { /* which may never end, or never begin */
    PetscCall(PetscSNPrintf(problem, size, "it is %s and not a file with text", S_ISFIFO(status.st_mode) ? "a pipe" : "a device"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  file = fopen(path, "r");
  if (!file) {
    PetscCall(PetscSNPrintf(problem, size, "it cannot be opened: %s", strerror(errno)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ReadRows(file, table, problem, size));
  (void)fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a table on the first rank and sends it to the others; if there is none, all ranks end with an error that says why */
PetscErrorCode TableRead(MPI_Comm comm, const char option[], const char path[], Table *table)
{
  char        problem[256] = "";
  PetscMPIInt rank, n;

  PetscFunctionBegin;
  PetscCall(PetscNew(table));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) PetscCall(ReadFile(path, *table, problem, sizeof(problem)));
  PetscCallMPI(MPI_Bcast(problem, (PetscMPIInt)sizeof(problem), MPI_CHAR, 0, comm));
  PetscCheck(!problem[0], comm, PETSC_ERR_USER_INPUT, "-%s: the table '%s' is of no use: %s", option, path, problem);
  PetscCallMPI(MPI_Bcast(&(*table)->n, 1, MPIU_INT, 0, comm));
  PetscCall(PetscMPIIntCast((*table)->n, &n));
  PetscCall(PetscRealloc(n * sizeof(PetscReal), &(*table)->times));
  PetscCall(PetscRealloc(n * sizeof(PetscReal), &(*table)->values));
  PetscCallMPI(MPI_Bcast((*table)->times, n, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast((*table)->values, n, MPIU_REAL, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The value at a time: linear between lines, constant before the first and after the last */
PetscReal TableEvaluate(Table table, PetscReal t)
{
  PetscInt  low = 0, high = table->n - 1;
  PetscReal part;

  if (t <= table->times[0]) return table->values[0];
  if (t >= table->times[high]) return table->values[high];
  while (high - low > 1) {
    const PetscInt middle = low + (high - low) / 2;

    if (table->times[middle] <= t) low = middle;
    else high = middle;
  }
  part = (t - table->times[low]) / (table->times[high] - table->times[low]);
  return (1 - part) * table->values[low] + part * table->values[high];
}

PetscErrorCode TableIsConstant(Table table, PetscBool *constant)
{
  PetscFunctionBegin;
  *constant = PETSC_TRUE;
  for (PetscInt i = 1; i < table->n; i++)
    if (table->values[i] != table->values[0]) *constant = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TableDestroy(Table *table)
{
  PetscFunctionBegin;
  if (!*table) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*table)->times));
  PetscCall(PetscFree((*table)->values));
  PetscCall(PetscFree(*table));
  PetscFunctionReturn(PETSC_SUCCESS);
}
