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

static PetscErrorCode GetObstacleDrift(Transfer transfer, PetscReal drift[], PetscReal turn[])
{
  const SurfaceData *data = &transfer->dirichlet->data;

  PetscFunctionBegin;
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscReal *normal = transfer->rows.normals + transfer->dim * row, *x = data->positions + 3 * row;
    PetscReal        gradient[3], chord                                        = 0;

    if (!transfer->rows.opposite[row]) continue;
    PetscCall(ObstacleGetGap(transfer->obstacle, x, &drift[row], gradient));
    drift[row] -= transfer->rows.gap[row];
    for (PetscInt d = 0; d < transfer->dim; d++) {
      drift[row] += normal[d] * (x[d] - data->reference[3 * row + d]);
      chord += PetscSqr(gradient[d] + normal[d]);
    }
    turn[row] = 2 * PetscAsinReal(PetscMin(1, 0.5 * PetscSqrtReal(chord)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far rows are off from new ones where the surfaces are: for each row of this rank the difference of gaps, 0 where nothing is opposite
   [m], and the angle between the normals, of rows against an obstacle [rad]. In two or three dimensions; u_neumann NULL: an obstacle */
PetscErrorCode TransferGetDrift(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal drift[], PetscReal turn[])
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(drift, transfer->n));
  PetscCall(PetscArrayzero(turn, transfer->n));
  if (transfer->idle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
  if (transfer->obstacle) {
    PetscCall(GetObstacleDrift(transfer, drift, turn));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
  PetscCall(GetNewGaps(transfer, u_dirichlet, u_neumann, drift));
  PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
  for (PetscInt row = 0; row < transfer->n; row++)
    drift[row] = transfer->rows.opposite[row] && drift[row] < PETSC_MAX_REAL ? drift[row] - TransferPresentGap(transfer, row) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
