/* Lists of names: in the options, of any length (PETSc's own call fills an array of the caller's, and leaves away what does not fit), and
   in registries. */
#define _DEFAULT_SOURCE /* isascii() */
#include "names.h"
#include "sharedoptions.h"
#include <ctype.h>

PetscErrorCode NamesDestroy(PetscInt n, char ***names)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; *names && i < n; i++) PetscCall(PetscFree((*names)[i]));
  PetscCall(PetscFree(*names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Names with commas between them; `set`: the option is there, or NULL */
PetscErrorCode NamesRead(const char prefix[], const char option[], PetscInt *n, char ***names, PetscBool *set)
{
  PetscInt capacity = 16;

  PetscFunctionBegin;
  *n     = 0;
  *names = NULL;
  do {
    PetscCall(NamesDestroy(*n, names));
    capacity *= 2;
    *n = capacity;
    PetscCall(PetscCalloc1(capacity, names));
    PetscCall(PetscOptionsGetStringArray(NULL, prefix, option, *names, n, set));
  } while (*n == capacity);
  if (!*n) PetscCall(NamesDestroy(0, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops with an error if options cannot begin with a name, as PETSc reads them, or are those of all bodies or of a material; `option` is
   the one that gave it */
PetscErrorCode NamesCheck(MPI_Comm comm, const char option[], const char name[])
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

/* Adds a name to a list in a message; where there is no room left, " ..." once. PETSc's own call writes a byte beyond a text that is full
 */
PetscErrorCode NamesAppend(char list[], size_t size, const char separator[], const char name[])
{
  static const char more[] = " ...";
  size_t            length, wanted, end;
  PetscBool         full;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(list, &length));
  PetscCall(PetscStrlen(separator, &end));
  PetscCall(PetscStrlen(name, &wanted));
  PetscCall(PetscStrendswith(list, more, &full));
  if (full) PetscFunctionReturn(PETSC_SUCCESS);
  if (length + end + wanted + sizeof(more) <= size)
    PetscCall(PetscSNPrintf(list + length, size - length, "%s%s", length ? separator : "", name));
  else PetscCall(PetscStrncpy(list + length, more, size - length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names in a registry, in alphabetical order, with commas between them */
PetscErrorCode NamesOfRegistry(PetscFunctionList registry, size_t size, char known[])
{
  const char **names;
  PetscInt    *order;
  int          n;

  PetscFunctionBegin;
  PetscCall(PetscFunctionListGet(registry, &names, &n));
  PetscCall(PetscMalloc1(n, &order));
  for (int i = 0; i < n; i++) order[i] = i;
  PetscCall(PetscSortStrWithPermutation(n, names, order));
  known[0] = '\0';
  for (int i = 0; i < n; i++) PetscCall(NamesAppend(known, size, ", ", names[order[i]]));
  PetscCall(PetscFree(order));
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}
