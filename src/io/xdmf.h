/* The XDMF file beside a file of fields. */
#pragma once
#include "fieldsfile.h"

PETSC_INTERN PetscErrorCode XdmfGetPath(const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode XdmfCheckPath(MPI_Comm, const char[]);
PETSC_INTERN PetscErrorCode XdmfWrite(const char[], const FieldsMesh *, FieldsSet, OutputPrecision, PetscInt, const PetscReal[]);
