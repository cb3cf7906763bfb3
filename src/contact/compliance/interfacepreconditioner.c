/*
   A preconditioner of conjugate gradients for S, where the bodies are linear and have too many rows for a dense matrix: what the Dirichlet
   sides answer with when their rows are moved. Of a body with the effective matrix A, c being the dofs of the surface that its rows are
   on, and j those around them,

     P = R (A_cc - A_cj A_jj^{-1} A_jc) R^T,

   R having the rows of the Dirichlet side alone. With all dofs of the body in j that is the Dirichlet preconditioner of FETI (C. Farhat,
   F.-X. Roux, A method of finite element tearing and interconnecting and its parallel solution algorithm, International Journal for
   Numerical Methods in Engineering 32, 1991; C. Farhat, J. Mandel, The two-level FETI method for static and dynamic plate problems,
   Computer Methods in Applied Mechanics and Engineering 155, 1998), with none its lumped one. What is far from the surface hardly
   counts, so that j has the dofs of the first layers of elements beside c alone, and what takes a solution with the factors of the
   body in the former takes a small part of one here. A massless layer has no j: its P is R K R^T, with its stiffness K.
*/
#include "interfaceslab.h"

struct _n_InterfacePreconditioner {
  PetscInt       n;
  InterfaceSlab *slabs;
};

/* NULL where no body is a Dirichlet side with a matrix that stays as it is */
PetscErrorCode InterfacePreconditionerCreate(InterfaceOperator op, InterfacePreconditioner *preconditioner)
{
  const Contact           contact = op->contact;
  InterfacePreconditioner p;

  PetscFunctionBegin;
  *preconditioner = NULL;
  PetscCall(PetscNew(&p));
  PetscCall(PetscCalloc1(contact->n_bodies, &p->slabs));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool dirichlet = PETSC_FALSE, exact;
    Mat       A, layer;

    for (PetscInt k = 0; k < contact->n_pairs; k++)
      dirichlet = (PetscBool)(dirichlet || contact->pairs[k].body[contact->pairs[k].dirichlet] == b);
    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    PetscCall(BodyGetComplianceMatrices(contact->bodies[b], &A, NULL));
    PetscCall(BodyGetLayerMatrices(contact->bodies[b], &layer, NULL));
    if (!dirichlet || !A || !op->feels[b]) continue;
    /* with a massless layer the surface is all that there is, and a product with K takes next to nothing */
    if (!layer && !exact) continue;
    p->slabs[p->n++] = (InterfaceSlab){.body = b, .is_layer = (PetscBool)(layer != NULL)};
  }
  if (p->n) *preconditioner = p;
  else PetscCall(InterfacePreconditionerDestroy(&p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfacePreconditionerDestroy(InterfacePreconditioner *preconditioner)
{
  PetscFunctionBegin;
  if (!*preconditioner) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < (*preconditioner)->n; k++) PetscCall(InterfaceSlabReset(&(*preconditioner)->slabs[k]));
  PetscCall(PetscFree((*preconditioner)->slabs));
  PetscCall(PetscFree(*preconditioner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the k-th row that a body has on this rank is one of its own, as the Dirichlet side */
static PetscBool IsDirichlet(const Contact contact, PetscInt b, PetscInt k)
{
  const ContactPair *pair = &contact->pairs[contact->rows.pair[contact->body_rows[b].rows[k]]];

  return (PetscBool)(pair->body[pair->dirichlet] == b);
}

/* Which of the rows that are in have a part in R: a node that touches two partners has rows with one direction, of which R may have one, or
   P is singular. A row has one if its largest entry is on a dof of this rank that no other has claimed. */
static PetscErrorCode ChooseRows(InterfaceOperator op, InterfaceSlab *slab)
{
  const Contact      contact = op->contact;
  PetscInt           count   = 0, n, dofs, row, dof; /* the first row and dof of this rank */
  PetscReal          sum     = 0;
  const PetscScalar *diagonal;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(slab->B, &n, &dofs));
  PetscCall(MatGetOwnershipRange(slab->B, &row, NULL));
  PetscCall(MatGetOwnershipRangeColumn(slab->B, &dof, NULL));
  PetscCall(PetscArrayzero(slab->claimed, dofs));
  PetscCall(VecGetArrayRead(slab->diagonal, &diagonal));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           entries, largest = 0, at;

    slab->moves[k] = PETSC_FALSE;
    if (!InterfaceIsIn(op, contact->body_rows[slab->body].rows[k]) || !IsDirichlet(contact, slab->body, k)) continue;
    PetscCall(MatGetRow(slab->B, row + k, &entries, &columns, &values));
    for (PetscInt j = 0; j < entries; j++)
      if (PetscAbsScalar(values[j]) > PetscAbsScalar(values[largest])) largest = j;
    at = entries ? columns[largest] - dof : -1;
    if (at >= 0 && at < dofs && values[largest] != 0 && !slab->claimed[at]) {
      slab->moves[k] = slab->claimed[at] = PETSC_TRUE;
      sum += PetscRealPart(diagonal[at]) * PetscSqr(PetscRealPart(values[largest]));
      count++;
    }
    PetscCall(MatRestoreRow(slab->B, row + k, &entries, &columns, &values));
  }
  slab->mean = count ? sum / count : 1;
  PetscCall(VecRestoreArrayRead(slab->diagonal, &diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one body adds to y = P x, on its rows that are in */
static PetscErrorCode AddSlab(InterfaceOperator op, InterfaceSlab *slab, const PetscScalar x[], PetscScalar y[])
{
  const Contact          contact = op->contact;
  const ContactBodyRows *of      = &contact->body_rows[slab->body];
  const PetscScalar     *out;
  PetscScalar           *in;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(slab->rows, &in));
  for (PetscInt k = 0; k < of->n; k++) in[k] = slab->moves[k] ? x[of->rows[k]] : 0;
  PetscCall(VecRestoreArrayWrite(slab->rows, &in));
  PetscCall(MatMultTranspose(slab->B, slab->rows, slab->dofs));
  PetscCall(VecScatterBegin(slab->gather, slab->dofs, slab->moved, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(slab->gather, slab->dofs, slab->moved, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(InterfaceSlabApply(slab));
  PetscCall(VecZeroEntries(slab->dofs));
  PetscCall(VecScatterBegin(slab->gather, slab->force, slab->dofs, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(slab->gather, slab->force, slab->dofs, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(MatMult(slab->B, slab->dofs, slab->rows));
  PetscCall(VecGetArrayRead(slab->rows, &out));
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt i = of->rows[k];

    if (InterfaceIsIn(op, i) && IsDirichlet(contact, slab->body, k)) y[i] = slab->moves[k] ? out[k] : slab->mean * x[i];
  }
  PetscCall(VecRestoreArrayRead(slab->rows, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the matrices of the bodies as they are now */
PetscErrorCode InterfacePreconditionerUpdate(InterfaceOperator op)
{
  InterfacePreconditioner p = op->preconditioner;

  PetscFunctionBegin;
  for (PetscInt k = 0; p && k < p->n; k++) {
    PetscCall(InterfaceSlabUpdate(op->contact, &p->slabs[k]));
    PetscCall(ChooseRows(op, &p->slabs[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x; rows that are not in stay as they are, and so do those whose Dirichlet side has no part in P */
PetscErrorCode InterfacePreconditionerApply(PC pc, Vec x, Vec y)
{
  InterfaceOperator  op;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &op));
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (PetscInt k = 0; k < op->preconditioner->n; k++) PetscCall(AddSlab(op, &op->preconditioner->slabs[k], in, out));
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether P is there, for some row */
PetscBool InterfaceOperatorHasPreconditioner(InterfaceOperator op)
{
  return (PetscBool)(op->preconditioner != NULL);
}

/* From now on P is for the rows of this rank that are `in`, with the matrices of the bodies as they are */
PetscErrorCode InterfaceOperatorChoose(InterfaceOperator op, const PetscBool in[])
{
  PetscFunctionBegin;
  PetscCall(InterfaceOperatorFactor(op, in, NULL));
  PetscCall(InterfacePreconditionerUpdate(op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = P x on these; elsewhere, and where the Dirichlet side has no part in P, y stays as it comes in */
PetscErrorCode InterfaceOperatorPrecondition(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; op->preconditioner && k < op->preconditioner->n; k++) PetscCall(AddSlab(op, &op->preconditioner->slabs[k], x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}
