#include "optionstext.h"
#include <ctype.h>
#include <string.h>

/* Cuts the first option off a text "-name value -name -name value ", which is changed and has to stay as long as name and value are used;
   the value is empty where there is none. False at the end of the text. */
PetscBool OptionsTextNext(char **text, const char **name, const char **value)
{
  char *end = strchr(*text, ' '), *next;

  if (!end) return PETSC_FALSE;
  for (next = end + 1; *next && !(next[-1] == ' ' && next[0] == '-' && isalpha((unsigned char)next[1])); next++);
  *name  = *text;
  *value = next > end + 1 ? end + 1 : "";
  *end   = '\0';
  if (next[-1] == ' ') next[-1] = '\0'; /* the blank after the value */
  *text = next;
  return PETSC_TRUE;
}

/* Whether the options of the run have some text in them, in small letters */
PetscErrorCode OptionsTextHas(const char text[], PetscBool *has)
{
  char *all, *found;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscStrtolower(all));
  PetscCall(PetscStrstr(all, text, &found));
  *has = (PetscBool)(found != NULL);
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
