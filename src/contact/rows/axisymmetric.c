/* Pairs of axisymmetric bodies: what may touch them. */
#include <contact/parts.h>

/* Components of directions, and distances from the axis in parts of the mesh, that are smaller count as none */
#define NONE 1e-9

/* An obstacle must be the same all around the axis x = 0: a plane across it, a sphere on it, a cylinder about it. z is across the mesh. */
static PetscErrorCode CheckObstacle(Contact contact, const ContactPair *pair)
{
  ObstacleType type;
  PetscReal    point[3], direction[3], lower[3], upper[3], off, tilt;
  PetscBool    moves;
  const char  *name;
  DM           dm;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetName((PetscObject)pair->obstacle, &name));
  PetscCall(ObstacleGetShape(pair->obstacle, &type, point, direction));
  PetscCall(ObstacleGetVelocity(pair->obstacle, NULL, 0, NULL, &moves));
  PetscCall(BodyGetDM(contact->bodies[pair->body[0]], &dm));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  off  = type == OBSTACLE_PLANE ? 0 : PetscMax(PetscAbsReal(point[0]), PetscAbsReal(point[2])) / upper[0];
  tilt = type == OBSTACLE_SPHERE ? 0 : PetscMax(PetscAbsReal(direction[0]), PetscAbsReal(direction[2]));
  PetscCheck(
      off < NONE && tilt < NONE && !moves, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is axisymmetric, and %s '%s' is not, at (%g, %g, %g) m along (%g, %g, %g): the normal of a plane "
      "must be along y, the axis, the centre of a sphere lie on it, and a cylinder about it (-%s_axis 0,1,0, x = z = 0 in -%s_point), "
      "which a wall around the axis is; and no surface may have a velocity along itself",
      pair->name, ((PetscObject)contact->bodies[pair->body[0]])->name, ObstacleTypes[type], name, (double)point[0], (double)point[1],
      (double)point[2], (double)direction[0], (double)direction[1], (double)direction[2], name, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where only a part of a pair is axisymmetric */
PetscErrorCode ContactCheckAxisymmetric(Contact contact, const ContactPair *pair)
{
  PetscBool rings[2];

  PetscFunctionBegin;
  PetscCall(BodyGetAxisymmetric(contact->bodies[pair->body[0]], &rings[0]));
  if (pair->obstacle) {
    if (rings[0]) PetscCall(CheckObstacle(contact, pair));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetAxisymmetric(contact->bodies[pair->body[1]], &rings[1]));
  PetscCheck(
      rings[0] == rings[1], PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is axisymmetric, body '%s' is not; set -%s_axisymmetric true, or have them not touch by naming other "
      "pairs in -contact_pairs",
      pair->name, ((PetscObject)contact->bodies[pair->body[rings[0] ? 0 : 1]])->name,
      ((PetscObject)contact->bodies[pair->body[rings[0] ? 1 : 0]])->name,
      ((PetscObject)contact->bodies[pair->body[rings[0] ? 1 : 0]])->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}
