/* One controller step: trial, contact, and the nodes that join and leave. */
#include "alternationimpl.h"
#include <impakt/private/bodysweeps.h>

/* Forces of this rank's rows at the end of the controller step, from the bodies' traces [N] */
PetscErrorCode AlternationGetForces(Contact contact, PetscScalar force[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    const Trace        reaction = contact->traces[DirichletBody(pair)].reaction;
    PetscScalar       *end;
    PetscInt           levels;

    PetscCall(TraceGetSizes(reaction, NULL, &levels));
    PetscCall(TraceGetLevel(reaction, levels, &end));
    for (PetscInt i = pair->begin; i < pair->end; i++)
      force[i] = contact->end.active[i] ? -NeumannSign(pair) * end[i - DirichletShift(pair)] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The outer iteration with the active set as it is, then forces and gaps */
static PetscErrorCode SolveActive(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  PetscCall(AlternationPredict(contact));
  PetscCall(ContactSetConditions(contact, AlternationConditions(alternation)));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  alternation->swept = PETSC_FALSE;
  PetscCall(SNESSolve(alternation->snes, NULL, alternation->x));
  PetscCall(AlternationCheckConverged(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AlternationGetForces(contact, contact->end.force));
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where no pair is pushed together already; the rows that penetrate at its end become active */
static PetscErrorCode Trial(Contact contact, PetscBool *in_contact)
{
  PetscBool changed;

  PetscFunctionBegin;
  PetscCall(ContactIntegrateFree(contact, in_contact));
  if (*in_contact) PetscCall(RoundsChange(&((Alternation *)contact->data)->rounds, &changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The free trial after all nodes have been let go, being pulled. If it ends in penetration by the same nodes as were held,
   the contact solution is the better of both, and is taken back. */
static PetscErrorCode TrialAfterContact(Contact contact, PetscBool *in_contact, PetscBool *taken_back)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscBool    flips;

  PetscFunctionBegin;
  *taken_back = PETSC_FALSE;
  PetscCall(RoundsNext(&alternation->rounds));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyKeep(contact->bodies[b]));
  PetscCall(PetscArraycpy(alternation->kept_force, contact->end.force, contact->rows.n));
  PetscCall(Trial(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RoundsBreakCycle(&alternation->rounds, &flips));
  if (!flips) PetscFunctionReturn(PETSC_SUCCESS);
  *taken_back = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyReinstate(contact->bodies[b]));
  PetscCall(PetscArraycpy(contact->end.force, alternation->kept_force, contact->rows.n));
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStep_Alternation(Contact contact)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscBool    in_contact, changed, flips, taken_back = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(RoundsBegin(&alternation->rounds));
  /* push: in contact in the last step (sustainability), with compressive traction at its end (compression) */
  for (PetscInt i = 0; i < contact->rows.n; i++)
    contact->end.active[i] = (PetscBool)(contact->rows.tied[i] || (contact->start.active[i] && contact->start.force[i] > 0));
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscCall(Trial(contact, &in_contact));
  while (in_contact && !taken_back) {
    PetscCall(RoundsNext(&alternation->rounds));
    if (!ContactFailed(contact)) PetscCall(SolveActive(contact));
    if (ContactFailed(contact)) break;
    PetscCall(RoundsChange(&alternation->rounds, &changed));
    if (!changed) break;
    contact->counts.set_changes++;
    PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
    if (in_contact) PetscCall(RoundsBreakCycle(&alternation->rounds, &flips));
    else PetscCall(TrialAfterContact(contact, &in_contact, &taken_back));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
