/* Rigid obstacles from options. */
#include <impakt/obstacle.h>
#include <petsc/private/petscimpl.h>
#include <sys/units.h>

/* Three numbers, or as many as there are dimensions; the rest is 0 */
static PetscErrorCode CheckVector(Obstacle obstacle, const char option[], const char meaning[], PetscBool set, PetscInt n,
                                  const PetscReal values[])
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)obstacle);
  const char *prefix = ((PetscObject)obstacle)->prefix;

  PetscFunctionBegin;
  PetscCheck(set, comm, PETSC_ERR_USER_INPUT, "-%s%s is missing: %s, as x,y,z", prefix, option, meaning);
  for (PetscInt d = 0; d < n; d++)
    PetscCheck(PetscIsNormalReal(values[d]) || values[d] == 0, comm, PETSC_ERR_USER_INPUT, "-%s%s: %g is no number for %s", prefix, option,
               (double)values[d], meaning);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleSetFromOptions - shape and place of an obstacle from the options that begin with its name

  Collective

  Input Parameter:
. obstacle - the `Obstacle`

  Options Database Keys:
+ -<obstacle>_obstacle_type (plane|sphere|cylinder) - its shape
- -<obstacle>_point, ...                            - its place and direction, see the setter, and options/README.md for defaults

  Level: beginner

.seealso: `Obstacle`, `ObstacleSetShape()`
@*/
PetscErrorCode ObstacleSetFromOptions(Obstacle obstacle)
{
  static const struct {
    const char *point, *option, *direction; /* what the point is; the option of the direction, and what that is */
  } words[]            = {{"a point of the plane", "normal", "the outward normal of the plane"},
                          {"the centre of the sphere", NULL, NULL},
                          {"a point of the axis", "axis", "the direction of the cylinder"}};
  PetscEnum   type     = (PetscEnum)OBSTACLE_PLANE;
  PetscReal   point[3] = {0, 0, 0}, direction[3] = {0, 0, 0}, radius = 0;
  PetscInt    n = 3, n_direction = 3;
  char        velocity[PETSC_MAX_OPTION_NAME];
  PetscBool   set, has_velocity, has_point, has_direction = PETSC_FALSE, plane;
  const char *prefix, *option;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  prefix = ((PetscObject)obstacle)->prefix;
  PetscObjectOptionsBegin((PetscObject)obstacle);
  PetscCall(PetscOptionsEnum("-obstacle_type", "Shape of the obstacle", "ObstacleSetShape", ObstacleTypes, type, &type, &set));
  plane  = (PetscBool)(type == (PetscEnum)OBSTACLE_PLANE);
  option = words[type].option;
  PetscCall(PetscOptionsRealArray("-point", "Where it is [m]", "ObstacleSetShape", point, &n, &has_point));
  if (option)
    PetscCall(
        PetscOptionsRealArray(plane ? "-normal" : "-axis", "Its direction", "ObstacleSetShape", direction, &n_direction, &has_direction));
  if (!plane) PetscCall(PetscOptionsReal("-radius", "Its radius [m]", "ObstacleSetShape", radius, &radius, NULL));
  PetscCall(PetscOptionsString("-velocity", "Velocity of its surface along itself [m/s]", "ObstacleSetVelocity", "", velocity,
                               sizeof(velocity), &has_velocity));
  PetscOptionsEnd();
  PetscCheck(set, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
             "-%sobstacle_type is missing: obstacle '%s' is a plane, a sphere or a cylinder", prefix, ((PetscObject)obstacle)->name);
  if (has_velocity) PetscCall(ObstacleSetVelocity(obstacle, velocity));
  PetscCall(CheckVector(obstacle, "point", words[type].point, has_point, n, point));
  if (plane || has_direction) {
    PetscCall(CheckVector(obstacle, option, words[type].direction, has_direction, n_direction, direction));
    PetscCheck(direction[0] != 0 || direction[1] != 0 || direction[2] != 0, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
               "-%s%s is the zero vector; it must have a direction", prefix, option);
  }
  PetscCheck(plane || (radius > 0 && radius < PETSC_MAX_REAL), PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
             "-%sradius %g%s: obstacle '%s' needs a positive radius", prefix, (double)radius, UnitsOf((PetscObject)obstacle, UNIT_LENGTH),
             ((PetscObject)obstacle)->name);
  PetscCall(ObstacleSetShape(obstacle, (ObstacleType)type, point, has_direction ? direction : NULL, radius));
  PetscFunctionReturn(PETSC_SUCCESS);
}
