/* The penalty method and the augmented Lagrangian: the contact step with the rule `linear`, with springs and dampers between the surfaces
   (contact/step/springs.c). The force of a row at the end of a controller step is

     lambda = <m - tau A gap - c A (gap - last gap) / dt>,   <x> = max(x, 0)

   with a spring tau, a damper c, or both; m is zero but for the augmented Lagrangian. Tied rows are held by springs that pull as well. With
   explicit bodies and mass on the contact nodes the gap does not depend on the force at the end of the step: S is then that of the
   springs. */
#include "forwardimpl.h"
#include <sys/units.h>

/* Each augmentation makes the gap smaller by 1 / (1 + tau A W): where a soft spring has tau A W = 1/10, 200 of them do by 2e8 */
#define AUGMENTATION_MAX_IT 200

static PetscErrorCode ContactSetFromOptions_Penalty(Contact contact)
{
  StepperPenalty *penalty = PenaltyOf(contact);
  PetscBool       set;

  PetscFunctionBegin;
  PetscCall(ContactStepperSetFromOptions(contact));
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP_RATE) PetscCall(PenaltyReadParameter(contact));
  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_penalty_damping", "Damping of the gap rate [N s/m in 1-D, N s/m^3 else]", "ContactSetFromOptions",
                             penalty->damping, &penalty->damping, &set));
  PetscOptionsEnd();
  PetscCheck(!set || penalty->damping > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_penalty_damping %g must be positive", (double)penalty->damping);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetFromOptions_AugmentedLagrangian(Contact contact)
{
  StepperPenalty *penalty = PenaltyOf(contact);
  MPI_Comm        comm    = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCall(ContactStepperSetFromOptions(contact));
  PetscCall(PenaltyReadParameter(contact));
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_augmentation_tolerance", "Gap that is left [m]", "ContactSetFromOptions", penalty->tolerance,
                             &penalty->tolerance, NULL));
  PetscCall(PetscOptionsInt("-contact_augmentation_max_it", "Limit of augmentations in a step", "ContactSetFromOptions", penalty->rounds,
                            &penalty->rounds, NULL));
  PetscOptionsEnd();
  PetscCheck(penalty->tolerance == (PetscReal)PETSC_DEFAULT || penalty->tolerance > 0, comm, PETSC_ERR_USER_INPUT,
             "-contact_augmentation_tolerance %g%s must be positive", (double)penalty->tolerance,
             UnitsOf((PetscObject)contact, UNIT_LENGTH));
  PetscCheck(penalty->rounds > 0, comm, PETSC_ERR_USER_INPUT, "-contact_augmentation_max_it %" PetscInt_FMT " must be positive",
             penalty->rounds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(Contact contact)
{
  StepperPenalty *penalty = PenaltyOf(contact);
  const PetscBool rates   = (PetscBool)(contact->options.constraint != CONTACT_CONSTRAINT_GAP);
  MPI_Comm        comm    = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCheck(!rates || !penalty->rounds, comm, PETSC_ERR_USER_INPUT,
             "-contact_constraint %s: -contact_type augmented_lagrangian closes the gap only; choose -contact_type lagrange or penalty",
             ContactConstraints[contact->options.constraint]);
  PetscCall(StepperCheckFriction(contact));
  PetscCheck(!rates || penalty->damping > 0, comm, PETSC_ERR_USER_INPUT,
             "-contact_constraint %s with -contact_type penalty needs -contact_penalty_damping, in N s/m in one dimension; the impedance "
             "of a bar, sqrt(E rho) times its area, is its scale",
             ContactConstraints[contact->options.constraint]);
  if (penalty->rounds) PetscCall(StepperCheckBodies(contact));
  if (penalty->tolerance == (PetscReal)PETSC_DEFAULT) penalty->tolerance = CONTACT_AUGMENTATION_TOLERANCE * contact->scale.length;
  PetscCall(ContactStepperSetUp(contact));
  PetscCall(PenaltySetUpSprings(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Areas are others, and so are the explicit steps that springs stand */
static PetscErrorCode RowsChanged(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactStepperRowsChanged(contact));
  PetscCall(PenaltySetUpSprings(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode View(Contact contact, PetscViewer viewer)
{
  const StepperPenalty *penalty = PenaltyOf(contact);

  PetscFunctionBegin;
  PetscCall(ContactStepperView(contact, viewer));
  PetscCall(PenaltyViewParameter(contact, viewer));
  if (penalty->damping > 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  damping %g%s\n", (double)penalty->damping,
                                     UnitsOf((PetscObject)contact, contact->dim == 1 ? UNIT_DASHPOT : UNIT_DASHPOT_ON_AREA)));
  if (penalty->rounds)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  augmented until %s within %g%s\n",
                                     ContactAnyPairHas(contact, CONTACT_LAW_FRICTION) ? "gaps and slips are" : "the gap is",
                                     (double)penalty->tolerance, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactCreate_Schwarz(contact));
  StepperClosesEnds(contact);
  PenaltyOf(contact)->any   = PETSC_TRUE;
  contact->ops->setup       = SetUp;
  contact->ops->rowschanged = RowsChanged;
  contact->ops->view        = View;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_PENALTY - contact forces in proportion to the penetration, or to its rate

   Options Database Keys:
+  -contact_penalty tau                    - penalty parameter [N/m^3; N/m in one dimension]; else by -contact_penalty_scale
.  -contact_constraint (gap|gap_rate|both) - springs, dampers in their place, or both
.  -contact_penalty_damping c              - damping [N s/m^3; N s/m in one dimension], required by dampers
-  -schwarz_snes_..., -law_snes_...        - the outer iteration, and how the law of rows is solved, as with `CONTACT_SCHWARZ`

   Level: beginner

   Notes:
   Implicit or explicit by the integrators of the bodies. The energy in the springs is reported beside that of the bodies; what
   dampers take is lost from these.

   The gap rate is the change of the gap over a controller step; dampers push on rows that were in contact or penetrate in a free
   trial. Without springs nothing brings penetration back: it grows while the bodies push.

.seealso: `ContactSetType()`, `CONTACT_SCHWARZ`, `CONTACT_LAGRANGE`, `CONTACT_AUGMENTED_LAGRANGIAN`
M*/
PetscErrorCode ContactCreate_Penalty(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(Create(contact));
  contact->ops->setfromoptions = ContactSetFromOptions_Penalty;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_AUGMENTED_LAGRANGIAN - the penalty method, with forces that add up from round to round until the gap is closed

   Options Database Keys:
+  -contact_penalty tau, -contact_penalty_scale s - penalty parameter, as with `CONTACT_PENALTY`
.  -contact_augmentation_tolerance g              - gap that is left [m], 4e-10 of the size of the smallest body
.  -contact_augmentation_max_it n                 - limit of rounds in a step, 200
-  -schwarz_snes_..., -law_snes_...               - the outer iteration, and how the law of rows is solved, as with `CONTACT_SCHWARZ`

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
  PetscFunctionBegin;
  PetscCall(Create(contact));
  PenaltyOf(contact)->tolerance = PETSC_DEFAULT;
  PenaltyOf(contact)->rounds    = AUGMENTATION_MAX_IT;
  contact->ops->setfromoptions  = ContactSetFromOptions_AugmentedLagrangian;
  PetscFunctionReturn(PETSC_SUCCESS);
}
