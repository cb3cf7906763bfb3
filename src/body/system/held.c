/* Whether the displacements that are held, or the nodes with mass, keep a body from rigid motions, and which it is free to make. */
#include "held.h"
#include <petscblaslapack.h>

/* A rigid motion is free if its eigenvalue of the Gram matrix of all rigid motions on the fixed dofs is below this part of the
   largest one. Round-off makes 1e-15 of it; two held nodes hold the body if they are more
   than some 1e-5 of its size apart, the square root of this. */
#define FREE 1e-10
/* Rigid motions that are named, of those that a free one is made of: from this part of the largest on */
#define NAMED 0.1

PetscErrorCode BodyGetRigidFrame(Body body, RigidFrame *frame)
{
  PetscReal box[6] = {0};

  PetscFunctionBegin;
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  frame->size = 0;
  for (PetscInt d = 0; d < 3; d++) frame->centre[d] = d < body->mesh.dim ? 0.5 * (box[d] + box[3 + d]) : 0;
  for (PetscInt d = 0; d < body->mesh.dim; d++) frame->size = PetscMax(frame->size, box[3 + d] - box[d]);
  frame->n = body->mesh.dim == 1 ? 1 : 3 * (body->mesh.dim - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a rigid motion is at an owned dof */
PetscReal BodyRigidMotion(Body body, const RigidFrame *frame, PetscInt motion, PetscInt dof)
{
  const PetscInt dim = body->mesh.dim, component = dof % dim, axis = dim == 2 ? 2 : motion - dim;
  PetscReal      r[3] = {0};

  if (motion < dim) return motion == component ? 1 : 0;
  for (PetscInt d = 0; d < dim; d++) r[d] = (body->mesh.coordinates[dof - component + d] - frame->centre[d]) / frame->size;
  if (component == (axis + 1) % 3) return -r[(axis + 2) % 3];
  if (component == (axis + 2) % 3) return r[(axis + 1) % 3];
  return 0;
}

/* The rigid motions that leave all fixed dofs in place: those of the list, which is of owned dofs, ascending, or all others; of all ranks
   together. `n_free` rows of `free`, each of as many numbers as there are rigid motions, orthonormal. */
static PetscErrorCode FindFreeMotions(Body body, PetscInt n_fixed, const PetscInt fixed[], PetscBool others, PetscInt *n_free,
                                      PetscReal free[])
{
  MPI_Comm     comm                                  = PetscObjectComm((PetscObject)body);
  PetscReal    gram[BODY_MAX_RIGID * BODY_MAX_RIGID] = {0}, eigenvalues[BODY_MAX_RIGID], work[4 * BODY_MAX_RIGID];
  PetscBLASInt order, lwork = 4 * BODY_MAX_RIGID, info;
  PetscInt     next = 0, n;
  RigidFrame   frame;

  PetscFunctionBegin;
  PetscCall(BodyGetRigidFrame(body, &frame));
  n     = frame.n;
  order = (PetscBLASInt)n;
  for (PetscInt dof = 0; dof < body->mesh.owned_nodes * body->mesh.dim; dof++) {
    const PetscBool listed = (PetscBool)(next < n_fixed && fixed[next] == dof);

    if (listed) next++;
    if (listed == others) continue;
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < n; b++) gram[a * n + b] += BodyRigidMotion(body, &frame, a, dof) * BodyRigidMotion(body, &frame, b, dof);
  }
  if (body->model.element->axisymmetric) /* rings are stretched by all but a motion along the axis */
    for (PetscInt a = 0; a < n; a++) gram[a * n + a] += a == 1 ? 0 : body->mesh.owned_nodes;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, gram, (PetscMPIInt)(n * n), MPIU_REAL, MPIU_SUM, comm));
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, gram, &order, eigenvalues, work, &lwork, &info));
  PetscCheck(info == 0, comm, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  *n_free = 0;
  while (*n_free < n && !(eigenvalues[*n_free] > FREE * eigenvalues[n - 1])) (*n_free)++;
  PetscCall(PetscArraycpy(free, gram, *n_free * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unit vectors, orthogonal to each other, that span the axes about which held displacements let the body turn: three numbers each */
PetscErrorCode BodyFindTurns(Body body, PetscInt *n, PetscReal axes[9])
{
  const PetscInt dim = body->mesh.dim, n_rigid = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal      free[BODY_MAX_RIGID * BODY_MAX_RIGID];
  PetscInt       n_free;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(PetscArrayzero(axes, 9));
  PetscCall(FindFreeMotions(body, body->held.n, body->held.dofs, PETSC_FALSE, &n_free, free));
  for (PetscInt k = 0; k < n_free && *n < 2 * dim - 3; k++) { /* by Gram and Schmidt */
    PetscReal *axis = axes + 3 * *n, square = 0;

    for (PetscInt d = 0; d < 3; d++) axis[d] = dim == 3 ? free[k * n_rigid + 3 + d] : d == 2 ? free[k * n_rigid + 2] : 0;
    for (PetscInt other = 0; other < *n; other++) {
      PetscReal dot = 0;

      for (PetscInt d = 0; d < 3; d++) dot += axis[d] * axes[3 * other + d];
      for (PetscInt d = 0; d < 3; d++) axis[d] -= dot * axes[3 * other + d];
    }
    for (PetscInt d = 0; d < 3; d++) square += PetscSqr(axis[d]);
    for (PetscInt d = 0; d < 3 && square > FREE; d++) axis[d] /= PetscSqrtReal(square);
    if (square > FREE) (*n)++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Names a motion by how much it has of each rigid motion: "move along x and turn about z" */
PetscErrorCode BodyDescribeMotions(PetscInt dim, const PetscReal parts[], size_t size, char text[])
{
  const PetscInt n       = dim == 1 ? 1 : 3 * (dim - 1);
  PetscReal      largest = 0;
  PetscInt       kind    = -1; /* of the last motion named: 0 translation, 1 rotation */

  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, PetscAbsReal(parts[i]));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt turns = i >= dim;
    const char    *verb = turns ? "turn about" : "move along", axis = "xyz"[turns ? (dim == 2 ? 2 : i - dim) : i];
    char           piece[32];

    if (PetscAbsReal(parts[i]) < NAMED * largest || largest == 0) continue;
    PetscCall(PetscSNPrintf(piece, sizeof(piece), "%s%s %c",
                            kind < 0        ? ""
                            : kind == turns ? ","
                                            : " and ",
                            kind == turns ? "" : verb, axis));
    PetscCall(PetscStrlcat(text, piece, size));
    kind = turns;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefuseLoose(Body body, PetscInt n_free, const PetscReal free[])
{
  PetscReal  parts[BODY_MAX_RIGID] = {0};
  RigidFrame frame;
  char       text[128];

  PetscFunctionBegin;
  PetscCall(BodyGetRigidFrame(body, &frame));
  for (PetscInt i = 0; i < frame.n; i++) {
    for (PetscInt k = 0; k < n_free; k++) parts[i] += PetscSqr(free[k * frame.n + i]);
    parts[i] = PetscSqrtReal(parts[i]);
  }
  PetscCall(BodyDescribeMotions(body->mesh.dim, parts, sizeof(text), text));
  SETERRQ(PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
          "Body '%s' is static, but nothing holds it, or not in all directions: it can %s as a whole; prescribe more displacements with "
          "-%sboundary_displacement, or let contact or ties hold it",
          body->hdr.name, text, ((PetscObject)body)->prefix);
}

/* The matrix of a body with rigid motions is singular, which factors need not show. A static body with too few held displacements has
   `n_free` motions for artificial springs with contact rows, else an error, as is a massless layer that too few nodes with mass hold. */
PetscErrorCode BodyCheckHeld(Body body, PetscInt *n_free, PetscReal free[])
{
  PetscReal rows, of_layer[BODY_MAX_RIGID * BODY_MAX_RIGID];
  PetscInt  n_of_layer;

  PetscFunctionBegin;
  *n_free = 0;
  if (!body->integrator->has_inertia) {
    PetscCall(FindFreeMotions(body, body->held.n, body->held.dofs, PETSC_FALSE, n_free, free));
    PetscCall(MatNorm(body->rows.matrix, NORM_FROBENIUS, &rows)); /* the rows of all pairs are there, those of others empty */
    if (*n_free && rows == 0) PetscCall(RefuseLoose(body, *n_free, free));
  }
  if (body->layer.exists) {
    PetscCall(FindFreeMotions(body, body->layer.n_dofs, body->layer.dofs, PETSC_TRUE, &n_of_layer, of_layer));
    PetscCheck(!n_of_layer, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
               "Body '%s' has too few nodes with mass to hold its massless contact nodes, which can turn about them; refine the mesh, or "
               "set -%smass_redistribute false",
               body->hdr.name, ((PetscObject)body)->prefix);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
