/* Energies and momentum. */
#include "bodyimpl.h"

/*@
  BodyGetMeasures - energies, momentum and mean velocity at the current time

  Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. measures - see `BodyMeasures`

  Level: intermediate

  Note:
  The kinetic energy of a body under central differences is the staggered one, 1/2 v'Mv - dt^2/8 a'Ma: together with the
  potential energy it is what the scheme conserves.

.seealso: `Body`, `BodyMeasures`
@*/
PetscErrorCode BodyGetMeasures(Body body, BodyMeasures *measures)
{
  const PetscInt     n       = body->owned_nodes * body->dim;
  const PetscReal    quarter = body->is_explicit ? 0.25 * PetscSqr(body->time_step) : 0;
  const PetscScalar *u, *v, *a, *force, *mass, *momentum_v, *momentum_a;
  PetscReal          kinetic = 0, potential = 0, sums[5] = {0};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(VecGetArrayRead(body->state.u, &u));
  PetscCall(VecGetArrayRead(body->state.v, &v));
  PetscCall(VecGetArrayRead(body->state.a, &a));
  PetscCall(VecGetArrayRead(body->internal_force, &force));
  PetscCall(VecGetArrayRead(body->mass_row_sum, &mass));
  for (PetscInt i = 0; i < n; i++) potential += u[i] * force[i];
  if (body->mass_diagonal) {
    for (PetscInt i = 0; i < n; i++) kinetic += mass[i] * (v[i] * v[i] - quarter * a[i] * a[i]);
  } else {
    PetscCall(MatMult(body->mass_matrix, body->state.v, body->work[0]));
    PetscCall(VecGetArrayRead(body->work[0], &momentum_v));
    for (PetscInt i = 0; i < n; i++) kinetic += v[i] * momentum_v[i];
    PetscCall(VecRestoreArrayRead(body->work[0], &momentum_v));
    if (quarter > 0) {
      PetscCall(MatMult(body->mass_matrix, body->state.a, body->work[0]));
      PetscCall(VecGetArrayRead(body->work[0], &momentum_a));
      for (PetscInt i = 0; i < n; i++) kinetic -= quarter * a[i] * momentum_a[i];
      PetscCall(VecRestoreArrayRead(body->work[0], &momentum_a));
    }
  }
  for (PetscInt d = 0; d < body->dim; d++) {
    PetscReal momentum = 0;

    for (PetscInt i = d; i < n; i += body->dim) momentum += mass[i] * v[i];
    sums[2 + d] = momentum;
  }
  sums[0] = 0.5 * kinetic;
  sums[1] = 0.5 * potential; /* linear materials: half the work of the internal force */
  PetscCall(VecRestoreArrayRead(body->mass_row_sum, &mass));
  PetscCall(VecRestoreArrayRead(body->internal_force, &force));
  PetscCall(VecRestoreArrayRead(body->state.a, &a));
  PetscCall(VecRestoreArrayRead(body->state.v, &v));
  PetscCall(VecRestoreArrayRead(body->state.u, &u));
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  measures->kinetic   = sums[0];
  measures->potential = sums[1];
  for (PetscInt d = 0; d < 3; d++) {
    measures->momentum[d]      = sums[2 + d];
    measures->mean_velocity[d] = sums[2 + d] / body->total_mass;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMass - the mass of the body

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. mass - [kg]

  Level: intermediate

.seealso: `Body`
@*/
PetscErrorCode BodyGetMass(Body body, PetscReal *mass)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  *mass = body->total_mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}
