/* Where the rows of a body get without contact, told without integrating. */
#include <body/layout/bodyimpl.h>

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
  PetscAssertPointer(has, 2);
  PetscCheck(body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call after BodySetUp()");
  *has = (PetscBool)(body->integrator->ops.freerows != NULL);
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
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(BodyHasFreeRows(body, &has));
  PetscCheck(has, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "Body '%s' is not explicit with massless contact nodes and one substep to a controller step: only integrating tells where its "
             "rows get; see BodyHasFreeRows()",
             body->hdr.name);
  StepFailureClear(&body->failure);
  if (BodyIsElsewhere(body)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall((*body->integrator->ops.freerows)(body, displacement));
  PetscCall(StepFailureRaise(PetscObjectComm((PetscObject)body), &body->failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}
