/* The end of a step for ties that keep their mass. Their force is the same throughout the step, by the rule `impulse`, where the uncut body
   has one that runs from l_0 to l_1. Newmark's trapezoidal rule sees the mean of both alone, so that l_1 = 2 l - l_0. Central differences
   see l_0 alone, which therefore is what the last step has ended with, and l_1 follows from one acceleration of both sides. So both sides
   go on as the uncut body does, and pairs are told its forces. */
#include "stepimpl.h"
#include <contact/rows/inversemass.h>
#include <impakt/private/bodyforces.h>

/* What a force that runs in a step of the trapezoidal rule has more at the end than in the mean */
static PetscErrorCode ExtrapolateForces(Contact contact, const ContactStepper *stepper, PetscReal more[])
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(more, contact->rows.n));
  for (PetscInt p = 0; p < contact->n_pairs && !contact->ties.all_explicit; p++) {
    const ContactPair *pair = &contact->pairs[p];
    PetscInt           substeps;

    PetscCall(BodyGetSubsteps(contact->bodies[pair->body[0]], &substeps));
    for (PetscInt i = pair->begin; i < pair->end && substeps == 1; i++)
      if (contact->ties.inverse->takes_part[i]) more[i] = contact->end.force[i] - stepper->last[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperEndTies(Contact contact, ContactStepper *stepper)
{
  const PetscReal    parts[] = {0, 0, 1};
  const InverseMass *inverse = contact->ties.inverse;
  PetscScalar      **aligns  = stepper->aligns;
  PetscReal         *more    = stepper->mine;

  PetscFunctionBegin;
  PetscCall(ExtrapolateForces(contact, stepper, more));
  for (PetscInt i = 0; i < contact->rows.n; i++) aligns[1][i] = more[i];
  for (PetscInt b = 0; b < contact->n_bodies && !contact->ties.all_explicit; b++) {
    if (!contact->body_rows[b].n_all) continue;
    ContactTakeRows(contact, b, aligns[1], inverse->work[0]);
    PetscCall(BodyAddImpulses(contact->bodies[b], BODY_AT_END, PETSC_FALSE, parts, inverse->work[0]));
  }
  PetscCall(InverseMassAlign(contact, contact->ties.inverse, BODY_AT_END, aligns));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal mean = contact->end.force[i] + PetscRealPart(aligns[0][i]) / contact->step; /* with what has aligned velocities */

    more[i] += PetscRealPart(aligns[1][i]);
    aligns[1][i] = more[i];
    contact->end.force[i] += more[i];
    if (inverse->takes_part[i]) contact->start.force[i] = 2 * mean - contact->end.force[i];
    aligns[0][i] = contact->start.force[i] - stepper->last[i];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) { /* by how much forces start above the last step's end, and end above the mean */
    if (!contact->body_rows[b].n_all) continue;
    ContactTakeRows(contact, b, aligns[0], inverse->work[0]);
    ContactTakeRows(contact, b, aligns[1], inverse->work[1]);
    PetscCall(BodyEndConstantForces(contact->bodies[b], inverse->work[0], inverse->work[1]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
