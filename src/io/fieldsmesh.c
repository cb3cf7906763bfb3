/* All bodies as one mesh: nodes and cells of the first body, then of the second, and so on. Every reader of XDMF takes this form. If each
   body had a grid of its own, some readers would show the first body alone. */
#include "fieldsmesh.h"

/* Shapes of cells in XDMF (www.xdmf.org, XDMF Model and Format, Topology): their names; their numbers in a list of cells of several shapes;
   and whether this list tells the number of nodes of each such cell too */
typedef struct {
  DMPolytopeType shape;
  const char    *name;
  int            id;
  PetscBool      counted;
} Shape;

static const Shape shapes[] = {
    {DM_POLYTOPE_SEGMENT, "Polyline", 2, PETSC_TRUE},
    {DM_POLYTOPE_TRIANGLE, "Triangle", 4, PETSC_FALSE},
    {DM_POLYTOPE_QUADRILATERAL, "Quadrilateral", 5, PETSC_FALSE},
    {DM_POLYTOPE_TETRAHEDRON, "Tetrahedron", 6, PETSC_FALSE},
    {DM_POLYTOPE_HEXAHEDRON, "Hexahedron", 9, PETSC_FALSE},
};

static PetscErrorCode FindShape(Body body, DMPolytopeType shape, const Shape **found)
{
  const char *name;

  PetscFunctionBegin;
  *found = NULL;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(shapes); i++)
    if (shapes[i].shape == shape) *found = &shapes[i];
  PetscCall(PetscObjectGetName((PetscObject)body, &name));
  PetscCheck(*found, PetscObjectComm((PetscObject)body), PETSC_ERR_SUP,
             "-output_fields: cells of shape '%s', as body '%s' has them, cannot be written", DMPolytopeTypes[shape], name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RowsCreate(PetscInt n, FieldsRows *rows)
{
  PetscFunctionBegin;
  rows->n     = n;
  rows->total = rows->local = 0;
  PetscCall(PetscMalloc2(n, &rows->begin, n, &rows->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the rows of the next body, of which this rank has `local` */
static PetscErrorCode RowsAdd(MPI_Comm comm, PetscInt piece, PetscInt64 local, FieldsRows *rows)
{
  PetscInt64  end, total;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Scan(&local, &end, 1, MPIU_INT64, MPI_SUM, comm));
  total = end;
  PetscCallMPI(MPI_Bcast(&total, 1, MPIU_INT64, size - 1, comm));
  rows->begin[piece] = rows->total + (hsize_t)(end - local);
  rows->count[piece] = (hsize_t)local;
  rows->total += (hsize_t)total;
  rows->local += (hsize_t)local;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the rows of nodes and cells, and finds out whether all cells have one shape */
static PetscErrorCode CountRows(FieldsMesh *mesh)
{
  const Shape *first = NULL, *shape;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    MPI_Comm       comm = PetscObjectComm((PetscObject)mesh->bodies[b]);
    DMPolytopeType type;
    PetscInt       n_cells, cell_nodes, *cells, n_nodes, dim;
    Vec            positions;

    PetscCall(BodyGetCells(mesh->bodies[b], &type, &n_cells, &cell_nodes, &cells));
    PetscCall(PetscFree(cells));
    PetscCall(FindShape(mesh->bodies[b], type, &shape));
    if (!first) first = shape;
    if (shape != first) mesh->mixed = PETSC_TRUE;
    mesh->cell_nodes = cell_nodes;
    PetscCall(RowsAdd(comm, b, n_cells, &mesh->cells));
    PetscCall(BodyGetDimension(mesh->bodies[b], &dim));
    PetscCall(BodyGetReferencePositions(mesh->bodies[b], &positions));
    PetscCall(VecGetLocalSize(positions, &n_nodes));
    PetscCall(RowsAdd(comm, b, n_nodes / dim, &mesh->nodes));
  }
  mesh->topology_type = mesh->mixed || !first ? "Mixed" : first->name;
  if (mesh->mixed) mesh->cell_nodes = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountTopology(FieldsMesh *mesh)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    DMPolytopeType type;
    const Shape   *shape;
    PetscInt       n_cells, cell_nodes, *cells;

    PetscCall(BodyGetCells(mesh->bodies[b], &type, &n_cells, &cell_nodes, &cells));
    PetscCall(PetscFree(cells));
    PetscCall(FindShape(mesh->bodies[b], type, &shape));
    PetscCall(RowsAdd(PetscObjectComm((PetscObject)mesh->bodies[b]), b,
                      mesh->mixed ? (PetscInt64)n_cells * (1 + shape->counted + cell_nodes) : n_cells, &mesh->topology));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where nodes and cells of the bodies lie in files. Collective */
PetscErrorCode FieldsMeshCreate(PetscInt n, const Body bodies[], FieldsMesh *mesh)
{
  PetscFunctionBegin;
  mesh->n_bodies = n;
  mesh->bodies   = bodies;
  mesh->mixed    = PETSC_FALSE;
  PetscCall(RowsCreate(n, &mesh->nodes));
  PetscCall(RowsCreate(n, &mesh->cells));
  PetscCall(RowsCreate(n, &mesh->topology));
  PetscCall(CountRows(mesh));
  PetscCall(CountTopology(mesh));
  PetscCheck(mesh->nodes.total <= (hsize_t)INT_MAX, PetscObjectComm((PetscObject)bodies[0]), PETSC_ERR_SUP,
             "-output_fields numbers nodes with 32 bits, and the bodies have more of them together: %llu",
             (unsigned long long)mesh->nodes.total);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FieldsMeshGetTopology(const FieldsMesh *mesh, int entries[])
{
  hsize_t first = 0; /* number of the body's first node */

  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    DMPolytopeType type;
    const Shape   *shape;
    PetscInt       n_cells, cell_nodes, *cells, dim, size;
    Vec            positions;

    PetscCall(BodyGetCells(mesh->bodies[b], &type, &n_cells, &cell_nodes, &cells));
    PetscCall(FindShape(mesh->bodies[b], type, &shape));
    for (PetscInt c = 0; c < n_cells; c++) {
      if (mesh->mixed) *entries++ = shape->id;
      if (mesh->mixed && shape->counted) *entries++ = (int)cell_nodes;
      for (PetscInt i = 0; i < cell_nodes; i++) *entries++ = (int)first + (int)cells[c * cell_nodes + i];
    }
    PetscCall(PetscFree(cells));
    PetscCall(BodyGetDimension(mesh->bodies[b], &dim));
    PetscCall(BodyGetReferencePositions(mesh->bodies[b], &positions));
    PetscCall(VecGetSize(positions, &size));
    first += (hsize_t)(size / dim);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reference positions of this rank's nodes. `x`: three coordinates for each node, 0 beyond the dimension of its body [m] */
PetscErrorCode FieldsMeshGetNodes(const FieldsMesh *mesh, PetscReal x[])
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < mesh->n_bodies; b++) {
    const PetscScalar *values;
    PetscInt           dim;
    Vec                positions;

    PetscCall(BodyGetDimension(mesh->bodies[b], &dim));
    PetscCall(BodyGetReferencePositions(mesh->bodies[b], &positions));
    PetscCall(VecGetArrayRead(positions, &values));
    for (PetscInt i = 0; i < (PetscInt)mesh->nodes.count[b]; i++)
      for (PetscInt d = 0; d < 3; d++) *x++ = d < dim ? PetscRealPart(values[i * dim + d]) : 0;
    PetscCall(VecRestoreArrayRead(positions, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FieldsMeshDestroy(FieldsMesh *mesh)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(mesh->nodes.begin, mesh->nodes.count));
  PetscCall(PetscFree2(mesh->cells.begin, mesh->cells.count));
  PetscCall(PetscFree2(mesh->topology.begin, mesh->topology.count));
  PetscFunctionReturn(PETSC_SUCCESS);
}
