/* Contact from the options. */
#include <contact/parts.h>
#include <sys/names.h>
#include <sys/optionvalues.h>
#include <sys/sharedoptions.h>

/* -contact_balance: on where it has no value */
static PetscErrorCode ReadBalance(Contact contact, const char value[])
{
  ContactOptions *options = &contact->options;

  PetscFunctionBegin;
  PetscCall(PetscStrcasecmp(value, "auto", &options->auto_balance));
  options->balance = (PetscBool)!options->auto_balance;
  if (!options->auto_balance && value[0])
    PetscCall(OptionsReadSwitch(PetscObjectComm((PetscObject)contact), "contact_balance", " or auto", value, &options->balance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadSettings(Contact contact)
{
  ContactOptions *options = &contact->options;
  const struct {
    const char *name, *text;
    PetscBool  *value;
    const char *limits; /* what limits the energy of contact where it is true */
  } switches[] = {
      {"-contact_separation", "Surfaces that have met may come apart again", &options->separation, NULL},
      {"-contact_facing", "Whole bodies come with the faces alone that see each other at the start", &options->facing, NULL},
      {"-contact_allow_unstable", "What is known to gain energy runs all the same", &options->allow_unstable, NULL},
      {"-contact_shared_times", "Contact holds at all times that all bodies have", &options->shared_times, NULL},
      {"-contact_balanced_start", "Massless nodes are brought into balance in the first state", &options->balanced_start, NULL},
      {"-contact_energy_cap", "Steps that would gain energy at contact are made again", &options->energy_cap, "-contact_energy_cap true"},
  };
  const struct {
    const char *name, *text;
    PetscReal  *value;
    PetscBool   may_be_zero, limits;
  } numbers[] = {
      {"-contact_tolerance", "Depth that does not yet count as penetration [m]", &options->tolerance, PETSC_TRUE, PETSC_FALSE},
      {"-contact_energy_tolerance", "Energy that contact may take or bring in a step [parts of the system's]", &options->energy_tolerance,
       PETSC_FALSE, PETSC_TRUE},
      {"-contact_energy_excess", "Part of the energy that contact may gain in the whole run", &options->energy_excess, PETSC_TRUE,
       PETSC_TRUE},
      {"-contact_tie_distance", "Gap or overlap up to which nodes are tied, parts of a face", &options->tie_distance, PETSC_FALSE,
       PETSC_FALSE},
      {"-contact_slip_bound", "Slip after which contact rows are built again, parts of a face", &options->slip_bound, PETSC_FALSE,
       PETSC_FALSE},
      {"-contact_angle_bound", "Turn of a normal after which contact rows are built again [rad]", &options->angle_bound, PETSC_FALSE,
       PETSC_FALSE},
  };
  char      balance[64] = "";
  PetscBool given, set, sets[PETSC_STATIC_ARRAY_LENGTH(numbers)];

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(switches); k++) {
    PetscCall(PetscOptionsBool(switches[k].name, switches[k].text, "ContactSetFromOptions", *switches[k].value, switches[k].value, &set));
    if (set && switches[k].limits && *switches[k].value) contact->energy.asked = switches[k].limits;
  }
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(numbers); k++) {
    PetscCall(PetscOptionsReal(numbers[k].name, numbers[k].text, "ContactSetFromOptions", *numbers[k].value, numbers[k].value, &sets[k]));
    if (sets[k] && numbers[k].limits) contact->energy.asked = numbers[k].name;
  }
  PetscCall(PetscOptionsEnum("-contact_constraint", "What contact forces keep from becoming negative", "ContactSetFromOptions",
                             ContactConstraints, (PetscEnum)options->constraint, (PetscEnum *)&options->constraint, NULL));
  PetscCall(PetscOptionsEnum("-contact_stabilization", "What is done against chatter", "ContactSetFromOptions", ContactStabilizations,
                             (PetscEnum)options->stabilization, (PetscEnum *)&options->stabilization, NULL));
  PetscCall(PetscOptionsString("-contact_balance", "Forces have the same sum along the normals of both sides", "ContactSetFromOptions",
                               options->auto_balance ? "auto" : PetscBools[options->balance], balance, sizeof(balance), &given));
  PetscOptionsEnd();
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(numbers); k++)
    PetscCheck(!sets[k] || *numbers[k].value > 0 || (numbers[k].may_be_zero && *numbers[k].value == 0),
               PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "%s %g must %s", numbers[k].name, (double)*numbers[k].value,
               numbers[k].may_be_zero ? "not be negative" : "be positive");
  if (given) PetscCall(ReadBalance(contact, balance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadObstacles(Contact contact)
{
  PetscErrorCode error = PETSC_SUCCESS;
  char         **names;
  PetscInt       n;

  PetscFunctionBegin;
  PetscCall(NamesRead(NULL, "-obstacles", &n, &names, NULL));
  for (PetscInt o = 0; o < n; o++) PetscCall(OptionsCheckName(PetscObjectComm((PetscObject)contact), "obstacles", names[o]));
  for (PetscInt o = 0; o < n && !error; o++) {
    Obstacle obstacle = NULL;

    error = ContactCheckObstacleName(contact, names[o]);
    if (!error) error = ObstacleCreate(PetscObjectComm((PetscObject)contact), names[o], &obstacle);
    if (!error) error = ObstacleSetFromOptions(obstacle);
    if (!error) error = ContactAddObstacle(contact, obstacle);
    PetscCall(ObstacleDestroy(&obstacle));
  }
  PetscCall(NamesDestroy(n, &names));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two bodies alone, or a body and obstacles, are pairs by themselves */
static PetscErrorCode ReadPairs(Contact contact)
{
  PetscErrorCode error = PETSC_SUCCESS;
  char         **pairs;
  PetscInt       n;
  PetscBool      set, none = PETSC_FALSE, all = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(NamesRead(((PetscObject)contact)->prefix, "-contact_pairs", &n, &pairs, &set));
  if (set && n == 1) PetscCall(PetscStrcmp(pairs[0], "none", &none));
  if (set && n == 1) PetscCall(PetscStrcmp(pairs[0], "auto", &all));
  for (PetscInt p = 0; p < n && !none && !all && !error; p++) error = ContactAddPair(contact, pairs[p]);
  PetscCall(NamesDestroy(n, &pairs));
  PetscCall(error);
  if (!set && !contact->n_pairs) all = (PetscBool)(contact->n_bodies == 2 || (contact->n_bodies == 1 && contact->n_obstacles));
  if (all) PetscCall(ContactAddAllPairs(contact));
  PetscCheck(contact->n_bodies < 2 || contact->n_pairs || contact->neighbours.all || none, PetscObjectComm((PetscObject)contact),
             PETSC_ERR_USER_INPUT, "There are %" PetscInt_FMT " bodies; say which may touch: -contact_pairs a:b,b:c, or auto, or none",
             contact->n_bodies);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which body of each pair has the rows: one value for all pairs, or one for each */
static PetscErrorCode TakeRowSides(Contact contact, PetscInt n, char *names[])
{
  PetscFunctionBegin;
  if (n != 1 && contact->neighbours.all) PetscCall(ContactAddEachPair(contact));
  PetscCheck(n == 1 || n == contact->n_pairs, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_rows has %" PetscInt_FMT " values for %" PetscInt_FMT " pairs; give one for all, or one for each", n,
             contact->n_pairs);
  for (PetscInt p = 0; p < n; p++) {
    PetscBool first, second;

    PetscCall(PetscStrcmp(names[p], "first", &first));
    PetscCall(PetscStrcmp(names[p], "second", &second));
    PetscCheck(first || second, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_rows %s is none of first, second; a~b in -contact_pairs gives the rows to the body with the finer mesh", names[p]);
    PetscCheck(n == 1 || first || !contact->pairs[p].obstacle, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_rows second: pair %s is that of a body and an obstacle, which has no rows; say first", contact->pairs[p].name);
    if (n == 1) contact->options.rows_second = second;
    else contact->pairs[p].rows_second = second;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRowSides(Contact contact)
{
  PetscErrorCode error;
  char         **names;
  PetscInt       n;
  PetscBool      set;

  PetscFunctionBegin;
  PetscCall(NamesRead(((PetscObject)contact)->prefix, "-contact_rows", &n, &names, &set));
  error = set ? TakeRowSides(contact, n, names) : PETSC_SUCCESS;
  PetscCall(NamesDestroy(n, &names));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first option given that the alternation alone has; it chooses the alternation */
static PetscErrorCode TakeAlternation(Contact contact, size_t size, char type[])
{
  const char *const names[] = {"-schwarz_transmission", "-schwarz_traction",   "-schwarz_traction_waveform",
                               "-schwarz_predictor",    "-schwarz_relaxation", "-contact_swap_sides"};
  PetscBool         schwarz, given = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(type, CONTACT_SCHWARZ, &schwarz));
  for (PetscInt k = 0; k < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(names) && schwarz && !given; k++) {
    PetscCall(PetscOptionsHasName(NULL, ((PetscObject)contact)->prefix, names[k], &given));
    if (!given) continue;
    PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)contact), stderr,
                           "impakt: warning: %s is an option of -contact_type alternation, which is taken; choose it by its name\n",
                           names[k]));
    PetscCall(PetscStrncpy(type, CONTACT_ALTERNATION, size));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetFromOptions - reads pairs and method from the options

  Collective

  Input Parameter:
. contact - the `Contact`, with its bodies

  Options Database Keys:
+ -contact_pairs a:b,b~c - pairs of bodies, Dirichlet side first, or, with a tilde, in the order that is better; a.top:b.bottom for
                           certain surfaces; default: the two bodies, where there are two
. -contact_type (schwarz|alternation|penalty|lagrange|augmented_lagrangian) - the contact method, whose page has its main options
. -contact_law (frictionless|tied|bonded|coulomb|...), -contact_law_<pair>  - what the surfaces do to each other, of all pairs; of one
- -contact_...           - all others, with units and defaults in options/README.md, which `impakt -help` prints too

  Level: beginner

  Note:
  What the program has set before holds where the options are silent: pairs of the options come after those that have been added, and
  the two bodies are a pair by themselves only where none has been. A program gives options of its own by `PetscOptionsSetValue()` before.

.seealso: `Contact`, `ContactSetType()`, `ContactAddPair()`, `ContactAddObstacle()`, `ContactSetLaw()`
@*/
PetscErrorCode ContactSetFromOptions(Contact contact)
{
  char type[64];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCall(PetscStrncpy(type, ((PetscObject)contact)->type_name ? ((PetscObject)contact)->type_name : CONTACT_SCHWARZ, sizeof(type)));
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsFList("-contact_type", "Contact method", "ContactSetType", ContactList, type, type, sizeof(type), NULL));
  PetscOptionsEnd();
  PetscCall(ReadSettings(contact));
  PetscCall(ContactReadLaw(contact, -1));
  PetscCall(ReadObstacles(contact));
  PetscCall(ReadPairs(contact));
  PetscCall(ReadRowSides(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) PetscCall(ContactReadLaw(contact, p));
  PetscCall(ContactReadLawParameters(contact));
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscCall(TakeAlternation(contact, sizeof(type), type));
  PetscCall(ContactSetType(contact, type));
  PetscTryTypeMethod(contact, setfromoptions);
  PetscFunctionReturn(PETSC_SUCCESS);
}
