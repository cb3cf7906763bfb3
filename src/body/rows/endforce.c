/* Contact forces that act at the end of a controller step and move nothing in it. */
#include <body/layout/bodyimpl.h>

/*@
  BodyFeelsEndForce - whether displacements at the end of the controller step answer to the contact forces there

  Not Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. feels - false for explicit bodies with mass on their contact nodes and one substep to a controller step, where the force at its end goes
          into the acceleration alone

  Level: developer

.seealso: `Body`, `BodyIntegrate()`
@*/
PetscErrorCode BodyFeelsEndForce(Body body, PetscBool *feels)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(feels, 2);
  *feels = body->integrator->feels_end_force;
  PetscFunctionReturn(PETSC_SUCCESS);
}
