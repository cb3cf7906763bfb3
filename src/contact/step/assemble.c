/* S, what touching rows read by forces on them, from how bodies answer: S = sum of B_b W_b B_b^T, on every rank. Where no node of a body
   answers to forces on others W_b is diagonal. The part of such bodies is the product R R^T of sparse matrices, R being the columns of all
   B_b times the roots of the diagonals, side by side. R and its product are kept while entries stay in place. Each other body has a block,
   between all of its rows. Where these are a small part of a matrix of all rows by all rows, as those of many bodies are, S is sparse. */
#include "stepimpl.h"
#include <impakt/private/bodyforces.h>

#define FEW_ROWS  60    /* up to so many S is dense whatever it is made of, */
#define MANY_ROWS 150   /* and up to so many where bodies have blocks, whose LU factors are exact where bodies hang on soft springs */
#define SPARSE    0.25  /* blocks of bodies that are at most this part of S make it sparse */
#define ZERO      1e-14 /* entries of rows that are zero but for round-off; the largest are 1 or so */
#define SMALL     1e-3  /* entries that are left out where S is approximate all the same, in parts of the largest of their row */

PetscErrorCode ContactStepperDestroyAssembly(StepperAssembly *assembly)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    StepperEntries *entries = &assembly->of_body[b];

    PetscCall(PetscFree4(entries->rows, entries->places, entries->begin, entries->product));
    PetscCall(PetscFree4(entries->columns, entries->dofs, entries->values, entries->answers));
    PetscCall(PetscFree2(entries->block, entries->own));
    PetscCall(StepperSecantsDestroy(&entries->secants));
    PetscCall(StepperSecantsDestroy(&entries->kept));
    PetscCall(VecDestroy(&entries->force));
    PetscCall(VecDestroy(&entries->way));
  }
  PetscCall(PetscFree(assembly->of_body));
  PetscCall(MatDestroy(&assembly->product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How large an entry of a row is that counts. Rows along an axis have entries of zero along the others, each of which would ask for a
   column of the compliance; `small`: so they have where the axis has turned a little, which secants make up for. */
static PetscReal Least(PetscBool small, PetscInt n, const PetscScalar values[])
{
  PetscReal largest = 0;

  for (PetscInt e = 0; e < n && small; e++) largest = PetscMax(largest, PetscAbsScalar(values[e]));
  return PetscMax(ZERO, SMALL * largest);
}

/* Entries that `rows` has of the touching rows of a body, of which each rank has its own, on all ranks. small: without the small ones. */
static PetscErrorCode GetEntries(Contact contact, StepperEntries *entries, PetscInt b, Mat rows, PetscBool small)
{
  const PetscInt first = contact->body_rows[b].begin, end = first + contact->body_rows[b].n;
  PetscInt      *begin = entries->begin, total = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(begin, entries->n + 1));
  for (PetscInt fills = 0; fills < 2; fills++) {
    for (PetscInt k = 0; k < entries->n; k++) {
      const PetscInt     row = entries->rows[k], *columns;
      const PetscScalar *values;
      PetscReal          least;
      PetscInt           n, at = begin[k];

      if (row < first || row >= end) continue;
      PetscCall(MatGetRow(rows, row, &n, &columns, &values));
      least = Least(small, n, values);
      for (PetscInt e = 0; e < n; e++) {
        if (PetscAbsScalar(values[e]) <= least) continue;
        if (fills) entries->columns[at] = columns[e];
        if (fills) entries->values[at++] = values[e];
        else begin[k + 1]++;
      }
      PetscCall(MatRestoreRow(rows, row, &n, &columns, &values));
    }
    if (fills) break;
    PetscCall(ContactReduce(contact, entries->n, MPIU_INT, MPI_SUM, begin + 1));
    for (PetscInt k = 0; k < entries->n; k++) begin[k + 1] += begin[k];
    total = begin[entries->n];
    if (total > entries->room) {
      entries->room = 2 * total;
      PetscCall(PetscFree4(entries->columns, entries->dofs, entries->values, entries->answers));
      PetscCall(PetscMalloc4(entries->room, &entries->columns, entries->room, &entries->dofs, entries->room, &entries->values,
                             entries->room, &entries->answers));
    }
    PetscCall(PetscArrayzero(entries->columns, total));
    PetscCall(PetscArrayzero(entries->values, total));
  }
  PetscCall(ContactReduce(contact, total, MPIU_INT, MPI_SUM, entries->columns));
  PetscCall(ContactReduce(contact, total, MPIU_SCALAR, MPIU_SUM, entries->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacements in which the touching rows of a body have entries, and the place of each entry among these */
static PetscErrorCode ListDofs(StepperEntries *entries)
{
  const PetscInt total = entries->begin[entries->n];

  PetscFunctionBegin;
  entries->n_dofs = total;
  PetscCall(PetscArraycpy(entries->dofs, entries->columns, total));
  PetscCall(PetscSortRemoveDupsInt(&entries->n_dofs, entries->dofs));
  for (PetscInt e = 0; e < total; e++) PetscCall(PetscFindInt(entries->columns[e], entries->n_dofs, entries->dofs, &entries->columns[e]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for the block of a body whose nodes answer to each other */
static PetscErrorCode BeginBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries *entries = &stepper->assembly.of_body[b];
  const PetscInt  n       = entries->n;

  PetscFunctionBegin;
  if (n * n > entries->block_room) {
    entries->block_room = 2 * n * n;
    PetscCall(PetscFree2(entries->block, entries->own));
    PetscCall(PetscMalloc2(entries->block_room, &entries->block, entries->block_room, &entries->own));
  }
  entries->corrected = PETSC_FALSE;
  PetscCall(PetscArrayzero(entries->own, n * n));
  PetscCall(BodyNodalComplianceFollows(contact->bodies[b], entries->n_dofs, &entries->follows));
  if (!entries->follows) PetscCall(ContactStepperMakeBlock(contact, stepper, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B_b W_b B_b^T of a body whose nodes answer to each other: for each row, how the displacements go under a unit force along it */
PetscErrorCode ContactStepperMakeBlock(Contact contact, ContactStepper *stepper, PetscInt b)
{
  StepperEntries    *entries = &stepper->assembly.of_body[b];
  const PetscInt     n = entries->n, count = entries->n_dofs, *dofs = entries->dofs, *columns = entries->columns, *place;
  PetscInt           leading;
  PetscScalar       *moved = entries->answers;
  const PetscScalar *W;

  PetscFunctionBegin;
  PetscCall(BodyGetNodalCompliance(contact->bodies[b], stepper->rules[b]->shape, count, dofs, &place, &leading, &W));
  PetscCall(PetscArrayzero(entries->own, n * n));
  for (PetscInt l = 0; l < n; l++) {
    PetscScalar *column = entries->own + l * n;

    PetscCall(PetscArrayzero(moved, count));
    for (PetscInt f = entries->begin[l]; f < entries->begin[l + 1]; f++) {
      const PetscScalar *answers = W + place[dofs[columns[f]]] * leading;

      for (PetscInt d = 0; d < count; d++) moved[d] += entries->values[f] * answers[place[dofs[d]]];
    }
    for (PetscInt k = 0; k < n; k++)
      for (PetscInt e = entries->begin[k]; e < entries->begin[k + 1]; e++) column[k] += entries->values[e] * moved[columns[e]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The entries that a body whose nodes answer to the forces on them alone has in R, with columns behind those of bodies before it */
static PetscErrorCode ScaleEntries(Contact contact, StepperEntries *entries, Vec diagonal, PetscInt *n_columns)
{
  const PetscScalar *values;
  PetscScalar       *roots = entries->answers;
  PetscInt           begin, end;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(diagonal, &begin, &end));
  PetscCall(VecGetArrayRead(diagonal, &values));
  for (PetscInt d = 0; d < entries->n_dofs; d++)
    roots[d] = entries->dofs[d] >= begin && entries->dofs[d] < end ? PetscSqrtScalar(values[entries->dofs[d] - begin]) : 0;
  PetscCall(VecRestoreArrayRead(diagonal, &values));
  PetscCall(ContactReduce(contact, entries->n_dofs, MPIU_SCALAR, MPIU_SUM, roots));
  for (PetscInt e = 0; e < entries->begin[entries->n]; e++) {
    entries->values[e] *= roots[entries->columns[e]];
    entries->columns[e] += *n_columns;
  }
  *n_columns += entries->n_dofs;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* R R^T. Columns of R are the displacements in which rows have entries, those of one body behind those of another. */
static PetscErrorCode MultiplyRows(PetscInt n, PetscInt n_columns, StepperAssembly *assembly)
{
  PetscInt *counts;
  Mat       R, transpose;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n, &counts));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    for (PetscInt k = 0; k < entries->n && entries->alone; k++) counts[entries->places[k]] += entries->begin[k + 1] - entries->begin[k];
  }
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n_columns, 0, counts, &R));
  PetscCall(PetscFree(counts));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    for (PetscInt k = 0; k < entries->n && entries->alone; k++) {
      const PetscInt begin = entries->begin[k], count = entries->begin[k + 1] - begin;

      PetscCall(MatSetValues(R, 1, &entries->places[k], count, entries->columns + begin, entries->values + begin, INSERT_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(R, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(R, MAT_FINAL_ASSEMBLY));
  PetscCall(MatTranspose(R, MAT_INITIAL_MATRIX, &transpose)); /* MatMatTransposeMult() takes longer */
  PetscCall(MatDestroy(&assembly->product));
  PetscCall(MatMatMult(R, transpose, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &assembly->product));
  PetscCall(MatDestroy(&transpose));
  PetscCall(MatDestroy(&R));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether bodies with touching rows answer node by node (true), or have blocks (false) */
static PetscBool AnyBody(const StepperAssembly *assembly, PetscBool alone)
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt b = 0; b < assembly->n_bodies; b++)
    any = (PetscBool)(any || (assembly->of_body[b].n && assembly->of_body[b].alone == alone));
  return any;
}

/* Of how many entries the blocks of bodies are, in parts of those of S */
static PetscReal BlockPart(const ContactStepper *stepper)
{
  PetscReal sum = 0;

  for (PetscInt b = 0; b < stepper->assembly.n_bodies; b++) {
    const StepperEntries *entries = &stepper->assembly.of_body[b];

    if (!entries->alone) sum += (PetscReal)entries->n * entries->n;
  }
  return sum / ((PetscReal)stepper->problem.n * stepper->problem.n);
}

/* S as a sum of R R^T and blocks. A dense one is that which there is, where it has the size. */
static PetscErrorCode SumParts(ContactStepper *stepper, PetscBool sparse, Mat *S)
{
  const PetscInt         n        = stepper->problem.n;
  const StepperAssembly *assembly = &stepper->assembly;
  PetscInt               size     = -1;

  PetscFunctionBegin;
  if (!sparse && !stepper->problem.sparse) PetscCall(MatGetSize(stepper->problem.S, &size, NULL));
  *S = stepper->problem.S;
  if (size == n) PetscCall(PetscObjectReference((PetscObject)*S));
  else if (!sparse) PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, n, n, NULL, S));
  else {
    PetscInt *counts; /* more than there are: two rows may share both of their bodies */

    PetscCall(PetscCalloc1(n, &counts));
    for (PetscInt b = 0; b < assembly->n_bodies; b++) {
      const StepperEntries *entries = &assembly->of_body[b];

      for (PetscInt k = 0; k < entries->n && !entries->alone; k++) counts[entries->places[k]] += entries->n;
    }
    PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, counts, S));
    PetscCall(PetscFree(counts));
  }
  PetscCall(MatZeroEntries(*S));
  PetscCall(MatSetOption(*S, MAT_ROW_ORIENTED, PETSC_FALSE));
  for (PetscInt b = 0; b < assembly->n_bodies; b++) {
    const StepperEntries *entries = &assembly->of_body[b];

    if (entries->alone || !entries->n) continue;
    PetscCall(MatSetValues(*S, entries->n, entries->places, entries->n, entries->places, entries->block, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(*S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*S, MAT_FINAL_ASSEMBLY));
  if (AnyBody(assembly, PETSC_TRUE))
    PetscCall(MatAXPY(*S, 1, assembly->product, sparse ? DIFFERENT_NONZERO_PATTERN : SUBSET_NONZERO_PATTERN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What S is made of, from the bodies; of products a matrix near S is made, as if each dof of a layer moved alone */
static PetscErrorCode GetParts(Contact contact, ContactStepper *stepper)
{
  StepperAssembly *assembly  = &stepper->assembly;
  PetscInt         n_columns = 0; /* of R */

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    StepperEntries *entries = &assembly->of_body[b];
    const Body      body    = contact->bodies[b];
    Mat             rows    = contact->interfaces[b], K;
    Vec             diagonal, of_layer = NULL;

    if (!entries->n) continue;
    PetscCall(BodyGetNodalDiagonal(body, stepper->rules[b]->shape, &diagonal));
    if (stepper->products) {
      PetscCall(BodyGetLayerMatrices(body, &K, &rows));
      PetscCall(MatCreateVecs(K, &of_layer, NULL));
      PetscCall(MatGetDiagonal(K, of_layer));
      PetscCall(VecReciprocal(of_layer));
      diagonal = of_layer;
    }
    PetscCall(
        GetEntries(contact, entries, b, rows, (PetscBool)(BodyDoes(body, BodyIsExplicit) && !BodyDoes(body, BodyIsLinear) && !diagonal)));
    PetscCall(ListDofs(entries));
    entries->alone = (PetscBool)(diagonal != NULL);
    if (diagonal) PetscCall(ScaleEntries(contact, entries, diagonal, &n_columns));
    else PetscCall(BeginBlock(contact, stepper, b));
    PetscCall(VecDestroy(&of_layer));
  }
  if (AnyBody(assembly, PETSC_TRUE)) PetscCall(MultiplyRows(stepper->problem.n, n_columns, assembly));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S of the rows that touch now, unless it is there. Where it has been corrected alone, bodies need not be asked again. */
PetscErrorCode ContactStepperAssemble(Contact contact, ContactStepper *stepper)
{
  const PetscInt   n        = stepper->problem.n;
  StepperAssembly *assembly = &stepper->assembly;
  PetscBool        same     = (PetscBool)(assembly->of_state == stepper->state && stepper->n_assembled == n);
  Mat              S, near = NULL;

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(stepper->rows, stepper->of_assembled, n, &same));
  if (same && stepper->assembled == stepper->state) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(CONTACT_Factor, contact, 0, 0, 0));
  if (!same) PetscCall(ContactStepperListBodyRows(contact, stepper));
  if (!same) PetscCall(ContactStepperChooseProducts(contact, stepper));
  if (!same) PetscCall(GetParts(contact, stepper));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    if (assembly->of_body[b].n && !assembly->of_body[b].alone) PetscCall(ContactStepperCorrectBlock(contact, stepper, b));
  }
  if (stepper->products) PetscCall(ContactStepperCreateProducts(stepper, &S, &near));
  else if (!AnyBody(assembly, PETSC_FALSE) && n > FEW_ROWS) {
    S = assembly->product;
    if (stepper->penalty.any) PetscCall(MatDuplicate(assembly->product, MAT_COPY_VALUES, &S));
    else PetscCall(PetscObjectReference((PetscObject)S));
  } else PetscCall(SumParts(stepper, (PetscBool)(n > MANY_ROWS && BlockPart(stepper) <= SPARSE), &S));
  PetscCall(ContactStepperAddTurns(contact, stepper, S));
  if (!near) PetscCall(ContactStepperAddSprings(stepper, S));
  PetscCall(LawProblemTakeS(&stepper->problem, &S, near ? &near : NULL));
  PetscCall(PetscArraycpy(stepper->of_assembled, stepper->rows, n));
  PetscCall(PetscInfo(contact, "S assembled: %s, %" PetscInt_FMT " rows of %" PetscInt_FMT " nodes\n",
                      stepper->products         ? "as products"
                      : stepper->problem.sparse ? "sparse"
                                                : "dense",
                      n, stepper->problem.n_nodes));
  stepper->n_assembled = n;
  stepper->assembled = assembly->of_state = stepper->state;
  PetscCall(PetscLogEventEnd(CONTACT_Factor, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
