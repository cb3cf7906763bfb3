/* How far a linear body has turned since its undeformed state. Its strains are those of small rotations: a body that turns by an angle a
   loses angular momentum and energy by terms of a^2.

   The angle is I^-1 sum m (X - C) x u with the inertia tensor I about the centre of mass C: u = R X - X of a rotation R by a small angle,
   in the least squares. Vibrations of a free body, which are orthogonal to its rigid motions, do not count. */
#include <body/integrator/rigidmotion.h>
#include <body/layout/bodyimpl.h>

/* Centre of mass and inverse inertia tensor; plane bodies turn about the third axis alone */
PetscErrorCode BodySetUpInertia(Body body)
{
  const PetscInt     dim     = body->mesh.dim;
  PetscReal          sums[9] = {0}, inertia[9], trace;
  const PetscScalar *mass;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(body->mass.row_sum, &mass));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i++) sums[i % dim] += mass[i] * body->mesh.coordinates[i];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt d = 0; d < 3; d++) body->mass.centre[d] = sums[d] / body->mass.total;
  if (body->model.element->axisymmetric) { /* rings lie about the axis, and do not turn */
    body->mass.centre[0] = 0;
    PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscArrayzero(sums, 9));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * dim; i += dim) {
    PetscReal r[3] = {0};

    for (PetscInt d = 0; d < dim; d++) r[d] = body->mesh.coordinates[i + d] - body->mass.centre[d];
    for (PetscInt k = 0; k < 9; k++) sums[k] += mass[i] * r[k / 3] * r[k % 3];
  }
  PetscCall(VecRestoreArrayRead(body->mass.row_sum, &mass));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 9, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscCall(PetscArrayzero(body->mass.inverse_inertia, 9));
  trace = sums[0] + sums[4] + sums[8];
  for (PetscInt k = 0; k < 9; k++) inertia[k] = (k % 4 ? 0 : trace) - sums[k];
  if (dim == 2 && trace > 0) body->mass.inverse_inertia[8] = 1 / trace;
  if (dim == 3 && !RigidInvert(inertia, body->mass.inverse_inertia)) PetscCall(PetscArrayzero(body->mass.inverse_inertia, 9));
  PetscFunctionReturn(PETSC_SUCCESS);
}
