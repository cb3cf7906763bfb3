/* The part of a body near the surfaces of which it is the Dirichlet side: which dofs it has, its matrices, and the forces that move the
   surface. */
#include "interfaceslab.h"
#include <solver/constrainedsolver.h>
#include <sys/petsccompat.h>

/* Layers of elements beside the surface. Two cubes of 20 and 18 hexahedra along an edge, at steps in which waves cross 5 of them, took 27
   iterations without P, 23 with no layer, 16, 13, 12 with one, two, four, and 11 with all. */
#define LAYERS 3

PetscErrorCode InterfaceSlabReset(InterfaceSlab *slab)
{
  PetscFunctionBegin;
  PetscCall(ISDestroy(&slab->surface));
  PetscCall(ISDestroy(&slab->layers));
  PetscCall(MatDestroy(&slab->A_cc));
  PetscCall(MatDestroy(&slab->A_cj));
  PetscCall(MatDestroy(&slab->A_jc));
  PetscCall(KSPDestroy(&slab->factors));
  PetscCall(VecScatterDestroy(&slab->gather));
  PetscCall(VecDestroy(&slab->rows));
  PetscCall(VecDestroy(&slab->dofs));
  PetscCall(VecDestroy(&slab->moved));
  PetscCall(VecDestroy(&slab->force));
  PetscCall(VecDestroy(&slab->diagonal));
  PetscCall(VecDestroy(&slab->depth[0]));
  PetscCall(VecDestroy(&slab->depth[1]));
  PetscCall(PetscFree(slab->moves));
  PetscCall(PetscFree(slab->claimed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks dofs of any rank by the number of their layer, where they have none yet */
static PetscErrorCode Mark(IS dofs, PetscScalar layer, Vec mark, Vec work)
{
  const PetscInt    *dof;
  PetscScalar       *now;
  const PetscScalar *found;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecSet(work, -1));
  PetscCall(ISGetLocalSize(dofs, &n));
  PetscCall(ISGetIndices(dofs, &dof));
  for (PetscInt i = 0; i < n; i++) PetscCall(VecSetValue(work, dof[i], layer, INSERT_VALUES));
  PetscCall(ISRestoreIndices(dofs, &dof));
  PetscCall(VecAssemblyBegin(work));
  PetscCall(VecAssemblyEnd(work));
  PetscCall(VecGetLocalSize(work, &n));
  PetscCall(VecGetArrayRead(work, &found));
  PetscCall(VecGetArray(mark, &now));
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(now[i]) < 0) now[i] = found[i];
  PetscCall(VecRestoreArray(mark, &now));
  PetscCall(VecRestoreArrayRead(work, &found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dofs of this rank in one layer */
static PetscErrorCode ListLayer(Vec mark, PetscReal layer, IS *is)
{
  PetscInt           count = 0, *dofs, begin, n;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(mark, &n));
  PetscCall(VecGetOwnershipRange(mark, &begin, NULL));
  PetscCall(VecGetArrayRead(mark, &values));
  PetscCall(PetscMalloc1(n, &dofs));
  for (PetscInt i = 0; i < n; i++)
    if (PetscRealPart(values[i]) == layer) dofs[count++] = begin + i;
  PetscCall(VecRestoreArrayRead(mark, &values));
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)mark), count, dofs, PETSC_COPY_VALUES, is));
  PetscCall(PetscFree(dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dofs of the surfaces of which the body is the Dirichlet side, of any rank and perhaps more than once */
static PetscErrorCode ListSurface(const Contact contact, const InterfaceSlab *slab, IS *is)
{
  PetscInt n = 0, room = 0, *dofs;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const SurfaceData *data;

    if (pair->body[pair->dirichlet] != slab->body) continue;
    PetscCall(SurfaceGetData(pair->surfaces[pair->dirichlet], &data));
    room += data->n_nodes * data->dim;
  }
  PetscCall(PetscMalloc1(room, &dofs));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const SurfaceData *data;

    if (pair->body[pair->dirichlet] != slab->body) continue;
    PetscCall(SurfaceGetData(pair->surfaces[pair->dirichlet], &data));
    for (PetscInt i = 0; i < data->n_nodes * data->dim; i++) dofs[n++] = data->dofs[i / data->dim] + i % data->dim;
  }
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)contact->bodies[slab->body]), n, dofs, PETSC_OWN_POINTER, is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs are on the surface and in the layers beside it; those of a massless layer are numbered by themselves, and all are on it */
static PetscErrorCode FindDofs(const Contact contact, InterfaceSlab *slab, Mat A)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  IS             reach;
  Vec            mark, work;

  PetscFunctionBegin;
  if (slab->is_layer) {
    PetscInt n, begin;

    PetscCall(MatGetLocalSize(A, &n, NULL));
    PetscCall(MatGetOwnershipRange(A, &begin, NULL));
    PetscCall(ISCreateStride(comm, n, begin, 1, &slab->surface));
    PetscCall(ISCreateStride(comm, 0, 0, 1, &slab->layers));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatCreateVecs(A, &mark, &work));
  PetscCall(VecSet(mark, -1));
  PetscCall(ListSurface(contact, slab, &reach));
  PetscCall(Mark(reach, 0, mark, work));
  PetscCall(ISDestroy(&reach));
  PetscCall(ListLayer(mark, 0, &slab->surface));
  PetscCall(ISDuplicate(slab->surface, &reach));
  PetscCall(MatIncreaseOverlap(A, 1, &reach, LAYERS));
  PetscCall(Mark(reach, 1, mark, work));
  PetscCall(ListLayer(mark, 1, &slab->layers));
  PetscCall(ISDestroy(&reach));
  PetscCall(VecDestroy(&mark));
  PetscCall(VecDestroy(&work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of A_jj, and the matrices beside it */
static PetscErrorCode SlabFactor(InterfaceSlab *slab, PetscInt dim, Mat A)
{
  PetscInt n;
  Mat      A_jj;

  PetscFunctionBegin;
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->surface, MAT_INITIAL_MATRIX, &slab->A_cc));
  PetscCall(MatCreateVecs(slab->A_cc, &slab->moved, &slab->force));
  PetscCall(ISGetSize(slab->layers, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateSubMatrix(A, slab->surface, slab->layers, MAT_INITIAL_MATRIX, &slab->A_cj));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->surface, MAT_INITIAL_MATRIX, &slab->A_jc));
  PetscCall(MatCreateSubMatrix(A, slab->layers, slab->layers, MAT_INITIAL_MATRIX, &A_jj));
  PetscCall(MatSetOption(A_jj, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(A_jj, &slab->depth[0], &slab->depth[1]));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)A), &slab->factors));
  PetscCall(KSPSetOperators(slab->factors, A_jj, A_jj));
  PetscCall(ConstrainedSolverChoose(slab->factors, A_jj, dim));
  PetscCall(KSPSetUp(slab->factors));
  PetscCall(MatDestroy(&A_jj));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the body's matrices as they are: the rows change often, A hardly ever */
PetscErrorCode InterfaceSlabUpdate(Contact contact, InterfaceSlab *slab)
{
  Mat              A;
  PetscObjectId    id;
  PetscObjectState state;
  PetscInt         rows, dofs;

  PetscFunctionBegin;
  PetscCall(BodyGetComplianceMatrices(contact->bodies[slab->body], &A, &slab->B));
  PetscCall(PetscObjectGetId((PetscObject)A, &id));
  PetscCall(PetscObjectStateGet((PetscObject)A, &state));
  if (id == slab->id && state == slab->state) PetscFunctionReturn(PETSC_SUCCESS);
  slab->id    = id;
  slab->state = state;
  PetscCall(InterfaceSlabReset(slab));
  PetscCall(FindDofs(contact, slab, A));
  PetscCall(SlabFactor(slab, contact->dim, A));
  PetscCall(MatCreateVecs(slab->B, &slab->dofs, &slab->rows));
  PetscCall(VecDuplicate(slab->dofs, &slab->diagonal));
  PetscCall(MatGetDiagonal(A, slab->diagonal));
  PetscCall(VecScatterCreate(slab->dofs, slab->surface, slab->moved, NULL, &slab->gather));
  PetscCall(MatGetLocalSize(slab->B, &rows, &dofs));
  PetscCall(PetscMalloc1(rows, &slab->moves));
  PetscCall(PetscMalloc1(dofs, &slab->claimed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* force = (A_cc - A_cj A_jj^{-1} A_jc) moved */
PetscErrorCode InterfaceSlabApply(InterfaceSlab *slab)
{
  PetscFunctionBegin;
  PetscCall(MatMult(slab->A_cc, slab->moved, slab->force));
  if (!slab->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMult(slab->A_jc, slab->moved, slab->depth[0]));
  PetscCall(KSPSolve(slab->factors, slab->depth[0], slab->depth[1]));
  PetscCall(VecScale(slab->depth[1], -1));
  PetscCall(MatMultAdd(slab->A_cj, slab->depth[1], slab->force, slab->force));
  PetscFunctionReturn(PETSC_SUCCESS);
}
