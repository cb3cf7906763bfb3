/* Methods that close gaps by the force at the end of a step: the contact step with the rule `linear`, whatever mass contact nodes have.
   Private to src/contact/impls. */
#pragma once
#include <contact/step/stepimpl.h>

/* Takes the rule `linear` for all sets */
static inline void StepperClosesEnds(Contact contact)
{
  ((ContactStepper *)contact->data)->asked = &ContactRuleLinear;
  contact->impulses                        = PETSC_FALSE;
  contact->ops->layrows                    = NULL;
  contact->ops->maybalance                 = NULL;
}

PETSC_INTERN PetscErrorCode StepperCheckFriction(Contact);
PETSC_INTERN PetscErrorCode StepperCheckBodies(Contact);
