#include "search.h"

/* Weights of the nodes of a simplex face (a point, segment or triangle) at the point of it that is closest to x: minimises
   |x - sum_k w_k p_k| over weights that sum to one and are not negative. The distance is returned. */
static PetscReal ProjectOnFace(const SurfaceData *data, PetscInt face, const PetscReal x[], PetscReal weights[])
{
  const PetscInt dim = data->dim, n = data->face_nodes, *nodes = data->faces + face * n;
  PetscReal      distance = 0;

  for (PetscInt k = 0; k < n; k++) weights[k] = k == 0;
  /* exact minimisation along one edge after the other, which ends in the minimum since the problem is convex; a segment
     needs one pass, a point none */
  for (PetscInt pass = 0; pass < (n > 2 ? 100 : n - 1); pass++) {
    PetscReal moved = 0;

    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = a + 1; b < n; b++) {
        PetscReal along = 0, square = 0, step;

        for (PetscInt d = 0; d < dim; d++) {
          const PetscReal edge = data->positions[nodes[b] * dim + d] - data->positions[nodes[a] * dim + d];
          PetscReal       rest = x[d];

          for (PetscInt k = 0; k < n; k++) rest -= weights[k] * data->positions[nodes[k] * dim + d];
          along += rest * edge;
          square += edge * edge;
        }
        step = PetscMin(PetscMax(along / square, -weights[b]), weights[a]);
        weights[a] -= step;
        weights[b] += step;
        moved = PetscMax(moved, PetscAbsReal(step));
      }
    if (moved < 1e-15) break;
  }
  for (PetscInt d = 0; d < dim; d++) {
    PetscReal rest = x[d];

    for (PetscInt k = 0; k < n; k++) rest -= weights[k] * data->positions[nodes[k] * dim + d];
    distance += rest * rest;
  }
  return PetscSqrtReal(distance);
}

/* The face whose outward normal is against that of the point and which is closest to it, with its nodes' weights; -1 where
   there is none. All faces are tried: contact in one dimension has a handful. */
PetscErrorCode SearchClosestFace(const SurfaceData *data, const PetscReal x[], const PetscReal normal[], PetscInt *closest, PetscReal weights[])
{
  PetscReal smallest = PETSC_MAX_REAL, trial[4];

  PetscFunctionBegin;
  *closest = -1;
  for (PetscInt f = 0; f < data->n_faces; f++) {
    PetscReal against = 0, distance;

    for (PetscInt d = 0; d < data->dim; d++) against -= normal[d] * data->face_normals[f * data->dim + d];
    if (against <= 1e-6) continue;
    distance = ProjectOnFace(data, f, x, trial);
    if (distance >= smallest) continue;
    smallest = distance;
    *closest = f;
    PetscCall(PetscArraycpy(weights, trial, data->face_nodes));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
