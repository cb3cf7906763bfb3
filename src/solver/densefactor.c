#include "densefactor.h"
#include <petscblaslapack.h>

/* Of a pivot, in parts of the largest entry of its column */
#define ROUND_OFF (16 * PETSC_MACHINE_EPSILON)

/* Gives the matrix diagonal blocks of these orders; its entries are undefined afterwards. Room grows by doubling, up to that of one block
   of order `most`, so that an interface whose active rows become more step by step does not allocate in each of them. */
PetscErrorCode DenseFactorResizeBlocks(DenseFactor *factor, PetscInt n_blocks, const PetscInt orders[], PetscInt most)
{
  PetscInt n = 0, size = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n_blocks; k++) {
    n += orders[k];
    size += orders[k] * orders[k];
  }
  factor->n        = n;
  factor->n_blocks = n_blocks;
  factor->factored = PETSC_FALSE;
  if (n > factor->room || n_blocks > factor->room || !factor->begin) {
    PetscCall(PetscFree4(factor->pivots, factor->largest, factor->begin, factor->at));
    factor->room = PetscMax(PetscMax(n, n_blocks), PetscMin(2 * factor->room, most));
    PetscCall(PetscMalloc4(factor->room, &factor->pivots, factor->room, &factor->largest, factor->room + 1, &factor->begin, factor->room,
                           &factor->at));
  }
  if (size > factor->size) {
    PetscCall(PetscFree(factor->values));
    factor->size = PetscMax(size, PetscMin(2 * factor->size, most * most));
    PetscCall(PetscMalloc1(factor->size, &factor->values));
  }
  factor->begin[0] = 0;
  for (PetscInt k = 0, at = 0; k < n_blocks; k++) {
    factor->at[k]        = at;
    factor->begin[k + 1] = factor->begin[k] + orders[k];
    at += orders[k] * orders[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same with one block */
PetscErrorCode DenseFactorResize(DenseFactor *factor, PetscInt n, PetscInt most)
{
  PetscFunctionBegin;
  PetscCall(DenseFactorResizeBlocks(factor, n > 0, &n, most));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of a diagonal block, by columns without gaps between them, and its order */
PetscScalar *DenseFactorGetBlock(const DenseFactor *factor, PetscInt k, PetscInt *order)
{
  *order = factor->begin[k + 1] - factor->begin[k];
  return factor->values + factor->at[k];
}

/* The largest entry of each column, without sign: what its pivot is measured by */
static void FindLargest(PetscInt n, const PetscScalar block[], PetscReal largest[])
{
  for (PetscInt j = 0; j < n; j++) {
    largest[j] = 0;
    for (PetscInt i = 0; i < n; i++) largest[j] = PetscMax(largest[j], PetscAbsScalar(block[j * n + i]));
  }
}

/* Whether a pivot is no more than the round-off of its column: of rows that depend on each other some pivot is zero but for that. Entries
   that are not numbers are not singular: the step in which they come about fails by itself. */
static PetscBool HasNoPivot(PetscInt n, const PetscScalar block[], const PetscReal largest[])
{
  for (PetscInt j = 0; j < n; j++)
    if (PetscAbsScalar(block[j * n + j]) <= ROUND_OFF * largest[j]) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Replaces the matrix by its LU factors; `singular`: it has none */
PetscErrorCode DenseFactorCompute(DenseFactor *factor, PetscBool *singular)
{
  PetscFunctionBegin;
  *singular = PETSC_FALSE;
  for (PetscInt k = 0; k < factor->n_blocks; k++) {
    PetscInt     order;
    PetscScalar *block = DenseFactorGetBlock(factor, k, &order);
    PetscBLASInt n, info = 0;

    PetscCall(PetscBLASIntCast(order, &n));
    FindLargest(order, block, factor->largest);
    if (n == 1) info = block[0] == 0 || PetscIsInfOrNanScalar(block[0]);
    else if (n) PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&n, &n, block, &n, factor->pivots + factor->begin[k], &info));
    PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK getrf info %d", (int)info);
    if (info > 0 || HasNoPivot(order, block, factor->largest)) *singular = PETSC_TRUE;
    PetscCall(PetscLogFlops(DenseFactorFlops(order)));
  }
  factor->factored = (PetscBool) !*singular;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^{-1} x */
PetscErrorCode DenseFactorSolve(const DenseFactor *factor, PetscScalar x[])
{
  PetscBLASInt one = 1, info;

  PetscFunctionBegin;
  PetscCheck(factor->factored || !factor->n, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE, "Call DenseFactorCompute() first");
  for (PetscInt k = 0; k < factor->n_blocks; k++) {
    PetscInt     order;
    PetscScalar *block = DenseFactorGetBlock(factor, k, &order), *of = x + factor->begin[k];
    PetscBLASInt n = (PetscBLASInt)order; /* which fits: it has been factored */

    if (n == 1) of[0] /= block[0];
    else if (n) PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &n, &one, block, &n, factor->pivots + factor->begin[k], of, &n, &info));
    PetscCall(PetscLogFlops(2.0 * order * order));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint, factors and all; `most` as in DenseFactorResize() */
PetscErrorCode DenseFactorVisit(DenseFactor *factor, PetscInt most, Checkpoint checkpoint)
{
  PetscInt  sizes[2] = {factor->factored, factor->n_blocks}, size = 0;
  PetscInt *orders;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "factor", 2, sizes));
  PetscCall(PetscMalloc1(sizes[1], &orders));
  for (PetscInt k = 0; k < sizes[1] && !CheckpointLoads(checkpoint); k++) orders[k] = factor->begin[k + 1] - factor->begin[k];
  PetscCall(CheckpointVisitInts(checkpoint, "factor blocks", sizes[1], orders));
  if (CheckpointLoads(checkpoint)) {
    PetscCall(DenseFactorResizeBlocks(factor, sizes[1], orders, most));
    factor->factored = (PetscBool)sizes[0];
  }
  for (PetscInt k = 0; k < sizes[1]; k++) size += orders[k] * orders[k];
  PetscCall(PetscFree(orders));
  if (!factor->factored) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckpointVisitReals(checkpoint, "factor values", size, factor->values));
  PetscCall(CheckpointVisitBytes(checkpoint, "factor pivots", (size_t)factor->n * sizeof(*factor->pivots), factor->pivots));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DenseFactorDestroy(DenseFactor *factor)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(factor->pivots, factor->largest, factor->begin, factor->at));
  PetscCall(PetscFree(factor->values));
  factor->n = factor->room = factor->size = factor->n_blocks = 0;
  factor->factored                                           = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Operations that factoring a matrix of that order takes */
PetscLogDouble DenseFactorFlops(PetscInt n)
{
  return 2.0 / 3.0 * n * n * n;
}
