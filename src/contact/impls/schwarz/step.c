/* One controller step: trial, contact, and the nodes that join and leave. */
#include "schwarzimpl.h"

/* Marks what belongs to the last active set as stale if it is another one now */
static PetscErrorCode CompareActive(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  int      differs = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) differs |= schwarz->solved_active[i] != contact->end.active[i];
  PetscCall(ContactOr(contact, &differs));
  if (!differs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(schwarz->solved_active, contact->end.active, contact->rows.n));
  schwarz->stale = PETSC_TRUE;
  if (schwarz->secants.dx) SchwarzResetSecants(contact, PETSC_TRUE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bodies under the conditions of the active set as it is, ready for sweeps */
static PetscErrorCode PrepareSweeps(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(CompareActive(contact));
  if (schwarz->newton || schwarz->mode == SCHWARZ_CONDENSED) PetscCall(SchwarzUpdateJacobian(contact));
  schwarz->step = schwarz->mode == SCHWARZ_CONDENSED && schwarz->jacobian.dense ? STEP_CONDENSED : STEP_WHOLE;
  if (schwarz->step == STEP_CONDENSED) PetscCall(SchwarzPrepareCondensed(contact));
  PetscCall(SchwarzFindGroups(contact));
  schwarz->goes_on = (PetscBool)(schwarz->iterated && schwarz->groups.on && !schwarz->substeps);
  PetscCall(SchwarzPredict(contact));
  if (schwarz->step == STEP_WHOLE) PetscCall(ContactSetSomeConditions(contact, SchwarzConditions(schwarz), schwarz->groups.rests));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the first sweep leave massless layers where they are, where Newton's step finds their balance and the forces between them in one
   solution with factors that are there: rows that stay in contact take no solution of each layer then */
static PetscErrorCode LeaveLayers(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;
  PetscInt max_it;

  PetscFunctionBegin;
  schwarz->leaves = (PetscBool)(schwarz->step == STEP_WHOLE && schwarz->newton && schwarz->exact && schwarz->full_steps &&
                                !schwarz->substeps && schwarz->transmission == SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN &&
                                !schwarz->groups.on && !schwarz->outer.watched);
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    if (!contact->pairs[p].by_force) schwarz->leaves = PETSC_FALSE;
  if (!schwarz->leaves) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SNESGetTolerances(schwarz->outer.snes, NULL, NULL, NULL, &max_it, NULL));
  if (max_it > 0) PetscCall(InterfaceOperatorBalances(schwarz->jacobian.S, &schwarz->leaves));
  else schwarz->leaves = PETSC_FALSE;
  for (PetscInt b = 0; b < contact->n_bodies && schwarz->leaves; b++) PetscCall(BodyLeaveLayer(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The outer iteration with the active set as it is */
static PetscErrorCode Iterate(Contact contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  PetscCall(PrepareSweeps(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  schwarz->swept = PETSC_FALSE;
  if (schwarz->secants.dx) SchwarzResetSecants(contact, PETSC_FALSE);
  PetscCall(LeaveLayers(contact));
  PetscCall(OuterSolverSolve(contact, &schwarz->outer, SchwarzSweep, &schwarz->converged));
  PetscCall(SchwarzCheckConverged(contact));
  if (!ContactFailed(contact)) schwarz->iterated = schwarz->groups.on;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of this rank's rows at the end of the controller step, from the bodies' traces [N] */
PetscErrorCode SchwarzGetForces(Contact contact, PetscScalar force[])
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

/* Forces and gaps at the end of the controller step */
PetscErrorCode SchwarzComputeEnd(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(SchwarzGetForces(contact, contact->end.force));
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* That iteration, then forces and gaps */
static PetscErrorCode SolveActive(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(Iterate(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzComputeEnd(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Free trial, where no pair is pushed together already; the rows that penetrate at its end become active */
static PetscErrorCode Trial(Contact contact, PetscBool *in_contact)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  schwarz->step     = STEP_WHOLE;
  schwarz->iterated = PETSC_FALSE;
  SchwarzWakeBodies(contact);
  PetscCall(ContactIntegrateFree(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzUpdateActiveSet(contact, in_contact));
  if (schwarz->mode != SCHWARZ_CONDENSED) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetBase(contact->bodies[b]));
  schwarz->have_base = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The free trial after all nodes have been let go, being pulled. If it ends in penetration by the same nodes as were held,
   the contact solution is the better of both, and is taken back. */
static PetscErrorCode TrialAfterContact(Contact contact, PetscBool *in_contact, PetscBool *taken_back)
{
  Schwarz        *schwarz   = (Schwarz *)contact->data;
  const PetscBool condensed = (PetscBool)(schwarz->step == STEP_CONDENSED);
  PetscBool       flips;

  PetscFunctionBegin;
  *taken_back = PETSC_FALSE;
  PetscCall(RoundsNext(&schwarz->rounds));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!condensed)
    for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyKeep(contact->bodies[b]));
  PetscCall(PetscArraycpy(schwarz->kept_force, contact->end.force, contact->rows.n));
  PetscCall(Trial(contact, in_contact));
  if (!*in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzBreakCycle(contact, &flips));
  /* on the compliance it is to be found again; where single rows change, others may penetrate */
  if (!flips || condensed || schwarz->rounds.single) PetscFunctionReturn(PETSC_SUCCESS);
  *taken_back = PETSC_TRUE;
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyReinstate(contact->bodies[b]));
  PetscCall(PetscArraycpy(contact->end.force, schwarz->kept_force, contact->rows.n));
  PetscCall(ContactComputeGaps(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the sweeps on the compliance have ended with, put on the whole bodies: then all rows have gaps, and one that the compliance did not
   know may penetrate */
static PetscErrorCode Finish(Contact contact, PetscBool *changed)
{
  Schwarz *schwarz = (Schwarz *)contact->data;

  PetscFunctionBegin;
  *changed = PETSC_FALSE;
  if (schwarz->step != STEP_CONDENSED) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SchwarzFinishCondensed(contact));
  schwarz->step = STEP_WHOLE;
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (schwarz->stall.rebase) {
    for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodySetBase(contact->bodies[b]));
    schwarz->stall.bases++;
    *changed = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactAny(contact, PETSC_TRUE, changed));
  if (!*changed) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (contact->end.gap[i] < -contact->options.tolerance) contact->end.active[i] = PETSC_TRUE;
  PetscCall(SchwarzTakeActiveSet(contact, changed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStep_Schwarz(Contact contact)
{
  Schwarz  *schwarz = (Schwarz *)contact->data;
  PetscBool in_contact, changed, flips, taken_back = PETSC_FALSE;

  PetscFunctionBegin;
  if (schwarz->tied.forward) {
    PetscCall(SchwarzStepTied(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(RoundsBegin(&schwarz->rounds));
  PetscCall(SchwarzBeginGroups(contact));
  PetscCall(ContactBeginRelease(contact, SchwarzPairRests));
  schwarz->have_base = schwarz->iterated = PETSC_FALSE;
  schwarz->stall.bases                   = 0;
  if (schwarz->swap && schwarz->started && !contact->energy.again && !contact->attempt.again) PetscCall(SchwarzSwapSides(contact));
  schwarz->started = PETSC_TRUE;
  /* push: in contact in the last step (sustainability), with compressive traction at its end (compression) */
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (!SchwarzPairRests(contact, contact->rows.pair[i]))
      contact->end.active[i] = (PetscBool)(contact->rows.tied[i] || (contact->start.active[i] && contact->start.force[i] > 0));
  ContactArrangeShared(contact);
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscCall(Trial(contact, &in_contact));
  while (in_contact && !taken_back) {
    PetscCall(RoundsNext(&schwarz->rounds));
    if (!ContactFailed(contact)) PetscCall(SolveActive(contact));
    if (ContactFailed(contact)) break;
    PetscCall(SchwarzUpdateActiveSet(contact, &changed));
    if (!changed && schwarz->rounds.early) {
      /* rows that were about to change have been let be: what was left is to be solved for */
      RoundsBePatient(&schwarz->rounds);
      continue;
    }
    if (!changed) PetscCall(Finish(contact, &changed));
    if (!changed || ContactFailed(contact)) break;
    contact->counts.set_changes++;
    PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
    if (in_contact) PetscCall(SchwarzBreakCycle(contact, &flips));
    else PetscCall(TrialAfterContact(contact, &in_contact, &taken_back));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
