/* The interface compliance of a body: displacements of its rows under forces on them. Private to the files of this folder that find it. */
#pragma once
#include <body/layout/bodyimpl.h>

#define NODAL_BY_STEPS (-1) /* columns by controller steps */

typedef struct _NodalMatrix *NodalMatrix;

struct _BodyCompliance {
  Compliance     nodal;        /* of displacements, not rows, at the end of the controller step, see BodyGetNodalCompliance(); or NULL */
  BodyForceShape nodal_shape;  /* the forces that it is for */
  PetscReal      nodal_step;   /* the substep that it is of [s] */
  PetscReal      nodal_time;   /* where it is that of a state: when the step begins [s] */
  NodalMatrix    nodal_matrix; /* that tells it, see nodalmatrix.c; NULL: controller steps do */
  PetscInt       nodal_kind;   /* which kind of it has told what is known, see nodalmatrix.c */
  Vec            diagonal;     /* see BodyGetNodalDiagonal(); or NULL */
};

PETSC_INTERN PetscErrorCode NodalMatrixRenew(Body, BodyForceShape, PetscInt, PetscInt, const PetscInt[], PetscInt *, NodalMatrix *,
                                             PetscBool *);
PETSC_INTERN PetscErrorCode NodalMatrixProbe(Body, const NodalMatrix, BodyForceShape, PetscInt, const PetscInt[], Compliance);
PETSC_INTERN PetscErrorCode FrontCreateMatrix(Body, Mat *);
PETSC_INTERN PetscErrorCode FrontProbe(Body, Mat, BodyForceShape, PetscInt, const PetscInt[], Compliance);
PETSC_INTERN PetscErrorCode BodyCreateSlabFunctions(Body, Mat, PetscInt, const PetscInt[], PetscInt, Mat *);
PETSC_INTERN const char    *NodalMatrixDescribe(const NodalMatrix);
PETSC_INTERN PetscErrorCode NodalMatrixDestroy(NodalMatrix *);
