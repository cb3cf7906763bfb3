/*
   Augmented Lagrangian by Uzawa's iteration. With the multipliers as they are, the penalty method gives forces
   lambda = <multiplier - tau A gap>; these are the next multipliers, until the gap is closed where there is a force and open where
   there is none. Each round makes the gap smaller by 1 / (1 + tau A W), with the interface compliance W; slow ones are extrapolated
   (contact/compliance/augmentation.c).
*/
#include "penaltyimpl.h"
#include <contact/compliance/augmentation.h>
#include <sys/units.h>

/* Each augmentation makes the gap smaller by 1 / (1 + tau A W): where a soft spring has tau A W = 1/10, 200 of them do by 2e8 */
#define AUGMENTATION_MAX_IT 200

static PetscErrorCode ContactSetFromOptions_AugmentedLagrangian(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;
  MPI_Comm comm    = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCall(PenaltyReadParameter(contact));
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_augmentation_tolerance", "Gap that is left [m]", "ContactPenaltySetAugmentation",
                             penalty->augmentation_tolerance, &penalty->augmentation_tolerance, NULL));
  PetscCall(PetscOptionsInt("-contact_augmentation_max_it", "Limit of augmentations in a step", "ContactPenaltySetAugmentation",
                            penalty->augmentation_max_it, &penalty->augmentation_max_it, NULL));
  PetscOptionsEnd();
  PetscCheck(penalty->augmentation_tolerance == (PetscReal)PETSC_DEFAULT || penalty->augmentation_tolerance > 0, comm, PETSC_ERR_USER_INPUT,
             "-contact_augmentation_tolerance %g%s must be positive", (double)penalty->augmentation_tolerance,
             UnitsOf((PetscObject)contact, UNIT_LENGTH));
  PetscCheck(penalty->augmentation_max_it > 0, comm, PETSC_ERR_USER_INPUT,
             "-contact_augmentation_max_it %" PetscInt_FMT " must be positive", penalty->augmentation_max_it);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_AugmentedLagrangian(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCheck(contact->options.constraint == CONTACT_CONSTRAINT_GAP, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_constraint %s: -contact_type augmented_lagrangian closes the gap only; choose -contact_type lagrange or penalty",
             ContactConstraints[contact->options.constraint]);
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscCall(ForcesCheckBodies(contact, CONTACT_AUGMENTED_LAGRANGIAN));
  if (penalty->augmentation_tolerance == (PetscReal)PETSC_DEFAULT)
    penalty->augmentation_tolerance = CONTACT_AUGMENTATION_TOLERANCE * contact->scale.length;
  PetscCall(PenaltySetUp(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest gap under a force, or penetration without one [m] */
static PetscErrorCode GetMismatch(Contact contact, PetscReal *mismatch)
{
  PetscReal worst = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    worst = PetscMax(worst, contact->end.active[i] ? PetscAbsReal(contact->end.gap[i]) : -contact->end.gap[i]);
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  *mismatch = worst;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_AugmentedLagrangian(Contact contact)
{
  Penalty     *penalty      = (Penalty *)contact->data;
  Augmentation augmentation = {.last = penalty->work};
  PetscBool    in_contact;
  PetscReal    mismatch, time;

  PetscFunctionBegin;
  PetscCall(ForcesBeginStep(contact, &penalty->forces, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(contact->end.force, contact->start.force, contact->rows.n));
  PetscCall(PetscArraycpy(penalty->multiplier, contact->end.force, contact->rows.n));
  PetscCall(PetscArrayzero(augmentation.last, contact->rows.n));
  for (PetscInt k = 0; k < penalty->augmentation_max_it; k++) {
    penalty->again = (PetscBool)(k > 0);
    if (k) PetscCall(AugmentationTakeForces(contact, &augmentation, penalty->multiplier));
    PetscCall(PenaltySolve(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(GetMismatch(contact, &mismatch));
    if (mismatch <= penalty->augmentation_tolerance) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ForcesGetTime(contact, &time));
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "The augmented Lagrangian did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
                           " augmentations the gap is off by %g%s. Raise -contact_penalty or -contact_augmentation_max_it, or loosen "
                           "-contact_augmentation_tolerance",
                           (double)time, penalty->augmentation_max_it, (double)mismatch, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_AugmentedLagrangian(Contact contact, PetscViewer viewer)
{
  const Penalty *penalty = (const Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(PenaltyViewParameter(contact, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  augmented until the gap is within %g%s\n", (double)penalty->augmentation_tolerance,
                                   UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_AUGMENTED_LAGRANGIAN - the penalty method, with forces that add up from round to round until the gap is closed

   Options Database Keys:
+  -contact_penalty tau, -contact_penalty_scale s               - penalty parameter, as with `CONTACT_PENALTY`
.  -contact_augmentation_tolerance g                            - gap that is left [m], 4e-10 of the size of the smallest body
.  -contact_augmentation_max_it n                               - limit of rounds in a step, 200
-  -penalty_snes_type, -penalty_snes_rtol, ...                  - the iteration in each round, as with `CONTACT_PENALTY`

   Level: beginner

   Note:
   Of each pair one body at least must be implicit or have massless contact nodes.

   Reference:
.  * - J. C. Simo, T. A. Laursen, An augmented Lagrangian treatment of contact problems involving friction, Computers & Structures 42
       (1992) 97-116

.seealso: `ContactSetType()`, `CONTACT_PENALTY`, `CONTACT_LAGRANGE`
M*/
PetscErrorCode ContactCreate_AugmentedLagrangian(Contact contact)
{
  Penalty *penalty;

  PetscFunctionBegin;
  PetscCall(PetscNew(&penalty));
  penalty->augmentation_tolerance = PETSC_DEFAULT;
  penalty->augmentation_max_it    = AUGMENTATION_MAX_IT;
  contact->data                   = penalty;
  contact->ops->setfromoptions    = ContactSetFromOptions_AugmentedLagrangian;
  contact->ops->setup             = ContactSetUp_AugmentedLagrangian;
  contact->ops->step              = ContactStep_AugmentedLagrangian;
  contact->ops->stored            = ContactStoresNothing;
  contact->ops->rowschanged       = PenaltyRowsChanged;
  contact->ops->stepback          = PenaltyStepBack;
  contact->ops->steplevel         = PenaltySetStepLevel;
  contact->ops->view              = ContactView_AugmentedLagrangian;
  contact->ops->visit             = PenaltyVisit;
  contact->ops->mayreplacerows    = PenaltyMayReplaceRows;
  contact->ops->reset             = PenaltyReset;
  contact->ops->destroy           = PenaltyDestroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
