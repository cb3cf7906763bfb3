/*
   The largest step for which central differences are stable: 2 / omega_max, from below. No eigenvalue of a body is larger than the
   largest of its elements (Irons and Treharne 1971), K x = lambda M x, and that is found from the elements alone: the time in which
   waves cross them, whatever their shape.

   A lumped mass: power iteration with the internal force of each element on its own, which costs as much as some explicit steps;
   it comes from below, so the elements that come out on top, and those close to them, are solved for exactly. Other masses: each
   element exactly.
*/
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Estimates come from below, the closer the more iterations; the elements that come out on top are solved for exactly afterwards */
#define POWER_ITERATIONS 24
/* Elements at a time; a multiple of what element loops take in a batch */
#define CHUNK 1024
/* Elements with an estimate above this part of the largest one are solved for exactly, from the top down in bands of this width, relative
   to it, up to a number of them, for that costs much more than an estimate */
#define CLOSE     0.8
#define BAND      0.02
#define MAX_EXACT 200
/* The first band: estimates of equal elements differ by round-off, which is less than this part of them */
#define EQUAL 1e-9
/* Displacement in power iteration, relative to the size of the element: a strain small enough for a nonlinear material to be linear, and
   large against the round-off of positions */
#define PROBE_STRAIN 1e-6

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

/* Work space of power iteration on a chunk of elements, each with nodes of its own */
typedef struct {
  PetscInt   count;
  PetscInt  *connectivity, *elements;
  PetscReal *coordinates, *size;
  PetscReal *inverse_mass, *u, *f;
  PetscReal *at, *moved, *force; /* displacement that the eigenvalues are those at, with u, and the force there */
  char      *memory;             /* of the history */
  PetscReal *history;            /* NULL: the material is virgin, or has none */
} Chunk;

static PetscErrorCode FillChunk(Body body, PetscInt begin, const PetscScalar u[], Chunk *chunk)
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  PetscScalar    M[ELEMENT_MAX_NODES * ELEMENT_MAX_NODES];
  PetscReal      first[ELEMENT_MAX_DOFS] = {0};

  PetscFunctionBegin;
  /* no symmetry that an eigenvector could be orthogonal to; the same for all elements, so that equal ones give equal values */
  for (PetscInt i = 0; i < n * dim; i++) first[i] = PetscSinReal(1 + 7.3 * i * i + 2.1 * i);
  for (PetscInt c = 0; c < chunk->count; c++) {
    const PetscInt *nodes  = body->mesh.connectivity + (begin + c) * n;
    PetscReal       extent = 0;

    chunk->elements[c] = begin + c;
    PetscCall(BodyGetElementMass(body, begin + c, M));
    for (PetscInt a = 0; a < n; a++) {
      const PetscInt own = c * n + a;

      chunk->connectivity[own] = own;
      for (PetscInt d = 0; d < dim; d++) {
        const PetscReal mass = M[a * n + a];

        chunk->coordinates[own * dim + d] = body->mesh.coordinates[nodes[a] * dim + d];
        chunk->at[own * dim + d]          = PetscRealPart(u[nodes[a] * dim + d]);
        extent = PetscMax(extent, PetscAbsReal(body->mesh.coordinates[nodes[a] * dim + d] - body->mesh.coordinates[nodes[0] * dim + d]));
        chunk->inverse_mass[own * dim + d] = mass > 0 && !IsStill(body, nodes[a], d) ? 1 / mass : 0;
        chunk->u[own * dim + d]            = first[a * dim + d];
      }
    }
    chunk->size[c] = extent;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rayleigh quotients after some iterations, one for each element of the chunk */
static PetscErrorCode Iterate(Body body, Element element, Chunk *chunk, PetscBool deformed, PetscReal eigenvalues[])
{
  const PetscInt n = body->model.element->nodes * body->mesh.dim;

  PetscFunctionBegin;
  if (deformed) {
    if (chunk->history) BodyHistoryGather(body, PETSC_TRUE, element, chunk->elements, chunk->history);
    element->history.start = chunk->history;
    element->history.end   = NULL;
    element->history.step  = -1;
    PetscCall(PetscArrayzero(chunk->force, chunk->count * n));
    PetscCall((*element->ops->internalforce)(element, chunk->at, chunk->force));
  }
  for (PetscInt iteration = 0; iteration <= POWER_ITERATIONS; iteration++) {
    for (PetscInt c = 0; c < chunk->count; c++) {
      PetscReal *u = chunk->u + c * n, norm = 0;

      for (PetscInt i = 0; i < n; i++) {
        if (chunk->inverse_mass[c * n + i] == 0) u[i] = 0;
        norm = PetscMax(norm, PetscAbsReal(u[i]));
      }
      for (PetscInt i = 0; i < n && norm > 0; i++) u[i] *= PROBE_STRAIN * chunk->size[c] / norm;
    }
    PetscCall(PetscArrayzero(chunk->f, chunk->count * n));
    if (deformed) {
      for (PetscInt i = 0; i < chunk->count * n; i++) chunk->moved[i] = chunk->at[i] + chunk->u[i];
      PetscCall((*element->ops->internalforce)(element, chunk->moved, chunk->f));
      for (PetscInt i = 0; i < chunk->count * n; i++) chunk->f[i] -= chunk->force[i];
    } else PetscCall((*element->ops->internalforce)(element, chunk->u, chunk->f));
    for (PetscInt c = 0; c < chunk->count; c++) {
      PetscReal *u = chunk->u + c * n, *f = chunk->f + c * n, uKu = 0, uMu = 0;

      for (PetscInt i = 0; i < n; i++) {
        uKu += u[i] * f[i];
        if (chunk->inverse_mass[c * n + i] > 0) uMu += u[i] * u[i] / chunk->inverse_mass[c * n + i];
        u[i] = f[i] * chunk->inverse_mass[c * n + i];
      }
      eigenvalues[c] = uMu > 0 ? uKu / uMu : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Estimates for all elements of this rank */
static PetscErrorCode EstimateEigenvalues(Body body, const PetscScalar u[], PetscBool deformed, PetscReal eigenvalues[])
{
  const PetscInt n = body->model.element->nodes, dim = body->mesh.dim;
  Chunk          chunk;
  Element        element;
  PetscInt       size;

  PetscFunctionBegin;
  PetscCall(PetscMalloc6(CHUNK * n, &chunk.connectivity, CHUNK * n * dim, &chunk.coordinates, CHUNK, &chunk.size, CHUNK * n * dim,
                         &chunk.inverse_mass, CHUNK * n * dim, &chunk.u, CHUNK * n * dim, &chunk.f));
  PetscCall(PetscMalloc4(CHUNK, &chunk.elements, CHUNK * n * dim, &chunk.at, CHUNK * n * dim, &chunk.moved, CHUNK * n * dim, &chunk.force));
  PetscCall(BodyHistoryCreateBuffer(body, deformed ? CHUNK : 0, &size, &chunk.memory, &chunk.history));
  for (PetscInt begin = 0; begin < body->model.element->count; begin += CHUNK) {
    chunk.count = PetscMin(CHUNK, body->model.element->count - begin);
    PetscCall(FillChunk(body, begin, u, &chunk));
    PetscCall(ElementCreateSelection(body->model.element, PETSC_FALSE, chunk.count, chunk.elements, chunk.connectivity, chunk.coordinates,
                                     &element));
    PetscCall(Iterate(body, element, &chunk, deformed, eigenvalues + begin));
    PetscCall(ElementDestroy(&element));
  }
  PetscCall(PetscFree(chunk.memory));
  PetscCall(PetscFree4(chunk.elements, chunk.at, chunk.moved, chunk.force));
  PetscCall(PetscFree6(chunk.connectivity, chunk.coordinates, chunk.size, chunk.inverse_mass, chunk.u, chunk.f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest eigenvalue, from estimates for all elements, which `eigenvalues` becomes */
static PetscErrorCode LargestOfLumped(Body body, const PetscScalar u[], PetscBool deformed, PetscReal eigenvalues[], PetscReal *largest)
{
  const PetscInt count = body->model.element->count;
  PetscReal      top = 0, above = PETSC_MAX_REAL, exact, last = -1;
  PetscInt       n_exact = 0;

  PetscFunctionBegin;
  PetscCall(EstimateEigenvalues(body, u, deformed, eigenvalues));
  for (PetscInt e = 0; e < count; e++) top = PetscMax(top, eigenvalues[e]);
  /* from the top down, band by band */
  while (above > CLOSE * top && n_exact < MAX_EXACT) {
    const PetscReal bound = above < PETSC_MAX_REAL ? above - BAND * top : (1 - EQUAL) * top;

    for (PetscInt e = 0; e < count && n_exact < MAX_EXACT; e++) {
      if (eigenvalues[e] < bound || eigenvalues[e] >= above || eigenvalues[e] == last) continue; /* of equal neighbours, one */
      last = eigenvalues[e];
      PetscCall(BodyGetElementEigenvalue(body, e, u, &exact));
      *largest = PetscMax(*largest, exact);
      n_exact++;
    }
    above = bound;
  }
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
  if (body->mass.type == BODY_MASS_LUMPED && body->mesh.dim > 1)
    PetscCall(LargestOfLumped(body, at, (PetscBool)(u != NULL), eigenvalues, &largest));
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
