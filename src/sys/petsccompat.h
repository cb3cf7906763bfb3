/* What differs between the PETSc versions that Impakt builds with, in one place. */
#pragma once
#include <petscversion.h>

#if PETSC_VERSION_LT(3, 21, 0)
#  error "Impakt needs PETSc 3.21 or newer (TSAlpha2SetPredictor)"
#endif

/* in setters: leave it as it is */
#if !defined(PETSC_CURRENT)
#  define PETSC_CURRENT PETSC_DEFAULT
#endif

/* the full step, without a search */
#if PETSC_VERSION_LT(3, 26, 0)
#  define LINESEARCH_FULL_STEP SNESLINESEARCHBASIC
#else
#  define LINESEARCH_FULL_STEP SNESLINESEARCHNONE
#endif

/* steps of the length that makes the residual least */
#if PETSC_VERSION_LT(3, 24, 0)
#  define LINESEARCH_LEAST_RESIDUAL SNESLINESEARCHL2
#else
#  define LINESEARCH_LEAST_RESIDUAL SNESLINESEARCHSECANT
#endif

#if PETSC_VERSION_LT(3, 25, 0)
#  define SNES_DIVERGED_NAN SNES_DIVERGED_FNORM_NAN
#else
#  define SNES_DIVERGED_NAN SNES_DIVERGED_FUNCTION_NANORINF
#endif

/* the two arguments of DMPlexCreateBoxMesh() for the coordinates of periodic meshes */
#if PETSC_VERSION_LT(3, 22, 0)
#  define BOX_NOT_PERIODIC
#else
#  define BOX_NOT_PERIODIC 0, PETSC_TRUE,
#endif

/* how PetscSFGetRootRanks() and PetscSFGetLeafRanks() count ranks */
#if PETSC_VERSION_LT(3, 23, 0)
#  define SF_RANK_COUNT PetscInt
#else
#  define SF_RANK_COUNT PetscMPIInt
#endif
