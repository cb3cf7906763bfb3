/* Meshes of the first rank, of which a surface may touch another body, divided among ranks by the coordinates of their cells.

   A step is over once the rank with most cells has done with them and, after that, the rank with most contact faces with those. A graph
   with one weight for both gives ranks with contact faces fewer cells, and each waits for the other. Here each rank has as many cells as
   another: those of one rank are halved, again and again, across their longest extent (recursive coordinate bisection, as in S. Plimpton,
   S. Attaway, B. Hendrickson, J. Swegle, C. Vaughan, D. Gardner, "Transient dynamics simulations: parallel algorithms for contact detection
   and smoothed particle hydrodynamics", 1998). The extent along the contact normal counts less and less, so that more ranks have a part of
   the surface, and the cheapest division is taken. If that is the first, PETSc divides the mesh as a graph, which makes smoother parts. */
#include "meshimpl.h"
#include <sys/names.h>

/* Work for a face that two ranks share, in units of the work for an element, as in bricks.c */
#define COST_OF_SHARED 0.2
/* The extent along the normal counts with 1, 1/2, 1/4, ... and at last with nothing: so many divisions are compared */
#define DIVISIONS 8
/* A surface has a normal if this part of its area, times squares of cosines, looks along one axis */
#define ONE_AXIS 0.6

typedef struct {
  DM          dm;
  const char *prefix;
  PetscInt    n_names;
  char      **names;
  PetscReal   cost;  /* work for a face in contact, in units of that for an element */
  PetscBool   sides; /* names may be those of sides of the bounding box */
  PetscMPIInt size;
  /* of each cell */
  PetscInt   n, dim;
  PetscReal *centres;
  PetscInt  *faces; /* in contact */
  PetscInt  *part, *best;
  PetscReal  along[3];
  PetscBool  found; /* a division that is better than one without regard to contact */
} Bisection;

/* The axis along which points reach farthest, with the weights of the axes */
static PetscInt FindLongest(PetscInt dim, const PetscReal weights[], const PetscReal points[], PetscInt n, const PetscInt list[])
{
  PetscReal most = -1;
  PetscInt  axis = 0;

  for (PetscInt d = 0; d < dim; d++) {
    PetscReal lower = PETSC_MAX_REAL, upper = -PETSC_MAX_REAL;

    for (PetscInt i = 0; i < n; i++) {
      lower = PetscMin(lower, points[dim * list[i] + d]);
      upper = PetscMax(upper, points[dim * list[i] + d]);
    }
    if (upper <= lower || weights[d] * (upper - lower) <= most) continue;
    most = weights[d] * (upper - lower);
    axis = d;
  }
  return axis;
}

/* Gives points to the ranks from `first` on, as much work to each: halves them, again and again, across their longest extent. `weights`: of
   the extents along the axes; `points`: dim numbers each; `work`: of each, NULL: alike; `list`: n, changed; `ranks`: of the listed */
PetscErrorCode MeshBisect(PetscInt dim, const PetscReal weights[], const PetscReal points[], const PetscReal work[], PetscInt n,
                          PetscInt list[], PetscMPIInt first, PetscMPIInt size, PetscInt ranks[])
{
  PetscReal *along;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &along));
  while (size > 1) {
    const PetscMPIInt below = size / 2;
    const PetscInt    axis  = FindLongest(dim, weights, points, n, list);
    PetscReal         all = 0, sum = 0;
    PetscInt          k = 0;

    for (PetscInt i = 0; i < n; i++) {
      along[i] = points[dim * list[i] + axis];
      all += work ? work[list[i]] : 1;
    }
    PetscCall(PetscSortRealWithArrayInt(n, along, list));
    for (PetscInt i = 0, next; i < n; i = next) { /* those at one place in the order of their numbers */
      for (next = i + 1; next < n && along[next] == along[i];) next++;
      PetscCall(PetscSortInt(next - i, list + i));
    }
    for (; k < n; k++) {
      const PetscReal one = work ? work[list[k]] : 1;

      if (sum + 0.5 * one >= all * below / size) break;
      sum += one;
    }
    PetscCall(MeshBisect(dim, weights, points, work, k, list, first, below, ranks)); /* as deep as the logarithm of the number of ranks */
    list += k;
    n -= k;
    first += below;
    size -= below;
  }
  for (PetscInt i = 0; i < n; i++) ranks[list[i]] = first;
  PetscCall(PetscFree(along));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a step costs with the parts as they are, in units of the work for an element */
static PetscErrorCode FindCost(const Bisection *b, PetscReal *cost)
{
  PetscInt *counts, start, end, cstart, most[3] = {0, 0, 0};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * b->size, &counts));
  for (PetscInt c = 0; c < b->n; c++) {
    counts[3 * b->part[c]]++;
    counts[3 * b->part[c] + 1] += b->faces[c];
  }
  PetscCall(DMPlexGetHeightStratum(b->dm, 0, &cstart, NULL));
  PetscCall(DMPlexGetHeightStratum(b->dm, 1, &start, &end));
  for (PetscInt f = start; f < end; f++) {
    const PetscInt *support;
    PetscInt        n;

    PetscCall(DMPlexGetSupportSize(b->dm, f, &n));
    PetscCall(DMPlexGetSupport(b->dm, f, &support));
    if (n != 2 || b->part[support[0] - cstart] == b->part[support[1] - cstart]) continue;
    for (PetscInt k = 0; k < 2; k++) counts[3 * b->part[support[k] - cstart] + 2]++;
  }
  for (PetscMPIInt rank = 0; rank < b->size; rank++)
    for (PetscInt k = 0; k < 3; k++) most[k] = PetscMax(most[k], counts[3 * rank + k]);
  PetscCall(PetscFree(counts));
  *cost = (PetscReal)most[0] + b->cost * (PetscReal)most[1] + COST_OF_SHARED * (PetscReal)most[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the contact faces of each cell, and finds the axis along which their normals look; -1 if there is none */
static PetscErrorCode CountFaces(Bisection *b, PetscInt *axis)
{
  PetscReal area = 0, looks[3] = {0, 0, 0};
  PetscInt  cstart;

  PetscFunctionBegin;
  *axis = -1;
  PetscCall(DMPlexGetHeightStratum(b->dm, 0, &cstart, NULL));
  for (PetscInt i = 0; i < b->n_names; i++) {
    PetscInt n, *faces;

    PetscCall(MeshFindSurface(b->dm, b->names[i], b->sides, &n, &faces));
    for (PetscInt f = 0; f < n; f++) {
      const PetscInt *support;
      PetscReal       size, centre[3], normal[3] = {0, 0, 0};

      PetscCall(DMPlexGetSupport(b->dm, faces[f], &support));
      PetscCall(DMPlexComputeCellGeometryFVM(b->dm, faces[f], &size, centre, normal));
      b->faces[support[0] - cstart]++;
      area += size;
      for (PetscInt d = 0; d < b->dim; d++) looks[d] += size * PetscSqr(normal[d]);
    }
    PetscCall(PetscFree(faces));
  }
  for (PetscInt d = 0; d < b->dim; d++)
    if (area > 0 && looks[d] > ONE_AXIS * area) *axis = d;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares divisions, on the first rank */
static PetscErrorCode Compare(void *ctx)
{
  Bisection *b = (Bisection *)ctx;
  PetscInt   axis, start, end, *cells;
  PetscReal  least = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(DMGetCoordinateDim(b->dm, &b->dim));
  PetscCall(DMPlexGetHeightStratum(b->dm, 0, &start, &end));
  b->n = end - start;
  PetscCall(PetscCalloc1(b->n, &b->faces));
  PetscCall(CountFaces(b, &axis));
  if (axis < 0 || b->n < b->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(b->dim * b->n, &b->centres, b->n, &b->part, b->n, &b->best));
  PetscCall(PetscMalloc1(b->n, &cells));
  for (PetscInt c = 0; c < b->n; c++) {
    PetscReal volume, centre[3];

    PetscCall(DMPlexComputeCellGeometryFVM(b->dm, start + c, &volume, centre, NULL));
    for (PetscInt d = 0; d < b->dim; d++) b->centres[b->dim * c + d] = centre[d];
  }
  for (PetscInt d = 0; d < 3; d++) b->along[d] = 1;
  for (PetscInt i = 0; i < DIVISIONS; i++) {
    PetscReal cost = 0;

    for (PetscInt c = 0; c < b->n; c++) cells[c] = c;
    PetscCall(MeshBisect(b->dim, b->along, b->centres, NULL, b->n, cells, 0, b->size, b->part));
    PetscCall(FindCost(b, &cost));
    if (cost < least) {
      least    = cost;
      b->found = (PetscBool)(i > 0);
      PetscCall(PetscArraycpy(b->best, b->part, b->n));
    }
    b->along[axis] = i < DIVISIONS - 2 ? b->along[axis] / 2 : 0;
  }
  PetscCall(PetscFree(cells));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prepares the division of a mesh that is on the first rank such that contact faces lie on all ranks that have a part, if that makes a step
   cheaper and no option asks for another division; spread: it does */
PetscErrorCode MeshSpreadContact(DM dm, const MeshRanks *ranks, const char prefix[], const char name[], PetscBool placed, PetscBool *spread)
{
  static const char *const options[] = {"-petscpartitioner_type", "-dm_distribute"};
  MPI_Comm                 comm      = PetscObjectComm((PetscObject)dm);
  Bisection                b         = {.dm = dm, .prefix = prefix, .size = ranks->n};
  PetscBool                has       = PETSC_FALSE, rotated;
  PetscErrorCode           error     = PETSC_SUCCESS;
  char                     where[256];
  int                      found = 0;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options) && !has; i++) PetscCall(PetscOptionsHasName(NULL, prefix, options[i], &has));
  if (!has) PetscCall(PetscOptionsHasName(NULL, NULL, options[0], &has));
  PetscCall(PetscOptionsHasName(NULL, prefix, "-rotate", &rotated));
  b.sides = (PetscBool)(placed || !rotated);
  PetscCall(MeshReadContact(comm, prefix, name, &b.n_names, &b.names, &b.cost));
  if (!has && b.size > 1 && b.n_names && b.cost > 0) {
    PetscCall(PetscSNPrintf(where, sizeof(where), "Body '%s', division of its mesh", name));
    error = MeshOnRank(comm, 0, Compare, &b, where);
    found = b.found;
    if (!error) PetscCallMPI(MPI_Bcast(&found, 1, MPI_INT, 0, comm));
    if (!error && found) error = MeshSetParts(dm, ranks, b.n, b.best);
  }
  *spread = (PetscBool)(!error && found);
  PetscCall(NamesDestroy(b.n_names, &b.names));
  PetscCall(PetscFree(b.faces));
  PetscCall(PetscFree3(b.centres, b.part, b.best));
  PetscCall(error);
  PetscFunctionReturn(PETSC_SUCCESS);
}
