/* The inverse of a mass matrix that couples nodes near the surface alone, of a body that one rank has: factors of that block, once for all
   components where none of its displacements is held; elsewhere the matrix is diagonal. */
#include <body/layout/bodyimpl.h>

struct _n_MassBlocks {
  PetscReal
      *inverse; /* per dof outside the block: 1 / mass; 1 on held dofs, whose acceleration is given in place of a force; 0 without mass */
  PetscInt  n[3], *nodes[3]; /* of the block, for each component */
  PetscBool same[3];         /* as the component before */
  Mat       factors[3];
  Vec       b[3], x[3];
};

static PetscErrorCode FactorBlock(MassBlocks blocks, PetscInt d, Mat of_nodes)
{
  MatFactorInfo info;
  Mat           block;
  IS            nodes, rows, columns;

  PetscFunctionBegin;
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, blocks->n[d], blocks->nodes[d], PETSC_USE_POINTER, &nodes));
  PetscCall(MatCreateSubMatrix(of_nodes, nodes, nodes, MAT_INITIAL_MATRIX, &block));
  PetscCall(ISDestroy(&nodes));
  PetscCall(MatGetOrdering(block, MATORDERINGND, &rows, &columns));
  PetscCall(MatFactorInfoInitialize(&info));
  info.zeropivot = 0; /* PETSc's default is an absolute number, whatever the unit of mass */
  PetscCall(MatGetFactor(block, MATSOLVERPETSC, MAT_FACTOR_LU, &blocks->factors[d]));
  PetscCall(MatLUFactorSymbolic(blocks->factors[d], block, rows, columns, &info));
  PetscCall(MatLUFactorNumeric(blocks->factors[d], block, &info));
  PetscCall(ISDestroy(&columns));
  PetscCall(ISDestroy(&rows));
  PetscCall(MatDestroy(&block));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which dofs belong to the block, and the inverse of the others */
static PetscErrorCode Divide(Body body, MassBlocks blocks, Mat of_nodes)
{
  const PetscInt dim  = body->mesh.dim;
  PetscInt       held = 0;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;
    PetscReal          diagonal = 0;

    PetscCall(MatGetRow(of_nodes, node, &n, &columns, &values));
    for (PetscInt k = 0; k < n; k++)
      if (columns[k] == node) diagonal = PetscRealPart(values[k]);
    PetscCall(MatRestoreRow(of_nodes, node, NULL, &columns, &values));
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt  dof     = node * dim + d;
      const PetscBool is_held = (PetscBool)(held < body->held.n && body->held.dofs[held] == dof);

      held += is_held;
      if (n > 1 && !is_held) blocks->nodes[d][blocks->n[d]++] = node;
      else blocks->inverse[dof] = is_held ? 1 : diagonal > 0 ? 1 / diagonal : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCreateMassBlocks(Body body, MassBlocks *created)
{
  const PetscInt dim = body->mesh.dim;
  MassBlocks     blocks;
  Mat            of_nodes = body->mass.of_nodes;

  PetscFunctionBegin;
  if (body->rows.size > 1) PetscCall(MatMPIAIJGetSeqAIJ(of_nodes, &of_nodes, NULL, NULL)); /* of other ranks there are no nodes */
  PetscCall(PetscNew(&blocks));
  PetscCall(PetscCalloc1(body->mesh.owned_nodes * dim, &blocks->inverse));
  for (PetscInt d = 0; d < dim; d++) PetscCall(PetscMalloc1(body->mesh.owned_nodes, &blocks->nodes[d]));
  PetscCall(Divide(body, blocks, of_nodes));
  for (PetscInt d = 0; d < dim; d++) {
    if (d && blocks->n[d] == blocks->n[d - 1])
      PetscCall(PetscArraycmp(blocks->nodes[d], blocks->nodes[d - 1], (size_t)blocks->n[d], &blocks->same[d]));
    if (!blocks->same[d] && blocks->n[d]) PetscCall(FactorBlock(blocks, d, of_nodes));
    PetscCall(VecCreateSeq(PETSC_COMM_SELF, blocks->n[d], &blocks->b[d]));
    PetscCall(VecDuplicate(blocks->b[d], &blocks->x[d]));
  }
  *created = blocks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a = M^{-1} f, as BodySolveMass() */
PetscErrorCode BodySolveMassBlocks(Body body, MassBlocks blocks, Vec f, Vec a)
{
  const PetscInt     dim    = body->mesh.dim;
  Mat                factor = NULL;
  const PetscScalar *force, *solution;
  PetscScalar       *acceleration, *b;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(f, &force));
  PetscCall(VecGetArrayWrite(a, &acceleration));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++) acceleration[i] = blocks->inverse[i] * force[i];
  for (PetscInt d = 0; d < dim; d++) {
    const PetscInt *nodes = blocks->nodes[d];

    if (!blocks->n[d]) continue;
    if (!blocks->same[d]) factor = blocks->factors[d];
    PetscCall(VecGetArrayWrite(blocks->b[d], &b));
    for (PetscInt k = 0; k < blocks->n[d]; k++) b[k] = force[nodes[k] * dim + d];
    PetscCall(VecRestoreArrayWrite(blocks->b[d], &b));
    PetscCall(MatSolve(factor, blocks->b[d], blocks->x[d]));
    PetscCall(VecGetArrayRead(blocks->x[d], &solution));
    for (PetscInt k = 0; k < blocks->n[d]; k++) acceleration[nodes[k] * dim + d] = solution[k];
    PetscCall(VecRestoreArrayRead(blocks->x[d], &solution));
  }
  PetscCall(VecRestoreArrayWrite(a, &acceleration));
  PetscCall(VecRestoreArrayRead(f, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroyMassBlocks(MassBlocks *blocks)
{
  PetscFunctionBegin;
  if (!*blocks) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < 3; d++) {
    PetscCall(PetscFree((*blocks)->nodes[d]));
    PetscCall(MatDestroy(&(*blocks)->factors[d]));
    PetscCall(VecDestroy(&(*blocks)->b[d]));
    PetscCall(VecDestroy(&(*blocks)->x[d]));
  }
  PetscCall(PetscFree((*blocks)->inverse));
  PetscCall(PetscFree(*blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
