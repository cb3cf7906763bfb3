/* When the rows of a transfer are built again. */
#include "interfaceimpl.h"
#include "obstacleimpl.h"

/* Partners are known so far beyond the closest one [edges of the largest face]: bodies that come closer need no new rows in each step */
#define FACES_AHEAD 4
/* Rows with a smaller gap are near contact: slips and turns beyond the bounds have them built again [edges of the face] */
#define NEAR_CONTACT 2
/* Motion relative to the partner since the last build after which other faces may lie opposite [edges of the smallest face] */
#define FAR_MOTION 0.25

/* Whether a row of this rank near contact has slipped or turned beyond the bounds. Marks those that have not, and notes all slips. */
static PetscErrorCode HasSlipped(Transfer transfer, PetscBool *slipped)
{
  const SurfaceData *data = &transfer->dirichlet->data;
  const PetscInt     dim  = transfer->dim;
  const PetscReal    turn = 2 * PetscSinReal(transfer->options.angle_bound / 2); /* chord of the angle */

  PetscFunctionBegin;
  *slipped = PETSC_FALSE;
  PetscCall(TransferBringColumns(transfer));
  for (PetscInt k = 0; k < (transfer->some_near ? transfer->n_near : transfer->n); k++) {
    const PetscInt  row  = transfer->some_near ? transfer->near[k] : k;
    const PetscReal size = data->sizes[row];
    PetscReal       offset[3], gap, slip = 0, turned, present[3];
    PetscBool       within;

    transfer->keep[row] = PETSC_FALSE;
    transfer->slip[row] = 0;
    if (!transfer->rows.opposite[row]) continue;
    if (transfer->neumann) {
      gap = TransferSplitRow(transfer, &transfer->rows, row, data->positions, transfer->column_x, offset);
      for (PetscInt d = 0; d < dim; d++) slip += PetscSqr(offset[d] - transfer->built_slip[3 * row + d]);
      transfer->slip[row] = PetscSqrtReal(slip) / size;
    } else gap = TransferPresentGap(transfer, row);
    if (PetscAbsReal(gap) >= NEAR_CONTACT * size) continue; /* of most rows the normals do not matter */
    PetscCall(TransferPresentNormal(transfer, row, present, &turned));
    within              = (PetscBool)(slip <= PetscSqr(transfer->options.slip_bound * size) && turned <= turn * turn);
    transfer->keep[row] = within;
    if (!within) *slipped = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows neither slip nor turn, so that the motion alone says when they are built again */
static PetscBool IsFlat(Transfer transfer)
{
  return (PetscBool)(!transfer->neumann && transfer->obstacle->type == OBSTACLE_PLANE);
}

/* Notes the positions and slips that the next updates compare with; `near` is how far partners are known [m] */
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
  PetscCallMPI(MPIU_Allreduce(&size, &transfer->numbers.smallest_size, 1, MPIU_REAL, MPIU_MIN, transfer->comm));
  if (transfer->neumann) {
    PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
    for (PetscInt row = 0; row < transfer->n; row++) /* the slip of rows that are kept is still counted from their own last build */
      if (!transfer->keep[row])
        (void)TransferSplitRow(transfer, &transfer->rows, row, transfer->dirichlet->data.positions, transfer->column_x,
                               transfer->built_slip + 3 * row);
  }
  transfer->built        = PETSC_TRUE;
  transfer->numbers.near = near;
  transfer->builds++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far ahead of a node to look for partners [m]: at least as far as the caller wants, and some faces further than the distance of the
   boxes about both surfaces, so that the closest partner is always known. Faces further away are not sent to other ranks. */
PetscErrorCode TransferGetReach(Transfer transfer, PetscReal near, PetscReal *reach)
{
  const SurfaceData *data[2]   = {&transfer->dirichlet->data, transfer->neumann ? &transfer->neumann->data : NULL};
  PetscReal          boxes[13] = {0}; /* of both sides; then the largest face with its sign changed */

  PetscFunctionBegin;
  *reach = near;
  if (near == PETSC_MAX_REAL || !data[1]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2; side++) {
    BoxFind(data[side]->n_owned, data[side]->positions, boxes + 6 * side);
    for (PetscInt i = 0; i < data[side]->n_owned; i++) boxes[12] = PetscMin(boxes[12], -data[side]->sizes[i]);
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, boxes, 13, MPIU_REAL, MPIU_MIN, transfer->comm));
  *reach = PetscMax(near, BoxesDistance(boxes, boxes + 6) - FACES_AHEAD * boxes[12]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsDue(Transfer transfer, PetscReal near)
{
  return (PetscBool)(!transfer->built || near > transfer->numbers.near);
}

/* The part of TransferUpdate() before ranks tell each other of the motion, which callers do for many transfers at once. Surfaces are where
   they are. `least`: of this rank; of those of all ranks the least go to TransferRenew(). They are a box about the motions of all nodes
   since the last build, whose upper corner has its sign changed, and -1 if a row has slipped. */
PetscErrorCode TransferMeasureMotion(Transfer transfer, PetscReal near, PetscReal least[TRANSFER_MOTION])
{
  const SurfaceData *data[2] = {&transfer->dirichlet->data, transfer->neumann ? &transfer->neumann->data : NULL};
  PetscBool          slipped = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCheck(near >= 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE, "Partners are looked for within %g m, which must not be negative",
             (double)near);
  for (PetscInt k = 0; k < 6; k++) least[k] = transfer->obstacle ? 0 : PETSC_MAX_REAL; /* obstacles do not move */
  least[6] = 0;
  if (transfer->idle && transfer->built) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(transfer->keep, transfer->n));
  if (transfer->built) PetscCall(PetscArrayzero(transfer->rows.changed, transfer->n));
  if (IsDue(transfer, near) || transfer->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < 2 && data[side]; side++)
    for (PetscInt d = 0; d < 3; d++) {
      const PetscReal *x = data[side]->positions + d, *built = transfer->built_x[side] + d;
      PetscReal        lower = least[d], upper = -least[3 + d];

      for (PetscInt i = 0; i < data[side]->n_owned; i++) {
        lower = PetscMin(lower, x[3 * i] - built[3 * i]);
        upper = PetscMax(upper, x[3 * i] - built[3 * i]);
      }
      least[d]     = lower;
      least[3 + d] = -upper;
    }
  if (!transfer->some_near || !IsFlat(transfer)) PetscCall(HasSlipped(transfer, &slipped));
  least[6] = slipped ? -1 : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rows are to be built, by TransferRenew(). `least`: of all ranks; `anew`: builds all rows, and none goes on from where it is */
PetscErrorCode TransferIsStale(Transfer transfer, PetscReal near, PetscBool anew, const PetscReal least[TRANSFER_MOTION], PetscBool *stale)
{
  const PetscBool due    = (PetscBool)(anew || IsDue(transfer, near));
  PetscReal       square = 0;

  PetscFunctionBegin;
  *stale = PETSC_FALSE;
  if (transfer->idle && transfer->built) PetscFunctionReturn(PETSC_SUCCESS);
  if (due) PetscCall(PetscArrayzero(transfer->keep, transfer->n));
  if (anew && transfer->follow.known) PetscCall(PetscArrayzero(transfer->follow.known, transfer->n));
  for (PetscInt d = 0; d < 3; d++) square += PetscSqr(least[d] + least[3 + d]);
  *stale = (PetscBool)(due ||
                       (transfer->dim > 1 && (least[6] < 0 || PetscSqrtReal(square) > FAR_MOTION * transfer->numbers.smallest_size)));
  PetscCall(PetscArrayzero(transfer->goes_on, transfer->n));
  PetscCall(PetscArrayzero(transfer->followed, transfer->n));
  for (PetscInt row = 0; row < transfer->n && *stale && transfer->follow.known; row++)
    transfer->goes_on[row] = (PetscBool)(transfer->follow.known[row] && !transfer->keep[row]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rest of TransferUpdate(), where TransferIsStale() */
PetscErrorCode TransferRenew(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal near, PetscBool anew)
{
  const PetscBool looks = (PetscBool)(!anew && !IsDue(transfer, near) && transfer->dim > 1);
  PetscReal       reach;
  PetscBool       slipped;

  PetscFunctionBegin;
  if (transfer->some_near) { /* normals, areas and sizes of all nodes */
    PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
    if (transfer->neumann) PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
    if (looks && IsFlat(transfer)) PetscCall(HasSlipped(transfer, &slipped)); /* which rows stay as they are */
  }
  PetscCall(TransferGetReach(transfer, near, &reach));
  if (transfer->neumann) PetscCall(TransferBuildRows(transfer, u_dirichlet, u_neumann, reach));
  else PetscCall(TransferBuildObstacleRows(transfer, reach));
  for (PetscInt row = 0; row < transfer->n; row++) /* a gap that is that of the surfaces again has no turn in it */
    if (transfer->balance.n && transfer->rows.changed[row] && !transfer->goes_on[row]) transfer->balance.turned[row] = 0;
  PetscCall(Remember(transfer, reach));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which rows may touch before rows are built again; updates look at no others until then. NULL: all rows; others have a gap of more than
   two edges of the face. For SurfaceSetNear() the nodes whose normals near rows need are set to true: of the Dirichlet side, none before
   a plane, and of the Neumann side, NULL with an obstacle */
PetscErrorCode TransferSetNear(Transfer transfer, const PetscBool near[], PetscBool dirichlet[], PetscBool neumann[])
{
  const RowSet *set = &transfer->rows;
  PetscReal    *columns, *nodes;

  PetscFunctionBegin;
  PetscCall(PetscFree(transfer->near));
  transfer->some_near = (PetscBool)(near != NULL);
  transfer->n_near    = 0;
  if (!near || transfer->idle) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(transfer->n, &transfer->near));
  for (PetscInt row = 0; row < transfer->n; row++) {
    if (!near[row]) continue;
    transfer->near[transfer->n_near++] = row;
    dirichlet[row]                     = (PetscBool)(dirichlet[row] || !IsFlat(transfer));
  }
  if (!transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc2(3 * set->n_columns, &columns, 3 * transfer->neumann->data.n_nodes, &nodes));
  for (PetscInt k = 0; k < transfer->n_near; k++)
    for (PetscInt j = set->offsets[transfer->near[k]]; j < set->offsets[transfer->near[k] + 1]; j++) columns[3 * set->columns[j]] = 1;
  PetscCall(PetscSFReduceBegin(set->vectors, MPIU_REAL, columns, nodes, MPIU_MAX));
  PetscCall(PetscSFReduceEnd(set->vectors, MPIU_REAL, columns, nodes, MPIU_MAX));
  for (PetscInt i = 0; i < transfer->neumann->data.n_owned; i++) neumann[i] = (PetscBool)(neumann[i] || nodes[3 * i] > 0);
  PetscCall(PetscFree2(columns, nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves both surfaces to where they are, and builds the rows again where that is needed, which the first call always does. u NULL: no
   displacements; partners at least as close as `near` must be known; PETSC_MAX_REAL: at any distance [m]. The rows are built again if a
   row whose gap is less than two edges of the face has slipped or turned by more than the bounds; if the surfaces have moved by more
   than a quarter of the smallest face relative to each other, so that other faces may lie opposite; and if `near` exceeds that of the
   last build. In a build, rows near contact that are within both bounds stay as they are: each change of a row costs a little energy. In
   one dimension rows are built once. A build looks ahead of a node as far as `near`, or four faces further than the distance of the
   boxes about both surfaces, if that is more; and behind the node as far as the two bodies overlap. */
PetscErrorCode TransferUpdate(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal near, PetscBool *rebuilt)
{
  PetscReal least[TRANSFER_MOTION];

  PetscFunctionBegin;
  PetscCall(SurfaceUpdate(transfer->dirichlet, u_dirichlet));
  if (transfer->neumann) PetscCall(SurfaceUpdate(transfer->neumann, u_neumann));
  PetscCall(TransferMeasureMotion(transfer, near, least));
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, least, TRANSFER_MOTION, MPIU_REAL, MPIU_MIN, transfer->comm));
  PetscCall(TransferIsStale(transfer, near, PETSC_FALSE, least, rebuilt));
  if (*rebuilt) PetscCall(TransferRenew(transfer, u_dirichlet, u_neumann, near, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
