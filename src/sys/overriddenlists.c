/* Lists of names that are overridden: -bodies a,b in a file and -bodies a on the command line leave the options of b over. */
#define _POSIX_C_SOURCE 200809L /* strncasecmp() */
#include <string.h>
#include <strings.h>
#include "names.h"
#include "optionsfiles.h"
#include "overriddenlists.h"

/* A list of names, one of which an option seems to belong to, as the files and the command line have it */
typedef struct {
  const char *option;
  PetscBool   behind; /* the names that it may end with, and not those that it may begin with */
  char        list[PETSC_MAX_OPTION_NAME], name[128];
  char        origin[2 * PETSC_MAX_PATH_LEN]; /* the list that has the name, as "-bodies a,b (two.opts, line 3)" */
  char        last[2 * PETSC_MAX_PATH_LEN];   /* the list that counts */
  PetscBool   counts;                         /* it has the name too */
} Search;

/* Whether the option belongs to a name of a list: it begins with it, as those of bodies and obstacles do, or, `behind`, of a pair of
   contact or of a surface of -left_boundary_displacement, ends with it */
static PetscBool Belongs(const Search *search, const char list[], const char name[])
{
  const char  *option = search->option;
  const size_t length = strlen(name), end = strlen(option);

  if (!length || end <= length) return PETSC_FALSE;
  if (!search->behind) return (PetscBool)(!strncasecmp(option, name, length) && option[length] == '_');
  return (PetscBool)(option[end - length - 1] == '_' && !strcasecmp(option + end - length, name) &&
                     (!strcasecmp(list, "contact_pairs") || !strncasecmp(option, list, strlen(list))));
}

/* An option of a file or of the command line: the last list is the one that counts */
static PetscErrorCode LookAt(const char option[], const char value[], const char origin[], void *context)
{
  Search         *search = (Search *)context;
  const PetscBool again  = (PetscBool)!strcasecmp(option, search->list);
  PetscToken      names;
  const char     *name;

  PetscFunctionBegin;
  if (!search->behind && strcasecmp(option, "bodies") != 0 && strcasecmp(option, "obstacles") != 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (again) {
    search->counts = PETSC_FALSE;
    PetscCall(PetscSNPrintf(search->last, sizeof(search->last), "-%s %s (%s)", option, value ? value : "", origin));
  } else if (search->name[0] && !search->counts) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscTokenCreate(value ? value : "", ',', &names));
  while (PETSC_TRUE) {
    PetscCall(PetscTokenFind(names, &name));
    if (!name) break;
    if (!Belongs(search, option, name)) continue;
    search->counts = PETSC_TRUE;
    PetscCall(PetscStrncpy(search->list, option, sizeof(search->list)));
    PetscCall(PetscStrncpy(search->name, name, sizeof(search->name)));
    PetscCall(PetscSNPrintf(search->origin, sizeof(search->origin), "-%s %s (%s)", option, value, origin));
  }
  PetscCall(PetscTokenDestroy(&names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which overridden list has the name that an option (without its dash) belongs to; nothing, if none has */
PetscErrorCode OptionsFindOverridden(const char option[], char text[], size_t size)
{
  Search search = {.counts = PETSC_TRUE};

  PetscFunctionBegin;
  text[0] = 0;
  for (int behind = 0; behind < 2 && search.counts; behind++) {
    search = (Search){.option = option, .behind = (PetscBool)behind, .counts = PETSC_TRUE};
    PetscCall(OptionsVisit(LookAt, &search));
  }
  if (search.counts) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(text, size, "of '%s', which %s names; %s overrides that list: take out what is left of '%s'", search.name,
                          search.origin, search.last, search.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}
