/* What enhanced elements compute one at a time: enhancedbalance.c, for the operations of enhanced.c */
#pragma once
#include <impakt/private/solid.h>

enum { MODES = 3, MAX_MODES = 9, MAX_SHAPES = SOLID_MAX_NODES + MODES, MAX_UNKNOWNS = MAX_SHAPES * 3 };

/* One element: its points are the members of a batch for the material */
typedef struct {
  PetscInt  element, n_points, dim, shapes, fixed, n_modes; /* shapes: nodes and modes; fixed: numbers of the nodes */
  PetscReal weight[SOLID_MAX_POINTS];
  PetscReal gradient[SOLID_MAX_POINTS][MAX_SHAPES * 3];
  PetscReal values[MAX_UNKNOWNS]; /* displacements of the nodes, then alpha */
  SimdReal  H[9], P[9];
  SimdReal  start[SOLID_MAX_HISTORY], end[SOLID_MAX_HISTORY]; /* history of the points, of materials that have one */
} Enhanced;

PETSC_INTERN PetscInt       EnhancedAmplitudesPerPoint(PetscInt, PetscInt);
PETSC_INTERN void           EnhancedPrepare(Element, PetscInt, const PetscScalar[], Enhanced *);
PETSC_INTERN void           EnhancedGetGradients(Enhanced *);
PETSC_INTERN void           EnhancedGetMatrix(const Solid *, const Enhanced *, PetscBool, PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode EnhancedSolve(PetscInt, PetscInt, PetscReal[], PetscReal[]);
PETSC_INTERN PetscErrorCode EnhancedBalance(const Solid *, Enhanced *, PetscReal[]);
