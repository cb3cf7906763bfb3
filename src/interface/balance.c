/* Forces that are balanced along the normals of both sides.

   Without friction the pressure on each surface acts along that surface's own normal. Forces lambda_i of rows act along one line for both
   sides; along the normals of the sides they would sum up to sum lambda_i n_i and sum -lambda_i m_i. Where the mesh resolves the contact
   both are the same. In one of two or three nodes they are not: the centre of pressure hangs on the mesh, and spins discs that should not.

   With c_i the component of n_i + m_i across the row, both sums are the same if sum lambda_i c_i is zero. Dual to this condition is a turn
   theta of the gap, g_i + theta c_i, which shifts the place at which curved surfaces meet. In contact the turn is an unknown beside the
   forces, so that the condition holds at the end of each step and the turn does no work. Before contact there is none.

   In three dimensions there are two conditions, one for each of two axes e across the mean normal of the contact,
   c_i = e . (r_i x (n_i + m_i)) with the direction r_i of the row; in two dimensions the one axis is that across the plane. */
#include "interfaceimpl.h"

/* Chord of the angle between the normals of two nodes of a face, 18 degrees, from which on the face is beside an edge */
#define EDGE 0.31
/* Rows count up to an angle of 37 degrees between the normals of both sides, unless an edge is near */
#define FACING 0.8
/* Components of rows that push follow the surfaces without delay down to this part of what they are without strain */
#define EVEN 0.2
/* and at least by this part of the way in a step */
#define SLOWEST 0.02

/* How far normals turn from each node of a surface to its neighbours, edges left out. Ghosts count with what this rank sees. */
static void FindBends(const SurfaceData *data, PetscReal bends[])
{
  for (PetscInt f = 0; f < data->n_faces; f++)
    for (PetscInt k = 0; k < data->face_nodes; k++) {
      const PetscInt   a = data->faces[data->face_nodes * f + k], b = data->faces[data->face_nodes * f + (k + 1) % data->face_nodes];
      const PetscReal *n = data->normals + 3 * a, *m = data->normals + 3 * b;
      const PetscReal  bend = PetscSqrtReal(PetscSqr(n[0] - m[0]) + PetscSqr(n[1] - m[1]) + PetscSqr(n[2] - m[2]));

      if (bend > EDGE) continue;
      if (a < data->n_owned) bends[3 * a] = PetscMax(bends[3 * a], bend);
      if (b < data->n_owned) bends[3 * b] = PetscMax(bends[3 * b], bend);
    }
}

/* What the components c_i of a row are taken from; 0 where nothing is turned, which is where the surface has an edge */
static void FindAcross(const Transfer transfer, PetscInt row, PetscReal across[])
{
  const RowSet    *set       = &transfer->rows;
  const PetscReal *node      = transfer->dirichlet->data.normals + 3 * row;
  PetscReal        normal[3] = {0}, partner[3] = {0}, sum[3];

  for (PetscInt d = 0; d < 3; d++) across[d] = 0;
  if (!set->opposite[row] || set->beyond[row]) return;
  for (PetscInt j = set->offsets[row]; j < set->offsets[row + 1]; j++)
    for (PetscInt d = 0; d < 3; d++) partner[d] += set->shares[j].value * transfer->column_normals[3 * set->columns[j] + d];
  if (-Dot(partner, node) < FACING) return;
  for (PetscInt d = 0; d < 3; d++) {
    normal[d] = d < transfer->dim ? set->normals[transfer->dim * row + d] : 0;
    sum[d]    = node[d] + partner[d];
  }
  Cross(normal, sum, across);
}

/* By what part of the way the components of rows that push follow the surfaces in a step. Forces press faces flat, which makes the
   components small, and small ones change by much of themselves with the forces that they lead to: once they are a fifth of what they are
   without strain, forces would swing from one step to the next, ever farther. */
static PetscErrorCode FindPace(Transfer transfer, const PetscReal force[], PetscReal *pace)
{
  const Balance *balance = &transfer->balance;
  PetscReal      sums[3] = {0, 0, 0}; /* forces, and times squares of components and of what they are without strain */

  PetscFunctionBegin;
  for (PetscInt row = 0; row < transfer->n; row++) {
    PetscReal across[3];

    if (!(force[row] > 0)) continue;
    FindAcross(transfer, row, across);
    sums[0] += force[row];
    sums[1] += force[row] * Dot(across, across);
    sums[2] += force[row] * PetscSqr(balance->bend[row]);
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, transfer->comm));
  *pace = sums[2] > 0 ? PetscMin(1, PetscMax(SLOWEST, sums[1] / (PetscSqr(EVEN) * balance->n * sums[2]))) : 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The components c_i of all rows, and by what a turn changes their gaps: in the step they change by the mean of the components of the step
   before, with which the forces at its start are balanced, and of those now, so that the work of the turn is of third order in the step */
static void FindUnevenness(Transfer transfer, const PetscReal force[], PetscReal pace)
{
  Balance *balance = &transfer->balance;

  for (PetscInt row = 0; row < transfer->n; row++) {
    PetscReal *across = balance->across + 3 * row, last[3] = {across[0], across[1], across[2]};

    FindAcross(transfer, row, across);
    for (PetscInt d = 0; d < 3 && force[row] > 0; d++) across[d] = last[d] + pace * (across[d] - last[d]);
    for (PetscInt k = 0; k < balance->n; k++) {
      const PetscReal now = Dot(transfer->numbers.axes[k], across);

      balance->uneven[balance->n * row + k] = now;
      balance->lever[balance->n * row + k]  = force[row] > 0 ? 0.5 * (now + Dot(transfer->numbers.axes[k], last)) : now;
    }
  }
}

/* The axes across the mean normal of the rows with a force or, without any, of those with a gap below the reach */
static PetscErrorCode FindAxes(Transfer transfer, const PetscReal force[], PetscReal reach)
{
  Balance  *balance = &transfer->balance;
  PetscReal sums[8] = {0};

  PetscFunctionBegin;
  if (transfer->dim == 2) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt row = 0; row < transfer->n; row++) {
    if (!transfer->rows.opposite[row]) continue;
    for (PetscInt d = 0; d < 3; d++) {
      if (force[row] > 0) sums[d] += force[row] * transfer->rows.normals[3 * row + d];
      if (balance->gap[row] < reach) sums[4 + d] += transfer->rows.normals[3 * row + d];
    }
    if (force[row] > 0) sums[3] = 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, sums, 8, MPIU_REAL, MPIU_SUM, transfer->comm));
  if (!(sums[3] > 0)) PetscCall(PetscArraycpy(sums, sums + 4, 3));
  if (!(Normalize(sums) > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  UnitsAcross(transfer->dim, sums, transfer->numbers.axes[0], transfer->numbers.axes[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TransferSetUpTurns(Transfer transfer)
{
  Balance *balance = &transfer->balance;

  PetscFunctionBegin;
  PetscCheck(transfer->neumann && transfer->dim > 1 && !transfer->options.owned, transfer->comm, PETSC_ERR_SUP,
             "Forces are balanced between two surfaces in two or three dimensions alone, without an owner");
  balance->n = transfer->dim - 1;
  PetscCall(PetscCalloc5(balance->n * transfer->n, &balance->uneven, balance->n * transfer->n, &balance->lever, 3 * transfer->n,
                         &balance->across, transfer->n, &balance->gap, transfer->n, &balance->turned));
  PetscCall(PetscCalloc3(3 * transfer->n, &balance->bends[0], 3 * transfer->neumann->data.n_owned, &balance->bends[1], transfer->n,
                         &balance->bend));
  FindBends(&transfer->dirichlet->data, balance->bends[0]);
  FindBends(&transfer->neumann->data, balance->bends[1]);
  if (transfer->dim == 2) transfer->numbers.axes[0][2] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How gaps can be turned such that forces have the same sum along the normals of both sides; each may be NULL. `n`: number of turns, one
   in two dimensions, two in three; for each row of this rank `uneven`: n numbers c, sums of forces times c vanish where forces are
   balanced; `lever`: n numbers, a turn t changes its gap by the sum of them times t. `turn`: all turns so far together [m] */
PetscErrorCode TransferGetTurns(Transfer transfer, PetscInt *n, const PetscReal *uneven[], const PetscReal *lever[], PetscReal turn[])
{
  const Balance *balance = &transfer->balance;

  PetscFunctionBegin;
  if (n) *n = balance->n;
  if (uneven) *uneven = balance->uneven;
  if (lever) *lever = balance->lever;
  for (PetscInt k = 0; turn && k < balance->n; k++) turn[k] = Dot(transfer->numbers.turn, transfer->numbers.axes[k]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns the gaps of all rows, after TransferBalance(), by `change` about each of its axes [m] */
PetscErrorCode TransferTurn(Transfer transfer, const PetscReal change[])
{
  Balance *balance = &transfer->balance;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < balance->n; k++)
    for (PetscInt d = 0; d < 3; d++) transfer->numbers.turn[d] += change[k] * transfer->numbers.axes[k][d];
  for (PetscInt row = 0; row < transfer->n; row++)
    for (PetscInt k = 0; k < balance->n; k++) {
      const PetscReal more = change[k] * balance->lever[balance->n * row + k];

      transfer->rows.gap[row] += more;
      balance->turned[row] += more;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds how gaps can be turned, after TransferFollow(), and turns those of rows without a force as they are to be. `force`: of each row
   at the start of the step [N]; `reach`: gap up to which rows may come into contact in the step [m]; `any` becomes true if gaps have
   changed. Without any force there is no turn. No row is turned into the partner. */
PetscErrorCode TransferBalance(Transfer transfer, const PetscReal force[], PetscReal reach, PetscBool *any)
{
  Balance  *balance = &transfer->balance;
  PetscReal most[2] = {-PETSC_MAX_REAL, 0}; /* minus the least gap without turns; whether there is any force */
  PetscReal turn[2] = {0, 0}, pace = 1;

  PetscFunctionBegin;
  PetscCall(TransferBringColumns(transfer));
  for (PetscInt row = 0; row < transfer->n; row++) {
    if (!transfer->rows.opposite[row]) continue;
    balance->gap[row] = TransferPresentGap(transfer, row);
    most[0]           = PetscMax(most[0], balance->turned[row] - balance->gap[row]);
    if (force[row] > 0) most[1] = 1;
  }
  PetscCallMPI(MPIU_Allreduce(MPI_IN_PLACE, most, 2, MPIU_REAL, MPIU_MAX, transfer->comm));
  PetscCall(FindAxes(transfer, force, reach));
  PetscCall(
      RowSetGetColumns(&transfer->rows, balance->bends[1], transfer->column_moved)); /* what these have moved is not needed any more */
  for (PetscInt row = 0; row < transfer->n; row++) {
    balance->bend[row] = 0.5 * balance->bends[0][3 * row];
    for (PetscInt j = transfer->rows.offsets[row]; j < transfer->rows.offsets[row + 1]; j++)
      balance->bend[row] += 0.5 * transfer->rows.shares[j].value * transfer->column_moved[3 * transfer->rows.columns[j]];
  }
  PetscCall(FindPace(transfer, force, &pace));
  FindUnevenness(transfer, force, pace);
  if (!(most[1] > 0)) {
    PetscCall(PetscArrayzero(transfer->numbers.turn, 3));
    if (-most[0] > reach) PetscFunctionReturn(PETSC_SUCCESS);
  } else
    for (PetscInt k = 0; k < balance->n; k++) turn[k] = Dot(transfer->numbers.turn, transfer->numbers.axes[k]);
  for (PetscInt row = 0; row < transfer->n; row++) {
    PetscReal more = -balance->turned[row];

    if (force[row] > 0 || !transfer->rows.opposite[row]) continue;
    for (PetscInt k = 0; k < balance->n; k++) more += turn[k] * balance->uneven[balance->n * row + k];
    if (balance->gap[row] + more < 0) more = -PetscMax(balance->gap[row], 0);
    transfer->rows.gap[row] += more;
    balance->turned[row] += more;
  }
  *any = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
