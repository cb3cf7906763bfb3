/* What a body may do beyond the layers of elements that a slab at its surface has whole: displacements that are linear between the nodes of
   a coarse grid on the box of the body. With the columns of P, one for each dof of the slab and one for each coarse node and component, the
   body answers to forces on its surface with

     B P (P^T A P)^{-1} P^T B^T

   in place of B A^{-1} B^T. Rigid motions and strains that are the same everywhere are among them, and so is, about, all that changes
   little from one coarse node to the next: what reaches far from the surface does. A slab whose far side is held lacks all that, and at
   steps in which waves cross the body that is most of what long waves on the surface answer with. */
#include "complianceimpl.h"

/* Edge of a coarse cell, in edges of elements as they are on average */
#define CELL 4

/* The coarse grid */
typedef struct {
  PetscInt  dim, cells[3];
  PetscReal lower[3], edge[3];
  PetscInt  begin, n; /* its first column, and how many it has: nodes times components */
} Coarse;

static PetscErrorCode LayCoarse(Body body, Coarse *coarse)
{
  const PetscInt dim = body->mesh.dim;
  PetscReal      upper[3], edge = 1;

  PetscFunctionBegin;
  PetscCall(DMGetBoundingBox(body->mesh.dm, coarse->lower, upper));
  PetscCall(VecGetSize(body->mesh.positions, &coarse->begin));
  for (PetscInt k = 0; k < dim; k++) edge *= upper[k] - coarse->lower[k];
  edge        = CELL * PetscPowReal(edge * dim / (PetscReal)coarse->begin, 1 / (PetscReal)dim);
  coarse->dim = coarse->n = dim;
  for (PetscInt k = 0; k < dim; k++) {
    coarse->cells[k] = PetscMax(1, (PetscInt)((upper[k] - coarse->lower[k]) / edge + 0.5));
    coarse->edge[k]  = (upper[k] - coarse->lower[k]) / (PetscReal)coarse->cells[k];
    coarse->n *= coarse->cells[k] + 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of the coarse nodes around a point, for one component of a displacement, and their weights */
static PetscInt FindWeights(const Coarse *coarse, const PetscScalar x[], PetscInt component, PetscInt columns[8], PetscScalar weights[8])
{
  PetscInt n = 0;

  for (PetscInt corner = 0; corner < PetscPowInt(2, coarse->dim); corner++) {
    PetscInt  index  = 0;
    PetscReal weight = 1;

    for (PetscInt k = 0; k < coarse->dim; k++) {
      const PetscReal at   = (PetscRealPart(x[k]) - coarse->lower[k]) / coarse->edge[k];
      const PetscInt  cell = PetscMin((PetscInt)at, coarse->cells[k] - 1), next = corner >> k & 1;

      index = index * (coarse->cells[k] + 1) + cell + next;
      weight *= next ? at - (PetscReal)cell : 1 - (at - (PetscReal)cell);
    }
    if (weight <= PETSC_SQRT_MACHINE_EPSILON) continue;
    columns[n]   = coarse->begin + index * coarse->dim + component;
    weights[n++] = weight;
  }
  return n;
}

/* Marks the displacements within so many layers of elements of those that are marked, by the entries of A */
static PetscErrorCode MarkNear(Mat A, PetscInt layers, Vec near)
{
  PetscInt           n, count = 0, begin, *list;
  const PetscInt    *dofs;
  const PetscScalar *marked;
  IS                 reach;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(near, &n));
  PetscCall(VecGetOwnershipRange(near, &begin, NULL));
  PetscCall(PetscMalloc1(n, &list));
  PetscCall(VecGetArrayRead(near, &marked));
  for (PetscInt i = 0; i < n; i++)
    if (marked[i] != 0) list[count++] = begin + i;
  PetscCall(VecRestoreArrayRead(near, &marked));
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)A), count, list, PETSC_OWN_POINTER, &reach));
  PetscCall(MatIncreaseOverlap(A, 1, &reach, layers));
  PetscCall(ISGetLocalSize(reach, &n));
  PetscCall(ISGetIndices(reach, &dofs));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecSetValue(near, dofs[i], 1, ADD_VALUES));
  PetscCall(ISRestoreIndices(reach, &dofs));
  PetscCall(ISDestroy(&reach));
  PetscCall(VecAssemblyBegin(near));
  PetscCall(VecAssemblyEnd(near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All functions of all displacements: those near the surface one by one, the coarse grid on others that are not held */
static PetscErrorCode Fill(const Coarse *coarse, Vec positions, Vec near, Vec free, Mat all)
{
  const PetscScalar *x, *is_near, *is_free, one = 1;
  PetscScalar        weights[8];
  PetscInt           begin, end, columns[8];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(near, &begin, &end));
  PetscCall(VecGetArrayRead(positions, &x));
  PetscCall(VecGetArrayRead(near, &is_near));
  PetscCall(VecGetArrayRead(free, &is_free));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt i = row - begin, d = i % coarse->dim;

    if (is_near[i] != 0) PetscCall(MatSetValues(all, 1, &row, 1, &row, &one, INSERT_VALUES));
    else if (is_free[i] != 0)
      PetscCall(MatSetValues(all, 1, &row, FindWeights(coarse, &x[i - d], d, columns, weights), columns, weights, INSERT_VALUES));
  }
  PetscCall(VecRestoreArrayRead(free, &is_free));
  PetscCall(VecRestoreArrayRead(near, &is_near));
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCall(MatAssemblyBegin(all, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(all, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of a matrix that have entries */
static PetscErrorCode DropEmptyColumns(Mat all, Mat *functions)
{
  MPI_Comm   comm = PetscObjectComm((PetscObject)all);
  PetscInt   begin, end, n, count = 0, *list;
  PetscReal *norms;
  IS         rows, columns;

  PetscFunctionBegin;
  PetscCall(MatGetSize(all, NULL, &n));
  PetscCall(MatGetOwnershipRangeColumn(all, &begin, &end));
  PetscCall(PetscMalloc1(n, &norms));
  PetscCall(PetscMalloc1(end - begin, &list));
  PetscCall(MatGetColumnNorms(all, NORM_INFINITY, norms));
  for (PetscInt k = begin; k < end; k++)
    if (norms[k] > 0) list[count++] = k;
  PetscCall(ISCreateGeneral(comm, count, list, PETSC_OWN_POINTER, &columns));
  PetscCall(MatGetOwnershipRange(all, &begin, &end));
  PetscCall(ISCreateStride(comm, end - begin, begin, 1, &rows));
  PetscCall(MatCreateSubMatrix(all, rows, columns, MAT_INITIAL_MATRIX, functions));
  PetscCall(ISDestroy(&rows));
  PetscCall(ISDestroy(&columns));
  PetscCall(PetscFree(norms));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P, the displacements near a surface and what the body may do beyond them on a coarse grid: all dofs by functions. The surface has the
   entries of all rows and n displacements; those within so many layers of elements of it come one by one. `A`: a matrix of the body */
PetscErrorCode BodyCreateSlabFunctions(Body body, Mat A, PetscInt n, const PetscInt dofs[], PetscInt layers, Mat *functions)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)A);
  const Vec   near = body->work.nodes[0], free = body->work.nodes[1];
  Coarse      coarse;
  PetscInt    local;
  PetscMPIInt rank, size;
  Mat         all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(VecZeroEntries(near));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecSetValue(near, dofs[i], 1, ADD_VALUES));
  PetscCall(BodyMarkColumns(body->rows.matrix, near));
  PetscCall(MarkNear(A, layers, near));
  PetscCall(VecSet(free, 1));
  PetscCall(BodyZeroHeld(body, free));
  PetscCall(LayCoarse(body, &coarse));
  PetscCall(MatGetLocalSize(A, &local, NULL));
  PetscCall(MatCreateAIJ(comm, local, local + (rank == size - 1 ? coarse.n : 0), PETSC_DETERMINE, PETSC_DETERMINE, 8, NULL, 8, NULL, &all));
  PetscCall(Fill(&coarse, body->mesh.positions, near, free, all));
  PetscCall(DropEmptyColumns(all, functions));
  PetscCall(MatDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
