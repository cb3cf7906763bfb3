/* LU factors of a dense matrix, the same on every rank: the one place where Impakt calls LAPACK for the matrices of an interface. */
#pragma once
#include <petscsys.h>
#include <checkpoint/checkpoint.h>

/* A matrix of order `n` by columns, without gaps between them; from DenseFactorCompute() on, its factors. It may have diagonal blocks,
   outside which its entries are zero: they are kept one after the other, and each is factored by itself. */
typedef struct {
  PetscInt      n, room;          /* order; what order or number of blocks there is room for */
  PetscInt      size;             /* entries that there is room for */
  PetscInt      n_blocks, *begin; /* where each diagonal block begins among the rows, and where the last ends */
  PetscInt     *at;               /* the same among the values */
  PetscBool     factored;
  PetscScalar  *values;
  PetscBLASInt *pivots;
  PetscReal    *largest; /* work space: of each column of a block */
} DenseFactor;

PETSC_INTERN PetscErrorCode DenseFactorResize(DenseFactor *, PetscInt, PetscInt);
PETSC_INTERN PetscErrorCode DenseFactorResizeBlocks(DenseFactor *, PetscInt, const PetscInt[], PetscInt);
PETSC_INTERN PetscScalar   *DenseFactorGetBlock(const DenseFactor *, PetscInt, PetscInt *);
PETSC_INTERN PetscErrorCode DenseFactorCompute(DenseFactor *, PetscBool *);
PETSC_INTERN PetscErrorCode DenseFactorSolve(const DenseFactor *, PetscScalar[]);
PETSC_INTERN PetscErrorCode DenseFactorVisit(DenseFactor *, PetscInt, Checkpoint);
PETSC_INTERN PetscErrorCode DenseFactorDestroy(DenseFactor *);
PETSC_INTERN PetscLogDouble DenseFactorFlops(PetscInt);
