#include <surface.h>
#include <mesh.h>

struct _n_Surface {
  DM          dm;
  SurfaceData data;
  PetscInt   *dofs, *faces;
  PetscReal  *positions, *areas, *normals, *face_normals;
};

/* One face as its rank sees it */
typedef struct {
  PetscInt  dofs[4];
  PetscReal positions[4][3], normal[3], area;
} Face;

/* Component of `out` across the face, as a unit vector: `out` less its projections on the edges that leave the first node */
static void OutwardNormal(PetscInt dim, PetscInt n, PetscReal positions[][3], PetscReal out[])
{
  PetscReal tangents[3][3], length = 0;
  PetscInt  n_tangents = 0;

  for (PetscInt k = 1; k < n && n_tangents < dim - 1; k++) {
    PetscReal tangent[3] = {0}, size = 0, full = 0;

    for (PetscInt d = 0; d < dim; d++) tangent[d] = positions[k][d] - positions[0][d];
    for (PetscInt d = 0; d < dim; d++) full += tangent[d] * tangent[d];
    for (PetscInt t = 0; t < n_tangents; t++) {
      PetscReal dot = 0;

      for (PetscInt d = 0; d < dim; d++) dot += tangent[d] * tangents[t][d];
      for (PetscInt d = 0; d < dim; d++) tangent[d] -= dot * tangents[t][d];
    }
    for (PetscInt d = 0; d < dim; d++) size += tangent[d] * tangent[d];
    if (size <= 1e-20 * full) continue;
    for (PetscInt d = 0; d < dim; d++) tangents[n_tangents][d] = tangent[d] / PetscSqrtReal(size);
    n_tangents++;
  }
  for (PetscInt t = 0; t < n_tangents; t++) {
    PetscReal dot = 0;

    for (PetscInt d = 0; d < dim; d++) dot += out[d] * tangents[t][d];
    for (PetscInt d = 0; d < dim; d++) out[d] -= dot * tangents[t][d];
  }
  for (PetscInt d = 0; d < dim; d++) length += out[d] * out[d];
  for (PetscInt d = 0; d < dim; d++) out[d] /= PetscSqrtReal(length);
}

static PetscErrorCode DescribeFace(DM dm, PetscInt face, PetscInt dim, PetscInt *n_nodes, Face *description)
{
  PetscSection       section, coordinate_section;
  Vec                coordinates;
  const PetscScalar *x;
  const PetscInt    *support;
  PetscInt          *closure     = NULL, n_points, vstart, vend;
  PetscReal          centroid[3] = {0}, cell_centroid[3] = {0};

  PetscFunctionBegin;
  PetscCall(DMGetGlobalSection(dm, &section));
  PetscCall(DMGetCoordinateSection(dm, &coordinate_section));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &vstart, &vend));
  PetscCall(PetscMemzero(description, sizeof(*description)));
  PetscCall(VecGetArrayRead(coordinates, &x));
  *n_nodes = 0;
  PetscCall(DMPlexGetTransitiveClosure(dm, face, PETSC_TRUE, &n_points, &closure));
  for (PetscInt p = 0; p < n_points; p++) {
    PetscInt offset;

    if (closure[2 * p] < vstart || closure[2 * p] >= vend) continue;
    PetscCheck(*n_nodes < 4, PETSC_COMM_SELF, PETSC_ERR_SUP, "Faces with more than four nodes are not supported");
    PetscCall(PetscSectionGetOffset(section, closure[2 * p], &offset));
    description->dofs[*n_nodes] = offset < 0 ? -(offset + 1) : offset;
    PetscCall(PetscSectionGetOffset(coordinate_section, closure[2 * p], &offset));
    for (PetscInt d = 0; d < dim; d++) description->positions[*n_nodes][d] = PetscRealPart(x[offset + d]);
    (*n_nodes)++;
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, face, PETSC_TRUE, &n_points, &closure));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  description->area = 1;
  if (*n_nodes > 1) PetscCall(DMPlexComputeCellGeometryFVM(dm, face, &description->area, NULL, NULL));
  for (PetscInt k = 0; k < *n_nodes; k++)
    for (PetscInt d = 0; d < dim; d++) centroid[d] += description->positions[k][d] / *n_nodes;
  PetscCall(DMPlexGetSupport(dm, face, &support));
  PetscCall(DMPlexComputeCellGeometryFVM(dm, support[0], NULL, cell_centroid, NULL));
  for (PetscInt d = 0; d < dim; d++) description->normal[d] = centroid[d] - cell_centroid[d];
  OutwardNormal(dim, *n_nodes, description->positions, description->normal);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The faces of this rank that a name means */
static PetscErrorCode CollectFaces(Surface surface, const char name[], PetscInt *n_faces, Face **faces)
{
  DM       dm      = surface->dm;
  PetscInt n_nodes = 0, *points;

  PetscFunctionBegin;
  PetscCall(MeshGetSurface(dm, name, n_faces, &points));
  PetscCall(PetscMalloc1(*n_faces, faces));
  for (PetscInt i = 0; i < *n_faces; i++) PetscCall(DescribeFace(dm, points[i], surface->data.dim, &n_nodes, &(*faces)[i]));
  PetscCall(PetscFree(points));
  PetscCallMPI(MPI_Allreduce(&n_nodes, &surface->data.face_nodes, 1, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)dm)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All faces on every rank: surfaces are small beside bodies */
static PetscErrorCode GatherFaces(MPI_Comm comm, PetscInt n, const Face mine[], PetscInt *n_all, Face **all)
{
  PetscMPIInt size, bytes, *counts, *offsets, total = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc2(size, &counts, size, &offsets));
  PetscCall(PetscMPIIntCast(n * (PetscInt)sizeof(Face), &bytes));
  PetscCallMPI(MPI_Allgather(&bytes, 1, MPI_INT, counts, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < size; total += counts[r++]) offsets[r] = total;
  *n_all = total / (PetscInt)sizeof(Face);
  PetscCall(PetscMalloc1(*n_all, all));
  PetscCallMPI(MPI_Allgatherv(mine, bytes, MPI_BYTE, *all, counts, offsets, MPI_BYTE, comm));
  PetscCall(PetscFree2(counts, offsets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the nodes, and gives them normals and areas */
static PetscErrorCode SetUpNodes(Surface surface, PetscInt n_faces, const Face faces[])
{
  SurfaceData   *data = &surface->data;
  const PetscInt dim = data->dim, n = data->face_nodes;
  PetscInt       n_nodes = n_faces * n;

  PetscFunctionBegin;
  data->n_faces = n_faces;
  PetscCall(PetscMalloc1(n_nodes, &surface->dofs));
  for (PetscInt f = 0; f < n_faces; f++)
    for (PetscInt k = 0; k < n; k++) surface->dofs[f * n + k] = faces[f].dofs[k];
  PetscCall(PetscSortRemoveDupsInt(&n_nodes, surface->dofs));
  data->n_nodes = n_nodes;
  PetscCall(PetscMalloc1(n_faces * n, &surface->faces));
  PetscCall(PetscMalloc1(n_faces * dim, &surface->face_normals));
  PetscCall(PetscCalloc3(n_nodes * dim, &surface->positions, n_nodes, &surface->areas, n_nodes * dim, &surface->normals));
  for (PetscInt f = 0; f < n_faces; f++) {
    for (PetscInt d = 0; d < dim; d++) surface->face_normals[f * dim + d] = faces[f].normal[d];
    for (PetscInt k = 0; k < n; k++) {
      PetscInt node;

      PetscCall(PetscFindInt(faces[f].dofs[k], n_nodes, surface->dofs, &node));
      surface->faces[f * n + k] = node;
      surface->areas[node] += faces[f].area / n;
      for (PetscInt d = 0; d < dim; d++) {
        surface->positions[node * dim + d] = faces[f].positions[k][d];
        surface->normals[node * dim + d] += faces[f].area * faces[f].normal[d];
      }
    }
  }
  for (PetscInt node = 0; node < n_nodes; node++) {
    PetscReal length = 0;

    for (PetscInt d = 0; d < dim; d++) length += PetscSqr(surface->normals[node * dim + d]);
    for (PetscInt d = 0; d < dim; d++) surface->normals[node * dim + d] /= PetscSqrtReal(length);
  }
  data->dofs         = surface->dofs;
  data->faces        = surface->faces;
  data->positions    = surface->positions;
  data->areas        = surface->areas;
  data->normals      = surface->normals;
  data->face_normals = surface->face_normals;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceCreate - collects faces of a body's boundary

  Collective

  Input Parameters:
+ dm   - a `DMPLEX` with a local section of one block of displacements at each vertex
- name - as `MeshGetSurface()` takes it: a label of the mesh, a number, a side of its bounding box; `NULL` or empty for the
         whole boundary

  Output Parameter:
. surface - the `Surface`

  Level: developer

.seealso: `Surface`, `SurfaceGetData()`, `MeshGetSurface()`
@*/
PetscErrorCode SurfaceCreate(DM dm, const char name[], Surface *surface)
{
  MPI_Comm     comm = PetscObjectComm((PetscObject)dm);
  PetscSection section;
  Face        *mine, *all;
  PetscInt     n_mine = 0, n_all = 0;

  PetscFunctionBegin;
  PetscCall(PetscNew(surface));
  PetscCall(PetscObjectReference((PetscObject)dm));
  (*surface)->dm = dm;
  PetscCall(DMGetCoordinateDim(dm, &(*surface)->data.dim));
  PetscCall(DMGetBoundingBox(dm, (*surface)->data.lower, (*surface)->data.upper));
  PetscCall(DMGetGlobalSection(dm, &section)); /* made by all ranks together, also by those that have no face */
  PetscCall(CollectFaces(*surface, name, &n_mine, &mine));
  PetscCall(GatherFaces(comm, n_mine, mine, &n_all, &all));
  PetscCall(PetscFree(mine));
  PetscCall(SetUpNodes(*surface, n_all, all));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceDestroy - frees a surface

  Collective

  Input Parameter:
. surface - the `Surface`, set to `NULL`

  Level: developer

.seealso: `Surface`, `SurfaceCreate()`
@*/
PetscErrorCode SurfaceDestroy(Surface *surface)
{
  PetscFunctionBegin;
  if (!*surface) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*surface)->dofs));
  PetscCall(PetscFree((*surface)->faces));
  PetscCall(PetscFree((*surface)->face_normals));
  PetscCall(PetscFree3((*surface)->positions, (*surface)->areas, (*surface)->normals));
  PetscCall(DMDestroy(&(*surface)->dm));
  PetscCall(PetscFree(*surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceGetData - nodes, faces, normals and areas

  Not Collective

  Input Parameter:
. surface - the `Surface`

  Output Parameter:
. data - the same on every rank, owned by the surface

  Level: developer

.seealso: `Surface`, `SurfaceData`
@*/
PetscErrorCode SurfaceGetData(Surface surface, const SurfaceData **data)
{
  PetscFunctionBegin;
  *data = &surface->data;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  SurfaceGetVertices - the mesh points of some nodes, as far as this rank has them

  Not Collective

  Input Parameters:
+ surface - the `Surface`
. n       - number of nodes
- nodes   - nodes of the surface

  Output Parameters:
+ n_vertices - number of vertices
- vertices   - points of the `DMPLEX`, owned or ghosts; free with `PetscFree()`

  Level: developer

.seealso: `Surface`
@*/
PetscErrorCode SurfaceGetVertices(Surface surface, PetscInt n, const PetscInt nodes[], PetscInt *n_vertices, PetscInt **vertices)
{
  PetscSection section;
  PetscInt     vstart, vend, *dofs;

  PetscFunctionBegin;
  PetscCall(DMGetGlobalSection(surface->dm, &section));
  PetscCall(DMPlexGetDepthStratum(surface->dm, 0, &vstart, &vend));
  PetscCall(PetscMalloc1(n, &dofs));
  for (PetscInt i = 0; i < n; i++) dofs[i] = surface->dofs[nodes[i]];
  PetscCall(PetscSortInt(n, dofs));
  PetscCall(PetscMalloc1(PetscMin(n, vend - vstart), vertices));
  *n_vertices = 0;
  for (PetscInt v = vstart; v < vend; v++) {
    PetscInt offset, found;

    PetscCall(PetscSectionGetOffset(section, v, &offset));
    PetscCall(PetscFindInt(offset < 0 ? -(offset + 1) : offset, n, dofs, &found));
    if (found >= 0) (*vertices)[(*n_vertices)++] = v;
  }
  PetscCall(PetscFree(dofs));
  PetscFunctionReturn(PETSC_SUCCESS);
}
