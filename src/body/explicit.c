/* A body under central differences. */
#include "bodyimpl.h"

/* Rounds of chord Newton's method that the layer of a nonlinear body may take, and when it is in balance: the last change, relative to
   the largest one, or to the displacement and the reference positions of the body, which round-off hangs on */
#define MAX_BALANCE_ROUNDS 100
#define BALANCE_TOLERANCE  1e-12
#define BALANCE_ROUND_OFF  (4 * PETSC_MACHINE_EPSILON)

/* Displacement of the massless layer by static balance with the rest as it is: K_LL du = (forces - internal force)_L, with prescribed
   rows held and Robin rows on their springs. One round is exact for linear materials; others repeat it with the undeformed layer's
   factors. */
static PetscErrorCode BalanceLayer(Body body, PetscReal time, PetscReal position, Vec u)
{
  Vec       force = body->work[0];
  PetscReal first = 0, round_off = 0, size;

  PetscFunctionBegin;
  if (!body->linear) {
    PetscCall(VecNorm(u, NORM_2, &size));
    PetscCall(VecNorm(body->positions, NORM_2, &round_off));
    round_off = BALANCE_ROUND_OFF * (round_off + size);
  }
  for (PetscInt round = 0; round < (body->linear ? 1 : MAX_BALANCE_ROUNDS); round++) {
    PetscReal change;

    PetscCall(BodyComputeInternalForce(body, u, body->internal_force));
    PetscCall(VecCopy(body->internal_force, force));
    PetscCall(VecScale(force, -1));
    PetscCall(BodyAddExternalForce(body, time, 1, force));
    PetscCall(BodyAddContactForce(body, position, 1, u, force));
    PetscCall(VecScatterBegin(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(ConstrainedSolverSolve(body->solver, body->layer_rhs, body->layer_solution));
    PetscCall(VecScatterBegin(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecScatterEnd(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
    if (body->linear) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(VecNorm(body->layer_solution, NORM_2, &change));
    first = PetscMax(first, change);
    /* what is not a number is told when the substep is over */
    if (change <= BALANCE_TOLERANCE * first + round_off || PetscIsInfOrNanReal(change)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  SETERRQ(PetscObjectComm((PetscObject)body), PETSC_ERR_NOT_CONVERGED, "Body '%s': the massless contact layer found no balance in %d rounds at time %.9g s; choose a smaller -%sts_time_step, or -%smass_redistribute false", body->hdr.name, MAX_BALANCE_ROUNDS, (double)time, ((PetscObject)body)->prefix, ((PetscObject)body)->prefix);
}

/* a = -f / m in one pass */
static PetscErrorCode DivideByMass(Body body, Vec A)
{
  const PetscScalar *force, *inverse;
  PetscScalar       *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->internal_force, &force));
  PetscCall(VecGetArrayRead(body->inverse_mass, &inverse));
  PetscCall(VecGetArrayWrite(A, &a));
  for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) a[i] = -force[i] * inverse[i];
  PetscCall(VecRestoreArrayWrite(A, &a));
  PetscCall(VecRestoreArrayRead(body->inverse_mass, &inverse));
  PetscCall(VecRestoreArrayRead(body->internal_force, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSCentralDifferenceFn`: held and contact conditions on U, then the acceleration it brings about */
static PetscErrorCode ComputeAcceleration(TS ts, PetscReal t, Vec U, Vec V, Vec A, void *ctx)
{
  Body            body       = (Body)ctx;
  const PetscReal position   = (PetscReal)(body->substep + 1) / body->substeps;
  const PetscBool prescribed = (PetscBool)(body->n_prescribed && body->prescribed_mass);
  Vec             force      = body->work[0];

  PetscFunctionBegin;
  (void)ts;
  (void)V;
  PetscCall(BodyPrescribeHeld(body, t, U, NULL, NULL));
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, position, U));
  if (body->layer_scatter) PetscCall(BalanceLayer(body, t, position, U));
  PetscCall(BodyComputeInternalForce(body, U, body->internal_force));
  if (body->inverse_mass && !body->n_forced && !body->loads) {
    PetscCall(DivideByMass(body, A));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecCopy(body->internal_force, force));
  PetscCall(VecScale(force, -1));
  PetscCall(BodyAddExternalForce(body, t, 1, force));
  PetscCall(BodyAddContactForce(body, position, 1, U, force));
  PetscCall(BodyAddHeldInertia(body, t, force, A));
  PetscCall(BodySolveMass(body, force, position, prescribed, A));
  PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of each dof of this rank's nodes, ghosts too, within the layer; -1 for others */
static PetscErrorCode NumberLayer(Body body, PetscInt first, Vec *numbers, PetscScalar **number)
{
  PetscScalar *array;
  Vec          local;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, numbers));
  PetscCall(VecSet(*numbers, -1));
  PetscCall(VecGetArray(*numbers, &array));
  for (PetscInt i = 0; i < body->n_layer_dofs; i++) array[body->layer_dofs[i]] = first + i;
  PetscCall(VecRestoreArray(*numbers, &array));
  local = *numbers;
  if (body->rows.size > 1) {
    PetscCall(VecGhostUpdateBegin(*numbers, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostUpdateEnd(*numbers, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostGetLocalForm(*numbers, &local));
  }
  PetscCall(PetscMalloc1(body->local_nodes * body->dim, number));
  PetscCall(VecGetArray(local, &array));
  PetscCall(PetscArraycpy(*number, array, body->local_nodes * body->dim));
  PetscCall(VecRestoreArray(local, &array));
  if (body->rows.size > 1) PetscCall(VecGhostRestoreLocalForm(*numbers, &local));
  PetscCall(VecDestroy(numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stiffness of the massless layer, from the elements that touch it: the whole body's matrix would be many times as large */
static PetscErrorCode AssembleLayer(Body body, Mat *K)
{
  const PetscInt n = body->element->nodes * body->dim;
  PetscInt       end, dofs[ELEMENT_MAX_DOFS];
  PetscScalar    element[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], *number, *zero;
  Vec            numbers;

  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)body), K));
  PetscCall(MatSetSizes(*K, body->n_layer_dofs, body->n_layer_dofs, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*K, MATAIJ));
  PetscCall(MatSetUp(*K));
  PetscCall(MatSetOption(*K, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatGetOwnershipRange(*K, &end, NULL));
  PetscCall(NumberLayer(body, end, &numbers, &number));
  PetscCall(PetscCalloc1(body->local_nodes * body->dim, &zero));
  for (PetscInt e = 0; e < body->element->count; e++) {
    const PetscInt *nodes   = body->connectivity + e * body->element->nodes;
    PetscBool       touches = PETSC_FALSE;

    for (PetscInt i = 0; i < n; i++) {
      dofs[i] = (PetscInt)number[nodes[i / body->dim] * body->dim + i % body->dim];
      if (dofs[i] >= 0) touches = PETSC_TRUE;
    }
    if (!touches) continue;
    PetscCall((*body->element->ops.stiffness)(body->element, e, zero, element));
    PetscCall(MatSetValues(*K, n, dofs, n, dofs, element, ADD_VALUES));
  }
  PetscCall(PetscFree(zero));
  PetscCall(PetscFree(number));
  PetscCall(MatAssemblyBegin(*K, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*K, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the interface as the layer sees them */
PetscErrorCode BodySetUpLayerRows(Body body, Mat *B)
{
  IS       rows;
  PetscInt row_begin;
  Mat      free_rows;

  PetscFunctionBegin;
  PetscCall(BodyCreateFreeRows(body, &free_rows));
  PetscCall(MatGetOwnershipRange(free_rows, &row_begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, row_begin, 1, &rows));
  PetscCall(MatCreateSubMatrix(free_rows, rows, body->layer_is, MAT_INITIAL_MATRIX, B));
  PetscCall(ISDestroy(&rows));
  PetscCall(MatDestroy(&free_rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The layer's balance, its matrix factored once */
static PetscErrorCode SetUpLayerBalance(Body body)
{
  Mat      K, B;
  PetscInt rstart, *global;
  char     prefix[128];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  PetscCall(PetscMalloc1(body->n_layer_dofs, &global));
  for (PetscInt i = 0; i < body->n_layer_dofs; i++) global[i] = rstart + body->layer_dofs[i];
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)body), body->n_layer_dofs, global, PETSC_OWN_POINTER, &body->layer_is));
  PetscCall(AssembleLayer(body, &K));
  PetscCall(BodySetUpLayerRows(body, &B));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%slayer_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(K, B, body->dim, prefix, &body->solver));
  PetscCall(MatCreateVecs(K, &body->layer_solution, &body->layer_rhs));
  PetscCall(VecScatterCreate(body->state.u, body->layer_is, body->layer_rhs, NULL, &body->layer_scatter));
  PetscCall(MatDestroy(&K));
  PetscCall(MatDestroy(&B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodySetUpExplicit(Body body)
{
  PetscInt layer = body->n_layer_dofs;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &layer, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)body)));
  if (layer) PetscCall(SetUpLayerBalance(body));
  if (body->mass_matrix) PetscCall(BodySetUpMassSolver(body));
  PetscCall(TSCentralDifferenceSetAcceleration(body->ts, ComputeAcceleration, body));
  PetscCall(TSCentralDifferenceSetAccelerationVec(body->ts, body->state.a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity of prescribed and massless nodes */
PetscErrorCode BodyFinishSubstepExplicit(Body body)
{
  PetscFunctionBegin;
  if (body->layer_scatter) {
    const PetscScalar *u0, *u1;
    PetscScalar       *v;

    PetscCall(VecGetArrayRead(body->substep_start.u, &u0));
    PetscCall(VecGetArrayRead(body->state.u, &u1));
    PetscCall(VecGetArray(body->state.v, &v));
    for (PetscInt i = 0; i < body->n_layer_dofs; i++) v[body->layer_dofs[i]] = (u1[body->layer_dofs[i]] - u0[body->layer_dofs[i]]) / body->time_step;
    PetscCall(VecRestoreArray(body->state.v, &v));
    PetscCall(VecRestoreArrayRead(body->state.u, &u1));
    PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  }
  if (body->prescribed_mass) PetscCall(BodyPrescribe(body, body->traces.velocity_in, (PetscReal)(body->substep + 1) / body->substeps, body->state.v));
  PetscCall(BodyPrescribeHeld(body, body->time, NULL, body->state.v, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
