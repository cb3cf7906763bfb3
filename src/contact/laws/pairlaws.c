/* Which law each pair has: that of all pairs, or one of its own; and which methods take which laws. */
#include "friction.h"
#include "glue.h"
#include <sys/optionvalues.h>

const char *const ContactLaws[] = {"frictionless", "tied", "bonded", "glue", "friction", "ContactLaw", "CONTACT_LAW_", NULL};

/* The name that users give to the law of a pair; NULL: to that of pairs that have none of their own */
const char *ContactNameLaw(Contact contact, const ContactPair *pair)
{
  const ContactLaw law  = pair ? pair->law : contact->options.law;
  const PetscInt   glue = pair ? pair->glue : contact->options.glue;

  if (law == CONTACT_LAW_GLUE) return contact->glues[glue].name;
  return law == CONTACT_LAW_FRICTION ? contact->friction.name : ContactLaws[law];
}

/* The law of pairs that have none of their own */
void ContactSpreadLaw(Contact contact, ContactLaw law)
{
  contact->options.law = law;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (contact->pairs[p].own_law) continue;
    contact->pairs[p].law  = law;
    contact->pairs[p].glue = contact->options.glue;
  }
}

static PetscErrorCode CheckLaw(Contact contact, ContactLaw law)
{
  PetscFunctionBegin;
  PetscCheck((int)law >= 0 && law < CONTACT_LAW_GLUE, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "There is no contact law %d", (int)law);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetLaw - sets what contact surfaces do to each other

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
- law - a `ContactLaw`, `CONTACT_LAW_FRICTIONLESS` by default; `CONTACT_LAW_GLUE` by
  `ContactSetGlueLaw()`, `CONTACT_LAW_FRICTION` by `ContactSetFrictionLaw()`

  Options Database Key:
. -contact_law (frictionless|tied|bonded|coulomb|...) - the law

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
- law     - a `ContactLaw`; `CONTACT_LAW_GLUE` by `ContactSetPairGlueLaw()`, `CONTACT_LAW_FRICTION` by `ContactSetPairFrictionLaw()`

  Options Database Key:
. -contact_law_<pair> (frictionless|tied|bonded|coulomb|...) - the law of the pair, which is named as in -contact_pairs

  Level: intermediate

  Note:
  Pairs of different laws need `CONTACT_SCHWARZ`.

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

/* The law of a pair from the options, or, before the pairs are known, that of all pairs (`pair` -1): one of the enumeration, a law of glue,
   or one of the registry of friction laws */
PetscErrorCode ContactReadLaw(Contact contact, PetscInt pair)
{
  const char *const *friction = NULL;
  const char        *names[64], *now = ContactNameLaw(contact, pair < 0 ? NULL : &contact->pairs[pair]);
  char               option[PETSC_MAX_PATH_LEN] = "-contact_law";
  PetscInt           n = 0, n_glue, chosen = 0;
  int                n_friction = 0;
  PetscBool          set;

  PetscFunctionBegin;
  if (pair >= 0) PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_law_%s", contact->pairs[pair].name));
  for (ContactLaw law = CONTACT_LAW_FRICTIONLESS; law < CONTACT_LAW_GLUE; law = (ContactLaw)(law + 1)) names[n++] = ContactLaws[law];
  PetscCall(RowLawListGlue((PetscInt)PETSC_STATIC_ARRAY_LENGTH(names) - n, names + n, &n_glue));
  n += n_glue;
  PetscCall(PetscFunctionListGet(ContactLawList, (const char ***)&friction, &n_friction));
  for (int k = 0; k < n_friction && n < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(names); k++) names[n++] = friction[k];
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEList(option, "What the surfaces do to each other", pair < 0 ? "ContactSetLaw" : "ContactSetPairLaw", names, n, now,
                              &chosen, &set));
  PetscOptionsEnd();
  if (set && chosen >= CONTACT_LAW_GLUE + n_glue)
    PetscCall(pair < 0 ? ContactSetFrictionLaw(contact, names[chosen]) : ContactSetPairFrictionLaw(contact, pair, names[chosen]));
  else if (set && chosen >= CONTACT_LAW_GLUE)
    PetscCall(pair < 0 ? ContactSetGlueLaw(contact, names[chosen]) : ContactSetPairGlueLaw(contact, pair, names[chosen]));
  else if (set) PetscCall(pair < 0 ? ContactSetLaw(contact, (ContactLaw)chosen) : ContactSetPairLaw(contact, pair, (ContactLaw)chosen));
  PetscCall(PetscFree(friction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses laws that the method has not, and pairs of different laws where it takes one for all */
PetscErrorCode ContactCheckLaws(Contact contact)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  const char    *type = ((PetscObject)contact)->type_name;
  const char    *way  = ContactNameLaw(contact, contact->n_pairs ? &contact->pairs[0] : NULL); /* the law that is in the way */
  PetscBool      slides;

  PetscFunctionBegin;
  for (PetscInt p = 1; p < contact->n_pairs && !contact->sideless; p++)
    PetscCheck(
        contact->pairs[p].law == contact->pairs[0].law, comm, PETSC_ERR_SUP,
        "Pair %s has the law %s, and pair %s the law %s: -contact_type %s has one law for all pairs; choose -contact_type schwarz, or "
        "leave -contact_law_<pair> out",
        contact->pairs[p].name, ContactNameLaw(contact, &contact->pairs[p]), contact->pairs[0].name, way, type);
  PetscCheck(contact->sideless || !ContactAnyPairHas(contact, CONTACT_LAW_FRICTION), comm, PETSC_ERR_SUP,
             "-contact_law %s: -contact_type %s has no friction; choose -contact_type schwarz, lagrange, penalty or augmented_lagrangian",
             contact->friction.name, type);
  PetscCheck(contact->impulses || !ContactAnyPairHas(contact, CONTACT_LAW_GLUE), comm, PETSC_ERR_SUP,
             "-contact_law %s works with -contact_type schwarz alone, not with %s; choose that, or -contact_law tied", way, type);
  PetscCheck(contact->impulses || contact->prescribes || !ContactAnyPairHas(contact, CONTACT_LAW_BONDED), comm, PETSC_ERR_SUP,
             "-contact_law bonded works with -contact_type schwarz or alternation alone, not with %s; choose one of these, or -contact_law "
             "frictionless or tied",
             type);
  PetscCall(ContactCheckGlue(contact));
  if (contact->options.separation) PetscFunctionReturn(PETSC_SUCCESS);
  /* of pairs of several laws those that touch must be frictionless */
  if (ContactAnyPairHas(contact, CONTACT_LAW_FRICTIONLESS)) way = ContactLaws[CONTACT_LAW_FRICTIONLESS];
  if (ContactAnyPairHas(contact, CONTACT_LAW_BONDED)) way = ContactLaws[CONTACT_LAW_BONDED];
  if (ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) way = contact->friction.name;
  PetscCall(PetscStrcmp(way, ContactLaws[CONTACT_LAW_FRICTIONLESS], &slides));
  PetscCheck(
      (contact->impulses || contact->prescribes) && slides, comm, PETSC_ERR_SUP,
      "-contact_separation false works with -contact_type schwarz or alternation and -contact_law frictionless alone, not with %s and %s",
      type, way);
  PetscFunctionReturn(PETSC_SUCCESS);
}
