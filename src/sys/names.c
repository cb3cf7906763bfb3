/* Lists of names: in the options, of any length (PETSc's own call leaves away what does not fit), and in registries. */
#include "names.h"

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

/* Adds a name to a list in a message; without room " ..." once. PETSc's own call writes a byte beyond a full text */
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
