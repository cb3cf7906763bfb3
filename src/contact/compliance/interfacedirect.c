/*
   S where all bodies that feel forces at the end of the step answer by a massless layer alone, with the stiffness matrix K_b. Those of all
   layers and the rows C_b = t_b B_b on their dofs make one sparse matrix of the size of the surfaces,

     | K_1        C_1' | | u_1 |   | 0 |
     |      K_2   C_2' | | u_2 | = | 0 |,   (S + D) y = x,
     | C_1  C_2   -D   | | -y  |   | x |

   symmetric and indefinite. Its factors take as long as some solutions by conjugate gradients, and are made once the same rows have been
   solved for so often: while rows change with every step they are not worth while. Rows that are not solved for keep their
   place, with zeros in C_b and one in D, so that the factors have the same pattern while rows join and leave.
*/
#include "interfaceimpl.h"
#include <solver/constrainedsolver.h>

/* Solutions by conjugate gradients that take as long as the factors: 961 rows of hexahedra took 2.9, 3721 rows 7.2 */
#define SOLUTIONS_OF_FACTORS 3
/* Part of the right-hand side that the first solution with new factors may leave: more is left where rows depend on each other, which
   conjugate gradients do not mind */
#define MOST_LEFT 1e-8

struct _n_InterfaceDirect {
  PetscInt  n;                     /* layers */
  PetscInt *bodies;                /* whose they are */
  Mat      *K, *C, *Ct, D, matrix; /* copies, since a matrix that is joined with others counts as changed, and would be factored again */
  PetscObjectState *states;        /* of K_b and B_b, as they are in the matrix */
  PetscObjectId    *rows;          /* B_b */
  PetscInt          solutions;     /* by conjugate gradients, for the rows as they are */
  PetscBool         filled;        /* the matrix is that of these rows, and factored */
  PetscBool         was_filled;    /* it was so, with good factors, at the checkpoint that the run goes on from */
  PetscBool         fails;         /* it has no good factors */
  PC                factors;
  Vec               rhs, solution;
  PetscInt          offset;         /* of this rank's rows in these */
  PetscInt          first_row;      /* number of the first of them in the matrix */
  PetscInt         *shift;          /* per layer and rank: a dof of the layer on that rank, and this, are its number in the matrix */
  PetscBool         answers;        /* `solution` is that of the last solution for S */
  PetscScalar      *change, *moved; /* work space: per row that a body has on this rank, and per dof of a layer */
  PetscInt          room;           /* of the following */
  PetscInt         *numbers;        /* work space */
  PetscScalar      *values;         /* work space */
};

/* NULL where a body answers otherwise */
PetscErrorCode InterfaceDirectCreate(InterfaceOperator op, InterfaceDirect *direct)
{
  const Contact   contact = op->contact;
  InterfaceDirect d;
  PetscBool       all = PETSC_TRUE;

  PetscFunctionBegin;
  *direct = NULL;
  PetscCall(PetscNew(&d));
  PetscCall(PetscMalloc1(contact->n_bodies, &d->bodies));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat K;

    if (!op->feels[b]) continue;
    d->bodies[d->n++] = b;
    PetscCall(BodyGetLayerMatrices(contact->bodies[b], &K, NULL));
    if (!K) all = PETSC_FALSE;
  }
  if (all && d->n) {
    PetscCall(PetscCalloc3(2 * d->n, &d->states, d->n, &d->rows, d->n * contact->ranks.size, &d->shift));
    *direct = d;
    if (contact->ranks.size > 1 && contact->rows.n_all > op->settings.few) contact->parallel_factors = PETSC_TRUE;
  } else PetscCall(InterfaceDirectDestroy(&d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyMatrices(InterfaceDirect d)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&d->matrix));
  PetscCall(PCDestroy(&d->factors));
  PetscCall(VecDestroy(&d->rhs));
  PetscCall(VecDestroy(&d->solution));
  PetscCall(PetscFree2(d->change, d->moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceDirectDestroy(InterfaceDirect *direct)
{
  PetscFunctionBegin;
  if (!*direct) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DestroyMatrices(*direct));
  PetscCall(PetscFree((*direct)->bodies));
  PetscCall(PetscFree3((*direct)->states, (*direct)->rows, (*direct)->shift));
  PetscCall(PetscFree2((*direct)->numbers, (*direct)->values));
  PetscCall(PetscFree(*direct));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other rows are solved for, or another diagonal is added */
void InterfaceDirectForget(InterfaceDirect d)
{
  if (!d) return;
  d->solutions = 0;
  d->filled = d->was_filled = d->answers = PETSC_FALSE;
}

/* Notes the layers and rows as they are. Where any has changed since the last call what is there of them is forgotten, and where rows are
   other objects, with entries elsewhere perhaps, the matrices go. */
static PetscErrorCode TakeState(InterfaceOperator op)
{
  InterfaceDirect d       = op->direct;
  PetscBool       changed = PETSC_FALSE, other = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < d->n; k++) {
    Mat              matrices[2];
    PetscObjectId    id;
    PetscObjectState state;

    PetscCall(BodyGetLayerMatrices(op->contact->bodies[d->bodies[k]], &matrices[0], &matrices[1]));
    for (PetscInt m = 0; m < 2; m++) {
      PetscCall(PetscObjectStateGet((PetscObject)matrices[m], &state));
      if (state != d->states[2 * k + m]) changed = PETSC_TRUE;
      d->states[2 * k + m] = state;
    }
    PetscCall(PetscObjectGetId((PetscObject)matrices[1], &id));
    if (id != d->rows[k]) changed = other = PETSC_TRUE;
    d->rows[k] = id;
  }
  if (changed) InterfaceDirectForget(d);
  if (other) PetscCall(DestroyMatrices(d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix without entries. On each rank the dofs of all layers come one after the other, then the rows. */
static PetscErrorCode CreateMatrix(InterfaceOperator op)
{
  InterfaceDirect   d     = op->direct;
  const Contact     c     = op->contact;
  const PetscMPIInt ranks = c->ranks.size;
  PetscInt         *next, begin = 0, rows = 0, dofs = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(ranks, &next));
  for (PetscMPIInt r = 0; r < ranks; r++) {
    for (PetscInt k = 0; k < d->n; k++) {
      const PetscInt *ranges;
      Mat             K;

      PetscCall(BodyGetLayerMatrices(c->bodies[d->bodies[k]], &K, NULL));
      PetscCall(MatGetOwnershipRanges(K, &ranges));
      d->shift[k * ranks + r] = begin - ranges[r];
      begin += ranges[r + 1] - ranges[r];
      dofs = PetscMax(dofs, ranges[r + 1] - ranges[r]);
    }
    next[r] = begin;
    begin += c->ranks.counts[r];
  }
  d->first_row = next[c->ranks.rank];
  begin        = c->ranks.rank ? next[c->ranks.rank - 1] + c->ranks.counts[c->ranks.rank - 1] : 0;
  d->offset    = d->first_row - begin;
  PetscCall(PetscFree(next));
  for (PetscInt k = 0; k < d->n; k++) rows = PetscMax(rows, c->body_rows[d->bodies[k]].n);
  PetscCall(PetscMalloc2(rows, &d->change, dofs, &d->moved));
  PetscCall(MatCreate(PetscObjectComm((PetscObject)c), &d->matrix));
  PetscCall(MatSetSizes(d->matrix, d->offset + c->rows.n, d->offset + c->rows.n, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(d->matrix, MATAIJ));
  PetscCall(MatSetUp(d->matrix));
  PetscCall(MatSetOption(d->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What dofs of layer k are in the matrix */
static PetscErrorCode NumberDofs(InterfaceOperator op, PetscInt k, Mat K, PetscInt n, const PetscInt dofs[])
{
  InterfaceDirect d     = op->direct;
  const PetscInt *shift = d->shift + k * op->contact->ranks.size;
  PetscLayout     layout;

  PetscFunctionBegin;
  PetscCall(MatGetLayouts(K, &layout, NULL));
  if (n > d->room) {
    PetscCall(PetscFree2(d->numbers, d->values));
    d->room = 2 * n;
    PetscCall(PetscMalloc2(d->room, &d->numbers, d->room, &d->values));
  }
  for (PetscInt j = 0; j < n; j++) PetscCall(InterfaceFindNumber(layout, shift, op->contact->ranks.rank, dofs[j], &d->numbers[j]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K_b of layer k */
static PetscErrorCode FillLayer(InterfaceOperator op, PetscInt k, Mat K)
{
  InterfaceDirect d = op->direct;
  PetscInt        begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(K, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    const PetscInt     number = row + d->shift[k * op->contact->ranks.size + op->contact->ranks.rank];
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(K, row, &n, &columns, &values));
    PetscCall(NumberDofs(op, k, K, n, columns));
    PetscCall(MatSetValues(d->matrix, 1, &number, n, d->numbers, values, INSERT_VALUES));
    PetscCall(MatRestoreRow(K, row, &n, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C_b of layer k, and its transpose: zeros in the rows that are not in */
static PetscErrorCode FillRows(InterfaceOperator op, PetscInt k, Mat K, Mat B)
{
  InterfaceDirect        d  = op->direct;
  const Contact          c  = op->contact;
  const PetscInt         b  = d->bodies[k];
  const ContactBodyRows *of = &c->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt l = 0; l < of->n; l++) {
    const PetscInt     i = of->rows[l], number = d->first_row + i;
    const PetscInt     sign = InterfaceIsIn(op, i) ? InterfaceSideIn(INTERFACE_GAP, &c->pairs[c->rows.pair[i]], b) : 0;
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(B, of->begin + l, &n, &columns, &values));
    PetscCall(NumberDofs(op, k, K, n, columns));
    for (PetscInt j = 0; j < n; j++) d->values[j] = sign * values[j];
    PetscCall(MatSetValues(d->matrix, 1, &number, n, d->numbers, d->values, INSERT_VALUES));
    PetscCall(MatSetValues(d->matrix, n, d->numbers, 1, &number, d->values, INSERT_VALUES));
    PetscCall(MatRestoreRow(B, of->begin + l, &n, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All entries, in place where they are there */
static PetscErrorCode FillMatrix(InterfaceOperator op)
{
  InterfaceDirect d = op->direct;
  const Contact   c = op->contact;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < d->n; k++) {
    Mat K, B;

    PetscCall(BodyGetLayerMatrices(c->bodies[d->bodies[k]], &K, &B));
    PetscCall(FillLayer(op, k, K));
    PetscCall(FillRows(op, k, K, B));
  }
  for (PetscInt i = 0; i < c->rows.n; i++)
    PetscCall(MatSetValue(d->matrix, d->first_row + i, d->first_row + i, InterfaceIsIn(op, i) ? -op->diagonal[i] : -1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(d->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(d->matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateFactors(InterfaceOperator op)
{
  InterfaceDirect d = op->direct;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(d->matrix, &d->solution, &d->rhs));
  PetscCall(PCCreate(PetscObjectComm((PetscObject)op->contact), &d->factors));
  PetscCall(PCSetOperators(d->factors, d->matrix, d->matrix));
  PetscCall(ConstrainedSolverChooseMUMPS(d->factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Layers that have been left where they are have yet to find their balance: u is how far they go back, and what they lack is in rhs */
static PetscErrorCode AddMissing(InterfaceOperator op, PetscScalar rhs[])
{
  InterfaceDirect d     = op->direct;
  PetscInt        begin = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < d->n; k++) {
    const Body body = op->contact->bodies[d->bodies[k]];
    PetscInt   n;
    Mat        K;

    PetscCall(BodyGetLayerMatrices(body, &K, NULL));
    PetscCall(MatGetLocalSize(K, &n, NULL));
    PetscCall(BodyGetLayerMissing(body, rhs + begin));
    for (PetscInt j = 0; j < n; j++) rhs[begin + j] = -rhs[begin + j];
    begin += n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* solution = matrix^{-1} rhs */
static PetscErrorCode SolveJoined(InterfaceOperator op, const PetscScalar x[])
{
  InterfaceDirect d = op->direct;
  PetscScalar    *rhs;

  PetscFunctionBegin;
  PetscCall(VecZeroEntries(d->rhs));
  PetscCall(VecGetArray(d->rhs, &rhs));
  PetscCall(AddMissing(op, rhs));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) rhs[d->offset + i] = InterfaceIsIn(op, i) ? x[i] : 0;
  PetscCall(VecRestoreArray(d->rhs, &rhs));
  PetscCall(PCApply(d->factors, d->rhs, d->solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the factors are good: y must close the gaps x, as the bodies themselves answer to it */
static PetscErrorCode CheckFactors(InterfaceOperator op, const PetscScalar x[], const PetscScalar y[])
{
  const Contact      contact = op->contact;
  PetscReal          sums[2] = {0, 0}; /* squares of what is left, and of all */
  PetscScalar       *force;
  const PetscScalar *gap;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(op->unknown, &force));
  PetscCall(PetscArraycpy(force, y, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(op->unknown, &force));
  PetscCall(InterfaceOperatorApply(op, INTERFACE_GAP, op->unknown, op->rhs));
  PetscCall(VecGetArrayRead(op->rhs, &gap));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (!InterfaceIsIn(op, i)) continue;
    sums[0] += PetscSqr(gap[i] + op->diagonal[i] * y[i] - x[i]);
    sums[1] += PetscSqr(x[i]);
  }
  PetscCall(VecRestoreArrayRead(op->rhs, &gap));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  op->direct->fails = (PetscBool) !(sums[0] <= PetscSqr(MOST_LEFT) * sums[1]); /* true where that is not a number */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix and its factors, for the rows as they are */
static PetscErrorCode Factor(InterfaceOperator op)
{
  InterfaceDirect d = op->direct;
  PCFailedReason  reason;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(CONTACT_Factor, op->contact, 0, 0, 0));
  if (!d->matrix) PetscCall(CreateMatrix(op));
  PetscCall(FillMatrix(op));
  if (!d->factors) PetscCall(CreateFactors(op));
  PetscCall(PCSetUp(d->factors));
  PetscCall(PCGetFailedReason(d->factors, &reason));
  d->fails  = (PetscBool)(reason != PC_NOERROR);
  d->filled = PETSC_TRUE;
  PetscCall(PetscLogEventEnd(CONTACT_Factor, op->contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the next solution for the rows as they are comes from factors that are there */
PetscErrorCode InterfaceDirectIsReady(InterfaceOperator op, PetscBool *ready)
{
  PetscFunctionBegin;
  PetscCall(TakeState(op));
  if (op->direct->was_filled && !op->direct->filled) PetscCall(Factor(op));
  *ready = (PetscBool)(op->direct->filled && !op->direct->fails);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (S + diagonal)^{-1} x on this rank's rows that are in, zero on the others; where layers have been left off balance x is to be what
   it becomes when they find it. solved: false where there are no factors, and conjugate
   gradients are to do it */
PetscErrorCode InterfaceDirectSolve(InterfaceOperator op, const PetscScalar x[], PetscScalar y[], PetscBool *solved)
{
  InterfaceDirect    d = op->direct;
  const PetscScalar *solution;
  PetscBool          fresh;

  PetscFunctionBegin;
  *solved = d->answers = PETSC_FALSE;
  if (!op->unknown) PetscCall(InterfaceOperatorCreateVecs(op));
  PetscCall(TakeState(op));
  if (d->solutions < SOLUTIONS_OF_FACTORS) {
    d->solutions++;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  fresh = (PetscBool)!d->filled;
  if (fresh) PetscCall(Factor(op));
  if (d->fails) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SolveJoined(op, x));
  PetscCall(VecGetArrayRead(d->solution, &solution));
  for (PetscInt i = 0; i < op->contact->rows.n; i++) y[i] = InterfaceIsIn(op, i) ? -solution[d->offset + i] : 0;
  PetscCall(VecRestoreArrayRead(d->solution, &solution));
  if (fresh) PetscCall(CheckFactors(op, x, y));
  *solved = d->answers = (PetscBool)!d->fails;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces y that were found last are to be taken from those on the rows. Where the layers get then has been found with them, and the
   bodies are told, which need not find it again. */
PetscErrorCode InterfaceDirectTell(InterfaceOperator op)
{
  InterfaceDirect    d = op->direct;
  const Contact      c = op->contact;
  const PetscScalar *solution;
  PetscInt           begin = 0;

  PetscFunctionBegin;
  if (!d->answers) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(d->solution, &solution));
  for (PetscInt k = 0; k < d->n; k++) {
    const PetscInt         b  = d->bodies[k];
    const ContactBodyRows *of = &c->body_rows[b];
    PetscInt               n;
    Mat                    K;

    PetscCall(BodyGetLayerMatrices(c->bodies[b], &K, NULL));
    PetscCall(MatGetLocalSize(K, &n, NULL));
    for (PetscInt l = 0; l < of->n; l++) /* where -y is the solution */
      d->change[l] = InterfaceSideIn(INTERFACE_GAP, &c->pairs[c->rows.pair[of->rows[l]]], b) * solution[d->offset + of->rows[l]];
    for (PetscInt j = 0; j < n; j++) d->moved[j] = -solution[begin + j];
    PetscCall(BodyExpectRepeat(c->bodies[b], d->change, d->moved));
    begin += n;
  }
  PetscCall(VecRestoreArrayRead(d->solution, &solution));
  d->answers = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: the factors are made again when they are needed. The bodies have been loaded before, see ContactVisit(). */
PetscErrorCode InterfaceDirectVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  InterfaceDirect d         = op->direct;
  PetscInt        solutions = 0;
  PetscBool       filled    = PETSC_FALSE;

  PetscFunctionBegin;
  if (d) { /* what has changed since the last solution shows now, and not after the checkpoint */
    PetscCall(TakeState(op));
    solutions = d->solutions;
    filled    = (PetscBool)(d->was_filled || (d->filled && !d->fails));
  }
  PetscCall(CheckpointVisitInts(checkpoint, "solutions", 1, &solutions));
  PetscCall(CheckpointVisitBools(checkpoint, "filled", 1, &filled));
  if (!d || !CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  InterfaceDirectForget(d);
  d->solutions  = solutions;
  d->was_filled = filled;
  PetscFunctionReturn(PETSC_SUCCESS);
}
