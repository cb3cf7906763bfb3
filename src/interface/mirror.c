/* Nodes of a surface that lie in a plane of symmetry.

   The normal of a node at the rim of a surface comes from the faces on one side of it. Where the body is cut along a plane of symmetry, at
   a right angle to an axis, its other half has as many on the other side, and the normal lies in the plane. One that is tilted out of it
   makes gaps and friction of what moves along it: of half a ball of 12 elements to a quarter, on a plate with a mesh, friction across the
   plane took up to all that the law has for the node. */
#include "interfaceimpl.h"

/* A body is on one side of a node if it reaches beyond the node by less than this part of its extent */
#define BEYOND 1e-6
/* Sine of 30 degrees, the tilt of normals out of a plane of symmetry: beyond are edges. A ball of 4 elements round the quarter has 11. */
#define TILTED 0.5

/* Finds nodes in planes of symmetry, whose normals stay in them from the next SurfaceUpdate() on. `dofs`: the prescribed displacements of
   this rank, ascending, numbered from its first one, `first`, on. A node lies in a plane if it is held along one axis or two but not along
   all, the whole body is on one side of it along that axis, and its normal is out of the plane by 30 degrees at most. */
PetscErrorCode SurfaceSetMirrors(Surface surface, PetscInt n, const PetscInt dofs[], PetscInt first)
{
  const SurfaceData *data = &surface->data;
  PetscReal          lower[3], upper[3];

  PetscFunctionBegin;
  PetscCall(PetscFree(surface->mirrors));
  if (data->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SurfaceUpdate(surface, NULL));
  PetscCall(PetscCalloc1(data->n_owned, &surface->mirrors));
  PetscCall(DMGetBoundingBox(surface->dm, lower, upper));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    PetscInt count = 0, mirrors = 0;

    for (PetscInt d = 0; d < data->dim; d++) {
      const PetscReal x = data->reference[3 * i + d], beyond = PetscMin(x - lower[d], upper[d] - x);
      PetscInt        place;

      PetscCall(PetscFindInt(data->dofs[i] + d - first, n, dofs, &place));
      if (place < 0) continue;
      count++;
      if (beyond < BEYOND * (upper[d] - lower[d]) && PetscAbsReal(data->normals[3 * i + d]) <= TILTED) mirrors |= 1 << d;
    }
    if (count < data->dim) surface->mirrors[i] = mirrors;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
