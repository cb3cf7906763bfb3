/* An HDF5 file of time series that all have the same length. */
#pragma once
#include <petscsys.h>

/* One dataset. Series lie side by side in records of `PetscReal`, one record for each time. */
typedef struct {
  char        name[256]; /* its path in the file */
  const char *units;
  PetscInt    column;     /* where it begins in a record */
  PetscInt    components; /* 1: dataset of shape (n); more: (n, components) */
  PetscBool   integer;    /* stored as a whole number */
} Series;

PETSC_INTERN PetscErrorCode SeriesFileCreate(const char[], PetscInt, const Series[], const char[]);
PETSC_INTERN PetscErrorCode SeriesFileAppend(const char[], PetscInt, const Series[], PetscInt64, PetscInt, PetscInt, const PetscReal[]);
PETSC_INTERN PetscErrorCode SeriesFileCut(const char[], PetscInt, const Series[], PetscInt64);
