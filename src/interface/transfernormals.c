/* Normals of rows: what they are made of, what they would be where surfaces are now, and by how much they differ from that. */
#include "interfaceimpl.h"

/* Whether rows take the bend of both surfaces into account, before the first update. If so, the normal of a row is between that of its
   node and those of the partner opposite, half way unless TransferSetNormalShare() says otherwise, and its gap is counted to a surface
   of second order that has the normals of the partner's nodes. Then it hardly matters which surface has the nodes of the rows. Where
   normals differ by more than 26 degrees, which is an edge, the row is as it is otherwise. */
PetscErrorCode TransferSetCurved(Transfer transfer, PetscBool curved)
{
  PetscFunctionBegin;
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  transfer->curved = curved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How much of the normal of a row is that of the partner, from 0 to 1, where rows take bends into account. Where two curved surfaces are
   pressed flat on each other, each gives way in proportion to its compliance: what is flat then has a slope between those of both,
   closer to that of the stiffer one (Johnson 1985, section 4.2). With moduli E1 of the side with the nodes and E2 of the partner the
   share is E2 / (E1 + E2). */
PetscErrorCode TransferSetNormalShare(Transfer transfer, PetscReal share)
{
  PetscFunctionBegin;
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  PetscCheck(share >= 0 && share <= 1, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE, "The share %g of the partner's normals is not from 0 to 1",
             (double)share);
  transfer->share = share;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The normal that a row would have now */
void TransferPresentNormal(Transfer transfer, PetscInt row, PetscReal normal[])
{
  const RowSet    *set   = &transfer->rows;
  const PetscInt   first = set->offsets[row], n = set->offsets[row + 1] - first;
  const PetscReal *normals[FOLLOW_MAX];
  PetscReal        weights[FOLLOW_MAX], partner[3];

  if (transfer->neumann && RowPartnerNormal(transfer->dirichlet, set, row, transfer->column_x, partner)) {
    for (PetscInt d = 0; d < transfer->dim; d++) normal[d] = -partner[d];
    return;
  }
  if (!transfer->curved) {
    for (PetscInt d = 0; d < transfer->dim; d++) normal[d] = transfer->dirichlet->data.normals[3 * row + d];
    return;
  }
  for (PetscInt j = 0; j < PetscMin(n, FOLLOW_MAX); j++) {
    normals[j] = transfer->column_normals + 3 * set->columns[first + j];
    weights[j] = set->shares[first + j].value;
  }
  RowNormal(transfer->dim, PetscMin(n, FOLLOW_MAX), transfer->share, transfer->dirichlet->data.normals + 3 * row, normals, weights, normal);
}

/* By how much the normal of each row of this rank differs from that which it would have where the surfaces are [rad], 0 where nothing is
   opposite */
PetscErrorCode TransferGetTilts(Transfer transfer, PetscReal tilts[])
{
  const SurfaceData *data = &transfer->dirichlet->data;
  const PetscInt     dim  = transfer->dim;

  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCall(PetscArrayzero(tilts, transfer->n));
  if (transfer->idle || dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  if (transfer->neumann) {
    PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
    PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->smooth, transfer->column_normals));
  }
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscReal *normal = transfer->rows.normals + dim * row;
    PetscReal        present[3], distance, chord = 0;

    if (!transfer->rows.opposite[row]) continue;
    if (transfer->neumann) TransferPresentNormal(transfer, row, present);
    else {
      PetscCall(ObstacleGetGap(transfer->obstacle, data->positions + 3 * row, &distance, present));
      for (PetscInt d = 0; d < dim; d++) present[d] = -present[d];
    }
    for (PetscInt d = 0; d < dim; d++) chord += PetscSqr(present[d] - normal[d]);
    tilts[row] = 2 * PetscAsinReal(PetscMin(1, 0.5 * PetscSqrtReal(chord)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
