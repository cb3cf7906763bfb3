/* Options files, looked at apart from PETSc.

   PETSc forgets which file and line an option came from, waits for ever for what a pipe or a device may say, and follows a file that
   includes itself until its stack ends. So the files are looked at before PETSC reads them, and again when an error is to name a line. */
#define _XOPEN_SOURCE 700 /* getline(), tsearch() */
#include <impakt.h>
#include <errno.h>
#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include "optionsfiles.h"

/* What some editors put before the text of a file in UTF-8 */
#define BYTE_ORDER_MARK "\xef\xbb\xbf"

typedef struct {
  char     name[PETSC_MAX_OPTION_NAME];
  PetscInt line;
} Given;

typedef struct Place *Place;
/* Where a walk through the files is: a file, included by the line of another */
struct Place {
  const char *path;
  PetscInt    line;
  struct stat status;
  const Place by;
  void       *given; /* a tree of the options that the file itself has given so far, where they are checked */
};

typedef struct {
  char              *error; /* what is wrong with the files, if somebody wants to know */
  size_t             error_size;
  PetscBool          checks; /* options that a file gives twice are wrong with it */
  const struct stat *sought; /* a file, or NULL */
  PetscBool          found;  /* it has been visited */
  OptionsVisitor     visit;  /* called for each option, or NULL */
  void              *context;
  char               prefixes[8][PETSC_MAX_OPTION_NAME]; /* by -prefix_push */
  int                n_prefixes;
} Walk;

static PetscErrorCode VisitFile(Walk *, const char[], Place);

/* Whether a text has a `${` without its `}`: PetscStrreplace(), called for paths of all files and viewers, crashes then */
PetscBool OptionsIsUnclosed(const char text[])
{
  const char *open = strstr(text, "${");

  while (open && strchr(open, '}')) open = strstr(strchr(open, '}'), "${");
  return open ? PETSC_TRUE : PETSC_FALSE;
}

/* What is wrong with the variables ${NAME} in a path, if anything. PETSc's own mean something without the environment. */
static PetscErrorCode CheckVariables(const char text[], char problem[], size_t size)
{
  const char *const own[] = {"PETSC_ARCH",       "PETSC_DIR", "PETSC_LIB_DIR", "DISPLAY",   "HOMEDIRECTORY",
                             "WORKINGDIRECTORY", "USERNAME",  "HOSTNAME",      "PETSC_MAKE"};

  PetscFunctionBegin;
  problem[0] = 0;
  if (OptionsIsUnclosed(text)) PetscCall(PetscStrncpy(problem, "has a ${ without its } in its path", size));
  for (const char *open = strstr(text, "${"); open && !problem[0]; open = strstr(open + 2, "${")) {
    const size_t length = (size_t)(strchr(open, '}') - open) - 2;
    char         name[PETSC_MAX_PATH_LEN];
    PetscBool    known = PETSC_FALSE;

    PetscCall(PetscStrncpy(name, open + 2, PetscMin(length + 1, sizeof(name))));
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(own) && !known; i++) PetscCall(PetscStrcmp(name, own[i], &known));
    if (!known && !getenv(name))
      PetscCall(PetscSNPrintf(problem, size, "has ${%s} in its path, which is not set in the environment", name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Expand(const char text[], char path[PETSC_MAX_PATH_LEN])
{
  char replaced[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrreplace(PETSC_COMM_SELF, text, replaced, sizeof(replaced)));
  PetscCall(PetscFixFilename(replaced, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* "'c.opts', which 'b.opts' includes in line 3" */
static PetscErrorCode Describe(const char path[], Place by, char text[], size_t size)
{
  PetscFunctionBegin;
  if (by) PetscCall(PetscSNPrintf(text, size, "'%s', which '%s' includes in line %" PetscInt_FMT ",", path, by->path, by->line));
  else PetscCall(PetscSNPrintf(text, size, "'%s'", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a file can be read to its end: a file that exists, and is not being read already */
static PetscErrorCode CheckFile(Walk *walk, const char path[], Place by, struct stat *status, PetscBool *fine)
{
  char name[2 * PETSC_MAX_PATH_LEN];
  int  failure;

  PetscFunctionBegin;
  errno   = 0;
  failure = stat(path, status) ? errno : 0;
  *fine   = (PetscBool)(!failure && S_ISREG(status->st_mode));
  PetscCall(Describe(path, by, name, sizeof(name)));
  if (failure) PetscCall(PetscSNPrintf(walk->error, walk->error_size, "The options file %s cannot be read: %s", name, strerror(failure)));
  else if (!*fine)
    PetscCall(PetscSNPrintf(walk->error, walk->error_size, "The options file %s is %s and not a file with text", name,
                            S_ISDIR(status->st_mode)    ? "a directory"
                            : S_ISFIFO(status->st_mode) ? "a pipe"
                                                        : "a device"));
  for (Place p = by; p && *fine; p = p->by) {
    if (p->status.st_dev != status->st_dev || p->status.st_ino != status->st_ino) continue;
    *fine = PETSC_FALSE;
    PetscCall(PetscSNPrintf(walk->error, walk->error_size, "The options file %s includes itself: take that line out", name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes what is wrong with the line of a file that is read */
static PetscErrorCode Blame(Walk *walk, Place place, const char problem[])
{
  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(walk->error, walk->error_size, "The options file '%s', line %" PetscInt_FMT ": %s", place->path, place->line, problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PushPrefix(Walk *walk, const char prefix[], Place place)
{
  const int n = walk->n_prefixes;

  PetscFunctionBegin;
  if (!prefix) PetscCall(Blame(walk, place, "-prefix_push needs the prefix that the options after it have")); /* PETSc crashes */
  else if (n < (int)PETSC_STATIC_ARRAY_LENGTH(walk->prefixes)) {
    PetscCall(PetscSNPrintf(walk->prefixes[n], sizeof(walk->prefixes[n]), "%s%s", n ? walk->prefixes[n - 1] : "", prefix));
    walk->n_prefixes++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int CompareNames(const void *a, const void *b)
{
  return strcasecmp(((const Given *)a)->name, ((const Given *)b)->name);
}

/* Keeps an option of a file, with its prefix, and blames the file if it has given it before. PETSc's own allocation wants PETSc to run */
static PetscErrorCode KeepGiven(Walk *walk, const char option[], Place place)
{
  Given *given = malloc(sizeof(*given)), **kept;

  PetscFunctionBegin;
  PetscCheck(given, PETSC_COMM_SELF, PETSC_ERR_MEM, "No memory for the options of '%s'", place->path);
  given->line = place->line;
  PetscCall(PetscStrncpy(given->name, option, sizeof(given->name)));
  kept = tsearch(given, &place->given, CompareNames);
  PetscCheck(kept, PETSC_COMM_SELF, PETSC_ERR_MEM, "No memory for the options of '%s'", place->path);
  if (*kept != given) {
    char problem[PETSC_MAX_OPTION_NAME + 64];

    free(given);
    PetscCall(PetscSNPrintf(problem, sizeof(problem), "-%s stands in line %" PetscInt_FMT " already: take one of the two out",
                            (*kept)->name, (*kept)->line));
    PetscCall(Blame(walk, place, problem));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void ForgetGiven(Place place)
{
  while (place->given) {
    Given *given = *(Given **)place->given; /* of the root */

    tdelete(given, &place->given, CompareNames);
    free(given);
  }
}

/* A line of a file: the name of an option and, where it has one, its value */
static PetscErrorCode VisitOption(Walk *walk, const char name[], const char value[], Place place)
{
  PetscBool file, push, pop;

  PetscFunctionBegin;
  PetscCall(PetscStrcasecmp(name, "-options_file", &file));
  PetscCall(PetscStrcasecmp(name, "-prefix_push", &push));
  PetscCall(PetscStrcasecmp(name, "-prefix_pop", &pop));
  if (file && value) PetscCall(VisitFile(walk, value, place));
  else if (push) PetscCall(PushPrefix(walk, value, place));
  else if (pop && walk->n_prefixes) walk->n_prefixes--;
  else if (pop) PetscCall(Blame(walk, place, "-prefix_pop without a -prefix_push before it"));
  else if ((walk->visit || walk->checks) && name[0] == '-') {
    char full[PETSC_MAX_OPTION_NAME], origin[PETSC_MAX_PATH_LEN + 64];

    PetscCall(PetscSNPrintf(full, sizeof(full), "%s%s", walk->n_prefixes ? walk->prefixes[walk->n_prefixes - 1] : "", name + 1));
    PetscCall(PetscSNPrintf(origin, sizeof(origin), "%s, line %" PetscInt_FMT, place->path, place->line));
    if (walk->checks) PetscCall(KeepGiven(walk, full, place));
    if (walk->visit) PetscCall((*walk->visit)(full, value, origin, walk->context));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The words of a line without what follows a #; words in quotes are one */
static char *NextWord(char **rest)
{
  char *word = *rest + strspn(*rest, " \t\r\n");
  char  end  = *word;

  if (end == '"' || end == '\'') word++;
  else end = 0;
  if (!*word) return NULL;
  *rest = end ? strchr(word, end) : word + strcspn(word, " \t\r\n");
  if (!*rest) *rest = word + strlen(word);
  else if (**rest) *(*rest)++ = 0;
  return word;
}

static PetscErrorCode VisitLines(Walk *walk, FILE *file, Place place)
{
  char   *text = NULL;
  size_t  size = 0;
  ssize_t length;

  PetscFunctionBegin;
  for (place->line = 1; (length = getline(&text, &size, file)) >= 0 && !walk->error[0]; place->line++) {
    char *rest = text, *comment = strchr(text, '#'), *name;

    if (strlen(text) < (size_t)length) {
      PetscCall(Blame(walk, place, "there is a zero byte in it: is it a text file?"));
      break;
    }
    if (place->line == 1 && !strncmp(text, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK))) {
      PetscCall(Blame(walk, place, "it begins with a byte-order mark, which no editor shows: save it as UTF-8 without one"));
      break;
    }
    if (text[strcspn(text, "\r")] && strcspn(text, "\r") + 2 < (size_t)length) {
      PetscCall(Blame(walk, place, "there is a carriage return in it: save the file with line ends of Unix or Windows"));
      break;
    }
    if (comment) *comment = 0;
    name = NextWord(&rest);
    if (name && name[0] != '-' && strcmp(name, "alias") != 0) {
      char problem[256];

      PetscCall(PetscSNPrintf(problem, sizeof(problem), "'%.100s' is no option, since these begin with a dash", name));
      PetscCall(Blame(walk, place, problem));
      break;
    }
    if (name) {
      const char *value = NextWord(&rest), *more = NextWord(&rest);
      char        problem[512];

      if (more && name[0] == '-') {
        PetscCall(
            PetscSNPrintf(problem, sizeof(problem),
                          "'%.100s' follows the value '%.100s' of %.100s; an option has one value, without blanks after the commas of "
                          "a list, and a line of its own",
                          more, value, name));
        PetscCall(Blame(walk, place, problem));
        break;
      }
      PetscCall(VisitOption(walk, name, value, place));
    }
  }
  free(text);
  ForgetGiven(place);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitFile(Walk *walk, const char text[], Place by)
{
  char         path[PETSC_MAX_PATH_LEN], problem[PETSC_MAX_PATH_LEN + 64], name[2 * PETSC_MAX_PATH_LEN];
  struct Place place = {.path = path, .line = 0, .by = by};
  PetscBool    fine, yaml = PETSC_FALSE;
  const char  *endings[] = {".yaml", ".yml", ".json", ":yaml"};
  FILE        *file;

  PetscFunctionBegin;
  PetscCall(CheckVariables(text, problem, sizeof(problem)));
  if (problem[0]) {
    PetscCall(Describe(text, by, name, sizeof(name)));
    PetscCall(PetscSNPrintf(walk->error, walk->error_size, "The options file %s %s", name, problem));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Expand(text, path));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(endings) && !yaml; i++) PetscCall(PetscStrendswith(path, endings[i], &yaml));
  if (yaml) PetscFunctionReturn(PETSC_SUCCESS); /* these are not made of lines, and cannot include others */
  PetscCall(CheckFile(walk, path, by, &place.status, &fine));
  if (!fine) PetscFunctionReturn(PETSC_SUCCESS);
  if (walk->sought && walk->sought->st_dev == place.status.st_dev && walk->sought->st_ino == place.status.st_ino) walk->found = PETSC_TRUE;
  file = fopen(path, "r");
  if (file) {
    const PetscErrorCode error = VisitLines(walk, file, &place);

    (void)fclose(file);
    PetscCall(error);
  } else PetscCall(PetscSNPrintf(walk->error, walk->error_size, "The options file '%s' cannot be read: %s", path, strerror(errno)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is wrong with an options file or with one that it includes; nothing if all of them can be read. PETSc need not run */
PetscErrorCode OptionsFileCheck(const char path[], char error[], size_t size)
{
  Walk walk = {.error = error, .error_size = size, .checks = PETSC_TRUE};

  PetscFunctionBegin;
  error[0] = 0;
  PetscCall(VisitFile(&walk, path, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All options files of the command line, then its own options, which overrule them */
static PetscErrorCode VisitCommandLine(Walk *walk)
{
  int    argc;
  char **argv;

  PetscFunctionBegin;
  PetscCall(PetscGetArgs(&argc, &argv));
  for (int options = 0; options < 2; options++)
    for (int i = 1; i < argc; i++) {
      PetscBool file, key = PETSC_TRUE;

      PetscCall(PetscStrcasecmp(argv[i], "-options_file", &file));
      if (i + 1 < argc) PetscCall(PetscOptionsValidKey(argv[i + 1], &key));
      if (file && i + 1 < argc && !options) PetscCall(VisitFile(walk, argv[i + 1], NULL));
      if (options && !file && argv[i][0] == '-' && walk->visit)
        PetscCall((*walk->visit)(argv[i] + 1, key ? NULL : argv[i + 1], "the command line", walk->context));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsFilesInclude(const struct stat *status, PetscBool *include)
{
  char error[1024] = "";
  Walk walk        = {.error = error, .error_size = sizeof(error), .sought = status};

  PetscFunctionBegin;
  PetscCall(VisitCommandLine(&walk));
  *include = walk.found;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Calls a function for each option of the files and of the command line (without its dash, with its prefix): its value, or NULL, and where
   it stands, as "file, line 3". Of an option that stands more than once the last one counts. */
PetscErrorCode OptionsVisit(OptionsVisitor visit, void *context)
{
  char error[1024] = "";
  Walk walk        = {.error = error, .error_size = sizeof(error), .visit = visit, .context = context};

  PetscFunctionBegin;
  PetscCall(VisitCommandLine(&walk));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  const char *option;
  char       *origin;
  size_t      size;
} Search;

static PetscErrorCode NoteOrigin(const char option[], const char value[], const char origin[], void *context)
{
  const Search *search = (const Search *)context;
  PetscBool     same;

  PetscFunctionBegin;
  (void)value;
  PetscCall(PetscStrcasecmp(option, search->option, &same));
  if (same) PetscCall(PetscStrncpy(search->origin, origin, search->size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where an option (without its dash) comes from: "the command line", a file and its line, or nothing if neither is known */
PetscErrorCode OptionsFindOrigin(const char option[], char origin[], size_t size)
{
  Search search = {.option = option, .origin = origin, .size = size};

  PetscFunctionBegin;
  origin[0] = 0;
  PetscCall(OptionsVisit(NoteOrigin, &search));
  PetscFunctionReturn(PETSC_SUCCESS);
}
