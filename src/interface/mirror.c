/* Nodes of a surface that lie in a plane of symmetry.

   The normal of a node at the rim of a surface comes from the faces on one side of it. Where the body is cut along a plane of symmetry, at
   a right angle to an axis, its other half has as many on the other side, and the normal lies in the plane. One that is tilted out of it
   makes gaps and friction of what moves along it: of half a ball of 12 elements to a quarter, on a plate with a mesh, friction across the
   plane took up to all that the law has for the node. */
#include "interfaceimpl.h"

/* Nodes of faces are on one side of a node that are behind it by less than this part of their extent */
#define BEHIND 1e-6
/* Sine of 30 degrees, the tilt of normals out of a plane of symmetry: beyond are edges. A ball of 4 elements round the quarter has 11. */
#define TILTED 0.5

/* How far the nodes of the faces around each node reach along each axis, on all ranks: the least of `sign` times their coordinates */
static PetscErrorCode FindExtents(Surface surface, PetscReal sign, PetscReal least[])
{
  const SurfaceData *data = &surface->data;
  const PetscInt     n    = data->face_nodes;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 3 * data->n_nodes; i++) least[i] = sign * data->reference[i];
  for (PetscInt f = 0; f < data->n_faces; f++)
    for (PetscInt k = 0; k < n; k++)
      for (PetscInt l = 0; l < n; l++)
        for (PetscInt d = 0; d < 3; d++) {
          const PetscInt at = 3 * data->faces[f * n + k] + d;

          least[at] = PetscMin(least[at], sign * data->reference[3 * data->faces[f * n + l] + d]);
        }
  if (!surface->divided) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSFReduceBegin(surface->vectors, MPIU_REAL, least, least, MPIU_MIN));
  PetscCall(PetscSFReduceEnd(surface->vectors, MPIU_REAL, least, least, MPIU_MIN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds nodes in planes of symmetry, whose normals stay in them from the next SurfaceUpdate() on. `dofs`: the prescribed displacements of
   this rank, ascending, numbered from its first one, `first`, on. A node lies in a plane if it is held along one axis or two but not along
   all, all faces around it are on one side of it along that axis, and its normal is out of the plane by 30 degrees at most. */
PetscErrorCode SurfaceSetMirrors(Surface surface, PetscInt n, const PetscInt dofs[], PetscInt first)
{
  const SurfaceData *data = &surface->data;
  PetscReal         *lower, *upper; /* the latter with its sign changed */

  PetscFunctionBegin;
  PetscCall(PetscFree(surface->mirrors));
  if (data->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SurfaceUpdate(surface, NULL));
  PetscCall(PetscCalloc1(data->n_owned, &surface->mirrors));
  PetscCall(PetscMalloc2(3 * data->n_nodes, &lower, 3 * data->n_nodes, &upper));
  PetscCall(FindExtents(surface, 1, lower));
  PetscCall(FindExtents(surface, -1, upper));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    PetscInt count = 0, mirrors = 0;

    for (PetscInt d = 0; d < data->dim; d++) {
      const PetscReal *x = data->reference + 3 * i, extent = -upper[3 * i + d] - lower[3 * i + d];
      PetscInt         place;

      PetscCall(PetscFindInt(data->dofs[i] + d - first, n, dofs, &place));
      if (place < 0) continue;
      count++;
      if (PetscMin(x[d] - lower[3 * i + d], -upper[3 * i + d] - x[d]) < BEHIND * extent && PetscAbsReal(data->normals[3 * i + d]) <= TILTED)
        mirrors |= 1 << d;
    }
    if (count < data->dim) surface->mirrors[i] = mirrors;
  }
  PetscCall(PetscFree2(lower, upper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
