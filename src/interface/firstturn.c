/* The turn of gaps before contact (balance.c): that which makes the smallest gap of all rows largest, so that nodes on both sides of the
   place where surfaces meet touch at one time. */
#include "interfaceimpl.h"

/* Rows that are looked at to find the turn before contact, at most; each time the one that is nearest to contact is added */
#define ROUNDS 24
/* A turn before contact within this part of the largest is right */
#define PRECISION 1e-12
/* With a turn beyond this part of the largest one no two sides of the place have been found: the surfaces meet beyond the rows */
#define BEYOND 0.9

/* A row as the turn before contact sees it: its gap is gap + sum_k uneven[k] turn[k] */
typedef struct {
  PetscReal gap, uneven[2];
} Plane;

/* The smallest gap of some rows with this turn */
static PetscReal LeastGap(PetscInt n, PetscInt n_planes, const Plane planes[], const PetscReal turn[])
{
  PetscReal least = PETSC_MAX_REAL;

  for (PetscInt i = 0; i < n_planes; i++) {
    PetscReal gap = planes[i].gap;

    for (PetscInt k = 0; k < n; k++) gap += planes[i].uneven[k] * turn[k];
    least = PetscMin(least, gap);
  }
  return least;
}

/* The turn with which gaps of n + 1 rows are the same; false if there is none */
static PetscBool MakeEven(PetscInt n, const Plane *a, const Plane *b, const Plane *c, PetscReal turn[])
{
  PetscReal p[2], q[2], determinant;

  for (PetscInt k = 0; k < n; k++) {
    p[k] = b->uneven[k] - a->uneven[k];
    q[k] = c->uneven[k] - a->uneven[k];
  }
  if (n == 1) {
    if (p[0] == 0) return PETSC_FALSE;
    turn[0] = (a->gap - b->gap) / p[0];
    return PETSC_TRUE;
  }
  determinant = p[0] * q[1] - p[1] * q[0];
  if (PetscAbsReal(determinant) < PETSC_SMALL * PetscSqrtReal((p[0] * p[0] + p[1] * p[1]) * (q[0] * q[0] + q[1] * q[1])))
    return PETSC_FALSE;
  turn[0] = ((a->gap - b->gap) * q[1] - (a->gap - c->gap) * p[1]) / determinant;
  turn[1] = ((a->gap - c->gap) * p[0] - (a->gap - b->gap) * q[0]) / determinant;
  return PETSC_TRUE;
}

/* The turn that makes the smallest gap of some rows largest: at it n + 1 of them are the same */
static PetscReal RaiseLeastGap(PetscInt n, PetscInt n_planes, const Plane planes[], PetscReal turn[])
{
  PetscReal most = -PETSC_MAX_REAL, at[2] = {0, 0};

  for (PetscInt i = 0; i < n_planes; i++)
    for (PetscInt j = i + 1; j < n_planes; j++)
      for (PetscInt k = n == 1 ? j : j + 1; k < (n == 1 ? j + 1 : n_planes); k++) {
        PetscReal gap;

        if (!MakeEven(n, &planes[i], &planes[j], &planes[k], at)) continue;
        gap = LeastGap(n, n_planes, planes, at);
        if (gap <= most) continue;
        most = gap;
        for (PetscInt d = 0; d < n; d++) turn[d] = at[d];
      }
  return most;
}

/* The turn before contact: rows are taken in, the nearest to contact each time, until it stays */
PetscErrorCode TransferFindTurn(Transfer transfer, PetscReal turn[])
{
  const Balance *balance = &transfer->balance;
  const PetscInt n       = balance->n;
  Plane          planes[ROUNDS + 4];
  PetscInt       n_planes = 0;
  PetscReal      most     = PETSC_MAX_REAL;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) turn[k] = 0;
  for (PetscInt round = 0; round < ROUNDS; round++) {
    struct {
      double gap;
      int    rank;
    } least             = {PETSC_MAX_REAL, 0};
    Plane       nearest = {0};
    PetscMPIInt rank;

    PetscCallMPI(MPI_Comm_rank(transfer->comm, &rank));
    least.rank = rank;
    for (PetscInt row = 0; row < transfer->n; row++) {
      PetscReal gap   = balance->gap[row] - balance->turned[row];
      Plane     plane = {.gap = gap};

      if (!transfer->rows.opposite[row]) continue;
      for (PetscInt k = 0; k < n; k++) {
        plane.uneven[k] = balance->uneven[n * row + k];
        gap += plane.uneven[k] * turn[k];
      }
      if ((plane.uneven[0] == 0 && plane.uneven[n - 1] == 0) || gap >= least.gap) continue;
      least.gap = gap;
      nearest   = plane;
    }
    PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, transfer->comm));
    if (least.gap == PETSC_MAX_REAL || least.gap >= most - PRECISION * balance->largest) break;
    PetscCallMPI(MPI_Bcast(&nearest, 3, MPIU_REAL, least.rank, transfer->comm));
    if (round == 0) /* walls that no turn gets past */
      for (PetscInt k = 0; k < n; k++)
        for (PetscInt sign = -1; sign <= 1; sign += 2) {
          Plane wall = {.gap = nearest.gap + balance->largest};

          wall.uneven[k]     = sign;
          planes[n_planes++] = wall;
        }
    planes[n_planes++] = nearest;
    most               = RaiseLeastGap(n, n_planes, planes, turn);
  }
  for (PetscInt k = 0; k < n; k++)
    if (PetscAbsReal(turn[k]) > BEYOND * balance->largest) turn[k] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
