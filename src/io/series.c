/* Time series in HDF5: extensible datasets, to which records are appended. Functions are not collective: one rank calls them. */
#include "series.h"
#include "hdf5file.h"
#include <stdint.h>

_Static_assert(sizeof(PetscReal) == sizeof(double), "series are stored in double precision");

/* Records in a chunk: few enough for small files of short runs, enough for a small index of long ones. Every series takes a chunk for its
   first record, so chunks have fewer records where there are many series: all series together take about CHUNK_BYTES then. */
#define CHUNK_MOST  1024
#define CHUNK_LEAST 64
#define CHUNK_BYTES ((size_t)1 << 24)

/* Records of a series that are written at a time, and most components of one */
#define BLOCK           2048
#define MOST_COMPONENTS 6

/* Records in a chunk of each series: a power of two */
static hsize_t ChunkRecords(PetscInt n_series, const Series series[])
{
  size_t  record = 0; /* bytes of one record of all series */
  hsize_t chunk  = CHUNK_MOST;

  for (PetscInt i = 0; i < n_series; i++) record += (size_t)series[i].components * (series[i].integer ? sizeof(int32_t) : sizeof(double));
  while (chunk > CHUNK_LEAST && chunk * record > CHUNK_BYTES) chunk /= 2;
  return chunk;
}

static PetscErrorCode CreateDataset(hid_t file, const Series *series, hsize_t records, const char path[])
{
  const int     rank       = series->components > 1 ? 2 : 1;
  const hsize_t size[2]    = {0, (hsize_t)series->components};
  const hsize_t maximum[2] = {H5S_UNLIMITED, (hsize_t)series->components};
  const hsize_t chunk[2]   = {records, (hsize_t)series->components};
  const hid_t   layout     = H5Pcreate(H5P_DATASET_CREATE);
  hid_t         dataset;

  PetscFunctionBegin;
  PetscCall(HDF5Check(H5Pset_chunk(layout, rank, chunk), "make chunks", path));
  PetscCall(
      HDF5CreateDataset(file, series->name, series->integer ? H5T_STD_I32LE : H5T_IEEE_F64LE, rank, size, maximum, layout, path, &dataset));
  PetscCall(HDF5WriteText(dataset, "units", series->units, PETSC_FALSE, path));
  PetscCall(HDF5Check(H5Dclose(dataset), "create a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesFileCreate(const char path[], PetscInt n_series, const Series series[], const char options[])
{
  const hsize_t records = ChunkRecords(n_series, series);
  hid_t         file;

  PetscFunctionBegin;
  PetscCall(HDF5Create(path, &file));
  PetscCall(HDF5WriteRun(file, options, path));
  for (PetscInt i = 0; i < n_series; i++) PetscCall(CreateDataset(file, &series[i], records, path));
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes at most BLOCK records of one series, gathered from all series: HDF5 is quick if memory and file have one shape */
static PetscErrorCode WriteRecords(hid_t dataset, const Series *series, PetscInt64 length, PetscInt n, PetscInt width,
                                   const PetscReal records[], const char path[])
{
  const PetscInt components = series->components;
  const hsize_t  start[2] = {(hsize_t)length, 0}, count[2] = {(hsize_t)n, (hsize_t)components};
  PetscReal      values[MOST_COMPONENTS * BLOCK];
  hid_t          to, from;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt c = 0; c < components; c++)
      values[i * components + c] = records[(size_t)i * (size_t)width + (size_t)(series->column + c)];
  to = H5Dget_space(dataset);
  PetscCall(HDF5Check(H5Sselect_hyperslab(to, H5S_SELECT_SET, start, NULL, count, NULL), "select records", path));
  from = H5Screate_simple(components > 1 ? 2 : 1, count, NULL);
  PetscCall(HDF5Check(from, "make a data space", path));
  PetscCall(HDF5Check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, from, to, H5P_DEFAULT, values), "write records", path));
  PetscCall(HDF5Check(H5Sclose(from), "close a data space", path));
  PetscCall(HDF5Check(H5Sclose(to), "close a data space", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AppendToDataset(hid_t file, const Series *series, PetscInt64 length, PetscInt n, PetscInt width,
                                      const PetscReal records[], const char path[])
{
  const hsize_t size[2] = {(hsize_t)length + (hsize_t)n, (hsize_t)series->components};
  hid_t         dataset;

  PetscFunctionBegin;
  dataset = H5Dopen2(file, series->name, H5P_DEFAULT);
  PetscCall(HDF5Check(dataset, "open a dataset", path));
  PetscCall(HDF5Check(H5Dset_extent(dataset, size), "extend a dataset", path));
  for (PetscInt i = 0; i < n; i += BLOCK)
    PetscCall(WriteRecords(dataset, series, length + i, PetscMin(BLOCK, n - i), width, records + (size_t)i * (size_t)width, path));
  PetscCall(HDF5Check(H5Dclose(dataset), "write records", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesFileAppend(const char path[], PetscInt n_series, const Series series[], PetscInt64 length, PetscInt n, PetscInt width,
                                const PetscReal records[])
{
  hid_t file;

  PetscFunctionBegin;
  file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  PetscCall(HDF5Check(file, "open the file", path));
  for (PetscInt i = 0; i < n_series; i++) PetscCall(AppendToDataset(file, &series[i], length, n, width, records, path));
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cuts off what a dataset has beyond so many records */
static PetscErrorCode CutDataset(hid_t file, const Series *series, PetscInt64 length, const char path[])
{
  const hsize_t size[2] = {(hsize_t)length, (hsize_t)series->components};
  hsize_t       has[2]  = {0, 0};
  hid_t         dataset, space;

  PetscFunctionBegin;
  dataset = H5Dopen2(file, series->name, H5P_DEFAULT);
  PetscCheck(dataset >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED, "%s has no %s: it is not the history of the run that is continued",
             path, series->name);
  space = H5Dget_space(dataset);
  PetscCheck(H5Sget_simple_extent_ndims(space) == (series->components > 1 ? 2 : 1) && H5Sget_simple_extent_dims(space, has, NULL) > 0 &&
                 has[0] >= size[0] && (series->components == 1 || has[1] == size[1]),
             PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
             "%s has %llu records of %s and the run that is continued has written %lld: it is another run's, or was replaced", path,
             (unsigned long long)has[0], series->name, (long long)length);
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", path));
  PetscCall(HDF5Check(H5Dset_extent(dataset, size), "cut a dataset", path));
  PetscCall(HDF5Check(H5Dclose(dataset), "cut a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cuts off what the series of a file have beyond so many records */
PetscErrorCode SeriesFileCut(const char path[], PetscInt n_series, const Series series[], PetscInt64 length)
{
  hid_t file;

  PetscFunctionBegin;
  file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  PetscCheck(file >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED, "%s is not an HDF5 file that can be continued", path);
  for (PetscInt i = 0; i < n_series; i++) PetscCall(CutDataset(file, &series[i], length, path));
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
