/*
   What passes show of S: secants by the formula of Broyden, Fletcher, Goldfarb and Shanno. The displacements of a body depend on the forces
   on its own rows alone, so that each has a secant of its own, for its block of S.

   C. G. Broyden, IMA Journal of Applied Mathematics 6 (1970) 76-90 and 222-231, and Fletcher, Goldfarb, Shanno in the same year.
*/
#include "stepimpl.h"

#define CURVATURE 1e-10 /* a secant counts whose work is at least this part of what S tells of it */
#define EXACT     1e-9  /* S has told right what differs by less than this part of it, and by the round-off of positions */

/* How the bodies of each touching row have gone along it in the last pass */
static PetscErrorCode GatherEnds(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    for (PetscInt p = 0; p < contact->n_pairs; p++) {
      const ContactPair *pair  = &contact->pairs[p];
      const Trace        trace = contact->traces[pair->body[side]].displacement;
      PetscScalar       *end;
      PetscInt           levels;

      PetscCall(TraceGetSizes(trace, NULL, &levels));
      PetscCall(TraceGetLevel(trace, levels, &end));
      for (PetscInt i = pair->begin; i < pair->end; i++) stepper->mine[i] = PetscRealPart(end[i - pair->shift[side]]);
    }
    PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->ends + side * stepper->problem.n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The block of a body is corrected by what the last two passes have shown of it, unless it has told right */
static PetscErrorCode CorrectBody(Contact contact, ContactStepper *stepper, PetscInt b)
{
  LawProblem     *problem = &stepper->problem;
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  n = entries->n, all = problem->n;
  PetscScalar    *force = stepper->secant, *gone = force + n, *product = gone + n;
  PetscReal       work = 0, told_work = 0, off = 0, largest = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt     i    = entries->places[k];
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[i]]];
    const PetscInt     at   = i + (pair->body[1] == b) * all;

    force[k]   = problem->base[i] - stepper->told[i];
    gone[k]    = ContactSign(pair, b) * (stepper->ends[at] - stepper->told[all + at]);
    product[k] = 0;
  }
  for (PetscInt l = 0; l < n; l++)
    for (PetscInt k = 0; k < n && force[l] != 0; k++) product[k] += entries->block[l * n + k] * force[l];
  for (PetscInt k = 0; k < n; k++) {
    work += PetscRealPart(force[k] * gone[k]);
    told_work += PetscRealPart(force[k] * product[k]);
    off     = PetscMax(off, PetscAbsScalar(gone[k] - product[k]));
    largest = PetscMax(largest, PetscAbsScalar(product[k]));
  }
  if (off <= EXACT * largest + problem->resolution || !(work > CURVATURE * told_work) || !(told_work > 0))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt l = 0; l < n; l++) {
    const PetscInt    j       = entries->places[l];
    PetscScalar      *change  = force; /* of a column */
    const PetscScalar by_gone = gone[l] / work, by_product = product[l] / told_work;

    for (PetscInt k = 0; k < n; k++) {
      change[k] = by_gone * gone[k] - by_product * product[k];
      entries->block[l * n + k] += change[k];
    }
    PetscCall(MatSetValues(problem->S, n, entries->places, 1, &j, change, ADD_VALUES));
    problem->diagonal[j] += PetscRealPart(change[l]);
  }
  stepper->assembled = -1;
  stepper->corrected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S after a pass, body by body. One whose nodes answer to forces on them alone tells right. */
PetscErrorCode ContactStepperCorrectS(Contact contact, ContactStepper *stepper)
{
  LawProblem    *problem = &stepper->problem;
  const PetscInt n       = problem->n;
  PetscBool      any     = PETSC_FALSE;

  PetscFunctionBegin;
  stepper->corrected = PETSC_FALSE;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    any = (PetscBool)(any || (stepper->assembly.of_body[b].n && !stepper->assembly.of_body[b].alone));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GatherEnds(contact, stepper));
  for (PetscInt b = 0; b < contact->n_bodies && stepper->has_told; b++)
    if (stepper->assembly.of_body[b].n && !stepper->assembly.of_body[b].alone) PetscCall(CorrectBody(contact, stepper, b));
  if (stepper->corrected) {
    PetscCall(MatAssemblyBegin(problem->S, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(problem->S, MAT_FINAL_ASSEMBLY));
  }
  PetscCall(PetscArraycpy(stepper->told, problem->base, n));
  PetscCall(PetscArraycpy(stepper->told + n, stepper->ends, 2 * n));
  stepper->has_told = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
