/*
   The largest step for which central differences are stable: 2 / omega_max, from below. No eigenvalue of a body is larger than the
   largest of its elements (Irons and Treharne 1971), K x = lambda M x, and that is found from the elements alone: the time in which
   waves cross them, whatever their shape.

   Of a lumped mass, power iteration with the tangent of each element tells about how large its eigenvalue is, from below. The elements
   that come out on top are then solved exactly, which costs several times as much. Other masses: each element exactly.
*/
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Estimates come from below, the closer the more iterations */
#define POWER_ITERATIONS 24
/* Elements with an estimate above this part of the largest one are solved exactly, from the top down, up to a number of them */
#define CLOSE     0.8
#define MAX_EXACT 200
/* Estimates of equal elements differ by round-off, which is less than this part of them: of these one is solved */
#define EQUAL 1e-9

static PetscBool IsMassless(Body body, PetscInt node)
{
  return (PetscBool)(body->mass.redistribute && body->layer.contains[node]);
}

/* Displacements that do not vibrate: of massless nodes, and of those that the axis holds */
static PetscBool IsStill(Body body, PetscInt node, PetscInt component)
{
  return (PetscBool)(IsMassless(body, node) || (component == 0 && body->mesh.on_axis && body->mesh.on_axis[node]));
}

/* Largest eigenvalue of one element with its massless nodes held, which is a bound whether they are free or prescribed; u: displacement of
   this rank's nodes. Where the body extrapolates, massless nodes have their own mass in the element and no stiffness: for inner
   displacements x with energy x^T K x, x^T E^T M E x is no less than the least of [x, y]^T M [x, y] over all displacements y of massless
   nodes. */
PetscErrorCode BodyGetElementEigenvalue(Body body, PetscInt e, const PetscScalar u[], PetscReal *largest)
{
  const PetscInt *nodes   = body->mesh.connectivity + e * body->model.element->nodes;
  const PetscInt  n_nodes = body->model.element->nodes, dim = body->mesh.dim, n = n_nodes * dim;
  PetscScalar     K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], M[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], work[4 * ELEMENT_MAX_DOFS];
  PetscScalar     of_nodes[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal       eigenvalues[ELEMENT_MAX_DOFS];
  PetscInt        kept[ELEMENT_MAX_DOFS], n_kept = 0;
  PetscBLASInt    one = 1, m, lwork = 4 * ELEMENT_MAX_DOFS, info;

  PetscFunctionBegin;
  *largest = 0;
  PetscCall((*body->model.element->ops->tangent)(body->model.element, e, PETSC_FALSE, u, K));
  PetscCall(BodyGetElementMass(body, e, of_nodes));
  for (PetscInt i = 0; i < n; i++) {
    const PetscBool moves = (PetscBool)(body->mass.extrapolation && IsMassless(body, nodes[i / dim]));

    if (moves || !IsStill(body, nodes[i / dim], i % dim)) kept[n_kept++] = i;
    for (PetscInt j = 0; j < n && moves; j++) K[i * n + j] = K[j * n + i] = 0;
  }
  if (!n_kept) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < n_kept; i++)
    for (PetscInt j = 0; j < n_kept; j++) {
      K[i * n_kept + j] = K[kept[i] * n + kept[j]];
      M[i * n_kept + j] = kept[i] % dim == kept[j] % dim ? of_nodes[kept[i] / dim * n_nodes + kept[j] / dim] : 0;
    }
  PetscCall(PetscBLASIntCast(n_kept, &m));
  PetscCallBLAS("LAPACKsygv", LAPACKsygv_(&one, "N", "L", &m, K, &m, M, &m, eigenvalues, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB,
             "Body '%s', element %" PetscInt_FMT ": no eigenvalues (LAPACK sygv info %d); is its mass matrix singular?", body->hdr.name, e,
             (int)info);
  *largest = eigenvalues[n_kept - 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Rayleigh quotient of an element with lumped mass after power iteration from the displacements `first` */
static PetscErrorCode EstimateEigenvalue(Body body, PetscInt e, const PetscScalar u[], const PetscReal first[], PetscReal *eigenvalue)
{
  const PetscInt *nodes = body->mesh.connectivity + e * body->model.element->nodes, dim = body->mesh.dim;
  const PetscInt  n_nodes = body->model.element->nodes, n = n_nodes * dim;
  PetscScalar     K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS], M[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal       x[ELEMENT_MAX_DOFS], inverse[ELEMENT_MAX_DOFS], force[ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  PetscCall((*body->model.element->ops->tangent)(body->model.element, e, PETSC_FALSE, u, K));
  PetscCall(BodyGetElementMass(body, e, M));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal mass = PetscRealPart(M[i / dim * (n_nodes + 1)]);

    inverse[i] = mass > 0 && !IsStill(body, nodes[i / dim], i % dim) ? 1 / mass : 0;
    x[i]       = inverse[i] > 0 ? first[i] : 0;
  }
  for (PetscInt iteration = 0; iteration <= POWER_ITERATIONS; iteration++) {
    PetscReal xKx = 0, xMx = 0, largest = 0;

    PetscCall(PetscArrayzero(force, n));
    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) force[i] += PetscRealPart(K[j * n + i]) * x[j];
    for (PetscInt i = 0; i < n; i++) {
      xKx += x[i] * force[i];
      xMx += inverse[i] > 0 ? PetscSqr(x[i]) / inverse[i] : 0;
      x[i]    = force[i] * inverse[i];
      largest = PetscMax(largest, PetscAbsReal(x[i]));
    }
    *eigenvalue = xMx > 0 ? xKx / xMx : 0;
    for (PetscInt i = 0; i < n && largest > 0; i++) x[i] /= largest;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest eigenvalue of a lumped mass, from estimates for all elements, which `eigenvalues` becomes */
static PetscErrorCode LargestOfLumped(Body body, const PetscScalar u[], PetscReal eigenvalues[], PetscReal *largest)
{
  const PetscInt count = body->model.element->count;
  PetscReal      first[ELEMENT_MAX_DOFS], *sorted, exact;
  PetscInt      *order, n_exact = 0;

  PetscFunctionBegin;
  /* no symmetry that an eigenvector could be orthogonal to; the same for all elements, so that equal ones give equal values */
  for (PetscInt i = 0; i < ELEMENT_MAX_DOFS; i++) first[i] = PetscSinReal(1 + 7.3 * i * i + 2.1 * i);
  PetscCall(PetscMalloc2(count, &sorted, count, &order));
  for (PetscInt e = 0; e < count; e++) {
    PetscCall(EstimateEigenvalue(body, e, u, first, &eigenvalues[e]));
    sorted[e] = eigenvalues[e];
    order[e]  = e;
  }
  PetscCall(PetscSortRealWithArrayInt(count, sorted, order));
  for (PetscInt k = count - 1; k >= 0 && sorted[k] >= CLOSE * sorted[count - 1] && n_exact < MAX_EXACT; k--) {
    if (k < count - 1 && sorted[k] >= (1 - EQUAL) * sorted[k + 1]) continue;
    PetscCall(BodyGetElementEigenvalue(body, order[k], u, &exact));
    *largest = PetscMax(*largest, exact);
    n_exact++;
  }
  PetscCall(PetscFree2(sorted, order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2 / omega, less with dashpots that feel the velocity at mid-step: (2 / omega) (sqrt(1 + zeta^2) - zeta), twice zeta omega being
   alpha + beta omega^2 */
PetscErrorCode BodyGetStepOfEigenvalue(Body body, PetscReal eigenvalue, PetscReal *step)
{
  PetscReal alpha, beta, rate;

  PetscFunctionBegin;
  PetscCall(BodyGetDamping(body, &alpha, &beta));
  rate  = alpha + beta * eigenvalue;
  *step = 4 / (rate + PetscSqrtReal(PetscSqr(rate) + 4 * eigenvalue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2 / omega_max, from below; less with dashpots. u: displacement of this rank's nodes; NULL: none, and the elements that bound the step are
   noted. Collective; or `alone`: of the rank that has the body. */
PetscErrorCode BodyComputeStableStepAt(Body body, const PetscScalar u[], PetscBool alone, PetscReal *step)
{
  const PetscInt     count   = body->model.element->count;
  PetscReal          largest = 0, *eigenvalues;
  PetscScalar       *zero    = NULL;
  const PetscScalar *at      = u;
  ElementHistory     before;

  PetscFunctionBegin;
  if (!u) {
    PetscCall(PetscCalloc1(body->mesh.local_nodes * body->mesh.dim, &zero));
    at = zero;
  }
  if (u) BodyHistoryLook(body, &before);
  else BodyHistoryForget(body, &before);
  PetscCall(PetscMalloc1(count, &eigenvalues));
  if (body->mass.type == BODY_MASS_LUMPED && body->mesh.dim > 1) PetscCall(LargestOfLumped(body, at, eigenvalues, &largest));
  else
    for (PetscInt e = 0; e < count; e++) {
      PetscCall(BodyGetElementEigenvalue(body, e, at, &eigenvalues[e]));
      largest = PetscMax(largest, eigenvalues[e]);
    }
  if (!u) PetscCall(BodyNoteStepBounds(body, at, eigenvalues));
  BodyHistoryLookBack(body, &before);
  PetscCall(PetscFree(eigenvalues));
  PetscCall(PetscFree(zero));
  if (!alone) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)body)));
  PetscCall(BodyGetStepOfEigenvalue(body, largest, step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of the undeformed body */
PetscErrorCode BodyComputeStableStep(Body body)
{
  PetscFunctionBegin;
  if (body->time.stable_step > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyComputeStableStepAt(body, NULL, PETSC_FALSE, &body->time.stable_step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
