/* Ties that keep their mass: what keeps both sides together over many steps. Newmark's formulas make velocities and accelerations from
   differences of displacements over dt and dt^2. Round-off between the sides comes back with the other sign in each step, and adds up, to
   1e-9 of contact forces in 700 steps. So both sides get one velocity and one acceleration at the end of each step, by impulses and forces
   on both alike.

   After a force that is the same throughout the step this is more than round-off: central differences go on with the force that the uncut
   body has at the end of the step, and velocities have the mean of both. With it both sides move as the uncut body does. */
#include <contact/rows/inversemass.h>

/* Finds out which ties keep their mass, with the rows as they are */
PetscErrorCode ContactSetUpTiedEnds(Contact contact)
{
  ContactTies *ties = &contact->ties;
  PetscBool    any  = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ContactDestroyTiedEnds(contact));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    if (!contact->pairs[p].keeps_mass) continue;
    any = PETSC_TRUE;
    PetscCall(BodyIsExplicit(contact->bodies[contact->pairs[p].body[0]], &ties->all_explicit)); /* or none, see ContactChooseTiedMass() */
  }
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(&ties->inverse));
  PetscCall(InverseMassCreate(contact, ties->all_explicit ? INVERSE_MASS_ASSEMBLED : INVERSE_MASS_LUMPED, ties->inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyTiedEnds(Contact contact)
{
  PetscFunctionBegin;
  if (contact->ties.inverse) PetscCall(InverseMassDestroy(contact->ties.inverse));
  PetscCall(PetscFree(contact->ties.inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}
