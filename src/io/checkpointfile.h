/* The file of a checkpoint. Private to src/io. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <checkpoint/tables.h>
#include <impakt/body.h>

typedef struct {
  PetscInt  step; /* controller steps that have been made */
  PetscReal time; /* at their end [s] */
  int       ranks;
  char     *options; /* of the run, as PetscOptionsGetAll() gives them; from CheckpointFileOpen(), to be freed */
} CheckpointInfo;

typedef struct {
  Checkpoint  shared, state; /* of all ranks alike, that of the first is written; of each rank */
  Tables      tables;
  PetscInt    n_bodies;
  const Body *bodies; /* borrowed */
} CheckpointContents;

/* A checkpoint that is being read, on rank 0 */
typedef struct {
  CheckpointInfo info;
  PetscInt64     file;   /* HDF5's handle; -1 on other ranks */
  const char    *option; /* that names it */
  char           path[PETSC_MAX_PATH_LEN];
} CheckpointFile;

PETSC_INTERN PetscErrorCode CheckpointFileGetPrevious(const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode CheckpointFileWrite(MPI_Comm, const char[], const CheckpointInfo *, const CheckpointContents *);
PETSC_INTERN PetscErrorCode CheckpointFileFind(MPI_Comm, const char[], size_t, char[], PetscBool *);
PETSC_INTERN PetscErrorCode CheckpointFileOpen(MPI_Comm, const char[], const char[], CheckpointFile *);
PETSC_INTERN PetscErrorCode CheckpointFileRead(MPI_Comm, const CheckpointFile *, Checkpoint *);
PETSC_INTERN PetscErrorCode CheckpointFileReadShared(MPI_Comm, const CheckpointFile *, Checkpoint *);
PETSC_INTERN PetscErrorCode CheckpointFileReadTables(MPI_Comm, const CheckpointFile *, Tables *);
PETSC_INTERN PetscErrorCode CheckpointFileClose(CheckpointFile *);
