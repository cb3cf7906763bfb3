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

/* The coarse grid. Nodes that have no weight in any dof have no number. */
typedef struct {
  PetscInt  dim, cells[3], n_all; /* the latter: of nodes times components */
  PetscReal lower[3], edge[3];
  PetscInt  n;       /* of these that have a number */
  PetscInt *numbers; /* of each, or -1 */
} Coarse;

/* One with weight in a dof */
typedef struct {
  PetscInt  index;
  PetscReal weight;
} CoarseWeight;

static PetscErrorCode CreateCoarse(Vec positions, PetscInt dim, Coarse *coarse)
{
  PetscReal          box[6] = {PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL, PETSC_MIN_REAL}, edge = 1;
  PetscInt           n, size;
  const PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(VecGetSize(positions, &size));
  PetscCall(VecGetArrayRead(positions, &x));
  for (PetscInt i = 0; i < n; i++) {
    box[i % dim]     = PetscMax(box[i % dim], PetscRealPart(x[i]));
    box[3 + i % dim] = PetscMax(box[3 + i % dim], -PetscRealPart(x[i]));
  }
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)positions)));
  for (PetscInt k = 0; k < dim; k++) edge *= box[k] + box[3 + k];
  edge          = CELL * PetscPowReal(edge * dim / (PetscReal)size, 1 / (PetscReal)dim);
  coarse->dim   = dim;
  coarse->n_all = dim;
  for (PetscInt k = 0; k < dim; k++) {
    const PetscReal extent = box[k] + box[3 + k];

    coarse->cells[k] = PetscMax(1, (PetscInt)(extent / edge + 0.5));
    coarse->lower[k] = -box[3 + k];
    coarse->edge[k]  = extent / (PetscReal)coarse->cells[k];
    coarse->n_all *= coarse->cells[k] + 1;
  }
  PetscCall(PetscMalloc1(coarse->n_all, &coarse->numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The coarse nodes around a point, and their weights, for one component of a displacement */
static PetscInt FindWeights(const Coarse *coarse, const PetscScalar x[], PetscInt component, CoarseWeight list[8])
{
  PetscInt n = 0;

  for (PetscInt corner = 0; corner < 1 << coarse->dim; corner++) {
    CoarseWeight *to = &list[n];

    *to = (CoarseWeight){.index = 0, .weight = 1};
    for (PetscInt k = 0; k < coarse->dim; k++) {
      const PetscReal at   = (PetscRealPart(x[k]) - coarse->lower[k]) / coarse->edge[k];
      const PetscInt  cell = PetscMin((PetscInt)at, coarse->cells[k] - 1), next = corner >> k & 1;

      to->index = to->index * (coarse->cells[k] + 1) + cell + next;
      to->weight *= next ? at - (PetscReal)cell : 1 - (at - (PetscReal)cell);
    }
    to->index = to->index * coarse->dim + component;
    if (to->weight > PETSC_SQRT_MACHINE_EPSILON) n++;
  }
  return n;
}

/* Which of this rank's dofs the coarse grid moves: none of the slab, and none that is held, whose row of A has its diagonal entry alone */
static PetscErrorCode FindMoved(Mat A, IS near, PetscBool moved[])
{
  const PetscInt *dofs;
  PetscInt        begin, end, n;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt    *columns;
    const PetscScalar *values;

    moved[i - begin] = PETSC_FALSE;
    PetscCall(MatGetRow(A, i, &n, &columns, &values));
    for (PetscInt k = 0; k < n && !moved[i - begin]; k++) moved[i - begin] = (PetscBool)(columns[k] != i && values[k] != 0);
    PetscCall(MatRestoreRow(A, i, &n, &columns, &values));
  }
  PetscCall(ISGetLocalSize(near, &n));
  PetscCall(ISGetIndices(near, &dofs));
  for (PetscInt k = 0; k < n; k++) moved[dofs[k] - begin] = PETSC_FALSE;
  PetscCall(ISRestoreIndices(near, &dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the coarse nodes that have weight in dofs of any rank */
static PetscErrorCode NumberCoarse(Coarse *coarse, Vec positions, const PetscBool moved[])
{
  PetscInt           n;
  const PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(PetscArrayzero(coarse->numbers, coarse->n_all));
  PetscCall(VecGetArrayRead(positions, &x));
  for (PetscInt i = 0; i < n; i++) {
    CoarseWeight   list[8];
    const PetscInt of = moved[i] ? FindWeights(coarse, &x[i - i % coarse->dim], i % coarse->dim, list) : 0;

    for (PetscInt k = 0; k < of; k++) coarse->numbers[list[k].index] = 1;
  }
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, coarse->numbers, (PetscMPIInt)coarse->n_all, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)positions)));
  coarse->n = 0;
  for (PetscInt k = 0; k < coarse->n_all; k++) coarse->numbers[k] = coarse->numbers[k] ? coarse->n++ : -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of the slab's dofs come first on each rank, then, on the last one, all coarse ones */
static PetscErrorCode FillFunctions(const Coarse *coarse, Vec positions, IS near, const PetscBool moved[], Mat P)
{
  const PetscInt    *dofs;
  const PetscScalar *x;
  PetscInt           begin, n, column, n_near, n_columns;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(positions, &n));
  PetscCall(MatGetOwnershipRange(P, &begin, NULL));
  PetscCall(MatGetOwnershipRangeColumn(P, &column, NULL));
  PetscCall(MatGetSize(P, NULL, &n_columns));
  PetscCall(ISGetLocalSize(near, &n_near));
  PetscCall(ISGetIndices(near, &dofs));
  for (PetscInt k = 0; k < n_near; k++) PetscCall(MatSetValue(P, dofs[k], column + k, 1, INSERT_VALUES));
  PetscCall(ISRestoreIndices(near, &dofs));
  PetscCall(VecGetArrayRead(positions, &x));
  for (PetscInt i = 0; i < n; i++) {
    CoarseWeight   list[8];
    const PetscInt of = moved[i] ? FindWeights(coarse, &x[i - i % coarse->dim], i % coarse->dim, list) : 0;

    for (PetscInt k = 0; k < of; k++)
      PetscCall(MatSetValue(P, begin + i, n_columns - coarse->n + coarse->numbers[list[k].index], list[k].weight, INSERT_VALUES));
  }
  PetscCall(VecRestoreArrayRead(positions, &x));
  PetscCall(MatAssemblyBegin(P, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(P, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Mark(IS dofs, Vec mark)
{
  const PetscInt *dof;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(dofs, &n));
  PetscCall(ISGetIndices(dofs, &dof));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecSetValue(mark, dof[i], 1, INSERT_VALUES));
  PetscCall(ISRestoreIndices(dofs, &dof));
  PetscCall(VecAssemblyBegin(mark));
  PetscCall(VecAssemblyEnd(mark));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ListMarked(Vec mark, IS *is)
{
  PetscInt           count = 0, *dofs, begin, n;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(mark, &n));
  PetscCall(VecGetOwnershipRange(mark, &begin, NULL));
  PetscCall(VecGetArrayRead(mark, &values));
  PetscCall(PetscMalloc1(n, &dofs));
  for (PetscInt i = 0; i < n; i++)
    if (values[i] != 0) dofs[count++] = begin + i;
  PetscCall(VecRestoreArrayRead(mark, &values));
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)mark), count, dofs, PETSC_COPY_VALUES, is));
  PetscCall(PetscFree(dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P, the displacements near a surface and what the body may do beyond them on a coarse grid: all dofs by functions, those near the surface
   first on each rank. `A`: matrix of the body, without entries beside the diagonal in rows of held dofs; `surface`: not zero on dofs of
   which functions have those one by one that are within so many layers of elements, which become `near` */
PetscErrorCode BodyCreateSlabFunctions(Mat A, Vec positions, PetscInt dim, Vec surface, PetscInt layers, IS *near, Mat *functions)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)A);
  Coarse      coarse = {0};
  PetscBool  *moved;
  PetscInt    n, n_near;
  PetscMPIInt rank, size;
  IS          reach;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(ListMarked(surface, &reach));
  PetscCall(MatIncreaseOverlap(A, 1, &reach, layers));
  PetscCall(Mark(reach, surface));
  PetscCall(ISDestroy(&reach));
  PetscCall(ListMarked(surface, near));
  PetscCall(MatGetLocalSize(A, &n, NULL));
  PetscCall(ISGetLocalSize(*near, &n_near));
  PetscCall(PetscMalloc1(n, &moved));
  PetscCall(FindMoved(A, *near, moved));
  PetscCall(CreateCoarse(positions, dim, &coarse));
  PetscCall(NumberCoarse(&coarse, positions, moved));
  PetscCall(MatCreate(comm, functions));
  PetscCall(MatSetSizes(*functions, n, n_near + (rank == size - 1 ? coarse.n : 0), PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*functions, MATAIJ));
  PetscCall(MatSetUp(*functions));
  PetscCall(FillFunctions(&coarse, positions, *near, moved, *functions));
  PetscCall(PetscFree(coarse.numbers));
  PetscCall(PetscFree(moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}
