/*
   S body by body, where it is not only multiplied with: each body's compliance on the rows of its own that are solved for. Among many bodies that is little beside n by n entries, and products with it are short. The block of one body stands for
   a sparse S that is given as a matrix.
*/
#include "interfaceimpl.h"
#include <checkpoint/checkpoint.h>

/* The places of the rows of a body; returns how many */
PetscInt InterfaceBlockPlaces(InterfaceOperator op, PetscInt b, const PetscInt *places[])
{
  *places = op->of_body + op->body_begin[b];
  return op->has_rows[b] ? op->body_begin[b + 1] - op->body_begin[b] : 0;
}

static PetscInt Sign(InterfaceOperator op, PetscInt place, PetscInt b)
{
  return op->matrix ? 1 : InterfaceSide(&op->contact->pairs[op->contact->ranks.row_pair[op->rows[place]]], b);
}

/* One level of a body's block */
static PetscErrorCode CopyBody(InterfaceOperator op, PetscInt b, PetscInt level, PetscScalar block[])
{
  const PetscScalar *W;
  const PetscInt    *place;
  PetscInt           leading, n = 0;

  PetscFunctionBegin;
  if (op->has_rows[b]) PetscCall(InterfaceOperatorListBodyRows(op, b, &n));
  if (!n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BodyGetCompliance(op->contact->bodies[b], level, &place, &leading, &W));
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) block[j * n + i] = W[place[op->body_rows[j]] * leading + place[op->body_rows[i]]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The listed part of a sparse S, on every rank */
static PetscErrorCode CopyMatrix(InterfaceOperator op, PetscScalar block[])
{
  const Contact contact = op->contact;
  PetscInt     *place;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(block, op->n * op->n));
  PetscCall(PetscMalloc1(contact->rows.n_all, &place));
  for (PetscInt i = 0; i < contact->rows.n_all; i++) place[i] = -1;
  for (PetscInt i = 0; i < op->n; i++) place[op->rows[i]] = i;
  for (PetscInt i = 0; i < op->n; i++) {
    const PetscInt     local = op->rows[i] - contact->rows.begin, *columns;
    const PetscScalar *values;
    PetscInt           count;

    if (local < 0 || local >= contact->rows.n) continue;
    PetscCall(MatGetRow(op->matrix, op->rows[i], &count, &columns, &values));
    for (PetscInt k = 0; k < count; k++)
      if (place[columns[k]] >= 0) block[place[columns[k]] * op->n + i] = values[k];
    PetscCall(MatRestoreRow(op->matrix, op->rows[i], &count, &columns, &values));
  }
  PetscCall(InterfaceOperatorSum(op, op->n * op->n, block));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where blocks begin; returns how many entries those of all levels have */
static PetscInt PlaceBlocks(InterfaceOperator op)
{
  op->block_begin[0] = 0;
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    const PetscInt *places, n = InterfaceBlockPlaces(op, b, &places);

    op->block_begin[b + 1] = op->block_begin[b] + n * n;
  }
  return op->levels * op->block_begin[op->contact->n_bodies];
}

static PetscErrorCode MakeRoom(InterfaceOperator op, PetscInt size)
{
  PetscFunctionBegin;
  if (size <= op->blocks_room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(op->blocks));
  op->blocks_room = PetscMax(size, 2 * op->blocks_room);
  PetscCall(PetscMalloc1(op->blocks_room, &op->blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The blocks of all levels, unless they are there: displacements k substeps after forces, or, where there is one level, at the end of the
   controller step for forces that rise linearly over it */
PetscErrorCode InterfaceBlocksUpdate(InterfaceOperator op)
{
  PetscFunctionBegin;
  if (op->assembled) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(op, PlaceBlocks(op)));
  if (op->matrix) PetscCall(CopyMatrix(op, op->blocks));
  for (PetscInt k = 0; k < op->levels && !op->matrix; k++)
    for (PetscInt b = 0; b < op->contact->n_bodies; b++)
      PetscCall(CopyBody(op, b, op->levels == 1 ? -1 : k, op->blocks + k * op->block_begin[op->contact->n_bodies] + op->block_begin[b]));
  op->assembled = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what one body does at the first level to a matrix by columns; `to`: for each listed row its place there, less than 0: it has none */
void InterfaceBlocksAdd(InterfaceOperator op, PetscInt b, const PetscInt to[], PetscInt leading, PetscScalar matrix[])
{
  const PetscScalar *block = op->blocks + op->block_begin[b];
  const PetscInt    *places, n = InterfaceBlockPlaces(op, b, &places);

  for (PetscInt l = 0; l < n; l++) {
    const PetscInt j = to[places[l]], sign_j = Sign(op, places[l], b);

    for (PetscInt k = 0; k < n && sign_j && j >= 0; k++) {
      const PetscInt i = to[places[k]], sign_i = Sign(op, places[k], b);

      if (sign_i && i >= 0) matrix[j * leading + i] += sign_i * sign_j * block[l * n + k];
    }
  }
}

/* S at the first level on the rows that are solved for, n x n by columns [m/N], of the bodies as they are now */
PetscErrorCode InterfaceOperatorAssemble(InterfaceOperator op, InterfaceMap map, PetscScalar matrix[])
{
  PetscFunctionBegin;
  (void)map;
  PetscCheck(op->dense, PetscObjectComm((PetscObject)op->contact), PETSC_ERR_ARG_WRONGSTATE,
             "The interface is too large for dense matrices");
  op->assembled = PETSC_FALSE;
  PetscCall(InterfaceBlocksUpdate(op));
  PetscCall(PetscArrayzero(matrix, op->n * op->n));
  for (PetscInt i = 0; i < op->n; i++) op->body_places[i] = i;
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) InterfaceBlocksAdd(op, b, op->body_places, op->n, matrix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += S x at the first level on the rows that are solved for */
PetscErrorCode InterfaceBlocksMultiply(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  PetscScalar *in = op->gathered, *out = in + op->n;

  PetscFunctionBegin;
  PetscCall(InterfaceBlocksUpdate(op));
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    const PetscInt *places, n = InterfaceBlockPlaces(op, b, &places);

    for (PetscInt k = 0; k < n; k++) {
      in[k]  = Sign(op, places[k], b) * x[places[k]];
      out[k] = 0;
    }
    PetscCall(DenseMultiplyAdd(n, n, op->blocks + op->block_begin[b], 1, in, out));
    for (PetscInt k = 0; k < n; k++) y[places[k]] += Sign(op, places[k], b) * out[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: the rows are there */
PetscErrorCode InterfaceBlocksVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  PetscInt size = 0;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitBools(checkpoint, "assembled", 1, &op->assembled));
  if (op->assembled) size = PlaceBlocks(op);
  if (CheckpointLoads(checkpoint)) PetscCall(MakeRoom(op, size));
  PetscCall(CheckpointVisitReals(checkpoint, "blocks", size, op->blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
