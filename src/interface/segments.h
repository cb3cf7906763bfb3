/* Parts of Dirichlet faces that lie opposite to faces of the Neumann side. Private to src/interface. */
#pragma once
#include "interfaceimpl.h"

typedef struct {
  PetscInt  face, partner; /* Dirichlet face, and number of the other one among those received */
  PetscInt  n;             /* corners of the part they share, in the plane of the Dirichlet face */
  PetscReal polygon[8][2];
  PetscReal partner_corners[4][2]; /* of the whole partner, projected on that plane */
  PetscReal gap;                   /* at the centroid [m] */
  PetscBool hidden, steep;
} Segment;

typedef struct {
  PetscInt   n, max, face_nodes; /* face_nodes: of the Neumann side */
  PetscInt64 candidates;
  PetscReal  ahead, behind;
  PetscBool  guards; /* nodes beyond the end of the partner get their mark */
  Segment   *list;   /* those of one Dirichlet face follow each other */
} Segments;

PETSC_INTERN PetscErrorCode SegmentsFind(const SurfaceData *, PetscInt, const Face[], PetscInt[], Segments *);
