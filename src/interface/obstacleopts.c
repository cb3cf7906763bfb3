/* Rigid obstacles from options. */
#include <impakt/obstacle.h>
#include <petsc/private/petscimpl.h>
#include <sys/units.h>

/* Three numbers, or as many as there are dimensions; the rest is 0. An option that is not given is an error where it is needed. */
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

static PetscErrorCode CheckDirection(Obstacle obstacle, const char option[], const PetscReal values[])
{
  PetscFunctionBegin;
  PetscCheck(PetscSqr(values[0]) + PetscSqr(values[1]) + PetscSqr(values[2]) > 0, PetscObjectComm((PetscObject)obstacle),
             PETSC_ERR_USER_INPUT, "-%s%s is the zero vector; it must have a direction", ((PetscObject)obstacle)->prefix, option);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleSetFromOptions - shape and place of an obstacle from the options that begin with its name

  Collective

  Input Parameter:
. obstacle - the `Obstacle`

  Options Database Keys:
+ -<obstacle>_obstacle_type (plane|sphere|cylinder) - its shape
- -<obstacle>_point, ...                            - its place and direction, see the setters, and options/README.md for defaults

  Level: beginner

.seealso: `Obstacle`, `ObstacleSetPlane()`, `ObstacleSetSphere()`, `ObstacleSetCylinder()`
@*/
PetscErrorCode ObstacleSetFromOptions(Obstacle obstacle)
{
  static const struct {
    const char *setter, *point;
  } words[]            = {{"ObstacleSetPlane", "a point of the plane"},
                          {"ObstacleSetSphere", "the centre of the sphere"},
                          {"ObstacleSetCylinder", "a point of the axis"}};
  PetscEnum   type     = (PetscEnum)OBSTACLE_PLANE;
  PetscReal   point[3] = {0, 0, 0}, direction[3] = {0, 0, 0}, radius = 0;
  PetscInt    n = 3, n_direction = 3;
  char        velocity[PETSC_MAX_OPTION_NAME];
  PetscBool   set, has_velocity, has_point, has_direction = PETSC_FALSE, has_radius = PETSC_FALSE;
  const char *prefix;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  prefix = ((PetscObject)obstacle)->prefix;
  PetscObjectOptionsBegin((PetscObject)obstacle);
  PetscCall(PetscOptionsEnum("-obstacle_type", "Shape of the obstacle", "ObstacleSetPlane", ObstacleTypes, type, &type, &set));
  PetscCall(PetscOptionsRealArray("-point", "Where it is [m]", words[type].setter, point, &n, &has_point));
  if (type != (PetscEnum)OBSTACLE_SPHERE)
    PetscCall(PetscOptionsRealArray(type == (PetscEnum)OBSTACLE_PLANE ? "-normal" : "-axis", "Its direction", words[type].setter, direction,
                                    &n_direction, &has_direction));
  if (type != (PetscEnum)OBSTACLE_PLANE)
    PetscCall(PetscOptionsReal("-radius", "Its radius [m]", words[type].setter, radius, &radius, &has_radius));
  PetscCall(PetscOptionsString("-velocity", "Velocity of its surface along itself [m/s]", "ObstacleSetVelocity", "", velocity,
                               sizeof(velocity), &has_velocity));
  PetscOptionsEnd();
  PetscCheck(set, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
             "-%sobstacle_type is missing: obstacle '%s' is a plane, a sphere or a cylinder", prefix, ((PetscObject)obstacle)->name);
  if (has_velocity) PetscCall(ObstacleSetVelocity(obstacle, velocity));
  PetscCall(CheckVector(obstacle, "point", words[type].point, has_point, n, point));
  if (type == (PetscEnum)OBSTACLE_PLANE) {
    PetscCall(CheckVector(obstacle, "normal", "the outward normal of the plane", has_direction, n_direction, direction));
    PetscCall(CheckDirection(obstacle, "normal", direction));
    PetscCall(ObstacleSetPlane(obstacle, point, direction));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(has_radius && radius > 0 && radius < PETSC_MAX_REAL, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_USER_INPUT,
             "-%sradius %g%s: obstacle '%s' needs a positive radius", prefix, (double)radius, UnitsOf((PetscObject)obstacle, UNIT_LENGTH),
             ((PetscObject)obstacle)->name);
  if (type == (PetscEnum)OBSTACLE_SPHERE) {
    PetscCall(ObstacleSetSphere(obstacle, point, radius));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (has_direction) {
    PetscCall(CheckVector(obstacle, "axis", "the direction of the cylinder", has_direction, n_direction, direction));
    PetscCall(CheckDirection(obstacle, "axis", direction));
  }
  PetscCall(ObstacleSetCylinder(obstacle, point, has_direction ? direction : NULL, radius));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ObstacleCreateFromOptions - creates a rigid obstacle as the options describe it

  Collective

  Input Parameters:
+ comm - communicator
- name - its name, which is the prefix of its options

  Output Parameter:
. obstacle - the `Obstacle`, also where an error comes up, `NULL` or to be destroyed

  Level: intermediate

.seealso: `Obstacle`, `ObstacleCreate()`, `ObstacleSetFromOptions()`
@*/
PetscErrorCode ObstacleCreateFromOptions(MPI_Comm comm, const char name[], Obstacle *obstacle)
{
  PetscFunctionBegin;
  PetscAssertPointer(obstacle, 3);
  *obstacle = NULL;
  PetscCall(ObstacleCreate(comm, name, obstacle));
  PetscCall(ObstacleSetFromOptions(*obstacle));
  PetscFunctionReturn(PETSC_SUCCESS);
}
