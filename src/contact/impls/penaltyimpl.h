/* Forces by springs and dampers at the contact nodes, for the penalty method and the augmented Lagrangian. Private to
   src/contact/impls. */
#pragma once
#include "forces.h"
#include "../outersolver.h"

typedef struct {
  OuterSolver   outer;
  PetscReal     penalty;          /* N/m for each unit of area [N/m in one dimension] */
  PetscReal     damping;          /* N s/m for each unit of area */
  PetscReal     step;             /* the controller step [s] */
  PetscReal     atol, rtol;       /* on the force [N], and relative to it */
  Trace         force;            /* of all rows over the controller step */
  PetscReal    *multiplier;       /* force at a closed gap that does not change [N]; zero but for the augmented Lagrangian */
  PetscBool    *held;             /* rows whose gap rate matters in this step */
  PetscBool    *pushing;          /* rows with a force that answers to their gap */
  PetscBool    *jacobian_pushing; /* the set that the Jacobian belongs to */
  PetscBool     have_jacobian;
  PetscScalar  *compliance;                     /* all rows by all rows, by columns [m/N] */
  PetscReal     residual, magnitude, round_off; /* [N] */
  PetscScalar **start;                          /* per body: displacement of all rows at the start of the step, the body's own */
  /* augmented Lagrangian */
  PetscReal augmentation_tolerance; /* [m] */
  PetscInt  augmentation_max_it;
} Penalty;

PETSC_INTERN PetscErrorCode PenaltyReadParameter(Contact);
PETSC_INTERN PetscErrorCode PenaltySetUp(Contact);
PETSC_INTERN PetscErrorCode PenaltySolve(Contact);
PETSC_INTERN PetscErrorCode PenaltyDestroy(Contact);
