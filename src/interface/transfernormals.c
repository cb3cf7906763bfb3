/* Normals of rows: what they are made of, what they would be where surfaces are now, and by how much they differ from that. */
#include "interfaceimpl.h"

static PetscErrorCode FindNormal(Transfer transfer, PetscInt row, PetscReal normal[])
{
  const RowSet    *set   = &transfer->rows;
  const PetscInt   first = set->offsets[row], n = set->offsets[row + 1] - first;
  const PetscReal *normals[FOLLOW_MAX];
  PetscReal        weights[FOLLOW_MAX], partner[3], distance;

  PetscFunctionBegin;
  if (transfer->obstacle) PetscCall(ObstacleGetGap(transfer->obstacle, transfer->dirichlet->data.positions + 3 * row, &distance, partner));
  if (transfer->obstacle || RowPartnerNormal(transfer->dirichlet, set, row, transfer->column_x, partner)) {
    for (PetscInt d = 0; d < transfer->dim; d++) normal[d] = -partner[d];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!transfer->options.curved) {
    PetscCall(PetscArraycpy(normal, transfer->dirichlet->data.normals + 3 * row, transfer->dim));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt j = 0; j < PetscMin(n, FOLLOW_MAX); j++) {
    normals[j] = transfer->column_normals + 3 * set->columns[first + j];
    weights[j] = set->shares[first + j].value;
  }
  RowNormal(transfer->dim, PetscMin(n, FOLLOW_MAX), transfer->options.share, transfer->dirichlet->data.normals + 3 * row, normals, weights,
            normal);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The normal that a row would have now, and the square of the chord of the angle by which its own differs */
PetscErrorCode TransferPresentNormal(Transfer transfer, PetscInt row, PetscReal normal[], PetscReal *square)
{
  PetscFunctionBegin;
  PetscCall(FindNormal(transfer, row, normal));
  *square = 0;
  for (PetscInt d = 0; d < transfer->dim; d++) *square += PetscSqr(normal[d] - transfer->rows.normals[transfer->dim * row + d]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings positions and normals of the partner's nodes, where these are now, to the ranks whose rows name them */
PetscErrorCode TransferBringColumns(Transfer transfer)
{
  PetscFunctionBegin;
  if (!transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
  PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->smooth, transfer->column_normals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Angle from the normal of each row of this rank to that where the surfaces are now [rad], 0 where nothing is opposite */
PetscErrorCode TransferGetTilts(Transfer transfer, PetscReal tilts[])
{
  PetscFunctionBegin;
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCall(PetscArrayzero(tilts, transfer->n));
  if (transfer->idle || transfer->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TransferBringColumns(transfer));
  for (PetscInt row = 0; row < transfer->n; row++) {
    PetscReal present[3], square;

    if (!transfer->rows.opposite[row]) continue;
    PetscCall(TransferPresentNormal(transfer, row, present, &square));
    tilts[row] = 2 * PetscAsinReal(PetscMin(1, 0.5 * PetscSqrtReal(square)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
