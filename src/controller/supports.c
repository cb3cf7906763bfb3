/* What holds the bodies: their surfaces with prescribed displacements, and obstacles. */
#include "controllerimpl.h"

/* A list of all, with room for their forces; after the set-up of the contact problem, which finishes that of the bodies */
PetscErrorCode ControllerSetUpSupports(Controller controller)
{
  PetscInt           n_obstacles, most = 0, next = 0, n;
  ControllerSupport *support;
  const Obstacle    *obstacles;

  PetscFunctionBegin;
  PetscCall(ContactGetObstacles(controller->contact, &n_obstacles, &obstacles));
  controller->n_supports = n_obstacles;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(BodyGetNumReactions(controller->bodies[b], &n));
    controller->n_supports += n;
    most = PetscMax(most, n);
  }
  PetscCall(PetscCalloc2(controller->n_supports, &controller->supports, 6 * most, &controller->reactions));
  support = controller->supports;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscCall(BodyGetNumReactions(controller->bodies[b], &n));
    for (PetscInt i = 0; i < n; i++, next++) {
      support[next].body = b;
      PetscCall(BodyGetReactionSurface(controller->bodies[b], i, &support[next].name));
    }
  }
  for (PetscInt o = 0; o < n_obstacles; o++, next++) {
    support[next].body = -1;
    PetscCall(PetscObjectGetName((PetscObject)obstacles[o], &support[next].name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ControllerGetSupports - what holds the bodies: surfaces with prescribed displacements, and obstacles

  Not Collective

  Input Parameter:
. controller - the `Controller`, set up

  Output Parameters:
+ n        - their number, or `NULL`
- supports - held surfaces body by body, then obstacles, with the forces that observers were told last; owned by the controller

  Level: intermediate

.seealso: `Controller`, `ControllerSupport`, `ControllerFrame`
@*/
PetscErrorCode ControllerGetSupports(Controller controller, PetscInt *n, const ControllerSupport *supports[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(controller, CONTROLLER_CLASSID, 1);
  PetscCheck(controller->setup, PetscObjectComm((PetscObject)controller), PETSC_ERR_ARG_WRONGSTATE, "Call ControllerSetUp() first");
  if (n) *n = controller->n_supports;
  if (supports) *supports = controller->supports;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of the obstacles, `support` for each: the opposite of what the pairs, whose states are given, exert on them */
static PetscErrorCode AddPairs(Controller controller, ControllerSupport support[])
{
  PetscInt n_pairs, n_obstacles, o;

  PetscFunctionBegin;
  PetscCall(ContactGetNumPairs(controller->contact, &n_pairs));
  PetscCall(ContactGetObstacles(controller->contact, &n_obstacles, NULL));
  for (o = 0; o < n_obstacles; o++)
    for (PetscInt d = 0; d < 3; d++) support[o].force[d] = support[o].moment[d] = 0;
  for (PetscInt p = 0; p < n_pairs; p++) {
    PetscCall(ContactGetPairTraits(controller->contact, p, NULL, &o, NULL));
    for (PetscInt d = 0; d < 3 && o >= 0; d++) {
      support[o].force[d] -= controller->pair_states[p].force_vector[d];
      support[o].moment[d] -= controller->pair_states[p].moment[d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces at the end of an accepted step; the states of the pairs are known. Collective. */
PetscErrorCode ControllerFindReactions(Controller controller)
{
  PetscInt next = 0, n;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < controller->n_bodies; b++) {
    PetscReal *force = controller->reactions, *moment;

    PetscCall(BodyGetNumReactions(controller->bodies[b], &n));
    moment = force + 3 * n;
    PetscCall(BodyGetReactions(controller->bodies[b], force, moment));
    for (PetscInt i = 0; i < n; i++, next++) {
      PetscCall(PetscArraycpy(controller->supports[next].force, force + 3 * i, 3));
      PetscCall(PetscArraycpy(controller->supports[next].moment, moment + 3 * i, 3));
    }
  }
  PetscCall(AddPairs(controller, controller->supports + next));
  PetscFunctionReturn(PETSC_SUCCESS);
}
