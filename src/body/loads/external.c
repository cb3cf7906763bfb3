/* What loads do to a body: forces from outside, and the work of these and of held displacements. */
#include <body/layout/bodyimpl.h>

/* f += scale * forces from outside at time t [N] */
PetscErrorCode BodyAddExternalForce(Body body, PetscReal t, PetscScalar scale, Vec f)
{
  PetscFunctionBegin;
  if (body->loads && !body->unloaded) PetscCall(BodyLoadsAddForce(body, t, scale, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Contact forces on all nodes at the end of the substep that has been made last */
static PetscErrorCode ComputeContactForce(Body body, Vec contact)
{
  PetscScalar *reaction, *force_in, *row;

  PetscFunctionBegin;
  PetscCall(TraceGetLevel(body->traces.reaction, body->step - body->saved_step, &reaction));
  PetscCall(TraceGetLevel(body->traces.force_in, body->step - body->saved_step, &force_in));
  PetscCall(VecGetArrayWrite(body->row_vec[0], &row));
  for (PetscInt i = 0; i < body->rows.local; i++) row[i] = body->conditions[i] == BODY_FORCED ? force_in[i] : reaction[i];
  PetscCall(VecRestoreArrayWrite(body->row_vec[0], &row));
  PetscCall(MatMultTranspose(body->interface, body->row_vec[0], contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces from outside and the reactions that hold held dofs, at the current state: what does work on the body, beside contact */
static PetscErrorCode ComputeApplied(Body body, Vec applied)
{
  const PetscScalar *force;
  PetscScalar       *values;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(applied));
  PetscCall(BodyAddExternalForce(body, body->time, 1, applied));
  if (!body->any_held) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->integrator->has_inertia) PetscCall(VecCopy(body->internal_force, body->work[0]));
  else {
    PetscCall(BodyMultiplyMass(body, body->state.a, body->work[0]));
    PetscCall(VecAXPY(body->work[0], 1, body->internal_force));
  }
  /* contact forces on held dofs come from the partner */
  if (body->n_prescribed || body->n_forced) {
    PetscCall(ComputeContactForce(body, body->work[1]));
    PetscCall(VecAXPY(body->work[0], -1, body->work[1]));
  }
  PetscCall(VecGetArrayRead(body->work[0], &force));
  PetscCall(VecGetArray(applied, &values));
  for (PetscInt i = 0; i < body->n_held; i++) values[body->held_dofs[i]] = force[body->held_dofs[i]];
  PetscCall(VecRestoreArray(applied, &values));
  PetscCall(VecRestoreArrayRead(body->work[0], &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* To be called when the initial state is there */
PetscErrorCode BodySetUpWork(Body body)
{
  PetscFunctionBegin;
  if (!body->loads) PetscFunctionReturn(PETSC_SUCCESS);
  if (!body->applied) {
    PetscCall(BodyCreateVec(body, &body->applied));
    PetscCall(BodyCreateVec(body, &body->saved_applied));
  }
  body->external_work = body->saved_work = 0;
  PetscCall(ComputeApplied(body, body->applied));
  PetscCall(VecCopy(body->applied, body->saved_applied));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The work from displacement `start` to the present one, by the trapezoidal rule; collective only where there are loads */
PetscErrorCode BodyAddWork(Body body, Vec start)
{
  Vec       sum = body->work[2], way = body->work[1];
  PetscReal work;

  PetscFunctionBegin;
  if (!body->loads || body->unloaded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecCopy(body->applied, sum));
  PetscCall(ComputeApplied(body, body->applied));
  PetscCall(VecAXPY(sum, 1, body->applied));
  PetscCall(VecWAXPY(way, -1, start, body->state.u));
  PetscCall(VecDot(sum, way, &work));
  body->external_work += 0.5 * work;
  PetscFunctionReturn(PETSC_SUCCESS);
}
