/* The conditions that moments of a body's mass are kept, and their solution: see massmoments.c. Private to src/body/system. */
#pragma once
#include <body/layout/bodyimpl.h>

/* The factor stays above this, since lighter nodes would need shorter explicit steps */
#define LEAST_FACTOR 0.3
/* As many as a quadratic polynomial in three dimensions has coefficients; two dimensions need 7 conditions at most */
#define MAX_MOMENTS 10

typedef struct {
  Body       body;
  PetscBool  alone;                               /* this rank has all of the mass, and what is computed is its own */
  PetscInt   n_moments;                           /* moments: phi_a' M phi_b for a <= b */
  PetscInt   pair[MAX_MOMENTS][2];                /* a and b of a moment */
  PetscReal  axes[3][3];                          /* of the fields of first order, axis . (x - centre) / size */
  PetscReal  centre[3], size[3];                  /* [m] */
  PetscReal  target[MAX_MOMENTS];                 /* of the full mass, over the total mass */
  PetscReal  total;                               /* the full mass [kg] */
  PetscInt   n;                                   /* conditions */
  PetscReal  condition[MAX_MOMENTS][MAX_MOMENTS]; /* weights of the moments in each condition */
  PetscReal  softness[MAX_MOMENTS];
  PetscReal  most;    /* 1 + p stays below this */
  PetscReal  scale;   /* the whole mass over what the massless layer has left */
  PetscReal *weights; /* per local node, ghosts too: what mass of this rank's elements at it adds to each moment, over the total */
} MomentsProblem;

PETSC_INTERN void           MomentsGetFields(const MomentsProblem *, PetscInt, PetscReal[4]);
PETSC_INTERN void           MomentsGetPolynomials(const MomentsProblem *, PetscInt, PetscReal[MAX_MOMENTS]);
PETSC_INTERN PetscReal      MomentsGetPolynomial(const MomentsProblem *, const PetscReal[], const PetscReal[]);
PETSC_INTERN PetscErrorCode MomentsCompute(const MomentsProblem *, const PetscReal[], PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode MomentsSolve(MomentsProblem *, PetscReal[], PetscBool *);
