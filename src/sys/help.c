/* The screens of -help, -help TOPIC, -help WORD and -version. PETSc prints its own for these options at its start and then lets the
   program run, so they are looked for first and kept from PETSc. */
#include <impakt.h>
#include <petscts.h>
#include <hdf5.h>
#include <signal.h>
#include <string.h>
#include "help.h"
#include "names.h"
#include "optionwords.h"

/* The Makefile knows with what */
#if !defined(IMPAKT_OPTIMISATION)
#  define IMPAKT_OPTIMISATION "unknown flags"
#endif

#if defined(__clang__)
#  define COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#  define COMPILER "gcc " __VERSION__
#else
#  define COMPILER "unknown compiler"
#endif

typedef enum { REQUEST_NONE, REQUEST_SCREEN, REQUEST_TOPIC, REQUEST_VERSION } Request;

/* What the command line asks for; `topic` is the word after -help */
static PetscErrorCode FindRequest(int argc, char **argv, Request *request, const char **topic)
{
  const struct {
    const char *option;
    Request     request;
  } known[] = {
      {"-help", REQUEST_SCREEN},     {"--help", REQUEST_SCREEN},     {"-h", REQUEST_SCREEN},
      {"-version", REQUEST_VERSION}, {"--version", REQUEST_VERSION},
  };

  PetscFunctionBegin;
  *request = REQUEST_NONE;
  *topic   = NULL;
  for (int i = 1; i < argc && *request == REQUEST_NONE; i++) {
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(known); k++) {
      PetscBool same;

      PetscCall(PetscStrcmp(argv[i], known[k].option, &same));
      if (same) *request = known[k].request;
    }
    if (*request == REQUEST_SCREEN && i + 1 < argc && argv[i + 1][0] != '-') {
      *request = REQUEST_TOPIC;
      *topic   = argv[i + 1];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Name and version of the MPI library: the first words of what MPI itself tells, which goes on with dates and machines */
static PetscErrorCode GetMPIVersion(char text[], size_t size)
{
  char library[MPI_MAX_LIBRARY_VERSION_STRING];
  int  length;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Get_library_version(library, &length));
  for (int i = 0; i < length; i++)
    if (library[i] == ',' || library[i] == '\n') library[i] = 0;
  PetscCall(PetscStrncpy(text, library, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintVersions(void)
{
  PetscInt petsc[3];
  char     mpi[128];
  unsigned hdf5[3];

  PetscFunctionBegin;
  PetscCall(PetscGetVersionNumber(&petsc[0], &petsc[1], &petsc[2], NULL));
  PetscCall(GetMPIVersion(mpi, sizeof(mpi)));
  PetscCheck(H5get_libversion(&hdf5[0], &hdf5[1], &hdf5[2]) >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5 does not tell its version");
  PetscCall(PetscPrintf(
      PETSC_COMM_WORLD, "Impakt   %s\nPETSc    %" PetscInt_FMT ".%" PetscInt_FMT ".%" PetscInt_FMT "%s\nMPI      %s\nHDF5     %u.%u.%u\n",
      IMPAKT_VERSION, petsc[0], petsc[1], petsc[2], PetscDefined(USE_DEBUG) ? ", with debugging" : "", mpi, hdf5[0], hdf5[1], hdf5[2]));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "compiler %s, %s\nscalars  %s, %d bytes\nintegers %d bytes\n", COMPILER, IMPAKT_OPTIMISATION,
                        PetscDefined(USE_COMPLEX) ? "complex" : "real", (int)sizeof(PetscScalar), (int)sizeof(PetscInt)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How the program is started; the first lines of -help, and all that it says without options */
PetscErrorCode ImpaktPrintUsage(FILE *file)
{
  PetscFunctionBegin;
  PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file,
                         "Impakt %s simulates bodies that hit each other.\n\n"
                         "  impakt FILE.opts [-option value ...]\n"
                         "  mpiexec -n 4 impakt FILE.opts [-option value ...]\n\n",
                         IMPAKT_VERSION));
  if (file == stderr)
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "`impakt -example` has options files to start from, `impakt -help` tells more.\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintScreen(void)
{
  const OptionTopic *topics;
  size_t             n;

  PetscFunctionBegin;
  topics = OptionTopicsGet(&n);
  PetscCall(ImpaktPrintUsage(stdout));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "-help TOPIC prints the options of a topic, -help WORD those for a word:\n"));
  for (size_t t = 0; t < n; t++) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-10s %s\n", topics[t].name, topics[t].text));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  all        the options of all topics, and those of PETSc\n"
                                          "  markdown   the options of all topics, as tables in Markdown\n"
                                          "-example [NAME] lists or writes options files; -version lists what is built in.\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the name of an option begins with, as it stands in print */
static const char *PrintedPrefix(OptionOwner owner)
{
  return owner == OPTION_OF_BODY ? "<body>_" : owner == OPTION_OF_OBSTACLE ? "<obstacle>_" : "";
}

static PetscErrorCode PrintOption(const KnownOption *option)
{
  PetscFunctionBegin;
  PetscCall(
      PetscPrintf(PETSC_COMM_WORLD, "  -%s%s %s\n      %s\n", PrintedPrefix(option->owner), option->name, option->value, option->text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In a table in Markdown | stands between columns */
static PetscErrorCode PrintRow(const KnownOption *option)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "| `-%s%s` | `", PrintedPrefix(option->owner), option->name));
  for (const char *c = option->value; *c; c++) PetscCall(PetscPrintf(PETSC_COMM_WORLD, *c == '|' ? "\\|" : "%c", *c));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "` | %s |\n", option->text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintTopic(const OptionTopic *topic, PetscBool markdown)
{
  const KnownOption *options;
  size_t             n;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, markdown ? "**%s**: %s\n\n| option | takes | meaning |\n| --- | --- | --- |\n" : "%s: %s\n\n",
                        topic->name, topic->text));
  for (size_t i = 0; i < n; i++)
    if (!strcmp(options[i].topic, topic->name)) PetscCall(markdown ? PrintRow(&options[i]) : PrintOption(&options[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintTopics(PetscBool markdown)
{
  const OptionTopic *topics;
  size_t             n;

  PetscFunctionBegin;
  topics = OptionTopicsGet(&n);
  for (size_t t = 0; t < n; t++) {
    if (t) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n"));
    PetscCall(PrintTopic(&topics[t], markdown));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ImpaktPrintOptions - prints a table of all options that Impakt has beside those of PETSc

  Collective on `PETSC_COMM_WORLD`

  Level: beginner

.seealso: `ImpaktCheckOptions()`
@*/
PetscErrorCode ImpaktPrintOptions(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "Options of Impakt, in SI units; those of PETSc work too\n\n"));
  PetscCall(PrintTopics(PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What PETSc calls before it prints the help that all of its programs have */
static PetscErrorCode PrintBeforePetsc(MPI_Comm comm)
{
  PetscFunctionBegin;
  (void)comm;
  PetscCall(ImpaktPrintOptions());
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n----------------------------------------\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options of the integrator and solvers of a body, and of the outer iteration: objects print theirs when they read them */
static PetscErrorCode PrintSolvers(void)
{
  TS   ts;
  SNES snes;

  PetscFunctionBegin;
  PetscCall(TSCreate(PETSC_COMM_WORLD, &ts));
  PetscCall(TSSetOptionsPrefix(ts, "<body>_"));
  PetscCall(TSSetType(ts, TSALPHA2));
  PetscCall(TSSetFromOptions(ts));
  PetscCall(TSDestroy(&ts));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetOptionsPrefix(snes, "schwarz_"));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESDestroy(&snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The topic of this name, or NULL; and the names of all topics */
static PetscErrorCode FindTopic(const char name[], const OptionTopic **topic, char list[], size_t size)
{
  const OptionTopic *topics;
  size_t             n;

  PetscFunctionBegin;
  topics  = OptionTopicsGet(&n);
  *topic  = NULL;
  list[0] = 0;
  for (size_t t = 0; t < n; t++) {
    PetscBool same;

    PetscCall(PetscStrcmp(topics[t].name, name, &same));
    if (same) *topic = &topics[t];
    PetscCall(NamesAppend(list, size, ", ", topics[t].name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options that a word means, then those with the word in their names, then those with the word in their texts */
static PetscErrorCode PrintFound(const char word[], const char topics[])
{
  const KnownOption *options;
  size_t             n, n_found = 0;

  PetscFunctionBegin;
  options = KnownOptionsGet(&n);
  for (PetscInt wanted = 0; wanted < 3; wanted++)
    for (size_t i = 0; i < n; i++) {
      PetscInt rank;

      PetscCall(OptionGetRank(&options[i], word, &rank));
      if (rank != wanted) continue;
      if (!n_found++) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: no topic; options that have to do with this word\n\n", word));
      PetscCall(PrintOption(&options[i]));
    }
  PetscCheck(n_found, PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT,
             "-help %s: there is no such topic, and no option with this word in its name or text; topics are %s, all, markdown", word,
             topics);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Answer(Request request, const char topic[], PetscBool all)
{
  const OptionTopic *found;
  char               topics[512];
  PetscBool          markdown = PETSC_FALSE;

  PetscFunctionBegin;
  if (topic) PetscCall(PetscStrcmp(topic, "markdown", &markdown));
  if (request == REQUEST_VERSION) PetscCall(PrintVersions());
  else if (request == REQUEST_SCREEN) PetscCall(PrintScreen());
  else if (all) PetscCall(PrintSolvers());
  else if (markdown) PetscCall(PrintTopics(PETSC_TRUE));
  else {
    PetscCall(FindTopic(topic, &found, topics, sizeof(topics)));
    if (found) PetscCall(PrintTopic(found, PETSC_FALSE));
    else PetscCall(PrintFound(topic, topics));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Answers -help and -version, where the command line has one of them: starts Impakt and PETSc, prints, and ends them */
PetscErrorCode ImpaktHelp(int argc, char **argv, PetscBool *done)
{
  Request     request;
  const char *topic;
  PetscBool   all    = PETSC_FALSE;
  char        help[] = "-help", *shown[] = {argv[0], help, NULL}, **words = shown;
  int         n_words = 1;

  PetscFunctionBegin;
  PetscCall(FindRequest(argc, argv, &request, &topic));
  *done = (PetscBool)(request != REQUEST_NONE);
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  if (topic) PetscCall(PetscStrcmp(topic, "all", &all));
  if (all) {
    PetscCall(PetscSetHelpVersionFunctions(NULL, PrintBeforePetsc));
    n_words = 2;
  }
  PetscCall(ImpaktInitialize(&n_words, &words));
  (void)signal(SIGPIPE, SIG_DFL); /* who reads may stop, as in `| head`; PETSc has a banner for it */
  PetscCall(Answer(request, topic, all));
  PetscCall(ImpaktFinalize());
  /* PetscFunctionReturn() would need PETSc */
  return PETSC_SUCCESS;
}
