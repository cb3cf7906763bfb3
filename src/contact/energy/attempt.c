/* An attempt at a step with other contact forces at its start, for limit.c. */
#include "energyimpl.h"
#include <impakt/private/bodyforces.h>

/* What attempts start from: the step as it has been made */
PetscErrorCode ContactBeginAttempts(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(ContactComputeEnergies(contact, energy->energies, energy->springs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->first_work[b] = energy->group_work[b] - energy->energies[b];
  for (PetscInt p = 0; p < contact->n_pairs; p++) energy->first_work[contact->pairs[p].body[0]] -= energy->springs[2 * p];
  PetscCall(PetscArraycpy(energy->start_force, energy->last_force, contact->rows.n));
  for (PetscInt i = 0; i < contact->rows.n; i++) energy->rest[i] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Work of contact on each group in the last attempt: that of the first, and by how much more the bodies and springs have now */
static PetscErrorCode ComputeGroupWork(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  PetscCall(ContactComputeEnergies(contact, energy->energies, energy->springs));
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    energy->pair_sums[2 * p + 1] = PetscMax(energy->pair_sums[2 * p + 1], energy->springs[2 * p + 1]);
  ContactFindGroups(contact);
  PetscCall(PetscArrayzero(energy->group_work, contact->n_bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) energy->group_work[energy->group[b]] += energy->first_work[b] + energy->energies[b];
  for (PetscInt p = 0; p < contact->n_pairs; p++) energy->group_work[energy->group[contact->pairs[p].body[0]]] += energy->springs[2 * p];
  ContactLeaveOutStatic(contact);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step from the saved states once more, with the start forces as they are, and what each group gains in it; nothing is told where it
   fails. Collective. */
PetscErrorCode ContactMakeAttempt(Contact contact)
{
  ContactEnergy *energy = &contact->energy;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const ContactBodyRows *of = &contact->body_rows[b];

    for (PetscInt k = 0; k < of->n; k++) {
      const PetscInt i = of->rows[k];

      energy->now[k]        = energy->start_force[i] - energy->last_force[i];
      contact->work.rest[k] = energy->rest[i];
    }
    PetscCall(BodySetStartForce(contact->bodies[b], energy->now, contact->work.rest));
  }
  PetscCall(PetscArraycpy(contact->start.force, energy->start_force, contact->rows.n));
  energy->again = energy->changed = PETSC_TRUE;
  PetscUseTypeMethod(contact, step);
  PetscCall(ContactCompleteBodies(contact));
  energy->again = PETSC_FALSE;
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactComputeFrictionLoss(contact, energy->start_force));
  PetscCall(ComputeGroupWork(contact));
  contact->counts.energy_attempts++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
