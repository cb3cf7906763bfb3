/* The part of a body near its contact surfaces: which dofs it has, its matrix, and the rows on it. */
#include "interfaceslab.h"

/* Layers of elements beside the surface. Two cubes of 12 and 10 hexahedra along an edge take 5 or 6 iterations with one, 4 or 5 with two, 3
   or 4 with three and 3 with four, at steps in which waves cross 3 elements; where they cross 30, 7 to 14, 5 to 11, 5 to 9, and 4 to 8. */
#define LAYERS 4

PetscErrorCode InterfaceSlabReset(InterfaceSlab *slab)
{
  PetscFunctionBegin;
  PetscCall(ISDestroy(&slab->dofs));
  PetscCall(MatDestroy(&slab->K));
  PetscCall(MatDestroy(&slab->rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks dofs of any rank */
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

/* The marked dofs of this rank */
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

/* The dofs of the surfaces of all pairs of a body, of any rank and perhaps more than once */
static PetscErrorCode ListSurfaces(Contact contact, PetscInt b, IS *is)
{
  const ContactBodyRows *of = &contact->body_rows[b];
  PetscInt               n = 0, room = 0, *dofs = NULL;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass) PetscCall(PetscMalloc1(room, &dofs));
    for (PetscInt k = 0; k < of->n_pairs; k++) {
      const ContactPair *pair = &contact->pairs[of->pairs[k]];

      for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
        const SurfaceData *data;

        if (pair->body[side] != b) continue;
        PetscCall(SurfaceGetData(pair->surfaces[side], &data));
        room += data->n_nodes * data->dim;
        for (PetscInt i = 0; pass && i < data->n_nodes * data->dim; i++) dofs[n++] = data->dofs[i / data->dim] + i % data->dim;
      }
    }
  }
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)contact->bodies[b]), n, dofs, PETSC_OWN_POINTER, is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs are on the surfaces and in the layers beside them; a massless layer has its own numbers, and all of it counts */
static PetscErrorCode FindDofs(Contact contact, InterfaceSlab *slab, Mat A)
{
  PetscInt n, begin;
  IS       reach;
  Vec      mark;

  PetscFunctionBegin;
  if (slab->is_layer) {
    PetscCall(MatGetLocalSize(A, &n, NULL));
    PetscCall(MatGetOwnershipRange(A, &begin, NULL));
    PetscCall(ISCreateStride(PetscObjectComm((PetscObject)A), n, begin, 1, &slab->dofs));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatCreateVecs(A, &mark, NULL));
  PetscCall(VecZeroEntries(mark));
  PetscCall(ListSurfaces(contact, slab->body, &reach));
  PetscCall(Mark(reach, mark));
  PetscCall(ISDestroy(&reach));
  PetscCall(ListMarked(mark, &reach));
  PetscCall(MatIncreaseOverlap(A, 1, &reach, LAYERS));
  PetscCall(Mark(reach, mark));
  PetscCall(ISDestroy(&reach));
  PetscCall(ListMarked(mark, &slab->dofs));
  PetscCall(VecDestroy(&mark));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the body's matrices as they are; `changed` becomes true where they have changed since the last call. Rows change as surfaces slide,
   A with the step. */
PetscErrorCode InterfaceSlabUpdate(Contact contact, InterfaceSlab *slab, PetscBool *changed)
{
  Mat       matrices[2];
  PetscBool other[2];
  IS        all;
  PetscInt  n, begin;

  PetscFunctionBegin;
  PetscCall(BodyGetComplianceMatrices(contact->bodies[slab->body], &matrices[0], &matrices[1]));
  for (PetscInt k = 0; k < 2; k++) {
    PetscObjectId    id;
    PetscObjectState state;

    PetscCall(PetscObjectGetId((PetscObject)matrices[k], &id));
    PetscCall(PetscObjectStateGet((PetscObject)matrices[k], &state));
    other[k]        = (PetscBool)(id != slab->ids[k] || state != slab->states[k]);
    slab->ids[k]    = id;
    slab->states[k] = state;
  }
  if (!other[0] && !other[1]) PetscFunctionReturn(PETSC_SUCCESS);
  *changed = PETSC_TRUE;
  if (other[0]) {
    PetscCall(InterfaceSlabReset(slab));
    PetscCall(FindDofs(contact, slab, matrices[0]));
    PetscCall(MatCreateSubMatrix(matrices[0], slab->dofs, slab->dofs, MAT_INITIAL_MATRIX, &slab->K));
    if (slab->K == matrices[0]) { /* all of A; one that is joined with others counts as changed, and the body would be factored again */
      PetscCall(MatDestroy(&slab->K));
      PetscCall(MatDuplicate(matrices[0], MAT_COPY_VALUES, &slab->K));
    }
  }
  PetscCall(MatDestroy(&slab->rows));
  PetscCall(MatGetLocalSize(matrices[1], &n, NULL));
  PetscCall(MatGetOwnershipRange(matrices[1], &begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)matrices[1]), n, begin, 1, &all));
  PetscCall(MatCreateSubMatrix(matrices[1], all, slab->dofs, MAT_INITIAL_MATRIX, &slab->rows));
  PetscCall(ISDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
