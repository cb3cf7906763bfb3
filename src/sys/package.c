/* The packages of all classes: each is filled when it is first used, and PetscFinalize() empties it. */
#include "package.h"

#define MAX_CLASSES 16

/* Since the start of PETSc */
static struct {
  PetscInt      n;
  PetscClassId *ids[MAX_CLASSES];
  PetscErrorCode (*empty[MAX_CLASSES])(void);
} classes;

static PetscErrorCode Forget(void)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < classes.n; i++) {
    if (classes.empty[i]) PetscCall((*classes.empty[i])());
    *classes.ids[i] = 0;
  }
  classes.n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What every XxxInitializePackage() calls: registers a class once, by its id, which is 0 until then. `fill` registers events and types,
   `empty` frees the registry; both may be NULL. `-info` and `-log_exclude` may name the class, in small letters. */
PetscErrorCode ImpaktRegisterClass(const char class[], PetscClassId *id, PetscErrorCode (*fill)(void), PetscErrorCode (*empty)(void))
{
  char      name[64], excluded[256];
  PetscBool set, listed = PETSC_FALSE;

  PetscFunctionBegin;
  if (*id) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(classes.n < MAX_CLASSES, PETSC_COMM_SELF, PETSC_ERR_PLIB, "There are more than %d classes", MAX_CLASSES);
  if (!classes.n) PetscCall(PetscRegisterFinalize(Forget));
  classes.ids[classes.n]     = id;
  classes.empty[classes.n++] = empty;
  PetscCall(PetscClassIdRegister(class, id));
  if (fill) PetscCall((*fill)());
  PetscCall(PetscStrncpy(name, class, sizeof(name)));
  PetscCall(PetscStrtolower(name));
  PetscCall(PetscInfoProcessClass(name, 1, id));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-log_exclude", excluded, sizeof(excluded), &set));
  if (set) PetscCall(PetscStrInList(name, excluded, ',', &listed));
  if (listed) PetscCall(PetscLogEventExcludeClass(*id));
  PetscFunctionReturn(PETSC_SUCCESS);
}
