/* The SNES on the interface that the alternation and other methods share. Private to src/contact. */
#pragma once
#include <contact/parts.h>
#include <petscsnes.h>

/* Iterations of an outer solver: more of them mean that it does not converge. Newton's method takes 1 to 5, the
   plain alternation of impedance conditions up to 41 in the paper's impacts. */
#define OUTER_MAX_ITERATIONS 50
/* Evaluations are not what ends an outer solver: more than any number of iterations needs */
#define OUTER_MAX_EVALUATIONS 1000000
/* Relative tolerance on positions: round-off of their sums, so that it is the absolute one that counts but far from the origin */
#define OUTER_POSITION_RTOL 1e-15

typedef struct {
  SNES      snes;
  Vec       x, residual;
  PetscBool watched; /* options may want to see each solve of it: monitors, views, reasons */
} OuterSolver;

PETSC_INTERN PetscErrorCode OuterSolverCreate(Contact, const char[], PetscInt, PetscErrorCode (*)(SNES, Vec, Vec, void *), OuterSolver *);
PETSC_INTERN PetscErrorCode OuterSolverSetFromOptions(Contact, OuterSolver *, PetscReal, PetscReal, PetscInt);
PETSC_INTERN PetscErrorCode OuterSolverSolve(Contact, OuterSolver *, PetscErrorCode (*)(SNES, Vec, Vec, void *), const PetscBool *);
PETSC_INTERN PetscErrorCode OuterSolverDestroy(OuterSolver *);
