/*
   Rows whose Dirichlet node is held already are no conditions on it, and have no force of their own. To leave them out would leave out
   the pressure between the rim of the interface and the nodes beside it. So their share goes to the rows of neighbouring nodes, as
   multipliers at crosspoints do (Wohlmuth 2000; Puso, Laursen 2003): with the weights w_kh of the heirs k, that sum to one for each held
   node h, their multiplier functions psi_k + sum_h w_kh psi_h sum to one over the whole interface. Their rows become

     (A_k row_k + sum_h w_kh A_h row_h) / A'_k,   A'_k = A_k + sum_h w_kh A_h,

   with the areas A. Forces on them have the same resultant and moment on both sides, since those on each of the rows do.
*/
#include "contactimpl.h"

/* Which rows belong to nodes with an edge in common */
static PetscErrorCode CreateNeighbours(Contact contact, Mat *neighbours)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PetscObjectComm((PetscObject)contact), neighbours));
  PetscCall(MatSetSizes(*neighbours, contact->n_rows, contact->n_rows, contact->n_all_rows, contact->n_all_rows));
  PetscCall(MatSetType(*neighbours, MATAIJ));
  PetscCall(MatSetUp(*neighbours));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    if (!pair->obstacle) PetscCall(TransferSetNeighbours(pair->transfer, contact->row_begin + pair->begin, pair->components, *neighbours));
  }
  PetscCall(MatAssemblyBegin(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*neighbours, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Dropped rows that no heir is known of, but of neighbours: `now` becomes one on them, and `part` one over the number of these neighbours */
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

/* Row h: the weights w_kh. A held node with neighbours that are not shares equally among them; one without, at a corner, among the heirs of its
   neighbours. The other rows are those of the identity. */
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
  PetscCall(VecDestroy(&part));
  PetscCall(VecDestroy(&now));
  PetscCall(VecDestroy(&known));
  PetscCall(MatDestroy(&neighbours));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Areas before and after; where they differ, the heirs get theirs, and `before` and `scale` what makes means of sums. Ones elsewhere. */
static PetscErrorCode ShareAreas(Contact contact, Mat weights, Vec before, Vec scale)
{
  PetscScalar *areas, *sums;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(before, &areas));
  for (PetscInt i = 0; i < contact->n_rows; i++) areas[i] = contact->area[i];
  PetscCall(VecRestoreArrayWrite(before, &areas));
  PetscCall(MatMultTranspose(weights, before, scale));
  PetscCall(VecGetArray(before, &areas));
  PetscCall(VecGetArray(scale, &sums));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    const PetscBool heir = (PetscBool)(!contact->dropped[i] && sums[i] != areas[i]);

    if (heir || contact->dropped[i]) contact->area[i] = PetscRealPart(sums[i]);
    if (!heir && !contact->dropped[i]) areas[i] = 1;
    sums[i] = heir ? 1 / sums[i] : 1;
  }
  PetscCall(VecRestoreArray(scale, &sums));
  PetscCall(VecRestoreArray(before, &areas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows that have been dropped because their node is held give their areas to their neighbours, and contact->merger makes matrices of the new rows
   of those of the old; NULL where none has been dropped */
PetscErrorCode ContactMergeDroppedRows(Contact contact)
{
  Mat weights;
  Vec before, scale;
  int any = 0;

  PetscFunctionBegin;
  PetscCall(ContactDestroyMerger(contact));
  for (PetscInt i = 0; i < contact->n_rows; i++) any |= contact->dropped[i];
  PetscCall(ContactOr(contact, &any));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CreateWeights(contact, &weights));
  PetscCall(MatCreateVecs(weights, &scale, &before));
  PetscCall(ShareAreas(contact, weights, before, scale));
  PetscCall(MatTranspose(weights, MAT_INITIAL_MATRIX, &contact->merger));
  PetscCall(MatDiagonalScale(contact->merger, scale, before));
  PetscCall(MatCreateVecs(contact->merger, &contact->places, &contact->means));
  PetscCall(VecDestroy(&scale));
  PetscCall(VecDestroy(&before));
  PetscCall(MatDestroy(&weights));
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

/* This rank's share of the moment of a pair about the origin: forces on merged rows act at the means of the places x of their nodes, dim numbers
   for each displacement block of the first body */
PetscErrorCode ContactSumMergedMoments(Contact contact, const ContactPair *pair, const PetscScalar reference[], const PetscScalar displacement[], PetscReal moment[])
{
  const PetscScalar *means;
  PetscScalar       *places;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < contact->dim; d++) {
    const PetscInt next = (d + 1) % 3, last = (d + 2) % 3;

    PetscCall(VecZeroEntries(contact->places));
    PetscCall(VecGetArray(contact->places, &places));
    for (PetscInt i = pair->begin; i < pair->end; i++) places[i] = reference[contact->row_dof[i] + d] + displacement[contact->row_dof[i] + d];
    PetscCall(VecRestoreArray(contact->places, &places));
    PetscCall(MatMult(contact->merger, contact->places, contact->means));
    PetscCall(VecGetArrayRead(contact->means, &means));
    for (PetscInt i = pair->begin; i < pair->end; i++) {
      moment[last] += contact->force[i] * PetscRealPart(means[i]) * contact->row_normal[3 * i + next];
      moment[next] -= contact->force[i] * PetscRealPart(means[i]) * contact->row_normal[3 * i + last];
    }
    PetscCall(VecRestoreArrayRead(contact->means, &means));
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
