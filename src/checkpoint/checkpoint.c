/* A stream of records: a name, what kind of values there are, how many, and the values. While a checkpoint is loaded each visit names the
   record that it expects, so that a checkpoint of another problem, or of another version, is found out by the first record that differs. */
#include "checkpoint.h"
#include <string.h>

#define NAME_BYTES  40
#define FIRST_BYTES ((size_t)1 << 16)

/* Each record begins with one, its values follow in multiples of 8 bytes */
typedef struct {
  char       name[NAME_BYTES - 1], kind;
  PetscInt64 count;
} Header;

_Static_assert(sizeof(Header) == NAME_BYTES + 8, "records begin at multiples of 8 bytes");
_Static_assert(sizeof(PetscScalar) == sizeof(PetscReal), "vectors and matrices are visited as real numbers");

struct _n_Checkpoint {
  MPI_Comm  comm;
  PetscBool loads;
  char      section[NAME_BYTES]; /* what is being visited, for messages */
  size_t    size, room;          /* bytes of the stream; those there is room for */
  size_t    at;                  /* where the next record begins */
  char     *bytes;
};

static size_t Padded(size_t bytes)
{
  return (bytes + 7) / 8 * 8;
}

/* CheckpointCreate - an empty stream, to be filled by visits; Collective */
PetscErrorCode CheckpointCreate(MPI_Comm comm, Checkpoint *checkpoint)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(checkpoint));
  (*checkpoint)->comm = comm;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointCreateFromBytes - a stream that visits are filled from; takes over `bytes`, which PetscMalloc() has made */
PetscErrorCode CheckpointCreateFromBytes(MPI_Comm comm, size_t size, void *bytes, Checkpoint *checkpoint)
{
  PetscFunctionBegin;
  PetscCall(CheckpointCreate(comm, checkpoint));
  (*checkpoint)->loads = PETSC_TRUE;
  (*checkpoint)->size = (*checkpoint)->room = size;
  (*checkpoint)->bytes                      = (char *)bytes;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointGetBytes - the stream of this rank, owned by the checkpoint */
PetscErrorCode CheckpointGetBytes(Checkpoint c, size_t *size, const void *bytes[])
{
  PetscFunctionBegin;
  *size  = c->size;
  *bytes = c->bytes;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointFinish - makes sure that all of a stream has been taken */
PetscErrorCode CheckpointFinish(Checkpoint c)
{
  PetscFunctionBegin;
  PetscCheck(c->at == c->size, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has more in it than this run has a place for, after '%s': it is of another problem or version", c->section);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CheckpointDestroy(Checkpoint *checkpoint)
{
  PetscFunctionBegin;
  if (!*checkpoint) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*checkpoint)->bytes));
  PetscCall(PetscFree(*checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointLoads - whether visits overwrite what they visit */
PetscBool CheckpointLoads(Checkpoint c)
{
  return c->loads;
}

static PetscErrorCode MakeRoom(Checkpoint c, size_t more)
{
  PetscFunctionBegin;
  if (c->size + more <= c->room) PetscFunctionReturn(PETSC_SUCCESS);
  c->room = PetscMax(PetscMax(2 * c->room, FIRST_BYTES), c->size + more);
  PetscCall(PetscRealloc(c->room, &c->bytes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One record of values of so many bytes each */
static PetscErrorCode Visit(Checkpoint c, const char name[], char kind, PetscInt64 count, size_t each, void *values)
{
  const size_t length = (size_t)count * each, padded = Padded(length);
  Header       header = {.kind = kind, .count = count};

  PetscFunctionBegin;
  strncpy(header.name, name, sizeof(header.name) - 1);
  if (!c->loads) {
    PetscCall(MakeRoom(c, sizeof(header) + padded));
    memcpy(c->bytes + c->size, &header, sizeof(header));
    if (length) memcpy(c->bytes + c->size + sizeof(header), values, length);
    memset(c->bytes + c->size + sizeof(header) + length, 0, padded - length);
    c->size += sizeof(header) + padded;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(c->at + sizeof(header) + padded <= c->size, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint ends before '%s' of %s: it is of another problem or version", name, c->section);
  PetscCheck(!memcmp(c->bytes + c->at, &header, sizeof(header)), PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "The checkpoint has %lld x '%.*s' where this run has %lld x '%s' of %s: it is of another problem or version",
             (long long)((const Header *)(const void *)(c->bytes + c->at))->count, NAME_BYTES - 1, c->bytes + c->at, (long long)count, name,
             c->section);
  if (length) memcpy(values, c->bytes + c->at + sizeof(header), length);
  c->at += sizeof(header) + padded;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointBegin - names the object whose records follow */
PetscErrorCode CheckpointBegin(Checkpoint c, const char section[])
{
  PetscFunctionBegin;
  strncpy(c->section, section, sizeof(c->section) - 1);
  PetscCall(Visit(c, section, 's', 0, 1, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CheckpointVisitReals(Checkpoint c, const char name[], PetscInt n, PetscReal values[])
{
  PetscFunctionBegin;
  PetscCall(Visit(c, name, 'r', n, sizeof(*values), values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CheckpointVisitInts(Checkpoint c, const char name[], PetscInt n, PetscInt values[])
{
  PetscFunctionBegin;
  PetscCall(Visit(c, name, 'i', n, sizeof(*values), values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CheckpointVisitInt64s(Checkpoint c, const char name[], PetscInt n, PetscInt64 values[])
{
  PetscFunctionBegin;
  PetscCall(Visit(c, name, 'l', n, sizeof(*values), values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CheckpointVisitBools(Checkpoint c, const char name[], PetscInt n, PetscBool values[])
{
  PetscFunctionBegin;
  PetscCall(Visit(c, name, 'b', n, sizeof(*values), values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointVisitBytes - a struct, or several, without pointers */
PetscErrorCode CheckpointVisitBytes(Checkpoint c, const char name[], size_t size, void *values)
{
  PetscFunctionBegin;
  PetscCall(Visit(c, name, 'c', (PetscInt64)size, 1, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointVisitVec - the entries of this rank; NULL, in both runs, is none */
PetscErrorCode CheckpointVisitVec(Checkpoint c, const char name[], Vec vec)
{
  PetscScalar *values = NULL;
  PetscInt     n      = 0;

  PetscFunctionBegin;
  if (vec) {
    PetscCall(VecGetLocalSize(vec, &n));
    if (c->loads) PetscCall(VecGetArrayWrite(vec, &values));
    else PetscCall(VecGetArrayRead(vec, (const PetscScalar **)&values));
  }
  PetscCall(Visit(c, name, vec ? 'v' : 'n', n, sizeof(*values), values));
  if (vec && c->loads) PetscCall(VecRestoreArrayWrite(vec, &values));
  else if (vec) PetscCall(VecRestoreArrayRead(vec, (const PetscScalar **)&values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointVisitTrace - all levels; NULL, in both runs, is none */
PetscErrorCode CheckpointVisitTrace(Checkpoint c, const char name[], Trace trace)
{
  PetscScalar *values = NULL;
  PetscInt     size = 0, levels = -1;

  PetscFunctionBegin;
  if (trace) {
    PetscCall(TraceGetSizes(trace, &size, &levels));
    PetscCall(TraceGetLevel(trace, 0, &values)); /* the others follow */
  }
  PetscCall(Visit(c, name, 't', (PetscInt64)size * (levels + 1), sizeof(*values), values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix like the one that is given, with new entries in other places */
static PetscErrorCode CreateMat(Mat like, PetscInt n, const PetscInt offsets[], const PetscInt columns[], const PetscScalar values[],
                                Mat *mat)
{
  PetscInt rows, local_columns;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(like, &rows, &local_columns));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)like), mat));
  PetscCall(MatSetSizes(*mat, n, local_columns, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*mat, MATAIJ));
  PetscCall(MatSeqAIJSetPreallocationCSR(*mat, offsets, columns, values));
  PetscCall(MatMPIAIJSetPreallocationCSR(*mat, offsets, columns, values));
  PetscCall(MatSetOption(*mat, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows that have been loaded are those of a matrix */
static PetscErrorCode CheckRows(Checkpoint c, const char name[], PetscInt n, const PetscInt offsets[])
{
  PetscBool fine = (PetscBool)(offsets[0] == 0);

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) fine = (PetscBool)(fine && offsets[i] <= offsets[i + 1]);
  /* entries that are not there are not given memory */
  if (fine && c->loads) fine = (PetscBool)((size_t)offsets[n] <= (c->size - c->at) / (sizeof(PetscInt) + sizeof(PetscScalar)));
  PetscCheck(fine, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED, "The checkpoint has rows of '%s' of %s that cannot be", name, c->section);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckColumns(Checkpoint c, const char name[], PetscInt size, PetscInt n, const PetscInt columns[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    PetscCheck(columns[i] >= 0 && columns[i] < size, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
               "The checkpoint has an entry of '%s' of %s in column %" PetscInt_FMT " of %" PetscInt_FMT, name, c->section, columns[i],
               size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointVisitMat - a matrix of type AIJ with its explicit zeros; loading makes it anew, of the same size. Collective */
PetscErrorCode CheckpointVisitMat(Checkpoint c, const char name[], Mat *mat)
{
  PetscInt     begin, end, n, width, count = 0, *offsets, *columns;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(*mat, &begin, &end));
  n = end - begin;
  PetscCall(PetscCalloc1(n + 1, &offsets));
  for (PetscInt i = 0; i < n && !c->loads; i++) {
    PetscInt entries;

    PetscCall(MatGetRow(*mat, begin + i, &entries, NULL, NULL));
    offsets[i + 1] = offsets[i] + entries;
    PetscCall(MatRestoreRow(*mat, begin + i, &entries, NULL, NULL));
  }
  PetscCall(CheckpointVisitInts(c, name, n + 1, offsets));
  PetscCall(CheckRows(c, name, n, offsets));
  count = offsets[n];
  PetscCall(PetscMalloc2(count, &columns, count, &values));
  for (PetscInt i = 0; i < n && !c->loads; i++) {
    const PetscInt    *row_columns;
    const PetscScalar *row_values;
    PetscInt           entries;

    PetscCall(MatGetRow(*mat, begin + i, &entries, &row_columns, &row_values));
    PetscCall(PetscArraycpy(columns + offsets[i], row_columns, entries));
    PetscCall(PetscArraycpy(values + offsets[i], row_values, entries));
    PetscCall(MatRestoreRow(*mat, begin + i, &entries, &row_columns, &row_values));
  }
  PetscCall(CheckpointVisitInts(c, "columns", count, columns));
  PetscCall(MatGetSize(*mat, NULL, &width));
  PetscCall(CheckColumns(c, name, width, count, columns));
  PetscCall(CheckpointVisitReals(c, "entries", count, values));
  if (c->loads) {
    Mat loaded;

    PetscCall(CreateMat(*mat, n, offsets, columns, values, &loaded));
    PetscCall(MatDestroy(mat));
    *mat = loaded;
  }
  PetscCall(PetscFree2(columns, values));
  PetscCall(PetscFree(offsets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CheckpointCheckInts - numbers that must be the same in both runs */
PetscErrorCode CheckpointCheckInts(Checkpoint c, const char name[], PetscInt n, const PetscInt values[])
{
  PetscInt *there;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &there));
  PetscCall(PetscArraycpy(there, values, n));
  PetscCall(CheckpointVisitInts(c, name, n, there));
  for (PetscInt i = 0; i < n; i++)
    PetscCheck(there[i] == values[i], PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
               "The checkpoint has '%s' of %s as %" PetscInt_FMT " where this run has %" PetscInt_FMT
               ": it is of another problem, or its bodies are distributed otherwise",
               name, c->section, there[i], values[i]);
  PetscCall(PetscFree(there));
  PetscFunctionReturn(PETSC_SUCCESS);
}
