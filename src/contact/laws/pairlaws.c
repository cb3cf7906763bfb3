/* Which law each pair has: that of all pairs, or one of its own; the parameters of these laws; and which methods take which laws. */
#include "pairlaws.h"
#include <sys/names.h>

#define MOST_LAWS 64

#define ROW_LAW_ADDRESS(law) &RowLaw##law,
const RowLaw *const RowLaws[] = {ROW_LAWS(ROW_LAW_ADDRESS) NULL};

const char *const ContactLaws[] = {"frictionless", "tied", "bonded", "glue", "friction", "ContactLaw", "CONTACT_LAW_", NULL};

/* The name that users give to the law of a pair; NULL: to that of pairs that have none of their own */
const char *ContactNameLaw(Contact contact, const ContactPair *pair)
{
  const ContactLaw law   = pair ? pair->law : contact->options.law;
  const PetscInt   named = pair ? pair->named : contact->options.named;

  return law >= CONTACT_LAW_GLUE ? RowLaws[named]->name : ContactLaws[law];
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

/* The names of all laws that users may choose: those of the enumeration, then those with parameters */
static void ListLaws(const char *names[MOST_LAWS], PetscInt *n)
{
  for (*n = 0; *n < CONTACT_LAW_GLUE; (*n)++) names[*n] = ContactLaws[*n];
  for (const RowLaw *const *law = RowLaws; *law; law++) names[(*n)++] = (*law)->name;
}

/* The number of a law among all, or the error of one that is none */
static PetscErrorCode FindLaw(Contact contact, const char law[], PetscInt *found)
{
  const char *names[MOST_LAWS];
  char        known[1024] = "";
  PetscInt    n;
  PetscBool   same = PETSC_FALSE;

  PetscFunctionBegin;
  ListLaws(names, &n);
  for (*found = 0; *found < n; (*found)++) {
    PetscCall(PetscStrcmp(names[*found], law, &same));
    if (same) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(NamesAppend(known, sizeof(known), ", ", names[*found]));
  }
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown contact law '%s'; known: %s", law, known);
}

/* Room for the parameters that pairs have which have none of their own */
PetscErrorCode ContactCreateLaws(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(ROW_LAW_PARAMETERS * PETSC_STATIC_ARRAY_LENGTH(RowLaws), &contact->law_parameters));
  for (size_t k = 0; k < ROW_LAW_PARAMETERS * PETSC_STATIC_ARRAY_LENGTH(RowLaws); k++) contact->law_parameters[k] = -1;
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
  PetscInt   chosen, named = 0;
  ContactLaw kind;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, pair, 2);
  PetscAssertPointer(law, 3);
  ContactCheckNotSetUp(contact);
  if (pair >= 0) ContactCheckPair(contact, pair);
  PetscCall(FindLaw(contact, law, &chosen));
  kind = (ContactLaw)chosen;
  if (chosen >= CONTACT_LAW_GLUE) {
    named = chosen - CONTACT_LAW_GLUE;
    kind  = RowLaws[named]->bound ? CONTACT_LAW_FRICTION : CONTACT_LAW_GLUE;
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
    if (contact->pairs[p].law == CONTACT_LAW_GLUE && RowLaws[contact->pairs[p].named]->n_history) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Of a parameter, with a space before it, or nothing */
static const char *UnitOf(Contact contact, const RowLawParameter *parameter)
{
  return parameter->unit == UNIT_ONE ? "" : UnitsOf((PetscObject)contact, parameter->unit);
}

/* The option of a parameter of a law; of a pair unless that is NULL */
static PetscErrorCode NameOption(const RowLaw *law, PetscInt k, const ContactPair *pair, char option[PETSC_MAX_PATH_LEN])
{
  const PetscBool bare = (PetscBool)(law->bound != NULL);

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, PETSC_MAX_PATH_LEN, "-contact_%s%s%s%s%s", bare ? "" : law->name, bare ? "" : "_",
                          law->parameters[k].name, pair ? "_" : "", pair ? pair->name : ""));
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
  const MPI_Comm         comm  = PetscObjectComm((PetscObject)contact);
  const RowLaw          *named = NULL;
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
  PetscCall(FindLaw(contact, law, &number));
  number -= CONTACT_LAW_GLUE;
  if (number >= 0) named = RowLaws[number];
  for (k = 0; named && k < named->n_parameters && !same; k += !same) PetscCall(PetscStrcmp(named->parameters[k].name, parameter, &same));
  PetscCheck(same, comm, PETSC_ERR_ARG_OUTOFRANGE, "-contact_law %s has no parameter '%s'", law, parameter);
  if (pair >= 0) {
    ContactCheckPair(contact, pair);
    PetscCheck(!named->parameters[k].optional, comm, PETSC_ERR_ARG_OUTOFRANGE, "'%s' of the law %s is the same for all pairs", parameter,
               law);
    PetscCheck(contact->pairs[pair].law >= CONTACT_LAW_GLUE && contact->pairs[pair].named == number, comm, PETSC_ERR_ARG_WRONGSTATE,
               "Pair %s does not have the law %s: call ContactSetLaw() first", contact->pairs[pair].name, law);
  }
  found = &named->parameters[k];
  PetscCall(NameOption(named, k, pair < 0 ? NULL : &contact->pairs[pair], option));
  PetscCheck((value > 0 || (found->may_be_zero && value == 0)) && value < PETSC_INFINITY, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "%s %g%s must %s, and be finite%s%s", option, (double)value, UnitOf(contact, found),
             found->may_be_zero ? "not be negative" : "be positive", found->hint ? "; " : "", found->hint ? found->hint : "");
  (pair < 0 ? contact->law_parameters + ROW_LAW_PARAMETERS * number : contact->pairs[pair].parameters)[k] = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The parameters of a pair, or of those to come (NULL); less than 0: not set */
void ContactGetLawParameters(Contact contact, const ContactPair *pair, PetscReal parameters[])
{
  const PetscReal *of_all = contact->law_parameters + ROW_LAW_PARAMETERS * (pair ? pair->named : contact->options.named);

  for (PetscInt k = 0; k < ROW_LAW_PARAMETERS; k++) parameters[k] = pair && pair->parameters[k] >= 0 ? pair->parameters[k] : of_all[k];
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
  ListLaws(names, &n);
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
  for (PetscInt g = 0; RowLaws[g]; g++) {
    const RowLaw *law = RowLaws[g];

    for (PetscInt k = 0; k < law->n_parameters; k++)
      for (PetscInt p = -1; p < (law->parameters[k].optional ? 0 : contact->n_pairs); p++) {
        const ContactPair *pair  = p < 0 ? NULL : &contact->pairs[p];
        PetscBool          used  = (PetscBool)(contact->options.law >= CONTACT_LAW_GLUE && contact->options.named == g), set;
        PetscReal          value = contact->law_parameters[ROW_LAW_PARAMETERS * g + k];
        char               option[PETSC_MAX_PATH_LEN];

        for (PetscInt q = 0; q < contact->n_pairs && !used; q++)
          used = (PetscBool)(contact->pairs[q].law >= CONTACT_LAW_GLUE && contact->pairs[q].named == g);
        if (pair) used = (PetscBool)(pair->law >= CONTACT_LAW_GLUE && pair->named == g);
        if (!used) continue;
        PetscCall(NameOption(law, k, pair, option));
        PetscObjectOptionsBegin((PetscObject)contact);
        PetscCall(PetscOptionsReal(option, law->parameters[k].what, "ContactSetLawParameter", value, &value, &set));
        PetscOptionsEnd();
        if (set) PetscCall(ContactSetLawParameter(contact, p, law->name, law->parameters[k].name, value));
      }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the law of a pair, or of those to come (NULL), has its parameters, and these go together */
static PetscErrorCode CheckParameters(Contact contact, const ContactPair *pair)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)contact);
  const RowLaw  *law  = RowLaws[pair ? pair->named : contact->options.named];
  PetscReal      parameters[ROW_LAW_PARAMETERS];
  const char    *wrong = NULL;

  PetscFunctionBegin;
  if ((pair ? pair->law : contact->options.law) < CONTACT_LAW_GLUE) PetscFunctionReturn(PETSC_SUCCESS);
  ContactGetLawParameters(contact, pair, parameters);
  for (PetscInt k = 0; k < law->n_parameters; k++) {
    const RowLawParameter *parameter = &law->parameters[k];
    char                   of_all[PETSC_MAX_PATH_LEN], of_pair[PETSC_MAX_PATH_LEN];

    PetscCall(NameOption(law, k, NULL, of_all));
    PetscCall(NameOption(law, k, pair, of_pair));
    PetscCheck(parameters[k] >= 0 || parameter->optional, comm, PETSC_ERR_USER_INPUT,
               "-contact_law %s needs the %s of the pair %s%s%s: set %s x for all pairs, or %s x for this one%s%s", law->name,
               parameter->what, pair ? pair->name : "that may come", UnitOf(contact, parameter)[0] ? ", in" : "",
               UnitOf(contact, parameter), of_all, of_pair, parameter->hint ? "; " : "", parameter->hint ? parameter->hint : "");
  }
  if (law->check) wrong = (*law->check)(parameters);
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
    for (PetscInt k = 0; k < RowLaws[pair->named]->n_parameters; k++) {
      const RowLawParameter *parameter = &RowLaws[pair->named]->parameters[k];

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
