/*
   What preconditions S on rows whose Dirichlet side answers by a massless layer with the stiffness K: what the layer answers with when its
   rows are moved, P = R K R^T, R having the rows of that side alone. It is the lumped preconditioner of FETI (C. Farhat, F.-X. Roux, A
   method of finite element tearing and interconnecting and its parallel solution algorithm, International Journal for Numerical Methods in
   Engineering 32, 1991), takes no factors, and so goes with layers of nonlinear bodies and with rows that change with each step.
*/
#include "interfacelayer.h"

PetscErrorCode InterfaceLayerReset(InterfaceLayer *layer)
{
  PetscFunctionBegin;
  PetscCall(VecDestroy(&layer->rows));
  PetscCall(VecDestroy(&layer->dofs));
  PetscCall(VecDestroy(&layer->force));
  PetscCall(VecDestroy(&layer->diagonal));
  PetscCall(PetscFree2(layer->moves, layer->claimed));
  PetscCall(PetscFree(layer->has));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the rows that are in have a part in R: a node that touches two partners has rows with one direction, of which R may have one, or
   P is singular. A row has one if its largest entry is on a dof of this rank that no other has claimed. */
static PetscErrorCode ChooseRows(InterfaceOperator op, InterfaceLayer *layer)
{
  const Contact      contact = op->contact;
  PetscInt           count   = 0, n, dofs, row, dof; /* the first row and dof of this rank */
  PetscReal          sum     = 0;
  const PetscScalar *diagonal;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(layer->B, &n, &dofs));
  PetscCall(MatGetOwnershipRange(layer->B, &row, NULL));
  PetscCall(MatGetOwnershipRangeColumn(layer->B, &dof, NULL));
  PetscCall(PetscArrayzero(layer->claimed, dofs));
  PetscCall(VecGetArrayRead(layer->diagonal, &diagonal));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries, largest = 0, at;

    layer->moves[k] = PETSC_FALSE;
    if (!InterfaceIsIn(op, contact->body_rows[layer->body].rows[k]) ||
        !layer->has[contact->rows.pair[contact->body_rows[layer->body].rows[k]]])
      continue;
    PetscCall(MatGetRow(layer->B, row + k, &entries, &columns, &values));
    for (PetscInt j = 0; j < entries; j++)
      if (PetscAbsScalar(values[j]) > PetscAbsScalar(values[largest])) largest = j;
    at = entries ? columns[largest] - dof : -1;
    if (at >= 0 && at < dofs && values[largest] != 0 && !layer->claimed[at]) {
      layer->moves[k] = layer->claimed[at] = PETSC_TRUE;
      sum += PetscRealPart(diagonal[at]) * PetscSqr(PetscRealPart(values[largest]));
      count++;
    }
    PetscCall(MatRestoreRow(layer->B, row + k, &entries, &columns, &values));
  }
  layer->mean = count ? sum / count : 1;
  PetscCall(VecRestoreArrayRead(layer->diagonal, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the layer and its rows as they are now */
PetscErrorCode InterfaceLayerUpdate(InterfaceOperator op, InterfaceLayer *layer)
{
  PetscFunctionBegin;
  PetscCall(BodyGetLayerMatrices(op->contact->bodies[layer->body], &layer->K, &layer->B));
  if (!layer->rows) {
    PetscInt rows, dofs;

    PetscCall(MatCreateVecs(layer->B, &layer->dofs, &layer->rows));
    PetscCall(VecDuplicate(layer->dofs, &layer->force));
    PetscCall(VecDuplicate(layer->dofs, &layer->diagonal));
    PetscCall(MatGetLocalSize(layer->B, &rows, &dofs));
    PetscCall(PetscMalloc2(rows, &layer->moves, dofs, &layer->claimed));
  }
  PetscCall(MatGetDiagonal(layer->K, layer->diagonal));
  PetscCall(ChooseRows(op, layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x, on the rows of the body that are in */
PetscErrorCode InterfaceLayerApply(InterfaceOperator op, InterfaceLayer *layer, const PetscScalar x[], PetscScalar y[])
{
  const Contact          contact = op->contact;
  const ContactBodyRows *of      = &contact->body_rows[layer->body];
  const PetscScalar     *out;
  PetscScalar           *in;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(layer->rows, &in));
  for (PetscInt k = 0; k < of->n; k++) in[k] = layer->moves[k] ? x[of->rows[k]] : 0;
  PetscCall(VecRestoreArrayWrite(layer->rows, &in));
  PetscCall(MatMultTranspose(layer->B, layer->rows, layer->dofs));
  PetscCall(MatMult(layer->K, layer->dofs, layer->force));
  PetscCall(MatMult(layer->B, layer->force, layer->rows));
  PetscCall(VecGetArrayRead(layer->rows, &out));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt i = of->rows[k];

    if (InterfaceIsIn(op, i) && layer->has[contact->rows.pair[i]]) y[i] = layer->moves[k] ? out[k] : layer->mean * x[i];
  }
  PetscCall(VecRestoreArrayRead(layer->rows, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}
