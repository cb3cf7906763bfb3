/* Lists of names that are overridden: -bodies a,b in a file and -bodies a on the command line leave the options of b over. */
#define _POSIX_C_SOURCE 200809L /* strncasecmp() */
#include <string.h>
#include <strings.h>
#include "names.h"
#include "optiontable.h"
#include "optionsfiles.h"
#include "overriddenlists.h"

/* A list of names, an option that may belong to one of them, and where such a name has been found */
typedef struct {
  const char *list, *begin; /* names of the list's options; what they begin with before the name */
  const char *option;
  char        name[128];
  char        origin[2 * PETSC_MAX_PATH_LEN]; /* the list that has the name, as "-bodies a,b (two.opts, line 3)" */
  PetscBool   counts;                         /* the list that counts has the name too */
} Search;

/* Whether the option belongs to a name: it begins with it, or, behind the beginning of a list, is it */
static PetscBool Belongs(const Search *search, const char name[])
{
  const size_t begin = strlen(search->begin), length = strlen(name);
  const char  *rest = search->option + begin;

  if (!length || strncasecmp(search->option, search->begin, begin) != 0 || strncasecmp(rest, name, length) != 0) return PETSC_FALSE;
  return (PetscBool)(rest[length] == (begin ? 0 : '_'));
}

/* An option of a file or of the command line: the last list is the one that counts */
static PetscErrorCode LookAt(const char option[], const char value[], const char origin[], void *context)
{
  Search    *search = (Search *)context;
  PetscToken names;

  PetscFunctionBegin;
  if (strcasecmp(option, search->list) != 0) PetscFunctionReturn(PETSC_SUCCESS);
  search->counts = PETSC_FALSE;
  PetscCall(PetscTokenCreate(value ? value : "", ',', &names));
  while (PETSC_TRUE) {
    const char *name;

    PetscCall(PetscTokenFind(names, &name));
    if (!name) break;
    if (!Belongs(search, name)) continue;
    search->counts = PETSC_TRUE;
    PetscCall(PetscStrncpy(search->name, name, sizeof(search->name)));
    PetscCall(PetscSNPrintf(search->origin, sizeof(search->origin), "-%s %s (%s)", option, value, origin));
  }
  PetscCall(PetscTokenDestroy(&names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Try(const char list[], const char begin[], const char option[], char text[], size_t size)
{
  Search      search = {.list = list, .begin = begin, .option = option};
  char        name[PETSC_MAX_OPTION_NAME], origin[PETSC_MAX_PATH_LEN + 64];
  const char *value;
  PetscBool   set;

  PetscFunctionBegin;
  if (text[0] || strncasecmp(option, begin, strlen(begin)) != 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OptionsVisit(LookAt, &search));
  if (!search.name[0] || search.counts) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s", list));
  PetscCall(PetscOptionsFindPair(NULL, NULL, name, &value, &set));
  PetscCall(OptionsFindOrigin(list, origin, sizeof(origin)));
  PetscCall(PetscSNPrintf(text, size, "of '%s', which %s names; -%s %s (%s) overrides that list: take out what is left of '%s'",
                          search.name, search.origin, list, set && value ? value : "", origin, search.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which overridden list has the name that an option (without its dash) belongs to; nothing, if none has */
PetscErrorCode OptionsFindOverridden(const char option[], PetscInt n, const char *const bodies[], char text[], size_t size)
{
  const char *const  lists[] = {"boundary_displacement", "boundary_traction"};
  const KnownOption *known;
  size_t             n_known;

  PetscFunctionBegin;
  text[0] = 0;
  known   = KnownOptionsGet(&n_known);
  PetscCall(Try("bodies", "", option, text, size));
  PetscCall(Try("obstacles", "", option, text, size));
  for (size_t i = 0; i < n_known; i++) {
    const char *pair = strstr(known[i].name, "<pair>");
    char        begin[PETSC_MAX_OPTION_NAME];

    if (!pair) continue;
    PetscCall(PetscSNPrintf(begin, sizeof(begin), "%.*s", (int)(pair - known[i].name), known[i].name));
    PetscCall(Try("contact_pairs", begin, option, text, size));
  }
  for (PetscInt b = 0; b < n && !text[0]; b++)
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(lists); i++) {
      char list[PETSC_MAX_OPTION_NAME], begin[PETSC_MAX_OPTION_NAME];

      PetscCall(PetscSNPrintf(list, sizeof(list), "%s_%s", bodies[b], lists[i]));
      PetscCall(PetscSNPrintf(begin, sizeof(begin), "%s_", list));
      PetscCall(Try(list, begin, option, text, size));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}
