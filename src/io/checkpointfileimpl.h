/* What reading and writing the file of a checkpoint share. */
#pragma once
#include "checkpointfile.h"
#include "hdf5file.h"
#include <stdint.h>
#include <string.h>

#define CHECKPOINT_FORMAT 13 /* of what a checkpoint has in it; to be raised with each change that older programs cannot read */
/* Bytes that are sent, written or summed at a time; a multiple of 8 */
#define CHECKPOINT_BLOCK ((size_t)1 << 26)

/* What stands behind the HDF5 file */
typedef struct {
  char     magic[8];
  uint64_t size, sum;
} CheckpointTrailer;

#define CHECKPOINT_MAGIC     "impaktC1"
#define CHECKPOINT_SUM_BEGIN 0xcbf29ce484222325u

/* FNV-1a over words of 8 bytes; the last one is filled up with zeros */
static inline uint64_t CheckpointSum(uint64_t sum, size_t size, const char bytes[])
{
  for (size_t i = 0; i < size; i += 8) {
    uint64_t word = 0;

    memcpy(&word, bytes + i, size - i < 8 ? size - i : 8);
    sum = (sum ^ word) * 0x100000001b3u;
  }
  return sum;
}

PETSC_INTERN PetscErrorCode CheckpointSendBytes(MPI_Comm, PetscMPIInt, size_t, const void *);
PETSC_INTERN PetscErrorCode CheckpointReceiveBytes(MPI_Comm, PetscMPIInt, size_t *, char **);
