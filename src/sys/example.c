/* -example: options files to start from, with what each option means. They lie in the program, since who has it need not have the sources.
 */
#include <impakt.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include "example.h"
#include "names.h"
#include "optiontable.h"

typedef struct {
  const char        *name;
  const char *const *lines; /* up to NULL */
} Example;

static const Example examples[] = {
#include <examples.inc> /* by the Makefile, from options/ */
};

enum { COLUMN = 44 }; /* where remarks begin */

/* The word after -example, or NULL; `asked`: the option is there */
static const char *FindName(int argc, char **argv, PetscBool *asked)
{
  *asked = PETSC_FALSE;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "-example") != 0 && strcmp(argv[i], "--example") != 0) continue;
    *asked = PETSC_TRUE;
    return i + 1 < argc && argv[i + 1][0] != '-' ? argv[i + 1] : NULL;
  }
  return NULL;
}

/* Characters of a text up to the full stop that ends its first sentence; one in a number does not */
static size_t SentenceLength(const char text[])
{
  size_t length = strcspn(text, ".");

  while (text[length] && text[length + 1] && text[length + 1] != ' ') length += 1 + strcspn(text + length + 1, ".");
  return length;
}

/* The examples, each with its first sentence */
static PetscErrorCode PrintList(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "-example NAME writes NAME.opts, an options file with remarks, to start from:\n\n"));
  for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(examples); e++) {
    const char  *first  = examples[e].lines[0] + strspn(examples[e].lines[0], "# ");
    const size_t length = SentenceLength(first);

    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-22s %.*s\n", examples[e].name, (int)length, first));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the option at the beginning of a line means, if the table knows it. `owner` changes where options get a prefix */
static PetscErrorCode FindMeaning(const char line[], OptionOwner owner, const KnownOption **meaning)
{
  const KnownOption *known;
  const char        *name   = line + strspn(line, " ");
  const size_t       length = strcspn(name, " ");
  size_t             n;

  PetscFunctionBegin;
  *meaning = NULL;
  known    = KnownOptionsGet(&n);
  if (name[0] != '-') PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < n && !*meaning; i++) {
    const size_t whole = strlen(known[i].name), fixed = strcspn(known[i].name, "<"), at = length - 1;
    const char  *end = owner == OPTION_OF_RUN && known[i].owner != OPTION_OF_RUN && at > whole ? name + 1 + at - whole : name + 1;
    PetscBool    same;

    if (!fixed || (owner != OPTION_OF_RUN && known[i].owner == OPTION_OF_RUN)) continue; /* not those of blocks, whose names come first */
    if (owner == OPTION_OF_RUN && known[i].owner != OPTION_OF_RUN && (end == name + 1 || end[-1] != '_')) continue;
    same = fixed < whole ? (PetscBool)(at > fixed && !strncmp(name + 1, known[i].name, fixed))
                         : (PetscBool)((size_t)(name + length - end) == whole && !strncmp(end, known[i].name, whole));
    if (same) *meaning = &known[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteLines(const Example *example, FILE *file)
{
  OptionOwner owner = OPTION_OF_RUN;

  PetscFunctionBegin;
  for (const char *const *line = example->lines; *line; line++) {
    const KnownOption *meaning;

    PetscCall(FindMeaning(*line, owner, &meaning));
    if (strstr(*line, "-prefix_push")) owner = OPTION_OF_BODY;
    if (strstr(*line, "-prefix_pop")) owner = OPTION_OF_RUN;
    if (meaning && !strchr(*line, '#')) fprintf(file, "%-*s # %s\n", COLUMN, *line, meaning->text);
    else fprintf(file, "%s\n", *line);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Write(const Example *example)
{
  char        path[PETSC_MAX_PATH_LEN];
  FILE       *file;
  PetscMPIInt rank;
  int         failure = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(path, sizeof(path), "%s.opts", example->name));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (!rank) {
    file    = fopen(path, "wx"); /* never what somebody has worked on */
    failure = file ? 0 : errno;
    if (file) {
      PetscCall(WriteLines(example, file));
      if (fclose(file)) failure = errno;
    }
  }
  PetscCallMPI(MPI_Bcast(&failure, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  PetscCheck(failure != EEXIST, PETSC_COMM_WORLD, PETSC_ERR_FILE_WRITE, "'%s' exists already: rename it, or go to another folder", path);
  PetscCheck(!failure, PETSC_COMM_WORLD, PETSC_ERR_FILE_WRITE, "'%s' cannot be written: %s", path, strerror(failure));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s is written; `impakt %s` runs it\n", path, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Answer(const char name[])
{
  char known[1500] = "";

  PetscFunctionBegin;
  for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(examples); e++) {
    PetscBool same;

    PetscCall(PetscStrcmp(name, examples[e].name, &same));
    PetscCall(NamesAppend(known, sizeof(known), ", ", examples[e].name));
    if (!same) continue;
    PetscCall(Write(&examples[e]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  SETERRQ(PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT, "-example %s: there is no such example; there are %s", name, known);
}

/* Answers -example [NAME], where the command line has it: starts Impakt and PETSc, writes or prints, and ends them */
PetscErrorCode ImpaktExample(int argc, char **argv, PetscBool *done)
{
  const char *name;
  char       *program[] = {argv[0], NULL}, **words = program;
  int         n = 1;

  PetscFunctionBegin;
  name = FindName(argc, argv, done);
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ImpaktInitialize(&n, &words));
  (void)signal(SIGPIPE, SIG_DFL); /* who reads may stop, as in `| head`; PETSc has a banner for it */
  if (name) PetscCall(Answer(name));
  else PetscCall(PrintList());
  PetscCall(ImpaktFinalize());
  /* PetscFunctionReturn() would need PETSc */
  return PETSC_SUCCESS;
}
