/* Checkpoints: the file, whose length and sum guard what HDF5 reads (first byte even), and the stream of records in it (odd) */
#include "fuzz.h"
#include <checkpoint/checkpoint.h>
#include <io/checkpointfile.h>

static void ReadFile(const uint8_t data[], size_t size)
{
  char           path[64];
  CheckpointFile file;
  Checkpoint     checkpoint = NULL;

  FuzzWrite(data, size, ".h5", path, sizeof(path));
  if (!CheckpointFileOpen(PETSC_COMM_SELF, "-restart", path, &file)) {
    FUZZ_IGNORE(CheckpointFileRead(PETSC_COMM_SELF, &file, &checkpoint));
    FUZZ_IGNORE(CheckpointFileClose(&file));
  }
  FUZZ_IGNORE(CheckpointDestroy(&checkpoint));
  (void)unlink(path);
}

/* The records of tests/fuzz/seeds.py */
static PetscErrorCode VisitAll(Checkpoint checkpoint)
{
  PetscReal  reals[3];
  PetscInt   ints[2];
  PetscInt64 long_ints[1];
  PetscBool  bools[3];
  char       bytes[5];
  Mat        matrix;

  PetscFunctionBegin;
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, 2, 3, 3, NULL, &matrix));
  PetscCall(MatSetUp(matrix));
  PetscCall(CheckpointBegin(checkpoint, "body"));
  PetscCall(CheckpointVisitReals(checkpoint, "reals", 3, reals));
  PetscCall(CheckpointVisitInts(checkpoint, "ints", 2, ints));
  PetscCall(CheckpointVisitInt64s(checkpoint, "long", 1, long_ints));
  PetscCall(CheckpointVisitBools(checkpoint, "bools", 3, bools));
  PetscCall(CheckpointVisitBytes(checkpoint, "bytes", 5, bytes));
  PetscCall(CheckpointCheckInts(checkpoint, "sizes", 2, ints));
  PetscCall(CheckpointVisitMat(checkpoint, "matrix", &matrix));
  PetscCall(MatDestroy(&matrix));
  PetscCall(CheckpointFinish(checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int LLVMFuzzerTestOneInput(const uint8_t data[], size_t size)
{
  Checkpoint checkpoint;
  void      *bytes;

  if (!size) return 0;
  if (data[0] % 2 == 0) {
    ReadFile(data + 1, size - 1);
    return 0;
  }
  if (PetscMalloc(size, &bytes)) abort();
  memcpy(bytes, data + 1, size - 1);
  if (CheckpointCreateFromBytes(PETSC_COMM_SELF, size - 1, bytes, &checkpoint)) abort();
  FUZZ_IGNORE(VisitAll(checkpoint));
  FUZZ_IGNORE(CheckpointDestroy(&checkpoint));
  return 0;
}
