/*
   Products of a mass matrix with vectors. In two and three dimensions x, y and z of a node have the same masses, and nothing to do with
   each other, so that one number serves for all of them. In one dimension nodes that are numbered along the bar make a matrix of three
   diagonals, which are gone through one after the other, without the numbers of columns.
*/
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

/* Diagonals that are gone through so at most; products of other matrices are left to PETSc */
#define MAX_DIAGONALS 3

/* Where entries of a matrix are, as column less row; `n` is more than may be kept where there are too many */
static PetscErrorCode FindDiagonals(Mat M, PetscInt *n, PetscInt offsets[MAX_DIAGONALS])
{
  PetscInt begin, end;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  for (PetscInt row = begin; row < end && *n <= MAX_DIAGONALS; row++) {
    const PetscInt *columns;
    PetscInt        n_columns;

    PetscCall(MatGetRow(M, row, &n_columns, &columns, NULL));
    for (PetscInt k = 0; k < n_columns && *n <= MAX_DIAGONALS; k++) {
      PetscInt d = 0;

      while (d < *n && offsets[d] != columns[k] - row) d++;
      if (d < *n) continue;
      if (*n < MAX_DIAGONALS) offsets[*n] = columns[k] - row;
      (*n)++;
    }
    PetscCall(MatRestoreRow(M, row, &n_columns, &columns, NULL));
  }
  if (*n <= MAX_DIAGONALS) PetscCall(PetscSortInt(*n, offsets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The diagonals of a matrix that has no others, row by row */
static PetscErrorCode FillDiagonals(Body body, Mat M)
{
  const PetscInt local = body->mesh.owned_nodes;
  PetscInt       begin, end;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(body->mass.n_diagonals * local, &body->mass.diagonals));
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n_columns;

    PetscCall(MatGetRow(M, row, &n_columns, &columns, &values));
    for (PetscInt k = 0; k < n_columns; k++)
      for (PetscInt d = 0; d < body->mass.n_diagonals; d++)
        if (columns[k] - row == body->mass.offsets[d]) body->mass.diagonals[d * local + row - begin] = values[k];
    PetscCall(MatRestoreRow(M, row, &n_columns, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the mass matrix, if it is not diagonal */
PetscErrorCode BodySetUpMassProduct(Body body)
{
  const PetscInt dim = body->mesh.dim;
  PetscInt       begin, n = MAX_DIAGONALS + 1;
  Mat            of_nodes;
  IS             first;

  PetscFunctionBegin;
  if (!body->mass.matrix) PetscFunctionReturn(PETSC_SUCCESS);
  if (dim == 1) {
    PetscCall(PetscObjectReference((PetscObject)body->mass.matrix));
    body->mass.product = body->mass.matrix;
    if (body->rows.size == 1) PetscCall(FindDiagonals(body->mass.matrix, &n, body->mass.offsets));
    if (n > MAX_DIAGONALS) PetscFunctionReturn(PETSC_SUCCESS);
    body->mass.n_diagonals = n;
    PetscCall(FillDiagonals(body, body->mass.matrix));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatGetOwnershipRange(body->mass.matrix, &begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->mesh.owned_nodes, begin, dim, &first));
  PetscCall(MatCreateSubMatrix(body->mass.matrix, first, first, MAT_INITIAL_MATRIX, &of_nodes));
  PetscCall(ISDestroy(&first));
  PetscCall(MatCreateMAIJ(of_nodes, dim, &body->mass.product));
  /* on several ranks such a matrix takes memory in each product; another without the zeros between components does not */
  if (body->rows.size > 1) PetscCall(MatConvert(body->mass.product, MATAIJ, MAT_INPLACE_MATRIX, &body->mass.product));
  PetscCall(MatDestroy(&of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += values x, number by number */
SIMD_CLONES static void AddProducts(PetscInt n, const PetscScalar values[], const PetscScalar x[], PetscScalar y[])
{
#pragma omp simd
  for (PetscInt i = 0; i < n; i++) y[i] += values[i] * x[i];
}

/* y = M x by the diagonals of M */
static PetscErrorCode MultiplyDiagonals(Body body, Vec x, Vec y)
{
  const PetscInt     n = body->mesh.owned_nodes;
  const PetscScalar *from;
  PetscScalar       *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(x, &from));
  PetscCall(VecGetArrayWrite(y, &to));
  PetscCall(PetscArrayzero(to, n));
  for (PetscInt d = 0; d < body->mass.n_diagonals; d++) {
    const PetscInt offset = body->mass.offsets[d], begin = PetscMax(0, -offset), end = PetscMin(n, n - offset);

    if (begin < end) AddProducts(end - begin, body->mass.diagonals + d * n + begin, from + begin + offset, to + begin);
  }
  PetscCall(VecRestoreArrayWrite(y, &to));
  PetscCall(VecRestoreArrayRead(x, &from));
  PetscCall(PetscLogFlops(2.0 * body->mass.n_diagonals * (PetscLogDouble)n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M x */
PetscErrorCode BodyMultiplyMass(Body body, Vec x, Vec y)
{
  PetscFunctionBegin;
  if (body->mass.diagonal) PetscCall(VecPointwiseMult(y, body->mass.diagonal, x));
  else if (body->mass.diagonals) PetscCall(MultiplyDiagonals(body, x, y));
  else PetscCall(MatMult(body->mass.product, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
