/* One contact node with friction, solved exactly. */
#include "friction.h"

/* Directions among which the one of sliding is looked for in space, and halvings that make it exact */
#define DIRECTIONS 64
#define HALVINGS   60

/* Forces under which the node sticks; whether they push, within the bound */
static PetscBool Sticks(PetscInt dim, const PetscReal S[], const PetscReal open[], const PetscReal limit[], PetscReal force[])
{
  PetscReal a[9] = {0}, square = 0;

  for (PetscInt k = 0; k < dim * dim; k++) a[k] = S[k];
  for (PetscInt k = 0; k < dim; k++) force[k] = -open[k];
  for (PetscInt k = 0; k < dim; k++)
    for (PetscInt i = k + 1; i < dim; i++) {
      const PetscReal factor = a[k * dim + i] / a[k * dim + k];

      for (PetscInt j = k; j < dim; j++) a[j * dim + i] -= factor * a[j * dim + k];
      force[i] -= factor * force[k];
    }
  for (PetscInt k = dim - 1; k >= 0; k--) {
    for (PetscInt j = k + 1; j < dim; j++) force[k] -= a[j * dim + k] * force[j];
    force[k] /= a[k * dim + k];
  }
  for (PetscInt k = 1; k < dim; k++) square += PetscSqr(force[k]);
  return (PetscBool)(force[0] >= 0 && square <= PetscSqr(PetscMax(limit[0] + limit[1] * force[0], 0)));
}

/* Forces under which the node slides against the unit vector e across its normal, with the gap closed, and the slip [m] along e and, in
   space, along e turned by 90 degrees; false where that takes a pull */
static PetscBool Slides(PetscInt dim, const PetscReal S[], const PetscReal open[], const PetscReal limit[], const PetscReal e[],
                        PetscReal force[], PetscReal slip[2])
{
  PetscReal across = 0, compliance, bound;

  for (PetscInt k = 1; k < dim; k++) across += S[k * dim] * e[k];
  compliance = S[0] + limit[1] * across;
  if (compliance <= 0) return PETSC_FALSE;
  force[0] = -(open[0] + limit[0] * across) / compliance;
  bound    = limit[0] + limit[1] * force[0];
  if (force[0] < 0) return PETSC_FALSE;
  for (PetscInt k = 1; k < dim; k++) force[k] = PetscMax(bound, 0) * e[k];
  slip[0] = slip[1] = 0;
  for (PetscInt k = 1; k < dim; k++) {
    PetscReal moved = open[k];

    for (PetscInt l = 0; l < dim; l++) moved += S[l * dim + k] * force[l];
    slip[0] += moved * e[k];
    if (dim == 3) slip[1] += moved * (k == 1 ? -e[2] : e[1]);
  }
  return PETSC_TRUE;
}

/* In space: the direction of the force with no slip square to it and some against it */
static PetscBool FindDirection(const PetscReal S[], const PetscReal open[], const PetscReal limit[], PetscReal force[])
{
  PetscReal slip[2] = {0}, last = 0, last_angle = 0;
  PetscBool known = PETSC_FALSE;

  for (PetscInt d = 0; d <= DIRECTIONS; d++) {
    PetscReal       angle = 2 * PETSC_PI * d / DIRECTIONS;
    const PetscReal e[3]  = {0, PetscCosReal(angle), PetscSinReal(angle)};
    const PetscBool can   = Slides(3, S, open, limit, e, force, slip);

    if (can && known && last * slip[1] <= 0) {
      PetscReal low = last_angle, high = angle, at_low = last;

      for (PetscInt h = 0; h < HALVINGS; h++) {
        const PetscReal middle = 0.5 * (low + high), m[3] = {0, PetscCosReal(middle), PetscSinReal(middle)};

        if (!Slides(3, S, open, limit, m, force, slip)) break;
        if (at_low * slip[1] > 0) {
          low    = middle;
          at_low = slip[1];
        } else high = middle;
      }
      if (slip[0] <= 0) return PETSC_TRUE;
      (void)Slides(3, S, open, limit, e, force, slip);
    }
    known      = can;
    last       = slip[1];
    last_angle = angle;
  }
  return PETSC_FALSE;
}

/* The forces on the rows of one node, the first along its normal, of what they open by without forces (`open`) and their compliance S, by
   columns. Where a large coefficient leaves no solution, the node sticks. */
PetscErrorCode FrictionSolveNode(PetscInt dim, const PetscReal S[], const PetscReal open[], const PetscReal limit[], PetscReal force[])
{
  PetscInt  held = 0;
  PetscBool found;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < dim; k++) force[k] = 0;
  if (open[0] >= 0 || S[0] <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 1; k < dim; k++) held += S[k * dim + k] <= 0;
  if (held == dim - 1) { /* nothing moves it across the normal */
    force[0] = -open[0] / S[0];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /* one that is held in one direction, where it is dragged, slides */
  found = held ? PETSC_FALSE : Sticks(dim, S, open, limit, force);
  if (!found && dim == 3) found = FindDirection(S, open, limit, force);
  for (PetscInt sign = -1; sign <= 1 && dim == 2 && !found; sign += 2) {
    const PetscReal e[3] = {0, (PetscReal)sign, 0};
    PetscReal       slip[2];

    found = (PetscBool)(Slides(2, S, open, limit, e, force, slip) && slip[0] <= 0);
  }
  if (!found && !held) (void)Sticks(dim, S, open, limit, force);
  force[0] = PetscMax(force[0], 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}
