/* How far the rows of a transfer are off from those that would be built where the surfaces are now. */
#include "interfaceimpl.h"

/* Gaps of rows that are built where the surfaces are, without taking them; PETSC_MAX_REAL: nothing lies opposite */
static PetscErrorCode GetNewGaps(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal gaps[])
{
  const RowSet kept = transfer->rows;
  PetscReal    reach;

  PetscFunctionBegin;
  PetscCall(RowSetAllocate(transfer->dim, transfer->n, 0, &transfer->rows));
  PetscCall(PetscArrayzero(transfer->keep, transfer->n));
  PetscCall(PetscArrayzero(transfer->goes_on, transfer->n));
  PetscCall(TransferGetReach(transfer, 0, &reach));
  PetscCall(TransferBuildRows(transfer, u_dirichlet, u_neumann, reach));
  PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
  for (PetscInt row = 0; row < transfer->n; row++)
    gaps[row] = transfer->rows.opposite[row] ? TransferPresentGap(transfer, row) : PETSC_MAX_REAL;
  PetscCall(RowSetDestroy(&transfer->rows));
  transfer->rows = kept;
  PetscCall(TransferSetUpColumns(transfer, &transfer->rows, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far rows are off from new ones where the surfaces are: for each row of this rank the difference of gaps, 0 where nothing is opposite
   [m], and the angle between the normals, of rows against an obstacle [rad]. In two or three dimensions; u_neumann NULL: an obstacle */
PetscErrorCode TransferGetDrift(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal drift[], PetscReal turn[])
{
  PetscReal normal[3];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(drift, transfer->n));
  PetscCall(PetscArrayzero(turn, transfer->n));
  if (transfer->idle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
  if (transfer->neumann) {
    PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
    PetscCall(GetNewGaps(transfer, u_dirichlet, u_neumann, drift));
    PetscCall(TransferBringColumns(transfer));
  } else {
    PetscCall(TransferGetTilts(transfer, turn));
    for (PetscInt row = 0; row < transfer->n; row++)
      PetscCall(ObstacleGetGap(transfer->obstacle, transfer->dirichlet->data.positions + 3 * row, &drift[row], normal));
  }
  for (PetscInt row = 0; row < transfer->n; row++)
    drift[row] = transfer->rows.opposite[row] && drift[row] < PETSC_MAX_REAL ? drift[row] - TransferPresentGap(transfer, row) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
