/* Impulses on the contact nodes at one instant: what ends the gap rate, and what closes a predicted gap in the norm of the mass. */
#include "forwardimpl.h"
#include <impakt/private/bodyforces.h>

/* The effect of unit impulses on the gap rates [1/kg]. One side of each pair must have mass, since `option` cannot do without. */
PetscErrorCode LagrangeSetUpImpulses(Contact contact, const char option[], Complementarity *impulses)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair  = &contact->pairs[p];
    const Body         first = contact->bodies[pair->body[0]], second = contact->bodies[pair->obstacle ? pair->body[0] : pair->body[1]];

    PetscCheck(!BodyDoes(first, BodyIsRedistributed) || !BodyDoes(second, BodyIsRedistributed), PetscObjectComm((PetscObject)contact),
               PETSC_ERR_USER_INPUT,
               "%s changes velocities through the mass of the contact nodes, and those of '%s' and '%s' have none: their velocity is the "
               "change of position over the step, so that a closed gap that stays closed has no rate already. Leave the option out, or set "
               "-%s_mass_redistribute false",
               option, ((PetscObject)first)->name, ((PetscObject)second)->name, ((PetscObject)first)->name);
  }
  PetscCall(ComplementarityCreate(contact, impulses));
  PetscCall(ComplementaritySetCompliance(contact, impulses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Impulses [N s] on the rows with a force, at the end of the step, after which their gap rate is zero: the nearest velocities in the
   norm of the mass, so that no energy is gained. With `pushing_only` a gap that opens may go on opening. */
PetscErrorCode LagrangeCloseRate(Contact contact, PetscBool pushing_only, Complementarity *impulses)
{
  const PetscReal parts[] = {0, 1, 0};
  PetscBool       in_contact;

  PetscFunctionBegin;
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactComputeRates(contact, 1, PETSC_TRUE, impulses->gaps));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    impulses->active[i] = (PetscBool)(contact->end.active[i] && (contact->rows.tied[i] || !pushing_only || impulses->gaps[i] < 0));
  PetscCall(ComplementaritySolve(contact, PETSC_TRUE, impulses));
  PetscCall(ComplementarityApply(contact, impulses, BODY_AT_END, parts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where positions that go on at constant velocity would penetrate after the step, moves the start of the step by as much as puts
   them outside: their projection in the norm of the mass onto what is admissible */
PetscErrorCode LagrangeProjectPrediction(Contact contact, Complementarity *impulses)
{
  const PetscReal parts[] = {1, 0, 0};
  PetscBool       any     = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(ContactComputeRates(contact, 1, PETSC_FALSE, impulses->gaps));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    impulses->gaps[i] = contact->start.gap[i] + contact->step * impulses->gaps[i];
    if (impulses->gaps[i] < 0) any = PETSC_TRUE;
  }
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComplementaritySolve(contact, PETSC_FALSE, impulses));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ComplementarityApply(contact, impulses, BODY_AT_START, parts));
  PetscFunctionReturn(PETSC_SUCCESS);
}
