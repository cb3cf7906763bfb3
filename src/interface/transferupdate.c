/* When the rows of a transfer are built again. */
#include "interfaceimpl.h"

/* Partners are known up to this number of face sizes beyond the closest one */
#define FACES_AHEAD 4

/* How far apart the positions at the last build and now are at most, and their sum: of the nodes that this rank owns */
static void SumMotion(const SurfaceData *data, const PetscReal built[], PetscReal sums[])
{
  for (PetscInt i = 0; i < 3 * data->n_owned; i++) sums[i % 3] += data->positions[i] - built[i];
  sums[3] += data->n_owned;
}

static PetscReal LargestMotion(const SurfaceData *data, const PetscReal built[], const PetscReal mean[])
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < data->n_owned; i++) {
    PetscReal square = 0;

    for (PetscInt d = 0; d < 3; d++) square += PetscSqr(data->positions[3 * i + d] - built[3 * i + d] - mean[d]);
    largest = PetscMax(largest, square);
  }
  return PetscSqrtReal(largest);
}

/* How far the nodes of either side that this rank has are from where they were at the last build at most, but for what all have moved
   together */
static PetscErrorCode GetMotion(Transfer transfer, PetscReal largest[])
{
  const SurfaceData *data[2] = {&transfer->dirichlet->data, transfer->neumann ? &transfer->neumann->data : NULL};
  PetscReal          sums[4] = {0}, mean[3] = {0};

  PetscFunctionBegin;
  if (data[1]) { /* a common translation changes nothing; an obstacle stays where it is */
    for (PetscInt side = 0; side < 2; side++) SumMotion(data[side], transfer->built_x[side], sums);
    PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 4, MPIU_REAL, MPIU_SUM, transfer->comm));
    for (PetscInt d = 0; d < 3; d++) mean[d] = sums[3] > 0 ? sums[d] / sums[3] : 0;
  }
  for (PetscInt side = 0; side < 2; side++) largest[side] = data[side] ? LargestMotion(data[side], transfer->built_x[side], mean) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sum_j P_ij x_j - x_i at present */
static void GetOffset(Transfer transfer, PetscInt row, PetscReal offset[])
{
  const RowSet    *set = &transfer->rows;
  const PetscReal *x   = transfer->dirichlet->data.positions + 3 * row;

  for (PetscInt d = 0; d < 3; d++) {
    offset[d] = -x[d];
    for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
      offset[d] += set->shares[j].value * transfer->column_x[3 * set->columns[j] + d];
  }
}

static void SplitOffset(PetscInt dim, const PetscReal normal[], PetscReal offset[], PetscReal *gap)
{
  *gap = 0;
  for (PetscInt d = 0; d < dim; d++) *gap += offset[d] * normal[d];
  for (PetscInt d = 0; d < dim; d++) offset[d] -= *gap * normal[d];
}

static PetscErrorCode GetColumnPositions(Transfer transfer)
{
  PetscFunctionBegin;
  PetscCall(PetscSFBcastBegin(transfer->rows.vectors, MPIU_REAL, transfer->neumann->data.positions, transfer->column_x, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(transfer->rows.vectors, MPIU_REAL, transfer->neumann->data.positions, transfer->column_x, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a row of this rank near contact has slipped or turned beyond the bounds */
static PetscErrorCode HasSlipped(Transfer transfer, PetscBool *slipped)
{
  const SurfaceData *data = &transfer->dirichlet->data;
  const PetscInt     dim  = transfer->dim;
  const PetscReal    turn = 2 * PetscSinReal(transfer->angle_bound / 2); /* chord of the angle */

  PetscFunctionBegin;
  *slipped = PETSC_FALSE;
  if (transfer->neumann) PetscCall(GetColumnPositions(transfer));
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscReal *normal = transfer->rows.normals + dim * row, *present = data->normals + 3 * row, size = data->sizes[row];
    PetscReal        offset[3], gap, slip = 0, turned = 0, gradient[3];
    PetscBool        within;

    transfer->keep[row] = PETSC_FALSE;
    transfer->slip[row] = 0;
    if (!transfer->rows.opposite[row]) continue;
    if (transfer->neumann) {
      GetOffset(transfer, row, offset);
      SplitOffset(dim, normal, offset, &gap);
      for (PetscInt d = 0; d < dim; d++) slip += PetscSqr(offset[d] - transfer->built_slip[3 * row + d]);
      for (PetscInt d = 0; d < dim; d++) turned += PetscSqr(present[d] - normal[d]);
      transfer->slip[row] = PetscSqrtReal(slip) / size;
    } else {
      PetscCall(ObstacleGetGap(transfer->obstacle, data->positions + 3 * row, &gap, gradient));
      for (PetscInt d = 0; d < dim; d++) turned += PetscSqr(gradient[d] + normal[d]);
    }
    if (PetscAbsReal(gap) >= 2 * size) continue;
    within              = (PetscBool)(slip <= PetscSqr(transfer->slip_bound * size) && turned <= turn * turn);
    transfer->keep[row] = within;
    if (!within) *slipped = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the surfaces have moved so far relative to each other since the last build that other faces may lie opposite, or along each other
   beyond the bounds, on any rank */
static PetscErrorCode HasMoved(Transfer transfer, PetscBool *moved)
{
  PetscReal largest[3]; /* motions of both sides, slip */
  PetscBool slipped;

  PetscFunctionBegin;
  *moved = PETSC_FALSE;
  if (transfer->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetMotion(transfer, largest));
  PetscCall(HasSlipped(transfer, &slipped));
  largest[2] = slipped;
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, largest, 3, MPIU_REAL, MPIU_MAX, transfer->comm));
  *moved = (PetscBool)(largest[0] + largest[1] > 0.25 * transfer->smallest_size || largest[2] > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the next updates compare with */
static PetscErrorCode Remember(Transfer transfer, PetscReal near)
{
  const SurfaceData *data[2] = {&transfer->dirichlet->data, transfer->neumann ? &transfer->neumann->data : NULL};
  PetscReal          size    = PETSC_MAX_REAL;

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++) {
    if (!data[side]) continue;
    PetscCall(PetscArraycpy(transfer->built_x[side], data[side]->positions, 3 * data[side]->n_owned));
    for (PetscInt i = 0; i < data[side]->n_owned; i++) size = PetscMin(size, data[side]->sizes[i]);
  }
  PetscCallMPI(MPIU_Allreduce(&size, &transfer->smallest_size, 1, MPIU_REAL, MPIU_MIN, transfer->comm));
  if (transfer->neumann) {
    PetscCall(GetColumnPositions(transfer));
    for (PetscInt row = 0; row < transfer->n; row++) {
      PetscReal gap;

      if (transfer->keep[row]) continue; /* its slip goes on from where it was */
      GetOffset(transfer, row, transfer->built_slip + 3 * row);
      SplitOffset(transfer->dim, transfer->rows.normals + transfer->dim * row, transfer->built_slip + 3 * row, &gap);
    }
  }
  transfer->built      = PETSC_TRUE;
  transfer->built_near = near;
  transfer->counts.builds++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far to look ahead: at least as far as is wanted, and as far as the boxes about both surfaces are apart and some faces more, so that
   what is closest is known at all times; faces further away need not be sent to other ranks */
static PetscErrorCode GetReach(Transfer transfer, PetscReal near, PetscReal *reach)
{
  const SurfaceData *data[2] = {&transfer->dirichlet->data, transfer->neumann ? &transfer->neumann->data : NULL};
  PetscReal          corners[13], square = 0; /* for each side the upper corner and the negative of the lower one; the largest face */

  PetscFunctionBegin;
  *reach = near;
  if (near == PETSC_MAX_REAL || !data[1]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 13; k++) corners[k] = -PETSC_MAX_REAL;
  for (PetscInt side = 0; side < 2; side++)
    for (PetscInt i = 0; i < data[side]->n_owned; i++) {
      for (PetscInt d = 0; d < 3; d++) {
        corners[6 * side + d]     = PetscMax(corners[6 * side + d], data[side]->positions[3 * i + d]);
        corners[6 * side + 3 + d] = PetscMax(corners[6 * side + 3 + d], -data[side]->positions[3 * i + d]);
      }
      corners[12] = PetscMax(corners[12], data[side]->sizes[i]);
    }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, corners, 13, MPIU_REAL, MPIU_MAX, transfer->comm));
  for (PetscInt d = 0; d < 3; d++)
    square += PetscSqr(PetscMax(0, PetscMax(-corners[3 + d] - corners[6 + d], -corners[9 + d] - corners[d])));
  *reach = PetscMax(near, PetscSqrtReal(square) + FACES_AHEAD * corners[12]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferUpdate - moves both surfaces to where they are, and builds the rows again where that is needed

  Collective

  Input Parameters:
+ transfer    - the `Transfer`
. u_dirichlet - displacements of the body of the Dirichlet side; `NULL`: none
. u_neumann   - of the Neumann side; `NULL`: none, or an obstacle
- near        - partners at least this close must be known; `PETSC_MAX_REAL`: at any distance [m]

  Output Parameter:
. rebuilt - whether the rows have been built, which the first call always does

  Level: developer

  Notes:
  The rows are built again when one with a gap of less than two face sizes has slipped by more than the bound, or its normal has turned by
more than the bound; when the surfaces have moved by more than a quarter of the smallest face relative to each other, so that other faces
may lie opposite; and when `near` exceeds that of the last build. Between builds a normal stays as it was, and in a build rows near contact
stay as they are that are within both bounds: each change of a row costs a little energy. In one dimension they are built once.

  A build looks ahead of a node as far as is wanted, and as far as the boxes about both surfaces are apart and four faces more; behind it,
as far as the two bodies can overlap at all.

.seealso: `Transfer`, `TransferSetBounds()`, `TransferGetRows()`
@*/
PetscErrorCode TransferUpdate(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal near, PetscBool *rebuilt)
{
  PetscReal reach;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  if (u_dirichlet) PetscValidHeaderSpecific(u_dirichlet, VEC_CLASSID, 2);
  if (u_neumann) PetscValidHeaderSpecific(u_neumann, VEC_CLASSID, 3);
  PetscValidLogicalCollectiveReal(transfer, near, 4);
  PetscAssertPointer(rebuilt, 5);
  PetscCheck(near >= 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE, "Partners are looked for within %g m, which must not be negative",
             (double)near);
  PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
  if (transfer->neumann) PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
  *rebuilt = (PetscBool)(!transfer->built || near > transfer->built_near);
  PetscCall(PetscArrayzero(transfer->keep, transfer->n));
  if (!*rebuilt) PetscCall(HasMoved(transfer, rebuilt));
  if (!*rebuilt) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetReach(transfer, near, &reach));
  if (transfer->neumann) PetscCall(TransferBuildRows(transfer, u_dirichlet, u_neumann, reach));
  else PetscCall(TransferBuildObstacleRows(transfer, reach));
  PetscCall(Remember(transfer, reach));
  PetscFunctionReturn(PETSC_SUCCESS);
}
