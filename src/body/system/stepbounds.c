/* The elements that bound the stable step of a body, and how they compare with the others. */
#include <body/layout/bodyimpl.h>

/* The median is looked for in an interval that becomes one of so many parts of it, again and again, until it is as short as this part of
   its place */
#define PARTS  1024
#define FOUND  1e-4
#define ROUNDS 24

/* One of the elements with the largest eigenvalues */
typedef struct {
  double eigenvalue, number, centre[3]; /* -1: there is none */
} Bound;

/* Puts an element in its place among those with the largest eigenvalues; of equal ones the first stays in front */
static void Insert(const Bound *bound, Bound list[BODY_STEP_BOUNDS])
{
  PetscInt place = BODY_STEP_BOUNDS;

  while (place > 0 && bound->eigenvalue > list[place - 1].eigenvalue) place--;
  if (place == BODY_STEP_BOUNDS) return;
  for (PetscInt k = BODY_STEP_BOUNDS - 1; k > place; k--) list[k] = list[k - 1];
  list[place] = *bound;
}

static void Clear(Bound list[BODY_STEP_BOUNDS])
{
  for (PetscInt k = 0; k < BODY_STEP_BOUNDS; k++) list[k] = (Bound){.eigenvalue = -1};
}

/* The largest ones of all ranks; u: displacement of this rank's nodes that the eigenvalues are those at */
static PetscErrorCode FindLargest(Body body, const PetscScalar u[], const PetscReal eigenvalues[], Bound list[BODY_STEP_BOUNDS])
{
  MPI_Comm    comm  = PetscObjectComm((PetscObject)body);
  PetscInt    count = body->model.element->count, offset;
  Bound       own[BODY_STEP_BOUNDS], *all;
  PetscMPIInt size;
  const int   numbers = BODY_STEP_BOUNDS * (int)(sizeof(Bound) / sizeof(double));

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Scan(&count, &offset, 1, MPIU_INT, MPI_SUM, comm));
  Clear(own);
  for (PetscInt e = 0; e < count; e++) Insert(&(const Bound){.eigenvalue = (double)eigenvalues[e], .number = (double)e}, own);
  for (PetscInt k = 0; k < BODY_STEP_BOUNDS && own[k].eigenvalue >= 0; k++) {
    const PetscInt e = (PetscInt)own[k].number;
    PetscReal      exact, centre[3] = {0};

    PetscCall(BodyGetElementEigenvalue(body, e, u, &exact)); /* others may be estimates */
    BodyGetElementCentre(body, e, centre);
    own[k] = (Bound){(double)exact, (double)(offset - count + e), {(double)centre[0], (double)centre[1], (double)centre[2]}};
  }
  PetscCall(PetscMalloc1(size * BODY_STEP_BOUNDS, &all));
  PetscCallMPI(MPI_Allgather(own, numbers, MPI_DOUBLE, all, numbers, MPI_DOUBLE, comm));
  Clear(list);
  for (PetscInt k = 0; k < size * BODY_STEP_BOUNDS; k++) Insert(&all[k], list);
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The median of the positive ones of all ranks, which is rank-wise a matter of counting; 0: there are none. The list is used up. */
static PetscErrorCode FindMedian(MPI_Comm comm, PetscInt n, PetscReal list[], PetscReal *median)
{
  PetscReal  range[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL}, lower, upper;
  PetscInt64 total = 0, before = 0, counts[PARTS];
  PetscInt   left = 0;

  PetscFunctionBegin;
  *median = 0;
  for (PetscInt i = 0; i < n; i++) {
    if (!(list[i] > 0)) continue;
    range[0]     = PetscMin(range[0], list[i]);
    range[1]     = PetscMin(range[1], -list[i]);
    list[left++] = list[i];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range, 2, MPIU_REAL, MPIU_MIN, comm));
  if (range[0] == PETSC_MAX_REAL) PetscFunctionReturn(PETSC_SUCCESS);
  lower = range[0];
  upper = -range[1];
  for (PetscInt round = 0; round < ROUNDS && upper - lower > FOUND * lower; round++) {
    const PetscReal width  = (upper - lower) / PARTS;
    PetscInt        n_left = left, part = 0;

    PetscCall(PetscArrayzero(counts, PARTS));
    for (PetscInt i = 0; i < left; i++) counts[PetscClipInterval((PetscInt)((list[i] - lower) / width), 0, PARTS - 1)]++;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, PARTS, MPIU_INT64, MPI_SUM, comm));
    for (PetscInt k = 0; k < PARTS && !round; k++) total += counts[k];
    while (2 * (before + counts[part]) < total) before += counts[part++];
    left = 0;
    for (PetscInt i = 0; i < n_left; i++)
      if (PetscClipInterval((PetscInt)((list[i] - lower) / width), 0, PARTS - 1) == part) list[left++] = list[i];
    lower += part * width;
    upper = lower + width;
  }
  *median = (lower + upper) / 2;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes which elements bound the step, from the eigenvalues of all, where history is forgotten. Collective. */
PetscErrorCode BodyNoteStepBounds(Body body, const PetscScalar u[], PetscReal eigenvalues[])
{
  BodyStepBounds *bounds = &body->time.bounds;
  PetscReal       median;
  Bound           list[BODY_STEP_BOUNDS];

  PetscFunctionBegin;
  PetscCall(FindLargest(body, u, eigenvalues, list));
  PetscCall(FindMedian(PetscObjectComm((PetscObject)body), body->model.element->count, eigenvalues, &median));
  bounds->n = 0;
  if (!(median > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetStepOfEigenvalue(body, median, &bounds->median));
  for (PetscInt k = 0; k < BODY_STEP_BOUNDS && list[k].eigenvalue > 0; k++) {
    PetscCall(BodyGetStepOfEigenvalue(body, (PetscReal)list[k].eigenvalue, &bounds->step[k]));
    bounds->number[k] = (PetscInt)list[k].number;
    for (PetscInt d = 0; d < 3; d++) bounds->centre[k][d] = (PetscReal)list[k].centre[d];
    bounds->n++;
  }
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
