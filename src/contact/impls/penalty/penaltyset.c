/* Setters of the penalty method and of the augmented Lagrangian, beside their options. */
#include "penaltyimpl.h"
#include "../methodset.h"
#include <sys/units.h>

/*@
  ContactPenaltySetParameter - sets the stiffness of the springs

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, of type `CONTACT_PENALTY` or `CONTACT_AUGMENTED_LAGRANGIAN`, not yet set up
- parameter - [N/m^3], in one dimension [N/m]; by default from materials and elements

  Options Database Key:
. -contact_penalty p - the stiffness of the springs

  Level: intermediate

.seealso: `Contact`, `CONTACT_PENALTY`
@*/
PetscErrorCode ContactPenaltySetParameter(Contact contact, PetscReal parameter)
{
  ContactStepper *stepper = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_PENALTY, CONTACT_AUGMENTED_LAGRANGIAN, "CONTACT_PENALTY", (void **)&stepper);
  PetscValidLogicalCollectiveReal(contact, parameter, 2);
  PetscCheck(parameter > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "A penalty parameter of %g must be positive",
             (double)parameter);
  stepper->penalty.parameter = parameter;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactPenaltySetScale - sets the stiffness of the springs relative to that of the elements

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_PENALTY` or `CONTACT_AUGMENTED_LAGRANGIAN`, not yet set up
- scale   - times the stiffness of an element of each side, one behind the other

  Options Database Key:
. -contact_penalty_scale s - the stiffness of the springs relative to that of the elements

  Level: intermediate

.seealso: `Contact`, `CONTACT_PENALTY`
@*/
PetscErrorCode ContactPenaltySetScale(Contact contact, PetscReal scale)
{
  ContactStepper *stepper = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_PENALTY, CONTACT_AUGMENTED_LAGRANGIAN, "CONTACT_PENALTY", (void **)&stepper);
  PetscValidLogicalCollectiveReal(contact, scale, 2);
  PetscCheck(scale > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "A penalty scale of %g must be positive",
             (double)scale);
  stepper->penalty.scale = scale;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactPenaltySetDamping - sets the dampers on the gap rate

  Logically Collective

  Input Parameters:
+ contact - the `Contact`, of type `CONTACT_PENALTY` or `CONTACT_AUGMENTED_LAGRANGIAN`, not yet set up
- damping - [N s/m^3], in one dimension [N s/m]

  Options Database Key:
. -contact_penalty_damping c - the dampers on the gap rate

  Level: intermediate

.seealso: `Contact`, `CONTACT_PENALTY`
@*/
PetscErrorCode ContactPenaltySetDamping(Contact contact, PetscReal damping)
{
  ContactStepper *stepper = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_PENALTY, CONTACT_AUGMENTED_LAGRANGIAN, "CONTACT_PENALTY", (void **)&stepper);
  PetscValidLogicalCollectiveReal(contact, damping, 2);
  PetscCheck(damping > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE, "A damping of %g must be positive",
             (double)damping);
  stepper->penalty.damping = damping;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ContactPenaltySetAugmentation - sets when augmentations end

  Logically Collective

  Input Parameters:
+ contact   - the `Contact`, of type `CONTACT_AUGMENTED_LAGRANGIAN`, not yet set up
. tolerance - gap that is left [m]
- max_it    - limit of augmentations in a controller step

  Options Database Keys:
+ -contact_augmentation_tolerance g - gap that is left
- -contact_augmentation_max_it n    - limit of augmentations

  Level: intermediate

.seealso: `Contact`, `CONTACT_AUGMENTED_LAGRANGIAN`
@*/
PetscErrorCode ContactPenaltySetAugmentation(Contact contact, PetscReal tolerance, PetscInt max_it)
{
  ContactStepper *stepper = NULL;

  PetscFunctionBegin;
  ContactGetMethod(contact, CONTACT_PENALTY, CONTACT_AUGMENTED_LAGRANGIAN, "CONTACT_PENALTY", (void **)&stepper);
  PetscValidLogicalCollectiveReal(contact, tolerance, 2);
  PetscValidLogicalCollectiveInt(contact, max_it, 3);
  PetscCheck(tolerance > 0 && max_it > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_OUTOFRANGE,
             "A gap of %g%s that is left, and a limit of %" PetscInt_FMT " augmentations, must be positive", (double)tolerance,
             UnitsOf((PetscObject)contact, UNIT_LENGTH), max_it);
  stepper->penalty.tolerance = tolerance;
  stepper->penalty.rounds    = max_it;
  PetscFunctionReturn(PETSC_SUCCESS);
}
