/* The file of a checkpoint: HDF5 with the stream of each rank, to continue on as many ranks bit for bit, and, to begin a run on any number
   of ranks, the nodes of each body with their state. Behind the HDF5 file stand its length and a sum over all its bytes, so that a file
   which is not whole, or was changed, is found out before HDF5 looks into it.

   The first rank makes the file in memory, writes it beside the last one, has it written through to the disk, and renames it. The
   checkpoint before stays as <path>.prev.h5: at every moment there is one that is whole. */
#define _POSIX_C_SOURCE 200809L
#include "checkpointfileimpl.h"
#include "outputfile.h"
#include "outputpaths.h"
#include <errno.h>
#include <fcntl.h>
#include <impakt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Bytes that a file in memory grows by at a time */
#define GROWTH ((size_t)1 << 20)

/* CheckpointFileGetPrevious - where the checkpoint before the last one is: c.prev.h5 of c.h5; Not Collective */
PetscErrorCode CheckpointFileGetPrevious(const char path[], size_t size, char previous[])
{
  const char  *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
  const size_t stem = dot && (!slash || dot > slash + 1) && dot > path ? (size_t)(dot - path) : strlen(path);

  PetscFunctionBegin;
  PetscCheck(strlen(path) + sizeof(".prev") <= size, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "The path '%s' is too long", path);
  PetscCall(PetscSNPrintf(previous, size, "%.*s.prev%s", (int)stem, path, path + stem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteDataset(hid_t file, const char name[], hid_t type, int rank, const hsize_t size[], const void *values,
                                   const char path[])
{
  hid_t dataset;

  PetscFunctionBegin;
  PetscCall(HDF5CreateDataset(file, name, type, rank, size, NULL, H5P_DEFAULT, path, &dataset));
  if (size[0]) PetscCall(HDF5Check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write a dataset", path));
  PetscCall(HDF5Check(H5Dclose(dataset), "write a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNumber(hid_t file, const char name[], hid_t type, const void *value, const char path[])
{
  const hid_t space = H5Screate(H5S_SCALAR), attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);

  PetscFunctionBegin;
  PetscCall(HDF5Check(attribute, "create an attribute", path));
  PetscCall(HDF5Check(H5Awrite(attribute, type, value), "write an attribute", path));
  PetscCall(HDF5Check(H5Aclose(attribute), "write an attribute", path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A stream to another rank, in blocks */
PetscErrorCode CheckpointSendBytes(MPI_Comm comm, PetscMPIInt to, size_t size, const void *bytes)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Send(&size, sizeof(size), MPI_BYTE, to, 0, comm));
  for (size_t at = 0; at < size; at += CHECKPOINT_BLOCK)
    PetscCallMPI(MPI_Send((const char *)bytes + at, (PetscMPIInt)PetscMin(CHECKPOINT_BLOCK, size - at), MPI_BYTE, to, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same at the other end; bytes to be freed */
PetscErrorCode CheckpointReceiveBytes(MPI_Comm comm, PetscMPIInt from, size_t *size, char **bytes)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Recv(size, sizeof(*size), MPI_BYTE, from, 0, comm, MPI_STATUS_IGNORE));
  PetscCall(PetscMalloc1(*size, bytes));
  for (size_t at = 0; at < *size; at += CHECKPOINT_BLOCK)
    PetscCallMPI(MPI_Recv(*bytes + at, (PetscMPIInt)PetscMin(CHECKPOINT_BLOCK, *size - at), MPI_BYTE, from, 0, comm, MPI_STATUS_IGNORE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The streams of all ranks, one dataset each: the first rank gets them one after the other */
static PetscErrorCode WriteStreams(MPI_Comm comm, hid_t file, Checkpoint checkpoint, const char path[])
{
  PetscMPIInt rank, ranks;
  const void *mine;
  size_t      size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(CheckpointGetBytes(checkpoint, &size, &mine));
  if (rank) {
    PetscCall(CheckpointSendBytes(comm, 0, size, mine));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscMPIInt r = 0; r < ranks; r++) {
    hsize_t length[1];
    char    name[32], *bytes = NULL;

    if (r) PetscCall(CheckpointReceiveBytes(comm, r, &size, &bytes));
    length[0] = size;
    PetscCall(PetscSNPrintf(name, sizeof(name), "state/%d", (int)r));
    PetscCall(WriteDataset(file, name, H5T_NATIVE_UCHAR, 1, length, r ? bytes : mine, path));
    PetscCall(PetscFree(bytes));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A vector of a body, nodes by dimensions, on the first rank */
static PetscErrorCode WriteVec(hid_t file, const char body[], const char name[], PetscInt dim, Vec vec, const char path[])
{
  const PetscScalar *values;
  hsize_t            size[2];
  PetscInt           n;
  char               full[PETSC_MAX_PATH_LEN];
  VecScatter         scatter;
  Vec                all;

  PetscFunctionBegin;
  PetscCall(VecScatterCreateToZero(vec, &scatter, &all));
  PetscCall(VecScatterBegin(scatter, vec, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, vec, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(VecGetLocalSize(all, &n));
  PetscCall(VecGetArrayRead(all, &values));
  size[0] = (hsize_t)(n / dim);
  size[1] = (hsize_t)dim;
  PetscCall(PetscSNPrintf(full, sizeof(full), "bodies/%s/%s", body, name));
  if (file >= 0) PetscCall(WriteDataset(file, full, H5T_NATIVE_DOUBLE, 2, size, values, path));
  PetscCall(VecRestoreArrayRead(all, &values));
  PetscCall(VecDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteBodies(hid_t file, PetscInt n, const Body bodies[], const char path[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < n; b++) {
    const char *name;
    PetscInt    dim;
    PetscBool   without_inertia;
    Vec         positions, u, v, a;

    PetscCall(PetscObjectGetName((PetscObject)bodies[b], &name));
    PetscCall(BodyGetDimension(bodies[b], &dim));
    PetscCall(BodyGetReferencePositions(bodies[b], &positions));
    PetscCall(BodyGetSolution(bodies[b], &u, &v, &a));
    PetscCall(WriteVec(file, name, "position", dim, positions, path));
    PetscCall(WriteVec(file, name, "displacement", dim, u, path));
    PetscCall(BodyIsStatic(bodies[b], &without_inertia));
    if (without_inertia) continue;
    PetscCall(WriteVec(file, name, "velocity", dim, v, path));
    PetscCall(WriteVec(file, name, "acceleration", dim, a, path));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateInMemory(const char path[], const CheckpointInfo *info, hid_t *file)
{
  const int       format = CHECKPOINT_FORMAT, integer = (int)sizeof(PetscInt);
  const long long step = info->step;
  hid_t           access;

  PetscFunctionBegin;
  access = H5Pcreate(H5P_FILE_ACCESS);
  PetscCall(HDF5Check(H5Pset_fapl_core(access, GROWTH, 0), "make room", path));
  *file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  PetscCall(HDF5Check(*file, "make a file in memory", path));
  PetscCall(HDF5Check(H5Pclose(access), "close a property list", path));
  PetscCall(WriteNumber(*file, "checkpoint", H5T_NATIVE_INT, &format, path));
  PetscCall(HDF5WriteText(*file, "version", IMPAKT_VERSION, PETSC_FALSE, path));
  PetscCall(HDF5WriteText(*file, "options", info->options, PETSC_FALSE, path));
  PetscCall(WriteNumber(*file, "step", H5T_NATIVE_LLONG, &step, path));
  PetscCall(WriteNumber(*file, "time", H5T_NATIVE_DOUBLE, &info->time, path));
  PetscCall(WriteNumber(*file, "ranks", H5T_NATIVE_INT, &info->ranks, path));
  PetscCall(WriteNumber(*file, "bytes_of_integers", H5T_NATIVE_INT, &integer, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All bytes to a file, and through to the disk; returns errno, or 0 */
static int WriteBytes(const char path[], size_t size, const char bytes[], const CheckpointTrailer *trailer)
{
  const char  *parts[2] = {bytes, (const char *)trailer};
  const size_t sizes[2] = {size, sizeof(*trailer)};
  int          file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), error = 0;

  if (file < 0) return errno;
  for (int k = 0; k < 2 && !error; k++)
    for (size_t done = 0; done < sizes[k] && !error;) {
      const ssize_t now = write(file, parts[k] + done, PetscMin(CHECKPOINT_BLOCK, sizes[k] - done));

      if (now < 0 && errno != EINTR) error = errno;
      if (now > 0) done += (size_t)now;
    }
  if (!error && fsync(file) && errno != EINVAL) error = errno;
  if (close(file) && !error) error = errno;
  if (error) (void)remove(path);
  return error;
}

/* The last checkpoint becomes the one before, and the new one the last. Where the file system has links there is no moment without a last
   one; else there is one in which that before is the only one. */
static int Rotate(const char part[], const char path[], const char previous[])
{
  char spare[PETSC_MAX_PATH_LEN];

  if (snprintf(spare, sizeof(spare), "%s.part", previous) >= (int)sizeof(spare)) return ENAMETOOLONG;
  if (!access(path, F_OK)) {
    (void)remove(spare);
    if (link(path, spare)) {
      if (rename(path, previous)) return errno;
    } else if (rename(spare, previous)) return errno;
  }
  return rename(part, path) ? errno : 0;
}

/* The file from memory to the disk, on the first rank */
static PetscErrorCode Store(hid_t file, const char path[])
{
  char              resolved[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN], previous[PETSC_MAX_PATH_LEN], *image;
  CheckpointTrailer trailer;
  ssize_t           size;
  int               error;

  PetscFunctionBegin;
  PetscCall(OutputPathResolve(path, sizeof(resolved), resolved));
  PetscCall(OutputFileGetPart(path, sizeof(part), part));
  PetscCall(CheckpointFileGetPrevious(resolved, sizeof(previous), previous));
  PetscCall(HDF5Check(H5Fflush(file, H5F_SCOPE_GLOBAL), "finish a file", path));
  size = H5Fget_file_image(file, NULL, 0);
  PetscCall(HDF5Check(size, "finish a file", path));
  PetscCall(PetscMalloc1((size_t)size, &image));
  size = H5Fget_file_image(file, image, (size_t)size);
  PetscCall(HDF5Check(size, "finish a file", path));
  memcpy(trailer.magic, CHECKPOINT_MAGIC, sizeof(trailer.magic));
  trailer.size = (uint64_t)size;
  trailer.sum  = ByteSum(BYTE_SUM_BEGIN, (size_t)size, image);
  PetscCall(OutputFileMakeParents(part));
  error = WriteBytes(part, (size_t)size, image, &trailer);
  PetscCall(PetscFree(image));
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "-checkpoint %s cannot be written: %s", path, strerror(error));
  error = Rotate(part, resolved, previous);
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "-checkpoint %s cannot be put in its place: %s", path, strerror(error));
  PetscCall(OutputFileSyncFolder(resolved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stream that all ranks have, and the tables, on the first rank */
static PetscErrorCode WriteShared(hid_t file, const CheckpointContents *contents, const char path[])
{
  const void *bytes;
  size_t      size;
  hsize_t     length[2];
  PetscInt    n_tables;

  PetscFunctionBegin;
  PetscCall(CheckpointGetBytes(contents->shared, &size, &bytes));
  length[0] = size;
  PetscCall(WriteDataset(file, "shared", H5T_NATIVE_UCHAR, 1, length, bytes, path));
  TablesGetNumber(contents->tables, &n_tables);
  for (PetscInt i = 0; i < n_tables; i++) {
    const char      *name;
    const PetscReal *values;
    PetscInt         n, width;
    char             place[32];
    hid_t            dataset;

    PetscCall(TablesGetTable(contents->tables, i, &name, &n, &width, &values));
    length[0] = (hsize_t)n;
    length[1] = (hsize_t)width;
    PetscCall(PetscSNPrintf(place, sizeof(place), "tables/%" PetscInt_FMT, i));
    PetscCall(WriteDataset(file, place, H5T_NATIVE_DOUBLE, 2, length, values, path));
    dataset = H5Dopen2(file, place, H5P_DEFAULT);
    PetscCall(HDF5Check(dataset, "open a table", path));
    PetscCall(HDF5WriteText(dataset, "name", name, PETSC_FALSE, path));
    PetscCall(HDF5Check(H5Dclose(dataset), "write a table", path));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a checkpoint, and keeps the one before. Collective */
PetscErrorCode CheckpointFileWrite(MPI_Comm comm, const char path[], const CheckpointInfo *info, const CheckpointContents *contents)
{
  PetscErrorCode error = PETSC_SUCCESS;
  PetscMPIInt    rank;
  hid_t          file = -1;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(CreateInMemory(path, info, &file));
  if (!rank) PetscCall(WriteShared(file, contents, path));
  PetscCall(WriteStreams(comm, file, contents->state, path));
  PetscCall(WriteBodies(file, contents->n_bodies, contents->bodies, path));
  if (!rank) {
    error = Store(file, path);
    H5Fclose(file);
  }
  PetscCall(OutputFileShareError(comm, error, "-checkpoint", path, "write"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
