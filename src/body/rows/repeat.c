/*
   Sweeps of one controller step integrate a body again and again from one state, with other inputs at its rows. Where it makes one substep, what a
   change of the inputs changes at the end of the step can be found without another whole step:

   - implicit and static, linear, under Newmark's method: A du = B^T df with prescribed rows at B du = dx, A being the effective matrix, by
   the solver that has its factors; dv = gamma / (beta dt) du, da = du / (beta dt^2), and for massless nodes dv = du / dt;
   - explicit, linear: the displacement of nodes with mass is known before the step's end; the massless layer and prescribed rows are put
     in place anew, and the acceleration that follows replaces the one before in the velocity;
   - explicit with mass on the contact nodes and forced rows alone, linear or not: da = M^{-1} B^T df, dv = dt / 2 da.
*/
#include <body/layout/bodyimpl.h>

typedef enum { REPEAT_NEVER, REPEAT_IMPLICIT, REPEAT_EXPLICIT, REPEAT_FORCES } RepeatKind;

struct _BodyRepeat {
  RepeatKind   kind;
  PetscBool    valid; /* the present end state is that of an integration from the saved state under the present conditions and `inputs` */
  PetscScalar *inputs[4]; /* of this rank's rows, at the end of the controller step: displacement, velocity, acceleration, force */
  PetscScalar *change[4];
};

PetscErrorCode BodyDestroyRepeat(Body body)
{
  PetscFunctionBegin;
  if (!body->repeat) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 4; k++) PetscCall(PetscFree2(body->repeat->inputs[k], body->repeat->change[k]));
  PetscCall(PetscFree(body->repeat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the integrator and the rows */
PetscErrorCode BodySetUpRepeat(Body body)
{
  const PetscBool newmark = (PetscBool)(body->is_static || (body->alpha_m == 1 && body->alpha_f == 1));
  PetscBool       layer   = (PetscBool)(body->n_layer_dofs > 0);
  RepeatKind      kind    = REPEAT_NEVER;

  PetscFunctionBegin;
  PetscCall(BodyAnyRank(body, &layer));
  /* a mass matrix that is not diagonal hands the acceleration of prescribed nodes to others */
  if (!body->is_explicit && body->linear && newmark && !(body->prescribed_mass && body->mass_matrix)) kind = REPEAT_IMPLICIT;
  if (body->is_explicit && body->linear) kind = REPEAT_EXPLICIT;
  else if (body->is_explicit && !layer) kind = REPEAT_FORCES;
  if (body->substeps > 1 || !body->rows.global) kind = REPEAT_NEVER;
  PetscCall(PetscNew(&body->repeat));
  body->repeat->kind = kind;
  for (PetscInt k = 0; k < 4 && kind != REPEAT_NEVER; k++)
    PetscCall(PetscCalloc2(body->rows.local, &body->repeat->inputs[k], body->rows.local, &body->repeat->change[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The present state is not, or not any more, that of the last integration under the conditions as they are */
void BodyInvalidateRepeat(Body body)
{
  if (body->repeat) body->repeat->valid = PETSC_FALSE;
}

/* What comes in at the end of the controller step is the present state's from now on; `change`: by how much that is more than before */
static PetscErrorCode TakeInputs(Body body)
{
  const Trace traces[] = {body->traces.displacement_in, body->traces.velocity_in, body->traces.acceleration_in, body->traces.force_in};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++) {
    PetscScalar *values, *inputs = body->repeat->inputs[k], *change = body->repeat->change[k];

    PetscCall(TraceGetLevel(traces[k], body->substeps, &values));
    for (PetscInt i = 0; i < body->rows.local; i++) {
      change[i] = values[i] - inputs[i];
      inputs[i] = values[i];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A whole integration has just been done */
PetscErrorCode BodyNoteInputs(Body body)
{
  PetscFunctionBegin;
  if (body->repeat->kind == REPEAT_NEVER) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body));
  /* rows of one node that are not orthonormal are prescribed by least squares, which has no simple change */
  body->repeat->valid = (PetscBool)(!body->n_prescribed || (body->repeat->kind != REPEAT_FORCES && !body->any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RepeatImplicit(Body body)
{
  const PetscReal    dt = body->time_step, to_velocity = body->gamma / (body->beta * dt), to_acceleration = 1 / (body->beta * dt * dt);
  const PetscInt     n     = body->owned_nodes * body->dim;
  PetscScalar       *force = body->repeat->change[3], *target = body->repeat->change[0], *v, *a;
  const PetscScalar *du;
  Vec                change = body->work[2];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < body->rows.local; i++) {
    if (body->conditions[i] != BODY_FORCED && body->conditions[i] != BODY_ROBIN) force[i] = 0;
    if (body->conditions[i] != BODY_PRESCRIBED) target[i] = 0;
  }
  PetscCall(ConstrainedSolverCorrect(body->solver, force, target, change));
  PetscCall(VecAXPY(body->state.u, 1, change));
  PetscCall(VecGetArrayRead(change, &du));
  PetscCall(VecGetArray(body->state.v, &v));
  PetscCall(VecGetArray(body->state.a, &a));
  if (body->is_static) {
    for (PetscInt i = 0; i < n; i++) v[i] += du[i] / dt;
  } else {
    for (PetscInt i = 0; i < n; i++) {
      v[i] += to_velocity * du[i];
      a[i] += to_acceleration * du[i];
    }
    for (PetscInt i = 0; i < body->n_layer_dofs; i++) {
      const PetscInt dof = body->layer_dofs[i];

      v[dof] += (1 / dt - to_velocity) * du[dof];
      a[dof] = 0;
    }
  }
  PetscCall(VecRestoreArray(body->state.a, &a));
  PetscCall(VecRestoreArray(body->state.v, &v));
  PetscCall(VecRestoreArrayRead(change, &du));
  if (body->prescribed_mass) {
    PetscCall(BodyPrescribe(body, body->traces.velocity_in, 1, body->state.v));
    PetscCall(BodyPrescribe(body, body->traces.acceleration_in, 1, body->state.a));
  }
  PetscCall(BodyComputeInternalForce(body, body->state.u, body->internal_force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RepeatForces(Body body)
{
  PetscScalar *force = body->repeat->change[3];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < body->rows.local; i++)
    if (body->conditions[i] != BODY_FORCED) force[i] = 0;
  PetscCall(BodySolveMassOfRows(body, force));
  PetscCall(VecAXPY(body->state.a, 1, body->work[2]));
  PetscCall(VecAXPY(body->state.v, 0.5 * body->time_step, body->work[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the end state of this controller step to the inputs as they are now, if that can be done */
PetscErrorCode BodyRepeat(Body body, PetscBool *done)
{
  struct _BodyRepeat *repeat = body->repeat;

  PetscFunctionBegin;
  *done = repeat->valid;
  if (!*done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeInputs(body));
  if (repeat->kind == REPEAT_IMPLICIT) PetscCall(RepeatImplicit(body));
  else if (repeat->kind == REPEAT_FORCES || (!body->n_prescribed && !body->n_robin && !body->layer_scatter)) PetscCall(RepeatForces(body));
  else PetscCall(BodyRepeatExplicit(body));
  PetscCall(BodyWriteTraces(body, body->substeps));
  body->total_substeps += body->substeps;
  PetscFunctionReturn(PETSC_SUCCESS);
}
