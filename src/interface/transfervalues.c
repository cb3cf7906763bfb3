/* The rows of a transfer as entries of matrices. */
#include "interfaceimpl.h"

/* Shares of a row whose entries go into a matrix together */
#define SHARES_AT_ONCE 32

/* Entries of a row of each node of this rank, along its normal or another direction, in both matrices; `second` NULL for obstacles */
PetscErrorCode TransferCountValues(Transfer transfer, PetscInt first[], PetscInt second[])
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  for (PetscInt i = 0; i < transfer->n; i++) {
    first[i] = transfer->dim;
    if (second) second[i] = set->opposite[i] ? transfer->dim * (set->offsets[i + 1] - set->offsets[i]) : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Entries of a row of node i at once, for speed: n components of a direction, the first along axis `first` */
static PetscErrorCode SetRow(Transfer transfer, PetscInt i, const PetscInt row[2], PetscInt first, PetscInt n, const PetscReal direction[],
                             const Mat rows[2])
{
  const RowSet *set = &transfer->rows;
  PetscInt      columns[3 * SHARES_AT_ONCE];
  PetscScalar   values[3 * SHARES_AT_ONCE];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < n; d++) {
    columns[d] = transfer->dirichlet->data.dofs[i] + first + d;
    values[d]  = -direction[d];
  }
  if (rows[0]) PetscCall(MatSetValues(rows[0], 1, &row[0], n, columns, values, ADD_VALUES));
  if (!rows[1] || !set->opposite[i]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt begin = set->offsets[i]; begin < set->offsets[i + 1]; begin += SHARES_AT_ONCE) {
    PetscInt count = 0;

    for (PetscInt j = begin; j < PetscMin(begin + SHARES_AT_ONCE, set->offsets[i + 1]); j++)
      for (PetscInt d = 0; d < n; d++) {
        columns[count]  = set->shares[j].dof + first + d;
        values[count++] = direction[d] * set->shares[j].value;
      }
    PetscCall(MatSetValues(rows[1], 1, &row[1], count, columns, values, ADD_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the rows of this rank to the matrices of both sides, which are zero, may be one, and are assembled afterwards. `begin`: global
   numbers of the first row of this rank in both matrices; `directions`: of each row 3 numbers, or NULL: with one component the normals of
   the rows, else the unit vectors, so that sum_j P_ij u_j - u_i has as many rows as components. The first matrix gets the direction times
   -1 at the displacements of the node, the second one the direction times the weights, at those of the nodes opposite: a gap is the sum of
   both products. Either may be NULL. A force f on the gap acts on each side as the transpose times f: sum and moment of both are zero. */
PetscErrorCode TransferSetValues(Transfer transfer, const PetscInt begin[2], PetscInt components, const PetscReal directions[],
                                 const Mat rows[2])
{
  const RowSet   *set = &transfer->rows;
  const PetscInt  dim = transfer->dim;
  const PetscReal one = 1;

  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCheck(components == 1 || components == dim, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "A row has 1 or %" PetscInt_FMT " components, not %" PetscInt_FMT, dim, components);
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt c = 0; c < components; c++) {
      const PetscInt k = i * components + c, row[2] = {begin[0] + k, begin[1] + k};

      if (directions) PetscCall(SetRow(transfer, i, row, 0, dim, directions + 3 * k, rows));
      else if (components == 1) PetscCall(SetRow(transfer, i, row, 0, dim, set->normals + dim * i, rows));
      else PetscCall(SetRow(transfer, i, row, c, 1, &one, rows));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks which rows belong to nodes of the Dirichlet side with an edge in common: `neighbours`, all rows by all rows, to be assembled
   afterwards, gets ones where rows of one component of two such nodes meet, unless their gaps differ by more than `slope` of their
   distance. In one dimension there are none. */
PetscErrorCode TransferSetNeighbours(Transfer transfer, PetscInt row_begin, PetscInt components, PetscReal slope, Mat neighbours)
{
  const Surface      surface = transfer->dirichlet;
  const SurfaceData *data    = &surface->data;
  const PetscInt     n       = data->face_nodes;
  PetscInt          *first;
  PetscReal         *gap;

  PetscFunctionBegin;
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
