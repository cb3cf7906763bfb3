/* Newton's step for contact forces that answer to the gaps: (I + D S) y = F, with the stiffness D of the rows that push and the interface
   compliance S of all bodies. Private to src/contact. */
#pragma once
#include "interfaceoperator.h"

typedef struct {
  PetscBool         rigid;     /* no gap answers to the forces at the end of the step: S = 0 */
  PetscReal        *stiffness; /* per row of this rank: change of its force with its gap, while it pushes [N/m]; the caller's */
  InterfaceOperator S;
  PetscBool         stale; /* rows or stiffness have changed */
  /* rows of this rank */
  InterfaceMark *listed;  /* those that pushed once */
  PetscBool     *pushing; /* those that do in the matrix as it is factored */
  PetscReal     *springs; /* work space: their compliance [m/N] */
  PetscScalar   *rest, *opened, *solution;
} ForceProblem;

PETSC_INTERN PetscErrorCode ForceProblemCreate(Contact, PetscReal[], ForceProblem *);
PETSC_INTERN PetscErrorCode ForceProblemUpdate(Contact, ForceProblem *, const PetscBool[], Vec);
PETSC_INTERN PetscErrorCode ForceProblemSolve(Contact, ForceProblem *, Vec, Vec);
PETSC_INTERN PetscErrorCode ForceProblemForget(Contact, ForceProblem *);
PETSC_INTERN PetscErrorCode ForceProblemDestroy(ForceProblem *);
PETSC_INTERN PetscErrorCode ForceProblemVisit(Contact, ForceProblem *, Checkpoint);
