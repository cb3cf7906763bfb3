/* Bodies whose contact nodes keep their mass because they are tied to nodes that move by the same rule. */
#include <body/layout/bodyimpl.h>

/*@
  BodyIntegratesLike - whether two bodies make the same substeps by the same rule

  Collective

  Input Parameters:
+ body  - the `Body`, after `BodySetUpDiscretization()` and `BodySetControllerStep()`
- other - another one

  Output Parameter:
. alike - true if both have inertia, integrators of one type with equal parameters, and equal substeps; false where a substep is chosen
          automatically, which is known only when the mass is

  Level: developer

.seealso: `Body`, `BodySetTiedMass()`
@*/
PetscErrorCode BodyIntegratesLike(Body body, Body other, PetscBool *alike)
{
  const Body bodies[2]        = {body, other};
  PetscReal  parameters[2][4] = {{0}}, substeps[2];
  PetscBool  same, newmark;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidHeaderSpecific(other, BODY_CLASSID, 2);
  PetscAssertPointer(alike, 3);
  PetscCall(PetscStrcmp(body->integrator->type, other->integrator->type, &same));
  *alike = (PetscBool)(same && body->integrator->has_inertia);
  for (PetscInt k = 0; k < 2 && *alike; k++) {
    const BodyTime *time = &bodies[k]->time;

    if (time->requested_step < 0) *alike = PETSC_FALSE;
    substeps[k] = time->requested_step > 0 ? PetscFloorReal(0.5 + time->controller_step / time->requested_step) : 1;
    PetscCall(PetscObjectTypeCompare((PetscObject)time->ts, TSALPHA2, &newmark));
    if (newmark) PetscCall(TSAlpha2GetParams(time->ts, &parameters[k][0], &parameters[k][1], &parameters[k][2], &parameters[k][3]));
  }
  if (!*alike) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < 4; i++) *alike = (PetscBool)(*alike && parameters[0][i] == parameters[1][i]);
  *alike = (PetscBool)(*alike && substeps[0] == substeps[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyRequestsControllerStep - whether the body is to make one substep in a controller step

  Not Collective

  Input Parameter:
. body - the `Body`, after `BodySetControllerStep()`

  Output Parameter:
. requests - false also where the substep is chosen automatically

  Level: developer

.seealso: `Body`, `BodyIntegratesLike()`
@*/
PetscErrorCode BodyRequestsControllerStep(Body body, PetscBool *requests)
{
  const PetscReal step = body->time.requested_step;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(requests, 2);
  *requests = (PetscBool)(step == 0 || (step > 0 && PetscFloorReal(0.5 + body->time.controller_step / step) == 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyMassIsChosen - whether program or options have said what becomes of the mass of contact nodes

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameters:
+ chosen       - `BodySetMassRedistribute()` has been called, or its option given
- redistribute - whether contact nodes are to be massless

  Level: developer

.seealso: `Body`, `BodySetMassRedistribute()`, `BodySetTiedMass()`
@*/
PetscErrorCode BodyMassIsChosen(Body body, PetscBool *chosen, PetscBool *redistribute)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(chosen, 2);
  PetscAssertPointer(redistribute, 3);
  *chosen       = body->mass.chosen;
  *redistribute = body->mass.redistribute;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyPrescribesMass - whether prescribed rows take velocity and acceleration from their partner

  Not Collective

  Input Parameter:
. body - the `Body`

  Output Parameter:
. prescribes - true where contact nodes have mass and are not tied, see `BodySetTiedMass()`; else only their displacement is prescribed

  Level: developer

.seealso: `Body`, `BodySetTiedMass()`, `BodyIsRedistributed()`
@*/
PetscErrorCode BodyPrescribesMass(Body body, PetscBool *prescribes)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(prescribes, 2);
  *prescribes = (PetscBool)(!body->mass.redistribute && !body->rows.tied_mass && body->integrator->has_inertia);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodySetTiedMass - says that rows on nodes with mass are ties to nodes that move by the same rule

  Logically Collective

  Input Parameters:
+ body - the `Body`, not yet set up
- tied - whether they are; false by default

  Level: developer

  Note:
  Such a row is a constraint in the equations of motion: where it is prescribed, the displacement is enough, since velocity and
  acceleration follow from it by the rule that the partner has too, and its force has the inertia of the nodes in it. Other rows on nodes
  with mass take velocity and acceleration from their partner.

.seealso: `Body`, `BodyIntegratesLike()`, `BodySetContactNodes()`, `BodyIsRedistributed()`
@*/
PetscErrorCode BodySetTiedMass(Body body, PetscBool tied)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscValidLogicalCollectiveBool(body, tied, 2);
  PetscCheck(!body->setup, PetscObjectComm((PetscObject)body), PETSC_ERR_ARG_WRONGSTATE, "Call before BodySetUp()");
  body->rows.tied_mass = tied;
  PetscFunctionReturn(PETSC_SUCCESS);
}
