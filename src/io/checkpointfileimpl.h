/* What reading and writing the file of a checkpoint share. */
#pragma once
#include "checkpointfile.h"
#include "hdf5file.h"
#include <sys/bytesum.h>

#define CHECKPOINT_FORMAT 16 /* of what a checkpoint has in it; to be raised with each change that older programs cannot read */
/* Bytes that are sent, written or summed at a time; a multiple of 8 */
#define CHECKPOINT_BLOCK ((size_t)1 << 26)

/* What stands behind the HDF5 file */
typedef struct {
  char     magic[8];
  uint64_t size, sum;
} CheckpointTrailer;

#define CHECKPOINT_MAGIC "impaktC1"

PETSC_INTERN PetscErrorCode CheckpointSendBytes(MPI_Comm, PetscMPIInt, size_t, const void *);
PETSC_INTERN PetscErrorCode CheckpointReceiveBytes(MPI_Comm, PetscMPIInt, size_t *, char **);
