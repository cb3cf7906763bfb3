/* A static body that contact or ties alone hold has a singular matrix: it can move, or turn, as if it were rigid. As many artificial
   springs as it has free motions make the matrix regular. Each pulls at one displacement, towards a place; they stand where a body without
   other supports would be held without redundancy. So the springs' forces are in balance with what loads and contact leave of force and
   moment: they vanish if, and only if, contact and loads are in balance without them, and the displacements are those without springs then.

   Contact brings that about (src/contact/interface/floating.c): it solves the step again and again, each time with the springs at rest
   where the body has come to the last time. That is the proximal point method (Rockafellar 1976) for the least energy under the conditions
   of contact. It converges wherever the body can be held, by k / (k + s) in each turn, k being the stiffness of a spring, s what contact
   and the body set against the motion; motions that nothing resists and nothing drives stay as they are. */
#include "held.h"

/* Of the springs, in parts of the stiffness of the softest static body, by default: soft beside what holds a body, and stiff enough that
   round-off in forces does not show in displacements: 1e-14 over the part with linear bodies, Newton's tolerance with others */
#define LINEAR_PART    5e-2
#define NONLINEAR_PART 1
/* The strain of the displacements by which a body's stiffness is measured: small, since the material may be nonlinear */
#define STRAIN 1e-6
/* Squares of free motions: all of a translation is 1. One of the node in the middle counts as MIDDLE_FIRST more if it is above DIFFERS. */
#define DIFFERS      0.1
#define MIDDLE_FIRST 1e3
/* A dof counts less the farther its node lies from the middle along its own axis, by this part at the size of the body: it moves where the
   body as a whole widens, and would take it along in a direction in which nothing holds it */
#define SPREAD 1.8

/* Stiffness of the body against being stretched along an axis (`across` is the same), or bent to a parabola in the plane of both [N/m] */
static PetscErrorCode MeasureStiffness(Body body, const RigidFrame *frame, PetscInt axis, PetscInt across, PetscReal *stiffness)
{
  const PetscInt dim = body->mesh.dim;
  Vec            u = body->work.nodes[0], force = body->work.nodes[1];
  PetscReal      energy, size                   = frame->size;
  PetscScalar   *array;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(u));
  PetscCall(VecGetArray(u, &array));
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    const PetscReal x = body->mesh.coordinates[node * dim + axis] - frame->centre[axis];
    const PetscReal y = body->mesh.coordinates[node * dim + across] - frame->centre[across];

    array[node * dim + axis] = STRAIN * (axis == across ? x : -2 * x * y / size);
    if (axis != across) array[node * dim + across] = STRAIN * x * x / size;
  }
  PetscCall(VecRestoreArray(u, &array));
  PetscCall(BodyComputeInternalForce(body, u, force));
  PetscCall(VecDot(u, force, &energy));
  *stiffness = energy / PetscSqr(STRAIN * size * (axis == across ? 1 : 0.25));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Least stiffness of the undeformed body against being stretched along its longest edge and bent [N/m]. Collective. */
PetscErrorCode BodyGetLeastStiffness(Body body, PetscReal *least)
{
  PetscReal  box[6]  = {0};
  PetscInt   longest = 0;
  RigidFrame frame;

  PetscFunctionBegin;
  PetscCall(BodyGetRigidFrame(body, &frame));
  PetscCall(DMGetBoundingBox(body->mesh.dm, box, box + 3));
  for (PetscInt d = 1; d < body->mesh.dim; d++)
    if (box[3 + d] - box[d] > box[3 + longest] - box[longest]) longest = d;
  *least = PETSC_MAX_REAL;
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscReal stiffness = 0;

    PetscCall(MeasureStiffness(body, &frame, longest, d, &stiffness));
    *least = PetscMin(*least, stiffness);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The owned node nearest to the middle of the body's box, on the rank that has it; -1 on others */
static PetscErrorCode FindMiddle(Body body, const RigidFrame *frame, PetscInt *middle)
{
  struct {
    double value;
    int    rank;
  } nearest = {PETSC_MAX_REAL, 0};
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)body), &rank));
  nearest.rank = rank;
  *middle      = -1;
  for (PetscInt node = 0; node < body->mesh.owned_nodes; node++) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < body->mesh.dim; d++) square += PetscSqr(body->mesh.coordinates[node * body->mesh.dim + d] - frame->centre[d]);
    if ((double)square >= nearest.value) continue;
    nearest.value = (double)square;
    *middle       = node;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE_INT, MPI_MINLOC, PetscObjectComm((PetscObject)body)));
  if (nearest.rank != rank) *middle = -1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dof at which the free motions differ most from those that the springs so far hold, by Gram and Schmidt; -1 on ranks that do not own
   it. Dofs of the node in the middle come first, where they differ at all: so a body that may slide stays where its middle is, and one that
   may turn turns about it. `held`: what
   the free motions are at the dofs of these springs, orthonormal. */
static PetscErrorCode PlaceSpring(Body body, const RigidFrame *frame, PetscInt middle, PetscInt n_free, const PetscReal free[],
                                  PetscReal held[], PetscInt n)
{
  PetscReal row[BODY_MAX_RIGID] = {0}, motion[BODY_MAX_RIGID], both[2 * BODY_MAX_RIGID] = {0}, norm;
  PetscInt  next = 0;
  struct {
    double value;
    int    rank;
  } best = {-1, 0};
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)body), &rank));
  best.rank            = rank;
  body->springs.dof[n] = -1;
  for (PetscInt dof = 0; dof < body->mesh.owned_nodes * body->mesh.dim; dof++) {
    PetscReal square = 0;

    if (next < body->held.n && body->held.dofs[next] == dof) {
      next++;
      continue;
    }
    for (PetscInt k = 0; k < n_free; k++) {
      motion[k] = 0;
      for (PetscInt i = 0; i < frame->n; i++) motion[k] += free[k * frame->n + i] * BodyRigidMotion(body, frame, i, dof);
      row[k] = motion[k];
    }
    for (PetscInt m = 0; m < n; m++) {
      PetscReal dot = 0;

      for (PetscInt k = 0; k < n_free; k++) dot += row[k] * held[m * n_free + k];
      for (PetscInt k = 0; k < n_free; k++) row[k] -= dot * held[m * n_free + k];
    }
    for (PetscInt k = 0; k < n_free; k++) square += PetscSqr(row[k]);
    square *= 1 - SPREAD * PetscAbsReal(body->mesh.coordinates[dof] - frame->centre[dof % body->mesh.dim]) / frame->size;
    if (dof / body->mesh.dim == middle && square > DIFFERS) square += MIDDLE_FIRST;
    if ((double)square <= best.value) continue;
    best.value           = (double)square;
    body->springs.dof[n] = dof;
    PetscCall(PetscArraycpy(both, row, n_free));
    PetscCall(PetscArraycpy(both + n_free, motion, n_free));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, PetscObjectComm((PetscObject)body)));
  if (best.rank != rank) body->springs.dof[n] = -1;
  PetscCallMPI(MPI_Bcast(both, (PetscMPIInt)(2 * n_free), MPIU_REAL, best.rank, PetscObjectComm((PetscObject)body)));
  norm = 0;
  for (PetscInt k = 0; k < n_free; k++) norm += PetscSqr(both[k]);
  norm = PetscSqrtReal(norm);
  for (PetscInt k = 0; k < n_free; k++) {
    held[n * n_free + k]                     = both[k] / norm;
    body->springs.at_springs[k * n_free + n] = both[n_free + k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Springs for the free motions of a body, each given by its parts of the rigid motions, orthonormal; none where it has none */
PetscErrorCode BodySetUpSprings(Body body, PetscInt n_free, const PetscReal free[])
{
  BodySprings *springs = &body->springs;
  PetscReal    held[BODY_MAX_RIGID * BODY_MAX_RIGID];
  PetscInt     middle = -1;
  RigidFrame   frame;

  PetscFunctionBegin;
  springs->n = n_free;
  if (!n_free) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetRigidFrame(body, &frame));
  if (springs->part == PETSC_DECIDE) springs->part = body->model.linear ? LINEAR_PART : NONLINEAR_PART;
  PetscCall(BodyGetLeastStiffness(body, &springs->stiffness));
  springs->stiffness *= springs->part;
  springs->size = frame.size;
  PetscCall(PetscArraycpy(springs->motions, free, n_free * frame.n));
  PetscCall(FindMiddle(body, &frame, &middle));
  for (PetscInt n = 0; n < n_free; n++) PetscCall(PlaceSpring(body, &frame, middle, n_free, free, held, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F += the force that the springs need to be where U has them. While the body is probed, from rest, they rest where it does. */
PetscErrorCode BodyAddSpringForce(Body body, Vec U, Vec F)
{
  const BodySprings *springs = &body->springs;
  const PetscScalar *u;
  PetscScalar       *f;

  PetscFunctionBegin;
  if (!springs->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(U, &u));
  PetscCall(VecGetArray(F, &f));
  for (PetscInt k = 0; k < springs->n; k++)
    if (springs->dof[k] >= 0) f[springs->dof[k]] += springs->stiffness * (u[springs->dof[k]] - (body->unloaded ? 0 : springs->place[k]));
  PetscCall(VecRestoreArray(F, &f));
  PetscCall(VecRestoreArrayRead(U, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyAddSpringStiffness(Body body, Mat A)
{
  const BodySprings *springs = &body->springs;
  PetscInt           rstart;

  PetscFunctionBegin;
  if (!springs->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetOwnershipRange(A, &rstart, NULL));
  for (PetscInt k = 0; k < springs->n; k++)
    if (springs->dof[k] >= 0) PetscCall(MatSetValue(A, rstart + springs->dof[k], rstart + springs->dof[k], springs->stiffness, ADD_VALUES));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}
