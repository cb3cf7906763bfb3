/*
   How far apart surfaces may be that touch in the next controller step. What counts is the motion of one body relative to the other, not
   that of the frame in which both are described: velocities are told by their mean over the nodes at the boundary of a body, and by the
   most by which that of a node there differs from this mean.
*/
#include <contact/parts.h>

/* Surfaces are looked for within this many times the way that bodies can make relative to each other in the step at their speeds */
#define AHEAD 2
/* Rows are taken to close in the step if they do at this many times the mean speed of the bodies along them */
#define CLOSES 1.5

static PetscReal Norm(const PetscReal v[3])
{
  return PetscSqrtReal(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The places of the boundary nodes of this rank in vectors of a body, whose owned part they count from */
static PetscErrorCode GetNodes(Contact contact, PetscInt body, Vec vec, PetscInt *n, const PetscInt *dofs[], PetscInt *start)
{
  Surface            boundary;
  const SurfaceData *data;

  PetscFunctionBegin;
  PetscCall(ContactGetBoundary(contact, body, &boundary));
  PetscCall(SurfaceGetData(boundary, &data));
  PetscCall(VecGetOwnershipRange(vec, start, NULL));
  *n    = data->n_owned;
  *dofs = data->dofs;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds up the vectors of the boundary nodes of this rank, and their number */
static PetscErrorCode SumNodes(Contact contact, PetscInt body, Vec vec, PetscReal sum[4])
{
  const PetscInt    *dofs;
  const PetscScalar *values;
  PetscReal          of[3] = {0};
  PetscInt           n, start;

  PetscFunctionBegin;
  PetscCall(GetNodes(contact, body, vec, &n, &dofs, &start));
  PetscCall(VecGetArrayRead(vec, &values));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt d = 0; d < contact->dim; d++) of[d] += PetscRealPart(values[dofs[i] - start + d]);
  PetscCall(VecRestoreArrayRead(vec, &values));
  PetscCall(PetscArraycpy(sum, of, 3));
  sum[3] = (PetscReal)n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The square of the most by which the vector of a node differs from `mean`. Loops over `dim`, known where this is called, are unrolled. */
static inline PetscReal LargestSquare(PetscInt dim, PetscInt n, const PetscInt dofs[], const PetscScalar values[], const PetscReal mean[])
{
  const PetscReal m[3] = {mean[0], mean[1], mean[2]};
  PetscReal       most = 0;

  for (PetscInt i = 0; i < n; i++) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < dim; d++) square += PetscSqr(PetscRealPart(values[dofs[i] + d]) - m[d]);
    most = PetscMax(most, square);
  }
  return most;
}

/* The most by which the vector of any boundary node of this rank differs from `mean` */
static PetscErrorCode FindSpread(Contact contact, PetscInt body, Vec vec, const PetscReal mean[], PetscReal *spread)
{
  const PetscInt    *dofs;
  const PetscScalar *values;
  PetscInt           n, start;

  PetscFunctionBegin;
  PetscCall(GetNodes(contact, body, vec, &n, &dofs, &start));
  PetscCall(VecGetArrayRead(vec, &values));
  *spread = PetscSqrtReal(contact->dim > 2 ? LargestSquare(3, n, dofs, values - start, mean)
                                           : LargestSquare(2, n, dofs, values - start, mean));
  PetscCall(VecRestoreArrayRead(vec, &values));
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
    PetscCall(SumNodes(contact, b, velocity, mean + 4 * b));
  }
  if (contact->ranks.size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, mean, (PetscMPIInt)(4 * n), MPIU_REAL, MPIU_SUM, comm));
  for (PetscInt b = 0; b < n; b++) {
    Vec velocity, acceleration;

    for (PetscInt d = 0; d < 3; d++) mean[4 * b + d] /= PetscMax(mean[4 * b + 3], 1);
    PetscCall(BodyGetSolution(contact->bodies[b], NULL, &velocity, &acceleration));
    PetscCall(FindSpread(contact, b, velocity, mean + 4 * b, &spread[b]));
    if (gains) PetscCall(FindSpread(contact, b, acceleration, none, &contact->reach.acceleration[b]));
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
