/* What HDF5 files of a run have in common: how errors are told, and attributes that tell how the run was made. */
#pragma once
#include <petscsys.h>
#include <hdf5.h>

/* How HDF5 printed errors before HDF5SilenceBegin() */
typedef struct {
  H5E_auto2_t print;
  void       *data;
} HDF5Silence;

PETSC_INTERN PetscErrorCode HDF5Check(hid_t, const char[], const char[]);
PETSC_INTERN PetscErrorCode HDF5Create(const char[], hid_t *);
PETSC_INTERN PetscErrorCode HDF5CreateDataset(hid_t, const char[], hid_t, int, const hsize_t[], const hsize_t[], hid_t, const char[],
                                              hid_t *);
PETSC_INTERN PetscErrorCode HDF5WriteText(hid_t, const char[], const char[], PetscBool, const char[]);
PETSC_INTERN PetscErrorCode HDF5WriteRun(hid_t, const char[], const char[]);
PETSC_INTERN void           HDF5SilenceBegin(HDF5Silence *);
PETSC_INTERN void           HDF5SilenceEnd(const HDF5Silence *);
