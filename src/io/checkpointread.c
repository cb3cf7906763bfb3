/* Reading the file of a checkpoint: see checkpointfile.c. */
#define _POSIX_C_SOURCE 200809L
#include "checkpointfileimpl.h"
#include "outputfile.h"
#include <errno.h>
#include <fcntl.h>
#include <impakt.h>
#include <sys/stat.h>
#include <unistd.h>

/* The last checkpoint there is. `found`: that path or, after a kill between two renames, that of the checkpoint before. Collective */
PetscErrorCode CheckpointFileFind(MPI_Comm comm, const char path[], size_t size, char found[], PetscBool *exists)
{
  PetscMPIInt rank;
  int         place = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(CheckpointFileGetPrevious(path, size, found));
  if (!rank) place = !access(path, F_OK) ? 1 : !access(found, F_OK) ? 2 : 0;
  PetscCallMPI(MPI_Bcast(&place, 1, MPI_INT, 0, comm));
  if (place != 2) PetscCall(PetscStrncpy(found, path, size));
  *exists = (PetscBool)(place > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads so many bytes, fewer at the end of the file; returns their number, or -1 */
static ssize_t ReadBytes(int file, size_t size, char bytes[])
{
  size_t done = 0;

  while (done < size) {
    const ssize_t now = read(file, bytes + done, size - done);

    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return -1;
    if (!now) break;
    done += (size_t)now;
  }
  return (ssize_t)done;
}

/* Whether the file is a checkpoint, all of it there and as it was written; says why not */
static PetscErrorCode CheckWhole(const char path[], const char **why)
{
  CheckpointTrailer trailer = {.size = 0};
  struct stat       status;
  uint64_t          sum  = BYTE_SUM_BEGIN, size;
  int               file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  char             *bytes;

  PetscFunctionBegin;
  *why = NULL;
  if (file < 0 || fstat(file, &status)) *why = strerror(errno);
  else if (!S_ISREG(status.st_mode)) *why = "it is no file";
  else if (status.st_size < (off_t)sizeof(trailer) || lseek(file, -(off_t)sizeof(trailer), SEEK_END) < 0 ||
           ReadBytes(file, sizeof(trailer), (char *)&trailer) != (ssize_t)sizeof(trailer) ||
           memcmp(trailer.magic, CHECKPOINT_MAGIC, sizeof(trailer.magic)) != 0)
    *why = "it is no checkpoint of Impakt, or its end is missing";
  else if (trailer.size + sizeof(trailer) != (uint64_t)status.st_size || lseek(file, 0, SEEK_SET) < 0)
    *why = "it is not as long as it was written";
  size = *why ? 0 : trailer.size;
  PetscCall(PetscMalloc1((size_t)PetscMin(size, CHECKPOINT_BLOCK), &bytes));
  for (uint64_t done = 0; done < size && !*why; done += CHECKPOINT_BLOCK) {
    const size_t now = (size_t)PetscMin(CHECKPOINT_BLOCK, size - done);

    if (ReadBytes(file, now, bytes) != (ssize_t)now) *why = "it cannot be read";
    else sum = ByteSum(sum, now, bytes);
  }
  PetscCall(PetscFree(bytes));
  if (!*why && sum != trailer.sum) *why = "its bytes are not those that were written";
  if (file >= 0) close(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNumber(const CheckpointFile *checkpoint, const char name[], hid_t type, void *value)
{
  const hid_t attribute = H5Aopen(checkpoint->file, name, H5P_DEFAULT);

  PetscFunctionBegin;
  PetscCheck(attribute >= 0 && H5Aread(attribute, type, value) >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "%s %s: there is no '%s' in it", checkpoint->option, checkpoint->path, name);
  H5Aclose(attribute);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadText(const CheckpointFile *checkpoint, hid_t object, const char name[], char **text)
{
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = attribute < 0 ? -1 : H5Aget_type(attribute);
  char       *read = NULL;

  PetscFunctionBegin;
  PetscCheck(type >= 0 && H5Tis_variable_str(type) > 0 && H5Aread(attribute, type, &read) >= 0 && read, PETSC_COMM_SELF,
             PETSC_ERR_FILE_UNEXPECTED, "%s %s: there is no '%s' in it", checkpoint->option, checkpoint->path, name);
  PetscCall(PetscStrallocpy(read, text));
  H5free_memory(read);
  H5Tclose(type);
  H5Aclose(attribute);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Open(const char path[], CheckpointFile *checkpoint)
{
  const char *why;
  char        previous[PETSC_MAX_PATH_LEN], *version;
  PetscBool   same, other;
  long long   step;
  int         format, integer;

  PetscFunctionBegin;
  PetscCall(CheckpointFileGetPrevious(path, sizeof(previous), previous));
  other = (PetscBool)!access(previous, F_OK);
  PetscCall(CheckWhole(path, &why));
  PetscCheck(!why, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s %s: the run cannot be continued from it, since %s%s%s%s", checkpoint->option,
             path, why, other ? "; the checkpoint before it is " : "", other ? previous : "", other ? ": give that" : "");
  checkpoint->file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  PetscCheck(checkpoint->file >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED, "%s %s: HDF5 cannot open it", checkpoint->option, path);
  PetscCall(ReadNumber(checkpoint, "checkpoint", H5T_NATIVE_INT, &format));
  PetscCall(ReadNumber(checkpoint, "bytes_of_integers", H5T_NATIVE_INT, &integer));
  PetscCall(ReadText(checkpoint, checkpoint->file, "version", &version));
  PetscCall(PetscStrcmp(version, IMPAKT_VERSION, &same));
  PetscCheck(same && format == CHECKPOINT_FORMAT && integer == (int)sizeof(PetscInt), PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "%s %s: it was written by Impakt %s with integers of %d bytes in format %d, and this is %s with %d bytes and format %d: "
             "continue the run with the program that began it",
             checkpoint->option, path, version, integer, format, IMPAKT_VERSION, (int)sizeof(PetscInt), CHECKPOINT_FORMAT);
  PetscCall(PetscFree(version));
  PetscCall(ReadNumber(checkpoint, "step", H5T_NATIVE_LLONG, &step));
  checkpoint->info.step = (PetscInt)step;
  PetscCall(ReadNumber(checkpoint, "time", H5T_NATIVE_DOUBLE, &checkpoint->info.time));
  PetscCall(ReadNumber(checkpoint, "ranks", H5T_NATIVE_INT, &checkpoint->info.ranks));
  PetscCall(ReadText(checkpoint, checkpoint->file, "options", &checkpoint->info.options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Opens a checkpoint and checks that it is whole. `option`: for messages, outlives the file. End with CheckpointFileClose(). Collective */
PetscErrorCode CheckpointFileOpen(MPI_Comm comm, const char option[], const char path[], CheckpointFile *checkpoint)
{
  PetscErrorCode error = PETSC_SUCCESS;
  PetscMPIInt    rank;
  size_t         length = 0;
  HDF5Silence    silence;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(checkpoint, sizeof(*checkpoint)));
  checkpoint->file   = -1;
  checkpoint->option = option;
  PetscCall(PetscStrncpy(checkpoint->path, path, sizeof(checkpoint->path)));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  HDF5SilenceBegin(&silence);
  if (!rank) error = Open(path, checkpoint);
  PetscCall(OutputFileShareError(comm, error, option, path, "read"));
  HDF5SilenceEnd(&silence);
  if (!rank) length = strlen(checkpoint->info.options) + 1;
  PetscCallMPI(MPI_Bcast(&checkpoint->info.step, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&checkpoint->info.time, 1, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(&checkpoint->info.ranks, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&length, sizeof(length), MPI_BYTE, 0, comm));
  if (rank) PetscCall(PetscMalloc1(length, &checkpoint->info.options));
  PetscCallMPI(MPI_Bcast(checkpoint->info.options, (PetscMPIInt)length, MPI_CHAR, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A dataset of rows by columns, or of one column, on the first rank. `values`: a pointer to numbers of `each` bytes, to be freed */
static PetscErrorCode ReadDataset(const CheckpointFile *file, const char name[], hid_t type, size_t each, hsize_t length[2], void *values)
{
  hid_t dataset, space;

  PetscFunctionBegin;
  length[0] = 0;
  length[1] = 1;
  dataset   = H5Dopen2(file->file, name, H5P_DEFAULT);
  PetscCall(HDF5Check(dataset, "open a dataset", file->path));
  space = H5Dget_space(dataset);
  PetscCall(HDF5Check(H5Sget_simple_extent_dims(space, length, NULL), "read a dataset", file->path));
  PetscCall(PetscMalloc((size_t)(length[0] * length[1]) * each, (void **)values));
  if (length[0])
    PetscCall(HDF5Check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *(void **)values), "read a dataset", file->path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", file->path));
  PetscCall(HDF5Check(H5Dclose(dataset), "read a dataset", file->path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadStream(const CheckpointFile *file, const char name[], size_t *size, char **bytes)
{
  hsize_t length[2];

  PetscFunctionBegin;
  PetscCall(ReadDataset(file, name, H5T_NATIVE_UCHAR, 1, length, bytes));
  *size = (size_t)length[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stream of each rank, of a checkpoint of as many ranks. Collective */
PetscErrorCode CheckpointFileRead(MPI_Comm comm, const CheckpointFile *file, Checkpoint *checkpoint)
{
  PetscMPIInt rank;
  size_t      size = 0, own_size = 0;
  char       *bytes, *own        = NULL;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  for (PetscMPIInt r = 0; r < file->info.ranks && !rank; r++) {
    char name[32];

    PetscCall(PetscSNPrintf(name, sizeof(name), "state/%d", (int)r));
    PetscCall(ReadStream(file, name, &size, &bytes));
    if (!r) {
      own      = bytes;
      own_size = size;
      continue;
    }
    PetscCall(CheckpointSendBytes(comm, r, size, bytes));
    PetscCall(PetscFree(bytes));
  }
  if (rank) PetscCall(CheckpointReceiveBytes(comm, 0, &own_size, &own));
  PetscCall(CheckpointCreateFromBytes(comm, own_size, own, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointFileReadShared - the stream that all ranks have; Collective */
PetscErrorCode CheckpointFileReadShared(MPI_Comm comm, const CheckpointFile *file, Checkpoint *checkpoint)
{
  PetscMPIInt rank;
  size_t      size = 0;
  char       *bytes;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(ReadStream(file, "shared", &size, &bytes));
  PetscCallMPI(MPI_Bcast(&size, sizeof(size), MPI_BYTE, 0, comm));
  if (rank) PetscCall(PetscMalloc1(size, &bytes));
  for (size_t at = 0; at < size; at += CHECKPOINT_BLOCK)
    PetscCallMPI(MPI_Bcast(bytes + at, (PetscMPIInt)PetscMin(CHECKPOINT_BLOCK, size - at), MPI_BYTE, 0, comm));
  PetscCall(CheckpointCreateFromBytes(comm, size, bytes, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An array of the first rank to every rank, in blocks of rows; of the others it is NULL before. Collective. */
static PetscErrorCode ShareArray(MPI_Comm comm, PetscInt size[2], PetscReal **values)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(size, 2, MPIU_INT, 0, comm));
  if (!*values && size[0]) PetscCall(PetscMalloc1(size[0] * size[1], values));
  for (PetscInt row = 0; row < size[0]; row += 1 << 20)
    PetscCallMPI(MPI_Bcast(*values + row * size[1], (PetscMPIInt)(PetscMin(1 << 20, size[0] - row) * size[1]), MPIU_REAL, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTable(const CheckpointFile *file, PetscInt i, char name[512], PetscInt size[2], PetscReal **values)
{
  char    place[32], *text;
  hsize_t length[2];
  hid_t   dataset;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(place, sizeof(place), "tables/%" PetscInt_FMT, i));
  PetscCall(ReadDataset(file, place, H5T_NATIVE_DOUBLE, sizeof(**values), length, values));
  for (PetscInt d = 0; d < 2; d++) size[d] = (PetscInt)length[d];
  dataset = H5Dopen2(file->file, place, H5P_DEFAULT);
  PetscCall(HDF5Check(dataset, "open a table", file->path));
  PetscCall(ReadText(file, dataset, "name", &text));
  PetscCall(PetscStrncpy(name, text, 512));
  PetscCall(PetscFree(text));
  PetscCall(HDF5Check(H5Dclose(dataset), "read a table", file->path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointFileReadTables - all tables, to every rank; Collective */
PetscErrorCode CheckpointFileReadTables(MPI_Comm comm, const CheckpointFile *file, Tables *tables)
{
  PetscMPIInt rank;
  hsize_t     n = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(TablesCreate(comm, PETSC_TRUE, tables));
  if (!rank) {
    const hid_t group = H5Gopen2(file->file, "tables", H5P_DEFAULT);

    PetscCall(HDF5Check(group, "open the tables", file->path));
    PetscCall(HDF5Check(H5Gget_num_objs(group, &n), "count the tables", file->path));
    PetscCall(HDF5Check(H5Gclose(group), "close the tables", file->path));
  }
  PetscCallMPI(MPI_Bcast(&n, sizeof(n), MPI_BYTE, 0, comm));
  for (PetscInt i = 0; i < (PetscInt)n; i++) {
    char       name[512] = "";
    PetscInt   size[2];
    PetscReal *values = NULL;

    if (!rank) PetscCall(ReadTable(file, i, name, size, &values));
    PetscCallMPI(MPI_Bcast(name, sizeof(name), MPI_CHAR, 0, comm));
    PetscCall(ShareArray(comm, size, &values));
    PetscCall(TablesShare(*tables, name, size[0], size[1], values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointFileClose - closes a checkpoint, and frees what it says of its run; Collective */
PetscErrorCode CheckpointFileClose(CheckpointFile *file)
{
  PetscFunctionBegin;
  if (file->file >= 0) H5Fclose(file->file);
  file->file = -1;
  PetscCall(PetscFree(file->info.options));
  PetscFunctionReturn(PETSC_SUCCESS);
}
