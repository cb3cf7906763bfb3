/* Pairs of axisymmetric bodies: what may touch them. */
#include <contact/parts.h>

/* Components of directions, and distances from the axis in parts of the mesh, that are smaller count as none */
#define NONE 1e-9

/* An obstacle that is the same all around the axis x = 0: a plane across it, a sphere on it, a cylinder about it. In three dimensions z
   goes across the plane of the mesh. */
static PetscErrorCode CheckObstacle(Contact contact, const ContactPair *pair)
{
  const char  *body = ((PetscObject)contact->bodies[pair->body[0]])->name;
  MPI_Comm     comm = PetscObjectComm((PetscObject)contact);
  ObstacleType type;
  PetscReal    point[3], direction[3], lower[3], upper[3], off;
  PetscBool    moves;
  const char  *name;
  DM           dm;

  PetscFunctionBegin;
  PetscCall(ObstacleGetName(pair->obstacle, &name));
  PetscCall(ObstacleGetType(pair->obstacle, &type));
  PetscCall(ObstacleGetPlace(pair->obstacle, point, direction));
  PetscCall(BodyGetDM(contact->bodies[pair->body[0]], &dm));
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  off = PetscMax(PetscAbsReal(point[0]), PetscAbsReal(point[2])) / upper[0];
  PetscCheck(
      type != OBSTACLE_PLANE || PetscMax(PetscAbsReal(direction[0]), PetscAbsReal(direction[2])) < NONE, comm, PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is axisymmetric, and plane '%s' is not: its normal (%g, %g, %g) must be along y, the axis; a wall "
      "around the axis is a cylinder",
      pair->name, body, name, (double)direction[0], (double)direction[1], (double)direction[2]);
  PetscCheck(
      type != OBSTACLE_SPHERE || off < NONE, comm, PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is axisymmetric, and sphere '%s' at (%g, %g, %g) m is not: its centre must lie on the axis, x = z = 0",
      pair->name, body, name, (double)point[0], (double)point[1], (double)point[2]);
  PetscCheck(
      type != OBSTACLE_CYLINDER || (PetscMax(PetscAbsReal(direction[0]), PetscAbsReal(direction[2])) < NONE && off < NONE), comm,
      PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: body '%s' is axisymmetric, and cylinder '%s' is not: it must lie about the axis, with -%s_axis 0,1,0 and x = z "
      "= 0 in -%s_point",
      pair->name, body, name, name, name);
  PetscCall(ObstacleGetVelocity(pair->obstacle, NULL, 0, NULL, &moves));
  PetscCheck(
      !moves, comm, PETSC_ERR_USER_INPUT,
      "-contact_pairs %s: the surface of obstacle '%s' moves along itself (-%s_velocity), which is not the same all around the axis of "
      "body '%s'",
      pair->name, name, name, body);
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
