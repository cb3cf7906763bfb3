/* The state of a body at the start of the controller step, brought back. */
#include <body/layout/bodyimpl.h>

/*@
  BodyRestore - goes back to the state of the last `BodySave()`, bit for bit

  Collective

  Input Parameter:
. body - the `Body`

  Level: developer

  Note:
  What the integrator remembers beside the state is as it was too: the same integration ends with the same bits as before. On three ranks
  and more, where sums over ranks come in any order, it ends the same up to round-off.

.seealso: `Body`, `BodySave()`, `BodyIntegrate()`
@*/
PetscErrorCode BodyRestore(Body body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscCall(VecCopy(body->saved.u, body->state.u));
  PetscCall(VecCopy(body->saved.v, body->state.v));
  PetscCall(VecCopy(body->saved.a, body->state.a));
  body->state.time = body->saved.time;
  body->state.step = body->saved.step;
  if (body->loads) {
    PetscCall(VecCopy(body->saved.applied, body->state.applied));
    body->state.external_work = body->saved.external_work;
  }
  PetscCall(TSSecondOrderSetState(body->time.ts, body->state.time, body->time.step, body->state.step));
  if (body->integrator->ops.restore) PetscCall((*body->integrator->ops.restore)(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
