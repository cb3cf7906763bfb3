/* S, what touching rows read by forces on them, from how bodies answer: S = sum of B_b W_b B_b^T, on every rank. */
#include "stepimpl.h"

/* The touching rows of a body as they are: entries of all ranks, row by row */
typedef struct {
  PetscInt     n;               /* rows */
  PetscInt    *begin, *columns; /* per row: its first entry; per entry: the displacement */
  PetscScalar *values;          /* per entry, with the sign by which the row's gap goes with the body */
} Entries;

#define FEW_ROWS 60 /* up to so many S is dense whatever it is made of */

static PetscErrorCode DestroyEntries(Entries *entries)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(entries->begin));
  PetscCall(PetscFree2(entries->columns, entries->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The touching rows of a body, by their numbers among its rows, and their places in the list of all */
static PetscErrorCode ListBodyRows(Contact contact, ContactStepper *stepper, PetscInt b, PetscInt *n)
{
  PetscFunctionBegin;
  *n = 0;
  for (PetscInt k = 0; k < stepper->problem.n; k++) {
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[k]]];

    if (pair->body[0] != b && pair->body[1] != b) continue;
    PetscCall(PetscFindInt(stepper->rows[k], contact->body_rows[b].n_all, contact->body_rows[b].all, &stepper->of_body[*n]));
    stepper->places[(*n)++] = k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings the entries of rows to all ranks; each rank has those of its rows */
static PetscErrorCode GetEntries(Contact contact, ContactStepper *stepper, PetscInt b, Entries *entries)
{
  const Mat      B     = contact->interfaces[b];
  const PetscInt begin = contact->body_rows[b].begin, end = begin + contact->body_rows[b].n;
  PetscInt      *counts, total                            = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(entries->n + 1, &entries->begin));
  PetscCall(PetscCalloc1(entries->n, &counts));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscInt row = stepper->of_body[k];

    if (row < begin || row >= end) continue;
    PetscCall(MatGetRow(B, row, &counts[k], NULL, NULL));
    PetscCall(MatRestoreRow(B, row, NULL, NULL, NULL));
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, (PetscMPIInt)entries->n, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt k = 0; k < entries->n; k++) {
    entries->begin[k] = total;
    total += counts[k];
  }
  entries->begin[entries->n] = total;
  PetscCall(PetscCalloc2(total, &entries->columns, total, &entries->values));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscInt     row  = stepper->of_body[k];
    const ContactPair *pair = &contact->pairs[contact->ranks.row_pair[stepper->rows[stepper->places[k]]]];
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    if (row < begin || row >= end) continue;
    PetscCall(MatGetRow(B, row, &n, &columns, &values));
    for (PetscInt e = 0; e < n; e++) {
      entries->columns[entries->begin[k] + e] = columns[e];
      entries->values[entries->begin[k] + e]  = ContactSign(pair, b) * values[e];
    }
    PetscCall(MatRestoreRow(B, row, &n, &columns, &values));
  }
  if (contact->ranks.size > 1) {
    PetscMPIInt n;

    PetscCall(PetscMPIIntCast(total, &n));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, entries->columns, n, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, entries->values, n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  }
  PetscCall(PetscFree(counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what one body does to a dense S */
static PetscErrorCode AddBody(Contact contact, ContactStepper *stepper, PetscInt b, PetscScalar S[])
{
  const PetscInt     n = stepper->problem.n, *place;
  const PetscScalar *W;
  Entries            entries;
  PetscInt           leading, *dofs, count;

  PetscFunctionBegin;
  PetscCall(ListBodyRows(contact, stepper, b, &entries.n));
  if (!entries.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetEntries(contact, stepper, b, &entries));
  count = entries.begin[entries.n];
  PetscCall(PetscMalloc1(count, &dofs));
  PetscCall(PetscArraycpy(dofs, entries.columns, count));
  PetscCall(PetscSortRemoveDupsInt(&count, dofs));
  PetscCall(BodyGetNodalCompliance(contact->bodies[b], stepper->rules[b]->shape, count, dofs, &place, &leading, &W));
  for (PetscInt k = 0; k < entries.n; k++)
    for (PetscInt l = 0; l < entries.n; l++) {
      PetscScalar sum = 0;

      for (PetscInt e = entries.begin[k]; e < entries.begin[k + 1]; e++)
        for (PetscInt f = entries.begin[l]; f < entries.begin[l + 1]; f++)
          sum += entries.values[e] * entries.values[f] * W[place[entries.columns[f]] * leading + place[entries.columns[e]]];
      S[stepper->places[l] * n + stepper->places[k]] += sum;
    }
  PetscCall(PetscFree(dofs));
  PetscCall(DestroyEntries(&entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds to a sparse S what a body does none of whose nodes answers to forces on others: rows are coupled that share a displacement */
static PetscErrorCode AddDiagonal(Contact contact, ContactStepper *stepper, PetscInt b, Vec diagonal, Mat S)
{
  const PetscScalar *values;
  PetscScalar       *answer;
  PetscScalar       *block;
  PetscInt           begin, end, count, most = 0, *order, *row, *rows;
  Entries            entries;

  PetscFunctionBegin;
  PetscCall(ListBodyRows(contact, stepper, b, &entries.n));
  if (!entries.n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GetEntries(contact, stepper, b, &entries));
  count = entries.begin[entries.n];
  PetscCall(PetscCalloc3(count, &answer, count, &order, count, &row));
  PetscCall(VecGetOwnershipRange(diagonal, &begin, &end));
  PetscCall(VecGetArrayRead(diagonal, &values));
  for (PetscInt k = 0; k < entries.n; k++)
    for (PetscInt e = entries.begin[k]; e < entries.begin[k + 1]; e++) {
      order[e] = e;
      row[e]   = stepper->places[k];
      if (entries.columns[e] >= begin && entries.columns[e] < end) answer[e] = values[entries.columns[e] - begin];
    }
  PetscCall(VecRestoreArrayRead(diagonal, &values));
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, answer, (PetscMPIInt)count, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(PetscSortIntWithPermutation(count, entries.columns, order));
  for (PetscInt first = 0, last; first < count; first = last) {
    for (last = first; last < count && entries.columns[order[last]] == entries.columns[order[first]]; last++);
    most = PetscMax(most, last - first);
  }
  PetscCall(PetscMalloc2(most, &rows, most * most, &block));
  for (PetscInt first = 0, last; first < count; first = last) {
    PetscInt n;

    for (last = first; last < count && entries.columns[order[last]] == entries.columns[order[first]]; last++);
    n = last - first;
    for (PetscInt k = 0; k < n; k++) {
      const PetscInt e = order[first + k];

      rows[k] = row[e];
      for (PetscInt l = 0; l < n; l++) block[k * n + l] = entries.values[e] * entries.values[order[first + l]] * answer[e];
    }
    PetscCall(MatSetValues(S, n, rows, n, rows, block, ADD_VALUES));
  }
  PetscCall(PetscFree2(rows, block));
  PetscCall(PetscFree3(answer, order, row));
  PetscCall(DestroyEntries(&entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds how far laws give way under their own forces */
static PetscErrorCode AddGive(Contact contact, ContactStepper *stepper, Mat S)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) stepper->mine[i] = ContactStepperGive(contact, stepper, i);
  PetscCall(ContactStepperGather(contact, stepper, stepper->mine, stepper->gathered));
  for (PetscInt k = 0; k < stepper->problem.n; k++) PetscCall(MatSetValues(S, 1, &k, 1, &k, &stepper->gathered[k], ADD_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether no node of any body answers to forces on others */
static PetscErrorCode IsSparse(Contact contact, ContactStepper *stepper, PetscBool *sparse)
{
  PetscFunctionBegin;
  *sparse = (PetscBool)(stepper->problem.n > FEW_ROWS);
  for (PetscInt b = 0; b < contact->n_bodies && *sparse; b++) {
    Vec diagonal;

    if (!contact->body_rows[b].n_all) continue;
    PetscCall(BodyGetNodalDiagonal(contact->bodies[b], stepper->rules[b]->shape, &diagonal));
    *sparse = (PetscBool)(diagonal != NULL);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S of the rows that touch now, unless it is there */
PetscErrorCode ContactStepperAssemble(Contact contact, ContactStepper *stepper)
{
  const PetscInt n    = stepper->problem.n;
  PetscBool      same = (PetscBool)(stepper->assembled == stepper->state && stepper->n_assembled == n), sparse;
  PetscScalar   *values;
  Mat            S;

  PetscFunctionBegin;
  if (same) PetscCall(PetscArraycmp(stepper->rows, stepper->of_assembled, n, &same));
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(CONTACT_Factor, contact, 0, 0, 0));
  PetscCall(IsSparse(contact, stepper, &sparse));
  PetscCall(MatCreate(PETSC_COMM_SELF, &S));
  PetscCall(MatSetSizes(S, n, n, n, n));
  PetscCall(MatSetType(S, sparse ? MATSEQAIJ : MATSEQDENSE));
  PetscCall(MatSetUp(S));
  if (!sparse) PetscCall(MatDenseGetArrayWrite(S, &values));
  if (!sparse) PetscCall(PetscArrayzero(values, n * n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Vec diagonal;

    if (!sparse) PetscCall(AddBody(contact, stepper, b, values));
    if (!sparse || !contact->body_rows[b].n_all) continue;
    PetscCall(BodyGetNodalDiagonal(contact->bodies[b], stepper->rules[b]->shape, &diagonal));
    PetscCall(AddDiagonal(contact, stepper, b, diagonal, S));
  }
  if (!sparse) PetscCall(MatDenseRestoreArrayWrite(S, &values));
  if (stepper->gives) PetscCall(AddGive(contact, stepper, S));
  PetscCall(MatAssemblyBegin(S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(S, MAT_FINAL_ASSEMBLY));
  PetscCall(LawProblemTakeS(&stepper->problem, &S));
  PetscCall(PetscArraycpy(stepper->of_assembled, stepper->rows, n));
  stepper->n_assembled = n;
  stepper->assembled   = stepper->state;
  PetscCall(PetscLogEventEnd(CONTACT_Factor, contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
