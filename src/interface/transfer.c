#include <transfer.h>
#include "search.h"

/* One node of the Dirichlet side and the face opposite to it */
typedef struct {
  PetscInt  node, face;
  PetscReal gap;        /* between reference positions, along the node's normal [m] */
  PetscReal weights[4]; /* of the face's nodes */
} Row;

struct _n_Transfer {
  Surface   dirichlet, neumann;
  PetscInt  n;
  Row      *rows;
  PetscInt  n_nodes[2]; /* nodes that take part, Dirichlet and Neumann side */
  PetscInt *nodes[2];
};

/* Whether the bounding boxes of the bodies meet */
static PetscBool BoxesMeet(const SurfaceData *a, const SurfaceData *b)
{
  for (PetscInt d = 0; d < a->dim; d++)
    if (a->upper[d] < b->lower[d] || b->upper[d] < a->lower[d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* A row for each Dirichlet node that has a face of the other surface before it. A face behind it (the far ends of two bars)
   looks at it too, but across both bodies: then the gap is negative though the bodies are apart. */
static PetscErrorCode FindRows(Transfer transfer, const SurfaceData *dirichlet, const SurfaceData *neumann)
{
  const PetscInt  dim = dirichlet->dim, n = neumann->face_nodes;
  const PetscBool meet = BoxesMeet(dirichlet, neumann);

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(dirichlet->n_nodes, &transfer->rows));
  for (PetscInt node = 0; node < dirichlet->n_nodes; node++) {
    const PetscReal *x = dirichlet->positions + node * dim, *normal = dirichlet->normals + node * dim;
    Row             *row = &transfer->rows[transfer->n];

    PetscCall(SearchClosestFace(neumann, x, normal, &row->face, row->weights));
    if (row->face < 0) continue;
    row->node = node;
    row->gap  = 0;
    for (PetscInt d = 0; d < dim; d++) {
      PetscReal opposite = 0;

      for (PetscInt k = 0; k < n; k++) opposite += row->weights[k] * neumann->positions[neumann->faces[row->face * n + k] * dim + d];
      row->gap += normal[d] * (opposite - x[d]);
    }
    if (row->gap >= 0 || meet) transfer->n++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where bodies overlap from the start their far ends look at each other too: of the rows with negative gap keep the least
   negative, which is what an error message about the overlap should name */
static PetscErrorCode DropFarRows(Transfer transfer)
{
  PetscReal closest = PETSC_MAX_REAL;
  PetscInt  kept    = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < transfer->n; i++) closest = PetscMin(closest, PetscAbsReal(transfer->rows[i].gap));
  for (PetscInt i = 0; i < transfer->n; i++)
    if (transfer->rows[i].gap >= 0 || transfer->rows[i].gap >= -closest * (1 + 1e-6)) transfer->rows[kept++] = transfer->rows[i];
  transfer->n = kept;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CollectNodes(Transfer transfer, const SurfaceData *neumann)
{
  const PetscInt n = neumann->face_nodes;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(transfer->n, &transfer->nodes[0], transfer->n * n, &transfer->nodes[1]));
  for (PetscInt i = 0; i < transfer->n; i++) {
    transfer->nodes[0][i] = transfer->rows[i].node;
    for (PetscInt k = 0; k < n; k++) transfer->nodes[1][i * n + k] = neumann->faces[transfer->rows[i].face * n + k];
  }
  transfer->n_nodes[0] = transfer->n;
  transfer->n_nodes[1] = transfer->n * n;
  PetscCall(PetscSortRemoveDupsInt(&transfer->n_nodes[1], transfer->nodes[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferCreate - finds the rows that compare two surfaces

  Collective

  Input Parameters:
+ comm      - communicator of both
. dirichlet - surface that takes displacements and gives tractions
- neumann   - surface that takes tractions and gives displacements

  Output Parameter:
. transfer - the `Transfer`

  Level: developer

.seealso: `Transfer`, `TransferDestroy()`
@*/
PetscErrorCode TransferCreate(MPI_Comm comm, Surface dirichlet, Surface neumann, Transfer *transfer)
{
  const SurfaceData *d, *n;

  PetscFunctionBegin;
  PetscCall(PetscNew(transfer));
  (*transfer)->dirichlet = dirichlet;
  (*transfer)->neumann   = neumann;
  PetscCall(SurfaceGetData(dirichlet, &d));
  PetscCall(SurfaceGetData(neumann, &n));
  PetscCheck(d->dim == n->dim, comm, PETSC_ERR_USER_INPUT, "The two bodies of a contact pair have %" PetscInt_FMT " and %" PetscInt_FMT " dimensions", d->dim, n->dim);
  PetscCall(FindRows(*transfer, d, n));
  PetscCall(DropFarRows(*transfer));
  PetscCall(CollectNodes(*transfer, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferDestroy - frees a transfer; its surfaces belong to the caller

  Collective

  Input Parameter:
. transfer - the `Transfer`, set to `NULL`

  Level: developer

.seealso: `Transfer`, `TransferCreate()`
@*/
PetscErrorCode TransferDestroy(Transfer *transfer)
{
  PetscFunctionBegin;
  if (!*transfer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*transfer)->rows));
  PetscCall(PetscFree2((*transfer)->nodes[0], (*transfer)->nodes[1]));
  PetscCall(PetscFree(*transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetSize - number of rows

  Not Collective

  Input Parameter:
. transfer - the `Transfer`

  Output Parameter:
. n - the same on every rank

  Level: developer

.seealso: `Transfer`, `TransferGetRow()`
@*/
PetscErrorCode TransferGetSize(Transfer transfer, PetscInt *n)
{
  PetscFunctionBegin;
  *n = transfer->n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetRow - where a row is, how wide its gap, and what area it stands for

  Not Collective

  Input Parameters:
+ transfer - the `Transfer`
- row      - 0 to its size - 1

  Output Parameters:
+ dof  - global number of the first displacement of its Dirichlet node
. gap  - gap between the reference positions [m]
- area - share of the Dirichlet surface [m^2; 1 in one dimension]

  Level: developer

.seealso: `Transfer`
@*/
PetscErrorCode TransferGetRow(Transfer transfer, PetscInt row, PetscInt *dof, PetscReal *gap, PetscReal *area)
{
  const SurfaceData *dirichlet;

  PetscFunctionBegin;
  PetscCall(SurfaceGetData(transfer->dirichlet, &dirichlet));
  *dof  = dirichlet->dofs[transfer->rows[row].node];
  *gap  = transfer->rows[row].gap;
  *area = dirichlet->areas[transfer->rows[row].node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetValues - puts one row into the matrices of both sides

  Not Collective

  Input Parameters:
+ transfer  - the `Transfer`
. row       - 0 to its size - 1
. matrix_row - global row of the matrices
. dirichlet - gets the normal of the node, at its displacements
- neumann   - gets the normal times the weights, at the displacements of the face opposite

  Level: developer

  Note:
  Assemble both afterwards. A force f on the gap acts on the Neumann side as the transpose times f and on the Dirichlet side as
  its transpose times -f: both have the same resultant, since the weights sum to one.

.seealso: `Transfer`
@*/
PetscErrorCode TransferSetValues(Transfer transfer, PetscInt row, PetscInt matrix_row, Mat dirichlet, Mat neumann)
{
  const SurfaceData *d, *n;
  const Row         *r = &transfer->rows[row];
  const PetscReal   *normal;

  PetscFunctionBegin;
  PetscCall(SurfaceGetData(transfer->dirichlet, &d));
  PetscCall(SurfaceGetData(transfer->neumann, &n));
  normal = d->normals + r->node * d->dim;
  for (PetscInt i = 0; i < d->dim; i++) {
    PetscCall(MatSetValue(dirichlet, matrix_row, d->dofs[r->node] + i, normal[i], ADD_VALUES));
    for (PetscInt k = 0; k < n->face_nodes; k++) PetscCall(MatSetValue(neumann, matrix_row, n->dofs[n->faces[r->face * n->face_nodes + k]] + i, normal[i] * r->weights[k], ADD_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetNodes - the nodes of one side that take part in the rows

  Not Collective

  Input Parameters:
+ transfer - the `Transfer`
- neumann  - `PETSC_TRUE` for the Neumann side

  Output Parameters:
+ n     - their number
- nodes - node numbers of that side's `Surface`, owned by the transfer

  Level: developer

.seealso: `Transfer`, `SurfaceGetVertices()`
@*/
PetscErrorCode TransferGetNodes(Transfer transfer, PetscBool neumann, PetscInt *n, const PetscInt *nodes[])
{
  PetscFunctionBegin;
  *n     = transfer->n_nodes[neumann ? 1 : 0];
  *nodes = transfer->nodes[neumann ? 1 : 0];
  PetscFunctionReturn(PETSC_SUCCESS);
}
