/* Signals that end a run in good order, or ask it for a checkpoint. Private to src/io. */
#pragma once
#include <petscsys.h>

typedef struct {
  int       stop;       /* the signal that ends the run; 0: none has come */
  PetscBool checkpoint; /* one has been asked for */
} StopSignals;

PETSC_INTERN void        StopSignalsBegin(PetscMPIInt, PetscMPIInt);
PETSC_INTERN void        StopSignalsCatch(PetscBool);
PETSC_INTERN void        StopSignalsRelease(void);
PETSC_INTERN void        StopSignalsTake(StopSignals *);
PETSC_INTERN const char *StopSignalName(int, PetscBool);
