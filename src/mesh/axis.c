/* Meshes of bodies that are rings about the axis x = 0. */
#include <impakt/private/mesh.h>
#include <sys/units.h>

/* Nodes that are nearer to the axis, in parts of the largest distance from it, lie on it */
#define ON_AXIS 1e-9

/* How near to the axis x = 0 nodes of a mesh lie on it. `tolerance`: largest distance from the axis at which a node counts as being on it
   [m]. An error where the mesh reaches across the axis by more than that: distances from an axis are not negative. Collective */
PetscErrorCode MeshGetAxisTolerance(DM dm, PetscReal *tolerance)
{
  PetscReal   lower[3], upper[3];
  const char *name;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(dm, DM_CLASSID, 1);
  PetscAssertPointer(tolerance, 2);
  PetscCall(DMGetBoundingBox(dm, lower, upper));
  PetscCall(PetscObjectGetName((PetscObject)dm, &name));
  *tolerance = ON_AXIS * upper[0];
  PetscCheck(
      upper[0] > 0 && lower[0] >= -*tolerance, PetscObjectComm((PetscObject)dm), PETSC_ERR_USER_INPUT,
      "-%s_axisymmetric true: the mesh reaches from x = %g to %g%s; x is the distance from the axis, which is not negative: mesh one "
      "half of the section alone, or move it (-%s_translate)",
      name, (double)lower[0], (double)upper[0], UnitsOf((PetscObject)dm, UNIT_LENGTH), name);
  PetscFunctionReturn(PETSC_SUCCESS);
}
