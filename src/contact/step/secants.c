/*
   What passes show of S. The displacements of a body depend on the forces on its own rows alone, so that each has secants of its own, for
   its block of S. Those of a linear body hold all at once by symmetric corrections of rank one, since its compliance is the same in all
   passes, and more than its block, which lacks motions: so what is wrong falls from step to step, until two passes are enough. Others
   correct it by the formula of Broyden, Fletcher, Goldfarb and Shanno, after which the last one holds. The block of an implicit nonlinear
   body has its tangent after the first pass of each step, and again after a pass that it has told wrong: a body that flows answers ten
   times as far as one that does not, of which secants tell little.

   They are kept from step to step, as long as the body has the same touching rows: a body that is deformed answers in the next step nearly
   as in this one. A step begins with those of accepted steps of its own size, or with none; its own join them when it is accepted. So a
   step that has failed leaves no trace in those that are made in its place.

   C. G. Broyden, IMA Journal of Applied Mathematics 6 (1970) 76-90 and 222-231, and Fletcher, Goldfarb, Shanno in the same year;
   C. G. Broyden, Mathematics of Computation 21 (1967) 368-381, for that of rank one.
*/
#include "stepimpl.h"
#include <checkpoint/checkpoint.h>

#define CURVATURE 1e-10 /* a secant counts whose work is at least this part of what S tells of it */
#define EXACT     1e-9  /* S has told right what differs by less than this part of it, and by the round-off of positions */
#define SURE      1e3   /* a secant is kept where S has told wrong by more than this many times that round-off */
#define SURE_WORK 10    /* one of a linear body counts as such where S has told the work of its forces wrong by so many times round-off */
#define RENEW     1e-3  /* of a body that follows: S has told wrong by more than this part of it, and is as the body has answered now */
#define MOST_KEPT 80    /* secants of a body; one more, and the older half of them goes */

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
  const PetscInt size = 2 * n * n_pairs, used = n == secants->n ? 2 * n * PetscMin(n_pairs, secants->n_pairs) : 0;

  PetscFunctionBegin;
  if (n > secants->row_room) {
    secants->row_room = 2 * n;
    PetscCall(PetscFree(secants->rows));
    PetscCall(PetscMalloc1(secants->row_room, &secants->rows));
  }
  if (size > secants->room) {
    PetscScalar *values;

    secants->room = 2 * size;
    PetscCall(PetscMalloc1(secants->room, &values));
    PetscCall(PetscArraycpy(values, secants->values, used));
    PetscCall(PetscFree(secants->values));
    secants->values = values;
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

/* The secants that a step begins with */
PetscErrorCode ContactStepperBeginSecants(Contact contact, ContactStepper *stepper)
{
  const PetscBool same_size = (PetscBool)(contact->attempt.level == contact->attempt.accepted_level);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    StepperEntries *entries = &stepper->assembly.of_body[b];

    PetscCall(Copy(&entries->kept, same_size ? 0 : entries->kept.n_pairs, &entries->secants));
    if (!(contact->attempt.again || contact->energy.again) || !entries->n || entries->alone) continue;
    entries->corrected = PETSC_FALSE; /* the attempt before at this step may have corrected it */
    stepper->assembled = -1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step is accepted */
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

/* Those that are kept, for a checkpoint */
PetscErrorCode ContactStepperVisitSecants(Contact contact, ContactStepper *stepper, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StepperSecants *kept    = &stepper->assembly.of_body[b].kept;
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
static PetscReal Multiply(PetscInt n, const PetscScalar block[], const PetscScalar force[], PetscScalar product[])
{
  PetscReal work = 0;

  for (PetscInt k = 0; k < n; k++) product[k] = 0;
  for (PetscInt l = 0; l < n; l++)
    for (PetscInt k = 0; k < n && force[l] != 0; k++) product[k] += block[l * n + k] * force[l];
  for (PetscInt k = 0; k < n; k++) work += PetscRealPart(force[k] * product[k]);
  return work;
}

/* Whether a secant of a linear body is one of those that hold all at once; `product`: how the block has it */
static PetscBool HoldsWithOthers(PetscInt n, const PetscScalar force[], const PetscScalar product[], PetscReal resolution)
{
  const PetscScalar *gone = force + n;
  PetscReal          more = 0, square = 0;

  for (PetscInt k = 0; k < n; k++) {
    more += PetscRealPart(force[k] * (gone[k] - product[k]));
    square += PetscRealPart(force[k] * force[k]);
  }
  return (PetscBool)(more > SURE_WORK * resolution * PetscSqrtReal(square));
}

/* Corrects the block by a secant, and S with it unless that is NULL; `product`: how the block has it. The change is a product of one vector
   with itself, or of two, each by its work. */
static PetscErrorCode Correct(StepperEntries *entries, const PetscScalar force[], PetscScalar product[], PetscBool one, LawProblem *problem)
{
  const PetscInt     n       = entries->n;
  const PetscScalar *gone    = force + n;
  PetscScalar       *change  = product + n; /* of a column */
  PetscScalar       *S       = NULL;
  PetscInt           leading = 0;
  PetscReal          work = 0, told_work = 0;

  PetscFunctionBegin;
  if (problem && !problem->sparse) {
    PetscCall(MatDenseGetLDA(problem->S, &leading));
    PetscCall(MatDenseGetArray(problem->S, &S));
  }
  for (PetscInt k = 0; k < n; k++) {
    if (one) product[k] -= gone[k];
    work += PetscRealPart(force[k] * gone[k]);
    told_work += PetscRealPart(force[k] * product[k]);
  }
  for (PetscInt l = 0; l < n; l++) {
    const PetscInt    j       = entries->places[l];
    const PetscScalar by_gone = one ? 0 : gone[l] / work, by_product = product[l] / told_work;

    for (PetscInt k = 0; k < n; k++) {
      change[k] = by_gone * gone[k] - by_product * product[k];
      entries->block[l * n + k] += change[k];
    }
    if (!problem) continue;
    if (problem->sparse) PetscCall(MatSetValues(problem->S, n, entries->places, 1, &j, change, ADD_VALUES));
    for (PetscInt k = 0; k < n && !problem->sparse; k++) S[j * leading + entries->places[k]] += change[k];
    problem->diagonal[j] += PetscRealPart(change[l]);
  }
  if (S) PetscCall(MatDenseRestoreArray(problem->S, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block of the touching rows, from the body's own one and secants, unless it is there. Those of other rows are forgotten. */
PetscErrorCode ContactStepperCorrectBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  n       = entries->n;
  StepperSecants *secants = &entries->secants;
  PetscBool       same    = (PetscBool)(secants->n == n), linear;

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(secants->rows, entries->rows, n, &same));
  if (!same) {
    PetscCall(StepperSecantsResize(secants, n, 0));
    PetscCall(PetscArraycpy(secants->rows, entries->rows, n));
  }
  if (same && entries->corrected) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyIsLinear(contact->bodies[b], &linear));
  PetscCall(PetscArraycpy(entries->block, entries->own, n * n));
  for (PetscInt j = 0; j < secants->n_pairs; j++) {
    const PetscScalar *force   = secants->values + 2 * n * j;
    PetscScalar       *product = entries->product;
    PetscBool          one;

    if (!(Multiply(n, entries->block, force, product) > 0)) continue;
    one = (PetscBool)(linear && HoldsWithOthers(n, force, product, stepper->problem.resolution));
    PetscCall(Correct(entries, force, product, one, NULL));
  }
  entries->corrected = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

/* By how much rows have gone otherwise under the forces of a secant than a block has it */
static PetscReal Off(PetscInt n, const PetscScalar gone[], const PetscScalar product[])
{
  PetscReal off = 0;

  for (PetscInt k = 0; k < n; k++) off = PetscMax(off, PetscAbsScalar(gone[k] - product[k]));
  return off;
}

static PetscReal Largest(PetscInt n, const PetscScalar product[])
{
  PetscReal largest = 0;

  for (PetscInt k = 0; k < n; k++) largest = PetscMax(largest, PetscAbsScalar(product[k]));
  return largest;
}

/* The block of a body is as the body has answered in the last pass */
static PetscErrorCode Renew(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];

  PetscFunctionBegin;
  PetscCall(ContactStepperMakeBlock(contact, stepper, b));
  PetscCall(PetscArraycpy(entries->block, entries->own, entries->n * entries->n));
  PetscCall(StepperSecantsResize(&entries->secants, entries->n, 0));
  entries->corrected = PETSC_TRUE;
  stepper->assembled = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The block of a body is corrected by what the last two passes have shown of it, unless it has told right. Where secants of earlier steps
   have made it worse than the body's own one they are forgotten. */
static PetscErrorCode CorrectBody(Contact contact, ContactStepper *stepper, PetscInt b, PetscBool *renewed)
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
    const PetscInt     end  = i + (pair->body[1] == b) * all;

    force[k] = problem->base[i] - stepper->told[i];
    gone[k]  = ContactSign(pair, b) * (stepper->ends[end] - stepper->told[all + end]);
    work += PetscRealPart(force[k] * gone[k]);
  }
  told_work = Multiply(n, entries->block, force, product);
  off       = Off(n, gone, product);
  if (entries->follows && off > RENEW * Largest(n, product) + SURE * problem->resolution) {
    PetscCall(Renew(contact, stepper, b));
    *renewed = stepper->corrected = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (stepper->passes == 1 && at && Multiply(n, entries->own, force, product + n) > 0 && Off(n, gone, product + n) < off) {
    PetscCall(PetscArraymove(secants->values, force, 2 * n));
    PetscCall(StepperSecantsResize(secants, n, 1));
    PetscCall(PetscArraycpy(entries->block, entries->own, n * n));
    at        = 0;
    force     = secants->values;
    gone      = force + n;
    told_work = Multiply(n, entries->block, force, product);
    off       = Off(n, gone, product);
    *renewed = stepper->corrected = PETSC_TRUE;
    stepper->assembled            = -1;
  }
  if (off <= EXACT * Largest(n, product) + problem->resolution || !(work > CURVATURE * told_work) || !(told_work > 0)) {
    secants->n_pairs = at;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyIsLinear(contact->bodies[b], &one));
  one = (PetscBool)(one && HoldsWithOthers(n, force, product, problem->resolution));
  PetscCall(Correct(entries, force, product, one, problem));
  stepper->assembled = -1;
  if (!one && off <= SURE * problem->resolution) { /* for this step alone: the next one makes the block anew */
    secants->n_pairs   = at;
    entries->corrected = PETSC_FALSE;
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
    if (stepper->has_told) PetscCall(CorrectBody(contact, stepper, b, &renewed));
    else if (entries->follows) {
      PetscCall(Renew(contact, stepper, b));
      renewed = PETSC_TRUE;
    }
  }
  if (stepper->corrected) {
    PetscCall(MatAssemblyBegin(problem->S, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(problem->S, MAT_FINAL_ASSEMBLY));
  }
  if (renewed) PetscCall(ContactStepperAssemble(contact, stepper));
  PetscCall(PetscArraycpy(stepper->told, problem->base, n));
  PetscCall(PetscArraycpy(stepper->told + n, stepper->ends, 2 * n));
  stepper->has_told = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
