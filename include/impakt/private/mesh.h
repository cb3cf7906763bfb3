/* Meshes from options: boxes, Gmsh and Exodus II files, distributed over the ranks; their surfaces and node sets by name. */
#pragma once
#include <petscdmplex.h>

PETSC_EXTERN PetscErrorCode MeshCreate(MPI_Comm, const char[], const char[], DM *);
PETSC_EXTERN PetscErrorCode MeshCreateOnRanks(MPI_Comm, const char[], const char[], PetscMPIInt, const PetscMPIInt[], DM *);
PETSC_EXTERN PetscErrorCode MeshEstimate(const char[], PetscInt *, PetscReal[3]);
PETSC_EXTERN PetscErrorCode MeshGetPlaceOption(const char[], const char *[], const char *[]);
PETSC_EXTERN PetscErrorCode MeshBisect(PetscInt, const PetscReal[], const PetscReal[], const PetscReal[], PetscInt, PetscInt[], PetscMPIInt,
                                       PetscMPIInt, PetscInt[]);
PETSC_EXTERN PetscErrorCode MeshMayBeWhole(MPI_Comm, const char[], PetscBool *, PetscBool *);
PETSC_EXTERN PetscErrorCode MeshCreateComposite(DM, DM *);
PETSC_EXTERN PetscErrorCode MeshIsComposite(DM, PetscBool *);
PETSC_EXTERN PetscErrorCode MeshGetSurface(DM, const char[], PetscInt *, PetscInt **);
PETSC_EXTERN PetscErrorCode MeshGetBlock(DM, const char[], PetscInt *, PetscInt **);
PETSC_EXTERN PetscErrorCode MeshHasBlock(DM, const char[], PetscBool *);
PETSC_EXTERN PetscErrorCode MeshListBlocks(DM, char[], size_t);
PETSC_EXTERN PetscErrorCode MeshGetAxisTolerance(DM, PetscReal *);
PETSC_EXTERN PetscErrorCode MeshGetNodeSet(DM, const char[], PetscInt *, PetscInt **);
