/* Whether what is held of a body holds it as a whole. */
#include "bodyimpl.h"
#include <petscblaslapack.h>

#define MAX_RIGID 6
/* Smallest eigenvalue of the Gram matrix below, relative to the largest, at which a motion counts as free; its round-off is 1e-15 */
#define FREE 1e-10

/* Rigid motions of a node at r: translations, then rotations about the axes (in two dimensions: about the third) */
static PetscReal RigidMotion(PetscInt dim, PetscInt motion, const PetscReal r[3], PetscInt component)
{
  const PetscInt axis = dim == 2 ? 2 : motion - dim;

  if (motion < dim) return motion == component ? 1 : 0;
  if (component == (axis + 1) % 3) return -r[(axis + 2) % 3];
  if (component == (axis + 2) % 3) return r[(axis + 1) % 3];
  return 0;
}

/* An error where a static body can move or turn without any held displacement noticing: its stiffness is singular, which factors need
   not show. Contact may hold it instead. */
PetscErrorCode BodyCheckHeld(Body body)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)body);
  const PetscInt dim = body->dim, n = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal      gram[MAX_RIGID * MAX_RIGID] = {0}, eigenvalues[MAX_RIGID], work[4 * MAX_RIGID], box[6], size = 0;
  PetscBLASInt   order = (PetscBLASInt)n, lwork = 4 * MAX_RIGID, info;

  PetscFunctionBegin;
  if (!body->is_static || body->rows.global) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMGetBoundingBox(body->dm, box, box + 3));
  for (PetscInt d = 0; d < dim; d++) size = PetscMax(size, box[3 + d] - box[d]);
  for (PetscInt i = 0; i < body->n_held; i++) {
    const PetscInt component = body->held_dofs[i] % dim;
    PetscReal      r[3]      = {0};

    for (PetscInt d = 0; d < dim; d++) r[d] = (body->coordinates[body->held_dofs[i] - component + d] - 0.5 * (box[d] + box[3 + d])) / size;
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) gram[a * n + b] += RigidMotion(dim, a, r, component) * RigidMotion(dim, b, r, component);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, gram, (PetscMPIInt)(n * n), MPIU_REAL, MPIU_SUM, comm));
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("N", "L", &order, gram, &order, eigenvalues, work, &lwork, &info));
  PetscCheck(info == 0, comm, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  PetscCheck(eigenvalues[0] > FREE * eigenvalues[n - 1], comm, PETSC_ERR_USER_INPUT, "Body '%s' is static, but nothing holds it, or not in all directions: it can move or turn as a whole; prescribe more displacements with -%sboundary_displacement", body->hdr.name, ((PetscObject)body)->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}
