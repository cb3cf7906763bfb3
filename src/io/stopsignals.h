/* Signals that end a run in good order, or ask it for a checkpoint. Private to src/io. */
#pragma once
#include <petscsys.h>

typedef struct {
  PetscBool   stop, checkpoint; /* what has been asked for */
  const char *name;             /* of the signal that ends the run */
} StopSignals;

PETSC_INTERN void StopSignalsBegin(PetscMPIInt);
PETSC_INTERN void StopSignalsCatch(void);
PETSC_INTERN void StopSignalsRelease(void);
PETSC_INTERN void StopSignalsTake(StopSignals *);
