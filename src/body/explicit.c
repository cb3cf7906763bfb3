/* A body under central differences. */
#include "bodyimpl.h"

/* Displacement of the massless layer by static balance with the rest as it is: K_LL du = (contact forces - internal force)_L,
   with prescribed rows held and Robin rows on their springs. One round is exact for linear materials. */
static PetscErrorCode BalanceLayer(Body body, PetscReal position, Vec u)
{
  Vec force = body->work[0];

  PetscFunctionBegin;
  PetscCall(BodyComputeInternalForce(body, u, body->internal_force));
  PetscCall(VecCopy(body->internal_force, force));
  PetscCall(VecScale(force, -1));
  PetscCall(BodyAddContactForce(body, position, 1, u, force));
  PetscCall(VecScatterBegin(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(ConstrainedSolverSolve(body->solver, body->layer_rhs, body->layer_solution));
  PetscCall(VecScatterBegin(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSCentralDifferenceFn`: contact conditions on U, then the acceleration it brings about */
static PetscErrorCode ComputeAcceleration(TS ts, PetscReal t, Vec U, Vec V, Vec A, void *ctx)
{
  Body            body       = (Body)ctx;
  const PetscReal position   = (PetscReal)(body->substep + 1) / body->substeps;
  const PetscBool prescribed = (PetscBool)(body->n_prescribed && body->prescribed_mass);
  Vec             force      = body->work[0];

  PetscFunctionBegin;
  (void)ts;
  (void)t;
  (void)V;
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, position, U));
  if (body->layer_scatter) PetscCall(BalanceLayer(body, position, U));
  PetscCall(BodyComputeInternalForce(body, U, body->internal_force));
  if (body->inverse_mass && !body->n_forced) {
    PetscCall(VecPointwiseMult(A, body->inverse_mass, body->internal_force));
    PetscCall(VecScale(A, -1));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecCopy(body->internal_force, force));
  PetscCall(VecScale(force, -1));
  PetscCall(BodyAddContactForce(body, position, 1, U, force));
  PetscCall(BodySolveMass(body, force, position, prescribed, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness of the massless layer alone, factored once */
static PetscErrorCode SetUpLayerBalance(Body body)
{
  Mat      K, B;
  IS       rows;
  PetscInt rstart, *global, row_begin;
  char     prefix[128];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->positions, &rstart, NULL));
  PetscCall(PetscMalloc1(body->n_layer_dofs, &global));
  for (PetscInt i = 0; i < body->n_layer_dofs; i++) global[i] = rstart + body->layer_dofs[i];
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)body), body->n_layer_dofs, global, PETSC_OWN_POINTER, &body->layer_is));
  PetscCall(MatCreateSubMatrix(body->stiffness, body->layer_is, body->layer_is, MAT_INITIAL_MATRIX, &K));
  PetscCall(MatGetOwnershipRange(body->interface, &row_begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, row_begin, 1, &rows));
  PetscCall(MatCreateSubMatrix(body->interface, rows, body->layer_is, MAT_INITIAL_MATRIX, &B));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%slayer_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(K, B, prefix, &body->solver));
  PetscCall(MatCreateVecs(K, &body->layer_solution, &body->layer_rhs));
  PetscCall(VecScatterCreate(body->state.u, body->layer_is, body->layer_rhs, NULL, &body->layer_scatter));
  PetscCall(ISDestroy(&rows));
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
  PetscFunctionReturn(PETSC_SUCCESS);
}
