/* Points and edges that are looked for among the faces of other surfaces, whichever ranks have these. Private to src/interface. */
#pragma once
#include "interfaceimpl.h"

/* A point, or an edge with both of its ends, of the first surface of a pair; and what is known of it */
typedef struct {
  PetscInt    pair;
  PetscMPIInt rank;   /* that asks */
  PetscInt    source; /* its number there */
  PetscReal   x[2][3];
  PetscReal   size;    /* edge of the smallest face there [m or 1] */
  PetscReal   at;      /* where an edge crosses a face of the second surface: from 0 at one end to 1 at the other */
  Closest     closest; /* face of the second surface to a point */
} Probe;

typedef struct {
  PetscInt     n, max;
  Probe       *list;
  PetscMPIInt *to; /* rank that is asked, or gets the answer */
} Probes;

typedef struct {
  MPI_Comm       comm;
  PetscMPIInt    rank, n_ranks;
  PetscInt       n, n_pairs;
  const Surface *surfaces;
  SurfaceDepth  *pairs;
  PetscReal     *boxes, *whole; /* of each surface on each rank, and on all: lower corner, then the upper one with its sign changed [m] */
  Tree          *trees;         /* of the faces of each surface that this rank has; made when they are asked for */
  Face         **faces;
} ProbeSearch;

PETSC_INTERN PetscErrorCode ProbesAdd(Probes *, const Probe *, PetscMPIInt);
PETSC_INTERN PetscErrorCode ProbesDestroy(Probes *);
PETSC_INTERN PetscErrorCode ProbesFindCrossings(ProbeSearch *, const Probes *, PetscInt *, Probe *[]);
PETSC_INTERN PetscErrorCode ProbesFindClosest(ProbeSearch *, Probes *);
