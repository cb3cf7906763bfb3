/* The energy that contact takes in a controller step. */
#include <contact/parts.h>

/* Whether rows join or leave contact in the step under way, on any rank: such as are of nodes without mass, and such whose nodes have mass,
   or a body of theirs no inertia: then what the step takes is not the step's doing */
static PetscErrorCode LookAtChanges(Contact contact, int found[2])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair  = &contact->pairs[p];
    PetscBool          other = PETSC_FALSE;

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
      const Body body = contact->bodies[pair->body[side]];

      if (!BodyDoes(body, BodyIsRedistributed) || BodyDoes(body, BodyIsStatic)) other = PETSC_TRUE;
    }
    for (PetscInt i = pair->begin; i < pair->end; i++)
      if (contact->start.active[i] != contact->end.active[i]) found[other ? 1 : 0] = 1;
  }
  PetscCall(ContactReduce(contact, 2, MPI_INT, MPI_MAX, found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy that contact has taken in the step just made, before ContactAccept() [J], positive where energy is lost: minus the work of
   contact forces on bodies and on springs of the penalty method, in a step in which rows join or leave contact; 0 in all
   others. Also 0 where halves of the step would cost more than they save, since what central differences conserve depends on the step;
   where nodes with mass join or leave, whose impact takes energy whatever the step, where a body has no inertia, where the method does not
   tell what its springs store, and where -contact_constraint has gap rates end; and, where all starts at rest without strain, below what
   ContactGetUnresolvedEnergy() tells. Collective. */
PetscErrorCode ContactGetEnergyLoss(Contact contact, PetscReal *loss)
{
  int       found[2] = {0, 0};
  PetscReal unresolved;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(loss, 2);
  *loss = 0;
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP || !contact->energy.known || contact->energy.stays_whole)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LookAtChanges(contact, found));
  if (!found[0] || found[1]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGetUnresolvedEnergy(contact, &unresolved));
  if (!contact->energy.at_rest || PetscAbsReal(contact->energy.step_work) > unresolved) *loss = -contact->energy.step_work;
  PetscFunctionReturn(PETSC_SUCCESS);
}
