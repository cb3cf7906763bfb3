/* Which bodies of a simulation have inertia: without it, some figures mean nothing. */
#include "controllerimpl.h"
#include <impakt/private/bodyfloating.h>

/*@
  ControllerGetStatics - whether bodies have no inertia

  Not Collective

  Input Parameter:
. controller - the `Controller`, set up

  Output Parameter:
. statics - see `ControllerStatics`

  Level: intermediate

.seealso: `Controller`, `BodyIsStatic()`
@*/
PetscErrorCode ControllerGetStatics(Controller controller, ControllerStatics *statics)
{
  PetscBool is_static, floating, any = PETSC_FALSE;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscAssertPointer(statics, 2);
  *statics = (ControllerStatics){.all = PETSC_TRUE};
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(BodyIsStatic(controller->bodies[b], &is_static));
    PetscCall(BodyIsFloating(controller->bodies[b], &floating));
    statics->some = (PetscBool)(statics->some || is_static);
    statics->all  = (PetscBool)(statics->all && is_static);
    any           = (PetscBool)(any || floating);
  }
  statics->balanced = (PetscBool) !(statics->all && any);
  PetscFunctionReturn(PETSC_SUCCESS);
}
