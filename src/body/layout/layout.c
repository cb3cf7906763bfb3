/* Mesh and numbering: what the element loops and vectors of a body run over. */
#include "bodyimpl.h"
#include "cells.h"
#include <impakt/private/mesh.h>
#include <petscblaslapack.h>

/* One node at each vertex, `dim` displacements at each node */
static PetscErrorCode SetUpSection(Body body)
{
  PetscSection section;
  PetscInt     start, end, vstart, vend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetChart(body->mesh.dm, &start, &end));
  PetscCall(DMPlexGetDepthStratum(body->mesh.dm, 0, &vstart, &vend));
  PetscCall(PetscSectionCreate(PetscObjectComm((PetscObject)body), &section));
  PetscCall(PetscSectionSetChart(section, start, end));
  for (PetscInt v = vstart; v < vend; v++) PetscCall(PetscSectionSetDof(section, v, body->mesh.dim));
  PetscCall(PetscSectionSetUp(section));
  PetscCall(DMSetLocalSection(body->mesh.dm, section));
  PetscCall(PetscSectionDestroy(&section));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* node_of_vertex[v - vstart]: owned nodes in the order of the global vector, then ghosts */
static PetscErrorCode NumberNodes(Body body, PetscInt vstart, PetscInt vend, PetscInt node_of_vertex[])
{
  PetscSection global;
  PetscInt     rstart = -1, ghosts = 0;

  PetscFunctionBegin;
  PetscCall(DMGetGlobalSection(body->mesh.dm, &global));
  body->mesh.local_nodes = vend - vstart;
  body->mesh.owned_nodes = 0;
  for (PetscInt v = vstart; v < vend; v++) {
    PetscInt offset;

    PetscCall(PetscSectionGetOffset(global, v, &offset));
    if (offset < 0) continue;
    if (rstart < 0 || offset < rstart) rstart = offset;
    body->mesh.owned_nodes++;
  }
  PetscCall(PetscMalloc1((body->mesh.local_nodes - body->mesh.owned_nodes) * body->mesh.dim, &body->mesh.ghost_dofs));
  for (PetscInt v = vstart; v < vend; v++) {
    PetscInt offset;

    PetscCall(PetscSectionGetOffset(global, v, &offset));
    if (offset >= 0) {
      node_of_vertex[v - vstart] = (offset - rstart) / body->mesh.dim;
    } else {
      for (PetscInt d = 0; d < body->mesh.dim; d++) body->mesh.ghost_dofs[ghosts * body->mesh.dim + d] = -(offset + 1) + d;
      node_of_vertex[v - vstart] = body->mesh.owned_nodes + ghosts++;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUpCoordinates(Body body, PetscInt vstart, PetscInt vend, const PetscInt node_of_vertex[])
{
  PetscSection       section;
  Vec                local;
  const PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(body->mesh.local_nodes * body->mesh.dim, &body->mesh.coordinates));
  PetscCall(DMGetCoordinateSection(body->mesh.dm, &section));
  PetscCall(DMGetCoordinatesLocal(body->mesh.dm, &local));
  PetscCall(VecGetArrayRead(local, &x));
  for (PetscInt v = vstart; v < vend; v++) {
    PetscInt offset;

    PetscCall(PetscSectionGetOffset(section, v, &offset));
    for (PetscInt d = 0; d < body->mesh.dim; d++)
      body->mesh.coordinates[node_of_vertex[v - vstart] * body->mesh.dim + d] = PetscRealPart(x[offset + d]);
  }
  PetscCall(VecRestoreArrayRead(local, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shape of all cells, and with it that of the elements */
PetscErrorCode BodySetUpCells(Body body)
{
  PetscInt       cstart, cend;
  int            shape[2] = {DM_NUM_POLYTOPES, -1};
  DMPolytopeType cell     = DM_POLYTOPE_UNKNOWN;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &cstart, &cend));
  for (PetscInt c = cstart; c < cend; c++) {
    DMPolytopeType type;

    PetscCall(DMPlexGetCellType(body->mesh.dm, c, &type));
    shape[0] = PetscMin(shape[0], (int)type);
    shape[1] = PetscMax(shape[1], (int)type);
  }
  /* a rank may have no cells at all */
  shape[0] = -shape[0];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, shape, 2, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  PetscCheck(shape[1] >= 0, PetscObjectComm((PetscObject)body), PETSC_ERR_USER_INPUT,
             "Body '%s' has no cells: check -%s_dm_plex_box_faces or the mesh file", body->hdr.name, body->hdr.name);
  cell                  = (DMPolytopeType)shape[1];
  body->mesh.cell_shape = cell;
  PetscCheck(
      -shape[0] == shape[1], PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
      "The mesh of body '%s' mixes cells of shape '%s' and '%s'; one shape in a body is supported; give each shape a body of its own",
      body->hdr.name, DMPolytopeTypes[-shape[0]], DMPolytopeTypes[cell]);
  PetscCall(ElementSetMaterial(body->model.element, body->model.material));
  PetscCall(ElementSetCellType(body->model.element, cell));
  PetscCheck(body->model.element->dim == body->mesh.dim, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "Body '%s': cells of shape '%s' in %" PetscInt_FMT " dimensions are not supported", body->hdr.name, DMPolytopeTypes[cell],
             body->mesh.dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes of all cells, from DMPLEX's order of vertices to the usual one */
static PetscErrorCode SetUpConnectivity(Body body, PetscInt vstart, PetscInt vend, const PetscInt node_of_vertex[])
{
  BodyMesh *mesh = &body->mesh;
  PetscInt  cstart, cend;

  PetscFunctionBegin;
  PetscCall(DMPlexGetHeightStratum(mesh->dm, 0, &cstart, &cend));
  mesh->n_cells    = cend - cstart;
  mesh->cell_nodes = DMPolytopeTypeGetNumVertices(mesh->cell_shape);
  PetscCall(PetscMalloc1(mesh->n_cells * mesh->cell_nodes, &mesh->cell_connectivity));
  for (PetscInt c = cstart; c < cend; c++) {
    PetscInt *closure = NULL, n_points, nodes = 0, *of_cell = mesh->cell_connectivity + (c - cstart) * mesh->cell_nodes;

    PetscCall(DMPlexGetTransitiveClosure(mesh->dm, c, PETSC_TRUE, &n_points, &closure));
    for (PetscInt p = 0; p < n_points; p++)
      if (closure[2 * p] >= vstart && closure[2 * p] < vend) of_cell[nodes++] = node_of_vertex[closure[2 * p] - vstart];
    PetscCall(DMPlexRestoreTransitiveClosure(mesh->dm, c, PETSC_TRUE, &n_points, &closure));
    PetscCall(DMPlexInvertCell(mesh->cell_shape, of_cell));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body that flows and whose nodes all lie on its surface has one element through its thickness */
static PetscErrorCode WarnOfOneLayer(Body body, PetscInt vstart, PetscInt vend)
{
  PetscInt  n, *on_surface;
  PetscBool inner;

  PetscFunctionBegin;
  if (!body->model.element->history.n || body->mesh.dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeshGetNodeSet(body->mesh.dm, NULL, &n, &on_surface));
  PetscCall(PetscFree(on_surface));
  inner = (PetscBool)(n < vend - vstart);
  PetscCall(BodyAnyRank(body, &inner));
  if (!inner) PetscCall(ElementWarnOfOneLayer(body->model.element));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUpElements(Body body, PetscInt vstart, PetscInt vend, const PetscInt node_of_vertex[])
{
  BodyBlocks *blocks = &body->model.blocks;
  PetscInt    count;

  PetscFunctionBegin;
  PetscCall(SetUpConnectivity(body, vstart, vend, node_of_vertex));
  PetscCall(BodyFindComposite(body));
  if (body->model.element->composite) PetscCall(BodySetUpComposite(body));
  else {
    body->mesh.cells_of_element = 1;
    body->mesh.connectivity     = body->mesh.cell_connectivity;
    blocks->of_element          = blocks->of_cell;
  }
  count = body->mesh.n_cells / body->mesh.cells_of_element;
  if (blocks->n) PetscCall(ElementSetBlocks(body->model.element, blocks->n, blocks->materials, count, blocks->of_element));
  PetscCall(ElementSetUp(body->model.element, count, body->mesh.connectivity, body->mesh.coordinates));
  PetscCall(ElementWarnOfLocking(body->model.element));
  PetscCall(WarnOfOneLayer(body, vstart, vend));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes on the axis of an axisymmetric body */
static PetscErrorCode FindAxis(Body body)
{
  PetscReal tolerance;

  PetscFunctionBegin;
  if (!body->model.element->axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeshGetAxisTolerance(body->mesh.dm, &tolerance));
  PetscCall(PetscCalloc1(body->mesh.local_nodes, &body->mesh.on_axis));
  for (PetscInt node = 0; node < body->mesh.local_nodes; node++) {
    body->mesh.on_axis[node] = (PetscBool)(body->mesh.coordinates[node * body->mesh.dim] <= tolerance);
    if (body->mesh.on_axis[node]) body->mesh.touches_axis = PETSC_TRUE;
  }
  PetscCall(BodyAnyRank(body, &body->mesh.touches_axis));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether one of several ranks has all cells, and which */
static PetscErrorCode FindOwner(Body body)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)body);
  PetscInt    start, end;
  PetscMPIInt rank, found[2];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(DMPlexGetHeightStratum(body->mesh.dm, 0, &start, &end));
  found[0] = end > start;
  found[1] = end > start ? rank : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found, 2, MPI_INT, MPI_SUM, comm));
  body->mesh.whole    = (PetscBool)(body->rows.size > 1 && found[0] == 1);
  body->mesh.ghosted  = (PetscBool)(body->rows.size > 1 && !body->mesh.whole);
  body->mesh.owner    = body->mesh.whole ? found[1] : 0;
  body->mesh.is_owner = (PetscBool)(rank == body->mesh.owner);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbering, coordinates, connectivity and elements from the DMPlex, after BodySetUpCells() */
PetscErrorCode BodySetUpLayout(Body body)
{
  PetscInt     vstart, vend, *node_of_vertex;
  PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(FindOwner(body));
  PetscCall(SetUpSection(body));
  PetscCall(DMPlexGetDepthStratum(body->mesh.dm, 0, &vstart, &vend));
  PetscCall(PetscMalloc1(vend - vstart, &node_of_vertex));
  body->mesh.vertex_start   = vstart;
  body->mesh.node_of_vertex = node_of_vertex; /* freed with the body, whatever happens next */
  PetscCall(NumberNodes(body, vstart, vend, node_of_vertex));
  PetscCall(SetUpCoordinates(body, vstart, vend, node_of_vertex));
  PetscCall(FindAxis(body));
  PetscCall(SetUpElements(body, vstart, vend, node_of_vertex));
  PetscCall(PetscCalloc1(body->mesh.local_nodes, &body->layer.contains));
  PetscCall(BodyCreateVec(body, &body->mesh.positions));
  PetscCall(VecGetArrayWrite(body->mesh.positions, &x));
  for (PetscInt i = 0; i < body->mesh.owned_nodes * body->mesh.dim; i++) x[i] = body->mesh.coordinates[i];
  PetscCall(VecRestoreArrayWrite(body->mesh.positions, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Logical or over all ranks */
PetscErrorCode BodyAnyRank(Body body, PetscBool *any)
{
  int value = *any ? 1 : 0; /* a PetscBool is of different size in different versions of PETSc */

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_MAX, PetscObjectComm((PetscObject)body)));
  *any = value ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Uses a scatter that has just been made, on all ranks. PETSc gives its messages a tag the first time, which is the same on all ranks only
   if they take tags in one order, and later one rank may use it alone. What is in `to` is lost. */
PetscErrorCode BodyUseScatter(VecScatter scatter, Vec from, Vec to)
{
  PetscFunctionBegin;
  PetscCall(VecScatterBegin(scatter, from, to, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, from, to, INSERT_VALUES, SCATTER_FORWARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The product of this rank's parts of two vectors: as that of vectors of one rank, bit for bit */
PetscErrorCode BodyGetLocalDot(Vec a, Vec b, PetscReal *dot)
{
  const PetscScalar *x, *y;
  PetscInt           n;
  PetscBLASInt       size, one = 1;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(a, &n));
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCall(VecGetArrayRead(a, &x));
  PetscCall(VecGetArrayRead(b, &y));
  *dot = PetscRealPart(BLASdot_(&size, x, &one, y, &one));
  PetscCall(VecRestoreArrayRead(b, &y));
  PetscCall(VecRestoreArrayRead(a, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Product of two vectors laid out as displacements, or of the massless layer: of a body that steps alone that of this rank's part */
PetscErrorCode BodyGetDot(Body body, Vec a, Vec b, PetscReal *dot)
{
  PetscScalar value;

  PetscFunctionBegin;
  if (!body->local) {
    PetscCall(VecDot(a, b, &value));
    *dot = PetscRealPart(value);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetLocalDot(a, b, dot));
  if (!BodyStepsAlone(body)) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, dot, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)body)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2-norm of a vector of this kind. PETSc remembers the norm of a vector that has not changed, which the vectors of a local body have for
   its own rank alone: there the sum over ranks is made each time. */
PetscErrorCode BodyGetNorm(Body body, Vec vec, PetscReal *norm)
{
  PetscFunctionBegin;
  if (!body->local) {
    PetscCall(VecNorm(vec, NORM_2, norm));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BodyGetDot(body, vec, vec, norm));
  *norm = PetscSqrtReal(*norm);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What this rank adds to a sum over all ranks that is to be a number of the body: that of the rank that knows it */
PetscReal BodyShareOf(Body body, PetscReal value)
{
  return body->mesh.is_owner ? value : 0;
}

/* A vector with the layout of the DM's global vector, with room for ghosts behind owned values for element loops in place */
PetscErrorCode BodyCreateVec(Body body, Vec *vec)
{
  MPI_Comm       comm   = PetscObjectComm((PetscObject)body);
  const PetscInt owned  = body->mesh.owned_nodes * body->mesh.dim,
                 ghosts = (body->mesh.local_nodes - body->mesh.owned_nodes) * body->mesh.dim;

  PetscFunctionBegin;
  if (body->mesh.positions) PetscCall(VecDuplicate(body->mesh.positions, vec)); /* ranks need not tell each other their sizes again */
  else if (body->rows.size == 1) PetscCall(VecCreateSeq(comm, owned, vec));
  else if (!body->mesh.ghosted) PetscCall(VecCreateMPI(comm, owned, PETSC_DETERMINE, vec));
  else PetscCall(VecCreateGhost(comm, owned, PETSC_DETERMINE, ghosts, body->mesh.ghost_dofs, vec));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of a vector on all nodes of this rank, ghosts up to date, for loops over elements. Collective. */
PetscErrorCode BodyGetLocalRead(Body body, Vec vec, Vec *local, const PetscScalar *array[])
{
  PetscFunctionBegin;
  *local = vec;
  if (body->mesh.ghosted) {
    PetscCall(VecGhostUpdateBegin(vec, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostUpdateEnd(vec, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGhostGetLocalForm(vec, local));
  }
  PetscCall(VecGetArrayRead(*local, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRestoreLocalRead(Body body, Vec vec, Vec *local, const PetscScalar *array[])
{
  PetscFunctionBegin;
  PetscCall(VecRestoreArrayRead(*local, array));
  if (body->mesh.ghosted) PetscCall(VecGhostRestoreLocalForm(vec, local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values on all nodes of this rank, zero at first, for loops over elements that add to them. BodyRestoreLocalSum() hands what ghosts have
   got to their owners. Collective. */
PetscErrorCode BodyGetLocalSum(Body body, Vec vec, Vec *local, PetscScalar *array[])
{
  PetscFunctionBegin;
  *local = vec;
  if (body->mesh.ghosted) PetscCall(VecGhostGetLocalForm(vec, local));
  PetscCall(VecGetArrayWrite(*local, array));
  PetscCall(PetscArrayzero(*array, body->mesh.local_nodes * body->mesh.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyRestoreLocalSum(Body body, Vec vec, Vec *local, PetscScalar *array[])
{
  PetscFunctionBegin;
  PetscCall(VecRestoreArrayWrite(*local, array));
  if (!body->mesh.ghosted) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGhostRestoreLocalForm(vec, local));
  PetscCall(VecGhostUpdateBegin(vec, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecGhostUpdateEnd(vec, ADD_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  BodyGetCells - the elements of the mesh, for output

  Not Collective

  Input Parameter:
. body - the `Body`, with its mesh

  Output Parameters:
+ shape   - of all cells
. n_cells - those of this rank
. n_nodes - nodes of a cell
- cells   - per cell of this rank: the global numbers of its nodes, in the order of VTK; free with `PetscFree()`

  Level: intermediate

  Note:
  A composite element is the cells that it is made of. Global node k is the k-th block of `dim` displacements in the vectors of
`BodyGetSolution()`.

.seealso: `Body`, `BodyGetReferencePositions()`, `BodyComputeStress()`
@*/
PetscErrorCode BodyGetCells(Body body, DMPolytopeType *shape, PetscInt *n_cells, PetscInt *n_nodes, PetscInt *cells[])
{
  const PetscInt n = body->mesh.n_cells * body->mesh.cell_nodes;
  PetscInt       rstart;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(body, BODY_CLASSID, 1);
  PetscAssertPointer(shape, 2);
  PetscAssertPointer(n_cells, 3);
  PetscAssertPointer(n_nodes, 4);
  PetscAssertPointer(cells, 5);
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &rstart, NULL));
  PetscCall(PetscMalloc1(n, cells));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt node = body->mesh.cell_connectivity[i];

    (*cells)[i] = (node < body->mesh.owned_nodes ? rstart + node * body->mesh.dim
                                                 : body->mesh.ghost_dofs[(node - body->mesh.owned_nodes) * body->mesh.dim]) /
                  body->mesh.dim;
  }
  *shape   = body->mesh.cell_shape;
  *n_cells = body->mesh.n_cells;
  *n_nodes = body->mesh.cell_nodes;
  PetscFunctionReturn(PETSC_SUCCESS);
}
