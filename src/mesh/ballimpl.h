/* What the files that make a ball share. Private to src/mesh. */
#pragma once
#include "meshimpl.h"

typedef struct {
  PetscInt  dim, divisions, layers; /* of the grid of nodes */
  PetscInt  step;   /* cells of this grid along an edge of an element: 2 where elements have nodes in the middle of their edges */
  PetscInt  n_cuts; /* planes that cut it: x = centre, then y = centre */
  PetscReal radius, centre[3], pole[3], grading;
  PetscReal length;   /* of a rod that the disc is drawn out to, along z */
  PetscInt  sections; /* cells of its grid along it; 0: it is no rod */
  PetscBool simplex, keep_volume;
  PetscBool turned; /* half a disc that becomes a ball as it is turned about x = 0 */
} Ball;

/* The names of options that balls and rods have in common */
typedef struct {
  const char *radius, *divisions, *layers, *part, *keep_volume;
} BallOptions;

/* The central block, or the block of layers on one side of it: along the axis of that side places count layers */
typedef struct {
  PetscInt axis; /* -1: the central block */
  PetscInt side; /* 0: lower, 1: upper */
} BallBlock;

/* Numbers of the nodes: the central block along its axes; then each layer around it, with a node for each on the block's rim */
typedef struct {
  MeshFile   *file;
  const Ball *ball;
  PetscInt    n[3], stride[3]; /* elements along the axes of the central block */
  PetscInt    n_core, n_rim;   /* nodes of the central block, and of its rim */
  PetscInt    n_section;       /* nodes of a disc, from one section of a rod to the next */
  PetscInt   *rim;             /* per node of the central block: its number on the rim, -1 inside */
  PetscInt    n_blocks;
  BallBlock   blocks[7]; /* the central one first */
  PetscReal   missing;   /* part of the ball's volume that the mesh lacks */
} BallGrid;

PETSC_INTERN PetscErrorCode BallCreate(MPI_Comm, Ball *, const char[], PetscMPIInt, DM *, MeshMiddles *, PetscReal *);
PETSC_INTERN PetscErrorCode MeshFillBall(void *);
PETSC_INTERN PetscErrorCode BallAddRange(const BallGrid *, const BallBlock *, PetscInt, const PetscInt[], const PetscInt[3],
                                         const PetscInt[3]);
PETSC_INTERN PetscErrorCode BallReadLength(MPI_Comm, const char[], const char[], PetscReal *);
PETSC_INTERN PetscErrorCode BallReadCount(MPI_Comm, const char[], const char[], PetscInt *);
PETSC_INTERN PetscErrorCode BallReadSection(MPI_Comm, const char[], const BallOptions *, Ball *);
PETSC_INTERN PetscErrorCode BallSetNodes(BallGrid *);
PETSC_INTERN PetscInt       BallGetNode(const BallGrid *, const BallBlock *, const PetscInt[3]);
PETSC_INTERN PetscBool      BallBlockIsMirrored(const BallBlock *);
PETSC_INTERN PetscInt       BallFirstCorner(const Ball *, const BallBlock *, PetscInt, const PetscInt[], const PetscInt[3]);
PETSC_INTERN PetscBool      BallCellIsConvex(const BallGrid *, const BallBlock *, const PetscInt[], const PetscReal *[]);
PETSC_INTERN PetscErrorCode BallKeepVolume(BallGrid *);
