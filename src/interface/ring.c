/* Surfaces of bodies that are rings about the axis x = 0; surfaces that lose faces. */
#include "interfaceimpl.h"
#include <impakt/private/mesh.h>

/* Forgets all other faces of this rank */
PetscErrorCode SurfaceKeepFaces(Surface surface, const PetscBool keep[])
{
  SurfaceData *data = &surface->data;
  PetscInt     kept = 0;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < data->n_faces; f++)
    if (keep[f]) surface->points[kept++] = surface->points[f];
  PetscCall(SurfaceClearNodes(surface));
  data->n_faces = kept;
  PetscCall(SurfaceSetUpNodes(surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a surface of a plane mesh that of rings about the axis x = 0. Areas, and with them mortar integrals, get the weight 2 pi x, x being
   the present distance from the axis. Faces on the axis are left out; normals of nodes on the axis are along it. */
PetscErrorCode SurfaceSetAxisymmetric(Surface surface)
{
  const SurfaceData *data = &surface->data;
  PetscBool         *keep;

  PetscFunctionBegin;
  PetscCheck(data->dim == 2, PetscObjectComm((PetscObject)surface->dm), PETSC_ERR_ARG_INCOMP,
             "Surface '%s' has %" PetscInt_FMT " dimensions; rings are made of plane meshes", ((PetscObject)surface)->name, data->dim);
  if (surface->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeshGetAxisTolerance(surface->dm, &surface->on_axis));
  surface->axisymmetric = PETSC_TRUE;
  PetscCall(PetscMalloc1(data->n_faces, &keep));
  for (PetscInt f = 0; f < data->n_faces; f++) {
    keep[f] = PETSC_FALSE;
    for (PetscInt k = 0; k < data->face_nodes; k++)
      if (data->reference[3 * data->faces[f * data->face_nodes + k]] > surface->on_axis) keep[f] = PETSC_TRUE;
  }
  PetscCall(SurfaceKeepFaces(surface, keep));
  PetscCall(PetscFree(keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}
