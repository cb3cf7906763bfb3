/* The HDF5 history of a run. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/controller.h>

typedef struct _n_History *History;

PETSC_INTERN PetscErrorCode      HistoryCreate(Controller, const char[], History *);
PETSC_INTERN ControllerMonitorFn HistoryMonitor;
PETSC_INTERN PetscErrorCode      HistoryFlush(History);
PETSC_INTERN PetscErrorCode      HistoryDestroy(History *);
PETSC_INTERN PetscErrorCode      HistorySync(History);
PETSC_INTERN PetscErrorCode      HistoryVisit(History, Checkpoint);
PETSC_INTERN PetscErrorCode      HistoryTakeUp(History);
