/* Whether a classic NetCDF file is complete. The NetCDF library reads zeros where such a file is cut short, without an error. */
#include "meshimpl.h"
#include <sys/stat.h>

/* A header as it is read. Its numbers are big-endian. */
typedef struct {
  FILE     *stream;
  long      size;
  int       count_bytes, offset_bytes; /* 4 or 8, by the version of the format */
  PetscBool cut;                       /* the file ends too early, or a number is impossible */
} Header;

static PetscInt64 ReadNumber(Header *header, int bytes)
{
  uint64_t value = 0;

  for (int i = 0; i < bytes && !header->cut; i++) {
    const int byte = fgetc(header->stream);

    if (byte == EOF) header->cut = PETSC_TRUE;
    value = value << 8 | (unsigned char)byte;
  }
  return header->cut ? 0 : (PetscInt64)value;
}

/* Reads a length, which cannot exceed that of the file */
static PetscInt64 ReadLength(Header *header)
{
  const PetscInt64 length = ReadNumber(header, header->count_bytes);

  if (length < 0 || length > header->size) header->cut = PETSC_TRUE;
  return header->cut ? 0 : length;
}

/* Skips an entry of the header: entries are padded to a multiple of four bytes */
static void Skip(Header *header, PetscInt64 bytes)
{
  bytes = (bytes + 3) / 4 * 4;
  if (bytes < 0 || bytes > header->size || fseek(header->stream, (long)bytes, SEEK_CUR)) header->cut = PETSC_TRUE;
}

static PetscInt64 TypeSize(PetscInt64 type)
{
  static const int sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8}; /* byte, char, short, int, float, double, unsigned ... */

  return type > 0 && type < 12 ? sizes[type] : 0;
}

static void SkipAttributes(Header *header)
{
  PetscInt64 n;

  (void)ReadNumber(header, 4); /* tells that a list follows */
  n = ReadLength(header);
  for (PetscInt64 i = 0; i < n && !header->cut; i++) {
    PetscInt64 type;

    Skip(header, ReadLength(header));
    type = ReadNumber(header, 4);
    Skip(header, TypeSize(type) * ReadLength(header));
  }
}

/* Finds where the data of the file end, from the place and the dimensions of each variable. A dimension of length 0 is that of records: the
   header tells the place of the first record. Only the first of a variable may be that; with another one NetCDF divides by zero. */
static PetscErrorCode FindEnd(Header *header, PetscInt64 records, double *end)
{
  PetscInt64 n, *lengths;
  double     record = 0, last = 0;

  PetscFunctionBegin;
  (void)ReadNumber(header, 4);
  n = ReadLength(header);
  PetscCall(PetscMalloc1((size_t)n, &lengths));
  for (PetscInt64 i = 0; i < n && !header->cut; i++) {
    Skip(header, ReadLength(header));
    lengths[i] = ReadNumber(header, header->count_bytes);
  }
  SkipAttributes(header);
  (void)ReadNumber(header, 4);
  *end = 0;
  for (PetscInt64 v = ReadLength(header); v > 0 && !header->cut; v--) {
    PetscInt64 rank, offset;
    PetscBool  is_record = PETSC_FALSE;
    double     size      = 1, entry;

    Skip(header, ReadLength(header));
    rank = ReadLength(header);
    for (PetscInt64 d = 0; d < rank && !header->cut; d++) {
      const PetscInt64 dimension = ReadNumber(header, header->count_bytes);

      if (dimension < 0 || dimension >= n || lengths[dimension] < 0 || (d && !lengths[dimension])) header->cut = PETSC_TRUE;
      else if (!lengths[dimension]) is_record = PETSC_TRUE;
      else size *= (double)lengths[dimension];
    }
    SkipAttributes(header);
    entry = (double)TypeSize(ReadNumber(header, 4));
    if (!(entry > 0)) header->cut = PETSC_TRUE;
    size *= entry;
    (void)ReadNumber(header, header->count_bytes);
    offset = ReadNumber(header, header->offset_bytes);
    if (is_record) {
      record += PetscCeilReal(size / 4) * 4;
      last = PetscMax(last, (double)offset + size);
    } else *end = PetscMax(*end, (double)offset + size);
  }
  if (records > 0) *end = PetscMax(*end, last + (double)(records - 1) * record);
  PetscCall(PetscFree(lengths));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends with an error if a classic NetCDF file is shorter than its header tells; other files are not checked. Call on the first rank alone.
   The format is that of the NetCDF User's Guide, "The NetCDF Classic Format Specification". */
PetscErrorCode MeshCheckNetCDFSize(const char path[])
{
  Header         header = {0};
  struct stat    about;
  unsigned char  magic[4] = {0};
  PetscBool      classic  = PETSC_FALSE;
  double         end      = 0;
  PetscErrorCode error    = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscCheck(!stat(path, &about), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "it cannot be read");
  header.size   = (long)about.st_size;
  header.stream = fopen(path, "rb");
  PetscCheck(header.stream, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "it cannot be opened");
  if (fread(magic, 1, 4, header.stream) == 4 && magic[0] == 'C' && magic[1] == 'D' && magic[2] == 'F')
    classic = (PetscBool)(magic[3] == 1 || magic[3] == 2 || magic[3] == 5);
  if (classic) {
    PetscInt64 records;

    header.count_bytes  = magic[3] == 5 ? 8 : 4;
    header.offset_bytes = magic[3] == 1 ? 4 : 8;
    records             = ReadNumber(&header, header.count_bytes);
    if (records == (header.count_bytes == 4 ? (PetscInt64)UINT32_MAX : -1)) records = 0; /* unknown: the file was written as a stream */
    error = FindEnd(&header, records, &end);
  }
  (void)fclose(header.stream);
  PetscCall(error);
  PetscCheck(!header.cut, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "its header is damaged or cut short");
  PetscCheck(end <= (double)header.size, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT,
             "it is cut short: it has %ld bytes, and its data end at byte %.0f", header.size, end);
  PetscFunctionReturn(PETSC_SUCCESS);
}
