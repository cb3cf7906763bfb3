/* Friction: rows across the normals of contact nodes, the law that bounds their forces, and what they dissipate. Private to src/contact. */
#pragma once
#include <contact/parts.h>

/* What a node does at the end of a controller step */
typedef enum { FRICTION_OPEN, FRICTION_STICKS, FRICTION_SLIDES } FrictionState;

/* One controller step on the rows of some nodes, of all ranks and on every rank. A node has `dim` rows, the first along its normal; what
   they open by follows from the forces on them by opened + S (force - base). */
typedef struct {
  PetscInt     dim, n;  /* of space; number of rows */
  PetscScalar *S;       /* n x n by columns [m/N] */
  PetscScalar *opened;  /* per row: gap, or slip over the step, under the forces `base` [m] */
  PetscScalar *base;    /* [N] */
  PetscScalar *limit;   /* per row; of a node its cohesion [N], then its coefficient: the force across the normal is at most their sum, the
                           latter times the normal force */
  PetscScalar   *force; /* at the end of the step: a guess comes in, the solution goes out [N] */
  FrictionState *state; /* per node: the same */
  PetscReal      still; /* slips of nodes that nothing moves are none up to this [m] */
  PetscInt       room;  /* rows that there is room for */
  /* of the last sweep: the change of forces [N], and what rows open by for it, by S and by the bodies [m] */
  PetscScalar *change, *told, *answer;
} FrictionProblem;

PETSC_INTERN PetscErrorCode FrictionProblemResize(FrictionProblem *, PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode FrictionProblemDestroy(FrictionProblem *);
PETSC_INTERN PetscErrorCode FrictionProblemKeepForces(FrictionProblem *, PetscReal, PetscBool *);
PETSC_INTERN PetscReal      FrictionProblemGetResidual(const FrictionProblem *);
PETSC_INTERN PetscBool      FrictionProblemIsAmbiguous(const FrictionProblem *);

typedef struct _n_FrictionSolver *FrictionSolver;

PETSC_INTERN PetscErrorCode FrictionSolverCreate(FrictionSolver *);
PETSC_INTERN PetscErrorCode FrictionSolverSolve(FrictionSolver, const FrictionProblem *, PetscBool *, PetscBool *);
PETSC_INTERN PetscErrorCode FrictionSolverDestroy(FrictionSolver *);
PETSC_INTERN void           FrictionLearn(FrictionProblem *);
PETSC_INTERN PetscErrorCode FrictionSolveNode(PetscInt, const PetscReal[], const PetscReal[], const PetscReal[], PetscReal[]);

PETSC_INTERN PetscErrorCode ContactLawCreate_Coulomb(Contact, ContactFrictionLaw *);
PETSC_INTERN PetscErrorCode ContactComputeSlips(Contact);
