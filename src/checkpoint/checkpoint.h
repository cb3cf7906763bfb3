/* The state of a run as one stream of named records for each rank: what a checkpoint file is filled with, and what a run that is continued
   is filled from. Each class lists its state once, in a function XVisit(X, Checkpoint), which serves both directions: a visit writes the
   value to the stream or, while a checkpoint is loaded, overwrites it. */
#pragma once
#include <impakt/private/trace.h>
#include <petscmat.h>

typedef struct _n_Checkpoint *Checkpoint;

PETSC_INTERN PetscErrorCode CheckpointCreate(MPI_Comm, Checkpoint *);
PETSC_INTERN PetscErrorCode CheckpointCreateFromBytes(MPI_Comm, size_t, void *, Checkpoint *);
PETSC_INTERN PetscErrorCode CheckpointGetBytes(Checkpoint, size_t *, const void *[]);
PETSC_INTERN PetscErrorCode CheckpointFinish(Checkpoint);
PETSC_INTERN PetscErrorCode CheckpointDestroy(Checkpoint *);
PETSC_INTERN PetscBool      CheckpointLoads(Checkpoint);
PETSC_INTERN PetscErrorCode CheckpointBegin(Checkpoint, const char[]);
PETSC_INTERN PetscErrorCode CheckpointVisitReals(Checkpoint, const char[], PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode CheckpointVisitInts(Checkpoint, const char[], PetscInt, PetscInt[]);
PETSC_INTERN PetscErrorCode CheckpointVisitInt64s(Checkpoint, const char[], PetscInt, PetscInt64[]);
PETSC_INTERN PetscErrorCode CheckpointVisitBools(Checkpoint, const char[], PetscInt, PetscBool[]);
PETSC_INTERN PetscErrorCode CheckpointVisitBytes(Checkpoint, const char[], size_t, void *);
PETSC_INTERN PetscErrorCode CheckpointVisitVec(Checkpoint, const char[], Vec);
PETSC_INTERN PetscErrorCode CheckpointVisitTrace(Checkpoint, const char[], Trace);
PETSC_INTERN PetscErrorCode CheckpointVisitMat(Checkpoint, const char[], Mat *);
PETSC_INTERN PetscErrorCode CheckpointCheckInts(Checkpoint, const char[], PetscInt, const PetscInt[]);
