/* Normals of rows: what they are made of, what they would be where surfaces are now, and by how much they differ from that. */
#include "interfaceimpl.h"

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
  if (!transfer->options.curved) {
    for (PetscInt d = 0; d < transfer->dim; d++) normal[d] = transfer->dirichlet->data.normals[3 * row + d];
    return;
  }
  for (PetscInt j = 0; j < PetscMin(n, FOLLOW_MAX); j++) {
    normals[j] = transfer->column_normals + 3 * set->columns[first + j];
    weights[j] = set->shares[first + j].value;
  }
  RowNormal(transfer->dim, PetscMin(n, FOLLOW_MAX), transfer->options.share, transfer->dirichlet->data.normals + 3 * row, normals, weights,
            normal);
}

/* Angle from the normal of each row of this rank to that where the surfaces are now [rad], 0 where nothing is opposite */
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
