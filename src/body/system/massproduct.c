/*
   Products of a mass matrix with vectors. In two and three dimensions x, y and z of a node have the same masses, and nothing to do with
   each other, so that one number serves for all of them. In one dimension nodes that are numbered along the bar make a matrix of three
   diagonals, for which the numbers of columns need not be looked up.
*/
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

/* The entries of each row below, on and above the main diagonal, if the matrix of one rank has no others */
static PetscErrorCode FindDiagonals(Body body)
{
  const PetscInt n = body->mesh.owned_nodes;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * n, &body->mass.diagonals));
  for (PetscInt row = 0; row < n; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n_columns;
    PetscBool          near = PETSC_TRUE;

    PetscCall(MatGetRow(body->mass.matrix, row, &n_columns, &columns, &values));
    for (PetscInt k = 0; k < n_columns; k++) {
      if (PetscAbsInt(columns[k] - row) > 1) near = PETSC_FALSE;
      else body->mass.diagonals[(columns[k] - row + 1) * n + row] = values[k];
    }
    PetscCall(MatRestoreRow(body->mass.matrix, row, &n_columns, &columns, &values));
    if (near) continue;
    PetscCall(PetscFree(body->mass.diagonals));
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the mass matrix, if it is not diagonal */
PetscErrorCode BodySetUpMassProduct(Body body)
{
  const PetscInt dim = body->mesh.dim;
  Mat            of_nodes;

  PetscFunctionBegin;
  if (!body->mass.matrix) PetscFunctionReturn(PETSC_SUCCESS);
  if (dim == 1) {
    PetscCall(PetscObjectReference((PetscObject)body->mass.matrix));
    body->mass.product = body->mass.matrix;
    if (body->rows.size == 1) PetscCall(FindDiagonals(body));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyCreateMassOfNodes(body, &of_nodes));
  PetscCall(MatCreateMAIJ(of_nodes, dim, &body->mass.product));
  /* on several ranks such a matrix takes memory in each product; another without the zeros between components does not */
  if (body->rows.size > 1) PetscCall(MatConvert(body->mass.product, MATAIJ, MAT_INPLACE_MATRIX, &body->mass.product));
  PetscCall(MatDestroy(&of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M x from the diagonals of M, in the order in which PETSc adds up a row */
SIMD_CLONES static void MultiplyDiagonals(PetscInt n, const PetscScalar below[], const PetscScalar on[], const PetscScalar above[],
                                          const PetscScalar x[], PetscScalar y[])
{
  y[0] = on[0] * x[0] + (n > 1 ? above[0] * x[1] : 0);
#pragma omp simd
  for (PetscInt i = 1; i < n - 1; i++) y[i] = below[i] * x[i - 1] + on[i] * x[i] + above[i] * x[i + 1];
  if (n > 1) y[n - 1] = below[n - 1] * x[n - 2] + on[n - 1] * x[n - 1];
}

/* y = M x */
PetscErrorCode BodyMultiplyMass(Body body, Vec x, Vec y)
{
  const PetscInt     n         = body->mesh.owned_nodes;
  const PetscScalar *diagonals = body->mass.diagonals, *from;
  PetscScalar       *to;

  PetscFunctionBegin;
  if (body->mass.diagonal) PetscCall(VecPointwiseMult(y, body->mass.diagonal, x));
  else if (!diagonals) PetscCall(MatMult(body->mass.product, x, y));
  else {
    PetscCall(VecGetArrayRead(x, &from));
    PetscCall(VecGetArrayWrite(y, &to));
    MultiplyDiagonals(n, diagonals, diagonals + n, diagonals + 2 * n, from, to);
    PetscCall(VecRestoreArrayWrite(y, &to));
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscCall(PetscLogFlops(5.0 * (PetscLogDouble)n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
