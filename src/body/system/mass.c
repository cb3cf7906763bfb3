/* Mass: lumped, consistent or averaged, with the mass of the contact layer moved inside where asked. */
#include <body/layout/bodyimpl.h>

const char *const BodyMassTypes[] = {"lumped", "consistent", "averaged", "BodyMassType", "BODY_MASS_", NULL};

/* The mass matrix of one element as the body uses it, row by row */
PetscErrorCode BodyGetElementMass(Body body, PetscInt e, PetscScalar M[])
{
  const PetscInt *nodes   = body->connectivity + e * body->element->nodes;
  const PetscInt  n_nodes = body->element->nodes, dim = body->dim, n = n_nodes * dim;
  PetscInt        inner = 0;

  PetscFunctionBegin;
  PetscCall((*body->element->ops->mass)(body->element, e, M));
  if (body->mass_type != BODY_MASS_CONSISTENT) {
    const PetscReal lumped = body->mass_type == BODY_MASS_LUMPED ? 1.0 : 0.5;

    for (PetscInt i = 0; i < n; i++) {
      PetscScalar sum = 0;

      for (PetscInt j = 0; j < n; j++) {
        sum += M[i * n + j];
        M[i * n + j] *= 1 - lumped;
      }
      M[i * n + i] += lumped * sum;
    }
  }
  if (!body->mass_redistribute) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < n_nodes; a++) inner += !body->in_layer[nodes[a]];
  if (inner == n_nodes) PetscFunctionReturn(PETSC_SUCCESS);
  if (!inner) {
    PetscCall(PetscArrayzero(M, n * n)); /* BodyRedistributeOrphans() finds its mass a place */
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt d = 0; d < dim; d++) {
    PetscScalar moved = 0;

    for (PetscInt a = 0; a < n_nodes; a++)
      for (PetscInt b = 0; b < n_nodes; b++)
        if (body->in_layer[nodes[a]] || body->in_layer[nodes[b]]) {
          moved += M[(a * dim + d) * n + b * dim + d];
          M[(a * dim + d) * n + b * dim + d] = 0;
        }
    for (PetscInt a = 0; a < n_nodes; a++)
      if (!body->in_layer[nodes[a]]) M[(a * dim + d) * n + a * dim + d] += moved / inner;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AssembleMass(Body body)
{
  const PetscInt n = body->element->nodes * body->dim;
  PetscInt       dofs[ELEMENT_MAX_DOFS];
  PetscScalar    M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], diagonal[ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  if (body->mass_type == BODY_MASS_LUMPED) PetscCall(BodyCreateVec(body, &body->mass_diagonal));
  else PetscCall(BodyCreateMatrix(body, &body->mass_matrix));
  for (PetscInt e = 0; e < body->element->count; e++) {
    PetscCall(BodyGetElementMass(body, e, M));
    PetscCall(BodyGetElementDofs(body, e, dofs));
    for (PetscInt i = 0; i < n; i++) diagonal[i] = M[i * n + i];
    if (body->mass_diagonal) PetscCall(VecSetValues(body->mass_diagonal, n, dofs, diagonal, ADD_VALUES));
    else PetscCall(MatSetValues(body->mass_matrix, n, dofs, n, dofs, M, ADD_VALUES));
  }
  if (body->mass_diagonal) {
    PetscCall(VecAssemblyBegin(body->mass_diagonal));
    PetscCall(VecAssemblyEnd(body->mass_diagonal));
  } else {
    PetscCall(MatAssemblyBegin(body->mass_matrix, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(body->mass_matrix, MAT_FINAL_ASSEMBLY));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mass times position, summed over this rank's elements as the shape functions have it, and over its nodes as the body has it */
static PetscErrorCode ComputeMassShift(Body body)
{
  const PetscInt     n = body->element->nodes, dim = body->dim;
  PetscScalar        M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];
  PetscReal          sums[3] = {0};
  const PetscScalar *mass;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < body->element->count; e++) {
    const PetscInt *nodes = body->connectivity + e * n;
    PetscBool       moved = PETSC_FALSE;

    for (PetscInt a = 0; a < n; a++) moved = (PetscBool)(moved || body->in_layer[nodes[a]]);
    if (!moved) continue;
    PetscCall((*body->element->ops->mass)(body->element, e, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++)
        for (PetscInt d = 0; d < dim; d++) sums[d] -= M[(a * dim) * n * dim + b * dim] * body->coordinates[nodes[a] * dim + d];
    PetscCall(BodyGetElementMass(body, e, M));
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++)
        for (PetscInt d = 0; d < dim; d++) sums[d] += M[(a * dim) * n * dim + b * dim] * body->coordinates[nodes[a] * dim + d];
  }
  if (body->orphan_mass) {
    PetscCall(VecGetArrayRead(body->orphan_mass, &mass));
    for (PetscInt i = 0; i < body->owned_nodes * dim; i++) sums[i % dim] += mass[i] * body->coordinates[i];
    PetscCall(VecRestoreArrayRead(body->orphan_mass, &mass));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt d = 0; d < dim; d++) body->mass_shift[d] = sums[d] / body->total_mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the massless nodes and their displacements, but those that are held */
static PetscErrorCode SetUpLayer(Body body)
{
  PetscInt held = 0;

  PetscFunctionBegin;
  body->n_layer_dofs = 0;
  PetscCall(PetscMalloc1(body->mass_redistribute ? body->owned_nodes * body->dim : 0, &body->layer_dofs));
  if (!body->mass_redistribute) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt node = 0; node < body->owned_nodes; node++)
    for (PetscInt d = 0; d < body->dim; d++) {
      const PetscInt dof = node * body->dim + d;

      while (held < body->n_held && body->held_dofs[held] < dof) held++;
      if (held < body->n_held && body->held_dofs[held] == dof) continue;
      if (body->in_layer[node]) body->layer_dofs[body->n_layer_dofs++] = dof;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Assembles the mass, and what the explicit integrator needs to divide by it */
PetscErrorCode BodySetUpMass(Body body)
{
  Vec       ones;
  PetscReal sum;

  PetscFunctionBegin;
  PetscCall(SetUpLayer(body));
  PetscCall(AssembleMass(body));
  if (body->mass_redistribute) PetscCall(BodyRedistributeOrphans(body));
  PetscCall(BodyCreateVec(body, &body->mass_row_sum));
  PetscCall(BodyCreateVec(body, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(BodyMultiplyMass(body, ones, body->mass_row_sum));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecSum(body->mass_row_sum, &sum));
  body->total_mass = sum / body->dim;
  if (body->mass_redistribute) PetscCall(ComputeMassShift(body));
  if (body->mass_diagonal) {
    PetscScalar       *inverse;
    const PetscScalar *mass;

    PetscCall(BodyCreateVec(body, &body->inverse_mass));
    PetscCall(VecGetArrayRead(body->mass_diagonal, &mass));
    PetscCall(VecGetArrayWrite(body->inverse_mass, &inverse));
    for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) inverse[i] = mass[i] > 0 ? 1 / mass[i] : 0;
    PetscCall(VecRestoreArrayWrite(body->inverse_mass, &inverse));
    PetscCall(VecRestoreArrayRead(body->mass_diagonal, &mass));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factors of a mass matrix that is not diagonal, with ones in place of the massless nodes. Explicit bodies have them from
   the start; an implicit one needs them at most once, for its first acceleration. */
PetscErrorCode BodySetUpMassSolver(Body body)
{
  Mat      solvable;
  char     prefix[128];
  PetscInt rstart;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(body->mass_matrix, MAT_COPY_VALUES, &solvable));
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  for (PetscInt i = 0; i < body->n_layer_dofs; i++)
    PetscCall(MatSetValue(solvable, rstart + body->layer_dofs[i], rstart + body->layer_dofs[i], 1, ADD_VALUES));
  PetscCall(MatAssemblyBegin(solvable, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(solvable, MAT_FINAL_ASSEMBLY));
  PetscCall(BodyEliminateHeld(body, solvable));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%smass_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(solvable, body->free_rows, body->dim, prefix, &body->mass_solver));
  PetscCall(BodySetConstraints(body)); /* rows may be prescribed already */
  PetscCall(MatDestroy(&solvable));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M x */
PetscErrorCode BodyMultiplyMass(Body body, Vec x, Vec y)
{
  PetscFunctionBegin;
  if (body->mass_diagonal) PetscCall(VecPointwiseMult(y, body->mass_diagonal, x));
  else PetscCall(MatMult(body->mass_matrix, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyHeld(Body body, Vec from, Vec to)
{
  const PetscScalar *source;
  PetscScalar       *target;

  PetscFunctionBegin;
  if (!body->any_held) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(from, &source));
  PetscCall(VecGetArray(to, &target));
  for (PetscInt i = 0; i < body->n_held; i++) target[body->held_dofs[i]] = source[body->held_dofs[i]];
  PetscCall(VecRestoreArray(to, &target));
  PetscCall(VecRestoreArrayRead(from, &source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes what held dofs with their acceleration at time t do to the others, through a mass matrix that is not diagonal, out of the force f;
   on held dofs it becomes that acceleration, for the solver which has rows of the identity there. `work` is overwritten. */
PetscErrorCode BodyAddHeldInertia(Body body, PetscReal t, Vec f, Vec work)
{
  PetscFunctionBegin;
  if (!body->any_held || body->mass_diagonal || body->is_static) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecZeroEntries(body->work[2]));
  PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, body->work[2]));
  PetscCall(MatMult(body->mass_matrix, body->work[2], work));
  PetscCall(VecAXPY(f, -1, work));
  PetscCall(CopyHeld(body, body->work[2], f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a = M^{-1} f, zero on massless nodes; where `prescribed` is given, with the acceleration of prescribed rows at that
   position of the controller step. f is that of BodyAddHeldInertia(), and is used as work space. */
PetscErrorCode BodySolveMass(Body body, Vec f, PetscReal position, PetscBool prescribed, Vec a)
{
  PetscFunctionBegin;
  if (body->is_static) PetscCall(VecZeroEntries(a));
  else if (body->inverse_mass) {
    PetscCall(VecPointwiseMult(a, body->inverse_mass, f));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, a));
  } else {
    PetscScalar *array;

    if (!body->mass_solver) PetscCall(BodySetUpMassSolver(body));
    if (prescribed) {
      PetscCall(VecZeroEntries(body->work[1]));
      PetscCall(CopyHeld(body, f, body->work[1]));
      PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, body->work[1]));
      PetscCall(BodyZeroHeld(body, body->work[1]));
      PetscCall(MatMult(body->mass_matrix, body->work[1], a));
      PetscCall(VecAXPY(f, -1, a));
    }
    PetscCall(ConstrainedSolverSolve(body->mass_solver, f, a));
    if (prescribed) PetscCall(VecAXPY(a, 1, body->work[1]));
    PetscCall(VecGetArray(a, &array));
    for (PetscInt i = 0; i < body->n_layer_dofs; i++) array[body->layer_dofs[i]] = 0;
    PetscCall(VecRestoreArray(a, &array));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
