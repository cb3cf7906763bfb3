/* What is done against chatter, whatever the method: the naive stabilisation. */
#include <contact/parts.h>
#include <sys/citations.h>

const char *const ContactStabilizations[] = {"none", "naive", "contact_stabilized", "ContactStabilization", "CONTACT_STABILIZATION_", NULL};

/* Ends with an error if the chosen stabilisation would have no effect, and makes room for it */
PetscErrorCode ContactSetUpStabilization(Contact contact)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)contact);
  PetscBool lagrange, rigid, all_massless = PETSC_TRUE;

  PetscFunctionBegin;
  if (contact->options.stabilization == CONTACT_STABILIZATION_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < (contact->pairs[p].obstacle ? 1 : 2); side++) {
      PetscBool massless;

      PetscCall(BodyIsRedistributed(contact->bodies[contact->pairs[p].body[side]], &massless));
      if (!massless) all_massless = PETSC_FALSE;
    }
  PetscCheck(!all_massless, comm, PETSC_ERR_USER_INPUT,
             "-contact_stabilization %s acts on contact nodes with mass, and all are massless here, which do not chatter; leave it at "
             "none, or set -<body>_mass_redistribute false",
             ContactStabilizations[contact->options.stabilization]);
  PetscCall(PetscObjectTypeCompare((PetscObject)contact, CONTACT_LAGRANGE, &lagrange));
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED)
    PetscCheck(lagrange, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized works with -contact_type lagrange and implicit bodies only, not with %s; choose "
               "these, or -contact_stabilization naive",
               ((PetscObject)contact)->type_name);
  PetscCall(ContactHasRigid(contact, &rigid));
  PetscCheck(!rigid, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_stabilization changes accelerations of contact nodes, and those of a rigid body have none of their own; leave it at "
             "none");
  contact->energy.unlimited = "a stabilization changes accelerations or forces between steps";
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED) PetscCall(ImpaktCite(CITE_CONTACT_STABILIZED));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error where a choice is known to gain energy, unless the user wants it all the same; what: the choice, and what to do */
PetscErrorCode ContactRefuseUnstable(Contact contact, PetscBool unstable, const char what[])
{
  PetscFunctionBegin;
  PetscCheck(!unstable || contact->options.allow_unstable, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "%s; -contact_allow_unstable true lets it run all the same", what);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the contact nodes of a body have mass */
PetscErrorCode ContactBodyHasMass(Body body, PetscBool *has)
{
  PetscBool massless, without_inertia, rigid;

  PetscFunctionBegin;
  PetscCall(BodyIsRigid(body, &rigid));
  PetscCall(BodyIsRedistributed(body, &massless));
  PetscCall(BodyIsStatic(body, &without_inertia));
  *has = (PetscBool)(!massless && !without_inertia && !rigid);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a set needs the rule `impulse`: contact nodes that have mass, be it that of a rigid body which meets what cannot yield */
PetscErrorCode ContactNeedsImpulse(Contact contact, PetscInt b, PetscBool *needs)
{
  PetscBool rigid;

  PetscFunctionBegin;
  PetscCall(ContactBodyHasMass(contact->bodies[b], needs));
  PetscCall(BodyIsRigid(contact->bodies[b], &rigid));
  for (PetscInt p = 0; p < contact->n_pairs && rigid && !*needs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (pair->body[0] != b && pair->body[1] != b) continue;
    if (pair->obstacle) *needs = PETSC_TRUE;
    else PetscCall(BodyIsRigid(contact->bodies[pair->body[pair->body[0] == b]], needs));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a side of any pair (all_sides = false), or both sides of some pair (true), have mass on their contact nodes. Those of a rigid
   body are no nodes that could move by themselves. */
PetscErrorCode ContactHasMass(Contact contact, PetscBool all_sides, PetscBool *has)
{
  PetscInt all = 0;

  PetscFunctionBegin;
  *has = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const PetscInt sides = contact->pairs[p].obstacle ? 1 : 2;
    PetscInt       with  = 0;

    for (PetscInt side = 0; side < sides; side++) {
      PetscBool mass = PETSC_FALSE;

      PetscCall(ContactBodyHasMass(contact->bodies[contact->pairs[p].body[side]], &mass));
      with += mass;
    }
    *has = (PetscBool)(*has || (all_sides ? with == sides : with > 0));
  }
  if (!contact->neighbours.come_and_go) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) { /* any two of them may come near */
    PetscBool mass = PETSC_FALSE;

    PetscCall(ContactBodyHasMass(contact->bodies[b], &mass));
    all += mass;
  }
  if (all > (all_sides && !contact->n_obstacles ? 1 : 0)) *has = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The naive stabilisation (Hoy, Tezaur, Mota, section 5): after a step in contact the acceleration of the nodes in contact is set to zero
 */
PetscErrorCode ContactStabilize(Contact contact)
{
  PetscBool in_contact;

  PetscFunctionBegin;
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    for (PetscInt k = 0; k < of->n; k++) contact->work.flags[k] = contact->end.active[of->rows[k]];
    PetscCall(BodyClearAcceleration(contact->bodies[b], contact->work.flags));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
