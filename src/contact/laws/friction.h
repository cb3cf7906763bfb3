/* Friction: rows across the normals of contact nodes, the law that bounds their forces, and what they dissipate. Private to src/contact. */
#pragma once
#include <contact/parts.h>

/* Corrections of S that there is room for: sweeps of a step */
#define FRICTION_SECANTS 60

/* What a node does at the end of a controller step */
typedef enum { FRICTION_OPEN, FRICTION_STICKS, FRICTION_SLIDES } FrictionState;

/* S where its rows are too many for a matrix: what is done with it. Arrays have the rows of the problem, the same on every rank; all
   functions are collective. */
typedef struct {
  void *data;                                                                 /* handed to all of these */
  PetscErrorCode (*multiply)(void *, const PetscScalar[], PetscScalar[]);     /* y = S x */
  PetscErrorCode (*choose)(void *, const PetscBool[]);                        /* (NULL) the rows that are preconditioned from now on */
  PetscErrorCode (*precondition)(void *, const PetscScalar[], PetscScalar[]); /* y = P x on these, with P about the inverse of S; where
                                                                                 nothing is known of that y stays as it comes in */
} FrictionProducts;

/* One controller step on the rows of some nodes, of all ranks and on every rank. A node has `dim` rows, the first along its normal; what
   they open by follows from the forces on them by opened + S (force - base). */
typedef struct {
  PetscInt                dim, n; /* of space; number of rows */
  PetscScalar            *S;      /* n x n by columns [m/N]; NULL: there is the following in its place */
  const FrictionProducts *products;
  PetscScalar            *diagonal; /* per row about what S has there, the same for all rows across a normal; 0 where nothing moves it */
  /* what sweeps have corrected that by: one pair of vectors a, b for each, S + a a' - b b' */
  PetscInt     n_secants;
  PetscScalar *secants;
  PetscScalar *opened;   /* per row: gap, or slip over the step, under the forces `base` [m] */
  PetscScalar *base;     /* [N] */
  PetscScalar *limit;    /* per row; of a node its cohesion [N], then its coefficient: the force across the normal is at most their sum, the
                            latter times the normal force */
  PetscScalar   *force;  /* at the end of the step: a guess comes in, the solution goes out [N] */
  FrictionState *state;  /* per node: the same */
  PetscReal      still;  /* slips of nodes that nothing moves are none up to this [m] */
  PetscInt       room;   /* rows that there is room for, and */
  PetscInt       square; /* rows that the matrix has */
  PetscScalar   *matrix; /* S, where it is one */
  /* of the last sweep: the change of forces [N], and what rows open by for it, by S and by the bodies [m] */
  PetscScalar *change, *told, *answer;
} FrictionProblem;

PETSC_INTERN PetscErrorCode FrictionProblemResize(FrictionProblem *, PetscInt, PetscInt, const FrictionProducts *);
PETSC_INTERN PetscErrorCode FrictionProblemDestroy(FrictionProblem *);
PETSC_INTERN PetscErrorCode FrictionProblemKeepForces(FrictionProblem *, PetscReal, PetscBool *);
PETSC_INTERN PetscErrorCode FrictionProblemMultiply(const FrictionProblem *, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscReal      FrictionProblemGetResidual(const FrictionProblem *, const PetscScalar[]);
PETSC_INTERN PetscErrorCode FrictionProblemIsAmbiguous(FrictionProblem *, PetscBool *);

/* What row i opens by under a unit force on row j of the same node. Where S is no matrix it is known on its diagonal alone. */
static inline PetscReal FrictionCompliance(const FrictionProblem *problem, PetscInt i, PetscInt j)
{
  if (problem->S) return PetscRealPart(problem->S[j * problem->n + i]);
  return i == j ? PetscRealPart(problem->diagonal[i]) : 0;
}

typedef struct _n_FrictionSolver *FrictionSolver;

PETSC_INTERN PetscErrorCode FrictionSolverCreate(FrictionSolver *);
PETSC_INTERN PetscErrorCode FrictionSolverSolve(FrictionSolver, const FrictionProblem *, PetscBool *, PetscBool *);
PETSC_INTERN PetscInt       FrictionSolverGetIterations(FrictionSolver);
PETSC_INTERN PetscErrorCode FrictionSolverDestroy(FrictionSolver *);
PETSC_INTERN void           FrictionLearn(FrictionProblem *);
PETSC_INTERN PetscErrorCode FrictionSolveNode(PetscInt, const PetscReal[], const PetscReal[], const PetscReal[], PetscReal[]);

PETSC_INTERN PetscErrorCode ContactLawCreate_Coulomb(Contact, ContactFrictionLaw *);
PETSC_INTERN PetscErrorCode ContactComputeSlips(Contact);
