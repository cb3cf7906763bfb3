/* Mass: lumped, consistent or averaged, with the mass of the contact layer moved inside where asked. */
#include <body/layout/bodyimpl.h>
#include <impakt/private/simd.h>

/* Entries of a matrix that are scaled at a time */
#define MAX_COLUMNS 256

const char *const BodyMassTypes[]        = {"lumped", "consistent", "averaged", "BodyMassType", "BODY_MASS_", NULL};
const char *const BodyMassMomentsNames[] = {"total", "centre", "inertia", "BodyMassMoments", "BODY_MASS_", NULL};

static PetscErrorCode AssembleMass(Body body)
{
  const PetscInt dim = body->mesh.dim, nodes = body->model.element->nodes, n = nodes * dim;
  PetscInt       dofs[ELEMENT_MAX_DOFS];
  PetscScalar    of_nodes[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES], M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS] = {0}, diagonal[ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  if (body->mass.type == BODY_MASS_LUMPED) PetscCall(BodyCreateVec(body, &body->mass.diagonal));
  else PetscCall(BodyCreateMatrix(body, NULL, &body->mass.matrix));
  for (PetscInt e = 0; e < body->model.element->count; e++) {
    PetscCall(BodyGetElementMass(body, e, of_nodes));
    PetscCall(BodyGetElementDofs(body, e, dofs));
    for (PetscInt i = 0; i < n; i++) diagonal[i] = of_nodes[i / dim * (nodes + 1)];
    for (PetscInt a = 0; a < nodes && body->mass.matrix; a++)
      for (PetscInt b = 0; b < nodes; b++)
        for (PetscInt d = 0; d < dim; d++) M[(a * dim + d) * n + b * dim + d] = of_nodes[a * nodes + b];
    if (body->mass.diagonal) PetscCall(VecSetValues(body->mass.diagonal, n, dofs, diagonal, ADD_VALUES));
    else PetscCall(MatSetValues(body->mass.matrix, n, dofs, n, dofs, M, ADD_VALUES));
  }
  if (body->mass.diagonal) {
    PetscCall(VecAssemblyBegin(body->mass.diagonal));
    PetscCall(VecAssemblyEnd(body->mass.diagonal));
  } else {
    PetscCall(MatAssemblyBegin(body->mass.matrix, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(body->mass.matrix, MAT_FINAL_ASSEMBLY));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of each row below, on and above the main diagonal of a body of one dimension, if its matrix of one rank has no others: for
   products that look up no columns */
static PetscErrorCode FindDiagonals(Body body)
{
  const PetscInt n    = body->mesh.owned_nodes;
  PetscBool      near = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * n, &body->mass.diagonals));
  for (PetscInt row = 0; row < n; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n_columns;

    PetscCall(MatGetRow(body->mass.matrix, row, &n_columns, &columns, &values));
    for (PetscInt k = 0; k < n_columns; k++) {
      near = (PetscBool)(near && PetscAbsInt(columns[k] - row) <= 1);
      if (near) body->mass.diagonals[(columns[k] - row + 1) * n + row] = values[k];
    }
    PetscCall(MatRestoreRow(body->mass.matrix, row, &n_columns, &columns, &values));
  }
  if (!near) PetscCall(PetscFree(body->mass.diagonals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For products with a mass matrix that is not diagonal: x, y and z of a node have the same masses, and nothing to do with each other */
static PetscErrorCode SetUpProduct(Body body)
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
SIMD_CLONES static void MultiplyDiagonals(PetscInt n, const PetscScalar diagonals[], const PetscScalar x[], PetscScalar y[])
{
  const PetscScalar *below = diagonals, *on = diagonals + n, *above = diagonals + 2 * n;

  y[0] = on[0] * x[0] + (n > 1 ? above[0] * x[1] : 0);
#pragma omp simd
  for (PetscInt i = 1; i < n - 1; i++) y[i] = below[i] * x[i - 1] + on[i] * x[i] + above[i] * x[i + 1];
  if (n > 1) y[n - 1] = below[n - 1] * x[n - 2] + on[n - 1] * x[n - 1];
}

PetscErrorCode BodyMultiplyMass(Body body, Vec x, Vec y)
{
  const PetscScalar *from;
  PetscScalar       *to;

  PetscFunctionBegin;
  if (body->mass.diagonal) PetscCall(VecPointwiseMult(y, body->mass.diagonal, x));
  else if (!body->mass.diagonals) PetscCall(MatMult(body->mass.product, x, y));
  else {
    PetscCall(VecGetArrayRead(x, &from));
    PetscCall(VecGetArrayWrite(y, &to));
    MultiplyDiagonals(body->mesh.owned_nodes, body->mass.diagonals, from, to);
    PetscCall(VecRestoreArrayWrite(y, &to));
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscCall(PetscLogFlops(5.0 * (PetscLogDouble)body->mesh.owned_nodes));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the massless nodes and their displacements, but those that are held */
static PetscErrorCode SetUpLayer(Body body)
{
  PetscInt held = 0;

  PetscFunctionBegin;
  body->layer.n_dofs = 0;
  body->layer.exists = PETSC_FALSE;
  PetscCall(PetscMalloc1(body->mass.redistribute ? body->mesh.owned_nodes * body->mesh.dim : 0, &body->layer.dofs));
  if (!body->mass.redistribute) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++)
    for (PetscInt d = 0; d < body->mesh.dim; d++) {
      const PetscInt dof = node * body->mesh.dim + d;

      while (held < body->held.n && body->held.dofs[held] < dof) held++;
      if (held < body->held.n && body->held.dofs[held] == dof) continue;
      if (body->layer.contains[node]) body->layer.dofs[body->layer.n_dofs++] = dof;
    }
  body->layer.exists = (PetscBool)(body->layer.n_dofs > 0);
  PetscCall(BodyAnyRank(body, &body->layer.exists));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Assembles the mass, and what the explicit integrator needs to divide by it */
PetscErrorCode BodySetUpMass(Body body)
{
  Vec       ones;
  PetscReal sum;

  PetscFunctionBegin;
  PetscCall(SetUpLayer(body));
  if (body->mass.redistribute && !body->mass.extrapolation && !body->mass.moved) PetscCall(BodyFindMassFactor(body, NULL));
  PetscCall(AssembleMass(body));
  if (body->mass.redistribute && body->mass.extrapolation) PetscCall(BodyExtrapolateMass(body));
  PetscCall(SetUpProduct(body));
  PetscCall(BodyCreateVec(body, &body->mass.row_sum));
  PetscCall(BodyCreateVec(body, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(BodyMultiplyMass(body, ones, body->mass.row_sum));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecSum(body->mass.row_sum, &sum));
  body->mass.total = sum / body->mesh.dim;
  PetscCall(BodySetUpInertia(body));
  if (body->mass.diagonal) {
    PetscScalar       *inverse;
    const PetscScalar *mass;

    PetscCall(BodyCreateVec(body, &body->mass.inverse));
    PetscCall(VecGetArrayRead(body->mass.diagonal, &mass));
    PetscCall(VecGetArrayWrite(body->mass.inverse, &inverse));
    for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) inverse[i] = mass[i] > 0 ? 1 / mass[i] : 0;
    PetscCall(VecRestoreArrayWrite(body->mass.inverse, &inverse));
    PetscCall(VecRestoreArrayRead(body->mass.diagonal, &mass));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Factors of a mass matrix that is not diagonal, ones on massless nodes: from the start, or for an implicit body's first acceleration. */
PetscErrorCode BodySetUpMassSolver(Body body)
{
  Mat      solvable;
  char     prefix[128];
  PetscInt rstart;

  PetscFunctionBegin;
  if (body->mass.of_nodes && (body->rows.size == 1 || body->mesh.whole)) {
    if (!body->mass.blocks) PetscCall(BodyCreateMassBlocks(body, &body->mass.blocks));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatDuplicate(body->mass.matrix, MAT_COPY_VALUES, &solvable));
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  for (PetscInt i = 0; i < body->layer.n_dofs; i++)
    PetscCall(MatSetValue(solvable, rstart + body->layer.dofs[i], rstart + body->layer.dofs[i], 1, ADD_VALUES));
  PetscCall(MatAssemblyBegin(solvable, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(solvable, MAT_FINAL_ASSEMBLY));
  PetscCall(BodyEliminateHeld(body, solvable));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%smass_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(solvable, body->rows.free_matrix, body->mesh.dim, prefix, PETSC_FALSE, &body->mass.solver));
  PetscCall(MatDestroy(&solvable));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A += scale M of a matrix with some of the entries of A */
static PetscErrorCode AddRows(Mat M, PetscReal scale, Mat A)
{
  PetscScalar scaled[MAX_COLUMNS];
  PetscInt    begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(M, row, &n, &columns, &values));
    for (PetscInt first = 0; first < n; first += MAX_COLUMNS) {
      const PetscInt part = PetscMin(MAX_COLUMNS, n - first);

      for (PetscInt k = 0; k < part; k++) scaled[k] = scale * values[first + k];
      PetscCall(MatSetValues(A, 1, &row, part, columns + first, scaled, ADD_VALUES));
    }
    PetscCall(MatRestoreRow(M, row, &n, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A += scale M; held dofs and massless nodes too */
PetscErrorCode BodyAddMassMatrix(Body body, PetscReal scale, Mat A)
{
  Vec         diagonal = body->work.nodes[0];
  Mat         mass     = body->mass.matrix;
  PetscMPIInt size;

  PetscFunctionBegin;
  if (body->mass.diagonal) {
    PetscCall(VecCopy(body->mass.diagonal, diagonal));
    PetscCall(VecScale(diagonal, scale));
    PetscCall(MatDiagonalSet(A, diagonal, ADD_VALUES));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)A), &size));
  if (size < body->rows.size) PetscCall(MatMPIAIJGetSeqAIJ(mass, &mass, NULL, NULL)); /* A is the block of this rank */
  if (body->mass.of_nodes) PetscCall(AddRows(mass, scale, A));
  else PetscCall(MatAXPY(A, scale, mass, SAME_NONZERO_PATTERN)); /* a subset would take memory in each call */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a = M^{-1} f, zero on massless nodes. Unless the mass is diagonal, held dofs of f are accelerations, see BodySubtractHeldInertia(). */
PetscErrorCode BodySolveMass(Body body, Vec f, Vec a)
{
  PetscScalar *array;

  PetscFunctionBegin;
  if (!body->integrator->has_inertia) PetscCall(VecZeroEntries(a));
  else if (body->integrator->ops.solvemass) PetscCall((*body->integrator->ops.solvemass)(body, f, a));
  else if (body->mass.inverse) PetscCall(VecPointwiseMult(a, body->mass.inverse, f));
  else {
    if (!body->mass.solver) PetscCall(BodySetUpMassSolver(body));
    if (body->mass.blocks) {
      PetscCall(BodySolveMassBlocks(body, body->mass.blocks, f, a));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(ConstrainedSolverSolve(body->mass.solver, f, a));
    PetscCall(VecGetArray(a, &array));
    for (PetscInt i = 0; i < body->layer.n_dofs; i++) array[body->layer.dofs[i]] = 0;
    PetscCall(VecRestoreArray(a, &array));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether forces on rows accelerate the nodes that they act on alone */
PetscBool BodyAnswersByNodes(Body body)
{
  return (PetscBool)(body->mass.inverse && body->integrator->has_inertia && !body->integrator->ops.solvemass && !body->layer.exists);
}
