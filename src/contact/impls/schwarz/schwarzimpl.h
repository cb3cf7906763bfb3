#pragma once
#include "../../outersolver.h"

/* What "change of position" is compared with the tolerances */
typedef enum {
  CONVERGENCE_AUTO,     /* the first for nrichardson with fixed relaxation, the second otherwise */
  CONVERGENCE_POSITION, /* of all nodes of every body, from one sweep to the next (the paper's) */
  CONVERGENCE_MISMATCH  /* of the contact nodes, that one more plain sweep would bring: |x - G(x)| */
} ConvergenceTest;

typedef enum {
  RELAXATION_FIXED,
  RELAXATION_AITKEN
} Relaxation;

typedef enum {
  UNCONVERGED_ERROR,
  UNCONVERGED_ACCEPT
} Unconverged;

typedef struct {
  OuterSolver         outer;
  PetscReal           atol, rtol;
  ConvergenceTest     convergence;
  Relaxation          relaxation;
  Unconverged         unconverged;
  BodyTractionType    traction;
  PetscBool           recheck;            /* tensile reactions leave the active set within the step */
  PetscInt           *levels;             /* per pair: times in the controller step at which its trace is an unknown */
  Trace               rate[2];            /* velocity and acceleration put on the Dirichlet sides of kinematic pairs */
  PetscBool          *kinematic;          /* per pair: velocity and acceleration of the Dirichlet side follow from its displacement */
  PetscInt           *offset;             /* per row: its first unknown on this rank */
  Trace              *trace;              /* per pair: displacements put on the Dirichlet side */
  PetscBool           stale;              /* the Jacobian belongs to another active set */
  PetscBool          *jacobian_active;    /* per row: the set that it belongs to */
  PetscInt           *all_offset;         /* per row, all ranks: its first unknown */
  const PetscScalar **responses;          /* per body: its waveform response */
  Trace              *body_in, *body_out; /* per body: waveforms of all rows, on every rank */
  Trace              *unit;               /* per pair: a unit at one of its unknowns */
  PetscReal           change, position;   /* of the last sweep: the body with the worst ratio */
  PetscBool           converged;
  PetscReal           damping; /* Aitken: relaxation of the last iteration */
  Vec                 last_residual;
  PetscBool          *tried; /* active sets seen in this step, one after the other */
  PetscInt            n_tried;
  PetscReal          *kept_force; /* of the contact solution, during a free trial after it */
} Schwarz;

PETSC_INTERN PetscErrorCode SchwarzSweep(SNES, Vec, Vec, void *);
PETSC_INTERN PetscErrorCode SchwarzStartTraces(Contact);
PETSC_INTERN PetscErrorCode SchwarzSetUpNewton(Contact);
PETSC_INTERN PetscErrorCode SchwarzDestroyNewton(Contact);
PETSC_INTERN PetscErrorCode SchwarzComputeJacobian(SNES, Vec, Mat, Mat, void *);
PETSC_INTERN PetscErrorCode SchwarzSetUpAitken(Contact);
PETSC_INTERN PetscErrorCode SchwarzTestConvergence(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason *, void *);
