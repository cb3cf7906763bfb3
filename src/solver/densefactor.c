#include "densefactor.h"
#include <petscblaslapack.h>

/* Of a pivot, in parts of the largest entry of its column */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* Gives the matrix an order, and one block; its entries are undefined afterwards. Room grows by doubling, up to `most`, so that an
   interface whose active rows become more step by step does not allocate in each of them. */
PetscErrorCode DenseFactorResize(DenseFactor *factor, PetscInt n, PetscInt most)
{
  PetscFunctionBegin;
  factor->n        = n;
  factor->factored = PETSC_FALSE;
  if (n > factor->room || !factor->begin) {
    PetscCall(PetscFree4(factor->values, factor->pivots, factor->largest, factor->begin));
    factor->room = PetscMax(n, PetscMin(2 * factor->room, most));
    PetscCall(PetscMalloc4(factor->room * factor->room, &factor->values, factor->room, &factor->pivots, factor->room, &factor->largest,
                           factor->room + 1, &factor->begin));
  }
  PetscCall(DenseFactorSetBlocks(factor, n > 0, &n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The orders of the diagonal blocks, after DenseFactorResize(): entries outside are not looked at */
PetscErrorCode DenseFactorSetBlocks(DenseFactor *factor, PetscInt n_blocks, const PetscInt orders[])
{
  PetscFunctionBegin;
  factor->n_blocks = n_blocks;
  factor->begin[0] = 0;
  for (PetscInt k = 0; k < n_blocks; k++) factor->begin[k + 1] = factor->begin[k] + orders[k];
  PetscCheck(factor->begin[n_blocks] == factor->n, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "Diagonal blocks of %" PetscInt_FMT " rows in all do not make a matrix of order %" PetscInt_FMT, factor->begin[n_blocks],
             factor->n);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest entry of each column, without sign: what its pivot is measured by */
static void FindLargest(DenseFactor *factor)
{
  for (PetscInt k = 0; k < factor->n_blocks; k++)
    for (PetscInt j = factor->begin[k]; j < factor->begin[k + 1]; j++) {
      factor->largest[j] = 0;
      for (PetscInt i = factor->begin[k]; i < factor->begin[k + 1]; i++)
        factor->largest[j] = PetscMax(factor->largest[j], PetscAbsScalar(factor->values[j * factor->n + i]));
    }
}

/* Whether a pivot is no more than the round-off of its column: of rows that depend on each other some pivot is zero but for that. Entries
   that are not numbers are not singular: the step in which they come about fails by itself. */
static PetscBool HasNoPivot(const DenseFactor *factor)
{
  for (PetscInt j = 0; j < factor->n; j++)
    if (PetscAbsScalar(factor->values[j * factor->n + j]) <= ROUND_OFF * factor->largest[j]) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The first entry of a diagonal block, whose columns have as many entries as those of the matrix; and its order */
static PetscScalar *GetBlock(const DenseFactor *factor, PetscInt k, PetscBLASInt *order)
{
  *order = (PetscBLASInt)(factor->begin[k + 1] - factor->begin[k]);
  return factor->values + factor->begin[k] * (factor->n + 1);
}

/* Replaces the matrix by its LU factors; `singular`: it has none */
PetscErrorCode DenseFactorCompute(DenseFactor *factor, PetscBool *singular)
{
  PetscBLASInt leading;

  PetscFunctionBegin;
  *singular = PETSC_FALSE;
  PetscCall(PetscBLASIntCast(factor->n, &leading));
  FindLargest(factor);
  for (PetscInt k = 0; k < factor->n_blocks; k++) {
    PetscBLASInt n, info = 0;
    PetscScalar *block = GetBlock(factor, k, &n);

    if (n == 1) info = block[0] == 0 || PetscIsInfOrNanScalar(block[0]);
    else if (n) PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, block, &leading, factor->pivots + factor->begin[k], &info));
    PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK getrf info %d", (int)info);
    if (info > 0) *singular = PETSC_TRUE;
    PetscCall(PetscLogFlops(DenseFactorFlops(n)));
  }
  if (HasNoPivot(factor)) *singular = PETSC_TRUE;
  factor->factored = (PetscBool) !*singular;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} x */
PetscErrorCode DenseFactorSolve(const DenseFactor *factor, PetscScalar x[])
{
  PetscBLASInt leading, one = 1, info;

  PetscFunctionBegin;
  PetscCheck(factor->factored || !factor->n, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "Call DenseFactorCompute() first");
  PetscCall(PetscBLASIntCast(factor->n, &leading));
  for (PetscInt k = 0; k < factor->n_blocks; k++) {
    PetscBLASInt n;
    PetscScalar *block = GetBlock(factor, k, &n), *of = x + factor->begin[k];

    if (n == 1) of[0] /= block[0];
    else if (n)
      PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, block, &leading, factor->pivots + factor->begin[k], of, &n, &info));
    PetscCall(PetscLogFlops(2.0 * n * n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint, factors and all; `most` as in DenseFactorResize() */
PetscErrorCode DenseFactorVisit(DenseFactor *factor, PetscInt most, Checkpoint checkpoint)
{
  PetscInt sizes[3] = {factor->n, factor->factored, factor->n_blocks};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "factor", 3, sizes));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(DenseFactorResize(factor, sizes[0], most));
    factor->factored = (PetscBool)sizes[1];
    factor->n_blocks = sizes[2];
  }
  if (!factor->factored) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitInts(checkpoint, "factor blocks", factor->n_blocks + 1, factor->begin));
  PetscCall(CheckpointVisitReals(checkpoint, "factor values", factor->n * factor->n, factor->values));
  PetscCall(CheckpointVisitBytes(checkpoint, "factor pivots", (size_t)factor->n * sizeof(*factor->pivots), factor->pivots));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DenseFactorDestroy(DenseFactor *factor)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(factor->values, factor->pivots, factor->largest, factor->begin));
  factor->n = factor->room = factor->n_blocks = 0;
  factor->factored                            = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += scale A x, A being n by n with `leading` entries from one column to the next */
PetscErrorCode DenseMultiplyAdd(PetscInt n, PetscInt leading, const PetscScalar A[], PetscReal scale, const PetscScalar x[],
                                PetscScalar y[])
{
  PetscBLASInt order, lda, one = 1;
  PetscScalar  alpha = scale, beta = 1;

  PetscFunctionBegin;
  if (!n) PetscFunctionReturn(PETSC_SUCCESS); /* BLAS refuses matrices without rows */
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(leading, &lda));
  PetscCallBLAS("BLASgemv", BLASgemv_("N", &order, &order, &alpha, A, &lda, x, &one, &beta, y, &one));
  PetscCall(PetscLogFlops(2.0 * n * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Operations that factoring a matrix of that order takes */
PetscLogDouble DenseFactorFlops(PetscInt n)
{
  return 2.0 / 3.0 * n * n * n;
}
