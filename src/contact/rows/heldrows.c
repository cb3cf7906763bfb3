/*
   Rows whose Dirichlet node is held already are no conditions on it, and have no force of their own. To leave them out would leave out
   the pressure between the rim of the interface and the nodes beside it. So their share goes to the rows of neighbouring nodes, as
   multipliers at crosspoints do (Wohlmuth 2000; Puso, Laursen 2003): with the weights w_kh of the heirs k, that sum to one for each held
   node h, their multiplier functions psi_k + sum_h w_kh psi_h sum to one over the whole interface. Their rows become

     (A_k row_k + sum_h w_kh A_h row_h) / A'_k,   A'_k = A_k + sum_h w_kh A_h,

   with the areas A. Forces on them have the same resultant and moment on both sides, since those on each of the rows do.

   The gap of such a row is a mean. Where rows may open it must not hide that one of them is closed: only rows of surfaces that are parallel
   there are merged, and held nodes without such neighbours are left out.
*/
#include <impakt/private/contactimpl.h>

/* Gaps of parallel surfaces differ by less than this part of the distance */
#define PARALLEL 0.01

/* What the transfers say of a row */
typedef enum { ROW_AREA, ROW_GAP, ROW_NORMAL } RowNumber;

/* One component of it, for all rows of this rank, before any are merged */
static PetscErrorCode GetRows(Contact contact, RowNumber which, PetscInt d, Vec vec)
{
  const PetscBool tied = (PetscBool)(contact->law == CONTACT_LAW_TIED);
  PetscScalar    *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(vec, &values));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    TransferRows       rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;

      if (which == ROW_AREA) values[i] = rows.area[node];
      else if (which == ROW_GAP) values[i] = tied || !rows.opposite[node] ? 0 : rows.gap[node];
      else if (tied) values[i] = d == k ? 1 : 0;
      else values[i] = rows.normals[contact->dim * node + d];
    }
  }
  PetscCall(VecRestoreArrayWrite(vec, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which rows belong to nodes with an edge in common, on surfaces that are parallel there as far as rows may open */
static PetscErrorCode CreateNeighbours(Contact contact, Mat *neighbours)
{
  const PetscReal slope = contact->law == CONTACT_LAW_TIED ? PETSC_MAX_REAL : PARALLEL;

  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), neighbours));
  PetscCall(MatSetSizes(*neighbours, contact->n_rows, contact->n_rows, contact->n_all_rows, contact->n_all_rows));
  PetscCall(MatSetType(*neighbours, MATAIJ));
  PetscCall(MatSetUp(*neighbours));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (!pair->obstacle)
      PetscCall(TransferSetNeighbours(pair->transfer, contact->row_begin + pair->begin, pair->components, slope, *neighbours));
  }
  PetscCall(MatAssemblyBegin(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Dropped rows that no heir is known of, but of neighbours: `now` becomes one on them, and `part` one over the number of these neighbours
 */
static PetscErrorCode FindNext(Contact contact, Mat neighbours, Vec known, Vec now, Vec part, int *any)
{
  const PetscScalar *has;
  PetscScalar       *values, *parts;

  PetscFunctionBegin;
  PetscCall(MatMult(neighbours, known, part));
  PetscCall(VecGetArrayRead(known, &has));
  PetscCall(VecGetArrayWrite(now, &values));
  PetscCall(VecGetArray(part, &parts));
  *any = 0;
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscBool next = (PetscBool)(contact->dropped[i] && PetscRealPart(has[i]) == 0 && PetscRealPart(parts[i]) > 0);

    values[i] = next ? 1 : 0;
    parts[i]  = next ? 1 / parts[i] : 0;
    if (next) *any = 1;
  }
  PetscCall(VecRestoreArray(part, &parts));
  PetscCall(VecRestoreArrayWrite(now, &values));
  PetscCall(VecRestoreArrayRead(known, &has));
  PetscCall(ContactOr(contact, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Row h: the weights w_kh. A held node with neighbours that are not shares equally among them; one without, at a corner, among the heirs of
   its neighbours. The other rows are those of the identity, as are those of held nodes that nobody inherits from. */
static PetscErrorCode CreateWeights(Contact contact, Mat *weights)
{
  Mat neighbours, given, inherited;
  Vec known, now, part;
  int any;

  PetscFunctionBegin;
  PetscCall(CreateNeighbours(contact, &neighbours));
  PetscCall(MatCreateVecs(neighbours, &known, &now));
  PetscCall(VecDuplicate(now, &part));
  PetscCall(MatDuplicate(neighbours, MAT_DO_NOT_COPY_VALUES, weights));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    PetscCall(VecSetValue(known, contact->row_begin + i, contact->opposite[i] ? 1 : 0, INSERT_VALUES));
    PetscCall(VecSetValue(now, contact->row_begin + i, contact->dropped[i] ? 0 : 1, INSERT_VALUES));
  }
  PetscCall(VecAssemblyBegin(known));
  PetscCall(VecAssemblyEnd(known));
  PetscCall(VecAssemblyBegin(now));
  PetscCall(VecAssemblyEnd(now));
  PetscCall(MatDiagonalSet(*weights, now, INSERT_VALUES));
  PetscCall(FindNext(contact, neighbours, known, now, part, &any));
  while (any) {
    PetscCall(MatDuplicate(neighbours, MAT_COPY_VALUES, &given));
    PetscCall(MatDiagonalScale(given, part, known));
    PetscCall(MatMatMult(given, *weights, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &inherited));
    PetscCall(MatAXPY(*weights, 1, inherited, DIFFERENT_NONZERO_PATTERN));
    PetscCall(VecAXPY(known, 1, now));
    PetscCall(MatDestroy(&inherited));
    PetscCall(MatDestroy(&given));
    PetscCall(FindNext(contact, neighbours, known, now, part, &any));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscInt row = contact->row_begin + i;
    PetscScalar    has;

    PetscCall(VecGetValues(known, 1, &row, &has));
    PetscCall(VecSetValue(now, row, contact->dropped[i] && PetscRealPart(has) > 0 ? 0 : 1, INSERT_VALUES));
  }
  PetscCall(VecAssemblyBegin(now));
  PetscCall(VecAssemblyEnd(now));
  PetscCall(MatDiagonalSet(*weights, now, INSERT_VALUES));
  PetscCall(VecDestroy(&part));
  PetscCall(VecDestroy(&now));
  PetscCall(VecDestroy(&known));
  PetscCall(MatDestroy(&neighbours));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of all new rows by all old ones, and whether rows of this rank are heirs; areas are those of the new rows afterwards */
static PetscErrorCode CreateMerger(Contact contact)
{
  PetscScalar *areas, *sums;
  Mat          weights;
  Vec          before, scale;

  PetscFunctionBegin;
  PetscCall(CreateWeights(contact, &weights));
  PetscCall(MatCreateVecs(weights, &scale, &before));
  PetscCall(GetRows(contact, ROW_AREA, 0, before));
  PetscCall(MatMultTranspose(weights, before, scale));
  PetscCall(VecGetArray(before, &areas));
  PetscCall(VecGetArray(scale, &sums));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    contact->heir[i] = (PetscBool)(!contact->dropped[i] && sums[i] != areas[i]);
    contact->area[i] = PetscRealPart(sums[i]);
    if (!contact->dropped[i] && !contact->heir[i]) areas[i] = 1;
    sums[i] = contact->heir[i] ? 1 / sums[i] : 1;
  }
  PetscCall(VecRestoreArray(scale, &sums));
  PetscCall(VecRestoreArray(before, &areas));
  PetscCall(MatTranspose(weights, MAT_INITIAL_MATRIX, &contact->merger));
  PetscCall(MatDiagonalScale(contact->merger, scale, before));
  PetscCall(MatCreateVecs(contact->merger, &contact->places, &contact->means));
  PetscCall(VecDestroy(&scale));
  PetscCall(VecDestroy(&before));
  PetscCall(MatDestroy(&weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gaps and directions of the heirs are means. A gap has that of the last merger in it, unless its row has been described since. */
static PetscErrorCode MergeNumbers(Contact contact)
{
  const PetscScalar *own, *means;

  PetscFunctionBegin;
  PetscCall(GetRows(contact, ROW_GAP, 0, contact->places));
  PetscCall(MatMult(contact->merger, contact->places, contact->means));
  PetscCall(VecGetArrayRead(contact->places, &own));
  PetscCall(VecGetArrayRead(contact->means, &means));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscReal part = contact->heir[i] ? PetscRealPart(means[i] - own[i]) : 0;

    contact->initial_gap[i] += part - contact->merged_gap[i];
    contact->merged_gap[i] = part;
  }
  PetscCall(VecRestoreArrayRead(contact->means, &means));
  PetscCall(VecRestoreArrayRead(contact->places, &own));
  for (PetscInt d = 0; d < contact->dim; d++) {
    PetscCall(GetRows(contact, ROW_NORMAL, d, contact->places));
    PetscCall(MatMult(contact->merger, contact->places, contact->means));
    PetscCall(VecGetArrayRead(contact->means, &means));
    for (PetscInt i = 0; i < contact->n_rows; i++)
      if (contact->heir[i]) contact->row_normal[3 * i + d] = PetscRealPart(means[i]);
    PetscCall(VecRestoreArrayRead(contact->means, &means));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where any row has changed, heirs before and after may have, without a shift of their own */
static PetscErrorCode MarkHeirs(Contact contact)
{
  int any = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) any |= contact->changed[i];
  PetscCall(ContactOr(contact, &any));
  for (PetscInt i = 0; i < contact->n_rows && any; i++) {
    if (contact->changed[i] || !contact->heir[i]) continue;
    contact->changed[i] = PETSC_TRUE;
    contact->initial_gap[i] -= contact->gap_shift[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that have been dropped because their node is held give their share to their neighbours: areas, gaps and directions at once, and
   contact->merger makes matrices of the new rows of those of the old; NULL where none has been dropped */
PetscErrorCode ContactMergeDroppedRows(Contact contact)
{
  int any = contact->merger ? 1 : 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->n_rows; i++) any |= contact->dropped[i];
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MarkHeirs(contact));
  PetscCall(ContactDestroyMerger(contact));
  PetscCall(CreateMerger(contact));
  PetscCall(MarkHeirs(contact));
  PetscCall(MergeNumbers(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the rows that have been merged in place of those of the transfers */
PetscErrorCode ContactMergeMatrix(Contact contact, Mat *rows)
{
  Mat merged;

  PetscFunctionBegin;
  if (!contact->merger) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatMatMult(contact->merger, *rows, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &merged));
  PetscCall(MatDestroy(rows));
  *rows = merged;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This rank's share of the moment of a pair about the origin: a force on a merged row acts where its nodes are, along their directions.
   `reference` and `displacement` are those of the first body. */
PetscErrorCode ContactSumMergedMoments(Contact contact, const ContactPair *pair, const PetscScalar reference[],
                                       const PetscScalar displacement[], PetscReal moment[])
{
  const PetscInt     dim = contact->dim;
  const PetscScalar *means, *own;
  PetscScalar       *levers;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) {
      const PetscInt  third = 3 - a - b;
      const PetscReal sign  = (b - a + 3) % 3 == 1 ? 1 : -1;

      if (a == b) continue; /* x_a n_b is a part of the third component */
      PetscCall(GetRows(contact, ROW_NORMAL, b, contact->places));
      PetscCall(VecGetArray(contact->places, &levers));
      for (PetscInt i = 0; i < contact->n_rows; i++)
        levers[i] *= i >= pair->begin && i < pair->end ? reference[contact->row_dof[i] + a] + displacement[contact->row_dof[i] + a] : 0;
      PetscCall(VecRestoreArray(contact->places, &levers));
      PetscCall(MatMult(contact->merger, contact->places, contact->means));
      PetscCall(VecGetArrayRead(contact->places, &own));
      PetscCall(VecGetArrayRead(contact->means, &means));
      for (PetscInt i = pair->begin; i < pair->end; i++)
        moment[third] += sign * contact->force[i] * PetscRealPart(contact->heir[i] ? means[i] : own[i]);
      PetscCall(VecRestoreArrayRead(contact->means, &means));
      PetscCall(VecRestoreArrayRead(contact->places, &own));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyMerger(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&contact->merger));
  PetscCall(VecDestroy(&contact->places));
  PetscCall(VecDestroy(&contact->means));
  PetscFunctionReturn(PETSC_SUCCESS);
}
