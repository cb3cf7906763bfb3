/* Corrections of S by what passes show: for each body a secant, or where the body follows its tangent the block anew. */
#include "stepimpl.h"

#define CURVATURE 1e-10 /* a secant counts whose work is at least this part of what S tells of it */
#define EXACT     1e-9  /* S has told right what differs by less than this part of it, and by the round-off of positions */
#define SURE      1e3   /* a secant is kept where S has told wrong by more than this many times that round-off */
#define RENEW     1e-3  /* of a body that follows: S has told wrong by more than this part of it, and is as the body has answered now */

/* How the bodies of each touching row have gone along it in the last pass */
static PetscErrorCode GatherEnds(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      const ContactPair *pair = &contact->pairs[p];
      PetscScalar       *end[2];

      PetscCall(ContactGetPairTraces(contact, pair, 0, PETSC_TRUE, end));
      for (PetscInt i = pair->begin; i < pair->end; i++) stepper->mine[i] = PetscRealPart(end[side][i - pair->shift[side]]);
    }
    PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->ends + side * stepper->problem.n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much rows go under the forces of a secant as a block has it, at most; less what they have `gone`, unless that is NULL [m] */
static PetscReal Largest(PetscInt n, const PetscScalar product[], const PetscScalar gone[])
{
  PetscReal largest = 0;

  for (PetscInt k = 0; k < n; k++) largest = PetscMax(largest, PetscAbsScalar(product[k] - (gone ? gone[k] : 0)));
  return largest;
}

/* The block of a body is as the body has answered in the last pass, once S is assembled */
static PetscErrorCode Renew(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];

  PetscFunctionBegin;
  PetscCall(ContactStepperMakeBlock(contact, stepper, b));
  entries->secants.n_pairs = 0;
  entries->corrected       = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The block of a body is corrected by what the last two passes have shown of it, unless it has told right. Where secants of earlier steps
   have made it worse than the body's own one they are forgotten. */
static PetscErrorCode CorrectBody(Contact contact, ContactStepper *stepper, PetscInt b)
{
  LawProblem     *problem = &stepper->problem;
  StepperEntries *entries = &stepper->assembly.of_body[b];
  StepperSecants *secants = &entries->secants;
  const PetscInt  n = entries->n, all = problem->n;
  PetscBool       one;
  PetscInt        at   = secants->n_pairs;
  PetscReal       work = 0, told_work, off;
  PetscScalar    *force, *gone, *product = entries->product;

  PetscFunctionBegin;
  PetscCall(StepperSecantsResize(secants, n, at + 1));
  force = secants->values + 2 * n * at;
  gone  = force + n;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt     i    = entries->places[k];
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[i]]];
    const PetscInt     end  = i + (pair->body[0] != b) * all;

    force[k] = problem->base[i] - stepper->told[i];
    gone[k]  = stepper->ends[end] - stepper->told[all + end];
    work += PetscRealPart(force[k] * gone[k]);
  }
  told_work = StepperSecantMultiply(n, entries->block, force, product);
  off       = Largest(n, product, gone);
  if (entries->follows && off > RENEW * Largest(n, product, NULL) + SURE * problem->resolution) {
    PetscCall(Renew(contact, stepper, b));
    stepper->corrected = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (stepper->passes == 1 && at && StepperSecantMultiply(n, entries->own, force, product + n) > 0 && Largest(n, product + n, gone) < off) {
    PetscCall(PetscArraymove(secants->values, force, 2 * n));
    PetscCall(StepperSecantsResize(secants, n, 1));
    PetscCall(PetscArraycpy(entries->block, entries->own, n * n));
    at                 = 0;
    force              = secants->values;
    gone               = force + n;
    told_work          = StepperSecantMultiply(n, entries->block, force, product);
    off                = Largest(n, product, gone);
    stepper->corrected = PETSC_TRUE;
  }
  if (off <= EXACT * Largest(n, product, NULL) + problem->resolution || !(work > CURVATURE * told_work) || !(told_work > 0)) {
    secants->n_pairs = at;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  one = StepperSecantCorrect(entries, BodyDoes(contact->bodies[b], BodyIsLinear), problem->resolution, force, product);
  if (!one && off <= SURE * problem->resolution) { /* for this step alone: the next one makes the block anew */
    secants->n_pairs = at;
    entries->forgets = PETSC_TRUE;
  }
  stepper->corrected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S after a pass, body by body. One whose nodes answer to forces on them alone tells right. */
PetscErrorCode ContactStepperCorrectS(Contact contact, ContactStepper *stepper)
{
  LawProblem    *problem = &stepper->problem;
  const PetscInt n       = problem->n;
  PetscBool      any = PETSC_FALSE, renewed = PETSC_FALSE;

  PetscFunctionBegin;
  stepper->corrected = PETSC_FALSE;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    any = (PetscBool)(any || (stepper->assembly.of_body[b].n && !stepper->assembly.of_body[b].alone));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GatherEnds(contact, stepper));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const StepperEntries *entries = &stepper->assembly.of_body[b];

    if (!entries->n || entries->alone) continue;
    if (stepper->has_told) PetscCall(CorrectBody(contact, stepper, b));
    else if (entries->follows) {
      PetscCall(Renew(contact, stepper, b));
      renewed = PETSC_TRUE;
    }
  }
  if (stepper->corrected || renewed) {
    stepper->assembled = -1;
    PetscCall(ContactStepperAssemble(contact, stepper));
  }
  PetscCall(PetscArraycpy(stepper->told, problem->base, n));
  PetscCall(PetscArraycpy(stepper->told + n, stepper->ends, 2 * n));
  stepper->has_told = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
