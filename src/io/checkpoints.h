/* When a run writes checkpoints and when it ends early; what it is continued from. Private to src/io. */
#pragma once
#include "checkpointfile.h"

typedef struct {
  /* options */
  char      path[PETSC_MAX_PATH_LEN];    /* empty: no checkpoints are written */
  PetscInt  interval;                    /* controller steps from one to the next; 0: by time alone */
  PetscReal wall_interval;               /* the same by the clock [s]; 0: by steps alone */
  PetscReal max_wall_time;               /* after which the run ends [s]; 0: never */
  char      restart[PETSC_MAX_PATH_LEN]; /* what the run goes on from; empty: nothing */
  char      state[PETSC_MAX_PATH_LEN];   /* what the bodies begin with; empty: their own */
  PetscBool allow_changes;
  PetscBool catches; /* signals */
  /* the run */
  PetscInt       last_step;      /* of the last checkpoint written or loaded; -1: none */
  PetscLogDouble begin, written; /* when the run began, and wrote the last checkpoint [s] */
  /* when ranks agree */
  PetscInt       next_look, look_every; /* in controller steps */
  PetscLogDouble looked;                /* [s] */
  PetscBool      stopped;
} Checkpoints;
