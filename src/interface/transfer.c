/* The rows of a transfer as others see them: creation, settings, values for matrices. */
#include "interfaceimpl.h"
#include <sys/citations.h>

/* Shares of a row whose entries go into a matrix together */
#define SHARES_AT_ONCE 32

/* Bounds beyond which rows are built again, unless TransferSetBounds() is called: with this slip bound a half disc that is led round
   another one has a normal force steady to 0.2 % */
#define SLIP_BOUND  0.05 /* [parts of the face] */
#define ANGLE_BOUND 0.02 /* [rad] */

/*@
  TransferCreate - prepares the rows that compare a surface with another, or with an obstacle

  Collective

  Input Parameters:
+ comm      - communicator of both
. dirichlet - surface that takes displacements and gives tractions
. neumann   - surface that takes tractions and gives displacements; `NULL` with an obstacle
- obstacle  - `NULL` with a second surface

  Output Parameter:
. transfer - the `Transfer`; surfaces and obstacle belong to the caller and must live as long

  Level: developer

.seealso: `Transfer`, `TransferUpdate()`, `TransferDestroy()`
@*/
PetscErrorCode TransferCreate(MPI_Comm comm, Surface dirichlet, Surface neumann, Obstacle obstacle, Transfer *transfer)
{
  Transfer t;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(dirichlet, SURFACE_CLASSID, 2);
  if (neumann) PetscValidHeaderSpecific(neumann, SURFACE_CLASSID, 3);
  if (obstacle) PetscValidHeaderSpecific(obstacle, OBSTACLE_CLASSID, 4);
  PetscAssertPointer(transfer, 5);
  PetscCall(TransferInitializePackage());
  PetscCall(PetscHeaderCreate(*transfer, TRANSFER_CLASSID, "Transfer", "Rows between contact surfaces", "Interface", comm, TransferDestroy,
                              TransferView));
  PetscCheck(!neumann != !obstacle, comm, PETSC_ERR_ARG_WRONG, "A transfer is between a surface and either another surface or an obstacle");
  t              = *transfer;
  t->comm        = comm;
  t->owner       = PETSC_DECIDE;
  t->dirichlet   = dirichlet;
  t->neumann     = neumann;
  t->obstacle    = obstacle;
  t->dim         = dirichlet->data.dim;
  t->n           = dirichlet->data.n_owned;
  t->slip_bound  = SLIP_BOUND;
  t->angle_bound = ANGLE_BOUND;
  t->share       = 0.5;
  t->guards      = PETSC_TRUE;
  if (neumann && t->dim > 1) {
    PetscCall(ImpaktCite(CITE_DUAL_MORTAR));
    PetscCall(ImpaktCite(CITE_SEGMENTS));
  }
  if (neumann)
    PetscCheck(t->dim == neumann->data.dim, comm, PETSC_ERR_USER_INPUT,
               "The two bodies of a contact pair have %" PetscInt_FMT " and %" PetscInt_FMT " dimensions", t->dim, neumann->data.dim);
  PetscCall(PetscCalloc5(3 * t->n, &t->built_x[0], neumann ? 3 * neumann->data.n_owned : 0, &t->built_x[1], 3 * t->n, &t->built_slip, t->n,
                         &t->slip, t->n, &t->keep));
  PetscCall(PetscCalloc2(t->n, &t->followed, t->n, &t->goes_on));
  if (neumann)
    PetscCall(PetscCalloc6(3 * t->n, &t->follow.x[0], 3 * neumann->data.n_owned, &t->follow.x[1], 3 * t->n, &t->follow.moved,
                           3 * neumann->data.n_owned, &t->follow.partner_moved, 3 * t->n, &t->follow.slip, t->n, &t->follow.known));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferDestroy - frees a transfer; its surfaces belong to the caller

  Collective

  Input Parameter:
. transfer - the `Transfer`, set to `NULL`

  Level: developer

.seealso: `Transfer`, `TransferCreate()`
@*/
PetscErrorCode TransferDestroy(Transfer *transfer)
{
  PetscFunctionBegin;
  if (!*transfer) PetscFunctionReturn(PETSC_SUCCESS);
  PetscValidHeaderSpecific(*transfer, TRANSFER_CLASSID, 1);
  if (--((PetscObject)*transfer)->refct > 0) {
    *transfer = NULL;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(RowSetDestroy(&(*transfer)->rows));
  PetscCall(TransferDestroySaved(*transfer));
  PetscCall(PetscFree5((*transfer)->built_x[0], (*transfer)->built_x[1], (*transfer)->built_slip, (*transfer)->slip, (*transfer)->keep));
  PetscCall(PetscFree2((*transfer)->followed, (*transfer)->goes_on));
  PetscCall(PetscFree3((*transfer)->balance.bends[0], (*transfer)->balance.bends[1], (*transfer)->balance.bend));
  PetscCall(PetscFree5((*transfer)->balance.uneven, (*transfer)->balance.lever, (*transfer)->balance.across, (*transfer)->balance.gap,
                       (*transfer)->balance.turned));
  PetscCall(PetscFree6((*transfer)->follow.x[0], (*transfer)->follow.x[1], (*transfer)->follow.moved, (*transfer)->follow.partner_moved,
                       (*transfer)->follow.slip, (*transfer)->follow.known));
  PetscCall(PetscFree4((*transfer)->column_x, (*transfer)->column_normals, (*transfer)->column_moved, (*transfer)->column_reference));
  PetscCall(PetscHeaderDestroy(transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetBounds - how far the surfaces may move along each other before the rows are built again

  Logically Collective

  Input Parameters:
+ transfer - the `Transfer`
. slip     - parts of the face size, 0.05 by default
- angle    - by which a normal may turn, 0.02 by default [rad]

  Level: developer

.seealso: `Transfer`, `TransferUpdate()`
@*/
PetscErrorCode TransferSetBounds(Transfer transfer, PetscReal slip, PetscReal angle)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveReal(transfer, slip, 2);
  PetscValidLogicalCollectiveReal(transfer, angle, 3);
  PetscCheck(slip >= 0 && angle >= 0, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "The bounds of slip, %g, and angle, %g, must not be negative", (double)slip, (double)angle);
  transfer->slip_bound  = slip;
  transfer->angle_bound = angle;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetMoved - whether the surfaces are where their bodies are already when `TransferUpdate()` is called

  Logically Collective

  Input Parameters:
+ transfer - the `Transfer`
- moved    - false by default: each update moves them

  Level: developer

  Note:
  For surfaces that several transfers have in common: the caller moves each once, by `SurfaceUpdate()`.

.seealso: `Transfer`, `TransferUpdate()`, `SurfaceUpdate()`
@*/
PetscErrorCode TransferSetMoved(Transfer transfer, PetscBool moved)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveBool(transfer, moved, 2);
  transfer->moved = moved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetOwner - says that one rank has all of both surfaces, so that it needs no other to update the rows

  Logically Collective

  Input Parameters:
+ transfer - the `Transfer`, before the first `TransferUpdate()`
- rank     - that rank

  Level: developer

  Note:
  From then on what an update finds, whether rows have been built and whether any has followed, that rank alone knows; and updates are
collective no more. Gaps must not be turned.

.seealso: `Transfer`, `TransferGetOwner()`, `TransferUpdate()`, `TransferFollow()`, `TransferSetBalance()`
@*/
PetscErrorCode TransferSetOwner(Transfer transfer, PetscMPIInt rank)
{
  PetscMPIInt mine;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)transfer), &mine));
  transfer->comm  = PETSC_COMM_SELF;
  transfer->owner = rank;
  transfer->idle  = (PetscBool)(mine != rank);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetOwner - which rank has all of both surfaces

  Not Collective

  Input Parameter:
. transfer - the `Transfer`

  Output Parameter:
. rank - as `TransferSetOwner()` was told; `PETSC_DECIDE`: there may be several

  Level: developer

.seealso: `Transfer`, `TransferSetOwner()`
@*/
PetscErrorCode TransferGetOwner(Transfer transfer, PetscMPIInt *rank)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscAssertPointer(rank, 2);
  *rank = transfer->owner;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetGuards - whether Dirichlet nodes just beyond the end of the partner have rows too

  Logically Collective

  Input Parameters:
+ transfer - the `Transfer`, before the first `TransferUpdate()`
- guards   - true by default

  Level: developer

  Notes:
  If a face is covered in part, a node of it beyond the end of the partner is compared with the straight line that continues the covered
  part, as in Popp, Seitz, Gee, Wall (2013), with the gap counted from where the partner ends. Without these rows the last covered node
  has the mean gap of the whole covered part, and the end of a tilting partner gets into the surface by half an element times the angle.

  A node beyond the end of one partner may be in contact with another one: `TransferRows` tells which nodes are beyond an end.

.seealso: `Transfer`, `TransferUpdate()`
@*/
PetscErrorCode TransferSetGuards(Transfer transfer, PetscBool guards)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscValidLogicalCollectiveBool(transfer, guards, 2);
  PetscCheck(!transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call before TransferUpdate()");
  transfer->guards = guards;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetRows - the rows of the nodes that this rank owns

  Not Collective

  Input Parameter:
. transfer - the `Transfer`, updated once at least

  Output Parameter:
. rows - see `TransferRows`

  Level: developer

.seealso: `Transfer`, `TransferUpdate()`, `TransferSetValues()`
@*/
PetscErrorCode TransferGetRows(Transfer transfer, TransferRows *rows)
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  rows->n        = transfer->n;
  rows->dofs     = transfer->dirichlet->data.dofs;
  rows->opposite = set->opposite;
  rows->beyond   = set->beyond;
  rows->gap      = set->gap;
  rows->area     = set->area;
  rows->normals  = set->normals;
  rows->size     = transfer->dirichlet->data.sizes;
  rows->changed  = set->changed;
  rows->followed = transfer->followed;
  rows->slip     = transfer->slip;
  rows->bow      = set->bow;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferCountValues - how many entries a row has in the matrices of both sides

  Not Collective

  Input Parameter:
. transfer - the `Transfer`, updated once at least

  Output Parameters:
+ first  - for each node of this rank: of a row of it, along its normal or another direction, in the matrix of the first side
- second - the same in that of the second side; `NULL` for obstacles

  Level: developer

.seealso: `Transfer`, `TransferSetValues()`, `TransferSetDirectedValues()`
@*/
PetscErrorCode TransferCountValues(Transfer transfer, PetscInt first[], PetscInt second[])
{
  const RowSet *set = &transfer->rows;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  if (transfer->n) PetscAssertPointer(first, 2);
  for (PetscInt i = 0; i < transfer->n; i++) {
    first[i] = transfer->dim;
    if (second) second[i] = set->opposite[i] ? transfer->dim * (set->offsets[i + 1] - set->offsets[i]) : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries of one row of node i: n components of a direction, the first of them that along axis `first`. Whole rows at once, since a
   call for each entry takes most of its time for itself. */
static PetscErrorCode SetRow(Transfer transfer, PetscInt i, const PetscInt row[2], PetscInt first, PetscInt n, const PetscReal direction[],
                             const Mat rows[2])
{
  const RowSet *set = &transfer->rows;
  PetscInt      columns[3 * SHARES_AT_ONCE];
  PetscScalar   values[3 * SHARES_AT_ONCE];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < n; d++) {
    columns[d] = transfer->dirichlet->data.dofs[i] + first + d;
    values[d]  = direction[d];
  }
  if (rows[0]) PetscCall(MatSetValues(rows[0], 1, &row[0], n, columns, values, INSERT_VALUES));
  if (!rows[1] || !set->opposite[i]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt begin = set->offsets[i]; begin < set->offsets[i + 1]; begin += SHARES_AT_ONCE) {
    PetscInt count = 0;

    for (PetscInt j = begin; j < PetscMin(begin + SHARES_AT_ONCE, set->offsets[i + 1]); j++)
      for (PetscInt d = 0; d < n; d++) {
        columns[count]  = set->shares[j].dof + first + d;
        values[count++] = direction[d] * set->shares[j].value;
      }
    PetscCall(MatSetValues(rows[1], 1, &row[1], count, columns, values, INSERT_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetValues - puts the rows of this rank into the matrices of both sides

  Not Collective

  Input Parameters:
+ transfer   - the `Transfer`, updated once at least
. begin      - global number of the first row of this rank in the matrix of the first side, and in that of the second
. components - 1: the normal gap, a row for each node; the space dimension: all components of sum_j P_ij u_j - u_i, as many rows for each
- rows       - the first gets the normal of the node, or the unit vectors, at its displacements; the second the same times the weights, at
               the displacements of the nodes opposite. Either may be `NULL`; the second is for obstacles

  Level: developer

  Notes:
  Assemble both afterwards; values that were there before must have been set to zero. Rows without anything opposite have entries on the
  Dirichlet side alone.

  A force f on the gap acts on the Neumann side as the transpose times f and on the Dirichlet side as its transpose times -f: both have
  the same resultant, since the weights sum to one, and the same moment about any point.

.seealso: `Transfer`
@*/
PetscErrorCode TransferSetValues(Transfer transfer, const PetscInt begin[2], PetscInt components, const Mat rows[2])
{
  const RowSet  *set = &transfer->rows;
  const PetscInt dim = transfer->dim;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCheck(components == 1 || components == dim, transfer->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "A row has 1 or %" PetscInt_FMT " components, not %" PetscInt_FMT, dim, components);
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt c = 0; c < components; c++) {
      const PetscInt  row[2] = {begin[0] + i * components + c, begin[1] + i * components + c};
      const PetscReal unit   = 1;

      if (components == 1) PetscCall(SetRow(transfer, i, row, 0, dim, set->normals + dim * i, rows));
      else PetscCall(SetRow(transfer, i, row, c, 1, &unit, rows));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetDirectedValues - puts rows of given directions into the matrices of both sides

  Not Collective

  Input Parameters:
+ transfer   - the `Transfer`, updated once at least
. begin      - global number of the first row of this rank in the matrix of the first side, and in that of the second
. components - rows of each node
. directions - of each row of this rank: 3 numbers, zeros beyond the space dimension
- rows       - as in `TransferSetValues()`, with these directions in place of the normal

  Level: developer

.seealso: `Transfer`, `TransferSetValues()`
@*/
PetscErrorCode TransferSetDirectedValues(Transfer transfer, const PetscInt begin[2], PetscInt components, const PetscReal directions[],
                                         const Mat rows[2])
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  for (PetscInt i = 0; i < transfer->n; i++)
    for (PetscInt k = i * components; k < (i + 1) * components; k++) {
      const PetscInt row[2] = {begin[0] + k, begin[1] + k};

      PetscCall(SetRow(transfer, i, row, 0, transfer->dim, directions + 3 * k, rows));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferSetNeighbours - marks which rows belong to nodes of the Dirichlet side with an edge in common

  Collective

  Input Parameters:
+ transfer   - the `Transfer`
. row_begin  - global number of the first row of this rank
. components - rows of each node
. slope      - nodes whose gaps differ by more than this part of their distance are left out
- neighbours - all rows by all rows: gets ones where rows of one component of two such nodes meet

  Level: developer

  Note:
  Assemble it afterwards. In two dimensions edges are the faces themselves; in one dimension there are none.

.seealso: `Transfer`, `TransferSetValues()`
@*/
PetscErrorCode TransferSetNeighbours(Transfer transfer, PetscInt row_begin, PetscInt components, PetscReal slope, Mat neighbours)
{
  const Surface      surface = transfer->dirichlet;
  const SurfaceData *data    = &surface->data;
  const PetscInt     n       = data->face_nodes;
  PetscInt          *first;
  PetscReal         *gap;

  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscCheck(transfer->built, transfer->comm, PETSC_ERR_ARG_WRONGSTATE, "Call TransferUpdate() first");
  PetscCall(PetscMalloc2(data->n_nodes, &first, data->n_nodes, &gap));
  for (PetscInt i = 0; i < data->n_owned; i++) {
    first[i] = row_begin + i * components;
    gap[i]   = transfer->rows.gap[i];
  }
  PetscCall(PetscSFBcastBegin(surface->sf, MPIU_REAL, gap, gap, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(surface->sf, MPIU_REAL, gap, gap, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(surface->sf, MPIU_INT, first, first, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(surface->sf, MPIU_INT, first, first, MPI_REPLACE));
  for (PetscInt f = 0; f < data->n_faces && n > 1; f++)
    for (PetscInt k = 0; k < n; k++) {
      const PetscInt   a = data->faces[f * n + k], b = data->faces[f * n + (k + 1) % n];
      const PetscReal *x = data->positions + 3 * a, *y = data->positions + 3 * b;
      const PetscReal  way[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};

      if (PetscAbsReal(gap[b] - gap[a]) / PetscSqrtReal(Dot(way, way)) > slope) continue;
      for (PetscInt c = 0; c < components; c++) {
        PetscCall(MatSetValue(neighbours, first[a] + c, first[b] + c, 1, INSERT_VALUES));
        PetscCall(MatSetValue(neighbours, first[b] + c, first[a] + c, 1, INSERT_VALUES));
      }
    }
  PetscCall(PetscFree2(first, gap));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*@
  TransferGetCounts - what the updates have done

  Not Collective

  Input Parameter:
. transfer - the `Transfer`

  Output Parameter:
. counts - see `TransferCounts`; the same on every rank

  Level: developer

.seealso: `Transfer`, `TransferUpdate()`
@*/
PetscErrorCode TransferGetCounts(Transfer transfer, TransferCounts *counts)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(transfer, TRANSFER_CLASSID, 1);
  PetscAssertPointer(counts, 2);
  *counts = transfer->counts;
  PetscFunctionReturn(PETSC_SUCCESS);
}
