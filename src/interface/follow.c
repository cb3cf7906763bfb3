/* Rows that follow the surfaces between two builds.

   A force along a row has the same moment on both sides if sum_j P_ij x_j - x_i is along the normal n_i at the end of the controller step.
   So the weights follow the slip, see RowCorrect(), ahead by the slip expected in the step, to second order. The expected slip is a mean of
   the last steps: massless nodes move with the forces, and would swing with weights that answer to each motion. The normal is that of the
   surface at the start of the step. With rows B_0 of the last step, B of this one, and the expected way dx the step begins with the gap

     gap - 1/2 (B - B_0) dx,

   and so changes it by 1/2 (B_0 + B) dx, the trapezoidal rule for the path of the gap. Then the work of forces along rows that change,
   1/2 (f_0 B_0 + f B) dx in a closed gap, is zero but for terms of second order in the step.

   For forces that are the same throughout the step surfaces are where they are expected in its middle: weights are those of that place,
   with no slip ahead, and the gap changes by B dx from that of the last step's rows, which is 1/2 (B - B_0) dx more in the middle.

   When a row is built again, other nodes of the partner come in, and a jump of its weights would lose energy. The new weights are the goal,
   to which the present ones go as the row slips on, by the slip after which rows are built. */
#include "interfaceimpl.h"

/* Part of the last step's slip in the mean. With all of it, bars that meet at a fifth of their wave speed chatter. */
#define LATEST 0.5

static PetscReal AlongRow(const Transfer transfer, PetscInt row, const PetscReal x[], const PetscReal columns[])
{
  PetscReal across[3];

  return TransferSplitRow(transfer, &transfer->rows, row, x, columns, across);
}

/* Takes the slip of the last step into the mean. `across`: that slip [m]; `ratio`: of this step to the last one */
static void ExpectSlip(Transfer transfer, PetscInt row, const PetscReal across[], PetscReal ratio)
{
  PetscReal *slip = transfer->follow.slip + 3 * row;

  for (PetscInt d = 0; d < transfer->dim; d++) {
    slip[d] *= transfer->numbers.scale;
    slip[d] += (transfer->follow.known[row] ? LATEST : 1) * (ratio * across[d] - slip[d]);
  }
}

/* Weights with sum_j P_j x_j - x across the normal as wanted, from those given. `ahead`: expected motion of the partner [m] */
static PetscErrorCode Correct(Transfer transfer, PetscInt row, const PetscReal ahead[], PetscReal weights[])
{
  const SurfaceData *data  = &transfer->dirichlet->data;
  const RowSet      *set   = &transfer->rows;
  const PetscInt     first = set->offsets[row], n = set->offsets[row + 1] - first, dim = transfer->dim;
  const PetscReal   *partners[FOLLOW_MAX];
  PetscReal          x[3] = {0}, normal[3] = {0};

  PetscFunctionBegin;
  for (PetscInt j = 0; j < n; j++) partners[j] = transfer->column_x + 3 * set->columns[first + j];
  for (PetscInt d = 0; d < dim; d++) {
    x[d]      = data->positions[3 * row + d] - ahead[d];
    normal[d] = set->normals[dim * row + d];
  }
  for (PetscInt pass = 0; pass < 2; pass++)
    RowCorrect(dim, n, x, normal, partners, set->shares + first, data->sizes[row], weights); /* twice for round-off */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The weights go to their goals by the part of the way that the slip of this step is of the bound */
static PetscErrorCode Approach(Transfer transfer, PetscInt row, const PetscReal expected[], const PetscReal ahead[])
{
  RowSet         *set   = &transfer->rows;
  const PetscInt  first = set->offsets[row], n = set->offsets[row + 1] - first;
  const PetscReal slip = PetscSqrtReal(Dot(expected, expected)) / (transfer->options.slip_bound * transfer->dirichlet->data.sizes[row]);
  const PetscReal rest = PetscMax(set->rest[row] - slip, 0), part = set->rest[row] > 0 ? 1 - rest / set->rest[row] : 0;
  PetscReal       weights[FOLLOW_MAX];

  PetscFunctionBegin;
  for (PetscInt j = 0; j < n; j++) weights[j] = set->shares[first + j].goal;
  if (set->rest[row] > 0) PetscCall(Correct(transfer, row, ahead, weights));
  for (PetscInt j = 0; j < n; j++) {
    set->shares[first + j].goal = weights[j];
    weights[j]                  = set->shares[first + j].value + part * (weights[j] - set->shares[first + j].value);
  }
  PetscCall(Correct(transfer, row, ahead, weights));
  for (PetscInt j = 0; j < n; j++) set->shares[first + j].value = weights[j];
  set->rest[row] = rest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* New normal and weights of a row, and the gap without displacements that has its gap go on. `middle`: surfaces are where they will be in
   the middle of the step; `ratio`: of this step to the last one */
static PetscErrorCode FollowRow(Transfer transfer, PetscInt row, PetscReal still, PetscBool turns, PetscBool middle, PetscReal ratio)
{
  const SurfaceData *data   = &transfer->dirichlet->data;
  Follow            *follow = &transfer->follow;
  RowSet            *set    = &transfer->rows;
  const PetscInt     dim    = transfer->dim;
  PetscReal gap, way, across[3] = {0}, before[3] = {0}, after[3] = {0}, expected[3] = {0}, ahead[3] = {0}, present[3], slip = 0, turn;

  PetscFunctionBegin;
  gap = set->gap[row] - AlongRow(transfer, row, data->reference, transfer->column_reference) +
        TransferSplitRow(transfer, set, row, data->positions, transfer->column_x, before);
  way = TransferSplitRow(transfer, set, row, follow->moved, transfer->column_moved, across);
  ExpectSlip(transfer, row, across, ratio);
  if (follow->known[row]) PetscCall(PetscArraycpy(expected, follow->slip + 3 * row, dim));
  if (!middle) PetscCall(PetscArraycpy(ahead, expected, dim));
  follow->known[row] = PETSC_TRUE;
  PetscCall(TransferPresentNormal(transfer, row, present, &turn));
  for (PetscInt d = 0; d < dim; d++) slip += PetscSqr(before[d] + ahead[d]);
  /* whether the slip that is expected, or the turn of the normal since the row was changed, is worth a change */
  transfer->followed[row] = (PetscBool)(slip >= PetscSqr(still * data->sizes[row]) || (turns && turn >= PetscSqr(still)));
  if (!transfer->followed[row]) PetscFunctionReturn(PETSC_SUCCESS);
  if (turns) PetscCall(PetscArraycpy(set->normals + dim * row, present, dim));
  PetscCall(Approach(transfer, row, expected, ahead));
  way           = AlongRow(transfer, row, follow->moved, transfer->column_moved) - way;
  set->gap[row] = gap + (middle ? 0.5 : -0.5) * ratio * way + AlongRow(transfer, row, data->reference, transfer->column_reference) -
                  TransferSplitRow(transfer, set, row, data->positions, transfer->column_x, after);
  /* slips are counted from the last build on */
  for (PetscInt d = 0; d < dim; d++) transfer->built_slip[3 * row + d] += after[d] - before[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The gap of a row where the surfaces are now [m] */
PetscReal TransferPresentGap(Transfer transfer, PetscInt row)
{
  const SurfaceData *data = &transfer->dirichlet->data;

  return transfer->rows.gap[row] + AlongRow(transfer, row, data->positions, transfer->column_x) -
         AlongRow(transfer, row, data->reference, transfer->column_reference);
}

/* Gaps of the rows of this rank where the surfaces are now [m], 0 where nothing is opposite */
PetscErrorCode TransferGetGaps(Transfer transfer, PetscReal gaps[])
{
  PetscFunctionBegin;
  if (transfer->neumann) PetscCall(RowSetGetColumns(&transfer->rows, transfer->neumann->data.positions, transfer->column_x));
  for (PetscInt row = 0; row < transfer->n; row++) gaps[row] = transfer->rows.opposite[row] ? TransferPresentGap(transfer, row) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks rows that are to follow: those of nodes that touch, or may within the reach. Those of nodes beyond the end of the partner continue
   it as a straight line, and slip along that; where it ends now a build tells. */
static PetscErrorCode MarkFollowers(Transfer transfer, const PetscBool touches[], PetscReal reach, PetscBool *any)
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscCall(TransferBringColumns(transfer));
  for (PetscInt k = 0; k < (transfer->some_near ? transfer->n_near : transfer->n); k++) {
    const PetscInt row = transfer->some_near ? transfer->near[k] : k, n = set->offsets[row + 1] - set->offsets[row];

    transfer->followed[row] = (PetscBool)(set->opposite[row] && n <= FOLLOW_MAX &&
                                          (touches[row] || TransferPresentGap(transfer, row) <= reach));
    if (transfer->followed[row]) *any = PETSC_TRUE;
    else transfer->follow.known[row] = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes where the nodes of both sides are, and how they have moved since the step before */
static PetscErrorCode NoteMotion(Transfer transfer)
{
  const SurfaceData *data[2]  = {&transfer->dirichlet->data, &transfer->neumann->data};
  Follow            *follow   = &transfer->follow;
  PetscReal         *moved[2] = {follow->moved, follow->partner_moved};

  PetscFunctionBegin;
  for (PetscInt side = 0; side < 2; side++)
    for (PetscInt i = 0; i < 3 * data[side]->n_owned; i++) {
      moved[side][i]     = transfer->numbers.has_last ? data[side]->positions[i] - follow->x[side][i] : 0;
      follow->x[side][i] = data[side]->positions[i];
    }
  transfer->numbers.has_last = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets rows near contact follow two surfaces, after an update, without building them again. `touches`: which rows are in contact; others
   follow if their gap is at most `reach` [m]; `still`: rows whose partner slips [parts of the face] and whose normal turns [rad] by less
   stay as they are, to the last bit; `turns`: whether normals become those of the surface, which they else do where rows are built;
   `middle`: whether the surfaces are where they are expected in the middle of the step, not at its start; `step`: until the next update,
   `last`: from the last one to this [s]; `any`: whether any row of this rank has followed */
PetscErrorCode TransferFollow(Transfer transfer, const PetscBool touches[], PetscReal reach, PetscReal still, PetscBool turns,
                              PetscBool middle, PetscReal step, PetscReal last, PetscBool *any)
{
  TransferNumbers *numbers = &transfer->numbers;
  PetscBool        found   = PETSC_FALSE;
  PetscMPIInt      size;

  PetscFunctionBegin;
  PetscCheck(transfer->built && transfer->neumann && transfer->dim > 1, transfer->comm, PETSC_ERR_ARG_WRONGSTATE,
             "Only rows between two surfaces in two or three dimensions follow, after TransferUpdate()");
  PetscCheck(step > 0 && last > 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE, "The steps %g s and %g s must be positive", (double)step,
             (double)last);
  *any = PETSC_FALSE;
  if (transfer->idle) PetscFunctionReturn(PETSC_SUCCESS);
  numbers->scale = numbers->step > 0 ? step / numbers->step : 1;
  PetscCall(NoteMotion(transfer));
  PetscCall(MarkFollowers(transfer, touches, reach, &found));
  PetscCallMPI(MPI_Comm_size(transfer->comm, &size));
  /* rows of another rank may follow where those of this one do not */
  if (found || size > 1) PetscCall(RowSetGetColumns(&transfer->rows, transfer->follow.partner_moved, transfer->column_moved));
  for (PetscInt row = 0; row < transfer->n; row++) {
    if (!transfer->followed[row]) continue;
    PetscCall(FollowRow(transfer, row, still, turns, middle, step / last));
    *any = (PetscBool)(*any || transfer->followed[row]);
  }
  numbers->step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}
