/* Locks on outputs, which keep a second run away while this one lives. Private to src/io. */
#pragma once
#include <petscsys.h>

#define OUTPUT_LOCKS 4

typedef struct {
  int  n;
  int  file[OUTPUT_LOCKS];
  char path[OUTPUT_LOCKS][PETSC_MAX_PATH_LEN]; /* of the files that are locked */
} OutputLocks;

PETSC_INTERN PetscErrorCode OutputLocksRelease(OutputLocks *);
