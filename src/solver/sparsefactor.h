/* Factors of a sparse symmetric positive definite matrix, the same on every rank: PETSc's Cholesky factors, by nested dissection. */
#pragma once
#include <petscmat.h>

/* All zero before the first use */
typedef struct {
  PetscInt  n;      /* order */
  Mat       factor; /* of the matrix scaled so that its diagonal is one */
  Vec       scale, x;
  PetscBool factored;
} SparseFactor;

PETSC_INTERN PetscErrorCode SparseFactorCompute(SparseFactor *, Mat, PetscBool *);
PETSC_INTERN PetscErrorCode SparseFactorSolve(const SparseFactor *, PetscScalar[]);
PETSC_INTERN PetscErrorCode SparseFactorDestroy(SparseFactor *);
PETSC_INTERN PetscLogDouble SparseFactorFlops(PetscInt, PetscLogDouble);
