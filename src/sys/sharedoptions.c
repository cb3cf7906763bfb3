/* Options that several bodies share.

   -all_density counts for each body without an option -<body>_density, and -material_steel_density for each body with -<body>_material
   steel, before -all_density. As soon as the names of the bodies are known, the options database gets -<body>_density for them, where each
   reader looks for it, and which checkpoints compare. The shared options stay in the database, where messages and the check of unread
   options find them. */
#define _DEFAULT_SOURCE /* isascii(), strncasecmp() */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include "names.h"
#include "optionsfiles.h"
#include "optionstext.h"
#include "optiontable.h"
#include "sharedoptions.h"

static const char all[] = "all", materials[] = "material";

/* The bodies, and the material of each, in the text of the options database: NULL where it names none */
typedef struct {
  PetscInt     n;
  char *const *bodies;
  const char **materials;
} Sharers;

/* What follows an owner's name and an underscore at the beginning of an option; NULL if it does not begin so */
static const char *After(const char option[], const char owner[])
{
  const size_t length = strlen(owner);

  return strncasecmp(option, owner, length) != 0 || option[length] != '_' || !option[length + 1] ? NULL : option + length + 1;
}

/* Whether an option (without its dash) is one of all bodies, or of a material */
PetscBool OptionsIsShared(const char option[])
{
  return (PetscBool)(After(option, all) || After(option, materials));
}

/* An error if PETSc's options cannot begin with a name, or those of all bodies or a material do; `option` is the one that gave it */
PetscErrorCode OptionsCheckName(MPI_Comm comm, const char option[], const char name[])
{
  char      begin[PETSC_MAX_OPTION_NAME];
  PetscBool fine = (PetscBool)(isascii((unsigned char)name[0]) && isalpha((unsigned char)name[0]));

  PetscFunctionBegin;
  for (const char *c = name; *c; c++)
    if (!isascii((unsigned char)*c) || !(isalnum((unsigned char)*c) || *c == '_' || *c == '-')) fine = PETSC_FALSE;
  PetscCheck(fine, comm, PETSC_ERR_USER_INPUT,
             "-%s: '%s' cannot be a name, since options begin with it: it needs a letter of ASCII first, then letters, digits, _ or -",
             option, name);
  PetscCall(PetscSNPrintf(begin, sizeof(begin), "%s_x", name));
  PetscCheck(!OptionsIsShared(begin), comm, PETSC_ERR_USER_INPUT,
             "-%s: '%s' cannot be a name: options that begin with -all_ are those of all bodies, and with -material_ those of named "
             "materials; choose another name",
             option, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindValue(const char option[], const char **value, PetscBool *set)
{
  char name[PETSC_MAX_OPTION_NAME];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s", option));
  PetscCall(PetscOptionsFindPair(NULL, NULL, name, value, set));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The material that a body names, or that all bodies do; and by which option */
static PetscErrorCode ReadMaterial(const char body[], const char **material, char option[], size_t size)
{
  const char *const owners[] = {body, all};
  PetscBool         set      = PETSC_FALSE;

  PetscFunctionBegin;
  *material = NULL;
  for (int o = 0; o < 2 && !set; o++) {
    PetscCall(PetscSNPrintf(option, size, "%s_material", owners[o]));
    PetscCall(FindValue(option, material, &set));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `materials` is to be freed */
static PetscErrorCode SharersCreate(PetscInt n, char *const bodies[], Sharers *sharers)
{
  char option[PETSC_MAX_OPTION_NAME];

  PetscFunctionBegin;
  sharers->n      = n;
  sharers->bodies = bodies;
  PetscCall(PetscCalloc1(n, &sharers->materials));
  for (PetscInt b = 0; b < n; b++) PetscCall(ReadMaterial(bodies[b], &sharers->materials[b], option, sizeof(option)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What follows the name of a material in one of its options, else NULL. Options of material steel_hard are none of steel */
static const char *AfterMaterial(const Sharers *sharers, const char option[], const char material[])
{
  const char *behind = After(option, materials), *rest = behind ? After(behind, material) : NULL;

  for (PetscInt b = 0; b < sharers->n && rest; b++) {
    const char *other = sharers->materials[b];

    if (other && strlen(other) > strlen(material) && After(behind, other)) rest = NULL;
  }
  return rest;
}

static int CompareNames(const void *a, const void *b)
{
  return strcasecmp(*(const char *const *)a, *(const char *const *)b);
}

static PetscBool Has(PetscInt n, const char *const names[], const char name[])
{
  return (PetscBool)(bsearch(&name, names, (size_t)n, sizeof(*names), CompareNames) != NULL);
}

/* The names of all options without their dashes, in order; `text` has to stay as long as they are used */
static PetscErrorCode CollectNames(char text[], PetscInt *n, const char **names[])
{
  const char *value;
  PetscInt    room = 1;

  PetscFunctionBegin;
  for (const char *c = text; *c; c++) room += *c == ' ';
  PetscCall(PetscMalloc1(room, names));
  for (*n = 0; OptionsTextNext(&text, &(*names)[*n], &value); (*n)++) (*names)[*n]++;
  qsort(*names, (size_t)*n, sizeof(**names), CompareNames);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The material of an option as -material_steel_density, which ends as a body's does; nothing if of none. Its name may have underscores. */
PetscErrorCode OptionsFindMaterial(const char option[], char material[], size_t size)
{
  const char        *behind = After(option, materials);
  const KnownOption *known;
  size_t             n, length = 0;

  PetscFunctionBegin;
  material[0] = 0;
  if (!behind || !strchr(behind, '_')) PetscFunctionReturn(PETSC_SUCCESS);
  known = KnownOptionsGet(&n);
  for (size_t i = 0; i < n; i++) {
    const size_t of_option = strlen(known[i].name), of_all = strlen(behind);

    if (known[i].owner != OPTION_OF_BODY || of_all < of_option + 2 || behind[of_all - of_option - 1] != '_') continue;
    if (!strcasecmp(behind + of_all - of_option, known[i].name)) length = PetscMax(length, of_option + 1);
  }
  length = length ? strlen(behind) - length : strcspn(behind, "_");
  PetscCall(PetscStrncpy(material, behind, PetscMin(length + 1, size)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is wrong with the name of a material that has no options, with those that have; nothing where it has some */
static PetscErrorCode CheckMaterial(const Sharers *sharers, PetscInt b, PetscInt n, const char *const names[], char error[], size_t size)
{
  char        option[PETSC_MAX_OPTION_NAME], name[128], list[1024] = "", last[128] = "";
  const char *wanted = sharers->materials[b];

  PetscFunctionBegin;
  if (!wanted) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n; i++) {
    if (AfterMaterial(sharers, names[i], wanted)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(OptionsFindMaterial(names[i], name, sizeof(name)));
    if (name[0] && strcasecmp(name, last) != 0) PetscCall(NamesAppend(list, sizeof(list), ", ", name));
    if (name[0]) PetscCall(PetscStrncpy(last, name, sizeof(last)));
  }
  PetscCall(ReadMaterial(sharers->bodies[b], &wanted, option, sizeof(option)));
  PetscCall(PetscSNPrintf(
      error, size,
      "-%s %s: there is no material '%s', since no option begins with -material_%s_, as in -material_%s_density 7800; there are: %s",
      option, wanted, wanted, wanted, wanted, list[0] ? list : "none"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A shared option becomes one of a body, unless the body has its own, or a material comes first */
static PetscErrorCode Expand(const Sharers *sharers, PetscInt b, const char option[], PetscInt n, const char *const names[])
{
  const char *material = sharers->materials[b], *rest = After(option, all), *value;
  char        full[PETSC_MAX_OPTION_NAME];
  PetscBool   set, first = PETSC_TRUE;

  PetscFunctionBegin;
  if (!rest && material) rest = AfterMaterial(sharers, option, material);
  else if (rest && material) {
    PetscCall(PetscSNPrintf(full, sizeof(full), "%s_%s_%s", materials, material, rest));
    if (Has(n, names, full) && AfterMaterial(sharers, full, material)) first = PETSC_FALSE;
  }
  if (!rest) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindValue(option, &value, &set)); /* it counts as read: OptionsSharedIsUnread() checks whether a body reads it */
  PetscCall(PetscSNPrintf(full, sizeof(full), "-%s_%s", sharers->bodies[b], rest));
  if (first && !Has(n, names, full + 1)) PetscCall(PetscOptionsSetValue(NULL, full, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives bodies the options of all bodies, and of their materials. `bodies`: names, before their options are read. Collective */
PetscErrorCode OptionsExpandShared(MPI_Comm comm, PetscInt n, char *const bodies[])
{
  Sharers      sharers;
  const char **names;
  char        *text, error[2048] = "";
  PetscInt     n_names;

  PetscFunctionBegin;
  PetscCall(SharersCreate(n, bodies, &sharers));
  PetscCall(PetscOptionsGetAll(NULL, &text));
  PetscCall(CollectNames(text, &n_names, &names));
  for (PetscInt b = 0; b < n && !error[0]; b++) PetscCall(CheckMaterial(&sharers, b, n_names, names, error, sizeof(error)));
  for (PetscInt i = 0; i < n_names && !error[0]; i++)
    for (PetscInt b = 0; b < n && OptionsIsShared(names[i]); b++) PetscCall(Expand(&sharers, b, names[i], n_names, names));
  PetscCall(PetscFree(names));
  PetscCall(PetscFree(text));
  PetscCall(PetscFree(sharers.materials));
  PetscCheck(!error[0], comm, PETSC_ERR_USER_INPUT, "%s", error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsMaterialIsNamed(const char material[], PetscInt n, const char *const bodies[], PetscBool *named)
{
  Sharers sharers;

  PetscFunctionBegin;
  *named = PETSC_FALSE;
  PetscCall(SharersCreate(n, (char *const *)bodies, &sharers));
  for (PetscInt b = 0; b < n; b++)
    if (sharers.materials[b] && !strcasecmp(sharers.materials[b], material)) *named = PETSC_TRUE;
  PetscCall(PetscFree(sharers.materials));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode HasSameValue(const char option[], const char value[], PetscBool *same)
{
  const char *other;

  PetscFunctionBegin;
  PetscCall(FindValue(option, &other, same));
  if (*same) *same = (PetscBool)!strcmp(value ? value : "", other ? other : "");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shared option that gives a body's option. `value`: its value, or `NULL`; `shared`: without dash; empty: it is given itself */
PetscErrorCode OptionsFindShared(const char option[], const char value[], char shared[], size_t size)
{
  Sharers  sharers;
  char   **bodies, found[PETSC_MAX_OPTION_NAME] = "", origin[PETSC_MAX_PATH_LEN + 64];
  PetscInt n;

  PetscFunctionBegin;
  shared[0] = 0;
  PetscCall(NamesRead(NULL, "-bodies", &n, &bodies, NULL));
  PetscCall(SharersCreate(n, bodies, &sharers));
  for (PetscInt b = 0; b < n && !found[0]; b++) {
    const char *rest = After(option, bodies[b]), *material = sharers.materials[b];
    PetscBool   same = PETSC_FALSE;

    if (!rest) continue;
    if (material) {
      PetscCall(PetscSNPrintf(found, sizeof(found), "%s_%s_%s", materials, material, rest));
      if (AfterMaterial(&sharers, found, material)) PetscCall(HasSameValue(found, value, &same));
    }
    if (!same) {
      PetscCall(PetscSNPrintf(found, sizeof(found), "%s_%s", all, rest));
      PetscCall(HasSameValue(found, value, &same));
    }
    if (!same) found[0] = 0;
  }
  PetscCall(PetscFree(sharers.materials));
  PetscCall(NamesDestroy(n, &bodies));
  if (!found[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OptionsFindOrigin(option, origin, sizeof(origin)));
  if (!origin[0]) PetscCall(PetscStrncpy(shared, found, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a shared option has been given to bodies none of which has read it. One that no body has got is unread in the database itself. */
PetscErrorCode OptionsSharedIsUnread(const char option[], PetscInt n, const char *const bodies[], PetscBool *unread)
{
  Sharers sharers;

  PetscFunctionBegin;
  PetscCall(PetscOptionsUsed(NULL, option, unread));
  PetscCall(SharersCreate(n, (char *const *)bodies, &sharers));
  for (PetscInt b = 0; b < n && *unread; b++) {
    const char *rest = After(option, all);
    char        full[PETSC_MAX_OPTION_NAME];
    PetscBool   used;

    if (!rest && sharers.materials[b]) rest = AfterMaterial(&sharers, option, sharers.materials[b]);
    if (!rest) continue;
    PetscCall(PetscSNPrintf(full, sizeof(full), "%s_%s", bodies[b], rest));
    PetscCall(PetscOptionsUsed(NULL, full, &used));
    if (used) *unread = PETSC_FALSE;
  }
  PetscCall(PetscFree(sharers.materials));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the options that a message names stand nowhere by themselves, but come of shared ones: as "-left_density is -all_density
   (blocks.opts, line 3)". Nothing: none of them. Not Collective */
PetscErrorCode OptionsExplainShared(const char message[], char text[], size_t size)
{
  PetscFunctionBegin;
  text[0] = 0;
  for (const char *at = strchr(message, '-'); at; at = strchr(at + 1, '-')) {
    char        name[PETSC_MAX_OPTION_NAME], shared[PETSC_MAX_OPTION_NAME], origin[PETSC_MAX_PATH_LEN + 64];
    char        one[2 * PETSC_MAX_PATH_LEN];
    const char *value;
    size_t      length = 1;
    PetscBool   set;

    while (isalnum((unsigned char)at[length]) || at[length] == '_') length++;
    if (!isalpha((unsigned char)at[1]) || (at > message && (isalnum((unsigned char)at[-1]) || at[-1] == '_'))) continue;
    PetscCall(PetscStrncpy(name, at + 1, PetscMin(length, sizeof(name))));
    PetscCall(FindValue(name, &value, &set));
    if (!set) continue;
    PetscCall(OptionsFindShared(name, value, shared, sizeof(shared)));
    if (!shared[0]) continue;
    PetscCall(OptionsFindOrigin(shared, origin, sizeof(origin)));
    PetscCall(PetscSNPrintf(one, sizeof(one), "-%s is -%s%s%s%s", name, shared, origin[0] ? " (" : "", origin, origin[0] ? ")" : ""));
    if (!strstr(text, one)) PetscCall(NamesAppend(text, size, ", ", one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
