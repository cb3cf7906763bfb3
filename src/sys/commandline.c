/* The words of the command line.

   PETSc skips words that belong to no option, and lets an options file that stands further right overrule what stands before it. Impakt
   refuses the former, takes a file that stands alone as an options file, and lets the command line overrule all files. */
#define _DEFAULT_SOURCE /* isascii() */
#include <impakt.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include "commandline.h"
#include "optionsfiles.h"
#include "optionvalues.h"

/* Whether a word is an option by which PETSc reads a file at once */
static PetscErrorCode ReadsFile(const char word[], PetscBool *reads)
{
  PetscFunctionBegin;
  PetscCall(PetscStrcasecmp(word, "-options_file", reads));
  if (!*reads) PetscCall(PetscStrcasecmp(word, "-options_file_yaml", reads));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A word where the name of an option belongs */
static PetscErrorCode Blame(CommandLine *line, const char word[], const char option[], const char value[])
{
  PetscFunctionBegin;
  if (!word[0])
    PetscCall(PetscSNPrintf(line->error, sizeof(line->error),
                            "There is an empty word on the command line%s%s: is a variable of a script empty?", option ? " after " : "",
                            option ? option : ""));
  else if (word[0] == '-' && (isdigit((unsigned char)word[1]) || !isascii((unsigned char)word[1])))
    PetscCall(PetscSNPrintf(line->error, sizeof(line->error),
                            "'%s' on the command line cannot be an option, and is no value of %s: options, and so names of bodies and "
                            "obstacles, begin with a letter of ASCII",
                            word, option ? option : "one"));
  else if (option)
    PetscCall(PetscSNPrintf(line->error, sizeof(line->error),
                            "'%s' on the command line belongs to no option: %s has its value already, '%s'. Lists take commas without "
                            "blanks, formulas with blanks quotes, and names of options begin with a dash",
                            word, option, value));
  else
    PetscCall(PetscSNPrintf(line->error, sizeof(line->error),
                            "'%s' on the command line is no option (these begin with a dash) and no options file (these end in .opts); "
                            "`impakt -help` tells how the program is started",
                            word));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An option without a value, which one of the same name further right would hide from OptionsCheckValues() */
static PetscErrorCode CheckAlone(CommandLine *line, const char option[])
{
  char text[900];

  PetscFunctionBegin;
  PetscCall(OptionsDescribeMissing(option + 1, text, sizeof(text)));
  if (text[0]) PetscCall(PetscSNPrintf(line->error, sizeof(line->error), "%s (the command line) %s", option, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `option` at words[i], whose value, if it has any, is the next word; an options file is none of a switch: -check case.opts */
static PetscErrorCode TakeOption(CommandLine *line, int argc, char **argv, int *i, PetscBool *has_value)
{
  PetscBool reads, key = PETSC_TRUE, file = PETSC_FALSE;
  char      text[900] = "";

  PetscFunctionBegin;
  line->words[line->n++] = argv[*i];
  PetscCall(ReadsFile(argv[*i], &reads));
  if (*i + 1 < argc) PetscCall(PetscOptionsValidKey(argv[*i + 1], &key));
  if (!key && !reads) PetscCall(PetscStrendswith(argv[*i + 1], ".opts", &file));
  if (file) PetscCall(OptionsDescribeMissing(argv[*i] + 1, text, sizeof(text)));
  *has_value = (PetscBool)(!key && !(file && !text[0]));
  if (*has_value && !argv[*i + 1][0])
    PetscCall(
        PetscSNPrintf(line->error, sizeof(line->error), "The value of %s is empty: is a variable of a script without content?", argv[*i]));
  else if (reads && !*has_value) PetscCall(PetscSNPrintf(line->error, sizeof(line->error), "%s needs the path of a file", argv[*i]));
  else if (!*has_value) PetscCall(CheckAlone(line, argv[*i]));
  if (*has_value) line->words[line->n++] = argv[++*i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the words. PETSc need not run, and `error` says what the user is to be told when it does. To be freed by CommandLineDestroy() */
PetscErrorCode CommandLineCreate(int argc, char **argv, CommandLine *line)
{
  const char *option = NULL, *value = NULL;

  PetscFunctionBegin;
  line->error[0] = 0;
  line->n        = 0;
  PetscCall(PetscStrncpy(line->files_option, "-options_file", sizeof(line->files_option)));
  line->words = malloc((2 * (size_t)argc + 1) * sizeof(*line->words)); /* PETSc's own allocation wants PETSc to run */
  PetscCheck(line->words, PETSC_COMM_SELF, PETSC_ERR_MEM, "No memory for the words of the command line");
  if (argc) line->words[line->n++] = argv[0];
  for (int i = 1; i < argc && !line->error[0]; i++) {
    PetscBool key, file, has_value = PETSC_FALSE;

    PetscCall(PetscOptionsValidKey(argv[i], &key));
    if (key) {
      option = argv[i];
      PetscCall(TakeOption(line, argc, argv, &i, &has_value));
      value = has_value ? argv[i] : NULL;
      continue;
    }
    PetscCall(PetscStrendswith(argv[i], ".opts", &file));
    if (file) {
      line->words[line->n++] = line->files_option;
      line->words[line->n++] = argv[i];
    } else PetscCall(Blame(line, argv[i], value ? option : NULL, value));
  }
  line->words[line->n] = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks at the options files before PETSc reads them: collective, once MPI runs */
PetscErrorCode CommandLineCheckFiles(CommandLine *line)
{
  int rank;

  PetscFunctionBegin;
  if (MPI_Comm_rank(MPI_COMM_WORLD, &rank)) PetscFunctionReturn(PETSC_ERR_MPI);
  for (int i = 1; i + 1 < line->n && rank == 0 && !line->error[0]; i++) {
    PetscBool reads;

    PetscCall(ReadsFile(line->words[i], &reads));
    if (reads) PetscCall(OptionsFileCheck(line->words[i + 1], line->error, sizeof(line->error)));
  }
  if (MPI_Bcast(line->error, sizeof(line->error), MPI_CHAR, 0, MPI_COMM_WORLD)) PetscFunctionReturn(PETSC_ERR_MPI);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inserts the options of the command line again, after those of all files, which PETSc has inserted in the order of the words */
PetscErrorCode CommandLineInsert(const CommandLine *line)
{
  const char **words;
  int          n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(line->n, &words));
  for (int i = 1; i < line->n; i++) {
    PetscBool reads;

    PetscCall(ReadsFile(line->words[i], &reads));
    if (reads) i++; /* with its file */
    else words[n++] = line->words[i];
  }
  PetscCall(PetscOptionsInsertArgs(NULL, n, words));
  PetscCall(PetscFree(words));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void CommandLineDestroy(CommandLine *line)
{
  free(line->words);
  line->words = NULL;
}
