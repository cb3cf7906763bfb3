/* Sharp edges of surfaces: which nodes lie on one, and the normal of a partner that such a node sees. */
#include "interfaceimpl.h"

/* Adds the normals of the faces beside each point that bounds a face (edge; in 2-D vertex), and counts these: four numbers per point */
static PetscErrorCode SumNormals(Surface surface, PetscSF sf, PetscReal sums[])
{
  const SurfaceData *data = &surface->data;
  MPI_Datatype       type;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < data->n_faces; f++) {
    const PetscInt *cone;
    PetscInt        size;

    PetscCall(DMPlexGetConeSize(surface->dm, surface->points[f], &size));
    PetscCall(DMPlexGetCone(surface->dm, surface->points[f], &cone));
    for (PetscInt c = 0; c < size; c++) {
      for (PetscInt d = 0; d < 3; d++) sums[4 * cone[c] + d] += data->face_normals[3 * f + d];
      sums[4 * cone[c] + 3] += 1;
    }
  }
  if (!sf) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Type_contiguous(4, MPIU_REAL, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCall(PetscSFReduceBegin(sf, type, sums, sums, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(sf, type, sums, sums, MPIU_SUM));
  PetscCall(PetscSFBcastBegin(sf, type, sums, sums, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, type, sums, sums, MPI_REPLACE));
  PetscCallMPI(MPI_Type_free(&type));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The vertices of a boundary face, or of a cell, and their number */
PetscErrorCode SurfaceListVertices(DM dm, PetscInt point, PetscInt *n, PetscInt vertices[])
{
  PetscInt *closure = NULL, n_points, vstart, vend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  *n = 0;
  PetscCall(DMPlexGetTransitiveClosure(dm, point, PETSC_TRUE, &n_points, &closure));
  for (PetscInt p = 0; p < n_points; p++) {
    if (closure[2 * p] < vstart || closure[2 * p] >= vend) continue;
    PetscCheck(*n < 8, PETSC_COMM_SELF, PETSC_ERR_SUP, "Cells with more than eight nodes are not supported");
    vertices[(*n)++] = closure[2 * p];
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, point, PETSC_TRUE, &n_points, &closure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the vertices of some faces with 1, on all ranks that have these vertices. `marks` has an entry for each point of the mesh. */
PetscErrorCode SurfaceMarkVertices(DM dm, PetscInt n_faces, const PetscInt points[], PetscSF sf, PetscInt marks[])
{
  PetscInt start;

  PetscFunctionBegin;
  PetscCall(DMPlexGetChart(dm, &start, NULL));
  for (PetscInt f = 0; f < n_faces; f++) {
    PetscInt n, vertices[8];

    PetscCall(SurfaceListVertices(dm, points[f], &n, vertices));
    PetscCheck(n <= 4, PETSC_COMM_SELF, PETSC_ERR_SUP, "Faces with more than four nodes are not supported");
    for (PetscInt k = 0; k < n; k++) marks[vertices[k] - start] = 1;
  }
  if (sf) {
    PetscCall(PetscSFReduceBegin(sf, MPIU_INT, marks, marks, MPI_MAX));
    PetscCall(PetscSFReduceEnd(sf, MPIU_INT, marks, marks, MPI_MAX));
    PetscCall(PetscSFBcastBegin(sf, MPIU_INT, marks, marks, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, MPIU_INT, marks, marks, MPI_REPLACE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the nodes on edges between two faces whose normals differ by more than SHARP in the mesh, where the surface has to be */
PetscErrorCode SurfaceFindEdges(Surface surface, PetscSF sf)
{
  const SurfaceData *data = &surface->data;
  PetscInt           start, end, chart, n_edges = 0, *edges, *marks;
  PetscReal         *sums;

  PetscFunctionBegin;
  if (data->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMPlexGetDepthStratum(surface->dm, data->dim - 2, &start, &end));
  PetscCall(DMPlexGetChart(surface->dm, NULL, &chart));
  PetscCall(PetscCalloc1(4 * chart, &sums));
  PetscCall(SumNormals(surface, sf, sums));
  PetscCall(PetscMalloc1(end - start, &edges));
  for (PetscInt e = start; e < end; e++) {
    const PetscReal *sum = sums + 4 * e;

    if (sum[3] > 1 && Dot(sum, sum) < PetscSqr(2 * SHARP_COSINE)) edges[n_edges++] = e;
  }
  PetscCall(PetscFree(sums));
  PetscCall(PetscCalloc1(chart, &marks));
  PetscCall(SurfaceMarkVertices(surface->dm, n_edges, edges, sf, marks));
  for (PetscInt i = 0; i < data->n_nodes; i++) surface->sharp[i] = (PetscBool)(marks[data->vertices[i]] > 0);
  PetscCall(PetscFree(marks));
  PetscCall(PetscFree(edges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gradients of the shape functions along a face with 2, 3 or 4 nodes, in its middle [1/m] */
void FaceGradients(PetscInt n, const PetscReal x[][3], PetscReal gradients[][3])
{
  static const PetscReal shapes[3][4][2] = {{{-0.5, 0}, {0.5, 0}}, {{-1, -1}, {1, 0}, {0, 1}}, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  const PetscReal(*slope)[2]             = shapes[n == 2 ? 0 : n == 3 ? 1 : 2];
  PetscReal a[3] = {0, 0, 0}, b[3] = {0, 0, 0}, aa = 0, ab = 0, bb = 0, determinant;

  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 3; d++) {
      a[d] += slope[k][0] * x[k][d];
      b[d] += slope[k][1] * x[k][d];
    }
  for (PetscInt d = 0; d < 3; d++) {
    aa += a[d] * a[d];
    ab += a[d] * b[d];
    bb += b[d] * b[d];
  }
  if (n == 2) bb = 1; /* there is no second direction */
  determinant = aa * bb - ab * ab;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal first  = (bb * slope[k][0] - ab * slope[k][1]) / determinant,
                    second = (aa * slope[k][1] - ab * slope[k][0]) / determinant;

    for (PetscInt d = 0; d < 3; d++) gradients[k][d] = first * a[d] + second * b[d];
  }
}

/* The outward normal of the part of the partner that a node on an edge saw when its row was built, with the partner's nodes at `x`;
   PETSC_FALSE: the row has no such part. The slopes map directions along that part to what they become. */
PetscBool RowPartnerNormal(Surface surface, const RowSet *set, PetscInt row, const PetscReal x[], PetscReal normal[])
{
  const PetscInt   dim   = surface->data.dim;
  const PetscReal *built = set->partner + 3 * row;
  PetscReal        frame[2][3], now[2][3] = {{0}};

  if (Dot(built, built) == 0) return PETSC_FALSE;
  if (dim == 2) now[1][2] = 1;
  UnitsAcross(dim, built, frame[0], frame[1]);
  for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
    for (PetscInt a = 0; a < dim - 1; a++)
      for (PetscInt d = 0; d < 3; d++) now[a][d] += Dot(set->shares[j].slope, frame[a]) * x[3 * set->columns[j] + d];
  Cross(now[0], now[1], normal);
  SurfaceMirrorNormal(surface, row, normal);
  (void)Normalize(normal);
  return PETSC_TRUE;
}
