/* The largest step for which central differences are stable: 2 / omega_max, from below. No eigenvalue of a body is larger than the
   largest of its elements (Irons and Treharne 1971), K x = lambda M x, and that is found from the elements alone: the time in which
   waves cross them, whatever their shape.

   Of a lumped mass, power iteration with the tangent of each element tells about how large its eigenvalue is, from below. The elements
   that come out on top are then solved exactly, which costs several times as much. Other masses: each element exactly. */
#include <body/layout/bodyimpl.h>

/* Elements with an estimate above this part of the largest one are solved exactly, from the top down, up to a number of them */
#define CLOSE     0.8
#define MAX_EXACT 200
/* Estimates of equal elements differ by round-off, which is less than this part of them: of these one is solved */
#define EQUAL 1e-9
/* Edges of equal elements differ by round-off of positions, which is less than this part of them */
#define SAME 1e-11

/* Whether an element is another one in another place, but for round-off, so that it has its tangent */
static PetscBool IsCopy(Body body, PetscInt e, PetscInt other, const PetscScalar u[])
{
  const PetscInt   n = body->model.element->nodes, *a = body->mesh.connectivity + e * n, *b = body->mesh.connectivity + other * n;
  const PetscInt   dim  = body->mesh.dim;
  const PetscReal *x    = body->mesh.coordinates;
  PetscReal        size = 0, off = 0;

  if (body->model.element->blocks || body->model.element->axisymmetric || body->history) return PETSC_FALSE;
  for (PetscInt k = 1; k < n; k++)
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal edge = x[dim * a[k] + d] - x[dim * a[0] + d] + PetscRealPart(u[dim * a[k] + d] - u[dim * a[0] + d]);
      const PetscReal same = x[dim * b[k] + d] - x[dim * b[0] + d] + PetscRealPart(u[dim * b[k] + d] - u[dim * b[0] + d]);

      size = PetscMax(size, PetscAbsReal(edge));
      off  = PetscMax(off, PetscAbsReal(edge - same));
    }
  return (PetscBool)(off <= SAME * size);
}

/* The largest eigenvalue of a lumped mass, from estimates for all elements, which `eigenvalues` becomes */
static PetscErrorCode LargestOfLumped(Body body, const PetscScalar u[], PetscReal eigenvalues[], PetscReal *largest)
{
  const PetscInt count = body->model.element->count;
  PetscReal      first[ELEMENT_MAX_DOFS], *sorted, exact;
  PetscInt      *order, n_exact = 0, last = -1; /* element that the tangent is of */
  PetscScalar    K[ELEMENT_MAX_DOFS * ELEMENT_MAX_DOFS];

  PetscFunctionBegin;
  /* no symmetry that an eigenvector could be orthogonal to; the same for all elements, so that equal ones give equal values */
  for (PetscInt i = 0; i < ELEMENT_MAX_DOFS; i++) first[i] = PetscSinReal(1 + 7.3 * i * i + 2.1 * i);
  PetscCall(PetscMalloc2(count, &sorted, count, &order));
  for (PetscInt e = 0; e < count; e++) {
    if (last < 0 || !IsCopy(body, e, last, u))
      PetscCall((*body->model.element->ops->tangent)(body->model.element, last = e, PETSC_FALSE, u, K));
    PetscCall(BodyEstimateElementEigenvalue(body, e, K, first, &eigenvalues[e]));
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

PetscErrorCode BodyComputeStableStep(Body body)
{
  PetscFunctionBegin;
  if (body->time.stable_step > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyComputeStableStepAt(body, NULL, PETSC_FALSE, &body->time.stable_step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@C
  BodyGetStepBounds - which elements bound the stable step of a body, and how they compare with the others

  Collective

  Input Parameter:
. body - the `Body`, set up

  Output Parameter:
. bounds - the same on every rank; owned by the body

  Level: intermediate

.seealso: `Body`, `BodyStepBounds`, `BodyGetStableStep()`
@*/
PetscErrorCode BodyGetStepBounds(Body body, const BodyStepBounds **bounds)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(bounds, 2);
  PetscCall(BodyComputeStableStep(body));
  *bounds = &body->time.bounds;
  PetscFunctionReturn(PETSC_SUCCESS);
}
