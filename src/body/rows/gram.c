/* Prescribed rows that are not orthonormal. A node that touches two partners has a row for each, along normals that need not be square to
   each other, and a row along displacements that the user prescribes has less than length one on the others. With such rows B and their
   Gram matrix G = B B^T, where B is without held dofs,

     u + B^T G^{-1} (x - B u)  is the nearest to u that has B u = x, and   G^{-1} B f  are the forces along the rows that amount to f.

   Rows couple only where they share a node, so that G falls into a small block for each such node; the other rows are orthonormal.

   Rows of a node that depend on each other are prescribed as well as can be, by least squares with a weight w for each row, and share the
   force according to their weights: with A = diag(w) the inverse becomes A^{1/2} (A^{1/2} G A^{1/2})^+ A^{1/2}, which is G^{-1} where there
   is one. Two with one direction are prescribed their weighted mean, and each takes its part of the force; so the work of the force is that
   of its parts, and with the areas that two partners cover for weights this is the mortar condition of both together. With the directions
   D of the rows of a node in space, that inverse is A D ((D^T A D)^+)^2 D^T A: 3 x 3 numbers for each node. */
#include <body/layout/bodyimpl.h>
#include <petscblaslapack.h>

/* Of a row, what is not along the rows before it, squared: less is nothing. Normals within 1e-4 of each other count as parallel. */
#define DEPENDENT 1e-8
/* Rows with a length so near to one are taken for unit vectors */
#define UNIT 1e-12

struct _n_BodyGram {
  PetscInt   n_blocks, *offsets, *rows;
  PetscBool *dependent;  /* of each of `rows`: on those before it in its block */
  PetscReal *squares;    /* of each block: ((D^T A D)^+)^2 */
  PetscReal *weights;    /* of all rows: A */
  PetscReal *directions; /* of all rows: 3 each, without held dofs */
  PetscInt  *nodes;      /* work space, per row */
};

PetscErrorCode BodyGramDestroy(BodyGram *gram)
{
  PetscFunctionBegin;
  if (!*gram) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree7((*gram)->offsets, (*gram)->rows, (*gram)->dependent, (*gram)->squares, (*gram)->weights, (*gram)->directions,
                       (*gram)->nodes));
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

/* Which of some rows depend on those before them; whether any does */
static PetscBool FindDependent(const BodyGram gram, PetscInt n, const PetscInt rows[], PetscBool dependent[])
{
  PetscReal basis[3][3];
  PetscInt  size = 0;

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *direction = gram->directions + 3 * rows[i];
    PetscReal        left[3], square;

    PetscArraycpy(left, direction, 3);
    for (PetscInt k = 0; k < size; k++) {
      const PetscReal along = Dot(left, basis[k]);

      for (PetscInt d = 0; d < 3; d++) left[d] -= along * basis[k][d];
    }
    square       = Dot(left, left);
    dependent[i] = (PetscBool)(size == 3 || !(square > DEPENDENT * Dot(direction, direction)));
    if (dependent[i]) continue;
    for (PetscInt d = 0; d < 3; d++) basis[size][d] = left[d] / PetscSqrtReal(square);
    size++;
  }
  return (PetscBool)(size < n);
}

/* ((D^T A D)^+)^2 of some rows */
static PetscErrorCode Square(const BodyGram gram, PetscInt n, const PetscInt rows[], PetscReal square[9])
{
  PetscScalar  vectors[9] = {0}, values[3], work[12];
  PetscBLASInt order = 3, lwork = 12, info;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *direction = gram->directions + 3 * rows[i];

    for (PetscInt k = 0; k < 9; k++) vectors[k] += gram->weights[rows[i]] * direction[k / 3] * direction[k % 3];
  }
  PetscCallBLAS("LAPACKsyev", LAPACKsyev_("V", "L", &order, vectors, &order, values, work, &lwork, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syev info %d", (int)info);
  PetscCall(PetscArrayzero(square, 9));
  for (PetscInt v = 0; v < 3; v++)
    for (PetscInt k = 0; k < 9 && values[v] > DEPENDENT * values[2]; k++)
      square[k] += vectors[3 * v + k / 3] * vectors[3 * v + k % 3] / PetscSqr(values[v]);
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
  PetscInt       count = 0;

  PetscFunctionBegin;
  gram->n_blocks = 0;
  for (PetscInt begin = 0, end; begin < n; begin = end) {
    const PetscReal *direction = gram->directions + 3 * gram->rows[begin];
    const PetscBool  unit      = (PetscBool)(PetscAbsReal(Dot(direction, direction) - 1) <= UNIT);

    for (end = begin + 1; end < n && gram->nodes[end] == gram->nodes[begin];) end++;
    if (gram->nodes[begin] < 0 || (end == begin + 1 && unit)) continue;
    PetscCall(PetscSortInt(end - begin, gram->rows + begin));
    for (PetscInt k = begin; k < end; k++)
      if (body->rows.conditions[gram->rows[k]] == BODY_PRESCRIBED) gram->rows[count++] = gram->rows[k];
    if (count > gram->offsets[gram->n_blocks]) gram->offsets[++gram->n_blocks] = count;
  }
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
    PetscCall(PetscCalloc7(n + 1, &gram->offsets, n, &gram->rows, n, &gram->dependent, 9 * n, &gram->squares, n, &gram->weights, 3 * n,
                           &gram->directions, n, &gram->nodes));
    body->rows.gram = gram;
  }
  gram = body->rows.gram;
  PetscCall(SortRows(body, &count));
  PetscCall(FindBlocks(body, count));
  for (PetscInt b = 0; b < gram->n_blocks; b++) {
    const PetscInt  size = gram->offsets[b + 1] - gram->offsets[b], *rows = gram->rows + gram->offsets[b];
    const PetscBool any = FindDependent(gram, size, rows, gram->dependent + gram->offsets[b]);

    for (PetscInt i = 0; i < size; i++) gram->weights[rows[i]] = any && body->rows.weights ? body->rows.weights[rows[i]] : 1;
    PetscCall(Square(gram, size, rows, gram->squares + 9 * b));
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
    const PetscReal *square = gram->squares + 9 * b;
    PetscReal        sum[3] = {0};

    for (PetscInt k = gram->offsets[b]; k < gram->offsets[b + 1]; k++)
      for (PetscInt d = 0; d < 3; d++)
        sum[d] += gram->weights[gram->rows[k]] * gram->directions[3 * gram->rows[k] + d] * PetscRealPart(row[gram->rows[k]]);
    for (PetscInt k = gram->offsets[b]; k < gram->offsets[b + 1]; k++) {
      const PetscReal *direction = gram->directions + 3 * gram->rows[k];
      const PetscReal  along[3]  = {Dot(square, direction), Dot(square + 3, direction), Dot(square + 6, direction)};

      row[gram->rows[k]] = gram->weights[gram->rows[k]] * Dot(along, sum);
    }
  }
}
