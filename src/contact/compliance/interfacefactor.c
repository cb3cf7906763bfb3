/*
   Factors of S on the rows that are in, the same on every rank: dense, group by group; or sparse where many bodies touch each other, each a
   few others: 1000 discs at rest in a box have 2 10^3 active rows in one group, and a dozen entries to a row.
*/
#include "interfaceimpl.h"
#include <checkpoint/checkpoint.h>
#include <sys/stages.h>

/* Lists the places of the rows that are in, those with a diagonal of 0 or more, group by group; in[]: how many each has */
static void ListPlaces(InterfaceOperator op, const PetscScalar diagonal[], PetscInt in[])
{
  PetscInt *next  = op->body_rows; /* work space that is free here */
  PetscInt  begin = 0;

  for (PetscInt g = 0; g < op->n_groups; g++) in[g] = 0;
  for (PetscInt i = 0; i < op->n; i++) in[op->group[i]] += PetscRealPart(diagonal[i]) >= 0;
  for (PetscInt g = 0; g < op->n_groups; g++) {
    next[g] = begin;
    begin += in[g];
  }
  op->n_in = begin;
  for (PetscInt i = 0; i < op->n; i++)
    if (PetscRealPart(diagonal[i]) >= 0) op->places[next[op->group[i]]++] = i;
}

/* The entries of the factor's blocks */
static PetscErrorCode FillBlocks(InterfaceOperator op, const PetscScalar diagonal[])
{
  PetscInt *to = op->body_places, order; /* of each listed row, its place in the block of its group */

  PetscFunctionBegin;
  for (PetscInt i = 0; i < op->n; i++) to[i] = -1;
  for (PetscInt g = 0; g < op->n_groups; g++) {
    PetscScalar *block = DenseFactorGetBlock(&op->factor, g, &order);

    PetscCall(PetscArrayzero(block, order * order));
    for (PetscInt k = 0; k < order; k++) {
      const PetscInt place = op->places[op->factor.begin[g] + k];

      to[place]              = k;
      block[k * (order + 1)] = diagonal[place];
    }
  }
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    PetscScalar *block;

    if (op->block_begin[b + 1] == op->block_begin[b]) continue;
    block = DenseFactorGetBlock(&op->factor, op->group[op->of_body[op->body_begin[b]]], &order);
    InterfaceBlocksAdd(op, b, to, order, block);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S with the diagonal, of type MATSEQAIJ */
static PetscErrorCode CreateSparse(InterfaceOperator op, const PetscScalar diagonal[], Mat *S)
{
  PetscInt    *to = op->body_places, *entries = op->body_rows; /* of each listed row, its place; of each of those, room for entries */
  PetscInt    *numbers, most                  = 0;
  PetscScalar *values;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < op->n; i++) to[i] = -1;
  for (PetscInt k = 0; k < op->n_in; k++) {
    to[op->places[k]] = k;
    entries[k]        = 1;
  }
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    const PetscInt *places, n = InterfaceBlockPlaces(op, b, &places);

    most = PetscMax(most, n);
    for (PetscInt k = 0; k < n; k++)
      if (to[places[k]] >= 0) entries[to[places[k]]] += n;
  }
  for (PetscInt k = 0; k < op->n_in; k++) entries[k] = PetscMin(entries[k], op->n_in);
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, op->n_in, op->n_in, 0, entries, S));
  PetscCall(MatSetOption(*S, MAT_ROW_ORIENTED, PETSC_FALSE));
  PetscCall(PetscMalloc2(op->n, &numbers, most * most, &values));
  for (PetscInt i = 0; i < op->n; i++) numbers[i] = -1;
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    const PetscInt *places, n = InterfaceBlockPlaces(op, b, &places);

    for (PetscInt k = 0; k < n; k++) numbers[places[k]] = k;
    PetscCall(PetscArrayzero(values, n * n));
    InterfaceBlocksAdd(op, b, numbers, n, values);
    for (PetscInt k = 0; k < n; k++) {
      numbers[places[k]] = -1;
      entries[k]         = to[places[k]]; /* those below 0 are left out */
    }
    PetscCall(MatSetValues(*S, n, entries, n, entries, values, ADD_VALUES));
  }
  for (PetscInt k = 0; k < op->n_in; k++) PetscCall(MatSetValue(*S, k, k, diagonal[op->places[k]], ADD_VALUES));
  PetscCall(MatAssemblyBegin(*S, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*S, MAT_FINAL_ASSEMBLY));
  PetscCall(PetscFree2(numbers, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factors for the rows that are in and the blocks as they are */
static PetscErrorCode Compute(InterfaceOperator op)
{
  PetscScalar *listed = op->listed[1]; /* the first may be what is solved for */
  PetscBool    singular;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorGather(op, op->diagonal, listed));
  ListPlaces(op, listed, op->body_places);
  if (op->is_sparse) {
    Mat S;

    PetscCall(CreateSparse(op, listed, &S));
    PetscCall(SparseFactorCompute(&op->sparse, S, &singular));
    PetscCall(MatDestroy(&S));
  } else {
    PetscCall(DenseFactorResizeBlocks(&op->factor, op->n_groups, op->body_places, op->contact->rows.n_all));
    PetscCall(FillBlocks(op, listed));
    PetscCall(DenseFactorCompute(&op->factor, &singular));
  }
  PetscCheck(!singular, PetscObjectComm((PetscObject)op->contact), PETSC_ERR_MAT_LU_ZRPVT,
             "The matrix of the contact forces is singular: contact rows are not independent, and constrain each other, or the "
             "bodies differ in stiffness by more than numbers have digits (check units, thickness and modulus)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Factor(InterfaceOperator op, const PetscBool in[], const PetscReal diagonal[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < op->contact->rows.n; i++)
    op->diagonal[i] = op->marks[i] != INTERFACE_SOLVED || (in && !in[i]) ? -1 : diagonal ? diagonal[i] : 0;
  op->factored = PETSC_TRUE;
  if (!op->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(InterfaceBlocksUpdate(op));
  PetscCall(Compute(op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From now on S is solved on the rows of this rank that are `in` (NULL: all that are to be solved for), with `diagonal` (NULL: zero) added
   to its own: the compliance of springs between both sides */
PetscErrorCode InterfaceOperatorFactor(InterfaceOperator op, const PetscBool in[], const PetscReal diagonal[])
{
  PetscBool logged;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(Factor(op, in, diagonal));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = (S + diagonal)^{-1} x on the rows that are in, zero on the others, with S at its first level */
PetscErrorCode InterfaceOperatorSolveListed(InterfaceOperator op, PetscScalar x[])
{
  PetscFunctionBegin;
  if (!op->factored) PetscCall(InterfaceOperatorFactor(op, NULL, NULL));
  for (PetscInt k = 0; k < op->n_in; k++) op->grouped[k] = x[op->places[k]];
  if (op->is_sparse) PetscCall(SparseFactorSolve(&op->sparse, op->grouped));
  else PetscCall(DenseFactorSolve(&op->factor, op->grouped));
  PetscCall(PetscArrayzero(x, op->n));
  for (PetscInt k = 0; k < op->n_in; k++) x[op->places[k]] = op->grouped[k];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: sparse factors are made again, of the same blocks */
PetscErrorCode InterfaceFactorVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  PetscFunctionBegin;
  if (!op->is_sparse) PetscCall(DenseFactorVisit(&op->factor, op->contact->rows.n_all, checkpoint));
  else if (op->dense && op->factored && CheckpointLoads(checkpoint)) PetscCall(Compute(op));
  PetscFunctionReturn(PETSC_SUCCESS);
}
