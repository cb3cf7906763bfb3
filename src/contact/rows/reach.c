/* How far apart surfaces may be that touch in the next controller step. Relative motion counts, in any frame: velocities are told by their
   mean over the contact nodes of a body, and by the most by which that of a node differs from this mean. */
#include <contact/parts.h>

/* Surfaces are looked for within this many times the way that bodies can make relative to each other in the step at their speeds */
#define AHEAD 2
/* Rows are taken to close in the step if they do at this many times the mean speed of the bodies along them */
#define CLOSES 1.5

static PetscReal Norm(const PetscReal v[3])
{
  return PetscSqrtReal(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Adds vectors of a surface's nodes on this rank, and their number, to `sum`; NULL: the most by which one of them differs from `mean` */
PetscErrorCode ContactLookAtNodes(const SurfaceData *data, Vec vec, PetscReal sum[4], const PetscReal mean[3], PetscReal *most)
{
  const PetscInt     dim = data->dim;
  const PetscScalar *values;
  PetscInt           first;
  PetscReal          largest = 0; /* square */

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(vec, &first, NULL));
  PetscCall(VecGetArrayRead(vec, &values));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    const PetscScalar *value  = values + data->dofs[i] - first;
    PetscReal          square = 0;

    for (PetscInt d = 0; d < dim && sum; d++) sum[d] += PetscRealPart(value[d]);
    for (PetscInt d = 0; d < dim && !sum; d++) square += PetscSqr(PetscRealPart(value[d]) - mean[d]);
    largest = PetscMax(largest, square);
  }
  if (sum) sum[3] += data->n_owned;
  else *most = PetscMax(*most, PetscSqrtReal(largest));
  PetscCall(VecRestoreArrayRead(vec, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of the two largest speeds of all bodies relative to the frame in which obstacles rest, or else to the mean velocity of all
   contact nodes: no two bodies come nearer faster. `gains`: with what accelerations add in the step: bodies at rest have no speed yet. */
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
  const PetscReal none[3] = {0, 0, 0};

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(mean, 4 * n));
  PetscCall(PetscArrayzero(spread, 2 * n)); /* accelerations follow */
  for (PetscInt pass = 0; pass < 2; pass++) {
    for (PetscInt s = 0; s < contact->n_surfaces; s++) {
      const PetscInt     b = contact->surfaces[s].body;
      const SurfaceData *data;
      Vec                velocity, acceleration;

      PetscCall(SurfaceGetData(contact->surfaces[s].surface, &data));
      PetscCall(BodyGetSolution(contact->bodies[b], NULL, &velocity, &acceleration));
      /* one body alone moves in the frame of its obstacles */
      if (!pass && n > 1) PetscCall(ContactLookAtNodes(data, velocity, mean + 4 * b, NULL, NULL));
      if (pass) PetscCall(ContactLookAtNodes(data, velocity, NULL, mean + 4 * b, &spread[b]));
      if (pass && gains) PetscCall(ContactLookAtNodes(data, acceleration, NULL, none, &contact->reach.acceleration[b]));
    }
    if (!pass) PetscCall(ContactReduce(contact, 4 * n, MPIU_REAL, MPIU_SUM, mean));
    for (PetscInt i = 0; i < 4 * n && !pass; i++)
      if (i % 4 < 3) mean[i] /= PetscMax(mean[i - i % 4 + 3], 1);
  }
  PetscCall(ContactReduce(contact, 2 * n, MPIU_REAL, MPIU_MAX, spread));
  *reach = AHEAD * contact->step * TwoFastest(contact, gains);
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
