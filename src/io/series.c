/* Time series in HDF5: extensible datasets, appended to record by record. Serial; the caller is one rank. */
#include "series.h"
#include <impakt.h>
#include <ctype.h>
#include <hdf5.h>
#include <string.h>

_Static_assert(sizeof(PetscReal) == sizeof(double), "series are stored in double precision");

/* Values in a chunk: small enough for a short run's file, large enough for a long run's index */
#define CHUNK 1024

/* Records written at a time */
#define BLOCK 4096

static PetscErrorCode CheckHDF5(hid_t result, const char what[], const char path[])
{
  PetscFunctionBegin;
  PetscCheck(result >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "HDF5 cannot %s in %s; is the disk full, or the file damaged?", what, path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A string of variable length, which may be empty */
static PetscErrorCode WriteAttribute(hid_t object, const char name[], const char value[], const char path[])
{
  hid_t type, space, attribute;

  PetscFunctionBegin;
  type = H5Tcopy(H5T_C_S1);
  PetscCall(CheckHDF5(H5Tset_size(type, H5T_VARIABLE), "make a string type", path));
  PetscCall(CheckHDF5(H5Tset_cset(type, H5T_CSET_UTF8), "make a string type", path));
  space = H5Screate(H5S_SCALAR);
  PetscCall(CheckHDF5(space, "make a data space", path));
  attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  PetscCall(CheckHDF5(attribute, "create an attribute", path));
  PetscCall(CheckHDF5(H5Awrite(attribute, type, &value), "write an attribute", path));
  PetscCall(CheckHDF5(H5Aclose(attribute), "write an attribute", path));
  PetscCall(CheckHDF5(H5Sclose(space), "close a data space", path));
  PetscCall(CheckHDF5(H5Tclose(type), "close a type", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool BeginsOption(const char text[])
{
  return (PetscBool)(text[0] == '-' && isalpha((unsigned char)text[1]));
}

/* One attribute for each option, from "-name value -name -name value ", as `PetscOptionsGetAll()` lists them */
static PetscErrorCode WriteOptions(hid_t object, const char options[], const char path[])
{
  char *copy, *name, *end, *value, *next;

  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(options, &copy));
  for (name = copy; (end = strchr(name, ' ')); name = next) {
    value = end + 1;
    for (next = value; *next && !(next[-1] == ' ' && BeginsOption(next)); next++);
    *end     = '\0';
    next[-1] = '\0'; /* the blank after the value, or where there is none, after the name once more */
    PetscCall(WriteAttribute(object, name, next == value ? "" : value, path));
  }
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateDataset(hid_t file, const Series *series, const char path[])
{
  const int     rank       = series->components > 1 ? 2 : 1;
  const hsize_t size[2]    = {0, (hsize_t)series->components};
  const hsize_t maximum[2] = {H5S_UNLIMITED, (hsize_t)series->components};
  const hsize_t chunk[2]   = {CHUNK, (hsize_t)series->components};
  hid_t         space, links, layout, dataset;

  PetscFunctionBegin;
  space = H5Screate_simple(rank, size, maximum);
  PetscCall(CheckHDF5(space, "make a data space", path));
  links  = H5Pcreate(H5P_LINK_CREATE);
  layout = H5Pcreate(H5P_DATASET_CREATE);
  PetscCall(CheckHDF5(H5Pset_create_intermediate_group(links, 1), "make groups", path));
  PetscCall(CheckHDF5(H5Pset_chunk(layout, rank, chunk), "make chunks", path));
  dataset = H5Dcreate2(file, series->name, series->integer ? H5T_STD_I32LE : H5T_IEEE_F64LE, space, links, layout, H5P_DEFAULT);
  PetscCall(CheckHDF5(dataset, "create a dataset", path));
  PetscCall(WriteAttribute(dataset, "units", series->units, path));
  PetscCall(CheckHDF5(H5Dclose(dataset), "create a dataset", path));
  PetscCall(CheckHDF5(H5Pclose(layout), "close a property list", path));
  PetscCall(CheckHDF5(H5Pclose(links), "close a property list", path));
  PetscCall(CheckHDF5(H5Sclose(space), "close a data space", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  SeriesFileCreate - creates a file of empty series

  Not Collective

  Input Parameters:
+ path     - where, replacing what is there
. n_series - number of series
. series   - the series
- options  - all options of the run, as `PetscOptionsGetAll()` gives them: they become attributes of the root, beside `version`
*/
PetscErrorCode SeriesFileCreate(const char path[], PetscInt n_series, const Series series[], const char options[])
{
  hid_t file;

  PetscFunctionBegin;
  file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  PetscCall(CheckHDF5(file, "create a file", path));
  PetscCall(WriteAttribute(file, "version", IMPAKT_VERSION, path));
  PetscCall(WriteOptions(file, options, path));
  for (PetscInt i = 0; i < n_series; i++) PetscCall(CreateDataset(file, &series[i], path));
  PetscCall(CheckHDF5(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Up to BLOCK records of one series, gathered from the records of all: HDF5 is quick where both sides have the same shape */
static PetscErrorCode WriteRecords(hid_t dataset, const Series *series, PetscInt64 length, PetscInt n, PetscInt width, const PetscReal records[], const char path[])
{
  const PetscInt components = series->components;
  const hsize_t  start[2] = {(hsize_t)length, 0}, count[2] = {(hsize_t)n, (hsize_t)components};
  PetscReal      values[3 * BLOCK];
  hid_t          to, from;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt c = 0; c < components; c++) values[i * components + c] = records[(size_t)i * (size_t)width + (size_t)(series->column + c)];
  to = H5Dget_space(dataset);
  PetscCall(CheckHDF5(H5Sselect_hyperslab(to, H5S_SELECT_SET, start, NULL, count, NULL), "select records", path));
  from = H5Screate_simple(components > 1 ? 2 : 1, count, NULL);
  PetscCall(CheckHDF5(from, "make a data space", path));
  PetscCall(CheckHDF5(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, from, to, H5P_DEFAULT, values), "write records", path));
  PetscCall(CheckHDF5(H5Sclose(from), "close a data space", path));
  PetscCall(CheckHDF5(H5Sclose(to), "close a data space", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AppendToDataset(hid_t file, const Series *series, PetscInt64 length, PetscInt n, PetscInt width, const PetscReal records[], const char path[])
{
  const hsize_t size[2] = {(hsize_t)length + (hsize_t)n, (hsize_t)series->components};
  hid_t         dataset;

  PetscFunctionBegin;
  dataset = H5Dopen2(file, series->name, H5P_DEFAULT);
  PetscCall(CheckHDF5(dataset, "open a dataset", path));
  PetscCall(CheckHDF5(H5Dset_extent(dataset, size), "extend a dataset", path));
  for (PetscInt i = 0; i < n; i += BLOCK) PetscCall(WriteRecords(dataset, series, length + i, PetscMin(BLOCK, n - i), width, records + (size_t)i * (size_t)width, path));
  PetscCall(CheckHDF5(H5Dclose(dataset), "write records", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
  SeriesFileAppend - appends records to all series of a file

  Not Collective

  Input Parameters:
+ path     - the file
. n_series - number of series
. series   - the series that it was created with
. length   - how many records it has
. n        - how many to append
. width    - length of a record
- records  - n records
*/
PetscErrorCode SeriesFileAppend(const char path[], PetscInt n_series, const Series series[], PetscInt64 length, PetscInt n, PetscInt width, const PetscReal records[])
{
  hid_t file;

  PetscFunctionBegin;
  file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  PetscCall(CheckHDF5(file, "open the file", path));
  for (PetscInt i = 0; i < n_series; i++) PetscCall(AppendToDataset(file, &series[i], length, n, width, records, path));
  PetscCall(CheckHDF5(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
