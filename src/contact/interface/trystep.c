/* Controller steps that may fail, and be made again in halves. */
#include <contact/parts.h>
#include <sys/stages.h>
#include <impakt/private/bodyforces.h>
#include <impakt/private/bodystep.h>

enum { MOST_PAIRS = 3 }; /* that a message names */

static const char *const Unconvergeds[] = {"error", "accept", "SchwarzUnconverged", "SCHWARZ_UNCONVERGED_", NULL};

/* What becomes of a step whose outer iteration does not converge, from the options; for methods that have one */
PetscErrorCode ContactReadUnconverged(Contact contact)
{
  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsEnum("-schwarz_unconverged", "What to do with a step that does not converge", "ContactSetFromOptions", Unconvergeds,
                             (PetscEnum)contact->options.unconverged, (PetscEnum *)&contact->options.unconverged, NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One attempt at a step. `pass`: how often it has been made with rows laid where it ended; `off`, `again`: see ContactLayAhead() */
static PetscErrorCode MakeOnce(Contact contact, PetscInt pass, PetscReal *off, PetscBool *again)
{
  PetscBool logged;

  PetscFunctionBegin;
  *again = PETSC_FALSE;
  StepFailureClear(&contact->attempt.failure);
  PetscCall(ContactBeginEnergy(contact));
  PetscCall(StageBegin(STAGE_ROWS, &logged));
  PetscCall(PetscLogEventBegin(CONTACT_Update, contact, 0, 0, 0));
  PetscTryTypeMethod(contact, layrows);
  PetscCall(ContactBond(contact));
  PetscCall(ContactUpdateRows(contact));
  ContactHoldTogether(contact);
  PetscCall(ContactDriveFriction(contact));
  if (contact->energy.rebuilt && !contact->energy.unlimited) PetscCall(ContactNoteRebuild(contact));
  PetscCall(PetscLogEventEnd(CONTACT_Update, contact, 0, 0, 0));
  PetscCall(StageEnd(logged));
  PetscCall(StageBegin(STAGE_SWEEPS, &logged));
  PetscCall(ContactTurn(contact, NULL));
  if (contact->rows.n_all) {
    PetscCall(ContactMakeStep(contact));
    if (!ContactFailed(contact)) PetscCall(ContactLayAhead(contact, pass, off, again));
    if (!ContactFailed(contact) && !*again) PetscCall(ContactLimitEnergy(contact));
  } else { /* nothing can touch */
    PetscBool penetrating;

    PetscCall(ContactIntegrateFree(contact, &penetrating));
    PetscCall(ContactCompleteBodies(contact));
  }
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As ContactStep(), for those who can make a step that fails again in halves. `may_cut`: false where this is the last try, in which the
   method may accept what has not converged; `most_loss`: energy that contact may take or bring before the step is made again, if it may be
   [J]; `reason`: negative where the step has failed, the same on every rank. After a step that has failed, or that is not to be accepted,
   call ContactStepBack(), then ContactSetStepLevel() and try again; or end by ContactRaiseFailure(). Collective. */
PetscErrorCode ContactTryStep(Contact contact, PetscBool may_cut, PetscReal most_loss, StepConvergedReason *reason)
{
  PetscReal off = 0;
  PetscBool again;
  PetscInt  pass = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscAssertPointer(reason, 4);
  PetscCall(PetscLogEventBegin(CONTACT_Step, contact, 0, 0, 0));
  contact->attempt.may_cut   = may_cut;
  contact->attempt.most_loss = most_loss;
  contact->counts.sweeps     = 0;
  ContactForgetAhead(contact);
  PetscCall(MakeOnce(contact, pass++, &off, &again));
  while (again) {
    PetscCall(ContactStepBack(contact));
    PetscCall(MakeOnce(contact, pass++, &off, &again));
    if (!ContactFailed(contact)) continue;
    PetscCall(ContactStepBack(contact)); /* with the rows of its start it went through */
    ContactForgetAhead(contact);
    PetscCall(MakeOnce(contact, PETSC_INT_MAX, &off, &again));
  }
  contact->counts.total_sweeps += contact->counts.sweeps;
  contact->attempt.may_cut = PETSC_FALSE;
  *reason                  = contact->attempt.failure.reason;
  PetscCall(PetscLogEventEnd(CONTACT_Step, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Advances all bodies from their saved states through one controller step, or one of the parts of it that ContactGetTraits() tells of,
   under contact; a failure is an error. ContactAccept() makes it final. Collective. */
PetscErrorCode ContactStep(Contact contact)
{
  StepConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(ContactTryStep(contact, PETSC_FALSE, contact->attempt.most_loss, &reason));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)contact), &contact->attempt.failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pairs that were in contact when the step failed, three at most, as text; none where bodies failed by themselves */
static PetscErrorCode NamePairs(Contact contact, size_t size, char text[])
{
  const StepConvergedReason reason = contact->attempt.failure.reason;
  PetscInt                  n      = 0;
  size_t                    used   = 0;

  PetscFunctionBegin;
  if (reason != STEP_DIVERGED_OUTER && reason != STEP_DIVERGED_ACTIVE_SET) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscBool touches = (PetscBool)(contact->n_pairs == 1);

    for (PetscInt i = contact->pairs[p].begin; i < contact->pairs[p].end; i++) touches = (PetscBool)(touches || contact->end.active[i]);
    PetscCall(ContactOr(contact, &touches));
    if (!touches || n++ >= MOST_PAIRS) continue;
    PetscCall(PetscSNPrintf(text + used, size - used, "%s%s", n == 1 ? ", in contact: " : ", ", contact->pairs[p].name));
    PetscCall(PetscStrlen(text, &used));
  }
  if (n > MOST_PAIRS) PetscCall(PetscSNPrintf(text + used, size - used, " and %" PetscInt_FMT " more", n - MOST_PAIRS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error that says why the last step has failed, which step, and how often it was cut. Collective. */
PetscErrorCode ContactRaiseFailure(Contact contact, PetscInt step, PetscInt cuts)
{
  MPI_Comm comm       = PetscObjectComm((PetscObject)contact);
  char     pairs[512] = "", halves[128] = "";

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, step, 2);
  PetscValidLogicalCollectiveInt(contact, cuts, 3);
  if (contact->attempt.failure.reason >= 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(NamePairs(contact, sizeof(pairs), pairs));
  if (cuts)
    PetscCall(PetscSNPrintf(halves, sizeof(halves),
                            ", which had been cut in halves %" PetscInt_FMT " time%s, to %g s: -controller_step_cuts", cuts,
                            cuts == 1 ? "" : "s", (double)contact->step));
  SETERRQ(comm, contact->attempt.failure.code, "%s [in controller step %" PetscInt_FMT "%s%s]", contact->attempt.failure.message, step,
          pairs, halves);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes back to the start of a controller step that has not been accepted, as if it had not been tried, but for the counts of work. The rows
   of the bodies remain those that the step has begun with until the next step begins, which starts from those before. Collective. */
PetscErrorCode ContactStepBack(Contact contact)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(BodyDropStartForce(contact->bodies[b]));
    PetscCall(BodyStepBack(contact->bodies[b]));
  }
  if (contact->energy.changed) PetscCall(PetscArraycpy(contact->start.force, contact->energy.last_force, contact->rows.n));
  contact->energy.changed = PETSC_FALSE;
  PetscCall(PetscArraycpy(contact->end.force, contact->start.force, contact->rows.n));
  PetscCall(PetscArraycpy(contact->end.gap, contact->start.gap, contact->rows.n));
  PetscCall(PetscArraycpy(contact->end.active, contact->start.active, contact->rows.n));
  contact->attempt.again = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next controller step is cut in halves so many times, from the start of a controller step on. Collective. */
PetscErrorCode ContactSetStepLevel(Contact contact, PetscInt level)
{
  ContactAttempt *attempt = &contact->attempt;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(contact, CONTACT_CLASSID, 1);
  PetscValidLogicalCollectiveInt(contact, level, 2);
  if (level == attempt->level) PetscFunctionReturn(PETSC_SUCCESS);
  if (attempt->level == 0) attempt->whole_step = contact->step;
  attempt->level = level;
  contact->step  = attempt->whole_step / PetscPowRealInt(2, level);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetStepLevel(contact->bodies[b], level));
  if (contact->rows.n_all) PetscTryTypeMethod(contact, steplevel);
  PetscFunctionReturn(PETSC_SUCCESS);
}
