/* The penalty method and the augmented Lagrangian. Private to src/contact/impls. */
#pragma once
#include "../endforces.h"

/* What users have asked for */
static inline StepperPenalty *PenaltyOf(Contact contact)
{
  return &((ContactStepper *)contact->data)->penalty;
}

PETSC_INTERN PetscErrorCode PenaltyReadParameter(Contact);
PETSC_INTERN PetscErrorCode PenaltySetUpSprings(Contact);
PETSC_INTERN PetscErrorCode PenaltyViewParameter(Contact, PetscViewer);
