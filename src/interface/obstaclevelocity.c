/* Obstacles whose surface moves along itself: belts, turning rolls. Where the obstacle is does not change by that. */
#include "obstacleimpl.h"

/*@C
  ObstacleSetVelocity - lets the surface of an obstacle move along itself, as that of a belt or a turning roll does

  Collective

  Input Parameters:
+ obstacle   - the `Obstacle`
- components - two or three formulas in x, y, z, t with commas between them, as in "0.5*sin(t),0" [m/s]

  Options Database Key:
. -<obstacle>_velocity vx,vy[,vz] - the same

  Level: intermediate

  Note:
  Bodies feel it by friction alone. The place of the obstacle stays: a velocity with a part across the surface is an error, where a body
  touches.

.seealso: `Obstacle`, `ObstacleGetVelocity()`, `ContactSetLaw()`
@*/
PetscErrorCode ObstacleSetVelocity(Obstacle obstacle, const char components[])
{
  char     option[320];
  PetscInt n;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  PetscAssertPointer(components, 2);
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%svelocity", ((PetscObject)obstacle)->prefix));
  PetscCall(ExpressionListCount(components, &n));
  PetscCheck(n == 2 || n == 3, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
             "%s '%s' has %" PetscInt_FMT " components; a velocity has 2 or 3, with commas between them", option, components, n);
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&obstacle->velocity[d]));
  PetscCall(ExpressionListCreate(PetscObjectComm((PetscObject)obstacle), option, components, n, PETSC_FALSE, obstacle->velocity));
  obstacle->n_velocity = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleGetVelocity - how fast the surface of an obstacle moves along itself

  Not Collective

  Input Parameters:
+ obstacle - the `Obstacle`
. x        - a point, 3 numbers [m]; `NULL` where only `moves` is asked for
- t        - time [s]

  Output Parameters:
+ velocity - 3 numbers [m/s], or `NULL`
- moves    - whether a velocity has been given at all, or `NULL`

  Level: intermediate

.seealso: `Obstacle`, `ObstacleSetVelocity()`
@*/
PetscErrorCode ObstacleGetVelocity(Obstacle obstacle, const PetscReal x[], PetscReal t, PetscReal velocity[], PetscBool *moves)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  if (moves) *moves = (PetscBool)(obstacle->n_velocity > 0);
  for (PetscInt d = 0; d < 3 && velocity; d++) {
    const ExpressionPoint point = {.x = {x[0], x[1], x[2]}, .t = t};

    velocity[d] = 0;
    if (d < obstacle->n_velocity) PetscCall(ExpressionEvaluate(obstacle->velocity[d], &point, &velocity[d]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
