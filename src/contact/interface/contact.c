/* The class: creation, options, step, destruction. */
#include <impakt/private/contactimpl.h>
#include <sys/names.h>

/* Slip [parts of the face] and turn [rad] after which rows are built again by default. Smaller bounds follow curved surfaces better, larger
   ones lose less energy: a half disc that is led round another one has ripples of 1.5 % in its normal force with these, and 0.2 % with
   0.05. */
#define SLIP_BOUND  0.2
#define ANGLE_BOUND 0.1

PetscClassId  CONTACT_CLASSID = 0;
PetscLogEvent CONTACT_Step, CONTACT_Sweep, CONTACT_Update;

const char *const ContactLaws[]        = {"frictionless", "tied", "ContactLaw", "CONTACT_LAW_", NULL};
const char *const ContactConstraints[] = {"gap", "gap_rate", "both", "ContactConstraint", "CONTACT_CONSTRAINT_", NULL};

static PetscFunctionList ContactList = NULL;

/*@C
  ContactRegister - adds a contact method to the registry

  Not Collective

  Input Parameters:
+ name   - its name for `-contact_type`
- create - function that sets up the type-specific part of a `Contact`

  Level: developer

.seealso: `Contact`, `ContactSetType()`
@*/
PetscErrorCode ContactRegister(const char name[], PetscErrorCode (*create)(Contact))
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(&ContactList, name, create));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactRegisterAll - registers the class and all methods that Impakt brings

  Not Collective

  Level: developer

.seealso: `ContactRegister()`, `ImpaktInitialize()`
@*/
PetscErrorCode ContactRegisterAll(void)
{
  PetscFunctionBegin;
  PetscCall(PetscClassIdRegister("Contact", &CONTACT_CLASSID));
  PetscCall(PetscLogEventRegister("ContactStep", CONTACT_CLASSID, &CONTACT_Step));
  PetscCall(PetscLogEventRegister("ContactSweep", CONTACT_CLASSID, &CONTACT_Sweep));
  PetscCall(PetscLogEventRegister("ContactUpdate", CONTACT_CLASSID, &CONTACT_Update));
  PetscCall(ContactRegister(CONTACT_SCHWARZ, ContactCreate_Schwarz));
  PetscCall(ContactRegister(CONTACT_PENALTY, ContactCreate_Penalty));
  PetscCall(ContactRegister(CONTACT_LAGRANGE, ContactCreate_Lagrange));
  PetscCall(ContactRegister(CONTACT_AUGMENTED_LAGRANGIAN, ContactCreate_AugmentedLagrangian));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactFinalizePackage - empties the registry

  Not Collective

  Level: developer

.seealso: `ContactRegisterAll()`
@*/
PetscErrorCode ContactFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&ContactList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactCreate - creates a contact problem without bodies

  Collective

  Input Parameter:
. comm - communicator

  Output Parameter:
. contact - the `Contact`

  Level: beginner

.seealso: `Contact`, `ContactSetBodies()`, `ContactSetFromOptions()`, `ContactSetUp()`
@*/
PetscErrorCode ContactCreate(MPI_Comm comm, Contact *contact)
{
  PetscFunctionBegin;
  PetscCall(
      PetscHeaderCreate(*contact, CONTACT_CLASSID, "Contact", "Contact between bodies", "Contact", comm, ContactDestroy, ContactView));
  PetscCallMPI(MPI_Comm_size(comm, &(*contact)->size));
  (*contact)->facing      = PETSC_TRUE;
  (*contact)->slip_bound  = SLIP_BOUND;
  (*contact)->angle_bound = ANGLE_BOUND;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetBodies - sets the bodies that may touch

  Logically Collective

  Input Parameters:
+ contact - the `Contact`
. n       - their number
- bodies  - the bodies, with mesh but not yet set up

  Level: beginner

.seealso: `Contact`, `ContactAddPair()`
@*/
PetscErrorCode ContactSetBodies(Contact contact, PetscInt n, const Body bodies[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCheck(!contact->bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "The bodies have been set already");
  contact->n_bodies = n;
  PetscCall(PetscMalloc1(n, &contact->bodies));
  for (PetscInt b = 0; b < n; b++) {
    PetscCall(PetscObjectReference((PetscObject)bodies[b]));
    contact->bodies[b] = bodies[b];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetType - chooses the contact method

  Collective

  Input Parameters:
+ contact - the `Contact`
- type    - its name

  Options Database Key:
. -contact_type (schwarz|penalty|lagrange|augmented_lagrangian) - the contact method

  Level: beginner

.seealso: `Contact`, `ContactRegister()`
@*/
PetscErrorCode ContactSetType(Contact contact, ContactType type)
{
  PetscErrorCode (*create)(Contact);
  PetscBool same;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(!contact->setup, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE,
             "The method cannot be changed after ContactSetUp()");
  PetscCall(PetscFunctionListFind(ContactList, type, &create));
  PetscCheck(create, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE,
             "Unknown -contact_type '%s'; known: schwarz, penalty, lagrange, augmented_lagrangian", type);
  PetscTryTypeMethod(contact, destroy);
  PetscCall(PetscMemzero(contact->ops, sizeof(*contact->ops)));
  contact->prescribes = PETSC_FALSE;
  PetscCall((*create)(contact));
  PetscCall(PetscObjectChangeTypeName((PetscObject)contact, type));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactGetType - the contact method

  Not Collective

  Input Parameter:
. contact - the `Contact`

  Output Parameter:
. type - its name

  Level: beginner

.seealso: `Contact`, `ContactSetType()`
@*/
PetscErrorCode ContactGetType(Contact contact, ContactType *type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  *type = ((PetscObject)contact)->type_name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetFromOptions - reads pairs and method from the options

  Collective

  Input Parameter:
. contact - the `Contact`, with its bodies

  Options Database Keys:
+ -contact_pairs a:b,b:c                                       - pairs of bodies, Dirichlet side first; a.top:b.bottom for certain
                                                                 surfaces; default: the two bodies, where there are two
. -contact_type (schwarz|penalty|lagrange|augmented_lagrangian) - the contact method
. -contact_constraint (gap|gap_rate|both)                       - what contact forces keep from becoming negative
. -contact_stabilization (none|naive|contact_stabilized)        - what is done against chatter where contact nodes have mass
. -contact_facing (true|false)                                  - pairs of whole bodies keep only the faces that see each other at the start
(default); false where bodies move round each other, as balls do
- -contact_tolerance g                                          - depth that does not yet count as penetration [m]

  Level: beginner

.seealso: `Contact`, `ContactSetType()`, `ContactAddPair()`
@*/
PetscErrorCode ContactSetFromOptions(Contact contact)
{
  char           type[64] = CONTACT_SCHWARZ, **pairs;
  PetscInt       n;
  PetscBool      set, none = PETSC_FALSE, all = PETSC_FALSE;
  PetscErrorCode error = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  contact->tolerance = PETSC_DEFAULT;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsFList("-contact_type", "Contact method", "ContactSetType", ContactList, type, type, sizeof(type), NULL));
  PetscCall(PetscOptionsReal("-contact_tolerance", "Depth that does not yet count as penetration [m]", "ContactSetFromOptions",
                             contact->tolerance, &contact->tolerance, NULL));
  PetscCall(PetscOptionsEnum("-contact_constraint", "What contact forces keep from becoming negative", "", ContactConstraints,
                             (PetscEnum)contact->constraint, (PetscEnum *)&contact->constraint, NULL));
  PetscCall(PetscOptionsEnum("-contact_stabilization", "What is done against chatter", "", ContactStabilizations,
                             (PetscEnum)contact->stabilization, (PetscEnum *)&contact->stabilization, NULL));
  PetscCall(PetscOptionsEnum("-contact_law", "What the surfaces do to each other", "", ContactLaws, (PetscEnum)contact->law,
                             (PetscEnum *)&contact->law, NULL));
  PetscCall(PetscOptionsBool("-contact_facing", "Whole bodies come with the faces alone that see each other at the start", "",
                             contact->facing, &contact->facing, NULL));
  PetscCall(PetscOptionsReal("-contact_slip_bound", "Slip after which contact rows are built again, parts of a face", "",
                             contact->slip_bound, &contact->slip_bound, NULL));
  PetscCall(PetscOptionsReal("-contact_angle_bound", "Turn of a normal after which contact rows are built again [rad]", "",
                             contact->angle_bound, &contact->angle_bound, NULL));
  PetscOptionsEnd();
  PetscCheck(contact->slip_bound > 0 && contact->angle_bound > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_slip_bound %g and -contact_angle_bound %g must be positive", (double)contact->slip_bound,
             (double)contact->angle_bound);
  PetscCall(ContactReadObstacles(contact));
  PetscCall(NamesRead(((PetscObject)contact)->prefix, "-contact_pairs", &n, &pairs, &set));
  if (set && n == 1) PetscCall(PetscStrcmp(pairs[0], "none", &none));
  if (set && n == 1) PetscCall(PetscStrcmp(pairs[0], "auto", &all));
  for (PetscInt p = 0; p < n && !none && !all && !error; p++) error = ContactAddPair(contact, pairs[p]);
  PetscCall(NamesDestroy(n, &pairs));
  PetscCall(error);
  if (all || (!set && (contact->n_bodies == 2 || (contact->n_bodies == 1 && contact->n_obstacles)))) PetscCall(ContactAddAllPairs(contact));
  PetscCheck(contact->n_bodies < 2 || contact->n_pairs || none, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "There are %" PetscInt_FMT " bodies; say which may touch: -contact_pairs a:b,b:c, or auto, or none", contact->n_bodies);
  PetscCall(ContactSetType(contact, type));
  PetscTryTypeMethod(contact, setfromoptions);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactStep - advances all bodies from their saved states through one controller step, under contact

  Collective

  Input Parameter:
. contact - the `Contact`, set up

  Level: developer

  Note:
  The step becomes final by `ContactAccept()`.

.seealso: `Contact`, `ContactAccept()`, `BodySave()`
@*/
PetscErrorCode ContactStep(Contact contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscCall(PetscLogEventBegin(CONTACT_Step, contact, 0, 0, 0));
  contact->counts_made.sweeps = 0;
  PetscCall(PetscLogEventBegin(CONTACT_Update, contact, 0, 0, 0));
  PetscCall(ContactUpdateRows(contact));
  PetscCall(PetscLogEventEnd(CONTACT_Update, contact, 0, 0, 0));
  if (contact->n_all_rows) PetscUseTypeMethod(contact, step);
  else { /* nothing can touch */ PetscBool penetrating;

    PetscCall(ContactIntegrateFree(contact, &penetrating));
  }
  contact->counts_made.total_sweeps += contact->counts_made.sweeps;
  PetscCall(PetscLogEventEnd(CONTACT_Step, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactAccept - takes the states at the end of the controller step as the start of the next one

  Collective

  Input Parameter:
. contact - the `Contact`, after `ContactStep()`

  Level: developer

.seealso: `Contact`, `ContactStep()`, `BodySave()`
@*/
PetscErrorCode ContactAccept(Contact contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscTryTypeMethod(contact, accept);
  if (contact->stabilization == CONTACT_STABILIZATION_NAIVE) PetscCall(ContactStabilize(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySave(contact->bodies[b]));
  PetscCall(ContactAddImpulses(contact));
  PetscCall(PetscArraycpy(contact->saved_force, contact->force, contact->n_rows));
  PetscCall(PetscArraycpy(contact->saved_gap, contact->gap, contact->n_rows));
  PetscCall(PetscArraycpy(contact->saved_active, contact->active, contact->n_rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactView - prints pairs and method

  Collective

  Input Parameters:
+ contact - the `Contact`
- viewer  - an ASCII viewer

  Level: beginner

.seealso: `Contact`
@*/
PetscErrorCode ContactView(Contact contact, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  if (!contact->n_pairs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "contact %s:", ((PetscObject)contact)->type_name));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCall(PetscViewerASCIIPrintf(viewer, " %s%s", contact->pairs[p].name,
                                     contact->pairs[p].chosen && !contact->pairs[p].obstacle ? " (sides chosen)" : ""));
  PetscCall(
      PetscViewerASCIIPrintf(viewer, ", %" PetscInt_FMT " contact node%s\n", contact->n_all_rows, contact->n_all_rows == 1 ? "" : "s"));
  if (contact->law != CONTACT_LAW_FRICTIONLESS) PetscCall(PetscViewerASCIIPrintf(viewer, "  law %s\n", ContactLaws[contact->law]));
  if (contact->constraint != CONTACT_CONSTRAINT_GAP)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  constraint %s\n", ContactConstraints[contact->constraint]));
  if (contact->stabilization != CONTACT_STABILIZATION_NONE)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  stabilization %s\n", ContactStabilizations[contact->stabilization]));
  PetscTryTypeMethod(contact, view, viewer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactDestroy - frees a contact problem

  Collective

  Input Parameter:
. contact - the `Contact`, set to `NULL`

  Level: beginner

.seealso: `Contact`, `ContactCreate()`
@*/
PetscErrorCode ContactDestroy(Contact *contact)
{
  Contact c = *contact;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(c, CONTACT_CLASSID, 1);
  if (--((PetscObject)c)->refct > 0) {
    *contact = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscTryTypeMethod(c, destroy);
  for (PetscInt b = 0; b < c->n_bodies; b++) {
    PetscCall(BodyDestroy(&c->bodies[b]));
    if (c->interfaces) PetscCall(MatDestroy(&c->interfaces[b]));
    if (c->node_dofs) PetscCall(PetscFree(c->node_dofs[b]));
  }
  PetscCall(ContactDestroyRows(c));
  PetscCall(ContactDestroyPairs(c));
  PetscCall(PetscFree(c->bodies));
  PetscCall(PetscFree7(c->speeds, c->traces, c->interfaces, c->order, c->node_dofs, c->n_node_dofs, c->n_all_nodes));
  PetscCall(PetscFree(c->stabilized));
  PetscCall(ContactDestroyResultants(c));
  PetscCall(PetscHeaderDestroy(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
