/* Newton's step for contact forces that answer to the gaps: (I + D S) y = F, with the stiffness D of the rows that push and the interface
   compliance S of all bodies. Private to src/contact/impls. */
#pragma once
#include <impakt/private/contactimpl.h>
#include <petscblaslapack.h>

typedef struct {
  Contact    contact;   /* borrowed */
  PetscBool  rigid;     /* no gap answers to the forces at the end of the step: S = 0 */
  PetscReal *stiffness; /* per row of this rank: change of its force with its gap, while it pushes [N/m]; the caller's */
  /* rows of this rank */
  PetscBool *listed;  /* those that pushed once */
  PetscBool *pushing; /* those that do in the matrix as it is factored */
  PetscBool  stale;   /* rows or stiffness have changed */
  /* listed rows of all ranks, on every rank, where there are not too many */
  PetscBool     dense;
  PetscInt      n, n_pushing, capacity;
  PetscInt     *rows, *body_rows, *places; /* places: of those that push among them */
  PetscReal    *springs;                   /* their stiffness, 0 where they do not push */
  PetscScalar  *compliance, *factor;       /* S, n x n, and the LU of I + D S on those that push */
  PetscScalar  *residual, *step;
  PetscBLASInt *pivots;
  /* with more of them */
  KSP iterative;
  Vec unknown, rhs, work[3];
} ForceProblem;

PETSC_INTERN PetscErrorCode ForceProblemCreate(Contact, PetscReal[], ForceProblem *);
PETSC_INTERN PetscErrorCode ForceProblemUpdate(Contact, ForceProblem *, const PetscBool[], Vec);
PETSC_INTERN PetscErrorCode ForceProblemSolve(Contact, ForceProblem *, Vec, Vec);
PETSC_INTERN PetscErrorCode ForceProblemDestroy(ForceProblem *);
