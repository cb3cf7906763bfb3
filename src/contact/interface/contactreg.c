/* The registry of contact methods, and the package of the class. */
#include <contact/parts.h>
#include <sys/package.h>

PetscFunctionList ContactList = NULL;

/*@C
  ContactRegister - adds a contact method to the registry

  Not Collective

  Input Parameters:
+ name   - its name for `-contact_type`
- create - function that sets up the type-specific part of a `Contact`

  Level: developer

  Note:
  What the function has to fill in is in `<impakt/private/contactimpl.h>`; src/contact/tutorials has an example.

.seealso: `Contact`, `ContactSetType()`
@*/
PetscErrorCode ContactRegister(const char name[], PetscErrorCode (*create)(Contact))
{
  PetscFunctionBegin;
  PetscAssertPointer(name, 1);
  PetscCall(ContactInitializePackage());
  PetscCall(PetscFunctionListAdd(&ContactList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Events, and all methods and laws that Impakt brings */
static PetscErrorCode RegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventRegister("ContactStep", CONTACT_CLASSID, &CONTACT_Step));
  PetscCall(PetscLogEventRegister("ContactSweep", CONTACT_CLASSID, &CONTACT_Sweep));
  PetscCall(PetscLogEventRegister("ContactUpdate", CONTACT_CLASSID, &CONTACT_Update));
  PetscCall(PetscLogEventRegister("ContactFactor", CONTACT_CLASSID, &CONTACT_Factor));
  PetscCall(ContactRegister(CONTACT_SCHWARZ, ContactCreate_Schwarz));
  PetscCall(ContactRegister(CONTACT_ALTERNATION, ContactCreate_Alternation));
  PetscCall(ContactRegister(CONTACT_PENALTY, ContactCreate_Penalty));
  PetscCall(ContactRegister(CONTACT_LAGRANGE, ContactCreate_Lagrange));
  PetscCall(ContactRegister(CONTACT_AUGMENTED_LAGRANGIAN, ContactCreate_AugmentedLagrangian));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Empty(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&ContactList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactInitializePackage(void)
{
  PetscFunctionBegin;
  PetscCall(ImpaktRegisterClass("Contact", &CONTACT_CLASSID, RegisterAll, Empty));
  PetscFunctionReturn(PETSC_SUCCESS);
}
