/* Faces of elements on a surface: nodes, outward normals, and points with which loads are integrated over them. */
#include "faces.h"
#include <impakt/private/mesh.h>

static const PetscReal gauss = 0.57735026918962576451;
/* Exact for quadratic functions on triangles (Strang, Fix 1973, table 4.1): barycentric coordinates 2/3, 1/6, 1/6, equal weights */
static const PetscReal triangle_far = 2. / 3, triangle_near = 1. / 6;

static PetscErrorCode AddFace(Body body, PetscInt face, PetscInt cstart, PetscInt vend, BodyFaces *faces)
{
  PetscInt       *nodes   = faces->connectivity + faces->count * faces->nodes;
  PetscInt       *closure = NULL, n_points, n = 0;
  const PetscInt *support, *cell;
  PetscReal       out = 0, weights[FACE_MAX_POINTS * FACE_MAX_NODES];
  ExpressionPoint points[FACE_MAX_POINTS];

  PetscFunctionBegin;
  PetscCall(DMPlexGetTransitiveClosure(body->mesh.dm, face, PETSC_TRUE, &n_points, &closure));
  for (PetscInt p = 0; p < n_points; p++)
    if (closure[2 * p] >= body->mesh.vertex_start && closure[2 * p] < vend)
      nodes[n++] = body->mesh.node_of_vertex[closure[2 * p] - body->mesh.vertex_start];
  PetscCall(DMPlexRestoreTransitiveClosure(body->mesh.dm, face, PETSC_TRUE, &n_points, &closure));
  /* outward is away from the mean of the nodes of the cell behind */
  PetscCall(DMPlexGetSupport(body->mesh.dm, face, &support));
  cell                      = body->mesh.cell_connectivity + (support[0] - cstart) * body->mesh.cell_nodes;
  faces->side[faces->count] = 1;
  PetscCall(BodyFacesGetPoints(body, faces, faces->count, points, weights));
  for (PetscInt d = 0; d < body->mesh.dim; d++) {
    PetscReal way = 0;

    for (PetscInt g = 0; g < faces->n_points; g++) way += points[g].x[d] / faces->n_points;
    for (PetscInt a = 0; a < body->mesh.cell_nodes; a++)
      way -= body->mesh.coordinates[cell[a] * body->mesh.dim + d] / (PetscReal)body->mesh.cell_nodes;
    out += way * points[0].n[d];
  }
  if (out < 0) faces->side[faces->count] = -1;
  faces->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's faces of a surface. 2 points on lines, 2 x 2 on quadrilaterals, 3 on triangles: exact for linear densities. */
PetscErrorCode BodyFacesCreate(Body body, const char surface[], BodyFaces *faces)
{
  PetscInt n, *points, cstart, vend;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(faces, sizeof(*faces)));
  PetscCall(MeshGetSurface(body->mesh.dm, surface, &n, &points));
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, NULL));
  PetscCall(DMPlexGetDepthStratum(body->mesh.dm, 0, NULL, &vend));
  faces->nodes    = body->mesh.dim;
  faces->n_points = body->mesh.dim;
  if (body->mesh.cell_shape == DM_POLYTOPE_HEXAHEDRON) faces->nodes = faces->n_points = 4;
  PetscCall(PetscMalloc1(n * faces->nodes, &faces->connectivity));
  PetscCall(PetscMalloc1(n, &faces->side));
  for (PetscInt i = 0; i < n; i++) PetscCall(AddFace(body, points[i], cstart, vend, faces));
  PetscCall(PetscFree(points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shape functions and their derivatives at a point of a face; returns its weight on the reference face */
static PetscReal GetShape(PetscInt dim, PetscInt nodes, PetscInt g, PetscReal N[], PetscReal dN[2][FACE_MAX_NODES])
{
  if (dim == 1) {
    N[0] = 1;
    return 1;
  }
  if (nodes == 2) {
    const PetscReal xi = g ? gauss : -gauss;

    N[0]     = (1 - xi) / 2;
    N[1]     = (1 + xi) / 2;
    dN[0][0] = -0.5;
    dN[0][1] = 0.5;
    return 1;
  }
  if (nodes == 3) {
    for (PetscInt a = 0; a < 3; a++) {
      N[a]     = a == g ? triangle_far : triangle_near;
      dN[0][a] = (a == 1) - (a == 0);
      dN[1][a] = (a == 2) - (a == 0);
    }
    return triangle_near;
  }
  for (PetscInt a = 0; a < 4; a++) {
    const PetscReal sign[2] = {a == 1 || a == 2 ? 1 : -1, a >= 2 ? 1 : -1}, xi = g % 2 ? gauss : -gauss, eta = g / 2 ? gauss : -gauss;

    N[a]     = (1 + sign[0] * xi) * (1 + sign[1] * eta) / 4;
    dN[0][a] = sign[0] * (1 + sign[1] * eta) / 4;
    dN[1][a] = sign[1] * (1 + sign[0] * xi) / 4;
  }
  return 1;
}

/* Position and outward unit normal at the points of a face (their time is left alone), and the shape functions there times the
   weight [m^2]: of plane bodies times the thickness or, of rings, 2 pi r; of bars the cross-section. weights: n_points x nodes. */
PetscErrorCode BodyFacesGetPoints(Body body, const BodyFaces *faces, PetscInt face, ExpressionPoint points[], PetscReal weights[])
{
  const PetscInt  dim = body->mesh.dim, *nodes = faces->connectivity + face * faces->nodes;
  const PetscReal side = faces->side[face];

  PetscFunctionBegin;
  for (PetscInt g = 0; g < faces->n_points; g++) {
    PetscReal N[FACE_MAX_NODES], dN[2][FACE_MAX_NODES] = {{0}}, tangent[2][3] = {{0}}, area = 1, *x = points[g].x, *n = points[g].n;
    PetscReal weight = GetShape(dim, faces->nodes, g, N, dN);

    for (PetscInt d = 0; d < 3; d++) x[d] = n[d] = 0;
    for (PetscInt a = 0; a < faces->nodes; a++)
      for (PetscInt d = 0; d < dim; d++) {
        const PetscReal X = body->mesh.coordinates[nodes[a] * dim + d];

        x[d] += N[a] * X;
        tangent[0][d] += dN[0][a] * X;
        tangent[1][d] += dN[1][a] * X;
      }
    if (dim == 1) n[0] = 1;
    else if (dim == 2) {
      n[0] = tangent[0][1];
      n[1] = -tangent[0][0];
    } else
      for (PetscInt d = 0; d < 3; d++)
        n[d] = tangent[0][(d + 1) % 3] * tangent[1][(d + 2) % 3] - tangent[0][(d + 2) % 3] * tangent[1][(d + 1) % 3];
    area = PetscSqrtReal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (area > 0)
      for (PetscInt d = 0; d < 3; d++) n[d] *= side / area;
    weight *= area * body->model.element->cross_section;
    if (body->model.element->axisymmetric) weight *= 2 * PETSC_PI * x[0];
    for (PetscInt a = 0; a < faces->nodes; a++) weights[g * faces->nodes + a] = weight * N[a];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyFacesDestroy(BodyFaces *faces)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(faces->connectivity));
  PetscCall(PetscFree(faces->side));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the nodes at some vertices of this rank on all ranks that have them: one may hold a node of a surface without a face of it */
PetscErrorCode BodyMarkNodes(Body body, PetscInt n, const PetscInt vertices[], PetscBool marked[])
{
  const PetscBool    ghosted = body->mesh.ghosted;
  PetscScalar       *mark;
  const PetscScalar *all;
  Vec                marks, local;

  PetscFunctionBegin;
  PetscCall(BodyCreateVec(body, &marks));
  local = marks;
  if (ghosted) PetscCall(VecGhostGetLocalForm(marks, &local));
  PetscCall(VecSet(local, 0));
  PetscCall(VecGetArray(local, &mark));
  for (PetscInt i = 0; i < n; i++) mark[body->mesh.node_of_vertex[vertices[i] - body->mesh.vertex_start] * body->mesh.dim] = 1;
  PetscCall(VecRestoreArray(local, &mark));
  if (ghosted) {
    PetscCall(VecGhostUpdateBegin(marks, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateEnd(marks, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecGhostUpdateBegin(marks, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostUpdateEnd(marks, INSERT_VALUES, SCATTER_FORWARD));
  }
  PetscCall(VecGetArrayRead(local, &all));
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++)
    if (PetscRealPart(all[node * body->mesh.dim]) > 0) marked[node] = PETSC_TRUE;
  PetscCall(VecRestoreArrayRead(local, &all));
  if (ghosted) PetscCall(VecGhostRestoreLocalForm(marks, &local));
  PetscCall(VecDestroy(&marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
