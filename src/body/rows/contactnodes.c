/* Forces on the rows of a body with lumped mass and without massless nodes. A contact node is accelerated by the forces on it and by no
   others, so that all is done at the contact nodes: all nodes of a body may be fifty times as many. */
#include <body/layout/bodyimpl.h>

PetscErrorCode BodyDestroyContactNodes(Body body)
{
  PetscFunctionBegin;
  PetscCall(VecDestroy(&body->nodes.force));
  PetscCall(PetscFree(body->nodes.dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyMarkColumns - adds 1 to each displacement, of whatever rank, that a row of this rank has an entry in. Collective. */
PetscErrorCode BodyMarkColumns(Mat rows, Vec marks)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(rows, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt *columns;
    PetscInt        n;

    PetscCall(MatGetRow(rows, row, &n, &columns, NULL));
    for (PetscInt j = 0; j < n; j++) PetscCall(VecSetValue(marks, columns[j], 1, ADD_VALUES));
    PetscCall(MatRestoreRow(rows, row, &n, &columns, NULL));
  }
  PetscCall(VecAssemblyBegin(marks));
  PetscCall(VecAssemblyEnd(marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyListContactDofs - displacements of contact nodes that near rows act on, and a vector of zeros for the forces on them */
PetscErrorCode BodyListContactDofs(Body body)
{
  const PetscInt     dim  = body->mesh.dim;
  const PetscBool    some = body->rows.some_near;
  const PetscScalar *marked;
  PetscInt           n = 0;

  PetscFunctionBegin;
  if (!BodyAnswersByNodes(body)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->nodes.force) {
    PetscCall(BodyCreateVec(body, &body->nodes.force));
    for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) n += body->layer.contains[node] ? dim : 0;
    PetscCall(PetscMalloc1(n, &body->nodes.dofs));
  }
  PetscCall(VecZeroEntries(body->nodes.force));
  if (some) PetscCall(BodyMarkColumns(body->rows.near.matrix, body->nodes.force));
  PetscCall(VecGetArrayRead(body->nodes.force, &marked));
  body->nodes.n = 0;
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++)
    if (some ? marked[i] != 0 : body->layer.contains[i / dim]) body->nodes.dofs[body->nodes.n++] = i;
  PetscCall(VecRestoreArrayRead(body->nodes.force, &marked));
  PetscCall(VecZeroEntries(body->nodes.force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* BodyCopyContactNodes - what a vector has at the nodes that near rows act on, to another */
PetscErrorCode BodyCopyContactNodes(Body body, Vec from, Vec to)
{
  const PetscScalar *values;
  PetscScalar       *copy;

  PetscFunctionBegin;
  if (!body->nodes.force) PetscCall(BodyListContactDofs(body));
  PetscCall(VecGetArrayRead(from, &values));
  PetscCall(VecGetArray(to, &copy));
  for (PetscInt k = 0; k < body->nodes.n; k++) copy[body->nodes.dofs[k]] = values[body->nodes.dofs[k]];
  PetscCall(VecRestoreArray(to, &copy));
  PetscCall(VecRestoreArrayRead(from, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = M^{-1} B^T force, one force for each row of this rank, and that of what does not go over from the rows of the last step where
   `stopped`: vecs[k] += scales[k] x */
PetscErrorCode BodyAddAnswerOfNodes(Body body, const PetscScalar force[], PetscBool stopped, PetscInt n, const PetscReal scales[],
                                    const Vec vecs[])
{
  const PetscInt    *dofs;
  const PetscScalar *inverse;
  PetscScalar       *x, *values;

  PetscFunctionBegin;
  if (!body->nodes.force) PetscCall(BodyListContactDofs(body));
  if (!BodyHandsOver(body) && BodyNearRowsAreZero(body, force)) PetscFunctionReturn(PETSC_SUCCESS);
  dofs = body->nodes.dofs;
  PetscCall(BodyAddNearRows(body, force, body->nodes.force));
  if (stopped) PetscCall(BodyAddStoppedHandover(body, body->nodes.force));
  PetscCall(BodyZeroHeld(body, body->nodes.force));
  PetscCall(VecGetArray(body->nodes.force, &x));
  PetscCall(VecGetArrayRead(body->mass.inverse, &inverse));
  for (PetscInt k = 0; k < body->nodes.n; k++) x[dofs[k]] *= inverse[dofs[k]];
  PetscCall(VecRestoreArrayRead(body->mass.inverse, &inverse));
  for (PetscInt v = 0; v < n; v++) {
    PetscCall(VecGetArray(vecs[v], &values));
    for (PetscInt k = 0; k < body->nodes.n; k++) values[dofs[k]] += scales[v] * x[dofs[k]];
    PetscCall(VecRestoreArray(vecs[v], &values));
  }
  for (PetscInt k = 0; k < body->nodes.n; k++) x[dofs[k]] = 0;
  PetscCall(VecRestoreArray(body->nodes.force, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
