/* The problem of one controller step with friction: its arrays, and how well forces fulfil the law in it. */
#include "friction.h"

/* Gives the problem n rows. Room grows by doubling, up to `most` rows, so that a step with more rows than any before seldom allocates. */
PetscErrorCode FrictionProblemResize(FrictionProblem *problem, PetscInt n, PetscInt most)
{
  const PetscInt room = PetscMax(n, PetscMin(2 * problem->room, most));

  PetscFunctionBegin;
  if (n > problem->room) {
    PetscCall(FrictionProblemDestroy(problem));
    PetscCall(PetscMalloc6(room * room, &problem->S, room, &problem->opened, room, &problem->base, room, &problem->limit, room,
                           &problem->force, room, &problem->state));
    PetscCall(PetscMalloc3(room, &problem->change, room, &problem->told, room, &problem->answer));
    problem->room = room;
  }
  problem->n = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrictionProblemDestroy(FrictionProblem *problem)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(problem->change, problem->told, problem->answer));
  PetscCall(PetscFree6(problem->S, problem->opened, problem->base, problem->limit, problem->force, problem->state));
  problem->n = problem->room = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much nodes miss the law [m]: de Saxce's residual. With the slip s of a node, v = (g + r|s|, s) and the compliance c of its normal
   row that is c |f - P(f - v/c)|, P being the projection onto the forces that the law admits. */
PetscReal FrictionProblemGetResidual(const FrictionProblem *problem)
{
  const PetscInt dim  = problem->dim;
  PetscReal      most = 0;

  for (PetscInt first = 0; first < problem->n; first += dim) {
    const PetscReal c = PetscRealPart(problem->S[first * (problem->n + 1)]), cohesion = PetscRealPart(problem->limit[first]);
    const PetscReal mu   = PetscRealPart(problem->limit[first + 1]);
    PetscReal       slip = 0, f[3] = {0}, t[3] = {0}, size = 0, normal, bound, square = 0;

    if (!(c > 0) || cohesion != 0) continue;
    for (PetscInt k = 1; k < dim; k++) slip += PetscSqr(PetscRealPart(problem->opened[first + k]));
    slip = PetscSqrtReal(slip);
    for (PetscInt k = 0; k < dim; k++) {
      f[k] = PetscRealPart(problem->force[first + k]);
      t[k] = f[k] - (PetscRealPart(problem->opened[first + k]) + (k ? 0 : mu * slip)) / c;
      if (k) size += PetscSqr(t[k]);
    }
    size   = PetscSqrtReal(size);
    normal = t[0];
    bound  = size;
    if (size > mu * t[0]) { /* outside the cone: onto its side, or its tip */
      normal = PetscMax((t[0] + mu * size) / (1 + mu * mu), 0);
      bound  = mu * normal;
    }
    square = PetscSqr(f[0] - normal);
    for (PetscInt k = 1; k < dim; k++) square += PetscSqr(f[k] - (size > 0 ? bound / size * t[k] : 0));
    most = PetscMax(most, c * PetscSqrtReal(square));
  }
  return most;
}

/* Whether a node in contact could be in another state under the same loads. One that slides answers to its normal force by a gap of
   S_NN - mu S_NT.e, e being the way of its force: with mu |S_NT| >= S_NN more force may open it less, or nothing (Klarbring 1990). */
PetscBool FrictionProblemIsAmbiguous(const FrictionProblem *problem)
{
  for (PetscInt first = 0; first < problem->n; first += problem->dim) {
    const PetscScalar *column   = &problem->S[first * problem->n + first];
    PetscReal          coupling = 0;

    if (problem->state[first / problem->dim] == FRICTION_OPEN) continue;
    for (PetscInt k = 1; k < problem->dim; k++) coupling += PetscSqr(PetscRealPart(column[k]));
    if (PetscRealPart(problem->limit[first + 1]) * PetscSqrtReal(coupling) >= PetscRealPart(column[0])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Keeps the forces as they were where the law holds for them: with nothing that changes any more all nodes are at the brink of another
   state, and their states go round. The law may be missed by `atol` [m]. */
PetscErrorCode FrictionProblemKeepForces(FrictionProblem *problem, PetscReal atol, PetscBool *kept)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(problem->force, problem->base, problem->n));
  *kept = (PetscBool)(FrictionProblemGetResidual(problem) <= atol);
  for (PetscInt first = 0; first < problem->n && *kept; first += problem->dim) {
    const PetscReal bound  = PetscRealPart(problem->limit[first] + problem->limit[first + 1] * problem->force[first]);
    PetscReal       square = 0;

    for (PetscInt k = 1; k < problem->dim; k++) square += PetscSqr(PetscRealPart(problem->force[first + k]));
    problem->state[first / problem->dim] = PetscRealPart(problem->force[first]) <= 0 ? FRICTION_OPEN
                                           : square < PetscSqr(bound)                ? FRICTION_STICKS
                                                                                     : FRICTION_SLIDES;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
