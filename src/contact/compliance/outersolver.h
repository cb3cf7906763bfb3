/* The SNES on the interface that Schwarz and penalty share. Private to src/contact. */
#pragma once
#include <impakt/private/contactimpl.h>
#include <petscsnes.h>

typedef struct {
  SNES snes;
  Vec  x, residual;
  Mat  jacobian;
} OuterSolver;

PETSC_INTERN PetscErrorCode OuterSolverCreate(Contact, const char[], PetscInt, PetscErrorCode (*)(SNES, Vec, Vec, void *),
                                              PetscErrorCode (*)(SNES, Vec, Mat, Mat, void *), OuterSolver *);
PETSC_INTERN PetscErrorCode OuterSolverSetNewton(Contact, OuterSolver *, PetscErrorCode (*)(SNES, Vec, Mat, Mat, void *),
                                                 PetscErrorCode (*)(PC, Vec, Vec));
PETSC_INTERN PetscErrorCode OuterSolverSetFromOptions(Contact, OuterSolver *, PetscReal, PetscReal, PetscInt);
PETSC_INTERN PetscErrorCode OuterSolverDestroy(OuterSolver *);
