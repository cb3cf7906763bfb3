/* Prescribed rows that are not orthonormal. A node that touches two partners has a row for each, along normals that need not be square to
   each other, and a row along displacements that the user prescribes has less than length one on the others. With such rows B and their
   Gram matrix G = B B^T, where B is without held dofs,

     u + B^T G^{-1} (x - B u)  is the nearest to u that has B u = x, and   G^{-1} B f  are the forces along the rows that amount to f.

   Rows couple only where they share a node, so that G falls into a small block for each such node; the other rows are orthonormal.

   Rows of a node that depend on each other are prescribed as well as can be, by least squares with a weight w for each row, and share the
   force according to their weights: with A = diag(w) the inverse becomes A^{1/2} (A^{1/2} G A^{1/2})^+ A^{1/2}, which is G^{-1} where there
   is one. Two with one direction are prescribed their weighted mean, and each takes its part of the force; so the work of the force is that
   of its parts, and with the areas that two partners cover for weights this is the mortar condition of both together. */
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Of a row, what is not along the rows before it, squared: less is nothing. Normals within 1e-4 of each other count as parallel. */
#define DEPENDENT 1e-8
/* Rows with a length so near to one are taken for unit vectors */
#define UNIT 1e-12

struct _n_BodyGram {
  PetscInt     n_blocks, *offsets, *rows;
  PetscInt    *starts; /* of each block in: */
  PetscScalar *inverses;
  PetscBool   *dependent; /* of each of `rows`: on those before it in its block */
  PetscScalar *work;      /* room for a row vector, and for the eigenvalues of a block */
  PetscInt     work_room, inverse_room;
  PetscInt    *nodes;      /* work space, per row */
  PetscReal   *directions; /* of all rows: 3 each, without held dofs */
};

PetscErrorCode BodyGramDestroy(BodyGram *gram)
{
  PetscFunctionBegin;
  if (!*gram) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree6((*gram)->offsets, (*gram)->rows, (*gram)->dependent, (*gram)->starts, (*gram)->nodes, (*gram)->directions));
  PetscCall(PetscFree((*gram)->work));
  PetscCall(PetscFree((*gram)->inverses));
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
  PetscCall(VecGetOwnershipRange(body->mesh.positions, &first, NULL));
  for (PetscInt d = 0; d < 3; d++) direction[d] = 0;
  *node = -1;
  PetscCall(MatGetRow(body->rows.free_matrix, row, &n, &columns, &values));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt dof = columns[k] - first, of = dof / body->mesh.dim;

    if (values[k] == 0) continue; /* of a held dof */
    if (dof < 0 || dof >= body->mesh.owned_nodes * body->mesh.dim || (*node >= 0 && of != *node)) {
      *node = -1;
      break;
    }
    *node                           = of;
    direction[dof % body->mesh.dim] = PetscRealPart(values[k]);
  }
  PetscCall(MatRestoreRow(body->rows.free_matrix, row, &n, &columns, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Dot(const PetscReal a[3], const PetscReal b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* An array of at least so many numbers; what was in it is lost where it grows */
static PetscErrorCode Grow(PetscInt n, PetscInt *room, PetscScalar *values[])
{
  PetscFunctionBegin;
  if (n <= *room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(*values));
  PetscCall(PetscCalloc1(n, values));
  *room = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inverse of a symmetric matrix by sweeping pivots (Goodnight, The American Statistician 33, 1979); false if none, with dependent rows */
static PetscBool Invert(PetscInt n, PetscScalar A[], PetscScalar diagonal[], PetscBool dependent[])
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt i = 0; i < n; i++) diagonal[i] = A[i * n + i];
  for (PetscInt k = 0; k < n; k++) {
    const PetscScalar pivot = A[k * n + k];

    dependent[k] = (PetscBool) !(PetscRealPart(pivot) > DEPENDENT * PetscRealPart(diagonal[k]));
    any          = (PetscBool)(any || dependent[k]);
    if (dependent[k]) continue;
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++)
        if (i != k && j != k) A[i * n + j] -= A[i * n + k] * A[k * n + j] / pivot;
    for (PetscInt i = 0; i < n; i++)
      if (i != k) A[i * n + k] = A[k * n + i] = A[i * n + k] / pivot;
    A[k * n + k] = -1 / pivot;
  }
  for (PetscInt i = 0; i < n * n; i++) A[i] = -A[i];
  return (PetscBool)!any;
}

/* G of some rows, with the square roots of weights on both sides */
static void FillBlock(const BodyGram gram, PetscInt n, const PetscInt rows[], const PetscReal weights[], PetscScalar block[])
{
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      const PetscReal scale = weights ? PetscSqrtReal(weights[rows[i]] * weights[rows[j]]) : 1;

      block[i * n + j] = scale * Dot(gram->directions + 3 * rows[i], gram->directions + 3 * rows[j]);
    }
}

/* A^{1/2} M^+ A^{1/2} of such a block M with weights */
static PetscErrorCode PseudoInvert(const BodyGram gram, PetscInt n, const PetscInt rows[], const PetscReal weights[], PetscScalar block[])
{
  PetscScalar *vectors = gram->work, *values = vectors + n * n, *work = values + n;
  PetscBLASInt order, lwork, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(4 * n, &lwork));
  FillBlock(gram, n, rows, weights, vectors);
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, vectors, &order, values, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      block[i * n + j] = 0;
      for (PetscInt k = 0; k < n; k++)
        if (values[k] > DEPENDENT * values[n - 1]) block[i * n + j] += vectors[k * n + i] * vectors[k * n + j] / values[k];
      if (weights) block[i * n + j] *= PetscSqrtReal(weights[rows[i]] * weights[rows[j]]);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows that have a condition, with their nodes by which they are sorted; their number */
static PetscErrorCode SortRows(Body body, PetscInt *n)
{
  const BodyGram gram = body->rows.gram;

  PetscFunctionBegin;
  *n = 0;
  for (PetscInt i = 0; i < body->rows.local; i++) {
    if (body->rows.conditions[i] == BODY_FREE) continue;
    PetscCall(GetRowNode(body, i, &gram->nodes[*n], gram->directions + 3 * i));
    gram->rows[(*n)++] = i;
  }
  PetscCall(PetscSortIntWithArray(*n, gram->nodes, gram->rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the rows of blocks: prescribed ones of a node that have others beside them, or are no unit vectors */
static PetscErrorCode FindBlocks(Body body, PetscInt n)
{
  const BodyGram gram  = body->rows.gram;
  PetscInt       count = 0, size = 0, most = 0;

  PetscFunctionBegin;
  gram->n_blocks = 0;
  for (PetscInt begin = 0, end; begin < n; begin = end) {
    const PetscReal *direction = gram->directions + 3 * gram->rows[begin];
    const PetscInt   first     = count;
    const PetscBool  unit      = (PetscBool)(PetscAbsReal(Dot(direction, direction) - 1) <= UNIT);

    for (end = begin + 1; end < n && gram->nodes[end] == gram->nodes[begin];) end++;
    if (gram->nodes[begin] < 0 || (end == begin + 1 && unit)) continue;
    PetscCall(PetscSortInt(end - begin, gram->rows + begin));
    for (PetscInt k = begin; k < end; k++)
      if (body->rows.conditions[gram->rows[k]] == BODY_PRESCRIBED) gram->rows[count++] = gram->rows[k];
    if (count == first) continue;
    gram->starts[gram->n_blocks++] = size;
    gram->offsets[gram->n_blocks]  = count;
    size += PetscSqr(count - first);
    most = PetscMax(most, count - first);
  }
  PetscCall(Grow(most * (most + 5), &gram->work_room, &gram->work));
  PetscCall(Grow(size, &gram->inverse_room, &gram->inverses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With the rows and conditions as they are now. Collective. */
PetscErrorCode BodyUpdateGram(Body body)
{
  const PetscInt n = body->rows.local;
  PetscInt       count;
  BodyGram       gram;

  PetscFunctionBegin;
  if (!body->rows.gram) {
    PetscCall(PetscNew(&gram));
    PetscCall(PetscCalloc6(n + 1, &gram->offsets, n, &gram->rows, n, &gram->dependent, n, &gram->starts, n, &gram->nodes, 3 * n,
                           &gram->directions));
    body->rows.gram = gram;
  }
  gram = body->rows.gram;
  PetscCall(SortRows(body, &count));
  PetscCall(FindBlocks(body, count));
  for (PetscInt b = 0; b < gram->n_blocks; b++) {
    const PetscInt first = gram->offsets[b], size = gram->offsets[b + 1] - first;
    PetscScalar   *block = gram->inverses + gram->starts[b];

    FillBlock(gram, size, gram->rows + first, NULL, block);
    if (!Invert(size, block, gram->work, gram->dependent + first))
      PetscCall(PseudoInvert(gram, size, gram->rows + first, body->rows.weights, block));
  }
  body->rows.any_oblique = (PetscBool)(gram->n_blocks > 0);
  if (body->rows.n_prescribed) PetscCall(BodyAnyRank(body, &body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes marks from prescribed rows that depend on others of their node: where those are zero, they are too */
void BodyUnmarkDependent(Body body, PetscBool marked[])
{
  const BodyGram gram = body->rows.gram;

  for (PetscInt k = 0; gram->n_blocks && k < gram->offsets[gram->n_blocks]; k++)
    if (gram->dependent[k]) marked[gram->rows[k]] = PETSC_FALSE;
}

/* row <- G^{-1} row, on prescribed rows */
void BodyDivideByGram(Body body, PetscScalar row[])
{
  const BodyGram gram = body->rows.gram;

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
