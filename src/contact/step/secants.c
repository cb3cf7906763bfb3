/* What passes show of S. The displacements of a body depend on the forces on its own rows alone, so that each has secants of its own, for
   its block of S. Those of a linear body hold all at once, by symmetric corrections of rank one: what its block lacks falls from step to
   step, until two passes are enough. Others correct it by the formula of Broyden, Fletcher, Goldfarb and Shanno, after which the last one
   holds. The block of an implicit nonlinear body is its tangent after the first pass of each step, and after a pass that it has told wrong:
   a body that flows answers ten times as far as one that does not.

   They are kept as long as the body has the same touching rows. A step begins with those of accepted steps of its own size, or with none;
   its own join them when it is accepted, so that a failed step leaves no trace.

   C. G. Broyden, IMA Journal of Applied Mathematics 6 (1970) 76-90 and 222-231, and Fletcher, Goldfarb, Shanno in the same year;
   C. G. Broyden, Mathematics of Computation 21 (1967) 368-381, for that of rank one. */
#include "stepimpl.h"
#include <checkpoint/checkpoint.h>

#define SURE_WORK 10 /* one of a linear body counts as such where S has told the work of its forces wrong by so many times round-off */
#define MOST_KEPT 80 /* secants of a body; one more, and the older half of them goes */

PetscErrorCode StepperSecantsDestroy(StepperSecants *secants)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(secants->rows));
  PetscCall(PetscFree(secants->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for so many secants of n rows; those that there are stay, if they are of as many */
PetscErrorCode StepperSecantsResize(StepperSecants *secants, PetscInt n, PetscInt n_pairs)
{
  const PetscInt size = 2 * n * n_pairs;

  PetscFunctionBegin;
  if (n > secants->row_room) {
    secants->row_room = 2 * n;
    PetscCall(PetscRealloc((size_t)secants->row_room * sizeof(*secants->rows), &secants->rows));
  }
  if (size > secants->room) {
    secants->room = 2 * size;
    PetscCall(PetscRealloc((size_t)secants->room * sizeof(*secants->values), &secants->values));
  }
  secants->n       = n;
  secants->n_pairs = n_pairs;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the first ones */
static PetscErrorCode Copy(const StepperSecants *from, PetscInt first, StepperSecants *to)
{
  PetscFunctionBegin;
  PetscCall(StepperSecantsResize(to, from->n, from->n_pairs - first));
  PetscCall(PetscArraycpy(to->rows, from->rows, from->n));
  PetscCall(PetscArraycpy(to->values, from->values + 2 * from->n * first, 2 * from->n * to->n_pairs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperBeginSecants(Contact contact, ContactStepper *stepper)
{
  const PetscBool same_size = (PetscBool)(contact->attempt.level == contact->attempt.accepted_level);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    StepperEntries *entries = &stepper->assembly.of_body[b];

    PetscCall(Copy(&entries->kept, same_size ? 0 : entries->kept.n_pairs, &entries->secants));
    if (!entries->n || entries->alone) continue;
    if (!(contact->attempt.again || contact->energy.again || entries->forgets)) continue;
    entries->corrected = entries->forgets = PETSC_FALSE; /* the attempt before at this step may have corrected it */
    stepper->assembled                    = -1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactStepperAcceptSecants(ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    StepperEntries *entries = &stepper->assembly.of_body[b];
    const PetscInt  n       = entries->secants.n_pairs;
    const PetscBool many    = (PetscBool)(n > MOST_KEPT);

    PetscCall(Copy(&entries->secants, entries->follows ? n : many ? n - MOST_KEPT / 2 : 0, &entries->kept));
    if (!many) continue;
    entries->corrected = PETSC_FALSE;
    stepper->assembled = -1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Those that are kept, which all ranks have, to or from a checkpoint */
PetscErrorCode ContactStepperVisitShared(Contact contact, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StepperSecants *kept    = &Stepper(contact)->assembly.of_body[b].kept;
    PetscInt        size[2] = {kept->n, kept->n_pairs};
    char            name[32];

    PetscCall(PetscSNPrintf(name, sizeof(name), "secants %" PetscInt_FMT, b));
    PetscCall(CheckpointVisitInts(checkpoint, name, 2, size));
    if (CheckpointLoads(checkpoint)) PetscCall(StepperSecantsResize(kept, size[0], size[1]));
    PetscCall(PetscSNPrintf(name, sizeof(name), "secant rows %" PetscInt_FMT, b));
    PetscCall(CheckpointVisitInts(checkpoint, name, kept->n, kept->rows));
    PetscCall(PetscSNPrintf(name, sizeof(name), "secant values %" PetscInt_FMT, b));
    PetscCall(CheckpointVisitReals(checkpoint, name, 2 * kept->n * kept->n_pairs, kept->values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How a block has it that rows go under the forces of a secant, and the work of these by it */
PetscReal StepperSecantMultiply(PetscInt n, const PetscScalar block[], const PetscScalar force[], PetscScalar product[])
{
  PetscReal work = 0;

  for (PetscInt k = 0; k < n; k++) product[k] = 0;
  for (PetscInt l = 0; l < n; l++)
    for (PetscInt k = 0; k < n && force[l] != 0; k++) product[k] += block[l * n + k] * force[l];
  for (PetscInt k = 0; k < n; k++) work += PetscRealPart(force[k] * product[k]);
  return work;
}

/* Whether a secant of a linear body is one of those that hold all at once; `product`: how the block has it */
static PetscBool Holds(PetscInt n, const PetscScalar force[], const PetscScalar product[], PetscReal resolution)
{
  const PetscScalar *gone = force + n;
  PetscReal          more = 0, square = 0;

  for (PetscInt k = 0; k < n; k++) {
    more += PetscRealPart(force[k] * (gone[k] - product[k]));
    square += PetscRealPart(force[k] * force[k]);
  }
  return (PetscBool)(more > SURE_WORK * resolution * PetscSqrtReal(square));
}

/* Corrects the block by a secant, by one vector (true) or two, over their work; `product`: how the block has it */
PetscBool StepperSecantCorrect(StepperEntries *entries, PetscBool linear, PetscReal resolution, const PetscScalar force[],
                               PetscScalar product[])
{
  const PetscInt     n    = entries->n;
  const PetscScalar *gone = force + n;
  const PetscBool    one  = (PetscBool)(linear && Holds(n, force, product, resolution));
  PetscReal          work = 0, told_work = 0;

  for (PetscInt k = 0; k < n; k++) {
    if (one) product[k] -= gone[k];
    work += PetscRealPart(force[k] * gone[k]);
    told_work += PetscRealPart(force[k] * product[k]);
  }
  for (PetscInt l = 0; l < n; l++) {
    const PetscScalar by_gone = one ? 0 : gone[l] / work, by_product = product[l] / told_work;

    for (PetscInt k = 0; k < n; k++) entries->block[l * n + k] += by_gone * gone[k] - by_product * product[k];
  }
  return one;
}

/* A block of the touching rows, from the body's own one and secants, unless it is there. Those of other rows are forgotten. */
PetscErrorCode ContactStepperCorrectBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  n       = entries->n;
  StepperSecants *secants = &entries->secants;
  PetscBool       same    = (PetscBool)(secants->n == n);

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(secants->rows, entries->rows, n, &same));
  if (!same) {
    PetscCall(StepperSecantsResize(secants, n, 0));
    PetscCall(PetscArraycpy(secants->rows, entries->rows, n));
  }
  if (same && entries->corrected) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(entries->block, entries->own, n * n));
  for (PetscInt j = 0; j < secants->n_pairs; j++) {
    const PetscScalar *force   = secants->values + 2 * n * j;
    PetscScalar       *product = entries->product;

    if (StepperSecantMultiply(n, entries->block, force, product) > 0)
      (void)StepperSecantCorrect(entries, BodyDoes(contact->bodies[b], BodyIsLinear), stepper->problem.resolution, force, product);
  }
  entries->corrected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
