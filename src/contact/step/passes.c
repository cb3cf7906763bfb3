/* The passes of a step: all bodies are advanced under forces of the touching rows, and the law has other forces for what rows read then.
   That is one evaluation of the outer SNES, F = lambda - law(lambda). */
#include "stepimpl.h"
#include <sys/units.h>

#define MOST_PASSES 50

/* What a row reads, less what it may: by the law */
static PetscReal Reading(Contact contact, const ContactStepper *stepper, PetscInt i)
{
  const RowLaw *law = ContactStepperLaw(contact, stepper, i);

  if (law->reads == ROW_LAW_READS_END) return contact->end.gap[i];
  if (law->reads == ROW_LAW_READS_MEAN) return contact->end.gap[i] + (ContactStepperTimes(contact, stepper, i) - 1) * contact->start.gap[i];
  if (!contact->rows.opposite[i]) return 0; /* across the normal of a node that may be bonded yet */
  return (ContactRowRubs(contact, i) ? contact->friction.slip[i] : contact->end.gap[i] - contact->start.gap[i]) - stepper->lets[i];
}

/* After the first solution of the law with the rows that touch: rows that join may move otherwise than their rule has said at first */
static PetscErrorCode LimitWays(Contact contact, ContactStepper *stepper)
{
  LawProblem        *problem = &stepper->problem;
  const PetscScalar *changes = stepper->gathered;
  PetscBool          any     = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt     k = problem->begin[node], i = stepper->rows[k] - contact->rows.begin;
    const ContactRule *rule = ContactStepperRule(stepper, &contact->pairs[contact->ranks.row_pair[stepper->rows[k]]]);
    PetscReal          way;

    if (i < 0 || i >= contact->rows.n) continue;
    way = rule->limit ? (*rule->limit)(contact, stepper, i, problem->diagonal[k] * PetscRealPart(problem->force[k])) : stepper->lets[i];
    stepper->mine[i] = stepper->lets[i] - way;
    stepper->lets[i] = way;
  }
  PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->gathered));
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt k = problem->begin[node];

    if (changes[k] == 0) continue;
    problem->read[k] += changes[k];
    any = PETSC_TRUE;
  }
  if (any) PetscCall(LawProblemSolve(problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much rows of each group still miss, and which groups are within the tolerance: their forces stay as they are */
static PetscErrorCode MeasureGroups(Contact contact, ContactStepper *stepper)
{
  LawProblem    *problem = &stepper->problem;
  const PetscInt n       = problem->n;
  PetscScalar   *change  = stepper->gathered;
  PetscReal      rtol, atol;

  PetscFunctionBegin;
  PetscCall(SNESGetTolerances(stepper->outer, &atol, &rtol, NULL, NULL, NULL));
  PetscCall(PetscArrayzero(stepper->off, contact->n_bodies));
  for (PetscInt i = 0; i < n; i++) change[i] = problem->force[i] - problem->base[i];
  PetscCall(LawProblemMultiply(problem, change, change));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt g = ContactStepperGroup(contact, stepper, i);

    stepper->off[g]   = PetscMax(stepper->off[g], PetscAbsScalar(change[i] + stepper->turns.shift[i]));
    stepper->scale[g] = PetscMax(stepper->scale[g], PetscAbsScalar((problem->diagonal[i] - stepper->turns.own[i]) * problem->force[i]));
  }
  PetscCall(ContactMonitorPass(contact, stepper));
  for (PetscInt g = 0; g < contact->n_bodies; g++) stepper->done[g] = (PetscBool)(stepper->off[g] <= rtol * stepper->scale[g] + atol);
  for (PetscInt i = 0; i < n; i++)
    if (stepper->done[ContactStepperGroup(contact, stepper, i)]) problem->force[i] = problem->base[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces by the law for what rows have read, and turns of gaps. Where Newton's method fails with products S gets entries, for sweeps. */
static PetscErrorCode SolveLaw(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;
  PetscBool   again   = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
  while (again) {
    PetscCall(LawProblemSolve(problem));
    again = (PetscBool)(!problem->solved && stepper->products);
    if (again) {
      stepper->forms             = PETSC_TRUE;
      stepper->assembly.of_state = -1;
    } else {
      PetscCall(ContactStepperImproveTurns(contact, stepper, &again));
      if (!again) PetscCall(ContactStepperImproveSprings(stepper, &again));
    }
    if (again) PetscCall(ContactStepperAssemble(contact, stepper));
    if (!problem->solved) PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies may be deformed by forces of a pass as nothing can be, without a word of their own: of that step there is nothing to be had */
static PetscErrorCode CheckReadings(Contact contact, const ContactStepper *stepper)
{
  const LawProblem *problem = &stepper->problem;
  PetscReal         time;
  PetscInt          i = 0;

  PetscFunctionBegin;
  while (i < problem->n && !PetscIsInfOrNanScalar(problem->read[i])) i++;
  if (i == problem->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGetTime(contact, &time));
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "Contact rows of %s read what is not a number in pass %" PetscInt_FMT
                           " of the step that ends at time %.9g s: the forces of that pass deform elements beyond all measure, as those of "
                           "a massless contact layer that yields; choose a smaller -time_step, or let contact nodes keep their mass with "
                           "-<body>_mass_redistribute false",
                           contact->pairs[contact->ranks.row_pair[stepper->rows[i]]].name, stepper->passes + 1, (double)time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces that the law has for what rows read under those in X, less these: one pass */
static PetscErrorCode ComputeChange(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  ContactStepper    *stepper = Stepper(contact);
  LawProblem        *problem = &stepper->problem;
  const PetscBool    first   = (PetscBool)!stepper->has_told; /* pass with these rows */
  const PetscInt     n = problem->n, n_acting = contact->rows.n_acting, *acting = contact->rows.acting;
  const PetscScalar *x;
  PetscScalar       *f;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  for (PetscInt k = 0; k < n_acting; k++) contact->end.force[acting[k]] = stepper->touches[acting[k]] ? PetscRealPart(x[acting[k]]) : 0;
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscCall(ContactStepperGather(contact, stepper, contact->end.force, problem->base));
  PetscCall(ContactStepperTurn(contact, stepper));
  PetscCall(ContactStepperAdvance(contact, stepper));
  if (!ContactFailed(contact)) {
    for (PetscInt k = 0; k < n_acting; k++)
      stepper->mine[acting[k]] = stepper->touches[acting[k]] ? Reading(contact, stepper, acting[k]) : 0;
    PetscCall(ContactStepperGather(contact, stepper, stepper->mine, problem->read));
    PetscCall(CheckReadings(contact, stepper));
  }
  if (ContactFailed(contact)) {
    PetscCall(VecSet(F, NAN));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  ContactStepperReadSprings(stepper);
  PetscCall(ContactStepperCorrectS(contact, stepper));
  PetscCall(SolveLaw(contact, stepper));
  if (first) PetscCall(LimitWays(contact, stepper));
  stepper->passes++;
  PetscCall(MeasureGroups(contact, stepper));
  if (!problem->solved) {
    PetscCall(VecSet(F, NAN));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(F, &f));
  PetscCall(PetscArrayzero(f, contact->rows.n));
  for (PetscInt place = 0; place < n; place++) stepper->gathered[place] = problem->base[place] - problem->force[place];
  ContactPickRows(contact, n, stepper->rows, stepper->gathered, f);
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The group that misses most, in parts of its tolerance */
static PetscInt WorstGroup(Contact contact, const ContactStepper *stepper, PetscReal atol, PetscReal rtol)
{
  PetscInt  worst = 0;
  PetscReal most  = -1;

  for (PetscInt g = 0; g < contact->n_bodies; g++) {
    const PetscReal parts = stepper->off[g] / (rtol * stepper->scale[g] + atol);

    if (!(parts <= most)) worst = g;
    most = PetscMax(most, parts);
  }
  return worst;
}

/* The step is made where rows would move no more by other forces, beside the way that forces make them go */
static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  Contact               contact = (Contact)ctx;
  const ContactStepper *stepper = Stepper(contact);
  PetscBool             done    = PETSC_TRUE;
  PetscInt              most;

  PetscFunctionBegin;
  (void)xnorm;
  (void)gnorm;
  PetscCall(SNESGetTolerances(snes, NULL, NULL, NULL, &most, NULL));
  for (PetscInt g = 0; g < contact->n_bodies; g++) done = (PetscBool)(done && stepper->done[g]);
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_LOCAL_MIN;
  else if (done) *reason = SNES_CONVERGED_FNORM_RELATIVE;
  else if (it >= most) *reason = SNES_DIVERGED_MAX_IT;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperCreateOuter(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(SNESCreate(PetscObjectComm((PetscObject)contact), &stepper->outer));
  PetscCall(SNESSetFunction(stepper->outer, NULL, ComputeChange, contact));
  PetscCall(SNESSetTolerances(stepper->outer, stepper->atol, stepper->rtol, 0, MOST_PASSES, PETSC_INT_MAX));
  PetscCall(SNESSetErrorIfNotConverged(stepper->outer, PETSC_FALSE));
  PetscCall(ContactSetOuterFromOptions(contact, stepper->outer, SNESNRICHARDSON));
  PetscCall(SNESSetConvergenceTest(stepper->outer, TestConvergence, contact, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest way of the touching rows of each group as the step begins [m], for the tolerance */
static PetscErrorCode FindScales(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < contact->rows.n_acting; k++) {
    const PetscInt i     = contact->rows.acting[k];
    PetscReal     *scale = &stepper->scale[stepper->group[contact->pairs[contact->rows.pair[i]].body[0]]];

    if (stepper->touches[i]) *scale = PetscMax(*scale, PetscAbsReal(contact->step * stepper->rate[i]));
  }
  PetscCall(ContactReduce(contact, contact->n_bodies, MPIU_REAL, MPIU_MAX, stepper->scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes as the failure of the step that the augmented Lagrangian has not closed gaps in the rounds that it may make */
static PetscErrorCode CheckSprings(Contact contact, const ContactStepper *stepper)
{
  PetscReal time;

  PetscFunctionBegin;
  if (!(stepper->springs.give > stepper->penalty.tolerance)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactGetTime(contact, &time));
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "The augmented Lagrangian did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
                           " augmentations the gap is off by %g%s. Raise -contact_penalty or -contact_augmentation_max_it, or loosen "
                           "-contact_augmentation_tolerance",
                           (double)time, stepper->springs.rounds + 1, (double)stepper->springs.give,
                           UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperIterate(Contact contact, ContactStepper *stepper)
{
  SNESConvergedReason reason;
  PetscScalar        *x;
  PetscInt            worst;
  const char         *length;
  PetscReal           time, atol, rtol;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(stepper->x, &x));
  PetscCall(PetscArraycpy(x, contact->end.force, contact->rows.n)); /* none of rows that do not touch, see guess.c */
  PetscCall(VecRestoreArrayWrite(stepper->x, &x));
  PetscCall(ContactStepperFindGroups(contact, stepper));
  PetscCall(FindScales(contact, stepper));
  stepper->has_told = PETSC_FALSE;
  PetscCall(SNESSolve(stepper->outer, NULL, stepper->x));
  PetscCall(SNESGetConvergedReason(stepper->outer, &reason));
  PetscCall(ContactMonitorStep(contact, stepper, reason));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (reason > 0) {
    PetscCall(LawProblemLetGo(&stepper->problem, CONTACT_POSITION_TOLERANCE * contact->scale.length));
    ContactPickRows(contact, stepper->problem.n, stepper->rows, stepper->problem.force, contact->end.force);
    PetscCall(CheckSprings(contact, stepper));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = stepper->touches[i]; /* whose pairs the message names */
  PetscCall(ContactGetTime(contact, &time));
  if (!stepper->problem.solved) {
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                             "The law of the %" PetscInt_FMT
                             " contact rows of the step that ends at time %.9g s was not solved in %" PetscInt_FMT
                             " iterations; choose a smaller -time_step, raise -law_snes_max_it and -law_nodes_snes_max_it, or look with "
                             "-law_snes_monitor and -law_nodes_snes_monitor",
                             stepper->problem.n, (double)time, stepper->problem.iterations));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (contact->options.unconverged == SCHWARZ_UNCONVERGED_ACCEPT && reason == SNES_DIVERGED_MAX_IT && !contact->attempt.may_cut) {
    contact->counts.unconverged_steps++;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  length = UnitsOf((PetscObject)contact, UNIT_LENGTH);
  PetscCall(SNESGetTolerances(stepper->outer, &atol, &rtol, NULL, NULL, NULL));
  worst = WorstGroup(contact, stepper, atol, rtol);
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "The contact forces of the step that ends at time %.9g s were not found in %" PetscInt_FMT
                           " passes: rows are off by %g%s, where %g%s are allowed%s; choose a smaller -time_step, raise "
                           "-schwarz_snes_max_it, or look with -schwarz_snes_monitor and -info",
                           (double)time, stepper->passes, (double)stepper->off[worst], length,
                           (double)(rtol * stepper->scale[worst] + atol), length,
                           PetscIsInfOrNanReal(stepper->off[worst]) ? " (not a number)" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}
