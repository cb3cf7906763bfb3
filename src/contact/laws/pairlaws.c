/* Which law each pair has: that of all pairs, or one of its own; the stiffness of springs; and which methods take which laws. */
#include "friction.h"
#include <sys/optionvalues.h>

const char *const ContactLaws[] = {"frictionless", "tied", "bonded", "spring", "friction", "ContactLaw", "CONTACT_LAW_", NULL};

/* The name that users give to a law */
const char *ContactNameLaw(Contact contact, ContactLaw law)
{
  return law == CONTACT_LAW_FRICTION ? contact->friction.name : ContactLaws[law];
}

/* The law of pairs that have none of their own */
void ContactSpreadLaw(Contact contact, ContactLaw law)
{
  contact->options.law = law;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].own_law) contact->pairs[p].law = law;
}

static PetscErrorCode CheckLaw(Contact contact, ContactLaw law)
{
  PetscFunctionBegin;
  PetscCheck((int)law >= 0 && law < CONTACT_LAW_FRICTION, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no contact law %d", (int)law);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetLaw - sets what contact surfaces do to each other

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- law - a `ContactLaw`, `CONTACT_LAW_FRICTIONLESS` by default; `CONTACT_LAW_FRICTION` by `ContactSetFrictionLaw()`

  Options Database Key:
. -contact_law (frictionless|tied|bonded|spring|coulomb) - the law

  Level: beginner

.seealso: `Contact`, `ContactGetLaw()`, `ContactSetPairLaw()`, `ContactSetFrictionLaw()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetLaw(Contact contact, ContactLaw law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(contact, law, 2);
  ContactCheckNotSetUp(contact);
  PetscCall(CheckLaw(contact, law));
  ContactSpreadLaw(contact, law);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetLaw - what contact surfaces do to each other

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. law - see `ContactSetLaw()`: that of pairs that have none of their own

  Level: beginner

.seealso: `Contact`, `ContactSetLaw()`, `ContactGetPairLaw()`
@*/
PetscErrorCode ContactGetLaw(Contact contact, ContactLaw *law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(law, 2);
  *law = contact->options.law;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetPairLaw - gives a pair a law of its own

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. pair    - 0 to the number of pairs - 1
- law     - a `ContactLaw`; `CONTACT_LAW_FRICTION` by `ContactSetPairFrictionLaw()`

  Options Database Key:
. -contact_law_<pair> (frictionless|tied|bonded|spring|coulomb) - the law of the pair, which is named as in -contact_pairs

  Level: intermediate

  Note:
  Pairs of different laws need `CONTACT_FORCE`.

.seealso: `Contact`, `ContactSetLaw()`, `ContactGetPairLaw()`, `ContactAddPair()`
@*/
PetscErrorCode ContactSetPairLaw(Contact contact, PetscInt pair, ContactLaw law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(contact, law, 3);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  PetscCall(CheckLaw(contact, law));
  contact->pairs[pair].law     = law;
  contact->pairs[pair].own_law = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetPairLaw - the law of a pair

  Not Collective

  Input Parameters:
+ contact - the `Contact`
- pair    - 0 to the number of pairs - 1

  Output Parameter:
. law - its own, or that of all pairs

  Level: intermediate

.seealso: `Contact`, `ContactSetPairLaw()`, `ContactHasLaw()`
@*/
PetscErrorCode ContactGetPairLaw(Contact contact, PetscInt pair, ContactLaw *law)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(law, 3);
  ContactCheckPair(contact, pair);
  *law = contact->neighbours.come_and_go ? contact->options.law : contact->pairs[pair].law;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactHasLaw - whether any pair has a law

  Not Collective

  Input Parameters:
+ contact - the `Contact`
- law     - the law

  Output Parameter:
. has - whether a pair has it; where pairs come and go, whether those to come have it

  Level: intermediate

.seealso: `Contact`, `ContactGetPairLaw()`
@*/
PetscErrorCode ContactHasLaw(Contact contact, ContactLaw law, PetscBool *has)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(has, 3);
  *has = ContactAnyPairHas(contact, law);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetSpringStiffness - sets the stiffness of the springs of all pairs that have none of their own

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, not yet set up
- stiffness - force per area and opening [N/m^3]; positive

  Options Database Key:
. -contact_spring_stiffness k - the stiffness [N/m^3]

  Level: intermediate

  Note:
  With `CONTACT_LAW_SPRING`. Glue of the modulus E and the thickness t has about E/t.

.seealso: `Contact`, `ContactSetLaw()`, `ContactSetPairSpringStiffness()`
@*/
PetscErrorCode ContactSetSpringStiffness(Contact contact, PetscReal stiffness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, stiffness, 2);
  ContactCheckNotSetUp(contact);
  PetscCheck(stiffness > 0 && stiffness < PETSC_INFINITY, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_spring_stiffness %g: springs need a positive stiffness per unit of area; -contact_law tied is rigid",
             (double)stiffness);
  contact->options.spring_stiffness = stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetPairSpringStiffness - gives the springs of a pair a stiffness of their own

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, not yet set up
. pair      - 0 to the number of pairs - 1
- stiffness - force per area and opening [N/m^3]; positive

  Options Database Key:
. -contact_spring_stiffness_<pair> k - the stiffness of the pair, which is named as in -contact_pairs [N/m^3]

  Level: intermediate

.seealso: `Contact`, `ContactSetPairLaw()`, `ContactSetSpringStiffness()`
@*/
PetscErrorCode ContactSetPairSpringStiffness(Contact contact, PetscInt pair, PetscReal stiffness)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveReal(contact, stiffness, 3);
  ContactCheckNotSetUp(contact);
  ContactCheckPair(contact, pair);
  PetscCheck(stiffness > 0 && stiffness < PETSC_INFINITY, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "-contact_spring_stiffness_%s %g: springs need a positive stiffness per unit of area; -contact_law_%s tied is rigid",
             contact->pairs[pair].name, (double)stiffness, contact->pairs[pair].name);
  contact->pairs[pair].stiffness = stiffness;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The law of a pair from the options, or, before the pairs are known, that of all pairs (`pair` -1): one of the enumeration, or one of the
   registry of friction laws */
PetscErrorCode ContactReadLaw(Contact contact, PetscInt pair)
{
  const char *const *laws = NULL;
  const char        *names[64], *now;
  char               option[PETSC_MAX_PATH_LEN] = "-contact_law";
  PetscInt           n = 0, chosen = 0;
  int                n_laws = 0;
  PetscBool          set;

  PetscFunctionBegin;
  now = ContactNameLaw(contact, pair < 0 ? contact->options.law : contact->pairs[pair].law);
  if (pair >= 0) PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_law_%s", contact->pairs[pair].name));
  for (ContactLaw law = CONTACT_LAW_FRICTIONLESS; law < CONTACT_LAW_FRICTION; law = (ContactLaw)(law + 1)) names[n++] = ContactLaws[law];
  PetscCall(PetscFunctionListGet(ContactLawList, (const char ***)&laws, &n_laws));
  for (int k = 0; k < n_laws && n < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(names); k++) names[n++] = laws[k];
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEList(option, "What the surfaces do to each other", pair < 0 ? "ContactSetLaw" : "ContactSetPairLaw", names, n, now,
                              &chosen, &set));
  PetscOptionsEnd();
  if (set && chosen >= CONTACT_LAW_FRICTION)
    PetscCall(pair < 0 ? ContactSetFrictionLaw(contact, names[chosen]) : ContactSetPairFrictionLaw(contact, pair, names[chosen]));
  else if (set) PetscCall(pair < 0 ? ContactSetLaw(contact, (ContactLaw)chosen) : ContactSetPairLaw(contact, pair, (ContactLaw)chosen));
  PetscCall(PetscFree(laws));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stiffnesses from the options, once the pairs and their laws are known: an option that stays unread is an error */
PetscErrorCode ContactReadSprings(Contact contact)
{
  PetscReal stiffness = contact->options.spring_stiffness;
  PetscBool set;

  PetscFunctionBegin;
  if (!ContactAnyPairHas(contact, CONTACT_LAW_SPRING)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_spring_stiffness", "Stiffness of springs per unit of area [N/m^3]", "ContactSetSpringStiffness",
                             stiffness, &stiffness, &set));
  if (set) PetscCall(ContactSetSpringStiffness(contact, stiffness));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    char option[PETSC_MAX_PATH_LEN];

    if (contact->pairs[p].law != CONTACT_LAW_SPRING) continue;
    PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_spring_stiffness_%s", contact->pairs[p].name));
    PetscCall(PetscOptionsReal(option, "Stiffness of the springs of a pair", "ContactSetPairSpringStiffness", stiffness, &stiffness, &set));
    if (set) PetscCall(ContactSetPairSpringStiffness(contact, p, stiffness));
  }
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the springs of a pair have a stiffness */
static PetscErrorCode CheckSprings(Contact contact, const ContactPair *pair)
{
  PetscFunctionBegin;
  PetscCheck(pair->stiffness > 0 || contact->options.spring_stiffness > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_law spring needs the stiffness of the springs of the pair %s, in N/m^3: set -contact_spring_stiffness k for all "
             "pairs, or -contact_spring_stiffness_%s k for this one; glue of the modulus E and the thickness t has about E/t",
             pair->name, pair->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses laws that the method has not, and pairs of different laws where it takes one for all */
PetscErrorCode ContactCheckLaws(Contact contact)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  const char    *type = ((PetscObject)contact)->type_name;
  ContactLaw     law  = contact->n_pairs ? contact->pairs[0].law : contact->options.law;

  PetscFunctionBegin;
  for (PetscInt p = 1; p < contact->n_pairs && !contact->sideless; p++)
    PetscCheck(contact->pairs[p].law == law, comm, PETSC_ERR_SUP,
               "Pair %s has the law %s, and pair %s the law %s: -contact_type %s has one law for all pairs; choose -contact_type force, or "
               "leave -contact_law_<pair> out",
               contact->pairs[p].name, ContactNameLaw(contact, contact->pairs[p].law), contact->pairs[0].name, ContactNameLaw(contact, law),
               type);
  PetscCheck(contact->sideless || !ContactAnyPairHas(contact, CONTACT_LAW_SPRING), comm, PETSC_ERR_SUP,
             "-contact_law spring works with -contact_type force alone, not with %s; choose that, or -contact_law tied", type);
  PetscCheck(contact->sideless || contact->prescribes || !ContactAnyPairHas(contact, CONTACT_LAW_BONDED), comm, PETSC_ERR_SUP,
             "-contact_law bonded works with -contact_type schwarz or force alone, not with %s; choose one of these, or -contact_law "
             "frictionless or tied",
             type);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_SPRING) PetscCall(CheckSprings(contact, &contact->pairs[p]));
  if (contact->options.separation) PetscFunctionReturn(PETSC_SUCCESS);
  /* the law that is in the way: of pairs of several laws those that touch must be frictionless */
  if (ContactAnyPairHas(contact, CONTACT_LAW_FRICTIONLESS)) law = CONTACT_LAW_FRICTIONLESS;
  if (ContactAnyPairHas(contact, CONTACT_LAW_BONDED)) law = CONTACT_LAW_BONDED;
  if (ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) law = CONTACT_LAW_FRICTION;
  PetscCheck((contact->sideless || contact->prescribes) && law == CONTACT_LAW_FRICTIONLESS, comm, PETSC_ERR_SUP,
             "-contact_separation false works with -contact_type schwarz or force and -contact_law frictionless alone, not with %s and %s",
             type, ContactNameLaw(contact, law));
  PetscFunctionReturn(PETSC_SUCCESS);
}
