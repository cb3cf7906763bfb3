/* Parts of Dirichlet faces that lie opposite to faces of the Neumann side. Private to src/interface. */
#pragma once
#include "interfaceimpl.h"

/* A Dirichlet face, and what does not depend on the face that it is compared with */
typedef struct {
  PetscInt           face, n; /* nodes of a face */
  const SurfaceData *data;
  Frame              frame;
  PetscReal          corners[4][2], area, size;
} Target;

typedef struct {
  PetscInt  face, partner;         /* the Dirichlet face, and the number of the partner's face among those that this rank has received */
  PetscInt  n;                     /* corners of the part that they have in common */
  PetscReal polygon[8][2];         /* these corners, in the plane of the Dirichlet face [m] */
  PetscReal partner_corners[4][2]; /* corners of the whole face of the partner, projected on that plane [m] */
  PetscReal gap;                   /* at the centroid [m] */
  PetscBool hidden;                /* another partner lies between the two */
  PetscBool steep;                 /* the partner is far from parallel to the face */
} Segment;

typedef struct {
  PetscInt  n, max;        /* number of segments, and how many there is room for */
  PetscInt  face_nodes;    /* nodes of a face of the Neumann side */
  PetscReal ahead, behind; /* how far before and behind a face its partner may be [m] */
  PetscBool guards;        /* whether nodes just beyond the end of the partner are marked */
  Segment  *list;          /* segments of one Dirichlet face follow each other */
} Segments;

PETSC_INTERN void           TargetSetUp(const SurfaceData *, PetscInt, Target *);
PETSC_INTERN PetscReal      TargetGap(const Target *, const PetscReal[], const Face *, PetscInt, const PetscReal[][2], const PetscReal[]);
PETSC_INTERN PetscErrorCode SegmentsFind(Surface, PetscInt, const Face[], PetscInt[], Segments *);
