/* The part of a body near its contact surfaces, with what it may do beyond: its matrix, and the rows on it. */
#include "interfaceslab.h"

/* Layers of elements beside the surface. With two there is an iteration more, with four half of one less at long steps, for which factors
   take 1.3 times as long. */
#define LAYERS 3

/* What is added to the diagonal of P^T A P, in parts of it */
#define SHIFT 1e-10

PetscErrorCode InterfaceSlabReset(InterfaceSlab *slab)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&slab->functions));
  PetscCall(MatDestroy(&slab->K));
  PetscCall(MatDestroy(&slab->rows));
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

/* P. A massless layer has its own numbers, and all of it counts. */
static PetscErrorCode CreateFunctions(Contact contact, InterfaceSlab *slab, Mat A)
{
  IS  dofs;
  Vec positions;

  PetscFunctionBegin;
  if (slab->is_layer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ListSurfaces(contact, slab->body, &dofs));
  PetscCall(BodyGetReferencePositions(contact->bodies[slab->body], &positions));
  PetscCall(BodyCreateSlabFunctions(A, positions, contact->dim, dofs, LAYERS, &slab->functions));
  PetscCall(ISDestroy(&dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P^T A P. Where elements are larger than coarse cells columns of P depend on each other, and what is added to the diagonal keeps the
   matrix positive definite. */
static PetscErrorCode ReduceMatrix(InterfaceSlab *slab, Mat A)
{
  Vec diagonal;

  PetscFunctionBegin;
  if (!slab->functions) { /* one that is joined with others counts as changed, and the body would be factored again */
    PetscCall(MatDuplicate(A, MAT_COPY_VALUES, &slab->K));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatPtAP(A, slab->functions, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &slab->K));
  PetscCall(MatProductClear(slab->K)); /* which would keep A */
  PetscCall(MatCreateVecs(slab->K, &diagonal, NULL));
  PetscCall(MatGetDiagonal(slab->K, diagonal));
  PetscCall(VecScale(diagonal, SHIFT));
  PetscCall(MatDiagonalSet(slab->K, diagonal, ADD_VALUES));
  PetscCall(VecDestroy(&diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B P */
static PetscErrorCode ReduceRows(InterfaceSlab *slab, Mat B)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&slab->rows));
  if (!slab->functions) {
    PetscCall(MatDuplicate(B, MAT_COPY_VALUES, &slab->rows));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatMatMult(B, slab->functions, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &slab->rows));
  PetscCall(MatProductClear(slab->rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the body's matrices as they are; `changed` becomes true where they have changed since the last call. Rows change as surfaces slide,
   A with the step. */
PetscErrorCode InterfaceSlabUpdate(Contact contact, InterfaceSlab *slab, PetscBool *changed)
{
  Mat       matrices[2];
  PetscBool other[2];

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
    PetscCall(CreateFunctions(contact, slab, matrices[0]));
    PetscCall(ReduceMatrix(slab, matrices[0]));
  }
  PetscCall(ReduceRows(slab, matrices[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
