/*
   How far apart surfaces may be that touch in the next controller step. What counts is the motion of one body relative to the other, not
   that of the frame in which both are described: velocities are told by their mean over the nodes of a body, and by the most by which that
   of a node differs from this mean.
*/
#include <contact/parts.h>
#include <impakt/private/simd.h>

/* Surfaces are looked for within this many times the way that bodies can make relative to each other in the step at their speeds */
#define AHEAD 2
/* Rows are taken to close in the step if they do at this many times the mean speed of the bodies along them */
#define CLOSES 1.5

static PetscReal Norm(const PetscReal v[3])
{
  return PetscSqrtReal(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Adds up the vectors of nodes, in as many sums at once as an instruction can */
SIMD_CLONES static void AddNodes(PetscInt n, PetscInt dim, const PetscScalar values[], PetscReal sum[3])
{
  const PetscInt width = dim * SIMD_WIDTH;
  PetscReal      sums[3 * SIMD_WIDTH];
  PetscInt       i;

  for (PetscInt k = 0; k < width; k++) sums[k] = 0;
  for (i = 0; i + width <= n; i += width)
    for (PetscInt k = 0; k < width; k++) sums[k] += PetscRealPart(values[i + k]);
  for (PetscInt k = 0; i < n; i++, k++) sums[k] += PetscRealPart(values[i]);
  for (PetscInt k = 0; k < width; k++) sum[k % dim] += sums[k];
}

/* The square of the most by which the vector of a node in space differs from `mean` */
SIMD_CLONES static PetscReal LargestSquare(PetscInt n, const PetscScalar values[], const PetscReal mean[3])
{
  PetscReal means[3 * SIMD_WIDTH], squares[3 * SIMD_WIDTH];
  SimdReal  most = {0};
  PetscInt  i;

  for (PetscInt k = 0; k < 3 * SIMD_WIDTH; k++) means[k] = mean[k % 3];
  for (i = 0; i + 3 * SIMD_WIDTH <= n; i += 3 * SIMD_WIDTH) {
    for (PetscInt k = 0; k < 3 * SIMD_WIDTH; k++) squares[k] = PetscSqr(PetscRealPart(values[i + k]) - means[k]);
    for (PetscInt k = 0; k < SIMD_WIDTH; k++) {
      const PetscReal square = squares[3 * k] + squares[3 * k + 1] + squares[3 * k + 2];

      most[k] = square > most[k] ? square : most[k];
    }
  }
  for (; i < n; i += 3) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < 3; d++) square += PetscSqr(PetscRealPart(values[i + d]) - mean[d]);
    most[0] = square > most[0] ? square : most[0];
  }
  for (PetscInt k = 1; k < SIMD_WIDTH; k++) most[0] = most[k] > most[0] ? most[k] : most[0];
  return most[0];
}

/* Adds up the vectors of the nodes of this rank, and their number */
static PetscErrorCode SumNodes(Vec vec, PetscInt dim, PetscReal sum[4])
{
  const PetscScalar *values;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(vec, &n));
  PetscCall(VecGetArrayRead(vec, &values));
  AddNodes(n, dim, values, sum);
  sum[3] = (PetscReal)n / (PetscReal)dim;
  PetscCall(VecRestoreArrayRead(vec, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The most by which the vector of any node of this rank differs from `mean` */
static PetscErrorCode FindSpread(Vec vec, PetscInt dim, const PetscReal mean[], PetscReal *spread)
{
  const PetscScalar *values;
  PetscReal          most = 0;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(vec, &n));
  PetscCall(VecGetArrayRead(vec, &values));
  if (dim == 3) most = LargestSquare(n, values, mean);
  for (PetscInt i = 0; i < n && dim < 3; i += dim) {
    PetscReal square = PetscSqr(PetscRealPart(values[i]) - mean[0]);

    if (dim > 1) square += PetscSqr(PetscRealPart(values[i + 1]) - mean[1]);
    most = square > most ? square : most;
  }
  PetscCall(VecRestoreArrayRead(vec, &values));
  *spread = PetscSqrtReal(most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of the two largest speeds of all bodies relative to the frame in which obstacles rest, or else to the mean velocity of all nodes:
   no two bodies come nearer faster. `gains`: with what accelerations add in the step: bodies at rest have no speed yet. */
static PetscReal TwoFastest(Contact contact, PetscBool gains)
{
  const ContactReach *reach   = &contact->reach;
  PetscReal           mean[3] = {0}, n = 0, first = 0, second = 0;

  for (PetscInt b = 0; b < contact->n_bodies && !contact->n_obstacles; b++) {
    for (PetscInt d = 0; d < 3; d++) mean[d] += reach->mean[4 * b + 3] * reach->mean[4 * b + d];
    n += reach->mean[4 * b + 3];
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscReal apart[3], speed;

    for (PetscInt d = 0; d < 3; d++) apart[d] = reach->mean[4 * b + d] - (n > 0 ? mean[d] / n : 0);
    speed  = Norm(apart) + reach->spread[b] + (gains ? 0.5 * reach->acceleration[b] * contact->step : 0);
    second = PetscMax(second, PetscMin(first, speed));
    first  = PetscMax(first, speed);
  }
  return first + second;
}

/* Measures the motion of the bodies. `reach`: bodies that far apart may touch in the step, as far as the speeds of all bodies tell [m] */
PetscErrorCode ContactMeasureReach(Contact contact, PetscReal *reach)
{
  const PetscBool gains = contact->neighbours.come_and_go;
  const PetscInt  n     = contact->n_bodies;
  PetscReal      *mean = contact->reach.mean, *spread = contact->reach.spread;
  const MPI_Comm  comm    = PetscObjectComm((PetscObject)contact);
  const PetscReal none[3] = {0, 0, 0};

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(mean, 4 * n));
  for (PetscInt b = 0; b < n && n > 1; b++) { /* one body alone moves in the frame of its obstacles */
    Vec velocity;

    PetscCall(BodyGetSolution(contact->bodies[b], NULL, &velocity, NULL));
    PetscCall(SumNodes(velocity, contact->dim, mean + 4 * b));
  }
  if (contact->ranks.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, mean, (PetscMPIInt)(4 * n), MPIU_REAL, MPIU_SUM, comm));
  for (PetscInt b = 0; b < n; b++) {
    Vec velocity, acceleration;

    for (PetscInt d = 0; d < 3; d++) mean[4 * b + d] /= PetscMax(mean[4 * b + 3], 1);
    PetscCall(BodyGetSolution(contact->bodies[b], NULL, &velocity, &acceleration));
    PetscCall(FindSpread(velocity, contact->dim, mean + 4 * b, &spread[b]));
    if (gains) PetscCall(FindSpread(acceleration, contact->dim, none, &contact->reach.acceleration[b]));
  }
  if (contact->ranks.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, spread, (PetscMPIInt)(2 * n), MPIU_REAL, MPIU_MAX, comm));
  *reach = contact->reach.all = AHEAD * contact->step * TwoFastest(contact, gains);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far apart surfaces of a pair may be that touch in the step; however far from an obstacle [m] */
PetscReal ContactPairReach(Contact contact, const ContactPair *pair)
{
  const PetscReal *mean = contact->reach.mean, *spread = contact->reach.spread;
  PetscReal        apart[3];

  if (pair->obstacle) return PETSC_MAX_REAL;
  for (PetscInt d = 0; d < 3; d++) apart[d] = mean[4 * pair->body[0] + d] - mean[4 * pair->body[1] + d];
  return AHEAD * contact->step * (Norm(apart) + spread[pair->body[0]] + spread[pair->body[1]]);
}

/* The gap from which on a row of a pair of bodies may close in the step [m]. `normal`: of the row, away from the first body */
PetscReal ContactRowReach(Contact contact, const ContactPair *pair, const PetscReal normal[])
{
  const PetscReal *mean = contact->reach.mean, *spread = contact->reach.spread;
  PetscReal        speed = spread[pair->body[0]] + spread[pair->body[1]];

  for (PetscInt d = 0; d < contact->dim; d++) speed += normal[d] * (mean[4 * pair->body[0] + d] - mean[4 * pair->body[1] + d]);
  return CLOSES * contact->step * speed;
}
