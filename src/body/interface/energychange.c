/* How the energy of a body changes in the controller step under way. */
#include <body/layout/bodyimpl.h>

/* Kinetic energy of a state, staggered for central differences, at the present step; this rank's share of a diagonal mass is not known
   apart, so that all are sums over ranks [J] */
static PetscErrorCode ComputeKinetic(Body body, const BodyState *state, PetscReal *kinetic)
{
  const PetscReal staggered = body->integrator->staggered * PetscSqr(body->time.step);
  PetscScalar     of_velocity, of_acceleration = 0;

  PetscFunctionBegin;
  *kinetic = 0;
  if (!body->integrator->has_inertia) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyMultiplyMass(body, state->v, body->work.nodes[0]));
  PetscCall(VecDot(state->v, body->work.nodes[0], &of_velocity));
  if (staggered > 0) {
    PetscCall(BodyMultiplyMass(body, state->a, body->work.nodes[0]));
    PetscCall(VecDot(state->a, body->work.nodes[0], &of_acceleration));
  }
  *kinetic = 0.5 * PetscRealPart(of_velocity - staggered * of_acceleration);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stored energy at a displacement [J] */
static PetscErrorCode ComputePotential(Body body, Vec u, PetscReal *potential)
{
  const PetscScalar *values;
  PetscScalar        product;
  Vec                local;

  PetscFunctionBegin;
  if (body->model.linear) {
    PetscCall(BodyComputeInternalForce(body, u, body->work.nodes[0]));
    PetscCall(VecDot(u, body->work.nodes[0], &product));
    *potential = 0.5 * PetscRealPart(product);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetLocalRead(body, u, &local, &values));
  PetscCall((*body->model.element->ops->energy)(body->model.element, values, potential));
  PetscCall(BodyRestoreLocalRead(body, u, &local, &values));
  if (body->rows.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, potential, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetEnergyChange - how much more energy the body has than at the start of the controller step, and what its loads have done in it

  Collective

  Input Parameter:
. body - the `Body`, integrated, before `BodySave()`

  Output Parameters:
+ change - of kinetic and stored energy; the kinetic energy of explicit bodies is the staggered one [J]
- work   - of forces from outside and of held displacements in this step [J]

  Level: developer

  Note:
  Costs two internal forces.

.seealso: `Body`, `BodyGetMeasures()`, `ContactGetEnergyLoss()`
@*/
PetscErrorCode BodyGetEnergyChange(Body body, PetscReal *change, PetscReal *work)
{
  PetscReal kinetic[2], potential[2];

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(change, 2);
  PetscAssertPointer(work, 3);
  PetscCall(ComputeKinetic(body, &body->saved, &kinetic[0]));
  PetscCall(ComputeKinetic(body, &body->state, &kinetic[1]));
  PetscCall(ComputePotential(body, body->saved.u, &potential[0]));
  PetscCall(ComputePotential(body, body->state.u, &potential[1]));
  *change = kinetic[1] - kinetic[0] + (potential[1] - potential[0]);
  PetscCall(BodyGetStepWork(body, work));
  PetscFunctionReturn(PETSC_SUCCESS);
}
