/* From the mortar integrals to the rows of a transfer. */
#include "interfaceimpl.h"

/* The least part of a node's area that is covered if the node has a row: weights are divided by the covered area, which has round-off */
#define COVERED 1e-6
/* Gaps of surfaces that only touch are round-off, which is smaller [of the face] */
#define TOUCHING 1e-6
/* In a rebuild, partners are looked for this far behind at least [parts of the smallest face] */
#define LEAST_DEPTH 0.5
/* Gaps are along normals, which may be oblique to the shortest way out of an overlap: this many times as long, at 60 degrees */
#define OBLIQUE 2

PetscErrorCode RowSetAllocate(PetscInt dim, PetscInt n, PetscInt n_shares, RowSet *set)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(set, sizeof(*set)));
  PetscCall(PetscCalloc7(n, &set->opposite, n, &set->beyond, n, &set->changed, n, &set->gap, n, &set->area, dim * n, &set->normals, n + 1,
                         &set->offsets));
  PetscCall(PetscCalloc3(n, &set->rest, n, &set->bow, 3 * n, &set->partner));
  PetscCall(PetscMalloc2(n_shares, &set->shares, n_shares, &set->columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowSetDestroy(RowSet *set)
{
  PetscFunctionBegin;
  PetscCall(PetscFree7(set->opposite, set->beyond, set->changed, set->gap, set->area, set->normals, set->offsets));
  PetscCall(PetscFree3(set->rest, set->bow, set->partner));
  PetscCall(PetscFree2(set->shares, set->columns));
  PetscCall(PetscSFDestroy(&set->vectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Orders shares by row, then by displacement, then by value: sums do not depend on the order of ranks and faces */
int ShareCompare(const void *a, const void *b, void *context)
{
  const Share *left = (const Share *)a, *right = (const Share *)b;

  (void)context;
  if (left->row != right->row) return left->row < right->row ? -1 : 1;
  if (left->dof != right->dof) return left->dof < right->dof ? -1 : 1;
  if (left->value != right->value) return left->value < right->value ? -1 : 1;
  for (PetscInt d = 0; d < 3; d++)
    if (left->slope[d] != right->slope[d]) return left->slope[d] < right->slope[d] ? -1 : 1;
  return 0;
}

/* Sums the pieces of each weight and divides by D_i. The row of a node of which too little is covered has no weights. */
static PetscErrorCode MergeShares(PetscInt n, const PetscBool keep[], const PetscReal lumped[], const PetscReal areas[], PetscInt n_shares,
                                  Share shares[], RowSet *set)
{
  PetscInt count = 0, share = 0;

  PetscFunctionBegin;
  if (n_shares > 1) PetscCall(PetscTimSort(n_shares, shares, sizeof(Share), ShareCompare, NULL)); /* which reads the first even of none */
  for (PetscInt row = 0; row < n; row++) {
    const PetscBool covered = (PetscBool)(lumped[row] > COVERED * areas[row] || keep[row]);

    set->offsets[row] = count;
    while (share < n_shares && shares[share].row == row) {
      Share sum = shares[share];

      PetscReal slope = 0;

      sum.value = sum.goal = sum.area = 0;
      for (PetscInt d = 0; d < 3; d++) sum.slope[d] = 0;
      for (; share < n_shares && shares[share].row == row && shares[share].dof == sum.dof; share++) {
        sum.value += shares[share].value;
        sum.goal += shares[share].goal;
        sum.area += shares[share].area;
        for (PetscInt d = 0; d < 3; d++) sum.slope[d] += shares[share].slope[d];
      }
      sum.value /= lumped[row];
      sum.goal /= lumped[row];
      sum.area /= lumped[row];
      for (PetscInt d = 0; d < 3; d++) {
        sum.slope[d] /= lumped[row];
        slope += PetscAbsReal(sum.slope[d]);
      }
      if (covered && (PetscAbsReal(sum.value) > ROUND_OFF_WEIGHT || PetscAbsReal(sum.goal) > ROUND_OFF_WEIGHT ||
                      sum.area > ROUND_OFF_WEIGHT || slope > 0))
        set->shares[count++] = sum;
    }
    set->opposite[row] = (PetscBool)(count > set->offsets[row]);
  }
  set->offsets[n] = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the distinct nodes of the partner that the shares name, and makes the star forest that brings their vectors from their owners */
static PetscErrorCode ConnectColumns(MPI_Comm comm, PetscInt n_owned, PetscInt n, RowSet *set)
{
  const PetscInt count = set->offsets[n];
  PetscInt      *dofs;
  PetscSFNode   *owners;
  PetscMPIInt    size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  set->n_columns = count;
  PetscCall(PetscMalloc1(count, &dofs));
  for (PetscInt i = 0; i < count; i++) dofs[i] = set->shares[i].dof;
  PetscCall(PetscSortRemoveDupsInt(&set->n_columns, dofs));
  PetscCall(PetscMalloc1(set->n_columns, &owners));
  for (PetscInt i = 0; i < count; i++) {
    PetscCall(PetscFindInt(set->shares[i].dof, set->n_columns, dofs, &set->columns[i]));
    owners[set->columns[i]].rank  = size > 1 ? set->shares[i].owner_rank : 0; /* of one rank alone that is its number */
    owners[set->columns[i]].index = set->shares[i].owner_index;
  }
  PetscCall(PetscFree(dofs));
  PetscCall(CreateVectorForest(comm, n_owned, set->n_columns, NULL, owners, &set->vectors));
  PetscCall(PetscFree(owners));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a node lies on a sharp edge, and what it sees of the partner is smooth: then its row is along the mean normal of that. Else it
   keeps the mean normal of its own faces, as where a corner meets a corner. Rows of ties, which have no guards, keep it too. */
static PetscBool SeesSmooth(Transfer transfer, PetscInt node, const PetscReal seen[], PetscReal area, PetscReal normal[])
{
  PetscReal       mean[3] = {seen[0], seen[1], seen[2]};
  const PetscBool smooth  = (PetscBool)(!transfer->options.unguarded && transfer->dirichlet->sharp[node] &&
                                        Normalize(mean) > SHARP_COSINE * area);

  for (PetscInt d = 0; d < 3; d++) normal[d] = smooth ? mean[d] : 0;
  if (!smooth) return PETSC_FALSE;
  SurfaceMirrorNormal(transfer->dirichlet, node, normal);
  (void)Normalize(normal);
  return PETSC_TRUE;
}

/* Corrects the weights of a row, and keeps the row if its gap lies between -behind, or the bow that a row may have of surfaces that only
   touch, and ahead [m]. The weights of a node beyond the end of the partner continue the partner as a straight line. Its gap is
   counted from the gap `end` [m] where the partner ends: so the node touches when the end of the partner does, not before or after.
   Corrected weights are goals: those of a row that goes on from where it is stay, and its present gap is that of its goals. */
static PetscErrorCode FinishRow(Transfer transfer, PetscInt row, PetscReal end, const PetscReal seen[], PetscReal ahead, PetscReal behind,
                                RowSet *set)
{
  const SurfaceData *data  = &transfer->dirichlet->data;
  const PetscInt     first = set->offsets[row], n = set->offsets[row + 1] - first, dim = transfer->dim;
  const PetscReal   *x = data->positions + 3 * row, **smooth, **partners;
  PetscReal *weights, present = 0, across[3], normal[3] = {data->normals[3 * row], data->normals[3 * row + 1], data->normals[3 * row + 2]};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(set->normals + dim * row, normal, dim));
  set->gap[row] = PETSC_MAX_REAL;
  if (!set->opposite[row]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(n, &weights, n, &partners, n, &smooth));
  for (PetscInt j = 0; j < n; j++) {
    weights[j]  = set->shares[first + j].goal;
    partners[j] = transfer->column_x + 3 * set->columns[first + j];
    smooth[j]   = transfer->column_normals + 3 * set->columns[first + j];
  }
  if (SeesSmooth(transfer, row, seen, set->area[row], set->partner + 3 * row)) {
    (void)RowPartnerNormal(transfer->dirichlet, set, row, transfer->column_x, normal); /* as it is found again later, from slopes */
    for (PetscInt d = 0; d < 3; d++) normal[d] = -normal[d];
  } else if (transfer->options.curved) RowNormal(dim, n, transfer->options.share, data->normals + 3 * row, smooth, weights, normal);
  PetscCall(PetscArraycpy(set->normals + dim * row, normal, dim));
  for (PetscInt pass = 0; pass < 2; pass++)
    RowCorrect(dim, n, x, normal, partners, set->shares + first, data->sizes[row], weights); /* twice for round-off */
  for (PetscInt d = 0; d < dim; d++) {
    PetscReal now = 0;

    for (PetscInt j = 0; j < n; j++) now += weights[j] * partners[j][d];
    present += normal[d] * (now - x[d]);
  }
  set->bow[row] = RowBow(dim, n, x, normal, partners, weights);
  if (set->beyond[row]) present = end;
  else if (transfer->options.curved) {
    const PetscReal bulge = RowBulge(dim, n, x, normal, partners, smooth, weights, set->shares + first);

    present -= bulge;
    set->bow[row] += PetscMax(bulge, 0);
  }
  for (PetscInt j = 0; j < n; j++) {
    set->shares[first + j].goal = weights[j];
    if (!transfer->goes_on[row]) set->shares[first + j].value = weights[j];
  }
  PetscCall(PetscFree3(weights, partners, smooth));
  set->rest[row]     = transfer->goes_on[row] ? 1 : 0;
  set->opposite[row] = (PetscBool)(present <= ahead && present >= -PetscMax(behind + TOUCHING * data->sizes[row], set->bow[row]));
  if (!set->opposite[row]) PetscFunctionReturn(PETSC_SUCCESS);
  set->gap[row] = present + (TransferSplitRow(transfer, set, row, data->reference, transfer->column_reference, across) -
                             TransferSplitRow(transfer, set, row, data->positions, transfer->column_x, across));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts shares of rows that stay in place of new ones; those of rows that go on from where they are go to new ones as goals. */
static PetscErrorCode KeepShares(Transfer transfer, PetscReal lumped[], PetscInt *n_shares, Share *shares[])
{
  const RowSet *old  = &transfer->rows;
  PetscInt      kept = 0, count = 0;
  Share        *all;

  PetscFunctionBegin;
  for (PetscInt row = 0; row < transfer->n; row++)
    if (transfer->keep[row] || transfer->goes_on[row]) kept += old->offsets[row + 1] - old->offsets[row];
  for (PetscInt i = 0; i < *n_shares; i++) {
    (*shares)[i].goal = (*shares)[i].value;
    if (transfer->goes_on[(*shares)[i].row]) (*shares)[i].value = 0;
  }
  if (!kept) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(*n_shares + kept, &all));
  for (PetscInt i = 0; i < *n_shares; i++)
    if (!transfer->keep[(*shares)[i].row]) all[count++] = (*shares)[i];
  for (PetscInt row = 0; row < transfer->n; row++) {
    if (!transfer->keep[row] && !transfer->goes_on[row]) continue;
    if (transfer->keep[row]) lumped[row] = 1; /* its weights have been divided by its area already */
    for (PetscInt i = old->offsets[row]; i < old->offsets[row + 1]; i++) {
      all[count] = old->shares[i];
      if (!transfer->keep[row]) {
        all[count].value *= lumped[row];
        all[count].goal = all[count].area = 0;
        for (PetscInt d = 0; d < 3; d++) all[count].slope[d] = 0;
      }
      count++;
    }
  }
  PetscCall(PetscFree(*shares));
  *shares   = all;
  *n_shares = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies a row that is to stay as it is; its weights have been copied by KeepShares() */
static void KeepRow(Transfer transfer, PetscInt row, RowSet *set)
{
  const RowSet *old = &transfer->rows;

  set->opposite[row] = PETSC_TRUE;
  set->beyond[row]   = old->beyond[row];
  set->gap[row]      = old->gap[row];
  set->area[row]     = old->area[row];
  set->rest[row]     = old->rest[row];
  set->bow[row]      = old->bow[row];
  for (PetscInt d = 0; d < transfer->dim; d++) set->normals[transfer->dim * row + d] = old->normals[transfer->dim * row + d];
  for (PetscInt d = 0; d < 3; d++) set->partner[3 * row + d] = old->partner[3 * row + d];
}

/* Takes rows that have been built. Those that neither stay nor have been without a partner, and still are, have changed. */
static PetscErrorCode TakeRows(Transfer transfer, RowSet *set)
{
  PetscFunctionBegin;
  for (PetscInt row = 0; row < transfer->n; row++)
    set->changed[row] = (PetscBool)(!transfer->built || (!transfer->keep[row] && (set->opposite[row] || transfer->rows.opposite[row])));
  PetscCall(RowSetDestroy(&transfer->rows));
  transfer->rows = *set;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How far behind a node its partner may be [m]: as far as the bodies are inside each other, not their hulls. One may be in a hollow of the
   other, and faces farther behind a node be on the far sides of both bodies. */
static PetscErrorCode GetDepth(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal *behind)
{
  const Vec     u[2]     = {u_dirichlet, u_neumann};
  const Surface whole[2] = {transfer->options.boundaries[0], transfer->options.boundaries[1]};
  SurfaceDepth *depths;
  PetscInt      n;

  PetscFunctionBegin;
  *behind = transfer->built ? LEAST_DEPTH * transfer->numbers.smallest_size : 0;
  for (PetscInt side = 0; side < 2; side++) PetscCall(SurfaceUpdate(whole[side], u[side]));
  PetscCall(SurfacesFindDepths(transfer->comm, 2, whole, 0, NULL, &n, &depths));
  for (PetscInt i = 0; i < n; i++) *behind = PetscMax(*behind, OBLIQUE * depths[i].depth);
  PetscCall(PetscFree(depths));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings vectors of the partner's nodes to the ranks whose rows name them */
PetscErrorCode RowSetGetColumns(const RowSet *set, const PetscReal vectors[], PetscReal columns[])
{
  PetscFunctionBegin;
  PetscCall(PetscSFBcastBegin(set->vectors, MPIU_REAL, vectors, columns, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(set->vectors, MPIU_REAL, vectors, columns, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for vectors of the columns of rows that have just come, and where these lie in the mesh. `connects`: makes the star forest first */
PetscErrorCode TransferSetUpColumns(Transfer transfer, RowSet *rows, PetscBool connects)
{
  PetscInt n;

  PetscFunctionBegin;
  if (!transfer->neumann) PetscFunctionReturn(PETSC_SUCCESS);
  if (connects) PetscCall(ConnectColumns(transfer->comm, transfer->neumann->data.n_owned, transfer->n, rows));
  n = 3 * rows->n_columns;
  PetscCall(PetscFree4(transfer->column_x, transfer->column_normals, transfer->column_moved, transfer->column_reference));
  PetscCall(PetscMalloc4(n, &transfer->column_x, n, &transfer->column_normals, n, &transfer->column_moved, n, &transfer->column_reference));
  PetscCall(RowSetGetColumns(rows, transfer->neumann->data.reference, transfer->column_reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the rows between two surfaces under the given displacements; partners at most `near` before a node count [m] */
PetscErrorCode TransferBuildRows(Transfer transfer, Vec u_dirichlet, Vec u_neumann, PetscReal near)
{
  const SurfaceData *dirichlet = &transfer->dirichlet->data, *neumann = &transfer->neumann->data;
  PetscReal         *lumped, *ends, *seen, behind;
  PetscInt           n_shares, *marks;
  Share             *shares;
  RowSet             set;

  PetscFunctionBegin;
  PetscCall(GetDepth(transfer, u_dirichlet, u_neumann, &behind));
  PetscCall(
      PetscMalloc4(dirichlet->n_nodes, &marks, dirichlet->n_nodes, &lumped, dirichlet->n_nodes, &ends, 3 * dirichlet->n_nodes, &seen));
  PetscCall(TransferIntegrate(transfer, near, behind, marks, lumped, ends, seen, &n_shares, &shares));
  PetscCall(KeepShares(transfer, lumped, &n_shares, &shares));
  PetscCall(RowSetAllocate(transfer->dim, transfer->n, n_shares, &set));
  PetscCall(MergeShares(transfer->n, transfer->keep, lumped, dirichlet->areas, n_shares, shares, &set));
  PetscCall(PetscFree(shares));
  PetscCall(TransferSetUpColumns(transfer, &set, PETSC_TRUE));
  PetscCall(RowSetGetColumns(&set, neumann->positions, transfer->column_x));
  PetscCall(RowSetGetColumns(&set, transfer->neumann->smooth, transfer->column_normals));
  for (PetscInt row = 0; row < transfer->n; row++) {
    set.beyond[row] = (PetscBool)(marks[row] == MARK_BEYOND);
    set.area[row]   = lumped[row];
    if (transfer->keep[row]) KeepRow(transfer, row, &set);
    else PetscCall(FinishRow(transfer, row, ends[row], seen + 3 * row, near, behind, &set));
    if (!set.opposite[row]) set.area[row] = 0;
  }
  PetscCall(TakeRows(transfer, &set));
  PetscCall(PetscFree4(marks, lumped, ends, seen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the rows against an obstacle: its distance, linearised at the present position of each node */
PetscErrorCode TransferBuildObstacleRows(Transfer transfer, PetscReal near)
{
  const SurfaceData *data = &transfer->dirichlet->data;
  const PetscInt     dim  = transfer->dim;
  RowSet             set;

  PetscFunctionBegin;
  PetscCall(RowSetAllocate(dim, transfer->n, 0, &set));
  for (PetscInt row = 0; row < transfer->n; row++) {
    const PetscReal *x = data->positions + 3 * row, *reference = data->reference + 3 * row;
    PetscReal        gradient[3], distance;

    if (transfer->keep[row]) {
      KeepRow(transfer, row, &set);
      continue;
    }
    PetscCall(ObstacleGetGap(transfer->obstacle, x, &distance, gradient));
    set.opposite[row] = (PetscBool)(distance <= near && Dot(gradient, data->normals + 3 * row) < OPPOSED);
    set.area[row]     = set.opposite[row] ? data->areas[row] : 0;
    set.gap[row]      = set.opposite[row] ? distance : PETSC_MAX_REAL;
    for (PetscInt d = 0; d < dim; d++) {
      set.normals[dim * row + d] = -gradient[d];
      if (set.opposite[row]) set.gap[row] -= gradient[d] * (x[d] - reference[d]);
    }
  }
  PetscCall(TakeRows(transfer, &set));
  PetscFunctionReturn(PETSC_SUCCESS);
}
