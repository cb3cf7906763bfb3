/* Forces by springs and dampers at the contact nodes, for the penalty method and the augmented Lagrangian. Private to
   src/contact/impls. */
#pragma once
#include <contact/compliance/forceproblem.h>
#include <contact/compliance/forces.h>
#include <contact/compliance/outersolver.h>

typedef struct {
  /* options */
  PetscReal penalty;                /* N/m for each unit of area [N/m in one dimension]; 0: from materials and elements */
  PetscReal scale;                  /* of the latter; 0: by the mass of the contact nodes */
  PetscReal damping;                /* N s/m for each unit of area */
  PetscReal augmentation_tolerance; /* of the augmented Lagrangian [m] */
  PetscInt  augmentation_max_it;    /* 0: the penalty method */
  /* all else; PenaltyReset() clears what follows */
  OuterSolver   outer;
  PetscBool     may_damp;   /* Newton's method, whose line search is not the user's */
  PetscBool     springs;    /* there are any */
  PetscReal    *spring;     /* per row of this rank [N/m] */
  PetscReal    *damper;     /* per row of this rank [N s/m] */
  PetscReal    *stiffness;  /* of both over a controller step, per row of this rank [N/m] */
  PetscReal    *work;       /* work space: three numbers per row */
  PetscReal     step;       /* the controller step [s] */
  PetscReal     atol, rtol; /* on the force [N], and relative to it */
  Forces        forces;
  ForceProblem  problem;
  ForceProblem  problems[STEP_MAX_CUTS + 1];    /* those of other levels of cut controller steps */
  PetscInt      level;                          /* the present one */
  PetscReal    *multiplier;                     /* force at a closed gap that does not change [N]; zero but for the augmented Lagrangian */
  PetscBool    *pushing;                        /* rows with a force that answers to their gap */
  PetscReal     residual, magnitude, round_off; /* [N] */
  PetscScalar **start;                          /* per body: displacement of all rows at the start of the step, the body's own */
  PetscBool     again; /* a round of the augmented Lagrangian that is to make gaps smaller than the last has: forces that are as they were
                          will not do */
} Penalty;

PETSC_INTERN PetscErrorCode PenaltyReadParameter(Contact);
PETSC_INTERN PetscErrorCode PenaltyGetPairParameter(Contact, const ContactPair *, PetscReal, PetscReal, PetscReal *, PetscReal *);
PETSC_INTERN PetscErrorCode PenaltySetUpSprings(Contact);
PETSC_INTERN PetscErrorCode PenaltyStepByFriction(Contact);
PETSC_INTERN PetscErrorCode PenaltyViewParameter(Contact, PetscViewer);
PETSC_INTERN PetscErrorCode PenaltySetUp(Contact);
PETSC_INTERN PetscErrorCode PenaltySolve(Contact);
PETSC_INTERN PetscErrorCode PenaltyStepBack(Contact);
PETSC_INTERN PetscErrorCode PenaltySetStepLevel(Contact, PetscInt, PetscBool);
PETSC_INTERN PetscErrorCode PenaltyRowsChanged(Contact);
PETSC_INTERN PetscBool      PenaltyMayReplaceRows(Contact);
PETSC_INTERN PetscErrorCode PenaltyReset(Contact);
PETSC_INTERN PetscErrorCode PenaltyDestroy(Contact);
PETSC_INTERN PetscErrorCode PenaltyVisit(Contact, Checkpoint);
