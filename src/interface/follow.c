/*
   Rows that follow the surfaces between two builds.

   A force along a row has the same moment on both sides if sum_j P_ij x_j - x_i is along the normal n_i where the force acts: at the end of
   the controller step. So the normal becomes that of the surface there, and the weights follow the slip, see RowCorrect(), with the
   positions to which the present velocities lead. What is left of the moment is of second order in the step.

   The gap goes on from where it was. With rows B_0 of the last step and B of this one, and the way dx that is expected, the gap that the
   step begins with is

     gap - 1/2 (B - B_0) dx,

   so that in the step it changes by 1/2 (B_0 + B) dx, the trapezoidal rule for the path of the gap. Then what forces do along rows that
   change, 1/2 (f_0 B_0 + f B) dx in a closed gap, adds up to nothing but for terms of second order in the step.
*/
#include "interfaceimpl.h"

/* What a row makes of positions of the nodes: n . (sum_j P_j x_j - x) [m] */
static PetscReal RowOf(Transfer transfer, PetscInt row, const PetscReal x[], const PetscReal columns[])
{
  const RowSet    *set    = &transfer->rows;
  const PetscReal *normal = set->normals + transfer->dim * row;
  PetscReal        gap    = 0;

  for (PetscInt d = 0; d < transfer->dim; d++) {
    PetscReal offset = -x[3 * row + d];

    for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
      offset += set->shares[j].value * columns[3 * set->columns[j] + d];
    gap += normal[d] * offset;
  }
  return gap;
}

/* The part of sum_j P_j x_j - x across the normal [m] */
static void AcrossOf(Transfer transfer, PetscInt row, const PetscReal x[], const PetscReal columns[], PetscReal across[])
{
  const RowSet    *set    = &transfer->rows;
  const PetscReal *normal = set->normals + transfer->dim * row, gap = RowOf(transfer, row, x, columns);

  for (PetscInt d = 0; d < transfer->dim; d++) {
    across[d] = -x[3 * row + d] - gap * normal[d];
    for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
      across[d] += set->shares[j].value * columns[3 * set->columns[j] + d];
  }
}

/* New normal and weights of a row, and the gap without displacements that has its gap go on */
static PetscErrorCode FollowRow(Transfer transfer, PetscInt row)
{
  const SurfaceData *data = &transfer->dirichlet->data;
  RowSet            *set = &transfer->rows;
  const PetscInt     first = set->offsets[row], n = set->offsets[row + 1] - first, dim = transfer->dim;
  const PetscReal   *now = transfer->follow_x, *next = data->positions, *columns[3] = {transfer->column_reference, transfer->column_x, transfer->column_next};
  const PetscReal   *partners[FOLLOW_MAX];
  PetscReal          weights[FOLLOW_MAX], gap, way, before[3] = {0}, after[3] = {0}, slip[3] = {0}, rest, part;

  PetscFunctionBegin;
  gap = set->gap[row] + RowOf(transfer, row, now, columns[1]) - RowOf(transfer, row, data->reference, columns[0]);
  way = RowOf(transfer, row, next, columns[2]) - RowOf(transfer, row, now, columns[1]);
  AcrossOf(transfer, row, now, columns[1], before);
  AcrossOf(transfer, row, next, columns[2], slip);
  rest           = PetscMax(set->rest[row] - PetscSqrtReal(Dot(slip, slip)) / (transfer->slip_bound * data->sizes[row]), 0);
  part           = set->rest[row] > 0 ? 1 - rest / set->rest[row] : 0;
  set->rest[row] = rest;
  for (PetscInt d = 0; d < dim; d++) set->normals[dim * row + d] = data->normals[3 * row + d];
  for (PetscInt j = 0; j < n; j++) partners[j] = columns[2] + 3 * set->columns[first + j];
  if (part > 0) {
    for (PetscInt j = 0; j < n; j++) weights[j] = set->shares[first + j].goal;
    RowCorrect(dim, n, next + 3 * row, data->normals + 3 * row, partners, data->sizes[row], weights);
    for (PetscInt j = 0; j < n; j++) set->shares[first + j].goal = weights[j];
  }
  for (PetscInt j = 0; j < n; j++) weights[j] = set->shares[first + j].value + part * (set->shares[first + j].goal - set->shares[first + j].value);
  for (PetscInt pass = 0; pass < 2; pass++)
    RowCorrect(dim, n, next + 3 * row, data->normals + 3 * row, partners, data->sizes[row], weights); /* twice for round-off */
  for (PetscInt j = 0; j < n; j++) set->shares[first + j].value = weights[j];
  way = RowOf(transfer, row, next, columns[2]) - RowOf(transfer, row, now, columns[1]) - way;
  set->gap[row] = gap - 0.5 * way - RowOf(transfer, row, now, columns[1]) + RowOf(transfer, row, data->reference, columns[0]);
  /* slips are counted from the last build on */
  AcrossOf(transfer, row, now, columns[1], after);
  for (PetscInt d = 0; d < dim; d++) transfer->built_slip[3 * row + d] += after[d] - before[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gap of a row where the surfaces are now [m] */
static PetscReal PresentGap(Transfer transfer, PetscInt row)
{
  const SurfaceData *data = &transfer->dirichlet->data;

  return transfer->rows.gap[row] + RowOf(transfer, row, data->positions, transfer->column_x) -
         RowOf(transfer, row, data->reference, transfer->column_reference);
}

/* Marks rows that are to follow: those of nodes that touch, or may within the reach. Rows with more partners than usual have little slip
   in parts of them. */
static PetscErrorCode MarkFollowers(Transfer transfer, const PetscBool touches[], PetscReal reach, PetscBool *any)
{
  const RowSet *set   = &transfer->rows;
  int           found = 0;

  PetscFunctionBegin;
  PetscCall(TransferGetColumns(transfer, transfer->neumann->data.positions, transfer->column_x));
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscInt n = set->offsets[row + 1] - set->offsets[row];

    transfer->followed[row] = (PetscBool)(set->opposite[row] && n <= FOLLOW_MAX &&
                                          (touches[row] || PresentGap(transfer, row) <= reach));
    if (transfer->followed[row]) found = 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, &found, 1, MPI_INT, MPI_MAX, transfer->comm));
  *any = (PetscBool)found;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferFollow - lets rows near contact follow the surfaces, without building them again

  Collective

  Input Parameters:
+ transfer    - the `Transfer`, between two surfaces, after `TransferUpdate()`
. touches     - for each row of this rank, whether it is in contact
. reach       - other rows follow if their gap is not larger than that [m]
. u_dirichlet - displacements that the body of the Dirichlet side is expected to have where the force acts
- u_neumann   - of the Neumann side

  Output Parameter:
. any - whether any row on any rank has followed; which, `TransferRows` tells

  Level: developer

  Notes:
  The normal becomes that of the surface in these displacements. The weights of the partner's nodes are changed as little as possible so
  that a force along the normal has no moment there. The gap goes on from where it was.

  Surfaces are left in these displacements, until the next `TransferUpdate()`.

.seealso: `Transfer`, `TransferUpdate()`, `TransferRows`
@*/
PetscErrorCode TransferFollow(Transfer transfer, const PetscBool touches[], PetscReal reach, Vec u_dirichlet, Vec u_neumann, PetscBool *any)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(transfer, reach, 3);
  PetscValidHeaderSpecific(u_dirichlet, VEC_CLASSID, 4);
  PetscValidHeaderSpecific(u_neumann, VEC_CLASSID, 5);
  PetscAssertPointer(any, 6);
  PetscCheck(transfer->built && transfer->neumann && transfer->dim > 1, transfer->comm, PETSC_ERR_ARG_WRONGSTATE,
             "Only rows between two surfaces in two or three dimensions follow, after TransferUpdate()");
  PetscCall(MarkFollowers(transfer, touches, reach, any));
  if (!*any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(transfer->follow_x, transfer->dirichlet->data.positions, 3 * transfer->n));
  PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
  PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
  PetscCall(TransferGetColumns(transfer, transfer->neumann->data.positions, transfer->column_next));
  for (PetscInt row = 0; row < transfer->n; row++)
    if (transfer->followed[row]) PetscCall(FollowRow(transfer, row));
  PetscFunctionReturn(PETSC_SUCCESS);
}
