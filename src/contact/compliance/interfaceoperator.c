/* S: set up, solved and multiplied with. Which rows it has is in interfacerows.c, its matrices are in interfaceblocks.c and their factors
   in interfacefactor.c, conjugate gradients are in interfaceiteration.c. */
#include "interfaceimpl.h"
#include <sys/stages.h>

PetscErrorCode InterfaceOperatorCreate(Contact contact, const InterfaceSettings *settings, InterfaceOperator *operator)
{
  InterfaceOperator op;

  PetscFunctionBegin;
  PetscCall(PetscNew(&op));
  op->contact  = contact;
  op->settings = *settings;
  op->levels   = 1;
  PetscCall(PetscCalloc6(contact->rows.n, &op->marks, contact->rows.n, &op->diagonal, contact->n_bodies, &op->feels, contact->n_bodies,
                         &op->body_group, contact->n_bodies, &op->has_rows, contact->n_bodies + 1, &op->body_begin));
  PetscCall(PetscCalloc1(contact->n_bodies + 1, &op->block_begin));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyFeelsEndForce(contact->bodies[b], &op->feels[b]));
  if (contact->rows.n_all > PetscMin(settings->few, settings->dense_limit)) {
    if (settings->products) PetscCall(InterfaceOperatorCreateProducts(op));
    else PetscCall(InterfaceOperatorCreateIterative(op));
  }
  *operator= op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceOperatorDestroy(InterfaceOperator *operator)
{
  InterfaceOperator op = *operator;

  PetscFunctionBegin;
  if (!op) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&op->matrix));
  PetscCall(PetscFree6(op->marks, op->diagonal, op->feels, op->body_group, op->has_rows, op->body_begin));
  PetscCall(PetscFree6(op->rows, op->body_rows, op->body_places, op->places, op->listed[0], op->listed[1]));
  PetscCall(PetscFree5(op->group, op->group_rows, op->grouped, op->gathered, op->of_body));
  PetscCall(PetscFree(op->block_begin));
  PetscCall(PetscFree(op->blocks));
  PetscCall(DenseFactorDestroy(&op->factor));
  PetscCall(SparseFactorDestroy(&op->sparse));
  PetscCall(InterfaceOperatorDestroyIterative(op));
  PetscCall(PetscFree(*operator));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S is a sparse matrix of all rows by all rows, in place of what the bodies' compliance tells; NULL: it has changed, and is told again
 * later */
PetscErrorCode InterfaceOperatorSetMatrix(InterfaceOperator op, Mat matrix)
{
  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)matrix));
  PetscCall(MatDestroy(&op->matrix));
  op->matrix    = matrix;
  op->factored  = PETSC_FALSE;
  op->assembled = PETSC_FALSE;
  PetscCall(InterfaceOperatorFindGroups(op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Any of: how many rows are solved for, which, and whether matrices are dense */
void InterfaceOperatorGetRows(InterfaceOperator op, PetscInt *n, const PetscInt *rows[], PetscBool *dense)
{
  if (n) *n = op->n;
  if (rows) *rows = op->rows;
  if (dense) *dense = op->dense;
}

/* Sums over all ranks of values that are zero but on one rank each */
PetscErrorCode InterfaceOperatorSum(InterfaceOperator op, PetscInt n, PetscScalar values[])
{
  PetscFunctionBegin;
  if (op->contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, (PetscMPIInt)n, MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)op->contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values of this rank's rows on the rows that are solved for, of all ranks */
PetscErrorCode InterfaceOperatorGather(InterfaceOperator op, const PetscScalar mine[], PetscScalar all[])
{
  const Contact contact = op->contact;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < op->n; i++) {
    const PetscInt local = op->rows[i] - contact->rows.begin;

    all[i] = local >= 0 && local < contact->rows.n ? mine[local] : 0;
  }
  PetscCall(InterfaceOperatorSum(op, op->n, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values on the rows that are solved for, back on this rank's rows; zero on others */
void InterfaceOperatorScatter(InterfaceOperator op, const PetscScalar all[], PetscScalar mine[])
{
  for (PetscInt i = 0; i < op->contact->rows.n; i++) mine[i] = 0;
  for (PetscInt i = 0; i < op->n; i++) {
    const PetscInt local = op->rows[i] - op->contact->rows.begin;

    if (local >= 0 && local < op->contact->rows.n) mine[local] = all[i];
  }
}

static PetscErrorCode Solve(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  PetscFunctionBegin;
  if (!op->dense) {
    if (!op->factored) PetscCall(InterfaceOperatorFactor(op, NULL, NULL));
    PetscCall(InterfaceOperatorIterate(op, x, y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(InterfaceOperatorGather(op, x, op->listed[0]));
  PetscCall(InterfaceOperatorSolveListed(op, op->listed[0]));
  InterfaceOperatorScatter(op, op->listed[0], y);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (S + diagonal)^{-1} x on this rank's rows that are in, zero on the others; where that is iterated for, y may be the first iterate */
PetscErrorCode InterfaceOperatorSolve(InterfaceOperator op, const PetscScalar x[], PetscScalar y[])
{
  PetscBool logged;

  PetscFunctionBegin;
  PetscCall(StageBegin(STAGE_INTERFACE, &logged));
  PetscCall(Solve(op, x, y));
  PetscCall(StageEnd(logged));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M x on this rank's rows that are solved for, zero on the others, at one level; x and y are not the same */
PetscErrorCode InterfaceOperatorMultiply(InterfaceOperator op, InterfaceMap map, const PetscScalar x[], PetscScalar y[])
{
  PetscFunctionBegin;
  (void)map;
  if (op->dense) {
    PetscCall(InterfaceOperatorGather(op, x, op->listed[0]));
    PetscCall(PetscArrayzero(op->listed[1], op->n));
    PetscCall(InterfaceBlocksMultiply(op, op->listed[0], op->listed[1]));
    InterfaceOperatorScatter(op, op->listed[1], y);
  } else {
    const PetscScalar *moved;
    PetscScalar       *force;

    if (!op->unknown) PetscCall(InterfaceOperatorCreateVecs(op));
    PetscCall(VecGetArrayWrite(op->unknown, &force));
    PetscCall(PetscArraycpy(force, x, op->contact->rows.n));
    PetscCall(VecRestoreArrayWrite(op->unknown, &force));
    PetscCall(InterfaceOperatorApply(op, op->unknown, op->rhs));
    PetscCall(VecGetArrayRead(op->rhs, &moved));
    PetscCall(PetscArraycpy(y, moved, op->contact->rows.n));
    PetscCall(VecRestoreArrayRead(op->rhs, &moved));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint. What the bodies' compliance knows they load themselves; a sparse S is the caller's to set again. */
PetscErrorCode InterfaceOperatorVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  PetscInt        sizes[] = {op->levels, op->n, op->n_in};
  PetscBool       flags[] = {op->dense, op->factored, op->is_sparse};
  PetscLogDouble  flops[] = {op->product_flops, op->spent, op->dense_flops};
  const PetscInt  mine    = op->contact->rows.n;
  const PetscBool loads   = CheckpointLoads(checkpoint);

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "interface operator", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  PetscCall(CheckpointVisitBools(checkpoint, "dense", PETSC_STATIC_ARRAY_LENGTH(flags), flags));
  PetscCall(CheckpointVisitReals(checkpoint, "flops", PETSC_STATIC_ARRAY_LENGTH(flops), flops));
  if (loads) {
    PetscCall(InterfaceOperatorMakeRoom(op, sizes[1]));
    op->levels        = sizes[0];
    op->n             = sizes[1];
    op->n_in          = sizes[2];
    op->dense         = flags[0];
    op->factored      = flags[1];
    op->is_sparse     = flags[2];
    op->product_flops = flops[0];
    op->spent         = flops[1];
    op->dense_flops   = flops[2];
  }
  PetscCall(CheckpointVisitInts(checkpoint, "rows", op->n, op->rows));
  if (loads) PetscCall(InterfaceOperatorFindGroups(op));
  PetscCall(CheckpointVisitInts(checkpoint, "places", op->n_in, op->places));
  PetscCall(CheckpointVisitBytes(checkpoint, "marks", (size_t)mine * sizeof(*op->marks), op->marks));
  PetscCall(CheckpointVisitReals(checkpoint, "diagonal", mine, op->diagonal));
  PetscCall(InterfaceBlocksVisit(op, checkpoint));
  PetscCall(InterfaceFactorVisit(op, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
