/* Rigid obstacles: the class, its shapes, and how far a point is from one. */
#include <impakt/private/transfer.h>
#include "obstacleimpl.h"
#include <sys/units.h>

/* An axis whose first component is above this is crossed with the second unit vector, not the first, which it may be parallel to */
#define NEARLY_PARALLEL 0.9

const char *const ObstacleTypes[] = {"plane", "sphere", "cylinder", "ObstacleType", "OBSTACLE_", NULL};

/*@
  ObstacleCreate - creates an obstacle without a shape

  Collective

  Input Parameters:
+ comm - communicator
- name - its name; options begin with `-<name>_`

  Output Parameter:
. obstacle - the `Obstacle`

  Level: beginner

.seealso: `Obstacle`, `ObstacleSetShape()`, `ObstacleSetFromOptions()`, `ContactAddObstacle()`
@*/
PetscErrorCode ObstacleCreate(MPI_Comm comm, const char name[], Obstacle *obstacle)
{
  char prefix[256];

  PetscFunctionBegin;
  PetscAssertPointer(name, 2);
  PetscAssertPointer(obstacle, 3);
  PetscCall(ObstacleInitializePackage());
  PetscCall(PetscHeaderCreate(*obstacle, OBSTACLE_CLASSID, "Obstacle", "Rigid obstacle", "Obstacle", comm, ObstacleDestroy, ObstacleView));
  PetscCall(PetscObjectSetName((PetscObject)*obstacle, name));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%s_", name));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)*obstacle, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleSetShape - makes an obstacle everything behind a plane, a solid sphere, or a solid cylinder without ends

  Logically Collective

  Input Parameters:
+ obstacle  - the `Obstacle`
. type      - the shape; a cylinder is a disc in two dimensions, where its axis is across the plane
. point     - a point of the plane or of the axis, or the centre, 3 numbers [m]
. direction - of a plane its normal, away from what is solid, of a cylinder its axis, or `NULL` for 0,0,1; 3 numbers, of any length
- radius    - of a sphere or a cylinder [m]

  Options Database Keys:
+ -<obstacle>_obstacle_type (plane|sphere|cylinder)        - the shape
. -<obstacle>_point x,y,z                                  - the point
. -<obstacle>_normal x,y,z, or -<obstacle>_axis x,y,z      - the direction
- -<obstacle>_radius r                                     - the radius

  Level: beginner

.seealso: `Obstacle`, `ObstacleGetShape()`
@*/
PetscErrorCode ObstacleSetShape(Obstacle obstacle, ObstacleType type, const PetscReal point[], const PetscReal direction[],
                                PetscReal radius)
{
  const PetscReal across[3] = {0, 0, 1};
  PetscReal       length    = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  PetscValidLogicalCollectiveEnum(obstacle, type, 2);
  PetscAssertPointer(point, 3);
  if (!direction) direction = across;
  for (PetscInt d = 0; d < 3; d++) {
    obstacle->point[d]     = point[d];
    obstacle->direction[d] = type == OBSTACLE_SPHERE ? 0 : direction[d];
    length += PetscSqr(direction[d]);
  }
  PetscCheck(length > 0 && length < PETSC_MAX_REAL, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_ARG_OUTOFRANGE,
             "Obstacle '%s': a vector of length %g has no direction", ((PetscObject)obstacle)->name, (double)PetscSqrtReal(length));
  PetscCheck(type == OBSTACLE_PLANE || (radius > 0 && radius < PETSC_MAX_REAL), PetscObjectComm((PetscObject)obstacle),
             PETSC_ERR_ARG_OUTOFRANGE, "Obstacle '%s': a radius of %g%s must be positive", ((PetscObject)obstacle)->name, (double)radius,
             UnitsOf((PetscObject)obstacle, UNIT_LENGTH));
  for (PetscInt d = 0; d < 3; d++) obstacle->direction[d] /= PetscSqrtReal(length);
  obstacle->type     = type;
  obstacle->radius   = radius;
  obstacle->complete = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes sure that an obstacle has a shape. Logically collective. */
PetscErrorCode ObstacleSetUp(Obstacle obstacle)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  PetscCheck(obstacle->complete, PetscObjectComm((PetscObject)obstacle), PETSC_ERR_ARG_WRONGSTATE,
             "Obstacle '%s' has no shape: call ObstacleSetShape() or ObstacleSetFromOptions()", ((PetscObject)obstacle)->name);
  PetscCall(PetscObjectViewFromOptions((PetscObject)obstacle, NULL, "-obstacle_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleGetShape - the shape of an obstacle, and where it is

  Not Collective

  Input Parameter:
. obstacle - the `Obstacle`

  Output Parameters:
+ type      - the `ObstacleType`
. point     - a point of the plane or of the axis of the cylinder, or the centre of the sphere, 3 numbers [m]; or `NULL`
- direction - unit normal of the plane or direction of the cylinder, zeros for a sphere, 3 numbers; or `NULL`

  Level: intermediate

.seealso: `Obstacle`, `ObstacleSetShape()`
@*/
PetscErrorCode ObstacleGetShape(Obstacle obstacle, ObstacleType *type, PetscReal point[], PetscReal direction[])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  PetscAssertPointer(type, 2);
  *type = obstacle->type;
  if (point) PetscCall(PetscArraycpy(point, obstacle->point, 3));
  if (direction) PetscCall(PetscArraycpy(direction, obstacle->direction, 3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Distance of a point (3 numbers) from the obstacle, negative inside [m], and the outward unit normal where the obstacle is closest (3
   numbers), the gradient of the distance; at the centre of a sphere, and on the axis of a cylinder, one of those possible. Not
   collective. */
PetscErrorCode ObstacleGetGap(Obstacle obstacle, const PetscReal point[], PetscReal *distance, PetscReal normal[])
{
  PetscReal along = 0, length = 0;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  PetscAssertPointer(point, 2);
  PetscAssertPointer(distance, 3);
  PetscAssertPointer(normal, 4);
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

/*@
  ObstacleView - prints an obstacle

  Collective

  Input Parameters:
+ obstacle - the `Obstacle`
- viewer   - an ASCII viewer, `NULL` for standard output

  Options Database Key:
. -<obstacle>_obstacle_view - print the obstacle when it is added to a contact problem

  Level: intermediate

.seealso: `Obstacle`
@*/
PetscErrorCode ObstacleView(Obstacle obstacle, PetscViewer viewer)
{
  const PetscReal *p = obstacle->point, *n = obstacle->direction;
  const char      *unit;
  PetscBool        ascii;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 1);
  unit = UnitsOf((PetscObject)obstacle, UNIT_LENGTH);
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(PetscObjectComm((PetscObject)obstacle), &viewer));
  PetscValidHeaderSpecific(viewer, PETSC_VIEWER_CLASSID, 2);
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "obstacle %s: %s at (%g, %g, %g)%s", ((PetscObject)obstacle)->name,
                                   obstacle->complete ? ObstacleTypes[obstacle->type] : "no shape", (double)p[0], (double)p[1],
                                   (double)p[2], unit));
  if (obstacle->type != OBSTACLE_SPHERE)
    PetscCall(PetscViewerASCIIPrintf(viewer, ", %s (%g, %g, %g)", obstacle->type == OBSTACLE_PLANE ? "normal" : "axis", (double)n[0],
                                     (double)n[1], (double)n[2]));
  if (obstacle->type != OBSTACLE_PLANE) PetscCall(PetscViewerASCIIPrintf(viewer, ", radius %g%s", (double)obstacle->radius, unit));
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  ObstacleDestroy - frees an obstacle

  Collective

  Input Parameter:
. obstacle - the `Obstacle`, set to `NULL`

  Level: beginner

.seealso: `Obstacle`, `ObstacleCreate()`
@*/
PetscErrorCode ObstacleDestroy(Obstacle *obstacle)
{
  PetscFunctionBegin;
  if (!*obstacle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*obstacle, OBSTACLE_CLASSID, 1);
  if (--((PetscObject)*obstacle)->refct > 0) {
    *obstacle = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt d = 0; d < 3; d++) PetscCall(ExpressionDestroy(&(*obstacle)->velocity[d]));
  PetscCall(PetscHeaderDestroy(obstacle));
  PetscFunctionReturn(PETSC_SUCCESS);
}
