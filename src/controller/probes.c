/* The points of all bodies that are observed. */
#include "controllerimpl.h"

/* After the set-up of the contact problem, which finishes that of the bodies */
PetscErrorCode ControllerSetUpProbes(Controller controller)
{
  PetscInt most = 0, next = 0, n;

  PetscFunctionBegin;
  controller->n_probes = 0;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(BodyGetNumProbes(controller->bodies[b], &n));
    controller->n_probes += n;
    most = PetscMax(most, n);
  }
  PetscCall(PetscCalloc2(controller->n_probes, &controller->probes, 15 * most, &controller->probe_values));
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(BodyGetNumProbes(controller->bodies[b], &n));
    for (PetscInt k = 0; k < n; k++, next++) {
      controller->probes[next].body   = b;
      controller->probes[next].number = k;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What they do at the end of an accepted step. Collective. */
PetscErrorCode ControllerFindProbes(Controller controller)
{
  PetscInt next = 0, n;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscReal *position = controller->probe_values, *displacement, *velocity, *stress;

    PetscCall(BodyGetNumProbes(controller->bodies[b], &n));
    displacement = position + 3 * n;
    velocity     = displacement + 3 * n;
    stress       = velocity + 3 * n;
    PetscCall(BodyGetProbes(controller->bodies[b], position, displacement, velocity, stress));
    for (PetscInt k = 0; k < n; k++, next++) {
      ControllerProbe *probe = &controller->probes[next];

      PetscCall(PetscArraycpy(probe->position, position + 3 * k, 3));
      PetscCall(PetscArraycpy(probe->displacement, displacement + 3 * k, 3));
      PetscCall(PetscArraycpy(probe->velocity, velocity + 3 * k, 3));
      PetscCall(PetscArraycpy(probe->stress, stress + 6 * k, 6));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetProbes - the points that are observed, of all bodies

  Not Collective

  Input Parameter:
. controller - the `Controller`, set up

  Output Parameters:
+ n      - their number, or `NULL`
- probes - body by body, with what observers were told last; owned by the controller

  Level: intermediate

.seealso: `Controller`, `ControllerProbe`, `ControllerFrame`, `BodyAddProbe()`
@*/
PetscErrorCode ControllerGetProbes(Controller controller, PetscInt *n, const ControllerProbe *probes[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCheck(controller->setup, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE, "Call ControllerSetUp() first");
  if (n) *n = controller->n_probes;
  if (probes) *probes = controller->probes;
  PetscFunctionReturn(PETSC_SUCCESS);
}
