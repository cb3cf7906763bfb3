/* An HDF5 file of fields, written by all ranks. */
#pragma once
#include <impakt/io.h>
#include "fieldsmesh.h"
#include <sys/units.h>

/* The names of frames have four digits, and all datasets of a run are made before its first frame */
#define FIELDS_MAX_FRAMES 10000
#define FIELDS_PER_FRAME  14

/* The fields of contact begin with this one, and are the last */
#define FIELDS_FIRST_OF_CONTACT  FIELDS_CONTACT_FORCE
#define FIELDS_FIRST_OF_FRICTION FIELDS_FRICTION_TRACTION

/* Which fields a frame has: bit k is set for number k of `FieldsKind` */
typedef unsigned FieldsSet;

/* What is written of each frame */
typedef enum {
  FIELDS_DISPLACEMENT,
  FIELDS_VELOCITY,
  FIELDS_STRESS,
  FIELDS_VON_MISES,
  FIELDS_PLASTIC_STRAIN, /* where some body's material flows */
  FIELDS_BLOCK,          /* where some body has several materials */
  FIELDS_CONTACT_FORCE,
  FIELDS_CONTACT_PRESSURE,
  FIELDS_CONTACT_GAP,
  FIELDS_CONTACT_ACTIVE,
  FIELDS_FRICTION_TRACTION, /* with friction, as all that follow */
  FIELDS_CONTACT_SLIDING,
  FIELDS_SLIP_DISTANCE,
  FIELDS_FRICTION_LOSS
} FieldsKind;

typedef struct {
  const char   *name;
  UnitDimension dimension;
  PetscInt      components;
  const char   *attribute_type; /* XDMF's word for what the components are */
  PetscBool     on_cells;       /* a value for each cell; otherwise for each node */
} FieldsField;

PETSC_INTERN const FieldsField fields_of_a_frame[FIELDS_PER_FRAME];

static inline PetscBool FieldsSetHas(FieldsSet set, FieldsKind kind)
{
  return (PetscBool)(set >> kind & 1);
}

PETSC_INTERN PetscInt64     FieldsFileGetSize(const FieldsMesh *, FieldsSet, PetscInt, OutputPrecision);
PETSC_INTERN PetscErrorCode FieldsFileCreate(const char[], const FieldsMesh *, FieldsSet, PetscInt, OutputPrecision, const char[]);
PETSC_INTERN PetscErrorCode FieldsFileAdd(hid_t, const char[], hid_t, hsize_t, PetscInt, UnitDimension, const void *, const char[]);
PETSC_INTERN PetscErrorCode FieldsFileCount(const char[], PetscInt *);
PETSC_INTERN PetscErrorCode FieldsFileCut(const char[], PetscInt, PetscInt, PetscReal[]);
PETSC_INTERN PetscErrorCode FieldsFileOpen(MPI_Comm, const char[], hid_t *);
PETSC_INTERN PetscErrorCode FieldsFileWrite(MPI_Comm, hid_t, const char[], const FieldsRows *, PetscInt, hid_t, const void *);
PETSC_INTERN PetscErrorCode FieldsFileGetDataset(FieldsKind, PetscInt, size_t, char[]);
