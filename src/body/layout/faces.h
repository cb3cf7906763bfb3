/* Faces of elements on a surface, and the points with which densities are integrated over them. Private to src/body. */
#pragma once
#include <body/layout/bodyimpl.h>
#include <impakt/expression.h>

#define FACE_MAX_NODES  4
#define FACE_MAX_POINTS 4

/* Faces of this rank on a surface, in the reference configuration */
typedef struct {
  PetscInt   count, nodes, n_points; /* of the rank; of one face */
  PetscInt  *connectivity;           /* count x nodes: local node numbers */
  PetscReal *side;                   /* 1, or -1 where the order of the nodes gives the inward normal */
} BodyFaces;

PETSC_INTERN PetscErrorCode BodyFacesCreate(Body, const char[], BodyFaces *);
PETSC_INTERN PetscErrorCode BodyFacesGetPoints(Body, const BodyFaces *, PetscInt, ExpressionPoint[], PetscReal[]);
PETSC_INTERN PetscErrorCode BodyFacesDestroy(BodyFaces *);
