/* An HDF5 file of fields. The first rank makes all of it before the first frame: groups, attributes, and a dataset for each field of each
   frame, which has its place in the file but no numbers yet (a hole, on most file systems). After that only numbers are written. So a run
   that is killed, even in the middle of a frame, leaves a file that can be read, and no frame waits for a flush. */
#include "fieldsfile.h"
#include "hdf5file.h"
#include <math.h>

const FieldsField fields_of_a_frame[FIELDS_PER_FRAME] = {
    {"displacement", UNIT_LENGTH, 3, "Vector", PETSC_FALSE},
    {"velocity", UNIT_VELOCITY, 3, "Vector", PETSC_FALSE},
    /* all nine components: with six, ParaView's readers differ in their order */
    {"stress", UNIT_STRESS, 9, "Tensor", PETSC_TRUE},
    {"von_mises", UNIT_STRESS, 1, "Scalar", PETSC_TRUE},
    {"plastic_strain", UNIT_ONE, 1, "Scalar", PETSC_TRUE},
    {"block", UNIT_ONE, 1, "Scalar", PETSC_TRUE},
    {"contact_force", UNIT_FORCE, 3, "Vector", PETSC_FALSE},
    {"contact_pressure", UNIT_STRESS, 1, "Scalar", PETSC_FALSE},
    {"contact_gap", UNIT_LENGTH, 1, "Scalar", PETSC_FALSE},
    {"contact_active", UNIT_ONE, 1, "Scalar", PETSC_FALSE},
    {"friction_traction", UNIT_STRESS, 3, "Vector", PETSC_FALSE},
    {"contact_sliding", UNIT_ONE, 1, "Scalar", PETSC_FALSE},
    {"slip_distance", UNIT_LENGTH, 1, "Scalar", PETSC_FALSE},
    {"friction_loss", UNIT_ENERGY_ON_AREA, 1, "Scalar", PETSC_FALSE},
};

const char *const OutputPrecisions[] = {"single", "double", "OutputPrecision", "OUTPUT_", NULL};

/* Bytes of all frames and of the mesh, without HDF5's own few */
PetscInt64 FieldsFileGetSize(const FieldsMesh *mesh, FieldsSet set, PetscInt n_frames, OutputPrecision precision)
{
  hsize_t numbers = 0;

  for (FieldsKind i = 0; i < FIELDS_PER_FRAME; i++)
    numbers += (hsize_t)FieldsSetHas(set, i) * (hsize_t)fields_of_a_frame[i].components *
               (fields_of_a_frame[i].on_cells ? mesh->cells : mesh->nodes).total;
  return (PetscInt64)(numbers * (hsize_t)n_frames * (precision == OUTPUT_DOUBLE ? sizeof(double) : sizeof(float)) +
                      mesh->nodes.total * 3 * sizeof(double) +
                      (mesh->topology.total * (hsize_t)mesh->cell_nodes + 2 * mesh->cells.total) * sizeof(int));
}

/* FieldsFileGetDataset - the name of a field of a frame in the file */
PetscErrorCode FieldsFileGetDataset(FieldsKind field, PetscInt frame, size_t size, char name[])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, size, "/%s/%04" PetscInt_FMT, fields_of_a_frame[field].name, frame));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a dataset, with its place in the file. It is closed again if `dataset` is NULL. */
static PetscErrorCode CreateDataset(hid_t file, const char name[], hid_t type, hsize_t rows, PetscInt components, UnitDimension dimension,
                                    Units units, const char path[], hid_t *dataset)
{
  const hsize_t size[2] = {rows, (hsize_t)components};
  const hid_t   layout  = H5Pcreate(H5P_DATASET_CREATE);
  hid_t         created;

  PetscFunctionBegin;
  PetscCall(HDF5Check(H5Pset_alloc_time(layout, H5D_ALLOC_TIME_EARLY), "place a dataset", path));
  PetscCall(HDF5Check(H5Pset_fill_time(layout, H5D_FILL_TIME_NEVER), "place a dataset", path));
  PetscCall(HDF5Check(H5Pset_obj_track_times(layout, 0), "place a dataset", path));
  PetscCall(HDF5CreateDataset(file, name, type, components > 1 ? 2 : 1, size, NULL, layout, path, &created));
  PetscCall(HDF5WriteText(created, "units", UnitsLabel(units, dimension), PETSC_TRUE, path));
  if (dataset) *dataset = created;
  else PetscCall(HDF5Check(H5Dclose(created), "create a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FieldsFileAdd - makes a dataset with its numbers, of a type that is the same in memory and in the file; one rank calls it */
PetscErrorCode FieldsFileAdd(hid_t file, const char name[], hid_t type, hsize_t rows, PetscInt components, UnitDimension dimension,
                             const void *values, const char path[])
{
  hid_t dataset;
  Units units;

  PetscFunctionBegin;
  PetscCall(UnitsGet(NULL, &units));
  PetscCall(CreateDataset(file, name, type, rows, components, dimension, units, path, &dataset));
  PetscCall(HDF5Check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write a dataset", path));
  PetscCall(HDF5Check(H5Dclose(dataset), "write a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the dataset of times, which are not-a-number until their frames are in the file */
static PetscErrorCode CreateTimes(hid_t file, PetscInt n_frames, const char path[])
{
  double *times;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n_frames, &times));
  for (PetscInt i = 0; i < n_frames; i++) times[i] = NAN;
  PetscCall(FieldsFileAdd(file, "time", H5T_NATIVE_DOUBLE, (hsize_t)n_frames, 1, UNIT_TIME, times, path));
  PetscCall(PetscFree(times));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateMesh(hid_t file, const FieldsMesh *mesh, Units units, const char path[])
{
  const char *name;
  size_t      size = 1, used = 0;
  char       *names;
  hid_t       dataset;

  PetscFunctionBegin;
  PetscCall(CreateDataset(file, "mesh/positions", H5T_IEEE_F64LE, mesh->nodes.total, 3, UNIT_LENGTH, units, path, NULL));
  PetscCall(CreateDataset(file, "mesh/cells", H5T_STD_I32LE, mesh->topology.total, mesh->cell_nodes, UNIT_ONE, units, path, NULL));
  PetscCall(CreateDataset(file, "mesh/rank", H5T_STD_I32LE, mesh->cells.total, 1, UNIT_ONE, units, path, NULL));
  PetscCall(CreateDataset(file, "mesh/body", H5T_STD_I32LE, mesh->cells.total, 1, UNIT_ONE, units, path, &dataset));
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    size_t length;

    PetscCall(PetscObjectGetName((PetscObject)mesh->bodies[b], &name));
    PetscCall(PetscStrlen(name, &length));
    size += length + 1;
  }
  PetscCall(PetscCalloc1(size, &names));
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    size_t length;

    PetscCall(PetscObjectGetName((PetscObject)mesh->bodies[b], &name));
    PetscCall(PetscSNPrintfCount(names + used, size - used, "%s%s", &length, b ? "," : "", name));
    used += length - 1; /* counted with the end of the text */
  }
  PetscCall(HDF5WriteText(dataset, "names", names, PETSC_FALSE, path));
  PetscCall(PetscFree(names));
  PetscCall(HDF5Check(H5Dclose(dataset), "create a dataset", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a file with a place for everything. One rank calls it. */
PetscErrorCode FieldsFileCreate(const char path[], const FieldsMesh *mesh, FieldsSet set, PetscInt n_frames, OutputPrecision precision,
                                const char options[])
{
  const hid_t type = precision == OUTPUT_DOUBLE ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  char        name[64];
  hid_t       file;
  Units       units;

  PetscFunctionBegin;
  PetscCall(UnitsGet(NULL, &units));
  PetscCall(HDF5Create(path, &file));
  PetscCall(HDF5WriteRun(file, options, path));
  PetscCall(CreateMesh(file, mesh, units, path));
  PetscCall(CreateTimes(file, n_frames, path));
  for (FieldsKind i = 0; i < FIELDS_PER_FRAME; i++) {
    const FieldsField *field = &fields_of_a_frame[i];

    if (!FieldsSetHas(set, i)) continue;
    for (PetscInt k = 0; k < n_frames; k++) {
      PetscCall(FieldsFileGetDataset(i, k, sizeof(name), name));
      PetscCall(CreateDataset(file, name, type, (field->on_cells ? mesh->cells : mesh->nodes).total, field->components, field->dimension,
                              units, path, NULL));
    }
  }
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many frames a file has places for; 0 where there is no file of fields. One rank calls it. */
PetscErrorCode FieldsFileCount(const char path[], PetscInt *n_frames)
{
  HDF5Silence silence;
  hsize_t     has = 0;
  hid_t       file, dataset, space;

  PetscFunctionBegin;
  HDF5SilenceBegin(&silence);
  file    = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  dataset = file < 0 ? -1 : H5Dopen2(file, "time", H5P_DEFAULT);
  space   = dataset < 0 ? -1 : H5Dget_space(dataset);
  if (space >= 0 && H5Sget_simple_extent_ndims(space) == 1) H5Sget_simple_extent_dims(space, &has, NULL);
  if (space >= 0) H5Sclose(space);
  if (dataset >= 0) H5Dclose(dataset);
  if (file >= 0) H5Fclose(file);
  HDF5SilenceEnd(&silence);
  *n_frames = (PetscInt)has;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaves the first frames of a file, and has the others count as not there yet. `n_frames`: that the file has places for; `written`: how
   many stay, an error if there are fewer; `times`: theirs, and not-a-number for the others [s]; n_frames numbers. One rank calls it. */
PetscErrorCode FieldsFileCut(const char path[], PetscInt n_frames, PetscInt written, PetscReal times[])
{
  hsize_t  has = 0;
  PetscInt n   = 0;
  hid_t    file, dataset, space;

  PetscFunctionBegin;
  file    = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  dataset = file < 0 ? -1 : H5Dopen2(file, "time", H5P_DEFAULT);
  space   = dataset < 0 ? -1 : H5Dget_space(dataset);
  if (space >= 0 && H5Sget_simple_extent_ndims(space) == 1) H5Sget_simple_extent_dims(space, &has, NULL);
  if (has == (hsize_t)n_frames && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times) >= 0)
    while (n < n_frames && !isnan(times[n])) n++;
  PetscCheck(
      n >= written, PETSC_COMM_SELF, PETSC_ERR_FILE_UNEXPECTED,
      "-output_fields %s has not the %" PetscInt_FMT
      " frames that the run which is continued has written: it is gone, or another run's; bring it back, or give another path, where "
      "the fields begin with the restart",
      path, written);
  for (PetscInt k = written; k < n_frames; k++) times[k] = NAN;
  PetscCall(HDF5Check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times), "write times", path));
  PetscCall(HDF5Check(H5Sclose(space), "close a data space", path));
  PetscCall(HDF5Check(H5Dclose(dataset), "write times", path));
  PetscCall(HDF5Check(H5Fclose(file), "write the last bytes", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Opens a file for writing by all ranks. Collective */
PetscErrorCode FieldsFileOpen(MPI_Comm comm, const char path[], hid_t *file)
{
  int   opened;
  hid_t access;

  PetscFunctionBegin;
  access = H5Pcreate(H5P_FILE_ACCESS);
  opened = H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL) >= 0 && H5Pset_all_coll_metadata_ops(access, 1) >= 0 &&
           (*file = H5Fopen(path, H5F_ACC_RDWR, access)) >= 0;
  if (access >= 0) H5Pclose(access);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &opened, 1, MPI_INT, MPI_MIN, comm));
  PetscCheck(opened, comm, PETSC_ERR_FILE_OPEN,
             "HDF5 cannot open %s for all ranks; -output_fields needs a file system that all of them see, and MPI-IO on it", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Selects the rows of this rank in the file; returns what HDF5 returned, negative after an error */
static herr_t SelectRows(hid_t space, const FieldsRows *rows, PetscInt components)
{
  herr_t result = H5Sselect_none(space);

  for (PetscInt i = 0; i < rows->n && result >= 0; i++) {
    const hsize_t start[2] = {rows->begin[i], 0}, count[2] = {rows->count[i], (hsize_t)components};

    if (rows->count[i]) result = H5Sselect_hyperslab(space, H5S_SELECT_OR, start, NULL, count, NULL);
  }
  return result;
}

static herr_t WriteRows(hid_t file, const char name[], const FieldsRows *rows, PetscInt components, hid_t type, const void *values)
{
  const hsize_t length  = rows->local * (hsize_t)components;
  const hid_t   dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset), memory = H5Screate_simple(1, &length, NULL),
                transfer = H5Pcreate(H5P_DATASET_XFER);
  herr_t        result   = -1;

  if (dataset >= 0 && space >= 0 && memory >= 0 && transfer >= 0) result = SelectRows(space, rows, components);
  if (result >= 0 && !length) result = H5Sselect_none(memory);
  if (result >= 0) result = H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  if (result >= 0) result = H5Dwrite(dataset, type, memory, space, transfer, values);
  if (transfer >= 0) H5Pclose(transfer);
  if (memory >= 0) H5Sclose(memory);
  if (space >= 0) H5Sclose(space);
  if (dataset >= 0 && H5Dclose(dataset) < 0) result = -1;
  return result;
}

/* Writes this rank's rows of a dataset. Collective; an error on any rank becomes an error on all */
PetscErrorCode FieldsFileWrite(MPI_Comm comm, hid_t file, const char name[], const FieldsRows *rows, PetscInt components, hid_t type,
                               const void *values)
{
  int result;

  PetscFunctionBegin;
  result = WriteRows(file, name, rows, components, type, values) < 0 ? -1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &result, 1, MPI_INT, MPI_MIN, comm));
  PetscCheck(!result, comm, PETSC_ERR_FILE_WRITE,
             "The dataset %s of -output_fields cannot be written; is the disk full? The frames before this one are whole", name);
  PetscFunctionReturn(PETSC_SUCCESS);
}
