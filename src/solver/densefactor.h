/* LU factors of a dense matrix, the same on every rank: the one place where Impakt calls LAPACK for the matrices of an interface. */
#pragma once
#include <petscsys.h>
#include <checkpoint/checkpoint.h>

/* A matrix of order `n` by columns, without gaps between them; from DenseFactorCompute() on, its factors. It may have diagonal blocks,
   outside which its entries are zero: each is factored by itself. */
typedef struct {
  PetscInt      n, room;          /* order; the largest order that there is room for */
  PetscInt      n_blocks, *begin; /* where each diagonal block begins, and where the last ends */
  PetscBool     factored;
  PetscScalar  *values;
  PetscBLASInt *pivots;
  PetscReal    *largest; /* work space: of each column */
} DenseFactor;

PETSC_INTERN PetscErrorCode DenseFactorResize(DenseFactor *, PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode DenseFactorSetBlocks(DenseFactor *, PetscInt, const PetscInt[]);
PETSC_INTERN PetscErrorCode DenseFactorCompute(DenseFactor *, PetscBool *);
PETSC_INTERN PetscErrorCode DenseFactorSolve(const DenseFactor *, PetscScalar[]);
PETSC_INTERN PetscErrorCode DenseFactorVisit(DenseFactor *, PetscInt, Checkpoint);
PETSC_INTERN PetscErrorCode DenseFactorDestroy(DenseFactor *);
PETSC_INTERN PetscErrorCode DenseMultiplyAdd(PetscInt, PetscInt, const PetscScalar[], PetscReal, const PetscScalar[], PetscScalar[]);
PETSC_INTERN PetscLogDouble DenseFactorFlops(PetscInt);
