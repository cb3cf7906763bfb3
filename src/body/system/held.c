/* Whether the displacements that are held, or the nodes with mass, keep a body from moving as if it were rigid. */
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

#define MAX_RIGID 6 /* rigid motions in three dimensions */
/* A rigid motion is free if the smallest eigenvalue of the Gram matrix of all rigid motions on the fixed dofs is below this part of the
   largest one. Round-off makes 1e-15 of it; two held nodes hold the body if they are more
   than some 1e-5 of its size apart, the square root of this. */
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

/* Adds to the Gram matrix of the rigid motions what they are at a fixed dof; positions relative to the body's size, for it to have no unit
 */
static void AddFixed(Body body, PetscInt dof, const PetscReal box[6], PetscReal size, PetscInt n, PetscReal gram[])
{
  const PetscInt dim = body->mesh.dim, component = dof % dim;
  PetscReal      r[3] = {0};

  for (PetscInt d = 0; d < dim; d++) r[d] = (body->mesh.coordinates[dof - component + d] - 0.5 * (box[d] + box[3 + d])) / size;
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt b = 0; b < n; b++) gram[a * n + b] += RigidMotion(dim, a, r, component) * RigidMotion(dim, b, r, component);
}

/* Whether some rigid motion leaves all fixed dofs in place: those of the list, which is of owned dofs, ascending, or all others; of all
   ranks together */
static PetscErrorCode IsLoose(Body body, PetscInt n_fixed, const PetscInt fixed[], PetscBool others, PetscBool *loose)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)body);
  const PetscInt dim = body->mesh.dim, n = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal      gram[MAX_RIGID * MAX_RIGID] = {0}, eigenvalues[MAX_RIGID], work[4 * MAX_RIGID], box[6] = {0}, size = 0;
  PetscBLASInt   order = (PetscBLASInt)n, lwork = 4 * MAX_RIGID, info;
  PetscInt       next = 0;

  PetscFunctionBegin;
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  for (PetscInt d = 0; d < dim; d++) size = PetscMax(size, box[3 + d] - box[d]);
  for (PetscInt dof = 0; dof < body->mesh.owned_nodes * dim; dof++) {
    const PetscBool listed = (PetscBool)(next < n_fixed && fixed[next] == dof);

    if (listed) next++;
    if (listed != others) AddFixed(body, dof, box, size, n, gram);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, gram, (PetscMPIInt)(n * n), MPIU_REAL, MPIU_SUM, comm));
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("N", "L", &order, gram, &order, eigenvalues, work, &lwork, &info));
  PetscCheck(info == 0, comm, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  *loose = (PetscBool) !(eigenvalues[0] > FREE * eigenvalues[n - 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An error where a body can move as if it were rigid and its matrix is singular for that: a static body with too few held displacements
   (contact does not count, because contact forces are found with the matrix of the body alone), or a massless layer that too few nodes with
   mass hold. Factors of a singular matrix need not show that it is. */
PetscErrorCode BodyCheckHeld(Body body)
{
  MPI_Comm    comm   = PetscObjectComm((PetscObject)body);
  const char *prefix = ((PetscObject)body)->prefix;
  PetscBool   loose, layer = (PetscBool)(body->layer.n_dofs > 0);

  PetscFunctionBegin;
  PetscCall(BodyAnyRank(body, &layer));
  if (!body->integrator->has_inertia) {
    PetscCall(IsLoose(body, body->held.n, body->held.dofs, PETSC_FALSE, &loose));
    PetscCheck(!loose, comm, PETSC_ERR_USER_INPUT,
               "Body '%s' is static, but nothing holds it, or not in all directions: it can move or turn as a whole; prescribe more "
               "displacements with -%sboundary_displacement%s",
               body->hdr.name, prefix, body->rows.global ? ", since contact cannot hold what has no stiffness of its own" : "");
  }
  if (layer) {
    PetscCall(IsLoose(body, body->layer.n_dofs, body->layer.dofs, PETSC_TRUE, &loose));
    PetscCheck(!loose, comm, PETSC_ERR_USER_INPUT,
               "Body '%s' has too few nodes with mass to hold its massless contact nodes, which can turn about them; refine the mesh, or "
               "set -%smass_redistribute false",
               body->hdr.name, prefix);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
