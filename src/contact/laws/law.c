/* The registry of friction laws, and what users choose of them. */
#include "friction.h"
#include <sys/names.h>

PetscFunctionList ContactLawList = NULL;

/*@C
  ContactLawRegister - adds a friction law to the registry

  Not Collective

  Input Parameters:
+ name   - its name for `-contact_law`
- create - function that fills in the operations of a `ContactFrictionLaw`

  Level: developer

  Note:
  A law tells how large the force across the normal of a contact node may be, as a number plus a coefficient times the normal force. What a
  node does within that bound is the same for all laws: below the bound it sticks, at the bound it slides against the force. The operations
  are in `<impakt/private/contactimpl.h>`.

.seealso: `Contact`, `ContactSetFrictionLaw()`
@*/
PetscErrorCode ContactLawRegister(const char name[], PetscErrorCode (*create)(Contact, ContactFrictionLaw *))
{
  PetscFunctionBegin;
  PetscAssertPointer(name, 1);
  PetscCall(ContactInitializePackage());
  PetscCall(PetscFunctionListAdd(&ContactLawList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactLawRegisterAll - registers the friction laws that Impakt brings */
PetscErrorCode ContactLawRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(ContactLawRegister("coulomb", ContactLawCreate_Coulomb));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forgets the friction law */
PetscErrorCode ContactDestroyFrictionLaw(Contact contact)
{
  PetscFunctionBegin;
  if (contact->friction.law.destroy) PetscCall((*contact->friction.law.destroy)(contact->friction.law.data));
  PetscCall(PetscMemzero(&contact->friction.law, sizeof(contact->friction.law)));
  PetscCall(PetscFree(contact->friction.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes a friction law of the registry */
static PetscErrorCode TakeLaw(Contact contact, const char name[])
{
  PetscErrorCode (*create)(Contact, ContactFrictionLaw *);

  PetscFunctionBegin;
  PetscCall(PetscFunctionListFind(ContactLawList, name, &create));
  if (!create) {
    char known[1024];

    PetscCall(NamesOfRegistry(ContactLawList, sizeof(known), known));
    SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown friction law '%s'; known: %s", name, known);
  }
  PetscCall(ContactDestroyFrictionLaw(contact));
  PetscCall((*create)(contact, &contact->friction.law));
  PetscCall(PetscStrallocpy(name, &contact->friction.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ContactSetFrictionLaw - lets contact surfaces resist sliding

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- name    - the law: `coulomb`, or one that has been added by `ContactLawRegister()`

  Options Database Key:
. -contact_law coulomb - Coulomb friction

  Level: beginner

  Note:
  The law becomes `CONTACT_LAW_FRICTION`.

.seealso: `Contact`, `ContactSetFriction()`, `ContactSetLaw()`, `ContactLawRegister()`
@*/
PetscErrorCode ContactSetFrictionLaw(Contact contact, const char name[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(name, 2);
  ContactCheckNotSetUp(contact);
  PetscCall(TakeLaw(contact, name));
  ContactSpreadLaw(contact, CONTACT_LAW_FRICTION);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ContactSetPairFrictionLaw - lets the surfaces of a pair resist sliding

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. pair    - 0 to the number of pairs - 1
- name    - the law: `coulomb`, or one that has been added by `ContactLawRegister()`; the same for all pairs that have friction

  Options Database Key:
. -contact_law_<pair> coulomb - Coulomb friction

  Level: intermediate

.seealso: `Contact`, `ContactSetFrictionLaw()`, `ContactSetPairLaw()`, `ContactSetPairFriction()`
@*/
PetscErrorCode ContactSetPairFrictionLaw(Contact contact, PetscInt pair, const char name[])
{
  PetscBool same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(name, 3);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  if (contact->friction.name) PetscCall(PetscStrcmp(contact->friction.name, name, &same));
  PetscCheck(same || !contact->friction.name, PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_law_%s %s: other pairs have the friction law %s, and all pairs with friction have the same",
             contact->pairs[pair].name, name, contact->friction.name);
  if (!same) PetscCall(TakeLaw(contact, name));
  contact->pairs[pair].law     = CONTACT_LAW_FRICTION;
  contact->pairs[pair].own_law = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetFriction - sets the coefficient of friction of all pairs that have none of their own

  Logically Collective

  Input Parameters:
+ contact     - the `Contact`, not yet set up
- coefficient - of nodes that stick, and of those that slide unless `ContactSetKineticFriction()` says otherwise; not negative

  Options Database Key:
. -contact_friction mu - the coefficient

  Level: beginner

.seealso: `Contact`, `ContactSetFrictionLaw()`, `ContactSetPairFriction()`, `ContactSetKineticFriction()`
@*/
PetscErrorCode ContactSetFriction(Contact contact, PetscReal coefficient)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, coefficient, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck(coefficient >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_friction %g: a coefficient of friction must not be negative", (double)coefficient);
  contact->options.friction = coefficient;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetPairFriction - gives a pair a coefficient of friction of its own

  Logically Collective

  Input Parameters:
+ contact     - the `Contact`, not yet set up
. pair        - 0 to the number of pairs - 1
- coefficient - not negative

  Options Database Key:
. -contact_friction_<pair> mu - the coefficient of the pair, which is named as in -contact_pairs

  Level: intermediate

.seealso: `Contact`, `ContactSetFriction()`, `ContactAddPair()`
@*/
PetscErrorCode ContactSetPairFriction(Contact contact, PetscInt pair, PetscReal coefficient)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, coefficient, 3);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  PetscCheck(coefficient >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_friction_%s %g: a coefficient of friction must not be negative", contact->pairs[pair].name, (double)coefficient);
  contact->pairs[pair].friction     = coefficient;
  contact->pairs[pair].own_friction = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetKineticFriction - sets to what the coefficient of friction falls with the speed of sliding

  Logically Collective

  Input Parameters:
+ contact     - the `Contact`, not yet set up
. coefficient - mu_k, of fast sliding, at most the coefficient of sticking mu_s of any pair; not negative
- decay       - d in mu_k + (mu_s - mu_k) exp(-d |v|) [s/m]; positive

  Options Database Keys:
+ -contact_friction_kinetic mu - the coefficient of fast sliding
- -contact_friction_decay d    - the decay [s/m]

  Level: intermediate

  Note:
  The speed |v| of a node is that of the last controller step, so that the coefficient does not change within a step.

.seealso: `Contact`, `ContactSetFriction()`
@*/
PetscErrorCode ContactSetKineticFriction(Contact contact, PetscReal coefficient, PetscReal decay)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, coefficient, 2);
  PetscValidLogicalCollectiveReal(contact, decay, 3);
  ContactCheckNotSetUp(contact);
  PetscCheck(coefficient >= 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_friction_kinetic %g: a coefficient of friction must not be negative", (double)coefficient);
  PetscCheck(decay > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_friction_decay %g: the decay with the speed of sliding must be positive [s/m]", (double)decay);
  contact->options.friction_kinetic = coefficient;
  contact->options.friction_decay   = decay;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Coefficients from the options, once the pairs are known */
PetscErrorCode ContactReadFriction(Contact contact)
{
  PetscReal mu = PetscMax(contact->options.friction, 0), kinetic = 0, decay = 0;
  PetscBool set, set_decay;

  PetscFunctionBegin;
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_friction", "Coefficient of friction", "ContactSetFriction", mu, &mu, &set));
  if (set) PetscCall(ContactSetFriction(contact, mu));
  PetscCall(
      PetscOptionsReal("-contact_friction_kinetic", "Coefficient of fast sliding", "ContactSetKineticFriction", kinetic, &kinetic, &set));
  PetscCall(PetscOptionsReal("-contact_friction_decay", "How fast it falls to that with the speed of sliding [s/m]",
                             "ContactSetKineticFriction", decay, &decay, &set_decay));
  PetscCheck(set == set_decay, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_friction_kinetic and -contact_friction_decay go together: the coefficient is mu_k + (mu_s - mu_k) exp(-d |v|)");
  if (set) PetscCall(ContactSetKineticFriction(contact, kinetic, decay));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    char option[PETSC_MAX_PATH_LEN];

    if (contact->pairs[p].law != CONTACT_LAW_FRICTION) continue; /* an option that stays unread is an error */
    PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_friction_%s", contact->pairs[p].name));
    PetscCall(PetscOptionsReal(option, "Coefficient of friction of a pair", "ContactSetPairFriction", mu, &mu, &set));
    if (set) PetscCall(ContactSetPairFriction(contact, p, mu));
  }
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}
