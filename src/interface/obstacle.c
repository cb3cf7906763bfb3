/* Rigid obstacles: their shape by the options, and how far a point is from them. */
#include <impakt/obstacle.h>
#include <petscoptions.h>
#include <petscviewer.h>

/* An axis whose first component is above this is crossed with the second unit vector, not the first, which it may be parallel to */
#define NEARLY_PARALLEL 0.9

struct _n_Obstacle {
  char        *name;
  ObstacleType type;
  PetscReal    point[3];     /* of the plane or axis, or the centre [m] */
  PetscReal    direction[3]; /* outward normal of the plane, or axis of the cylinder; zero for a sphere */
  PetscReal    radius;       /* of the sphere or the cylinder [m] */
};

const char *const ObstacleTypes[] = {"plane", "sphere", "cylinder", "ObstacleType", "OBSTACLE_", NULL};

/* Three numbers, or as many as there are dimensions; the rest is 0 */
static PetscErrorCode GetVector(MPI_Comm comm, const char prefix[], const char option[], const char meaning[], PetscReal values[],
                                PetscBool *set)
{
  PetscInt n = 3;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++) values[d] = 0;
  PetscCall(PetscOptionsGetRealArray(NULL, prefix, option, values, &n, set));
  PetscCheck(*set, comm, PETSC_ERR_USER_INPUT, "-%s%s is missing: %s, as x,y,z", prefix, option + 1, meaning);
  for (PetscInt d = 0; d < n; d++)
    PetscCheck(PetscIsNormalReal(values[d]) || values[d] == 0, comm, PETSC_ERR_USER_INPUT, "-%s%s: %g is no number for %s", prefix,
               option + 1, (double)values[d], meaning);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetUnitVector(MPI_Comm comm, const char prefix[], const char option[], const char meaning[], PetscReal values[])
{
  PetscReal length = 0;
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(GetVector(comm, prefix, option, meaning, values, &set));
  for (PetscInt d = 0; d < 3; d++) length += values[d] * values[d];
  PetscCheck(length > 0, comm, PETSC_ERR_USER_INPUT, "-%s%s is the zero vector; it must have a direction", prefix, option + 1);
  for (PetscInt d = 0; d < 3; d++) values[d] /= PetscSqrtReal(length);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ObstacleCreateFromOptions - a rigid obstacle as the options describe it

  Collective

  Input Parameters:
+ comm - communicator
- name - its name, which is the prefix of its options

  Output Parameter:
. obstacle - the `Obstacle`

  Options Database Keys:
+ -<name>_obstacle_type (plane|sphere|cylinder) - its shape
. -<name>_point x,y,z                           - a point of the plane or of the cylinder's axis, or the centre of the sphere [m]
. -<name>_normal x,y,z                          - of the plane, away from what is solid
. -<name>_axis x,y,z                            - of the cylinder; across the plane (0,0,1) by default, a disc in two dimensions
- -<name>_radius r                              - of the sphere or cylinder [m]

  Level: intermediate

.seealso: `Obstacle`, `ObstacleGetGap()`
@*/
PetscErrorCode ObstacleCreateFromOptions(MPI_Comm comm, const char name[], Obstacle *obstacle)
{
  char      prefix[256];
  PetscEnum type = 0;
  PetscBool set;
  Obstacle  o;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%s_", name));
  PetscCall(PetscNew(obstacle));
  o = *obstacle;
  PetscCall(PetscStrallocpy(name, &o->name));
  PetscCall(PetscOptionsGetEnum(NULL, prefix, "-obstacle_type", ObstacleTypes, &type, &set));
  PetscCheck(set, comm, PETSC_ERR_USER_INPUT, "-%sobstacle_type is missing: obstacle '%s' is a plane, a sphere or a cylinder", prefix,
             name);
  o->type = (ObstacleType)type;
  PetscCall(GetVector(comm, prefix, "-point",
                      o->type == OBSTACLE_SPHERE  ? "the centre of the sphere"
                      : o->type == OBSTACLE_PLANE ? "a point of the plane"
                                                  : "a point of the axis",
                      o->point, &set));
  if (o->type == OBSTACLE_PLANE) {
    PetscCall(GetUnitVector(comm, prefix, "-normal", "the outward normal of the plane", o->direction));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-radius", &o->radius, &set));
  PetscCheck(set && o->radius > 0 && o->radius < PETSC_MAX_REAL, comm, PETSC_ERR_USER_INPUT,
             "-%sradius %g m: obstacle '%s' needs a positive radius", prefix, (double)o->radius, name);
  if (o->type == OBSTACLE_SPHERE) PetscFunctionReturn(PETSC_SUCCESS);
  o->direction[2] = 1;
  PetscCall(PetscOptionsHasName(NULL, prefix, "-axis", &set));
  if (set) PetscCall(GetUnitVector(comm, prefix, "-axis", "the direction of the cylinder", o->direction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleGetGap - how far a point is from an obstacle

  Not Collective

  Input Parameters:
+ obstacle - the `Obstacle`
- point    - 3 numbers [m]

  Output Parameters:
+ distance - negative inside [m]
- normal   - outward unit normal of the obstacle where it is closest, the gradient of the distance; 3 numbers

  Level: developer

  Note:
  At the centre of a sphere, and on the axis of a cylinder, any normal would do; one of them is returned.

.seealso: `Obstacle`
@*/
PetscErrorCode ObstacleGetGap(Obstacle obstacle, const PetscReal point[], PetscReal *distance, PetscReal normal[])
{
  PetscReal along = 0, length = 0;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++)
    along += (point[d] - obstacle->point[d]) * obstacle->direction[d]; /* 0 for a sphere, which has no direction */
  if (obstacle->type == OBSTACLE_PLANE) {
    *distance = along;
    for (PetscInt d = 0; d < 3; d++) normal[d] = obstacle->direction[d];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt d = 0; d < 3; d++) {
    normal[d] = point[d] - obstacle->point[d] - along * obstacle->direction[d];
    length += normal[d] * normal[d];
  }
  length    = PetscSqrtReal(length);
  *distance = length - obstacle->radius;
  if (length > 0) {
    for (PetscInt d = 0; d < 3; d++) normal[d] /= length;
  } else { /* any direction across the axis */
    const PetscInt first = PetscAbsReal(obstacle->direction[0]) < NEARLY_PARALLEL ? 0 : 1;

    for (PetscInt d = 0; d < 3; d++) {
      normal[d] = (d == first) - obstacle->direction[first] * obstacle->direction[d];
      length += normal[d] * normal[d];
    }
    for (PetscInt d = 0; d < 3; d++) normal[d] /= PetscSqrtReal(length);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  ObstacleGetName - the name an obstacle was given

  Not Collective

  Input Parameter:
. obstacle - the `Obstacle`

  Output Parameter:
. name - owned by the obstacle

  Level: developer

.seealso: `Obstacle`
@*/
PetscErrorCode ObstacleGetName(Obstacle obstacle, const char *name[])
{
  PetscFunctionBegin;
  *name = obstacle->name;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleDestroy - frees an obstacle

  Not Collective

  Input Parameter:
. obstacle - the `Obstacle`, set to `NULL`

  Level: developer

.seealso: `Obstacle`
@*/
PetscErrorCode ObstacleDestroy(Obstacle *obstacle)
{
  PetscFunctionBegin;
  if (!*obstacle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*obstacle)->name));
  PetscCall(PetscFree(*obstacle));
  PetscFunctionReturn(PETSC_SUCCESS);
}
