/* The mass of a body whose massless contact nodes move as inner nodes do: E^T M E, see extrapolation.c. */
#include <body/layout/bodyimpl.h>

/* The mass matrix of nodes, from that of displacements, which has the same for each component */
PetscErrorCode BodyCreateMassOfNodes(Body body, Mat *of_nodes)
{
  const PetscInt     dim = body->mesh.dim, n = body->mesh.owned_nodes;
  const PetscScalar *diagonal;
  PetscInt           begin;
  IS                 first;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &begin, NULL));
  begin /= dim;
  if (body->mass.matrix) {
    PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), n, dim * begin, dim, &first));
    PetscCall(MatCreateSubMatrix(body->mass.matrix, first, first, MAT_INITIAL_MATRIX, of_nodes));
    PetscCall(ISDestroy(&first));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)body), n, n, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, of_nodes));
  PetscCall(VecGetArrayRead(body->mass.diagonal, &diagonal));
  for (PetscInt i = 0; i < n; i++) PetscCall(MatSetValue(*of_nodes, begin + i, begin + i, diagonal[i * dim], INSERT_VALUES));
  PetscCall(VecRestoreArrayRead(body->mass.diagonal, &diagonal));
  PetscCall(MatAssemblyBegin(*of_nodes, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*of_nodes, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Replaces the full mass of nodes by E^T M E, with zeros on the diagonal of massless nodes: their rows have no other entries */
PetscErrorCode BodyExtrapolateMass(Body body)
{
  const PetscInt n = body->mesh.owned_nodes;
  PetscInt       begin;
  Mat            full, zeros;

  PetscFunctionBegin;
  PetscCall(BodyCreateMassOfNodes(body, &full));
  PetscCall(MatPtAP(full, body->mass.extrapolation, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &body->mass.of_nodes));
  PetscCall(MatDestroy(&full));
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)body), n, n, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &zeros));
  PetscCall(MatGetOwnershipRange(zeros, &begin, NULL));
  for (PetscInt i = 0; i < n; i++) PetscCall(MatSetValue(zeros, begin + i, begin + i, 0, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(zeros, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(zeros, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAXPY(body->mass.of_nodes, 1, zeros, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatDestroy(&zeros));
  PetscCall(MatDestroy(&body->mass.matrix));
  PetscCall(VecDestroy(&body->mass.diagonal));
  if (body->mesh.dim == 1) {
    PetscCall(PetscObjectReference((PetscObject)body->mass.of_nodes));
    body->mass.matrix = body->mass.of_nodes;
  } else {
    PetscCall(MatCreateMAIJ(body->mass.of_nodes, body->mesh.dim, &body->mass.matrix));
    PetscCall(MatConvert(body->mass.matrix, MATAIJ, MAT_INPLACE_MATRIX, &body->mass.matrix));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
