/* What the packages of all classes end their registration with. */
#include "package.h"

/* The end of every XxxInitializePackage(), after class id, events and registry: `-info` and `-log_exclude` may name the class, and
   PetscFinalize() calls the counterpart */
PetscErrorCode ImpaktFinishPackage(const char name[], PetscClassId id, PetscErrorCode (*finalize)(void))
{
  char      excluded[256];
  PetscBool set, listed = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscInfoProcessClass(name, 1, &id));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-log_exclude", excluded, sizeof(excluded), &set));
  if (set) PetscCall(PetscStrInList(name, excluded, ',', &listed));
  if (listed) PetscCall(PetscLogEventExcludeClass(id));
  PetscCall(PetscRegisterFinalize(finalize));
  PetscFunctionReturn(PETSC_SUCCESS);
}
