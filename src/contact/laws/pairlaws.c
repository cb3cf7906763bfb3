/* Which law each pair has: that of all pairs, or one of its own; the parameters of these laws; and which methods take which laws. */
#include "pairlaws.h"
#include <sys/names.h>

#define MOST_LAWS 64

const char *const ContactLaws[] = {"frictionless", "tied", "bonded", "glue", "friction", "ContactLaw", "CONTACT_LAW_", NULL};

/* The name that users give to the law of a pair; NULL: to that of pairs that have none of their own */
const char *ContactNameLaw(Contact contact, const ContactPair *pair)
{
  const ContactLaw law   = pair ? pair->law : contact->options.law;
  const PetscInt   named = pair ? pair->named : contact->options.named;

  return law >= CONTACT_LAW_GLUE ? contact->laws[named].name : ContactLaws[law];
}

/* Ends with an error where any pair has friction; `why`: what is in its way, and what to choose */
PetscErrorCode ContactRefuseFriction(Contact contact, const char why[])
{
  const ContactPair *pair = NULL;

  PetscFunctionBegin;
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_FRICTION) pair = &contact->pairs[p];
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP, "-contact_law %s: %s", ContactNameLaw(contact, pair), why);
}

/* The names of all laws that users may choose: those of the enumeration, then those of the registry with parameters, which owns them */
static PetscErrorCode ListLaws(const char *names[MOST_LAWS], PetscInt *n)
{
  PetscInt more;

  PetscFunctionBegin;
  for (*n = 0; *n < CONTACT_LAW_GLUE; (*n)++) names[*n] = ContactLaws[*n];
  PetscCall(RowLawListNamed(MOST_LAWS - *n, names + *n, &more));
  *n += more;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of a law with parameters among those that have been named */
static PetscErrorCode TakeLaw(Contact contact, const char name[], PetscInt *named)
{
  ContactNamedLaw *found;

  PetscFunctionBegin;
  for (*named = 0; *named < contact->n_laws; (*named)++) {
    PetscBool same;

    PetscCall(PetscStrcmp(contact->laws[*named].name, name, &same));
    if (same) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscRealloc((size_t)(contact->n_laws + 1) * sizeof(ContactNamedLaw), &contact->laws));
  found = &contact->laws[contact->n_laws];
  PetscCall(RowLawCreate(name, &found->law));
  PetscCall(PetscStrncpy(found->name, name, sizeof(found->name)));
  for (PetscInt k = 0; k < ROW_LAW_PARAMETERS; k++) found->parameters[k] = -1;
  contact->n_laws++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ContactSetLaw - sets what the surfaces of a pair do to each other, or of all pairs

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, not yet set up
. pair    - 0 to the number of pairs - 1; -1 for all pairs that have no law of their own
- law     - `frictionless`, which is the default, `tied`, `bonded`, a law of glue, as `spring`, or one of friction, as `coulomb`

  Options Database Keys:
+ -contact_law (frictionless|tied|bonded|coulomb|...)        - the law of all pairs
- -contact_law_<pair> (frictionless|tied|bonded|coulomb|...) - the law of a pair, which is named as in -contact_pairs

  Level: beginner

  Note:
  Pairs of different laws need `CONTACT_SCHWARZ`.

.seealso: `Contact`, `ContactGetPairLaw()`, `ContactSetLawParameter()`, `ContactAddPair()`, `ContactSetFromOptions()`
@*/
PetscErrorCode ContactSetLaw(Contact contact, PetscInt pair, const char law[])
{
  const char *names[MOST_LAWS];
  PetscInt    n, chosen, named = 0;
  PetscBool   same = PETSC_FALSE;
  ContactLaw  kind;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, pair, 2);
  PetscAssertPointer(law, 3);
  ContactCheckNotSetUp(contact);
  if (pair >= 0) ContactCheckPair(contact, pair);
  PetscCall(ListLaws(names, &n));
  for (chosen = 0; chosen < n && !same; chosen += !same) PetscCall(PetscStrcmp(names[chosen], law, &same));
  if (!same) {
    char known[1024] = "";

    for (PetscInt k = 0; k < n; k++) PetscCall(NamesAppend(known, sizeof(known), ", ", names[k]));
    SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown contact law '%s'; known: %s", law, known);
  }
  kind = (ContactLaw)chosen;
  if (chosen >= CONTACT_LAW_GLUE) {
    PetscCall(TakeLaw(contact, law, &named));
    kind = contact->laws[named].law.bound ? CONTACT_LAW_FRICTION : CONTACT_LAW_GLUE;
  }
  if (pair < 0) {
    contact->options.law   = kind;
    contact->options.named = named;
  } else contact->pairs[pair].own_law = PETSC_TRUE;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (pair >= 0 ? p != pair : contact->pairs[p].own_law) continue;
    contact->pairs[p].law   = kind;
    contact->pairs[p].named = named;
  }
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

.seealso: `Contact`, `ContactSetLaw()`, `ContactGetTraits()`
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

/* Whether any pair is glued by a law with damage */
PetscBool ContactGlueBreaks(Contact contact)
{
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (contact->pairs[p].law == CONTACT_LAW_GLUE && contact->laws[contact->pairs[p].named].law.n_history) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Of a parameter, with a space before it, or nothing */
static const char *UnitOf(Contact contact, const RowLawParameter *parameter)
{
  return parameter->unit == UNIT_ONE ? "" : UnitsOf((PetscObject)contact, parameter->unit);
}

/* The option of a parameter of a law; of a pair unless that is NULL */
static PetscErrorCode NameOption(const ContactNamedLaw *law, PetscInt k, const ContactPair *pair, char option[PETSC_MAX_PATH_LEN])
{
  const PetscBool bare = (PetscBool)(law->law.bound != NULL);

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, PETSC_MAX_PATH_LEN, "-contact_%s%s%s%s%s", bare ? "" : law->name, bare ? "" : "_",
                          law->law.parameters[k].name, pair ? "_" : "", pair ? pair->name : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ContactSetLawParameter - sets a parameter of a law of glue or friction, of a pair, or of all pairs

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, not yet set up
. pair      - 0 to the number of pairs - 1, of a pair that has the law; -1 for all pairs that have no such parameter of their own
. law       - name of the law, as `spring`
. parameter - name of the parameter, as `stiffness`
- value     - positive, or not negative, in the unit that the law says

  Options Database Keys:
+ -contact_<law>_<parameter> x        - as -contact_spring_stiffness k [N/m^3]
. -contact_<law>_<parameter>_<pair> x - of a pair, which is named as in -contact_pairs
. -contact_friction mu                - parameter `friction` of `coulomb`, the coefficient of friction; -contact_friction_<pair> of a pair
- -contact_friction_kinetic mu, -contact_friction_decay d - `friction_kinetic` and `friction_decay` of `coulomb`, of all pairs: to what the
                                                            coefficient falls with the speed v of sliding, as exp(-d v) [s/m]

  Level: intermediate

.seealso: `Contact`, `ContactSetLaw()`
@*/
PetscErrorCode ContactSetLawParameter(Contact contact, PetscInt pair, const char law[], const char parameter[], PetscReal value)
{
  const MPI_Comm         comm = PetscObjectComm((PetscObject)contact);
  const ContactNamedLaw *named;
  const RowLawParameter *found;
  PetscInt               number, k;
  PetscBool              same = PETSC_FALSE;
  char                   option[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, pair, 2);
  PetscAssertPointer(law, 3);
  PetscAssertPointer(parameter, 4);
  PetscValidLogicalCollectiveReal(contact, value, 5);
  ContactCheckNotSetUp(contact);
  PetscCall(TakeLaw(contact, law, &number));
  named = &contact->laws[number];
  for (k = 0; k < named->law.n_parameters && !same; k += !same) PetscCall(PetscStrcmp(named->law.parameters[k].name, parameter, &same));
  PetscCheck(same, comm, PETSC_ERR_ARG_OUTOFRANGE, "-contact_law %s has no parameter '%s'", law, parameter);
  if (pair >= 0) {
    ContactCheckPair(contact, pair);
    PetscCheck(!named->law.parameters[k].optional, comm, PETSC_ERR_ARG_OUTOFRANGE, "'%s' of the law %s is the same for all pairs",
               parameter, law);
    PetscCheck(contact->pairs[pair].law >= CONTACT_LAW_GLUE && contact->pairs[pair].named == number, comm, PETSC_ERR_ARG_WRONGSTATE,
               "Pair %s does not have the law %s: call ContactSetLaw() first", contact->pairs[pair].name, law);
  }
  found = &named->law.parameters[k];
  PetscCall(NameOption(named, k, pair < 0 ? NULL : &contact->pairs[pair], option));
  PetscCheck((value > 0 || (found->may_be_zero && value == 0)) && value < PETSC_INFINITY, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "%s %g%s must %s, and be finite%s%s", option, (double)value, UnitOf(contact, found),
             found->may_be_zero ? "not be negative" : "be positive", found->hint ? "; " : "", found->hint ? found->hint : "");
  (pair < 0 ? contact->laws[number].parameters : contact->pairs[pair].parameters)[k] = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The parameters of a pair, or of those to come (NULL); less than 0: not set */
void ContactGetLawParameters(Contact contact, const ContactPair *pair, PetscReal parameters[])
{
  const ContactNamedLaw *named = &contact->laws[pair ? pair->named : contact->options.named];

  for (PetscInt k = 0; k < ROW_LAW_PARAMETERS; k++)
    parameters[k] = pair && pair->parameters[k] >= 0 ? pair->parameters[k] : named->parameters[k];
}

/* The law of a pair from the options, or, before the pairs are known, that of all pairs (`pair` -1) */
PetscErrorCode ContactReadLaw(Contact contact, PetscInt pair)
{
  const char *names[MOST_LAWS];
  char        option[PETSC_MAX_PATH_LEN] = "-contact_law";
  PetscInt    n, chosen = 0;
  PetscBool   set;

  PetscFunctionBegin;
  if (pair >= 0) PetscCall(PetscSNPrintf(option, sizeof(option), "-contact_law_%s", contact->pairs[pair].name));
  PetscCall(ListLaws(names, &n));
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEList(option, "What the surfaces do to each other", "ContactSetLaw", names, n,
                              ContactNameLaw(contact, pair < 0 ? NULL : &contact->pairs[pair]), &chosen, &set));
  PetscOptionsEnd();
  if (set) PetscCall(ContactSetLaw(contact, pair, names[chosen]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Parameters of all laws from the options, of all pairs and of each that has the law; an option left unread is an error */
PetscErrorCode ContactReadLawParameters(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt g = 0; g < contact->n_laws; g++) {
    const ContactNamedLaw *law = &contact->laws[g];

    for (PetscInt k = 0; k < law->law.n_parameters; k++)
      for (PetscInt p = -1; p < (law->law.parameters[k].optional ? 0 : contact->n_pairs); p++) {
        const ContactPair *pair  = p < 0 ? NULL : &contact->pairs[p];
        PetscBool          used  = (PetscBool)(contact->options.law >= CONTACT_LAW_GLUE && contact->options.named == g), set;
        PetscReal          value = law->parameters[k];
        char               option[PETSC_MAX_PATH_LEN];

        for (PetscInt q = 0; q < contact->n_pairs && !used; q++)
          used = (PetscBool)(contact->pairs[q].law >= CONTACT_LAW_GLUE && contact->pairs[q].named == g);
        if (pair) used = (PetscBool)(pair->law >= CONTACT_LAW_GLUE && pair->named == g);
        if (!used) continue;
        PetscCall(NameOption(law, k, pair, option));
        PetscObjectOptionsBegin((PetscObject)contact);
        PetscCall(PetscOptionsReal(option, law->law.parameters[k].what, "ContactSetLawParameter", value, &value, &set));
        PetscOptionsEnd();
        if (set) PetscCall(ContactSetLawParameter(contact, p, law->name, law->law.parameters[k].name, value));
      }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the law of a pair, or of those to come (NULL), has its parameters, and these go together */
static PetscErrorCode CheckParameters(Contact contact, const ContactPair *pair)
{
  const MPI_Comm         comm = PetscObjectComm((PetscObject)contact);
  const ContactNamedLaw *law  = &contact->laws[pair ? pair->named : contact->options.named];
  PetscReal              parameters[ROW_LAW_PARAMETERS];
  const char            *wrong = NULL;

  PetscFunctionBegin;
  if ((pair ? pair->law : contact->options.law) < CONTACT_LAW_GLUE) PetscFunctionReturn(PETSC_SUCCESS);
  ContactGetLawParameters(contact, pair, parameters);
  for (PetscInt k = 0; k < law->law.n_parameters; k++) {
    const RowLawParameter *parameter = &law->law.parameters[k];
    char                   of_all[PETSC_MAX_PATH_LEN], of_pair[PETSC_MAX_PATH_LEN];

    PetscCall(NameOption(law, k, NULL, of_all));
    PetscCall(NameOption(law, k, pair, of_pair));
    PetscCheck(parameters[k] >= 0 || parameter->optional, comm, PETSC_ERR_USER_INPUT,
               "-contact_law %s needs the %s of the pair %s%s%s: set %s x for all pairs, or %s x for this one%s%s", law->name,
               parameter->what, pair ? pair->name : "that may come", UnitOf(contact, parameter)[0] ? ", in" : "",
               UnitOf(contact, parameter), of_all, of_pair, parameter->hint ? "; " : "", parameter->hint ? parameter->hint : "");
  }
  if (law->law.check) wrong = (*law->law.check)(parameters);
  PetscCheck(!wrong, comm, PETSC_ERR_USER_INPUT, "-contact_law %s of the pair %s: %s", law->name, pair ? pair->name : "that may come",
             wrong);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactViewLawParameters(Contact contact, PetscViewer viewer)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscReal          parameters[ROW_LAW_PARAMETERS];

    if (pair->law < CONTACT_LAW_GLUE) continue;
    ContactGetLawParameters(contact, pair, parameters);
    for (PetscInt k = 0; k < contact->laws[pair->named].law.n_parameters; k++) {
      const RowLawParameter *parameter = &contact->laws[pair->named].law.parameters[k];

      if (parameters[k] >= 0)
        PetscCall(PetscViewerASCIIPrintf(viewer, "  %s of %s: %g%s\n", parameter->what, pair->name, (double)parameters[k],
                                         UnitOf(contact, parameter)));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses laws that the method has not, and pairs of different laws where it takes one for all */
PetscErrorCode ContactCheckLaws(Contact contact)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  const char    *type = ((PetscObject)contact)->type_name;
  const char    *way  = ContactNameLaw(contact, contact->n_pairs ? &contact->pairs[0] : NULL); /* the law that is in the way */
  char           why[256];

  PetscFunctionBegin;
  for (PetscInt p = 1; p < contact->n_pairs && !contact->sideless; p++)
    PetscCheck(
        contact->pairs[p].law == contact->pairs[0].law, comm, PETSC_ERR_SUP,
        "Pair %s has the law %s, and pair %s the law %s: -contact_type %s has one law for all pairs; choose -contact_type schwarz, or "
        "leave -contact_law_<pair> out",
        contact->pairs[p].name, ContactNameLaw(contact, &contact->pairs[p]), contact->pairs[0].name, way, type);
  PetscCall(PetscSNPrintf(
      why, sizeof(why), "-contact_type %s has no friction; choose -contact_type schwarz, lagrange, penalty or augmented_lagrangian", type));
  if (!contact->sideless) PetscCall(ContactRefuseFriction(contact, why));
  PetscCheck(contact->impulses || !ContactAnyPairHas(contact, CONTACT_LAW_GLUE), comm, PETSC_ERR_SUP,
             "-contact_law %s works with -contact_type schwarz alone, not with %s; choose that, or -contact_law tied", way, type);
  PetscCheck(contact->impulses || contact->prescribes || !ContactAnyPairHas(contact, CONTACT_LAW_BONDED), comm, PETSC_ERR_SUP,
             "-contact_law bonded works with -contact_type schwarz or alternation alone, not with %s; choose one of these, or -contact_law "
             "frictionless or tied",
             type);
  if (contact->neighbours.come_and_go) PetscCall(CheckParameters(contact, NULL));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(CheckParameters(contact, &contact->pairs[p]));
  if (contact->options.separation) PetscFunctionReturn(PETSC_SUCCESS);
  /* of pairs of several laws those that touch must be frictionless */
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!ContactPairTies(&contact->pairs[p]) && (ContactPairTies(&contact->pairs[0]) || contact->pairs[p].law != CONTACT_LAW_FRICTIONLESS))
      way = ContactNameLaw(contact, &contact->pairs[p]);
  PetscCheck(
      (contact->impulses || contact->prescribes) && ContactAnyPairHas(contact, CONTACT_LAW_FRICTIONLESS) &&
          !ContactAnyPairHas(contact, CONTACT_LAW_BONDED) && !ContactAnyPairHas(contact, CONTACT_LAW_FRICTION),
      comm, PETSC_ERR_SUP,
      "-contact_separation false works with -contact_type schwarz or alternation and -contact_law frictionless alone, not with %s and %s",
      type, way);
  PetscFunctionReturn(PETSC_SUCCESS);
}
