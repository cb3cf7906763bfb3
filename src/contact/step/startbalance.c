/* The first state of massless nodes is the one in which they are in balance, under loads, with strains of the initial displacement, and
   with the forces of ties and of closed rows. With the layer of each body held by the rest of it, which stays where the user has put it,
   gaps g answer to forces l on the rows by

     g = g* + S l,   S = sum_bodies B K_LL^{-1} B^T,   g*: gaps of layers that relax without contact.

   That is a step of no length: the laws of rows hold for g and l as they do in others, with the springs of the penalty method on the
   diagonal of S. Rows across normals read how far they have slipped from where the user has put the bodies, so that a state of rest under
   friction stays one. Nonlinear bodies repeat it with the tangents at the displacements found. The forces are those of the first record of
   the history. It has a stepper of its own, for methods that are not the contact step, too. */
#include "stepimpl.h"
#include <impakt/private/bodystart.h>

/* Rows up to which S has entries; more are products with it */
#define FEW_ROWS 500
/* Rounds of nonlinear layers; the layer is in balance when its last change is below this part of the largest one */
#define MAX_ROUNDS 50
#define SMALL      1e-13

static PetscErrorCode TakeS(ContactStepper *stepper)
{
  const PetscInt n = stepper->problem.n;
  Mat            S, near = NULL;

  PetscFunctionBegin;
  PetscCall(ContactStepperCreateShell(stepper, &S));
  if (n > FEW_ROWS) {
    PetscCall(MatCreateConstantDiagonal(PETSC_COMM_SELF, n, n, n, n, 1, &near));
    PetscCall(MatConvert(near, MATSEQAIJ, MAT_INPLACE_MATRIX, &near));
    PetscCall(LawProblemMatchTrace(S, near));
  } else PetscCall(MatConvert(S, MATSEQDENSE, MAT_INPLACE_MATRIX, &S));
  PetscCall(LawProblemTakeS(&stepper->problem, &S, near ? &near : NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows touch that have a partner and whose forces move a massless node, and rows across their normals. But not ties that keep their mass:
   ContactStartTies() finds their forces. */
static PetscErrorCode FindRows(Contact contact, ContactStepper *stepper)
{
  PetscReal *const entries[] = {stepper->mine, stepper->before}; /* on massless nodes, and on others */

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    for (PetscInt massive = 0; massive < 2; massive++) {
      PetscCall(BodySumRows(contact->bodies[b], (PetscBool)massive, stepper->given));
      ContactAddRows(contact, b, stepper->given, entries[massive]);
    }
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt first = ContactFirstRow(contact, i);

    if (contact->rows.tied[first])
      stepper->touches[i] = (PetscBool)(entries[0][i] > 0 && !(entries[1][i] > 0 && contact->pairs[contact->rows.pair[i]].keeps_mass));
    else stepper->touches[i] = (PetscBool)(entries[0][first] > 0 && contact->rows.opposite[first]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is the same in all rounds, and `lets`, here what rows read now. Springs of a method have the compliance [m/N] that tells what they
   store at a penetration of a metre. */
static PetscErrorCode SetUp(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(LawProblemSetUp(&stepper->problem));
  PetscCall(ContactStepperCreateVecs(contact, stepper));
  for (PetscInt p = 0; p < contact->n_pairs; p++) stepper->laws[p] = &RowLawTie;
  stepper->answer = BodyMultiplyLayerCompliance;
  PetscCall(FindRows(contact, stepper));
  PetscCall(ContactStepperListRows(contact, stepper));
  PetscCall(ContactStepperListBodyRows(contact, stepper));
  PetscCall(ContactStepperGetLimits(contact, stepper));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal stored = contact->ops->stored ? (*contact->ops->stored)(contact, i, -1) : 0;

    stepper->mine[i] = stored > 0 ? 0.5 / stored : 0;
    stepper->lets[i] = contact->start.gap[i] < CONTACT_NO_GAP ? contact->start.gap[i] : 0; /* across normals: none */
  }
  stepper->penalty.any      = PETSC_TRUE;
  stepper->springs.softness = stepper->told; /* of passes, which are not made here */
  PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->springs.softness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds to what rows read how they go with layers into balance: without contact, of which bodies tell alone, or under the forces there are,
   which moves them. `change`: the largest displacement of a layer [m] */
static PetscErrorCode Balance(Contact contact, ContactStepper *stepper, PetscBool moves, PetscReal read[], PetscReal *change)
{
  PetscFunctionBegin;
  *change = 0;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal largest;

    ContactTakeRows(contact, b, contact->end.force, stepper->given);
    PetscCall(BodyBalanceLayer(contact->bodies[b], moves, stepper->given, &largest));
    ContactAddRows(contact, b, stepper->given, read);
    *change = PetscMax(*change, largest);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces by the laws for what rows read without any. Where squares of that are not finite, energies are not, of which the controller tells
   with their cause. */
static PetscErrorCode SolveRows(Contact contact, ContactStepper *stepper)
{
  LawProblem *problem = &stepper->problem;
  PetscReal   square  = 0;

  PetscFunctionBegin;
  PetscCall(ContactStepperGather(contact, stepper, stepper->mine, problem->read));
  PetscCall(ContactStepperGather(contact, stepper, contact->end.force, problem->force));
  PetscCall(PetscArrayzero(problem->base, problem->n));
  for (PetscInt k = 0; k < problem->n; k++) square += PetscSqr(PetscRealPart(problem->read[k]));
  if (!problem->n || PetscIsInfOrNanReal(square)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeS(stepper));
  PetscCall(LawProblemSolve(problem));
  PetscCheck(problem->solved, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
             "The contact forces of the first state, in which massless nodes are in balance, were not found in %" PetscInt_FMT
             " iterations for %" PetscInt_FMT " rows; raise -law_snes_max_it, or set -contact_balanced_start false to start from the "
             "displacements as they are",
             problem->iterations, problem->n);
  ContactPickRows(contact, problem->n, stepper->rows, problem->force, contact->end.force);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The states of the bodies, and of the rows, as those that the run starts from */
static PetscErrorCode Finish(Contact contact, ContactStepper *stepper)
{
  const PetscInt n = contact->rows.n;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, contact->end.force, stepper->given);
    PetscCall(BodyStartUnderForces(contact->bodies[b], stepper->given));
  }
  PetscCall(ContactReadStartGaps(contact, PETSC_TRUE));
  ContactAlignRubbingRows(contact);
  PetscCall(ContactStepperMarkRows(contact, stepper));
  PetscCall(PetscArraycpy(contact->start.force, contact->end.force, n));
  PetscCall(PetscArraycpy(contact->start.active, contact->end.active, n));
  PetscCall(PetscArraycpy(contact->energy.accepted_force, contact->end.force, n));
  for (PetscInt i = 0; i < n && contact->ops->stored; i++)
    contact->energy.last_stored[i] = (*contact->ops->stored)(contact, i, contact->end.gap[i]);
  if (contact->ops->stored) PetscCall(ContactSumStored(contact));
  PetscCall(ContactStartImpulses(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether any body has a layer out of balance, and all have inertia: what a body without inertia does in its first step is not known yet */
static PetscErrorCode IsNeeded(Contact contact, PetscBool *needed, PetscBool *linear)
{
  PetscFunctionBegin;
  *needed = PETSC_FALSE;
  *linear = PETSC_TRUE;
  if (!contact->options.balanced_start || !(contact->n_pairs || contact->neighbours.come_and_go)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (BodyDoes(contact->bodies[b], BodyIsStatic)) PetscFunctionReturn(PETSC_SUCCESS);
    *linear = (PetscBool)(*linear && BodyDoes(contact->bodies[b], BodyIsLinear));
  }
  for (PetscInt b = 0; b < contact->n_bodies && !*needed; b++) PetscCall(BodyIsOutOfBalance(contact->bodies[b], needed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The error of a first state that is not found */
static PetscErrorCode RefuseStart(Contact contact)
{
  char sudden[BODY_SUDDEN_LENGTH] = "";

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && !sudden[0]; b++) PetscCall(BodyDescribeSuddenLoad(contact->bodies[b], sudden));
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
          "The massless nodes found no balance in %d rounds at the start, from the initial displacements and loads of the bodies; give "
          "these smaller values, or set -contact_balanced_start false to start from the displacements as they are%s%s",
          MAX_ROUNDS, sudden[0] ? ". " : "", sudden);
}

/* Moves the massless nodes of all bodies into balance in their first states. Call with the bodies set up, when ties and rows are known. */
PetscErrorCode ContactBalanceStart(Contact contact)
{
  const PetscInt n       = contact->rows.n;
  ContactStepper stepper = {0};
  PetscReal      change, first = 0;
  PetscBool      needed, linear, out = PETSC_FALSE; /* of balance without forces */

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(contact->end.force, n));
  PetscCall(PetscArrayzero(contact->start.force, n));
  PetscCall(PetscArrayzero(contact->end.active, n));
  PetscCall(PetscArrayzero(contact->start.active, n));
  PetscCall(IsNeeded(contact, &needed, &linear));
  if (!needed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SetUp(contact, &stepper));
  for (PetscInt round = 0;; round++) {
    if (round == MAX_ROUNDS) PetscCall(RefuseStart(contact));
    PetscCall(PetscArraycpy(stepper.mine, stepper.lets, n));
    PetscCall(Balance(contact, &stepper, PETSC_FALSE, stepper.mine, &change));
    if (round == 0 && change == 0) break;
    out = PETSC_TRUE;
    PetscCall(SolveRows(contact, &stepper));
    PetscCall(Balance(contact, &stepper, PETSC_TRUE, stepper.lets, &change));
    first = PetscMax(first, change);
    if (linear || change <= SMALL * first) break;
  }
  if (out) PetscCall(Finish(contact, &stepper)); /* also where forces put all nodes back, as with the state of a run that goes on */
  PetscCall(ContactStepperDestroyAssembly(&stepper.assembly));
  PetscCall(ContactStepperDestroyVecs(&stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
