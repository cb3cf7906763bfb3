/* The registry of the laws of the contact step. */
#include "rowlaw.h"
#include <sys/names.h>

static PetscFunctionList RowLawList = NULL;

/* Adds a law; `create` fills in its members */
PetscErrorCode RowLawRegister(const char name[], PetscErrorCode (*create)(RowLaw *))
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(&RowLawList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowLawRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(RowLawRegister("unilateral", RowLawCreate_Unilateral));
  PetscCall(RowLawRegister("tie", RowLawCreate_Tie));
  PetscCall(RowLawRegister("hold", RowLawCreate_Hold));
  PetscCall(RowLawRegister("spring", RowLawCreate_Spring));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowLawDestroyList(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&RowLawList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The law of a name */
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
