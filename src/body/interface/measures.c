/* Energies and momentum. */
#include <body/layout/bodyimpl.h>

/* Stored energy of this rank's elements, or of its dofs where half the work of the internal force is all there is to it [J] */
static PetscErrorCode ComputePotential(Body body, PetscReal *potential)
{
  const PetscScalar *u, *force;
  const PetscInt     n = body->owned_nodes * body->dim;
  Vec                local;
  PetscReal          sum = 0;

  PetscFunctionBegin;
  if (body->linear) {
    PetscCall(VecGetArrayRead(body->state.u, &u));
    PetscCall(VecGetArrayRead(body->internal_force, &force));
    for (PetscInt i = 0; i < n; i++) sum += u[i] * force[i];
    PetscCall(VecRestoreArrayRead(body->internal_force, &force));
    PetscCall(VecRestoreArrayRead(body->state.u, &u));
    *potential = 0.5 * sum;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetLocalRead(body, body->state.u, &local, &u));
  PetscCall((*body->element->ops->energy)(body->element, u, potential));
  PetscCall(BodyRestoreLocalRead(body, body->state.u, &local, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Kinetic energy [J], staggered for central differences */
static PetscErrorCode ComputeKinetic(Body body, Vec momentum, PetscReal *kinetic)
{
  const PetscReal    quarter = body->is_explicit ? 0.25 * PetscSqr(body->time_step) : 0;
  const PetscInt     n       = body->owned_nodes * body->dim;
  const PetscScalar *v, *a, *p, *inertia;
  PetscReal          sum = 0;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->state.v, &v));
  PetscCall(VecGetArrayRead(momentum, &p));
  for (PetscInt i = 0; i < n; i++) sum += v[i] * p[i];
  PetscCall(VecRestoreArrayRead(momentum, &p));
  PetscCall(VecRestoreArrayRead(body->state.v, &v));
  if (quarter > 0) {
    PetscCall(BodyMultiplyMass(body, body->state.a, body->work[1]));
    PetscCall(VecGetArrayRead(body->state.a, &a));
    PetscCall(VecGetArrayRead(body->work[1], &inertia));
    for (PetscInt i = 0; i < n; i++) sum -= quarter * a[i] * inertia[i];
    PetscCall(VecRestoreArrayRead(body->work[1], &inertia));
    PetscCall(VecRestoreArrayRead(body->state.a, &a));
  }
  *kinetic = 0.5 * sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sums over this rank's nodes that make kinetic energy, momentum and angular momentum */
static PetscErrorCode ComputeMotion(Body body, PetscReal *kinetic, PetscReal momentum[3], PetscReal angular[3])
{
  const PetscInt     dim = body->dim, n = body->owned_nodes * dim;
  const PetscScalar *x, *u, *p;
  Vec                nodal = body->work[0];

  PetscFunctionBegin;
  PetscCall(BodyMultiplyMass(body, body->state.v, nodal));
  PetscCall(ComputeKinetic(body, nodal, kinetic));
  PetscCall(VecGetArrayRead(nodal, &p));
  if (dim == 1) {
    for (PetscInt i = 0; i < n; i++) momentum[0] += p[i];
  } else {
    PetscCall(VecGetArrayRead(body->positions, &x));
    PetscCall(VecGetArrayRead(body->state.u, &u));
    for (PetscInt i = 0; i < n; i += dim) {
      PetscReal r[3] = {0}, q[3] = {0};

      for (PetscInt d = 0; d < dim; d++) {
        r[d] = x[i + d] + u[i + d];
        q[d] = p[i + d];
        momentum[d] += q[d];
      }
      for (PetscInt d = 0; d < 3; d++) angular[d] += r[(d + 1) % 3] * q[(d + 2) % 3] - r[(d + 2) % 3] * q[(d + 1) % 3];
    }
    PetscCall(VecRestoreArrayRead(body->state.u, &u));
    PetscCall(VecRestoreArrayRead(body->positions, &x));
  }
  PetscCall(VecRestoreArrayRead(nodal, &p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mean velocity of a body without inertia, weighted by its mass all the same */
static PetscErrorCode SumMassVelocity(Body body, PetscReal sum[3])
{
  const PetscScalar *v, *mass;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->state.v, &v));
  PetscCall(VecGetArrayRead(body->mass_row_sum, &mass));
  for (PetscInt i = 0; i < body->owned_nodes * body->dim; i++) sum[i % body->dim] += mass[i] * v[i];
  PetscCall(VecRestoreArrayRead(body->mass_row_sum, &mass));
  PetscCall(VecRestoreArrayRead(body->state.v, &v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetMeasures - energies, momenta and mean velocity at the current time

  Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. measures - see `BodyMeasures`

  Level: intermediate

  Notes:
  The kinetic energy of a body under central differences is the staggered one, 1/2 v'Mv - dt^2/8 a'Ma: together with the
  potential energy it is what the scheme conserves.

  A static body has neither kinetic energy nor momentum.

.seealso: `Body`, `BodyMeasures`
@*/
PetscErrorCode BodyGetMeasures(Body body, BodyMeasures *measures)
{
  PetscReal sums[11] = {0};

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(measures, 2);
  PetscCall(ComputePotential(body, &sums[1]));
  if (body->is_static) PetscCall(SumMassVelocity(body, sums + 8));
  else {
    PetscCall(ComputeMotion(body, &sums[0], sums + 2, sums + 5));
    for (PetscInt d = 0; d < 3; d++) sums[8 + d] = sums[2 + d];
  }
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 11, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  measures->kinetic       = sums[0];
  measures->potential     = sums[1];
  measures->external_work = body->external_work;
  measures->loaded        = (PetscBool)(body->loads != NULL);
  for (PetscInt d = 0; d < 3; d++) {
    measures->momentum[d]         = sums[2 + d];
    measures->angular_momentum[d] = sums[5 + d];
    measures->mean_velocity[d]    = sums[8 + d] / body->total_mass;
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
  PetscAssertPointer(mass, 2);
  *mass = body->total_mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}
