/* Multipliers of the augmented Lagrangian from round to round */
#pragma once
#include <contact/parts.h>

typedef struct {
  PetscReal *last;   /* change of each row's force in the last round [N] */
  PetscInt   rounds; /* of which changes are known, since forces were last extrapolated */
} Augmentation;

PETSC_INTERN PetscErrorCode AugmentationTakeForces(Contact, Augmentation *, PetscReal[]);
