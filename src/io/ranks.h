/* How the work of a run lies on the ranks. */
#pragma once
#include <impakt/controller.h>

/* What is counted on each rank */
typedef enum {
  RANKS_ELEMENTS,
  RANKS_NODES, /* ghosts too */
  RANKS_HALO,  /* ghosts alone: nodes that other ranks own */
  RANKS_FACETS,
  RANKS_ROWS,
  RANKS_NEIGHBOURS,  /* other ranks with which it shares nodes of any body */
  RANKS_PEAK_MEMORY, /* [B] */
  RANKS_BASE_MEMORY, /* of it what the process had before there were bodies [B] */
  RANKS_WORK,        /* of a controller step, in units of the work for an element */
  RANKS_COUNTS
} RanksCount;

extern const char *const RanksNames[RANKS_COUNTS];

typedef struct {
  PetscMPIInt size;
  PetscReal   largest[RANKS_COUNTS], mean[RANKS_COUNTS];
} RanksSummary; /* the largest work is that for the most elements, faces and rows, since a step waits for each of them */

PETSC_INTERN PetscErrorCode RanksGather(Controller, RanksSummary *);
PETSC_INTERN PetscErrorCode RanksView(const RanksSummary *, PetscViewer);
