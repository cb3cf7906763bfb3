/* Several expressions in one text. */
#include "expressionimpl.h"

/* Length of the text up to the next comma outside parentheses, or to its end */
static size_t FindComma(const char text[])
{
  int    depth = 0;
  size_t i;

  for (i = 0; text[i]; i++) {
    if (text[i] == '(') depth++;
    else if (text[i] == ')') depth--;
    else if (text[i] == ',' && depth <= 0) break;
  }
  return i;
}

PetscErrorCode ExpressionListCount(const char text[], PetscInt *n)
{
  const char *c = text + FindComma(text);

  PetscFunctionBegin;
  for (*n = 1; *c; c += FindComma(c)) {
    c++;
    (*n)++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The expression of one component, without the blanks around it; NULL if the component is the word `free` */
static PetscErrorCode CreateComponent(MPI_Comm comm, const char option[], const char text[], size_t length, PetscBool allow_free,
                                      Expression *expression)
{
  char          *component;
  PetscBool      is_free;
  PetscErrorCode error = PETSC_SUCCESS;

  PetscFunctionBegin;
  while (length && strchr(" \t", text[0])) text++, length--;
  while (length && strchr(" \t", text[length - 1])) length--;
  PetscCall(PetscMalloc1(length + 1, &component));
  PetscCall(PetscStrncpy(component, text, length + 1));
  PetscCall(PetscStrcmp(component, "free", &is_free));
  *expression = NULL;
  if (!allow_free || !is_free) error = ExpressionCreate(comm, option, component, expression);
  PetscCall(PetscFree(component));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Components of a vector, separated by commas. `list`: n expressions, `NULL`: free; after an error all are freed. Collective */
PetscErrorCode ExpressionListCreate(MPI_Comm comm, const char option[], const char text[], PetscInt n, PetscBool allow_free,
                                    Expression list[])
{
  PetscInt found;

  PetscFunctionBegin;
  PetscAssertPointer(option, 2);
  PetscAssertPointer(text, 3);
  PetscAssertPointer(list, 6);
  PetscCall(ExpressionListCount(text, &found));
  for (PetscInt i = 0; i < n; i++) list[i] = NULL;
  PetscCheck(found == n, comm, PETSC_ERR_USER_INPUT,
             "-%s: '%s' has %" PetscInt_FMT " component%s; it needs %" PetscInt_FMT ", separated by commas%s", option, text, found,
             found == 1 ? "" : "s", n, allow_free ? ", each a formula, table:file or free" : "");
  for (PetscInt i = 0; i < n; i++) {
    const size_t         length = FindComma(text);
    const PetscErrorCode error  = CreateComponent(comm, option, text, length, allow_free, &list[i]);

    if (error)
      for (PetscInt k = 0; k < i; k++) (void)ExpressionDestroy(&list[k]);
    PetscCall(error);
    text += length + 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
