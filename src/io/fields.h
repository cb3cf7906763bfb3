/* The fields of all bodies over time. */
#pragma once
#include <checkpoint/checkpoint.h>
#include <impakt/controller.h>
#include "fieldsfile.h"

typedef struct _n_Fields *Fields;

PETSC_INTERN PetscErrorCode      FieldsCreate(Controller, const char[], PetscInt *, OutputPrecision, Fields *);
PETSC_INTERN void                FieldsKeepFirst(Fields);
PETSC_INTERN ControllerMonitorFn FieldsMonitor;
PETSC_INTERN PetscErrorCode      FieldsFinish(Fields);
PETSC_INTERN PetscErrorCode      FieldsDestroy(Fields *);
PETSC_INTERN PetscErrorCode      FieldsSync(Fields);
PETSC_INTERN PetscErrorCode      FieldsVisit(Fields, MPI_Comm, PetscBool, Checkpoint);
PETSC_INTERN PetscErrorCode      FieldsTakeUp(Fields);
