/* The XDMF file beside a file of fields. */
#pragma once
#include "fieldsfile.h"
#include "obstaclegrid.h"

#define XDMF_BODIES    ".xdmf"
#define XDMF_OBSTACLES "-obstacles.xdmf"

PETSC_INTERN PetscErrorCode XdmfGetPath(const char[], const char[], size_t, char[]);
PETSC_INTERN PetscErrorCode XdmfCheckPath(MPI_Comm, const char[]);
PETSC_INTERN PetscErrorCode XdmfWrite(const char[], const FieldsMesh *, FieldsSet, OutputPrecision, PetscInt, const PetscReal[]);
PETSC_INTERN PetscErrorCode XdmfWriteObstacles(const char[], PetscInt, const ObstacleGrid[], PetscReal);
