/*
   Ties that go round in a circle: where four bodies meet at a node, each tied to two others, the last tie says nothing that the others do
   not say, and its force is not determined. Such rows are let go. Of rows r that are linear combinations of others the Gram matrix

     G = sum_bodies B B^T,   with the signs of both sides,

   is singular. Only rows that share a node with rows of another pair can be such: of these G is factored row by row, and rows that leave
   nothing of their diagonal are dependent.
*/
#include <contact/parts.h>

/* What a dependent row leaves of its diagonal is round-off; a row that differs from others by an angle of 1e-4 leaves this */
#define DEPENDENT 1e-8
/* More rows at joints than this are not looked at: a matrix of 32 MB */
#define MAX_ROWS 2000

/* G */
static PetscErrorCode CreateGram(Contact contact, Mat *gram)
{
  PetscFunctionBegin;
  PetscCall(ContactCreateRowMatrix(contact, gram));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat part;

    PetscCall(MatMatTransposeMult(contact->interfaces[b], contact->interfaces[b], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &part));
    PetscCall(ContactAddBodyMatrix(contact, b, part, *gram));
    PetscCall(MatDestroy(&part));
  }
  PetscCall(MatAssemblyBegin(*gram, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*gram, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tied rows of all ranks that share a node with tied rows of another pair, in ascending order, on every rank */
static PetscErrorCode FindSuspects(Contact contact, Mat gram, PetscInt *n, PetscInt *rows[])
{
  PetscMPIInt *marks;
  PetscInt     count = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(contact->rows.n_all, &marks));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt     row = contact->rows.begin + i;
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n_columns;

    if (!contact->rows.tied[i] || contact->pairs[contact->rows.pair[i]].law != CONTACT_LAW_TIED) continue; /* springs share their force */
    PetscCall(MatGetRow(gram, row, &n_columns, &columns, &values));
    for (PetscInt k = 0; k < n_columns; k++)
      if (values[k] != 0 && contact->ranks.row_pair[columns[k]] != contact->rows.pair[i]) marks[row] = 1;
    PetscCall(MatRestoreRow(gram, row, &n_columns, &columns, &values));
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, marks, (PetscMPIInt)contact->rows.n_all, MPI_INT, MPI_SUM, PetscObjectComm((PetscObject)contact)));
  for (PetscInt row = 0; row < contact->rows.n_all; row++) count += marks[row];
  *n = count;
  PetscCall(PetscMalloc1(count, rows));
  count = 0;
  for (PetscInt row = 0; row < contact->rows.n_all; row++)
    if (marks[row]) (*rows)[count++] = row;
  PetscCall(PetscFree(marks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cholesky's factorisation of a matrix, by columns, that leaves dependent rows out, and marks them */
static void MarkDependent(PetscInt n, PetscScalar G[], PetscBool dependent[])
{
  for (PetscInt j = 0; j < n; j++) {
    PetscReal pivot = PetscRealPart(G[j * n + j]);

    const PetscReal size = pivot;

    for (PetscInt k = 0; k < j; k++) pivot -= PetscRealPart(PetscSqr(G[k * n + j]));
    dependent[j] = (PetscBool)(pivot <= DEPENDENT * size);
    for (PetscInt i = j; i < n; i++) {
      PetscScalar sum = G[j * n + i];

      if (dependent[j]) sum = 0;
      else {
        for (PetscInt k = 0; k < j; k++) sum -= G[k * n + i] * G[k * n + j];
        sum /= PetscSqrtReal(pivot);
      }
      G[j * n + i] = sum;
    }
  }
}

/* Lets tied rows go that follow from others */
PetscErrorCode ContactDropDependentTies(Contact contact)
{
  Mat          gram, *parts;
  IS           is;
  PetscInt     n = 0, *rows = NULL;
  PetscScalar *values;
  PetscBool   *dependent;

  PetscFunctionBegin;
  if (contact->n_pairs < 2) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CreateGram(contact, &gram));
  PetscCall(FindSuspects(contact, gram, &n, &rows));
  if (n && n <= MAX_ROWS) {
    PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, rows, PETSC_USE_POINTER, &is));
    PetscCall(MatCreateSubMatrices(gram, 1, &is, &is, MAT_INITIAL_MATRIX, &parts));
    PetscCall(PetscCalloc2(n * n, &values, n, &dependent));
    for (PetscInt i = 0; i < n; i++) {
      const PetscInt    *columns;
      const PetscScalar *entries;
      PetscInt           n_columns;

      PetscCall(MatGetRow(parts[0], i, &n_columns, &columns, &entries));
      for (PetscInt k = 0; k < n_columns; k++) values[columns[k] * n + i] = entries[k];
      PetscCall(MatRestoreRow(parts[0], i, &n_columns, &columns, &entries));
    }
    MarkDependent(n, values, dependent);
    for (PetscInt k = 0; k < n; k++) {
      const PetscInt i = rows[k] - contact->rows.begin;

      if (!dependent[k] || i < 0 || i >= contact->rows.n) continue;
      contact->rows.opposite[i] = contact->rows.tied[i] = PETSC_FALSE;
      contact->rows.initial_gap[i] = contact->start.gap[i] = contact->end.gap[i] = CONTACT_NO_GAP;
    }
    PetscCall(PetscFree2(values, dependent));
    PetscCall(MatDestroySubMatrices(1, &parts));
    PetscCall(ISDestroy(&is));
  }
  PetscCall(PetscFree(rows));
  PetscCall(MatDestroy(&gram));
  PetscFunctionReturn(PETSC_SUCCESS);
}
