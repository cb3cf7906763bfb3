/* Multipliers and springs at the ends of steps, and what corrects states around them. Private to src/contact/impls. */
#pragma once
#include "complementarity.h"
#include <contact/step/stepimpl.h>

/* Takes the contact step with the rule `linear` for all sets, whatever mass contact nodes have: it closes gaps by the force at its end */
static inline void StepperClosesEnds(Contact contact)
{
  ((ContactStepper *)contact->data)->asked = &ContactRuleLinear;
  contact->impulses                        = PETSC_FALSE;
  contact->ops->layrows                    = NULL;
  contact->ops->maybalance                 = NULL;
}

/* What users have asked for of springs */
static inline StepperPenalty *PenaltyOf(Contact contact)
{
  return &((ContactStepper *)contact->data)->penalty;
}

PETSC_INTERN PetscErrorCode StepperCheckFriction(Contact);
PETSC_INTERN PetscErrorCode StepperCheckBodies(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpForward(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImplicit(Contact);
PETSC_INTERN PetscErrorCode LagrangeSetUpImpulses(Contact, const char[], Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeCloseRate(Contact, PetscBool, Complementarity *);
PETSC_INTERN PetscErrorCode LagrangeProjectPrediction(Contact, Complementarity *);
PETSC_INTERN PetscErrorCode PenaltyReadParameter(Contact);
PETSC_INTERN PetscErrorCode PenaltySetUpSprings(Contact);
PETSC_INTERN PetscErrorCode PenaltyViewParameter(Contact, PetscViewer);
