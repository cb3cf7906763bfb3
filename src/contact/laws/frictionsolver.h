/* The solver of a controller step with friction: what its sources share. Private to this folder. */
#pragma once
#include "friction.h"
#include <petscksp.h>
#include <solver/densefactor.h>

struct _n_FrictionSolver {
  PetscInt     room;
  PetscScalar *open, *trial, *rhs;    /* what rows open by; trial forces; right-hand side, where S is a matrix then Newton's step */
  PetscScalar *of_force, *of_opening; /* the equations, see FrictionSetEquations(): `dim` numbers for each row */
  /* where S is a matrix */
  DenseFactor factor;
  PetscInt   *in; /* rows of nodes that touch */
  /* where it is not */
  KSP                    ksp;
  Vec                    step, residual; /* of the size that there is room for */
  PetscScalar           *work[3];        /* a number for each row */
  PetscBool             *chosen;         /* rows that are preconditioned */
  const FrictionProblem *problem;        /* that is being solved */
  PetscInt               iterated;       /* rows that there is room for */
  PetscInt               iterations;     /* of GMRES for the present problem */
};

PETSC_INTERN PetscErrorCode FrictionOpen(FrictionSolver, const FrictionProblem *);
PETSC_INTERN PetscReal      FrictionStiffness(const FrictionProblem *, PetscInt, PetscInt, PetscInt);
PETSC_INTERN PetscBool      FrictionImmovable(const FrictionProblem *, PetscInt, PetscInt);
PETSC_INTERN PetscBool      FrictionDragged(const FrictionProblem *, const PetscScalar[], PetscInt);
PETSC_INTERN PetscBool      FrictionJudge(FrictionSolver, const FrictionProblem *, PetscBool);
PETSC_INTERN void           FrictionSetEquations(FrictionSolver, const FrictionProblem *);
PETSC_INTERN PetscBool      FrictionDropForces(FrictionSolver, const FrictionProblem *);
PETSC_INTERN PetscErrorCode FrictionIterate(FrictionSolver, const FrictionProblem *, PetscBool *, PetscBool *);
PETSC_INTERN PetscErrorCode FrictionIterationCreate(FrictionSolver);
PETSC_INTERN PetscErrorCode FrictionIterationDestroy(FrictionSolver);
PETSC_INTERN PetscErrorCode FrictionSolveByBounds(FrictionSolver, const FrictionProblem *);
