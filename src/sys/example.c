/* -example: options files to start from, with what each option means. They lie in the program, which may be there without sources. */
#include <impakt.h>
#include <ctype.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include "example.h"
#include "names.h"
#include "optionvalues.h"

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

/* Whether the full stop at a place ends a sentence: none does in a number, behind an initial, or before a small letter or a bracket */
static PetscBool EndsSentence(const char text[], size_t at)
{
  const PetscBool initial = (PetscBool)(at && isupper((unsigned char)text[at - 1]) && (at == 1 || !isalnum((unsigned char)text[at - 2])));

  if (!text[at + 1]) return PETSC_TRUE;
  return (PetscBool)(!initial && text[at + 1] == ' ' && !islower((unsigned char)text[at + 2]) && text[at + 2] != '(');
}

/* The first sentence of the remark that an example begins with, which may go over several lines */
static PetscErrorCode GetSentence(const Example *example, char text[], size_t size)
{
  PetscFunctionBegin;
  text[0] = 0;
  for (const char *const *line = example->lines; *line && (*line)[0] == '#'; line++)
    PetscCall(NamesAppend(text, size, " ", *line + strspn(*line, "# ")));
  for (char *stop = strchr(text, '.'); stop; stop = *stop ? strchr(stop + 1, '.') : NULL)
    if (EndsSentence(text, (size_t)(stop - text))) *stop = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintList(void)
{
  size_t longest = 0;

  PetscFunctionBegin;
  for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(examples); e++) longest = PetscMax(longest, strlen(examples[e].name));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "-example NAME writes NAME.opts, an options file with remarks, to start from:\n\n"));
  for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(examples); e++) {
    char sentence[4096];

    PetscCall(GetSentence(&examples[e], sentence, sizeof(sentence)));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-*s  %s\n", (int)longest, examples[e].name, sentence));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the option at the beginning of a line means, if the table knows it. `prefixed`: it gets the prefix of a body there */
static PetscErrorCode FindMeaning(const char line[], PetscBool prefixed, const KnownOption **meaning)
{
  const char *name = line + strspn(line, " ");
  char        option[PETSC_MAX_OPTION_NAME];

  PetscFunctionBegin;
  *meaning = NULL;
  if (name[0] != '-') PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(option, sizeof(option), "%s%.*s", prefixed ? "body_" : "", (int)strcspn(name, " ") - 1, name + 1));
  PetscCall(OptionsFindKnown(option, meaning));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteLines(const Example *example, FILE *file)
{
  PetscBool prefixed = PETSC_FALSE;

  PetscFunctionBegin;
  for (const char *const *line = example->lines; *line; line++) {
    const KnownOption *meaning;

    PetscCall(FindMeaning(*line, prefixed, &meaning));
    if (strstr(*line, "-prefix_push")) prefixed = PETSC_TRUE;
    if (strstr(*line, "-prefix_pop")) prefixed = PETSC_FALSE;
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
