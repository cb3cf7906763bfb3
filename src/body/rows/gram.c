/*
   Prescribed rows that are not orthonormal. A node that touches two partners has a row for each, along normals that need not be square to
   each other, and a row along displacements that the user prescribes has less than length one on the others. With such rows B and their
   Gram matrix G = B B^T, where B is without held dofs,

     u + B^T G^{-1} (x - B u)  is the nearest to u that has B u = x, and   G^{-1} B f  are the forces along the rows that amount to f.

   Rows couple only where they share a node, so that G falls into a small block for each such node; the other rows are orthonormal.

   Rows of a node that depend on each other are prescribed as well as can be, by least squares with a weight w for each row, and share the
   force according to their weights: with A = diag(w) the inverse becomes A^{1/2} (A^{1/2} G A^{1/2})^+ A^{1/2}, which is G^{-1} where there
   is one. Two with one direction are prescribed their weighted mean, and each takes its part of the force; so the work of the force is that
   of its parts, and with the areas that two partners cover for weights this is the mortar condition of both together.
*/
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

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
  PetscBool   *dependent; /* of each of `rows`: on those before it in its block */
  PetscScalar *work;      /* room for a row vector, and for the eigenvalues of a block */
  PetscInt     work_room, inverse_room;
  PetscInt    *nodes, *order; /* work space, per row */
  PetscReal   *all;           /* the same: directions of all rows */
};

PetscErrorCode BodyGramDestroy(BodyGram *gram)
{
  PetscFunctionBegin;
  if (!*gram) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*gram)->run_offsets, (*gram)->candidates, (*gram)->directions));
  PetscCall(PetscFree4((*gram)->offsets, (*gram)->rows, (*gram)->dependent, (*gram)->starts));
  PetscCall(PetscFree3((*gram)->nodes, (*gram)->order, (*gram)->all));
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

/* Rows sorted by node: those that share one, or are alone and no unit vectors, become candidates. Returns the sum of squares of their
   numbers, and the largest one. */
static PetscErrorCode FindCandidates(Body body, const PetscInt nodes[], PetscInt order[], const PetscReal directions[], PetscInt *size,
                                     PetscInt *most)
{
  BodyGram       gram  = body->rows.gram;
  const PetscInt n     = body->rows.local;
  PetscInt       count = 0;

  PetscFunctionBegin;
  *size = *most = 0;
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
    *most = PetscMax(*most, end - begin);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for as many blocks and runs as there can be rows */
static PetscErrorCode Create(PetscInt n, BodyGram *gram)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(gram));
  PetscCall(PetscCalloc3(n + 1, &(*gram)->run_offsets, n, &(*gram)->candidates, 3 * n, &(*gram)->directions));
  PetscCall(PetscCalloc4(n + 1, &(*gram)->offsets, n, &(*gram)->rows, n, &(*gram)->dependent, n, &(*gram)->starts));
  PetscCall(PetscMalloc3(n, &(*gram)->nodes, n, &(*gram)->order, 3 * n, &(*gram)->all));
  PetscFunctionReturn(PETSC_SUCCESS);
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

/* With the rows as they are now; which of them are prescribed is for BodyUpdateGram() */
PetscErrorCode BodySetUpGram(Body body)
{
  const PetscInt n = body->rows.local;
  PetscInt       size, most;
  BodyGram       gram;

  PetscFunctionBegin;
  if (!body->rows.gram) PetscCall(Create(n, &body->rows.gram));
  gram           = body->rows.gram;
  gram->n_blocks = gram->n_runs = 0;
  for (PetscInt i = 0; i < n; i++) {
    PetscCall(GetRowNode(body, i, &gram->nodes[i], gram->all + 3 * i));
    gram->order[i] = i;
  }
  PetscCall(PetscSortIntWithArray(n, gram->nodes, gram->order));
  PetscCall(FindCandidates(body, gram->nodes, gram->order, gram->all, &size, &most));
  body->rows.any_oblique = (PetscBool)(gram->n_runs > 0);
  /* of a body at home its rank alone has rows, and tells the others when they take part: BodyAgreeOnGram() */
  if (!body->local || !body->rows.at_home) PetscCall(BodyAnyRank(body, &body->rows.any_oblique));
  PetscCall(Grow(most * (most + 5), &gram->work_room, &gram->work));
  PetscCall(Grow(size, &gram->inverse_room, &gram->inverses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rank of a local body alone knows of its rows, before all ranks take part in prescribing some */
PetscErrorCode BodyAgreeOnGram(Body body)
{
  PetscFunctionBegin;
  if (body->local && (body->rows.n_prescribed || body->rows.n_robin)) PetscCall(BodyAnyRank(body, &body->rows.any_oblique));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The inverse of a symmetric matrix by sweeping its pivots (Goodnight, The American Statistician 33 (1979) 149-158); false if there is
   none, with the rows that depend on those before them */
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

/* G of some candidates, with the square roots of weights on both sides */
static void FillBlock(const BodyGram gram, PetscInt n, const PetscInt candidates[], const PetscReal weights[], PetscScalar block[])
{
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      const PetscInt  a = candidates[i], b = candidates[j];
      const PetscReal scale = weights ? PetscSqrtReal(weights[gram->candidates[a]] * weights[gram->candidates[b]]) : 1;

      block[i * n + j] = scale * Dot(gram->directions + 3 * a, gram->directions + 3 * b);
    }
}

/* A^{1/2} M^+ A^{1/2} of such a block M with weights */
static PetscErrorCode PseudoInvert(const BodyGram gram, PetscInt n, const PetscInt candidates[], const PetscReal weights[],
                                   PetscScalar block[])
{
  PetscScalar *vectors = gram->work, *values = vectors + n * n, *work = values + n;
  PetscBLASInt order, lwork, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(4 * n, &lwork));
  FillBlock(gram, n, candidates, weights, vectors);
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, vectors, &order, values, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      block[i * n + j] = 0;
      for (PetscInt k = 0; k < n; k++)
        if (values[k] > DEPENDENT * values[n - 1]) block[i * n + j] += vectors[k * n + i] * vectors[k * n + j] / values[k];
      if (weights) block[i * n + j] *= PetscSqrtReal(weights[gram->candidates[candidates[i]]] * weights[gram->candidates[candidates[j]]]);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The blocks of the rows that are prescribed now */
PetscErrorCode BodyUpdateGram(Body body)
{
  BodyGram gram  = body->rows.gram;
  PetscInt count = 0, size = 0;

  PetscFunctionBegin;
  gram->n_blocks = 0;
  for (PetscInt run = 0; run < gram->n_runs; run++) {
    const PetscInt first = count;
    PetscInt       n;
    PetscScalar   *block = gram->inverses + size;

    for (PetscInt k = gram->run_offsets[run]; k < gram->run_offsets[run + 1]; k++)
      if (body->rows.conditions[gram->candidates[k]] == BODY_PRESCRIBED) gram->rows[count++] = k;
    n = count - first;
    FillBlock(gram, n, gram->rows + first, NULL, block);
    if (!n || (n == 1 && PetscAbsReal(PetscRealPart(block[0]) - 1) <= UNIT)) {
      count = first;
      continue;
    }
    if (!Invert(n, block, gram->work, gram->dependent + first))
      PetscCall(PseudoInvert(gram, n, gram->rows + first, body->rows.weights, block));
    for (PetscInt i = first; i < count; i++) gram->rows[i] = gram->candidates[gram->rows[i]];
    gram->starts[gram->n_blocks++] = size;
    gram->offsets[gram->n_blocks]  = count;
    size += n * n;
  }
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
