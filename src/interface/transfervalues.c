/* The rows of a transfer as entries of matrices. */
#include "interfaceimpl.h"

/* Shares of a row whose entries go into a matrix together */
#define SHARES_AT_ONCE 32

/*@
  TransferCountValues - how many entries a row has in the matrices of both sides

  Not Collective

  Input Parameter:
. transfer - the `Transfer`, updated once at least

  Output Parameters:
+ first  - for each node of this rank: of a row of it, along its normal or another direction, in the matrix of the first side
- second - the same in that of the second side; `NULL` for obstacles

  Level: developer

.seealso: `Transfer`, `TransferSetValues()`, `TransferSetDirectedValues()`
@*/
PetscErrorCode TransferCountValues(Transfer transfer, PetscInt first[], PetscInt second[])
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  if (transfer->n) PetscAssertPointer(first, 2);
  for (PetscInt i = 0; i < transfer->n; i++) {
    first[i] = transfer->dim;
    if (second) second[i] = set->opposite[i] ? transfer->dim * (set->offsets[i + 1] - set->offsets[i]) : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of one row of node i: n components of a direction, the first of them that along axis `first`. Whole rows at once, since a
   call for each entry takes most of its time for itself. */
static PetscErrorCode SetRow(Transfer transfer, PetscInt i, const PetscInt row[2], PetscInt first, PetscInt n, const PetscReal direction[],
                             const Mat rows[2])
{
  const RowSet *set = &transfer->rows;
  PetscInt      columns[3 * SHARES_AT_ONCE];
  PetscScalar   values[3 * SHARES_AT_ONCE];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < n; d++) {
    columns[d] = transfer->dirichlet->data.dofs[i] + first + d;
    values[d]  = direction[d];
  }
  if (rows[0]) PetscCall(MatSetValues(rows[0], 1, &row[0], n, columns, values, INSERT_VALUES));
  if (!rows[1] || !set->opposite[i]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt begin = set->offsets[i]; begin < set->offsets[i + 1]; begin += SHARES_AT_ONCE) {
    PetscInt count = 0;

    for (PetscInt j = begin; j < PetscMin(begin + SHARES_AT_ONCE, set->offsets[i + 1]); j++)
      for (PetscInt d = 0; d < n; d++) {
        columns[count]  = set->shares[j].dof + first + d;
        values[count++] = direction[d] * set->shares[j].value;
      }
    PetscCall(MatSetValues(rows[1], 1, &row[1], count, columns, values, INSERT_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetValues - puts the rows of this rank into the matrices of both sides

  Not Collective

  Input Parameters:
+ transfer   - the `Transfer`, updated once at least
. begin      - global number of the first row of this rank in the matrix of the first side, and in that of the second
. components - 1: the normal gap, a row for each node; the space dimension: all components of sum_j P_ij u_j - u_i, as many rows for each
- rows       - the first gets the normal of the node, or the unit vectors, at its displacements; the second the same times the weights, at
               the displacements of the nodes opposite. Either may be `NULL`; the second is for obstacles

  Level: developer

  Notes:
  Assemble both afterwards; values that were there before must have been set to zero. Rows without anything opposite have entries on the
  Dirichlet side alone.

  A force f on the gap acts on the Neumann side as the transpose times f and on the Dirichlet side as its transpose times -f: both have
  the same resultant, since the weights sum to one, and the same moment about any point.

.seealso: `Transfer`
@*/
PetscErrorCode TransferSetValues(Transfer transfer, const PetscInt begin[2], PetscInt components, const Mat rows[2])
{
  const RowSet  *set = &transfer->rows;
  const PetscInt dim = transfer->dim;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCheck(components == 1 || components == dim, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "A row has 1 or %" PetscInt_FMT " components, not %" PetscInt_FMT, dim, components);
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt c = 0; c < components; c++) {
      const PetscInt  row[2] = {begin[0] + i * components + c, begin[1] + i * components + c};
      const PetscReal unit   = 1;

      if (components == 1) PetscCall(SetRow(transfer, i, row, 0, dim, set->normals + dim * i, rows));
      else PetscCall(SetRow(transfer, i, row, c, 1, &unit, rows));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetDirectedValues - puts rows of given directions into the matrices of both sides

  Not Collective

  Input Parameters:
+ transfer   - the `Transfer`, updated once at least
. begin      - global number of the first row of this rank in the matrix of the first side, and in that of the second
. components - rows of each node
. directions - of each row of this rank: 3 numbers, zeros beyond the space dimension
- rows       - as in `TransferSetValues()`, with these directions in place of the normal

  Level: developer

.seealso: `Transfer`, `TransferSetValues()`
@*/
PetscErrorCode TransferSetDirectedValues(Transfer transfer, const PetscInt begin[2], PetscInt components, const PetscReal directions[],
                                         const Mat rows[2])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt k = i * components; k < (i + 1) * components; k++) {
      const PetscInt row[2] = {begin[0] + k, begin[1] + k};

      PetscCall(SetRow(transfer, i, row, 0, transfer->dim, directions + 3 * k, rows));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetNeighbours - marks which rows belong to nodes of the Dirichlet side with an edge in common

  Collective

  Input Parameters:
+ transfer   - the `Transfer`
. row_begin  - global number of the first row of this rank
. components - rows of each node
. slope      - nodes whose gaps differ by more than this part of their distance are left out
- neighbours - all rows by all rows: gets ones where rows of one component of two such nodes meet

  Level: developer

  Note:
  Assemble it afterwards. In two dimensions edges are the faces themselves; in one dimension there are none.

.seealso: `Transfer`, `TransferSetValues()`
@*/
PetscErrorCode TransferSetNeighbours(Transfer transfer, PetscInt row_begin, PetscInt components, PetscReal slope, Mat neighbours)
{
  const Surface      surface = transfer->dirichlet;
  const SurfaceData *data    = &surface->data;
  const PetscInt     n       = data->face_nodes;
  PetscInt          *first;
  PetscReal         *gap;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCall(PetscMalloc2(data->n_nodes, &first, data->n_nodes, &gap));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    first[i] = row_begin + i * components;
    gap[i]   = transfer->rows.gap[i];
  }
  PetscCall(PetscSFBcastBegin(surface->sf, MPIU_REAL, gap, gap, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(surface->sf, MPIU_REAL, gap, gap, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(surface->sf, MPIU_INT, first, first, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(surface->sf, MPIU_INT, first, first, MPI_REPLACE));
  for (PetscInt f = 0; f < data->n_faces && n > 1; f++)
    for (PetscInt k = 0; k < n; k++) {
      const PetscInt   a = data->faces[f * n + k], b = data->faces[f * n + (k + 1) % n];
      const PetscReal *x = data->positions + 3 * a, *y = data->positions + 3 * b;
      const PetscReal  way[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};

      if (PetscAbsReal(gap[b] - gap[a]) / PetscSqrtReal(Dot(way, way)) > slope) continue;
      for (PetscInt c = 0; c < components; c++) {
        PetscCall(MatSetValue(neighbours, first[a] + c, first[b] + c, 1, INSERT_VALUES));
        PetscCall(MatSetValue(neighbours, first[b] + c, first[a] + c, 1, INSERT_VALUES));
      }
    }
  PetscCall(PetscFree2(first, gap));
  PetscFunctionReturn(PETSC_SUCCESS);
}
