/* How deep bodies lie inside each other, anywhere on their boundaries, on any number of ranks. Points are looked at that may be the deepest
   ones: nodes, and points of edges between two places where these cross the other boundary, so that edges which cross edges are seen too. A
   point is inside where the closest face says so; its depth is the distance from there. */
#include "probes.h"

/* Pieces of edges shorter than this part of them reach no deeper inside than that */
#define LEAST_PIECE 1e-3
/* Of each piece so many points are looked at: of a convex body they tell the depth of the deepest one to a quarter */
#define PIECE_POINTS 3

/* The boxes of all surfaces, and the pairs of those whose boxes meet, each in both orders */
static PetscErrorCode FindPairs(ProbeSearch *search)
{
  PetscReal *mine;
  PetscInt   max = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(6 * search->n, &mine));
  PetscCall(PetscMalloc2(6 * search->n * search->n_ranks, &search->boxes, 6 * search->n, &search->whole));
  for (PetscInt s = 0; s < search->n; s++) BoxFind(search->surfaces[s]->data.n_nodes, search->surfaces[s]->data.positions, mine + 6 * s);
  PetscCallMPI(
      MPI_Allgather(mine, (PetscMPIInt)(6 * search->n), MPIU_REAL, search->boxes, (PetscMPIInt)(6 * search->n), MPIU_REAL, search->comm));
  for (PetscInt k = 0; k < 6 * search->n; k++) {
    search->whole[k] = PETSC_MAX_REAL;
    for (PetscMPIInt r = 0; r < search->n_ranks; r++) search->whole[k] = PetscMin(search->whole[k], search->boxes[6 * search->n * r + k]);
  }
  for (PetscInt a = 0; a < search->n; a++)
    for (PetscInt b = a + 1; b < search->n; b++) {
      if (!BoxesMeet(search->whole + 6 * a, search->whole + 6 * b)) continue;
      if (search->n_pairs + 2 > max) {
        max = 2 * max + 16;
        PetscCall(PetscRealloc((size_t)max * sizeof(SurfaceDepth), &search->pairs));
      }
      search->pairs[search->n_pairs++] = (SurfaceDepth){.surfaces = {a, b}};
      search->pairs[search->n_pairs++] = (SurfaceDepth){.surfaces = {b, a}};
    }
  PetscCall(PetscFree(mine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds points of an edge between its places `begin` and `end` */
static PetscErrorCode AddPiece(const Probe *edge, PetscReal begin, PetscReal end, Probes *points)
{
  PetscFunctionBegin;
  if (end - begin < LEAST_PIECE) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 1; k <= PIECE_POINTS; k++) {
    const PetscReal at    = begin + k * (end - begin) / (PIECE_POINTS + 1);
    Probe           point = {.pair = edge->pair, .size = edge->size};

    for (PetscInt d = 0; d < 3; d++) point.x[0][d] = (1 - at) * edge->x[0][d] + at * edge->x[1][d];
    PetscCall(ProbesAdd(points, &point, -1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a point on the face f of a surface, in the middle of its nodes or, of those, of node k and the next one */
static PetscErrorCode AddMiddle(const SurfaceData *data, PetscInt pair, PetscInt f, PetscInt first, PetscInt n, Probes *points)
{
  Probe point = {.pair = pair, .size = FaceSize(data->face_nodes, data->face_areas[f])};

  PetscFunctionBegin;
  for (PetscInt k = first; k < first + n; k++)
    for (PetscInt d = 0; d < 3; d++) point.x[0][d] += data->positions[3 * data->faces[f * data->face_nodes + k % data->face_nodes] + d] / n;
  PetscCall(ProbesAdd(points, &point, -1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds all points of a surface that a rank looks at by itself: nodes, middles of faces in space and, if `edges`, of edges */
static PetscErrorCode AddPoints(const SurfaceData *data, PetscInt pair, PetscBool edges, Probes *points)
{
  const PetscInt n = data->face_nodes;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < data->n_owned; i++) {
    Probe point = {.pair = pair, .size = data->sizes[i]};

    PetscCall(PetscArraycpy(point.x[0], data->positions + 3 * i, 3));
    PetscCall(ProbesAdd(points, &point, -1));
  }
  for (PetscInt f = 0; f < data->n_faces; f++) {
    if (n > 2) PetscCall(AddMiddle(data, pair, f, 0, n, points));
    for (PetscInt k = 0; k < (n > 2 ? n : n - 1) && edges; k++) PetscCall(AddMiddle(data, pair, f, k, 2, points));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds edges of a pair's first surface near the second one. An edge counts in the face where its numbers ascend. */
static PetscErrorCode AddEdges(ProbeSearch *search, PetscInt pair, Probes *edges)
{
  const SurfaceData *data  = &search->surfaces[search->pairs[pair].surfaces[0]]->data;
  const PetscInt     n     = data->face_nodes;
  const PetscReal   *whole = search->whole + 6 * search->pairs[pair].surfaces[1];

  PetscFunctionBegin;
  for (PetscInt f = 0; f < data->n_faces; f++)
    for (PetscInt k = 0; k < (n > 2 ? n : n - 1); k++) {
      const PetscInt i = data->faces[f * n + k], j = data->faces[f * n + (k + 1) % n];
      Probe          edge = {.pair = pair, .size = PetscMin(data->sizes[i], data->sizes[j])};
      PetscReal      box[6];

      if (n > 2 && data->dofs[i] > data->dofs[j]) continue;
      PetscCall(PetscArraycpy(edge.x[0], data->positions + 3 * i, 3));
      PetscCall(PetscArraycpy(edge.x[1], data->positions + 3 * j, 3));
      BoxFind(2, edge.x[0], box);
      if (BoxesMeet(box, whole)) PetscCall(ProbesAdd(edges, &edge, -1));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindPoints(ProbeSearch *search, Probes *points)
{
  Probes   edges = {0};
  PetscInt n;
  Probe   *crossings;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < search->n_pairs; p++) PetscCall(AddEdges(search, p, &edges));
  PetscCall(ProbesFindCrossings(search, &edges, &n, &crossings));
  for (PetscInt i = 0; i < n; i++) {
    const PetscBool first = (PetscBool)(!i || crossings[i - 1].source != crossings[i].source);
    const PetscBool last  = (PetscBool)(i + 1 == n || crossings[i + 1].source != crossings[i].source);

    PetscCall(AddPiece(&crossings[i], first ? 0 : crossings[i - 1].at, crossings[i].at, points));
    if (last) PetscCall(AddPiece(&crossings[i], crossings[i].at, 1, points));
  }
  PetscCall(PetscFree(crossings));
  PetscCall(ProbesDestroy(&edges));
  for (PetscInt p = 0; p < search->n_pairs; p++) {
    const PetscReal *whole = search->whole + 6 * search->pairs[p].surfaces[1];
    const PetscInt   first = points->n;
    PetscInt         kept  = first;

    PetscCall(AddPoints(&search->surfaces[search->pairs[p].surfaces[0]]->data, p, PETSC_FALSE, points));
    for (PetscInt i = first; i < points->n; i++) {
      const PetscReal *x = points->list[i].x[0], box[6] = {x[0], x[1], x[2], -x[0], -x[1], -x[2]};

      if (BoxesMeet(box, whole)) points->list[kept++] = points->list[i];
    }
    points->n = kept;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep points are inside obstacles. The pairs are those of each surface with each obstacle. */
static PetscErrorCode MeasureObstacles(ProbeSearch *search, PetscInt n_obstacles, const Obstacle obstacles[], Probes *points)
{
  PetscFunctionBegin;
  if (!n_obstacles) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscRealloc((size_t)(search->n_pairs + search->n * n_obstacles) * sizeof(SurfaceDepth), &search->pairs));
  for (PetscInt s = 0; s < search->n; s++)
    for (PetscInt o = 0; o < n_obstacles; o++) {
      const PetscInt first = points->n;
      PetscInt       kept  = first;

      PetscCall(AddPoints(&search->surfaces[s]->data, search->n_pairs, PETSC_TRUE, points));
      for (PetscInt i = first; i < points->n; i++) {
        PetscReal gap, gradient[3];

        PetscCall(ObstacleGetGap(obstacles[o], points->list[i].x[0], &gap, gradient));
        if (gap >= 0) continue;
        points->list[kept]           = points->list[i];
        points->list[kept++].closest = (Closest){.square = PetscSqr(gap), .height = gap, .size = PETSC_MAX_REAL};
      }
      points->n                        = kept;
      search->pairs[search->n_pairs++] = (SurfaceDepth){.surfaces = {s, search->n + o}};
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The deepest point of each pair, in parts of the edge of the faces there, on all ranks */
static PetscErrorCode Reduce(ProbeSearch *search, const Probes *points)
{
  struct {
    double value;
    int    rank;
  } *parts;
  PetscReal(*values)[5];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(search->n_pairs, &parts));
  PetscCall(PetscCalloc1(search->n_pairs, &values));
  for (PetscInt p = 0; p < search->n_pairs; p++) {
    parts[p].value = 0;
    parts[p].rank  = search->rank;
  }
  for (PetscInt i = 0; i < points->n; i++) {
    const Probe    *point = &points->list[i];
    const PetscReal depth = point->closest.height < 0 ? PetscSqrtReal(point->closest.square) : 0,
                    size  = PetscMin(point->size, point->closest.size);

    if (depth <= parts[point->pair].value * size) continue;
    parts[point->pair].value = depth / size;
    values[point->pair][0]   = depth;
    values[point->pair][1]   = size;
    PetscCall(PetscArraycpy(values[point->pair] + 2, point->x[0], 3));
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, parts, search->n_pairs, MPI_DOUBLE_INT, MPI_MAXLOC, search->comm));
  for (PetscInt p = 0; p < search->n_pairs; p++)
    if (parts[p].rank != search->rank) PetscCall(PetscArrayzero(values[p], 5));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, values, 5 * search->n_pairs, MPIU_REAL, MPIU_SUM, search->comm));
  for (PetscInt p = 0; p < search->n_pairs; p++) {
    search->pairs[p].depth = values[p][0];
    search->pairs[p].size  = values[p][1];
    PetscCall(PetscArraycpy(search->pairs[p].x, values[p] + 2, 3));
  }
  PetscCall(PetscFree(parts));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MeasurePairs(ProbeSearch *search, Probes *points)
{
  PetscFunctionBegin;
  PetscCall(FindPairs(search));
  if (!search->n_pairs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc2(search->n, &search->trees, search->n, &search->faces));
  PetscCall(FindPoints(search, points));
  PetscCall(ProbesFindClosest(search, points));
  for (PetscInt s = 0; s < search->n; s++) {
    PetscCall(PetscFree(search->faces[s]));
    PetscCall(TreeDestroy(&search->trees[s]));
  }
  PetscCall(PetscFree2(search->trees, search->faces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep bodies lie inside each other and in obstacles, anywhere on their boundaries: for each pair of surfaces whose boxes meet, in
   both orders, and of surfaces and obstacles the deepest point; free `depths` with PetscFree(). Collective on a communicator that has
   all of the surfaces, the whole boundaries of bodies. The deepest points of the first surface inside the body of the second are looked
   for among its nodes, the middles of its faces in space, and points of its edges between two places where these cross the second
   surface; those inside an obstacle among nodes and middles. Deepest is the point whose depth, its distance from the closest face, is
   most in parts of the faces there. Costs O(log n) for each node, edge and crossing within the boxes that two surfaces have in common. */
PetscErrorCode SurfacesFindDepths(MPI_Comm comm, PetscInt n, const Surface surfaces[], PetscInt n_obstacles, const Obstacle obstacles[],
                                  PetscInt *n_depths, SurfaceDepth *depths[])
{
  ProbeSearch search = {.comm = comm, .n = n, .surfaces = surfaces};
  Probes      points = {0};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &search.n_ranks));
  PetscCallMPI(MPI_Comm_rank(comm, &search.rank));
  PetscCall(MeasurePairs(&search, &points));
  PetscCall(MeasureObstacles(&search, n_obstacles, obstacles, &points));
  if (search.n_pairs) PetscCall(Reduce(&search, &points));
  PetscCall(PetscFree2(search.boxes, search.whole));
  PetscCall(ProbesDestroy(&points));
  *n_depths = search.n_pairs;
  *depths   = search.pairs;
  PetscFunctionReturn(PETSC_SUCCESS);
}
