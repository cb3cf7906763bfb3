/* Stages of a run for -log_view, by parts of the algorithm. A stage that begins within another one interrupts it, so that they add up. */
#pragma once
#include <petsclog.h>

typedef enum {
  STAGE_SETUP,     /* meshes, surfaces, matrices and their factors */
  STAGE_SEARCH,    /* which faces are near each other, and segments where they overlap */
  STAGE_ROWS,      /* contact rows that are made anew, and what follows from them */
  STAGE_SWEEPS,    /* bodies are integrated, and answer to contact forces */
  STAGE_INTERFACE, /* compliance of the interface: columns, factors, solutions */
  STAGE_OUTPUT,    /* energies, momenta and reactions, and the observers they are for: history, fields, terminal */
  N_STAGES
} Stage;

PETSC_INTERN PetscErrorCode StagesInitialize(void);
PETSC_INTERN PetscErrorCode StageBegin(Stage, PetscBool *);
PETSC_INTERN PetscErrorCode StageEnd(PetscBool);
