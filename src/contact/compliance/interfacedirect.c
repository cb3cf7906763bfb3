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

/* Memory that pivots may take beyond what MUMPS expects [%] */
#define PIVOT_MEMORY 100
/* Solutions by conjugate gradients that take as long as the factors: 2401 rows of hexahedra took 2.4 */
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
  PetscBool         fails;         /* it has no good factors */
  PC                factors;
  Vec               rhs, solution;
  PetscInt          offset; /* of this rank's rows in these */
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
    PetscCall(PetscCalloc5(d->n, &d->K, d->n, &d->C, d->n, &d->Ct, 2 * d->n, &d->states, d->n, &d->rows));
    *direct = d;
    if (contact->ranks.size > 1 && contact->rows.n_all > op->settings.few) contact->parallel_factors = PETSC_TRUE;
  } else PetscCall(InterfaceDirectDestroy(&d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyMatrices(InterfaceDirect d)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < d->n && d->C; k++) {
    PetscCall(MatDestroy(&d->K[k]));
    PetscCall(MatDestroy(&d->C[k]));
    PetscCall(MatDestroy(&d->Ct[k]));
  }
  PetscCall(MatDestroy(&d->D));
  PetscCall(MatDestroy(&d->matrix));
  PetscCall(PCDestroy(&d->factors));
  PetscCall(VecDestroy(&d->rhs));
  PetscCall(VecDestroy(&d->solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceDirectDestroy(InterfaceDirect *direct)
{
  PetscFunctionBegin;
  if (!*direct) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DestroyMatrices(*direct));
  PetscCall(PetscFree((*direct)->bodies));
  PetscCall(PetscFree5((*direct)->K, (*direct)->C, (*direct)->Ct, (*direct)->states, (*direct)->rows));
  PetscCall(PetscFree(*direct));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other rows are solved for, or another diagonal is added */
void InterfaceDirectForget(InterfaceDirect d)
{
  if (!d) return;
  d->solutions = 0;
  d->filled    = PETSC_FALSE;
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

/* Signs of body b on the rows that are in, in this rank's part of a vector of rows */
static PetscErrorCode SetSigns(InterfaceOperator op, PetscInt b, Vec signs)
{
  PetscScalar *sign;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(signs, &sign));
  for (PetscInt i = 0; i < op->contact->rows.n; i++)
    sign[i] = InterfaceIsIn(op, i) ? InterfaceSideIn(INTERFACE_GAP, &op->contact->pairs[op->contact->rows.pair[i]], b) : 0;
  PetscCall(VecRestoreArrayWrite(signs, &sign));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K_b, C_b and its transpose for each layer, -D; in place where they are there */
static PetscErrorCode FillBlocks(InterfaceOperator op)
{
  InterfaceDirect d    = op->direct;
  const MatReuse  keep = d->matrix ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX;
  const Contact   c    = op->contact;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < d->n; k++) {
    Mat K, B;

    PetscCall(BodyGetLayerMatrices(c->bodies[d->bodies[k]], &K, &B));
    if (d->matrix) {
      PetscCall(MatCopy(K, d->K[k], SAME_NONZERO_PATTERN));
      PetscCall(MatCopy(B, d->C[k], SAME_NONZERO_PATTERN));
    } else {
      PetscCall(MatDuplicate(K, MAT_COPY_VALUES, &d->K[k]));
      PetscCall(MatDuplicate(B, MAT_COPY_VALUES, &d->C[k]));
    }
    PetscCall(SetSigns(op, d->bodies[k], op->work[0]));
    PetscCall(MatDiagonalScale(d->C[k], op->work[0], NULL));
    PetscCall(MatTranspose(d->C[k], keep, &d->Ct[k]));
  }
  if (!d->matrix) {
    PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)c), c->rows.n, c->rows.n, c->rows.n_all, c->rows.n_all, 1, NULL, 0, NULL, &d->D));
    PetscCall(MatSetOption(d->D, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  }
  for (PetscInt i = 0; i < c->rows.n; i++) {
    const PetscInt row = c->rows.begin + i;

    PetscCall(MatSetValue(d->D, row, row, InterfaceIsIn(op, i) ? -op->diagonal[i] : -1, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(d->D, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(d->D, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All blocks as one matrix */
static PetscErrorCode JoinBlocks(InterfaceOperator op)
{
  InterfaceDirect d = op->direct;
  const PetscInt  n = d->n + 1;
  Mat            *blocks, nest;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * n, &blocks));
  for (PetscInt k = 0; k < d->n; k++) {
    blocks[k * n + k]    = d->K[k];
    blocks[k * n + d->n] = d->Ct[k];
    blocks[d->n * n + k] = d->C[k];
  }
  blocks[d->n * n + d->n] = d->D;
  PetscCall(MatCreateNest(PetscObjectComm((PetscObject)op->contact), n, NULL, n, NULL, blocks, &nest));
  PetscCall(MatConvert(nest, MATAIJ, d->matrix ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX, &d->matrix));
  PetscCall(MatSetOption(d->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatDestroy(&nest));
  PetscCall(PetscFree(blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateFactors(InterfaceOperator op)
{
  InterfaceDirect d = op->direct;
  PetscInt        local;
  Mat             F;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(d->matrix, &d->solution, &d->rhs));
  PetscCall(VecGetLocalSize(d->rhs, &local));
  d->offset = local - op->contact->rows.n;
  PetscCall(PCCreate(PetscObjectComm((PetscObject)op->contact), &d->factors));
  PetscCall(PCSetOperators(d->factors, d->matrix, d->matrix));
  PetscCall(PCSetType(d->factors, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(d->factors, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(d->factors));
  PetscCall(PCFactorGetMatrix(d->factors, &F));
  PetscCall(MatMumpsSetIcntl(F, 14, PIVOT_MEMORY));
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
  PetscCall(FillBlocks(op));
  PetscCall(JoinBlocks(op));
  if (!d->factors) PetscCall(CreateFactors(op));
  PetscCall(PCSetUp(d->factors));
  PetscCall(PCGetFailedReason(d->factors, &reason));
  d->fails  = (PetscBool)(reason != PC_NOERROR);
  d->filled = PETSC_TRUE;
  PetscCall(PetscLogEventEnd(CONTACT_Factor, op->contact, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (S + diagonal)^{-1} x on this rank's rows that are in, zero on the others; solved: false where there are no factors, and conjugate
   gradients are to do it */
PetscErrorCode InterfaceDirectSolve(InterfaceOperator op, const PetscScalar x[], PetscScalar y[], PetscBool *solved)
{
  InterfaceDirect    d = op->direct;
  const PetscScalar *solution;
  PetscBool          fresh;

  PetscFunctionBegin;
  *solved = PETSC_FALSE;
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
  *solved = (PetscBool)!d->fails;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: the factors are made again when they are needed. The bodies have been loaded before. */
PetscErrorCode InterfaceDirectVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  InterfaceDirect d         = op->direct;
  PetscInt        solutions = 0;

  PetscFunctionBegin;
  if (d) { /* what has changed since the last solution shows now, and not after the checkpoint */
    PetscCall(TakeState(op));
    solutions = d->solutions;
  }
  PetscCall(CheckpointVisitInts(checkpoint, "solutions", 1, &solutions));
  if (!d || !CheckpointLoads(checkpoint)) PetscFunctionReturn(PETSC_SUCCESS);
  InterfaceDirectForget(d);
  d->solutions = solutions;
  PetscFunctionReturn(PETSC_SUCCESS);
}
