/* The text of loads and conditions: formulas for components, and their values. */
#include "loadsimpl.h"

/* The value of an option of the body, whose name comes without - and prefix; NULL if it is not given */
PetscErrorCode BodyLoadsGetText(Body body, const char name[], const char *text[])
{
  const char *prefix = ((PetscObject)body)->prefix;
  char        option[LOADS_NAME_LENGTH];
  PetscBool   set;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%s", name));
  PetscCall(PetscOptionsFindPair(NULL, prefix, option, text, &set));
  if (!set) *text = NULL;
  /* PETSc takes -a for an option, but -1 for a value */
  PetscCheck(!set || (*text && (*text)[0]), PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "-%s%s has no value; one that begins with - and a letter needs parentheses around it, as in (-x),0", prefix, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As many components as the body has dimensions */
PetscErrorCode BodyLoadsGetComponents(Body body, const char name[], const char text[], PetscBool allow_free, Expression list[])
{
  MPI_Comm comm = PetscObjectComm((PetscObject)body);
  char     option[LOADS_NAME_LENGTH];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "%s%s", ((PetscObject)body)->prefix, name));
  PetscCall(ExpressionListCount(text, &n));
  PetscCheck(n == body->mesh.dim, comm, PETSC_ERR_USER_INPUT,
             "-%s '%s' has %" PetscInt_FMT " component%s; body '%s' is %" PetscInt_FMT "-dimensional%s", option, text, n, n == 1 ? "" : "s",
             body->hdr.name, body->mesh.dim, allow_free ? " (a component may be the word free)" : "");
  PetscCall(ExpressionListCreate(comm, option, text, body->mesh.dim, allow_free, list));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where one of n formulas of an option, or NULL, depends on what it must not */
PetscErrorCode BodyLoadsRefuse(Body body, const char name[], LoadsRefused what, PetscInt n, const Expression list[])
{
  static const char *const why[] = {
      [LOADS_NORMAL] = ": nx, ny and nz are for tractions alone; use x, y, z",
      [LOADS_TIME]   = " cannot vary in time: it is what there is at the start; use x, y, z",
      [LOADS_PLACE]  = ": a rigid body is led as a whole; its formulas may use t, but not x, y, z or a normal",
  };

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    PetscBool steady, uniform, normal;

    if (!list[i]) continue;
    PetscCall(ExpressionGetNature(list[i], &steady, &uniform, &normal));
    PetscCheck(what == LOADS_NORMAL ? !normal
               : what == LOADS_TIME ? steady
                                    : uniform,
               PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT, "-%s%s%s", ((PetscObject)body)->prefix, name, why[what]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of an array of owned dofs that are not zero, from the first-th on every stride-th */
PetscErrorCode BodyLoadsCompress(PetscInt n, const PetscScalar array[], PetscInt first, PetscInt stride, DofValues *compressed)
{
  PetscInt count = 0;

  PetscFunctionBegin;
  for (PetscInt i = first; i < n; i += stride) count += array[i] != 0;
  PetscCall(PetscMalloc1(count, &compressed->dofs));
  PetscCall(PetscMalloc1(count, &compressed->values));
  compressed->n = 0;
  for (PetscInt i = first; i < n; i += stride) {
    if (array[i] == 0) continue;
    compressed->dofs[compressed->n]     = i;
    compressed->values[compressed->n++] = PetscRealPart(array[i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
