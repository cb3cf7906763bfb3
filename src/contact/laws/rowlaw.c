/* The registry of the laws of the contact step. */
#include "rowlaw.h"
#include <sys/names.h>

static PetscFunctionList RowLawList = NULL;

static PetscErrorCode Register(const char name[], PetscErrorCode (*create)(RowLaw *))
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(&RowLawList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define ROW_LAW_REGISTER(law) PetscCall(Register(#law, RowLawCreate_##law));

PetscErrorCode RowLawRegisterAll(void)
{
  PetscFunctionBegin;
  ROW_LAWS(ROW_LAW_REGISTER)
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowLawDestroyList(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&RowLawList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowLawCreate(const char name[], RowLaw *law)
{
  PetscErrorCode (*create)(RowLaw *);

  PetscFunctionBegin;
  PetscCall(PetscFunctionListFind(RowLawList, name, &create));
  if (!create) {
    char known[1024];

    PetscCall(NamesOfRegistry(RowLawList, sizeof(known), known));
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown law of rows '%s'; known: %s", name, known);
  }
  PetscCall(PetscMemzero(law, sizeof(*law)));
  PetscCall((*create)(law));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names of the laws with parameters, which users give, in the order in which these have been registered. The registry owns them. */
PetscErrorCode RowLawListNamed(PetscInt room, const char *names[], PetscInt *n)
{
  const char **all;
  int          n_all;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(PetscFunctionListGet(RowLawList, &all, &n_all));
  for (int k = 0; k < n_all && *n < room; k++) {
    RowLaw law;

    PetscCall(RowLawCreate(all[k], &law));
    if (law.n_parameters) names[(*n)++] = all[k];
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
