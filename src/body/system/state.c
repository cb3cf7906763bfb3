/* The state of a body as one thing: made, copied, brought back. */
#include <body/layout/bodyimpl.h>

/* With room for displacement, velocity, acceleration, what loads and dashpots do, and for the internal force where it is wanted */
PetscErrorCode BodyStateCreate(Body body, PetscBool internal_force, BodyState *state)
{
  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &state->u));
  PetscCall(BodyCreateVec(body, &state->v));
  PetscCall(BodyCreateVec(body, &state->a));
  if (internal_force) PetscCall(BodyCreateVec(body, &state->internal_force));
  if (body->loads) PetscCall(BodyCreateVec(body, &state->applied));
  if (BodyIsDamped(body)) PetscCall(BodyCreateVec(body, &state->damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What both have room for; of a body that is elsewhere its time alone */
PetscErrorCode BodyStateCopy(Body body, const BodyState *from, BodyState *to)
{
  PetscFunctionBegin;
  to->external_work = from->external_work;
  to->damping_work  = from->damping_work;
  to->time          = from->time;
  to->step          = from->step;
  to->incomplete    = from->incomplete;
  to->force_known   = from->force_known;
  if (BodyIsElsewhere(body)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < STATE_VECS; k++)
    if (from->vecs[k] && to->vecs[k]) PetscCall(VecCopy(from->vecs[k], to->vecs[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyStateDestroy(BodyState *state)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < STATE_VECS; k++) PetscCall(VecDestroy(&state->vecs[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes back to the state of the last BodySave() and to what the integrator has beside it, bit for bit; the same integration ends with
   the same bits on two ranks, up to round-off on more, where sums come in any order. Collective. */
PetscErrorCode BodyRestore(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyStateCopy(body, &body->saved, &body->state));
  BodyHistoryRestore(body);
  body->repeats = PETSC_FALSE;
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  if (body->integrator->ops.restore && !BodyIsElsewhere(body)) PetscCall((*body->integrator->ops.restore)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
