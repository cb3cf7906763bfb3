/* A body under central differences. */
#include <body/layout/bodyimpl.h>

/* Rounds of chord Newton's method that the layer of a nonlinear body may take, and when it is in balance: the last change, relative to
   the largest one, or to the displacement and the reference positions of the body, which round-off hangs on */
#define MAX_BALANCE_ROUNDS 100
#define SLOW_ROUNDS        20 /* after so many the layer's matrix is made anew before the next balance */
#define BALANCE_TOLERANCE  1e-12
#define BALANCE_ROUND_OFF  (4 * PETSC_MACHINE_EPSILON)

/* Whether anything but elements pulls at the body: loads, or contact unless that is left out */
static PetscBool HasOutsideForce(Body body, PetscBool contact)
{
  return (PetscBool)(body->loads || (contact && body->n_forced));
}

static PetscErrorCode ComputeOutsideForce(Body body, PetscReal time, PetscReal position, PetscBool contact, Vec u, Vec force)
{
  PetscFunctionBegin;
  PetscCall(VecZeroEntries(force));
  PetscCall(BodyAddExternalForce(body, time, 1, force));
  if (contact) PetscCall(BodyAddContactForce(body, position, 1, u, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With contact: under the constraints of the rows; else as if there were no rows */
static PetscErrorCode SolveLayer(Body body, PetscBool contact)
{
  KSP ksp;

  PetscFunctionBegin;
  if (contact) PetscCall(ConstrainedSolverSolve(body->solver, body->layer_rhs, body->layer_solution));
  else {
    PetscCall(ConstrainedSolverGetKSP(body->solver, &ksp));
    PetscCall(KSPSolve(ksp, body->layer_rhs, body->layer_solution));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefactorLayer(Body body, Vec u)
{
  KSP ksp;
  Mat K;

  PetscFunctionBegin;
  PetscCall(ConstrainedSolverGetKSP(body->solver, &ksp));
  PetscCall(KSPGetOperators(ksp, &K, NULL));
  PetscCall(BodyAssembleLayer(body, u, K));
  PetscCall(ConstrainedSolverRefactor(body->solver));
  body->layer_slow = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement of the massless layer by static balance with the rest as it is: K_LL du = (forces - internal force)_L, with prescribed
   rows held and Robin rows on their springs. One round is exact for linear materials; others repeat it with the factors of the undeformed
   layer, or, since a body that turns makes these worse (23 degrees are too many), of one as it was when they became slow. `force` becomes
   that of ComputeOutsideForce(), where there is any. */
static PetscErrorCode BalanceLayer(Body body, PetscReal time, PetscReal position, PetscBool contact, Vec u, Vec force)
{
  const PetscBool outside = HasOutsideForce(body, contact), linear = (PetscBool)(body->linear || body->linearized),
                  robin = (PetscBool)(contact && body->n_robin);
  PetscReal       first = 0, round_off = 0;

  PetscFunctionBegin;
  if (!linear) {
    if (body->layer_slow) PetscCall(RefactorLayer(body, u));
    PetscCall(VecNorm(u, NORM_2, &round_off));
    round_off = BALANCE_ROUND_OFF * (round_off + body->layer_reach);
  }
  if (outside) PetscCall(ComputeOutsideForce(body, time, position, contact, u, force));
  for (PetscInt round = 0; round < (linear ? 1 : MAX_BALANCE_ROUNDS); round++) {
    PetscReal change;

    if (round && robin) PetscCall(ComputeOutsideForce(body, time, position, contact, u, force));
    if (outside) {
      PetscCall(VecScatterBegin(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
      PetscCall(VecScatterEnd(body->layer_scatter, force, body->layer_rhs, INSERT_VALUES, SCATTER_FORWARD));
    } else PetscCall(VecZeroEntries(body->layer_rhs));
    PetscCall(BodySubtractLayerForce(body, u, body->layer_rhs));
    PetscCall(SolveLayer(body, contact));
    PetscCall(VecScatterBegin(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecScatterEnd(body->layer_scatter, body->layer_solution, u, ADD_VALUES, SCATTER_REVERSE));
    if (linear) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(VecNorm(body->layer_solution, NORM_2, &change));
    first = PetscMax(first, change);
    /* what is not a number is told when the substep is over */
    body->layer_slow = (PetscBool)(round + 1 >= SLOW_ROUNDS);
    if (change <= BALANCE_TOLERANCE * first + round_off || PetscIsInfOrNanReal(change)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  SETERRQ(PetscObjectComm((PetscObject)body), PETSC_ERR_NOT_CONVERGED,
          "Body '%s': the massless contact layer found no balance in %d rounds at time %.9g s; choose a smaller -%sts_time_step, or "
          "-%smass_redistribute false",
          body->hdr.name, MAX_BALANCE_ROUNDS, (double)time, ((PetscObject)body)->prefix, ((PetscObject)body)->prefix);
}

/* a = (force - internal force) / m in one pass; without a force, where it is NULL */
static PetscErrorCode DivideByMass(Body body, Vec force, Vec A)
{
  const PetscInt     n = body->owned_nodes * body->dim;
  const PetscScalar *internal, *inverse, *outside;
  PetscScalar       *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->internal_force, &internal));
  PetscCall(VecGetArrayRead(body->inverse_mass, &inverse));
  PetscCall(VecGetArrayWrite(A, &a));
  if (force) {
    PetscCall(VecGetArrayRead(force, &outside));
    for (PetscInt i = 0; i < n; i++) a[i] = (outside[i] - internal[i]) * inverse[i];
    PetscCall(VecRestoreArrayRead(force, &outside));
  } else {
    for (PetscInt i = 0; i < n; i++) a[i] = -internal[i] * inverse[i];
  }
  PetscCall(VecRestoreArrayWrite(A, &a));
  PetscCall(VecRestoreArrayRead(body->inverse_mass, &inverse));
  PetscCall(VecRestoreArrayRead(body->internal_force, &internal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* a = M^{-1} f with a mass matrix that is not diagonal, where a is prescribed on some rows and on held dofs, whose part of f is their
   acceleration already: what is prescribed is taken to the right-hand side. f is overwritten. */
static PetscErrorCode SolveMassPrescribed(Body body, Vec f, PetscReal position, Vec a)
{
  Vec prescribed = body->work[1];

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(prescribed));
  PetscCall(BodyCopyHeld(body, f, prescribed));
  PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, prescribed));
  PetscCall(BodyZeroHeld(body, prescribed));
  PetscCall(MatMult(body->mass_matrix, prescribed, a));
  PetscCall(VecAXPY(f, -1, a));
  PetscCall(BodySolveMass(body, f, a));
  PetscCall(VecAXPY(a, 1, prescribed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `TSCentralDifferenceFn`: held and contact conditions on U, then the acceleration it brings about */
static PetscErrorCode ComputeAcceleration(TS ts, PetscReal t, Vec U, Vec V, Vec A, void *ctx)
{
  Body            body       = (Body)ctx;
  const PetscReal position   = (PetscReal)(body->substep + 1) / body->substeps;
  const PetscBool prescribed = (PetscBool)(body->n_prescribed && body->prescribed_mass), outside = HasOutsideForce(body, PETSC_TRUE);
  Vec             force = body->work[0];

  PetscFunctionBegin;
  (void)ts;
  (void)V;
  PetscCall(BodyPrescribeHeld(body, t, U, NULL, NULL));
  PetscCall(BodyPrescribe(body, body->traces.displacement_in, position, U));
  if (body->layer_scatter) PetscCall(BalanceLayer(body, t, position, PETSC_TRUE, U, force));
  /* Robin rows have moved with the layer */
  if (outside && (!body->layer_scatter || body->n_robin)) PetscCall(ComputeOutsideForce(body, t, position, PETSC_TRUE, U, force));
  PetscCall(BodyComputeInternalForce(body, U, body->internal_force));
  if (body->inverse_mass) {
    PetscCall(DivideByMass(body, outside ? force : NULL, A));
    PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
    if (prescribed) PetscCall(BodyPrescribe(body, body->traces.acceleration_in, position, A));
  } else {
    if (!outside) PetscCall(VecZeroEntries(force));
    PetscCall(VecAXPY(force, -1, body->internal_force));
    PetscCall(BodySubtractHeldInertia(body, t, force, A));
    if (prescribed) PetscCall(SolveMassPrescribed(body, force, position, A));
    else PetscCall(BodySolveMass(body, force, A));
    PetscCall(BodyPrescribeHeld(body, t, NULL, NULL, A));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the interface as the layer sees them */
PetscErrorCode BodySetUpLayerRows(Body body, Mat *B)
{
  IS       rows;
  PetscInt row_begin;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(body->free_rows, &row_begin, NULL));
  PetscCall(ISCreateStride(PetscObjectComm((PetscObject)body), body->rows.local, row_begin, 1, &rows));
  PetscCall(MatCreateSubMatrix(body->free_rows, rows, body->layer_is, MAT_INITIAL_MATRIX, B));
  PetscCall(ISDestroy(&rows));
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
  PetscCall(VecCreate(PetscObjectComm((PetscObject)body), &body->layer_rhs));
  PetscCall(VecSetSizes(body->layer_rhs, body->n_layer_dofs, PETSC_DETERMINE));
  PetscCall(VecSetType(body->layer_rhs, VECSTANDARD));
  PetscCall(VecDuplicate(body->layer_rhs, &body->layer_solution));
  PetscCall(BodySetUpLayerElements(body));
  PetscCall(BodyCreateLayerMatrix(body, &K));
  PetscCall(BodySetUpLayerRows(body, &B));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%slayer_", ((PetscObject)body)->prefix));
  PetscCall(ConstrainedSolverCreate(K, B, body->dim, prefix, &body->solver));
  PetscCall(VecNorm(body->positions, NORM_2, &body->layer_reach));
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
    for (PetscInt i = 0; i < body->n_layer_dofs; i++)
      v[body->layer_dofs[i]] = (u1[body->layer_dofs[i]] - u0[body->layer_dofs[i]]) / body->time_step;
    PetscCall(VecRestoreArray(body->state.v, &v));
    PetscCall(VecRestoreArrayRead(body->state.u, &u1));
    PetscCall(VecRestoreArrayRead(body->substep_start.u, &u0));
  }
  PetscCall(BodyPrescribeHeld(body, body->time, NULL, body->state.v, NULL));
  if (body->prescribed_mass)
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, (PetscReal)(body->substep + 1) / body->substeps, body->state.v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyHasFreeRows - whether `BodyComputeFreeRows()` can tell where the rows get

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. has - whether it is explicit, with massless contact nodes, and makes one substep to a controller step

  Level: developer

.seealso: `Body`, `BodyComputeFreeRows()`
@*/
PetscErrorCode BodyHasFreeRows(Body body, PetscBool *has)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  *has = (PetscBool)(body->is_explicit && body->layer_scatter && body->substeps == 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyComputeFreeRows - where the rows get at the end of the controller step if no contact acts on any of them

  Collective

  Input Parameter:
. body - the `Body`, one with `BodyHasFreeRows()`

  Output Parameter:
. displacement - of this rank's rows [m]

  Level: developer

  Notes:
  From the saved state, which remains as it is, as do the present one and all traces. The same as the displacement traces of
  `BodyIntegrate()` under `BODY_FREE` conditions, for the price of the elements that touch the massless layer: central differences
  know the displacement of all nodes with mass before the step's internal force. Rows must be of contact nodes alone.

.seealso: `Body`, `BodyHasFreeRows()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyComputeFreeRows(Body body, PetscScalar displacement[])
{
  const PetscReal    end = body->saved_time + body->time_step, dt = body->time_step;
  const PetscScalar *u, *v, *a, *rows;
  PetscScalar       *moved;
  const PetscInt    *near;
  PetscInt           n;
  Vec                way = body->work[1]; /* elsewhere it is of no concern */
  PetscBool          has;

  PetscFunctionBegin;
  PetscCall(BodyHasFreeRows(body, &has));
  PetscCheck(has, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "Body '%s' is not explicit with massless contact nodes and one substep to a controller step: only integrating tells where its "
             "rows get; see BodyHasFreeRows()",
             body->hdr.name);
  BodyGetNearLayer(body, &n, &near);
  if (!body->linear) PetscCall(VecCopy(body->saved.u, way)); /* the balance takes the size of all of it */
  PetscCall(VecGetArrayRead(body->saved.u, &u));
  PetscCall(VecGetArrayRead(body->saved.v, &v));
  PetscCall(VecGetArrayRead(body->saved.a, &a));
  PetscCall(VecGetArray(way, &moved));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt i = near[k];

    moved[i] = u[i] + dt * (v[i] + 0.5 * dt * a[i]);
  }
  PetscCall(VecRestoreArray(way, &moved));
  PetscCall(VecRestoreArrayRead(body->saved.a, &a));
  PetscCall(VecRestoreArrayRead(body->saved.v, &v));
  PetscCall(VecRestoreArrayRead(body->saved.u, &u));
  PetscCall(BodyPrescribeHeld(body, end, way, NULL, NULL));
  PetscCall(BalanceLayer(body, end, 1, PETSC_FALSE, way, body->work[0]));
  PetscCall(MatMult(body->interface, way, body->row_vec[0]));
  PetscCall(VecGetArrayRead(body->row_vec[0], &rows));
  PetscCall(PetscArraycpy(displacement, rows, body->rows.local));
  PetscCall(VecRestoreArrayRead(body->row_vec[0], &rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}
