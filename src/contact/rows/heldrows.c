/* A held row, whose Dirichlet node the user holds in place, is no condition on that node and has no force of its own. But to leave the row
   out would leave out the pressure between the rim of the interface and the nodes beside it. So a held row is dropped, and its share goes
   to the rows of neighbouring nodes, its heirs, as with multipliers at crosspoints (Wohlmuth 2000; Puso, Laursen 2003). With weights w_kh
   of the heirs k, which sum to one for each held node h, the multiplier functions psi_k + sum_h w_kh psi_h sum to one over the whole
   interface. The rows of the heirs become

     (A_k row_k + sum_h w_kh A_h row_h) / A'_k,   A'_k = A_k + sum_h w_kh A_h,

   with the areas A. A force on such a row has the same resultant and moment on both sides, since a force on each of its parts has.

   The gap of such a row is a mean. If rows may open, the mean must not hide that one of its parts is closed: only rows between parallel
   surfaces are merged.

   Methods that prescribe displacements have no use for a held row, and leave out those without heirs. Where bodies answer to forces, rows
   of held nodes are dropped at rims alone. Which rows are held: see droppedrows.c. */
#include <contact/parts.h>

/* Edges between a held row and its heirs, where held rows that have none are of use: two at the corner of a rim */
#define RIM 2

/* Surfaces are parallel between two nodes if their gaps differ by less than this part of the distance of the nodes: by half a degree */
#define PARALLEL 0.01

/* A number that the transfers have for each row */
typedef enum { ROW_AREA, ROW_GAP, ROW_NORMAL } RowNumber;

/* Such a number of all rows of this rank, before any are merged; of normals the component d */
static PetscErrorCode GetRows(Contact contact, RowNumber which, PetscInt d, Vec vec)
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(vec, &values));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];
    const PetscBool    tied = ContactPairTies(pair);
    TransferRows       rows;

    PetscCall(TransferGetRows(pair->transfer, &rows));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      const PetscInt node = (i - pair->begin) / pair->components, k = (i - pair->begin) % pair->components;
      PetscReal      direction[3];

      ContactGetDirection(contact, pair, &rows, i, direction);
      if (which == ROW_AREA) values[i] = rows.area[node];
      else if (which == ROW_GAP) values[i] = tied || k > 0 || !rows.opposite[node] ? 0 : rows.gap[node];
      else values[i] = direction[d];
    }
  }
  PetscCall(VecRestoreArrayWrite(vec, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix of rows by rows, with ones where the nodes of two rows have an edge in common and, if rows may open, parallel surfaces there */
static PetscErrorCode CreateNeighbours(Contact contact, Mat *neighbours)
{
  PetscFunctionBegin;
  PetscCall(ContactCreateRowMatrix(contact, neighbours));
  PetscCall(MatSetOption(*neighbours, MAT_NO_OFF_PROC_ENTRIES, PETSC_FALSE)); /* edges have nodes of other ranks */
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair  = &contact->pairs[p];
    const PetscReal    slope = ContactPairTies(pair) ? PETSC_MAX_REAL : PARALLEL;

    if (!pair->obstacle)
      PetscCall(TransferSetNeighbours(pair->transfer, contact->rows.begin + pair->begin, pair->components, slope, *neighbours));
  }
  PetscCall(MatAssemblyBegin(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Dropped rows without heirs beside heirs or rows with some (`known`): `now` becomes one there, `part` one over the number of these. */
static PetscErrorCode FindNext(Contact contact, Mat neighbours, Vec known, Vec now, Vec part, PetscBool *any)
{
  const PetscScalar *has;
  PetscScalar       *values, *parts;

  PetscFunctionBegin;
  PetscCall(MatMult(neighbours, known, part));
  PetscCall(VecGetArrayRead(known, &has));
  PetscCall(VecGetArrayWrite(now, &values));
  PetscCall(VecGetArray(part, &parts));
  *any = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscBool next = (PetscBool)(contact->held.dropped[i] && PetscRealPart(has[i]) == 0 && PetscRealPart(parts[i]) > 0);

    values[i] = next ? 1 : 0;
    parts[i]  = next ? 1 / parts[i] : 0;
    if (next) *any = PETSC_TRUE;
  }
  PetscCall(VecRestoreArray(part, &parts));
  PetscCall(VecRestoreArrayWrite(now, &values));
  PetscCall(VecRestoreArrayRead(known, &has));
  PetscCall(ContactOr(contact, any));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix with the weights w_kh in row h. The share of a held node goes in equal parts to neighbours that are not; if there are none, as
   at a corner, to the heirs of its neighbours. Other rows are the identity's, and zero if dropped without heirs. */
static PetscErrorCode CreateWeights(Contact contact, Mat *weights)
{
  const PetscInt most = contact->sideless ? RIM : PETSC_INT_MAX;
  PetscScalar   *has, *diagonal;
  Mat            neighbours, given, inherited;
  Vec            known, now, part;
  PetscBool      any;

  PetscFunctionBegin;
  PetscCall(CreateNeighbours(contact, &neighbours));
  PetscCall(MatCreateVecs(neighbours, &known, &now));
  PetscCall(VecDuplicate(now, &part));
  PetscCall(MatDuplicate(neighbours, MAT_DO_NOT_COPY_VALUES, weights));
  PetscCall(VecGetArrayWrite(known, &has));
  for (PetscInt i = 0; i < contact->rows.n; i++) has[i] = contact->rows.opposite[i] && !contact->held.dropped[i] ? 1 : 0;
  PetscCall(VecRestoreArrayWrite(known, &has));
  PetscCall(MatDiagonalSet(*weights, known, INSERT_VALUES));
  PetscCall(FindNext(contact, neighbours, known, now, part, &any));
  for (PetscInt edges = 0; any && edges < most; edges++) {
    PetscCall(MatDuplicate(neighbours, MAT_COPY_VALUES, &given));
    PetscCall(MatDiagonalScale(given, part, known));
    PetscCall(MatMatMult(given, *weights, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &inherited));
    PetscCall(MatAXPY(*weights, 1, inherited, DIFFERENT_NONZERO_PATTERN));
    PetscCall(VecAXPY(known, 1, now));
    PetscCall(MatDestroy(&inherited));
    PetscCall(MatDestroy(&given));
    PetscCall(FindNext(contact, neighbours, known, now, part, &any));
  }
  PetscCall(VecGetArray(known, &has));
  PetscCall(VecGetArrayWrite(now, &diagonal));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (contact->sideless && has[i] == 0) contact->held.dropped[i] = PETSC_FALSE; /* without heirs rows stay as they are */
    diagonal[i] = contact->held.dropped[i] ? 0 : 1;
  }
  PetscCall(VecRestoreArrayWrite(now, &diagonal));
  PetscCall(VecRestoreArray(known, &has));
  PetscCall(MatDiagonalSet(*weights, now, INSERT_VALUES));
  PetscCall(VecDestroy(&part));
  PetscCall(VecDestroy(&now));
  PetscCall(VecDestroy(&known));
  PetscCall(MatDestroy(&neighbours));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the matrix of new rows by old rows, finds out which rows of this rank are heirs, and sets the areas to those of the new rows */
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
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    contact->held.heir[i] = (PetscBool)(!contact->held.dropped[i] && sums[i] != areas[i]);
    contact->rows.area[i] = PetscRealPart(sums[i]);
    if (!contact->held.dropped[i] && !contact->held.heir[i]) areas[i] = 1;
    sums[i] = contact->held.heir[i] ? 1 / sums[i] : 1;
  }
  PetscCall(VecRestoreArray(scale, &sums));
  PetscCall(VecRestoreArray(before, &areas));
  PetscCall(MatTranspose(weights, MAT_INITIAL_MATRIX, &contact->held.merger));
  PetscCall(MatDiagonalScale(contact->held.merger, scale, before));
  PetscCall(MatCreateVecs(contact->held.merger, &contact->held.places, &contact->held.means));
  PetscCall(VecDestroy(&scale));
  PetscCall(VecDestroy(&before));
  PetscCall(MatDestroy(&weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets gaps and normals of the heirs, which are means. An earlier merger's part, merged_gap (0 in new rows), is taken out first. */
static PetscErrorCode MergeNumbers(Contact contact)
{
  const PetscScalar *own, *means;

  PetscFunctionBegin;
  PetscCall(GetRows(contact, ROW_GAP, 0, contact->held.places));
  PetscCall(MatMult(contact->held.merger, contact->held.places, contact->held.means));
  PetscCall(VecGetArrayRead(contact->held.places, &own));
  PetscCall(VecGetArrayRead(contact->held.means, &means));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal part = contact->held.heir[i] ? PetscRealPart(means[i] - own[i]) : 0;

    contact->rows.initial_gap[i] += part - contact->held.merged_gap[i];
    contact->held.merged_gap[i] = part;
  }
  PetscCall(VecRestoreArrayRead(contact->held.means, &means));
  PetscCall(VecRestoreArrayRead(contact->held.places, &own));
  for (PetscInt d = 0; d < contact->dim; d++) {
    PetscCall(GetRows(contact, ROW_NORMAL, d, contact->held.places));
    PetscCall(MatMult(contact->held.merger, contact->held.places, contact->held.means));
    PetscCall(VecGetArrayRead(contact->held.means, &means));
    for (PetscInt i = 0; i < contact->rows.n; i++)
      if (contact->held.heir[i]) contact->rows.normal[3 * i + d] = PetscRealPart(means[i]);
    PetscCall(VecRestoreArrayRead(contact->held.means, &means));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* If any row has changed, the rows of heirs may have changed with it: marks them, and takes the shifts of their gaps out */
static PetscErrorCode MarkHeirs(Contact contact)
{
  PetscBool any = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) any = (PetscBool)(any || contact->rows.changed[i]);
  PetscCall(ContactOr(contact, &any));
  for (PetscInt i = 0; i < contact->rows.n && any; i++) {
    if (contact->rows.changed[i] || !contact->held.heir[i]) continue;
    contact->rows.changed[i] = PETSC_TRUE;
    contact->rows.initial_gap[i] -= contact->rows.gap_shift[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Drops the held rows and gives their shares to heirs: areas, gaps and normals now, matrices by contact->held.merger (NULL: none) */
PetscErrorCode ContactMergeDroppedRows(Contact contact)
{
  PetscBool any = (PetscBool)(contact->held.merger != NULL);

  PetscFunctionBegin;
  PetscCall(ContactMarkHeldRows(contact));
  for (PetscInt i = 0; i < contact->rows.n; i++) any = (PetscBool)(any || contact->held.dropped[i]);
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MarkHeirs(contact));
  PetscCall(ContactDestroyMerger(contact));
  PetscCall(CreateMerger(contact));
  PetscCall(MarkHeirs(contact));
  if (contact->sideless) ContactLeaveOutDropped(contact);
  PetscCall(MergeNumbers(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Replaces the rows of the transfers in the matrix of a body by the merged ones. Heirs are rows of the same pair. */
PetscErrorCode ContactMergeMatrix(Contact contact, PetscInt b)
{
  const ContactBodyRows *of = &contact->body_rows[b];
  Mat                    merger, merged;
  IS                     rows;

  PetscFunctionBegin;
  if (!contact->held.merger) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ISCreateGeneral(PetscObjectComm((PetscObject)contact), of->n, of->all + of->begin, PETSC_USE_POINTER, &rows));
  PetscCall(MatCreateSubMatrix(contact->held.merger, rows, rows, MAT_INITIAL_MATRIX, &merger));
  PetscCall(MatMatMult(merger, contact->interfaces[b], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &merged));
  PetscCall(ISDestroy(&rows));
  PetscCall(MatDestroy(&merger));
  PetscCall(MatDestroy(&contact->interfaces[b]));
  contact->interfaces[b] = merged;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces on the rows as transfers have them, on this rank: a force on a merged row is one on each of its parts, along that part's normal */
PetscErrorCode ContactGetPartForces(Contact contact, Vec *parts)
{
  PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(contact->held.means, &force));
  PetscCall(PetscArraycpy(force, contact->end.force, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(contact->held.means, &force));
  PetscCall(MatMultTranspose(contact->held.merger, contact->held.means, contact->held.places));
  *parts = contact->held.places;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroyMerger(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&contact->held.merger));
  PetscCall(VecDestroy(&contact->held.places));
  PetscCall(VecDestroy(&contact->held.means));
  PetscFunctionReturn(PETSC_SUCCESS);
}
