#include "densefactor.h"
#include <petscblaslapack.h>

/* Of a pivot, in parts of the largest entry of its column */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* Gives the matrix an order; its entries are undefined afterwards. Room grows by doubling, up to `most`, so that an interface whose active
   rows become more step by step does not allocate in each of them. */
PetscErrorCode DenseFactorResize(DenseFactor *factor, PetscInt n, PetscInt most)
{
  PetscFunctionBegin;
  factor->n        = n;
  factor->factored = PETSC_FALSE;
  if (n <= factor->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3(factor->values, factor->pivots, factor->largest));
  factor->room = PetscMax(n, PetscMin(2 * factor->room, most));
  PetscCall(PetscMalloc3(factor->room * factor->room, &factor->values, factor->room, &factor->pivots, factor->room, &factor->largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest entry of each column, without sign: what its pivot is measured by */
static void FindLargest(DenseFactor *factor)
{
  for (PetscInt j = 0; j < factor->n; j++) {
    factor->largest[j] = 0;
    for (PetscInt i = 0; i < factor->n; i++)
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

/* Replaces the matrix by its LU factors; `singular`: it has none */
PetscErrorCode DenseFactorCompute(DenseFactor *factor, PetscBool *singular)
{
  PetscBLASInt n, info = 0;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(factor->n, &n));
  FindLargest(factor);
  if (n == 1) info = factor->values[0] == 0 || PetscIsInfOrNanScalar(factor->values[0]);
  else if (n) PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, factor->values, &n, factor->pivots, &info));
  PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK getrf info %d", (int)info);
  PetscCall(PetscLogFlops(DenseFactorFlops(factor->n)));
  *singular        = (PetscBool)(info > 0 || HasNoPivot(factor));
  factor->factored = (PetscBool) !*singular;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} x */
PetscErrorCode DenseFactorSolve(const DenseFactor *factor, PetscScalar x[])
{
  PetscBLASInt n, one = 1, info;

  PetscFunctionBegin;
  PetscCheck(factor->factored || !factor->n, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "Call DenseFactorCompute() first");
  PetscCall(PetscBLASIntCast(factor->n, &n));
  if (n == 1) x[0] /= factor->values[0];
  else if (n) PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, factor->values, &n, factor->pivots, x, &n, &info));
  PetscCall(PetscLogFlops(2.0 * n * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint, factors and all; `most` as in DenseFactorResize() */
PetscErrorCode DenseFactorVisit(DenseFactor *factor, PetscInt most, Checkpoint checkpoint)
{
  PetscInt sizes[2] = {factor->n, factor->factored};

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "factor", 2, sizes));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(DenseFactorResize(factor, sizes[0], most));
    factor->factored = (PetscBool)sizes[1];
  }
  if (!factor->factored) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "factor values", factor->n * factor->n, factor->values));
  PetscCall(CheckpointVisitBytes(checkpoint, "factor pivots", (size_t)factor->n * sizeof(*factor->pivots), factor->pivots));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DenseFactorDestroy(DenseFactor *factor)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(factor->values, factor->pivots, factor->largest));
  factor->n = factor->room = 0;
  factor->factored         = PETSC_FALSE;
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
