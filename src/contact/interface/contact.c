/* The class: creation, type, step, destruction. */
#include <contact/parts.h>
#include <sys/names.h>
#include <impakt/private/bodystep.h>

/* Parts of the system's energy that contact may gain in a run (tests/README.md), and take or bring in a step before it is halved */
#define ENERGY_EXCESS    1e-3
#define ENERGY_TOLERANCE 1e-3
/* Default slip [parts of the face] and turn [rad] after which rows are built again. Smaller bounds follow curved surfaces better, larger
   ones lose less energy: a half disc led round another has ripples of 1.5 % in its normal force with these, and 0.2 % with 0.05. */
#define SLIP_BOUND  0.2
#define ANGLE_BOUND 0.1
/* Gap or overlap up to which nodes are tied by default [parts of a face]: above what meshes of one curved surface differ by where a face
   spans 1/10 rad, 1/800 of a face, and far below what a user takes for bodies that lie apart */
#define TIE_DISTANCE 0.01

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
  PetscAssertPointer(contact, 2);
  PetscCall(ContactInitializePackage());
  PetscCall(
      PetscHeaderCreate(*contact, CONTACT_CLASSID, "Contact", "Contact between bodies", "Contact", comm, ContactDestroy, ContactView));
  PetscCallMPI(MPI_Comm_size(comm, &(*contact)->ranks.size));
  PetscCallMPI(MPI_Comm_rank(comm, &(*contact)->ranks.rank));
  PetscCall(ContactCreateLaws(*contact));
  PetscCall(ContactCreateResultants(*contact));
  (*contact)->attempt.failed = PETSC_INT_MAX;
  (*contact)->options        = (ContactOptions){
      .separation       = PETSC_TRUE,
      .facing           = PETSC_TRUE,
      .shared_times     = PETSC_TRUE,
      .balanced_start   = PETSC_TRUE,
      .auto_balance     = PETSC_TRUE,
      .energy_cap       = PETSC_TRUE,
      .energy_excess    = ENERGY_EXCESS,
      .energy_tolerance = ENERGY_TOLERANCE,
      .slip_bound       = SLIP_BOUND,
      .angle_bound      = ANGLE_BOUND,
      .tolerance        = PETSC_DEFAULT,
      .tie_distance     = TIE_DISTANCE,
  };
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactSetBodies - sets the bodies that may touch

  Logically Collective

  Input Parameters:
+ contact - the `Contact`
. n       - their number
- bodies  - the bodies, not yet set up

  Level: beginner

.seealso: `Contact`, `ContactAddPair()`
@*/
PetscErrorCode ContactSetBodies(Contact contact, PetscInt n, const Body bodies[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, n, 2);
  if (n) PetscAssertPointer(bodies, 3);
  PetscCheck(!contact->bodies, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_WRONGSTATE, "The bodies have been set already");
  contact->n_bodies = n;
  PetscCall(PetscMalloc1(n, &contact->bodies));
  for (PetscInt b = 0; b < n; b++) {
    PetscValidHeaderSpecific(bodies[b], BODY_CLASSID, 3);
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
. -contact_type (schwarz|alternation|penalty|lagrange|augmented_lagrangian) - the contact method; force is another name of schwarz

  Level: beginner

.seealso: `Contact`, `ContactRegister()`
@*/
PetscErrorCode ContactSetType(Contact contact, ContactType type)
{
  PetscErrorCode (*create)(Contact);
  PetscBool same;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(type, 2);
  PetscCall(PetscStrcmp(type, CONTACT_FORCE, &same));
  if (same) type = CONTACT_SCHWARZ;
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, type, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  ContactCheckNotSetUp(contact);
  PetscCall(PetscFunctionListFind(ContactList, type, &create));
  if (!create) {
    char known[1024];

    PetscCall(NamesOfRegistry(ContactList, sizeof(known), known));
    SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE, "Unknown -contact_type '%s'; known: %s", type, known);
  }
  PetscTryTypeMethod(contact, destroy);
  PetscCall(PetscMemzero(contact->ops, sizeof(*contact->ops)));
  contact->data       = NULL;
  contact->prescribes = contact->sideless = contact->impulses = PETSC_FALSE;
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
. type - its name; `NULL` until it has been chosen

  Level: beginner

.seealso: `Contact`, `ContactSetType()`
@*/
PetscErrorCode ContactGetType(Contact contact, ContactType *type)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(type, 2);
  *type = ((PetscObject)contact)->type_name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the states at the end of a controller step, made by ContactStep(), as the start of the next one. Collective. */
PetscErrorCode ContactAccept(Contact contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscTryTypeMethod(contact, accept);
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)contact), &contact->attempt.failure));
  PetscCall(ContactCheckNear(contact));
  if (contact->options.stabilization == CONTACT_STABILIZATION_NAIVE) PetscCall(ContactStabilize(contact));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySave(contact->bodies[b]));
  PetscCall(ContactBookWork(contact));
  PetscCall(ContactAcceptFriction(contact));
  PetscCall(ContactNoteTilt(contact));
  PetscCall(ContactAddImpulses(contact));
  PetscCall(ContactAcceptTurns(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt k = pair->near_begin; k < pair->near_end; k += ContactGapStride(pair))
      contact->start.gap[contact->rows.near[k]] = contact->end.gap[contact->rows.near[k]];
  }
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i = contact->rows.acting[k];

    contact->start.force[i]  = contact->end.force[i];
    contact->start.active[i] = contact->end.active[i];
  }
  contact->attempt.accepted_level = contact->attempt.level;
  contact->attempt.again          = PETSC_FALSE;
  contact->energy.start_known     = PETSC_FALSE;
  for (PetscInt b = 0; contact->body_rows && b < contact->n_bodies; b++)
    contact->body_rows[b].filled = contact->body_rows[b].rewritten = PETSC_FALSE;
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
    if (c->spares) PetscCall(MatDestroy(&c->spares[b]));
    if (c->ends) PetscCall(VecDestroy(&c->ends[b]));
  }
  PetscCall(ContactDestroyRows(c));
  PetscCall(ContactDestroyNeighbours(c));
  PetscCall(ContactDestroyPairs(c));
  PetscCall(PetscFree(c->bodies));
  PetscCall(PetscFree2(c->reach.mean, c->reach.spread));
  PetscCall(PetscFree5(c->traces, c->interfaces, c->spares, c->order, c->body_rows));
  PetscCall(PetscFree4(c->ends, c->ahead, c->work.hands_over, c->work.traces));
  PetscCall(ContactDestroyResultants(c));
  PetscCallMPI(MPI_Op_free(&c->resultants.add));
  PetscCallMPI(MPI_Type_free(&c->resultants.state));
  PetscCall(ContactDestroyOverlaps(c));
  PetscCall(ContactDestroyFloating(c));
  PetscCall(ContactDestroyEnergy(c));
  PetscCall(ContactDestroyFriction(c));
  PetscCall(PetscFree(c->law_parameters));
  PetscCall(PetscHeaderDestroy(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
