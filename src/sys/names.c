/* Lists of names in the options, of any length: PETSc's own call fills an array of the caller's, and leaves away what does not fit. */
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
