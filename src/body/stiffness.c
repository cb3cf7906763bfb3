/* Internal force and stiffness matrix. */
#include "bodyimpl.h"

/* f = internal force for displacement u [N] */
PetscErrorCode BodyComputeInternalForce(Body body, Vec u, Vec f)
{
  const PetscScalar *u_array;
  PetscScalar       *f_array;
  Vec                u_local = u, f_local = f;
  const PetscBool    ghosted = (PetscBool)(body->rows.size > 1);

  PetscFunctionBegin;
  if (ghosted) {
    PetscCall(VecGhostUpdateBegin(u, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostUpdateEnd(u, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostGetLocalForm(u, &u_local));
    PetscCall(VecGhostGetLocalForm(f, &f_local));
  }
  PetscCall(VecGetArrayRead(u_local, &u_array));
  PetscCall(VecGetArrayWrite(f_local, &f_array));
  PetscCall(PetscArrayzero(f_array, body->local_nodes * body->dim));
  PetscCall((*body->element->ops.internalforce)(body->element, u_array, f_array));
  PetscCall(VecRestoreArrayWrite(f_local, &f_array));
  PetscCall(VecRestoreArrayRead(u_local, &u_array));
  if (ghosted) {
    PetscCall(VecGhostRestoreLocalForm(f, &f_local));
    PetscCall(VecGhostRestoreLocalForm(u, &u_local));
    PetscCall(VecGhostUpdateBegin(f, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(f, ADD_VALUES, SCATTER_REVERSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The global numbers of an element's displacements, from the numbers of its nodes on this rank */
PetscErrorCode BodyGetElementDofs(Body body, PetscInt e, PetscInt dofs[])
{
  const PetscInt *nodes = body->connectivity + e * body->element->nodes;
  PetscInt        rstart;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  for (PetscInt n = 0; n < body->element->nodes; n++)
    for (PetscInt d = 0; d < body->dim; d++) dofs[n * body->dim + d] = nodes[n] < body->owned_nodes ? rstart + nodes[n] * body->dim + d : body->ghost_dofs[(nodes[n] - body->owned_nodes) * body->dim + d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness matrix of the undeformed body */
PetscErrorCode BodySetUpStiffness(Body body)
{
  const PetscInt n = body->element->nodes * body->dim;
  PetscInt       dofs[ELEMENT_MAX_DOFS];
  PetscScalar    zero[ELEMENT_MAX_DOFS] = {0}, K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  PetscCall(DMSetMatType(body->dm, MATAIJ));
  PetscCall(DMCreateMatrix(body->dm, &body->stiffness));
  for (PetscInt e = 0; e < body->element->count; e++) {
    PetscCall((*body->element->ops.stiffness)(body->element, e, zero, K));
    PetscCall(BodyGetElementDofs(body, e, dofs));
    PetscCall(MatSetValues(body->stiffness, n, dofs, n, dofs, K, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(body->stiffness, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(body->stiffness, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}
