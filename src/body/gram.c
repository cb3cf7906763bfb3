/*
   Prescribed rows that are not orthonormal. A node that touches two partners has a row for each, along normals that need not be square to each other,
   and a row along displacements that the user prescribes has less than length one on the others. With such rows B and their Gram matrix
   G = B B^T, where B is without held dofs,

     u + B^T G^{-1} (x - B u)  is the nearest to u that has B u = x, and   G^{-1} B f  are the forces along the rows that amount to f.

   Rows couple only where they share a node, so that G falls into a small block for each such node; the other rows are orthonormal. Of rows
   of a node that depend on each other, the first are prescribed, and the others left out.
*/
#include "bodyimpl.h"

/* Of a row, what is not along the rows before it, squared: less is nothing. Normals within 1e-4 of each other count as parallel. */
#define DEPENDENT 1e-8
/* Rows with a length so near to one are taken for unit vectors */
#define UNIT 1e-12

/* The rows of this rank that a block may be made of, side by side where they share a node, and the blocks of those that are prescribed */
struct _n_BodyGram {
  PetscInt     n_runs, *run_offsets, *candidates;
  PetscReal   *directions; /* of candidates: 3 each, without held dofs */
  PetscInt     n_blocks, *offsets, *rows;
  PetscInt    *starts; /* of each block in: */
  PetscScalar *inverses;
  PetscBool   *left_out; /* per candidate, as they are ordered in `rows`: it depends on those before it */
  PetscScalar *work;
};

PetscErrorCode BodyGramDestroy(BodyGram *gram)
{
  PetscFunctionBegin;
  if (!*gram) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4((*gram)->run_offsets, (*gram)->candidates, (*gram)->directions, (*gram)->work));
  PetscCall(PetscFree5((*gram)->offsets, (*gram)->rows, (*gram)->left_out, (*gram)->starts, (*gram)->inverses));
  PetscCall(PetscFree(*gram));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The node of this rank that a row belongs to alone, -1 if there is none, and its direction without held dofs */
static PetscErrorCode GetRowNode(Body body, PetscInt i, PetscInt *node, PetscReal direction[3])
{
  const PetscInt     row = body->rows.begin + i;
  const PetscInt    *columns;
  const PetscScalar *values;
  PetscInt           n, first;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(body->positions, &first, NULL));
  for (PetscInt d = 0; d < 3; d++) direction[d] = 0;
  *node = -1;
  PetscCall(MatGetRow(body->free_rows, row, &n, &columns, &values));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt dof = columns[k] - first, of = dof / body->dim;

    if (dof < 0 || dof >= body->owned_nodes * body->dim || (*node >= 0 && of != *node)) {
      *node = -1;
      break;
    }
    *node                      = of;
    direction[dof % body->dim] = PetscRealPart(values[k]);
  }
  PetscCall(MatRestoreRow(body->free_rows, row, &n, &columns, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Dot(const PetscReal a[3], const PetscReal b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Rows sorted by node: those that share one, or are alone and no unit vectors, become candidates. Returns the sum of squares of their numbers. */
static PetscErrorCode FindCandidates(Body body, const PetscInt nodes[], PetscInt order[], const PetscReal directions[], PetscInt *size)
{
  BodyGram       gram  = body->gram;
  const PetscInt n     = body->rows.local;
  PetscInt       count = 0;

  PetscFunctionBegin;
  *size = 0;
  for (PetscInt begin = 0, end; begin < n; begin = end) {
    const PetscReal *first = directions + 3 * order[begin];

    for (end = begin + 1; end < n && nodes[end] == nodes[begin];) end++;
    if (nodes[begin] < 0 || (end == begin + 1 && PetscAbsReal(Dot(first, first) - 1) <= UNIT)) continue;
    PetscCall(PetscSortInt(end - begin, order + begin));
    for (PetscInt k = begin; k < end; k++) {
      for (PetscInt d = 0; d < 3; d++) gram->directions[3 * count + d] = directions[3 * order[k] + d];
      gram->candidates[count++] = order[k];
    }
    gram->run_offsets[++gram->n_runs] = count;
    *size += PetscSqr(end - begin);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the rows as they are now; which of them are prescribed is for BodyUpdateGram() */
PetscErrorCode BodySetUpGram(Body body)
{
  const PetscInt n = body->rows.local;
  PetscInt      *nodes, *order, size;
  PetscReal     *directions;
  BodyGram       gram;

  PetscFunctionBegin;
  PetscCall(BodyGramDestroy(&body->gram));
  PetscCall(PetscNew(&gram));
  body->gram = gram;
  PetscCall(PetscMalloc3(n, &nodes, n, &order, 3 * n, &directions));
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(GetRowNode(body, i, &nodes[i], directions + 3 * i));
    order[i] = i;
  }
  PetscCall(PetscSortIntWithArray(n, nodes, order));
  PetscCall(PetscCalloc4(n + 1, &gram->run_offsets, n, &gram->candidates, 3 * n, &gram->directions, n, &gram->work));
  PetscCall(FindCandidates(body, nodes, order, directions, &size));
  PetscCall(PetscFree3(nodes, order, directions));
  PetscCall(PetscCalloc5(gram->n_runs + 1, &gram->offsets, n, &gram->rows, n, &gram->left_out, gram->n_runs, &gram->starts, size, &gram->inverses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The inverse of a symmetric matrix by sweeping its pivots (Goodnight, The American Statistician 33 (1979) 149-158), without the rows and columns
   that depend on those before them, which become zero */
static void Invert(PetscInt n, PetscScalar A[], PetscScalar diagonal[], PetscBool left_out[])
{
  for (PetscInt i = 0; i < n; i++) diagonal[i] = A[i * n + i];
  for (PetscInt k = 0; k < n; k++) {
    const PetscScalar pivot = A[k * n + k];

    left_out[k] = (PetscBool) !(PetscRealPart(pivot) > DEPENDENT * PetscRealPart(diagonal[k]));
    if (left_out[k]) continue;
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++)
        if (i != k && j != k) A[i * n + j] -= A[i * n + k] * A[k * n + j] / pivot;
    for (PetscInt i = 0; i < n; i++)
      if (i != k) A[i * n + k] = A[k * n + i] = A[i * n + k] / pivot;
    A[k * n + k] = -1 / pivot;
  }
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) A[i * n + j] = left_out[i] || left_out[j] ? 0 : -A[i * n + j];
}

/* The blocks of the rows that are prescribed now */
PetscErrorCode BodyUpdateGram(Body body)
{
  BodyGram gram  = body->gram;
  PetscInt count = 0, size = 0;

  PetscFunctionBegin;
  gram->n_blocks = 0;
  for (PetscInt run = 0; run < gram->n_runs; run++) {
    const PetscInt first = count;
    PetscInt       n;
    PetscScalar   *block = gram->inverses + size;

    for (PetscInt k = gram->run_offsets[run]; k < gram->run_offsets[run + 1]; k++)
      if (body->conditions[gram->candidates[k]] == BODY_PRESCRIBED) gram->rows[count++] = k;
    n = count - first;
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) block[i * n + j] = Dot(gram->directions + 3 * gram->rows[first + i], gram->directions + 3 * gram->rows[first + j]);
    if (!n || (n == 1 && PetscAbsReal(PetscRealPart(block[0]) - 1) <= UNIT)) {
      count = first;
      continue;
    }
    for (PetscInt i = first; i < count; i++) gram->rows[i] = gram->candidates[gram->rows[i]];
    Invert(n, block, gram->work, gram->left_out + first);
    gram->starts[gram->n_blocks++] = size;
    gram->offsets[gram->n_blocks]  = count;
    size += n * n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes marks from prescribed rows that depend on others of their node */
void BodyLeaveOutDependent(Body body, PetscBool marked[])
{
  const BodyGram gram = body->gram;

  for (PetscInt k = 0; gram->n_blocks && k < gram->offsets[gram->n_blocks]; k++)
    if (gram->left_out[k]) marked[gram->rows[k]] = PETSC_FALSE;
}

/* row <- G^{-1} row, on prescribed rows */
void BodyDivideByGram(Body body, PetscScalar row[])
{
  const BodyGram gram = body->gram;

  for (PetscInt b = 0; b < gram->n_blocks; b++) {
    const PetscInt     n = gram->offsets[b + 1] - gram->offsets[b], *rows = gram->rows + gram->offsets[b];
    const PetscScalar *inverse = gram->inverses + gram->starts[b];

    for (PetscInt i = 0; i < n; i++) gram->work[i] = row[rows[i]];
    for (PetscInt i = 0; i < n; i++) {
      row[rows[i]] = 0;
      for (PetscInt j = 0; j < n; j++) row[rows[i]] += inverse[i * n + j] * gram->work[j];
    }
  }
}
