/*
   Ties that keep their mass: what keeps both sides together over many steps. Newmark's formulas make velocities and accelerations from
   differences of displacements over dt and dt^2. What round-off leaves between the two sides of a tie comes back with the other sign in
   each step, and adds up: after 700 steps contact forces had 1e-9 of themselves in it. So both sides are brought to one velocity and one
   acceleration at the end of each step, by impulses and forces that act on both alike.

   Where a force has been the same throughout the step that takes more than round-off: central differences go on with the force that the
   uncut body has at the end of the step, and velocities have the mean of both in them. With it both sides move as the uncut body does.
*/
#include <contact/rows/inversemass.h>
#include <impakt/private/bodyforces.h>

/* At the end of a controller step, before the next one starts from it. `change`: per row, impulses [N s], then forces [N]; zero on rows
   that take no part */
PetscErrorCode ContactAlignTies(Contact contact, PetscScalar *const change[2])
{
  const ContactTies *ties = &contact->ties;

  PetscFunctionBegin;
  for (PetscInt order = 1; order <= 2; order++) {
    const PetscReal    parts[] = {0, order == 1, order == 2};
    PetscScalar *const rates = change[order - 1], *const on_body = ties->inverse->work[0];

    PetscCall(ContactComputeRates(contact, order, PETSC_TRUE, rates));
    PetscCall(InverseMassSolve(contact, ties->inverse, rates, rates));
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      InverseMassGetBodyForces(contact, b, rates, on_body);
      PetscCall(BodyAddImpulses(contact->bodies[b], BODY_AT_END, (PetscBool)!ties->all_explicit, parts, on_body));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
