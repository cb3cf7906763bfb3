/* How the work of a run lies on the ranks. */
#pragma once
#include <impakt/controller.h>

/* What is counted on each rank */
typedef enum {
  RANKS_ELEMENTS,
  RANKS_NODES, /* ghosts too */
  RANKS_FACETS,
  RANKS_ROWS,
  RANKS_NEIGHBOURS,  /* other ranks with which it shares nodes of any body */
  RANKS_PEAK_MEMORY, /* [B] */
  RANKS_COUNTS
} RanksCount;

extern const char *const RanksNames[RANKS_COUNTS];

typedef struct {
  PetscMPIInt size;
  PetscReal   largest[RANKS_COUNTS], mean[RANKS_COUNTS];
} RanksSummary;

PETSC_INTERN PetscErrorCode RanksGather(Controller, RanksSummary *);
