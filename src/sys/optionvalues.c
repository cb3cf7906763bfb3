/* Values of options that are missing, or are not what they should be.

   PETSc takes the default where an option has no value, and says of a value that it cannot convert neither whose it is nor where it
   stands. Impakt refuses the former and adds to the latter. */
#include <impakt.h>
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "names.h"
#include "optionsfiles.h"
#include "optionvalues.h"
#include "sharedoptions.h"

/* Whether an option belongs to a line of the table, whatever body or obstacle it is of */
static PetscErrorCode Matches(const char option[], const KnownOption *known, PetscBool *matches)
{
  char        middle[128];
  const char *part = strchr(known->name, '<'); /* what follows is the name of a surface, or of a block */
  size_t      length, end;

  PetscFunctionBegin;
  if (known->owner == OPTION_OF_RUN) {
    PetscCall(PetscStrcasecmp(option, known->name, matches));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *matches = PETSC_FALSE;
  if (part == known->name)
    PetscFunctionReturn(PETSC_SUCCESS); /* of a block: it ends as an option of the body does, which is found instead */
  PetscCall(PetscSNPrintf(middle, sizeof(middle), "_%s", known->name));
  if (part) middle[part - known->name + 1] = 0;
  PetscCall(PetscStrlen(middle, &length));
  PetscCall(PetscStrlen(option, &end));
  if (part) *matches = (PetscBool)(strstr(option, middle) != NULL);
  else *matches = (PetscBool)(end > length && !strcmp(option + end - length, middle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The line of the table that an option belongs to; NULL: none */
PetscErrorCode OptionsFindKnown(const char option[], const KnownOption **found)
{
  const KnownOption *known;
  size_t             n;

  PetscFunctionBegin;
  known  = KnownOptionsGet(&n);
  *found = NULL;
  for (size_t i = 0; i < n && !*found; i++) {
    PetscBool matches;

    PetscCall(Matches(option, &known[i], &matches));
    if (matches) *found = &known[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* "-left_density (steel.opts, line 3)" */
static PetscErrorCode NameWithOrigin(const char option[], char text[], size_t size)
{
  char origin[PETSC_MAX_PATH_LEN + 64];

  PetscFunctionBegin;
  PetscCall(OptionsFindOrigin(option, origin, sizeof(origin)));
  PetscCall(PetscSNPrintf(text, size, "-%s%s%s%s", option, origin[0] ? " (" : "", origin, origin[0] ? ")" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options of PETSc that mean nothing without a value, by how they end: tolerances, counts, types */
static PetscErrorCode WantsValue(const char option[], PetscBool *wants)
{
  const char *const endings[] = {"_type", "_rtol", "_atol", "_stol", "_divtol", "_max_it", "_max_funcs", "_restart", "_damping", "_order"};

  PetscFunctionBegin;
  *wants = (PetscBool)(strstr(option, "_icntl_") || strstr(option, "_cntl_"));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(endings) && !*wants; i++) PetscCall(PetscStrendswith(option, endings[i], wants));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What there is to say of an option that has no value: nothing, if it can be on or off, or if nobody knows it */
PetscErrorCode OptionsDescribeMissing(const char option[], char text[], size_t size)
{
  const KnownOption *known;
  PetscBool          on_or_off = PETSC_FALSE, viewer = PETSC_FALSE, wants;

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(OptionsFindKnown(option, &known));
  if (known) {
    PetscCall(PetscStrcmp(known->value, "true|false", &on_or_off));
    if (!on_or_off) PetscCall(PetscStrcmp(known->value, "true|false|auto", &on_or_off));
    viewer = (PetscBool)(known->value[0] == '[');
    wants  = (PetscBool)(!on_or_off && !viewer);
  } else PetscCall(WantsValue(option, &wants));
  if (wants && known) PetscCall(PetscSNPrintf(text, size, "has no value: it takes %s (%s)", known->value, known->text));
  else if (wants) PetscCall(PetscSNPrintf(text, size, "has no value: give one after it"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The value of a switch that may be another word as well, as `other` says, which the caller has looked for. `option` without its dash */
PetscErrorCode OptionsReadSwitch(MPI_Comm comm, const char option[], const char other[], const char value[], PetscBool *flag)
{
  static const char *const words[] = {"true", "yes", "on", "1", "false", "no", "off", "0"};
  PetscBool                same    = PETSC_FALSE;
  PetscInt                 which   = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 8 && !same; i++) {
    PetscCall(PetscStrcasecmp(value, words[i], &same));
    which = i;
  }
  PetscCheck(same, comm, PETSC_ERR_USER_INPUT, "-%s is true, false%s, not '%s'", option, other, value);
  *flag = (PetscBool)(which < 4);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first whole number of a list that PETSc would cut off without a word, since it has more bits than a PetscInt */
static PetscErrorCode FindTooLarge(const char option[], const char value[], char number[], size_t size)
{
  const KnownOption *known;
  PetscBool          whole;
  PetscToken         elements;
  const char        *element;

  PetscFunctionBegin;
  number[0] = 0;
  PetscCall(OptionsFindKnown(option, &known));
  if (!known) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrcmp(known->value, "n", &whole));
  if (!whole) PetscCall(PetscStrncmp(known->value, "n[,", 3, &whole));
  if (!whole) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscTokenCreate(value, ',', &elements));
  while (!number[0]) {
    char     *end;
    long long n;

    PetscCall(PetscTokenFind(elements, &element));
    if (!element) break;
    errno = 0;
    n     = strtoll(element, &end, 10);
    if (end == element || *end || (!errno && n >= PETSC_INT_MIN && n <= PETSC_INT_MAX)) continue;
    PetscCall(PetscStrncpy(number, element, size));
  }
  PetscCall(PetscTokenDestroy(&elements));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops with an error if an option without a value is not one that can be on or off. Before anybody has read options; collective */
PetscErrorCode OptionsCheckValues(void)
{
  PetscInt n;
  char   **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) {
    char name[2 * PETSC_MAX_PATH_LEN], text[1024] = "", number[256] = "";

    if (!values[i] || !values[i][0]) PetscCall(OptionsDescribeMissing(names[i], text, sizeof(text)));
    else PetscCall(FindTooLarge(names[i], values[i], number, sizeof(number)));
    if (number[0]) PetscCall(PetscSNPrintf(text, sizeof(text), "%s: whole numbers go to %" PetscInt_FMT " here", number, PETSC_INT_MAX));
    if (values[i] && OptionsIsUnclosed(values[i])) PetscCall(PetscSNPrintf(text, sizeof(text), "'%s': a ${ without its }", values[i]));
    if (!text[0]) continue;
    PetscCall(NameWithOrigin(names[i], name, sizeof(name)));
    SETERRQ(PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT, "%s %s", name, text);
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What PETSc says of a value that it cannot convert: before and after the value, and what Impakt says instead */
typedef struct {
  const char *before, *after, *wanted;
} Complaint;

static const Complaint complaints[] = {
    {"Input string ", " has no integer value (do not include . in it)", "a whole number"},
    {"Input string ", " has no numeric value", "a number"},
    {"Unknown logical value: ", "", "true or false"},
    {"Unsupported viewer ", "", "a viewer, as in ascii:file.txt"},
};

static const Complaint *FindComplaint(const char message[], char value[], size_t size)
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(complaints); i++) {
    const size_t before = strlen(complaints[i].before), after = strlen(complaints[i].after), length = strlen(message);

    if (length < before + after || length - before - after >= size) continue;
    if (strncmp(message, complaints[i].before, before) != 0 || strcmp(message + length - after, complaints[i].after) != 0) continue;
    memcpy(value, message + before, length - before - after);
    value[length - before - after] = 0;
    return &complaints[i];
  }
  return NULL;
}

/* Whether a text is a value, or an element of a list that is one */
static PetscBool Contains(const char value[], const char text[])
{
  const size_t n = strlen(text);

  for (const char *at = strstr(value, text); at; at = strstr(at + 1, text)) {
    const PetscBool begins = (PetscBool)(at == value || strchr(",:- ", at[-1])), ends = (PetscBool)(!at[n] || strchr(",:- ", at[n]));

    if (n && begins && ends) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Whether a value is a number, or a list with a number in it, that is not finite or, with `printed`, has been printed with six digits as
   that */
static PetscBool HasNumber(const char value[], const PetscReal *printed)
{
  for (const char *at = value; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    char        *end;
    const double number = strtod(at, &end);

    if (end == at || (*end && *end != ',')) continue;
    if (printed ? fabs(number - *printed) <= 1e-5 * fabs(*printed) : !(fabs(number) <= PETSC_MAX_REAL)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Options read with such a value (NULL: with the number `printed`, or one that is not finite), each with its origin and what it takes */
static PetscErrorCode Describe(const char value[], const PetscReal *printed, char text[], size_t size)
{
  char       *all, name[2 * PETSC_MAX_PATH_LEN], one[3 * PETSC_MAX_PATH_LEN];
  const char *word;
  PetscToken  words;

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscTokenCreate(all, ' ', &words));
  while (PETSC_TRUE) {
    const KnownOption *known;
    const char        *given = NULL;
    PetscBool          key, used, set = PETSC_FALSE;

    PetscCall(PetscTokenFind(words, &word));
    if (!word) break;
    PetscCall(PetscOptionsValidKey(word, &key));
    if (!key || OptionsIsShared(word + 1)) continue; /* ImpaktReportError() adds whence the option of a body comes */
    PetscCall(PetscOptionsUsed(NULL, word + 1, &used));
    if (used) PetscCall(PetscOptionsFindPair(NULL, NULL, word, &given, &set));
    if (!set || !given || !(value ? Contains(given, value) : HasNumber(given, printed))) continue;
    PetscCall(OptionsFindKnown(word + 1, &known));
    PetscCall(NameWithOrigin(word + 1, name, sizeof(name)));
    PetscCall(PetscSNPrintf(one, sizeof(one), "%s%s%s", name, known ? ", which takes " : "", known ? known->value : ""));
    if (!value) PetscCall(PetscSNPrintf(one, sizeof(one), printed ? "%s %s" : "%s: '%s'", name, given));
    PetscCall(NamesAppend(text, size, " or ", one));
  }
  PetscCall(PetscTokenDestroy(&words));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What may help, by how the value looks */
static const char *Advise(const char value[])
{
  const char *end  = value + strspn(value, "0123456789+-.eE");
  const char *tail = value + strspn(value, "0123456789+-");

  if (tail > value && *tail == ',' && isdigit((unsigned char)tail[1]) && !strchr(tail + 1, ','))
    return "; decimals come after a point, not a comma";
  if (end > value && isalpha((unsigned char)*end))
    return "; numbers stand without units: all are of one consistent set, SI unless -units says otherwise";
  return "";
}

/* Setters of PETSc complain of a number that is out of range without the name of the option: "Relative tolerance 7. must be ..." */
static PetscErrorCode ExplainRange(const char message[], char text[], size_t size, PetscBool *explained)
{
  char        names[2048] = "";
  const char *at          = message;

  PetscFunctionBegin;
  while (*at && !names[0]) { /* the first number of the message is the one that was given */
    char     *end;
    PetscReal number = 0;

    at += strcspn(at, " ");
    at += strspn(at, " ");
    if (*at == '-' || isdigit((unsigned char)*at)) {
      number = strtod(at, &end);
      if (end == at) continue;
      PetscCall(Describe(NULL, &number, names, sizeof(names)));
      break;
    }
  }
  if (names[0]) PetscCall(PetscSNPrintf(text, size, "%s: %s", names, message));
  *explained = (PetscBool)(names[0] != 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says of a complaint by PETSc which option it is about, where that stands and what is wanted; not Collective */
PetscErrorCode OptionsExplain(const char function[], PetscErrorCode code, const char message[], char text[], size_t size,
                              PetscBool *explained)
{
  char             value[512], names[2048], kind[64];
  const Complaint *complaint = NULL;
  PetscBool        converts, views, bounded = PETSC_FALSE;

  PetscFunctionBegin;
  *explained = PETSC_FALSE;
  if (message) PetscCall(PetscStrncmp(message, "Newly set value ", 16, &bounded));
  if (bounded) { /* PETSC_MAX_REAL and its negative are the bounds of all numbers that have no others */
    PetscCall(Describe(NULL, NULL, names, sizeof(names)));
    if (names[0]) PetscCall(PetscSNPrintf(text, size, "%s is no finite number", names));
    *explained = (PetscBool)(names[0] != 0);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscStrncmp(function, "PetscOptionsStringTo", 20, &converts));
  PetscCall(PetscStrncmp(function, "PetscOptionsCreateViewer", 24, &views));
  if ((converts || views) && message) complaint = FindComplaint(message, value, sizeof(value));
  if (!complaint && message && code == PETSC_ERR_ARG_UNKNOWN_TYPE &&
      sscanf(message, "Unable to find requested %63s type %255s", kind, value) == 2) {
    PetscCall(Describe(value, NULL, names, sizeof(names)));
    *explained = (PetscBool)(names[0] != 0);
    if (*explained)
      PetscCall(PetscSNPrintf(text, size, "%s: PETSc has no %s of type '%s'; `impakt -help all` lists the types", names, kind, value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!complaint) {
    if (message && !converts && !views && code == PETSC_ERR_ARG_OUTOFRANGE) PetscCall(ExplainRange(message, text, size, explained));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Describe(value, NULL, names, sizeof(names)));
  if (!names[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(text, size, "%s: '%s' is not %s%s", names, value, complaint->wanted, Advise(value)));
  *explained = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
