/* One controller step of bodies that touch. (1) All bodies are advanced under a guess of the forces of rows; (2) the law of each node's
   rows is solved on what these would read under other forces, y + S dlambda; (3) all are advanced under the solution; (4) what rows read is
   compared with what S told of it. Where they agree the step is made; else S is corrected by the secant, and (2) comes again. (1), (3), (4)
   are one evaluation of the outer SNES, F = lambda - (2)(lambda), and (2) is the SNES of solve/. */
#include "stepimpl.h"

/* ContactStepperGetLimits - bounds that the law of friction has for touching nodes, on all ranks, by how fast they have slid */
PetscErrorCode ContactStepperGetLimits(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(problem->limit, 2 * problem->n_nodes));
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactStepperGather(contact, stepper, contact->friction.speed, stepper->gathered));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt     first = problem->begin[node];
    const ContactPair *pair  = &contact->pairs[contact->ranks.row_pair[stepper->rows[first]]];

    if (pair->law == CONTACT_LAW_FRICTION)
      ContactGetFrictionLimit(contact, pair, PetscRealPart(stepper->gathered[first]), problem->limit + 2 * node);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows touch that were left out, by the rules of their pairs */
static PetscErrorCode FindMore(Contact contact, ContactStepper *stepper, PetscBool *more)
{
  PetscFunctionBegin;
  *more = PETSC_FALSE;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactRule *rule = ContactStepperRule(stepper, &contact->pairs[p]);

    if (rule->more) PetscCall((*rule->more)(contact, stepper, &contact->pairs[p], more));
  }
  PetscCall(ContactStepperJoinTurned(contact, stepper, more));
  PetscCall(ContactOr(contact, more));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactStepperMarkRows - which rows of this rank are in contact, and which nodes slide, at the end of the step */
PetscErrorCode ContactStepperMarkRows(Contact contact, const ContactStepper *stepper)
{
  const LawProblem *problem = &stepper->problem;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i = contact->rows.acting[k], first = ContactFirstRow(contact, i);

    contact->end.active[i] = (PetscBool)(stepper->touches[i] && (contact->rows.tied[first] || contact->end.force[first] > 0));
    if (contact->friction.slides) contact->friction.slides[i] = PETSC_FALSE;
  }
  for (PetscInt node = 0; contact->friction.slides && problem->n && node < problem->n_nodes; node++) {
    const PetscInt i = stepper->rows[problem->begin[node]] - contact->rows.begin;

    if (i >= 0 && i < contact->rows.n && contact->end.force[i] > 0) contact->friction.slides[i] = LawProblemSlides(problem, node);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckFriction(Contact contact, const ContactStepper *stepper)
{
  PetscBool ambiguous;

  PetscFunctionBegin;
  if (!stepper->problem.n || contact->energy.again || !ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscFunctionReturn(PETSC_SUCCESS);
  contact->counts.friction_residual = PetscMax(contact->counts.friction_residual, LawProblemGetFrictionResidual(&stepper->problem));
  PetscCall(LawProblemIsAmbiguous(&stepper->problem, &ambiguous));
  if (ambiguous) contact->counts.ambiguous_steps++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* States of rows at the end of the step, and what contact has taken */
static PetscErrorCode EndStep(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  stepper->closed.loss = stepper->closed.force = 0;
  PetscCall(ContactStepperEndGlue(contact, stepper));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactRule *rule = ContactStepperRule(stepper, &contact->pairs[p]);

    if (rule->end) PetscCall((*rule->end)(contact, stepper, &contact->pairs[p]));
  }
  PetscCall(ContactStepperEndSprings(contact, stepper));
  PetscCall(ContactStepperMarkRows(contact, stepper));
  PetscCall(CheckFriction(contact, stepper));
  if (stepper->glued) PetscCall(ContactSumStored(contact));
  if (!contact->energy.takes) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactReduce(contact, 2, MPIU_REAL, MPIU_SUM, &stepper->closed));
  PetscCall(PetscInfo(contact, "closed rows take %g J in the step\n", (double)stepper->closed.loss));
  /* nobody else sums up what friction takes where the energy is not limited */
  PetscCall(ContactComputeFrictionLoss(contact, contact->start.force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperStep(Contact contact)
{
  ContactStepper *stepper = Stepper(contact);
  PetscBool       more    = PETSC_TRUE;

  PetscFunctionBegin;
  stepper->passes = 0;
  if (ContactHasRigid(contact) || stepper->forms) stepper->state++; /* as rigid bodies turn their compliance is another */
  stepper->forms = PETSC_FALSE;
  PetscCall(PetscArrayzero(stepper->rests, contact->n_bodies));
  PetscCall(ContactComputeRates(contact, 1, PETSC_FALSE, stepper->rate));
  for (PetscInt i = 0; i < contact->rows.n && contact->friction.drive; i++) stepper->rate[i] += contact->friction.drive[i] / contact->step;
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    PetscCall((*ContactStepperRule(stepper, &contact->pairs[p])->begin)(contact, stepper, &contact->pairs[p]));
  ContactListActingRows(contact, stepper->touches);
  PetscCall(ContactStepperGuess(contact, stepper));
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  PetscCall(ContactStepperBeginSecants(contact, stepper));
  PetscCall(ContactStepperBeginTurns(contact, stepper));
  while (more) {
    for (PetscInt k = 0; k < contact->rows.n_acting; k++)
      stepper->last[contact->rows.acting[k]] = contact->start.force[contact->rows.acting[k]];
    PetscCall(ContactStepperListRows(contact, stepper));
    if (stepper->problem.n) {
      PetscCall(ContactStepperGetLimits(contact, stepper));
      PetscCall(ContactStepperBeginGlue(contact, stepper));
      PetscCall(ContactStepperListTurns(contact, stepper));
      PetscCall(ContactStepperListSprings(contact, stepper));
      PetscCall(ContactStepperAssemble(contact, stepper));
      PetscCall(ContactStepperIterate(contact, stepper));
    } else PetscCall(ContactStepperAdvance(contact, stepper));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(FindMore(contact, stepper, &more));
    if (more) ContactListActingRows(contact, stepper->touches);
  }
  PetscCall(EndStep(contact, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
