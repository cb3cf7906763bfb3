/* The elements that bound the stable step of a body, and how they compare with the others. */
#include <body/layout/bodyimpl.h>

/* Eigenvalues of elements alike differ by less than this part of them: then the first element comes first */
#define EQUAL 1e-9

/* 2 / omega, less with dashpots at mid-step: (2 / omega) (sqrt(1 + zeta^2) - zeta), twice zeta omega being alpha + beta omega^2 */
PetscErrorCode BodyGetStepOfEigenvalue(Body body, PetscReal eigenvalue, PetscReal *step)
{
  PetscReal alpha, beta, rate;

  PetscFunctionBegin;
  PetscCall(BodyGetDamping(body, &alpha, &beta));
  rate  = alpha + beta * eigenvalue;
  *step = 4 / (rate + PetscSqrtReal(PetscSqr(rate) + 4 * eigenvalue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Positive eigenvalues of all elements, ascending, and the elements' numbers over ranks; `offset`: this rank's first. Caller frees both. */
static PetscErrorCode SortAll(Body body, const PetscReal eigenvalues[], PetscInt *offset, PetscInt *n, PetscReal **all, PetscInt **numbers)
{
  MPI_Comm       comm = PetscObjectComm((PetscObject)body);
  PetscMPIInt    count, *counts, *offsets;
  const PetscInt size  = body->rows.size;
  PetscInt       total = 0, zeros = 0;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(body->model.element->count, &count));
  PetscCall(PetscMalloc2(size, &counts, size, &offsets));
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts, 1, MPI_INT, comm));
  PetscCallMPI(MPI_Scan(&body->model.element->count, offset, 1, MPIU_INT, MPI_SUM, comm));
  *offset -= count;
  for (PetscInt r = 0; r < size; total += counts[r++]) PetscCall(PetscMPIIntCast(total, &offsets[r]));
  PetscCall(PetscMalloc2(total, all, total, numbers));
  PetscCallMPI(MPI_Allgatherv(eigenvalues, count, MPIU_REAL, *all, counts, offsets, MPIU_REAL, comm));
  for (PetscInt e = 0; e < total; e++) {
    if (!((*all)[e] > 0)) {
      zeros++;
      continue;
    }
    (*all)[e - zeros]     = (*all)[e];
    (*numbers)[e - zeros] = e;
  }
  *n = total - zeros;
  PetscCall(PetscFree2(counts, offsets));
  PetscCall(PetscSortRealWithArrayInt(*n, *all, *numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes which elements bound the step, from all eigenvalues, some estimated. u: displacement of this rank's nodes. Collective. */
PetscErrorCode BodyNoteStepBounds(Body body, const PetscScalar u[], const PetscReal eigenvalues[])
{
  BodyStepBounds *bounds                     = &body->time.bounds;
  PetscReal       found[BODY_STEP_BOUNDS][4] = {{0}}, *all; /* eigenvalue and centre */
  PetscInt        order[BODY_STEP_BOUNDS], offset, n = 0, *numbers;

  PetscFunctionBegin;
  PetscCall(SortAll(body, eigenvalues, &offset, &n, &all, &numbers));
  bounds->n = PetscMin(n, BODY_STEP_BOUNDS);
  for (PetscInt k = 0; k < bounds->n; k++) {
    const PetscInt e = numbers[n - 1 - k] - offset;

    order[k] = k;
    if (e < 0 || e >= body->model.element->count) continue;
    PetscCall(BodyGetElementEigenvalue(body, e, u, &found[k][0]));
    BodyGetElementCentre(body, e, &found[k][1]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found, 4 * BODY_STEP_BOUNDS, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  for (PetscInt k = 1; k < bounds->n; k++)
    for (PetscInt j = k; j > 0; j--) {
      const PetscInt  one = order[j], before = order[j - 1];
      const PetscReal less = EQUAL * found[before][0], more = found[one][0] - found[before][0];

      if (more > less || (more >= -less && numbers[n - 1 - one] < numbers[n - 1 - before])) {
        order[j]     = before;
        order[j - 1] = one;
      }
    }
  for (PetscInt k = 0; k < bounds->n; k++) {
    PetscCall(BodyGetStepOfEigenvalue(body, found[order[k]][0], &bounds->step[k]));
    bounds->number[k] = numbers[n - 1 - order[k]];
    PetscCall(PetscArraycpy(bounds->centre[k], found[order[k]] + 1, 3));
  }
  if (n) PetscCall(BodyGetStepOfEigenvalue(body, all[(n - 1) / 2], &bounds->median));
  PetscCall(PetscFree2(all, numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}
