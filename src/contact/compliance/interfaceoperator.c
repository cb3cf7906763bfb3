/* S, and its dense form; which rows it has is in interfacerows.c, conjugate gradients are in interfaceiteration.c. */
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
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyFeelsEndForce(contact->bodies[b], &op->feels[b]));
  if (settings->direct) PetscCall(InterfaceDirectCreate(op, &op->direct));
  if (contact->rows.n_all > PetscMin(settings->few, settings->dense_limit)) PetscCall(InterfaceOperatorCreateIterative(op));
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
  PetscCall(PetscFree4(op->group, op->group_rows, op->grouped, op->of_body));
  for (PetscInt m = 0; m < INTERFACE_MAPS; m++) PetscCall(PetscFree(op->matrices[m]));
  PetscCall(DenseFactorDestroy(&op->factor));
  PetscCall(InterfaceOperatorDestroyIterative(op));
  PetscCall(InterfaceDirectDestroy(&op->direct));
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
  op->matrix   = matrix;
  op->factored = PETSC_FALSE;
  for (PetscInt m = 0; m < INTERFACE_MAPS; m++) op->assembled[m] = PETSC_FALSE;
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

/* Adds what one body does */
static PetscErrorCode AddBody(InterfaceOperator op, InterfaceMap map, PetscInt b, PetscInt level, PetscScalar matrix[])
{
  const Contact      contact = op->contact;
  const PetscScalar *W;
  const PetscInt    *place;
  PetscInt           leading, n = 0;

  PetscFunctionBegin;
  PetscCall(BodyGetCompliance(contact->bodies[b], level, &place, &leading, &W));
  PetscCall(InterfaceOperatorListBodyRows(op, b, 0, op->n, &n));
  for (PetscInt l = 0; l < n; l++) {
    const PetscInt     j      = op->body_places[l];
    const PetscInt     sign_j = InterfaceSideIn(map, &contact->pairs[contact->ranks.row_pair[op->rows[j]]], b);
    const PetscScalar *column = W + place[op->body_rows[l]] * leading;

    for (PetscInt k = 0; k < n && sign_j; k++) {
      const PetscInt i      = op->body_places[k];
      const PetscInt sign_i = InterfaceSideOut(map, &contact->pairs[contact->ranks.row_pair[op->rows[i]]], b);

      if (sign_i) matrix[j * op->n + i] += sign_i * sign_j * column[place[op->body_rows[k]]];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The listed part of a sparse S, on every rank */
static PetscErrorCode AssembleFromMatrix(InterfaceOperator op, PetscScalar matrix[])
{
  const Contact contact = op->contact;
  PetscInt     *place;

  PetscFunctionBegin;
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
      if (place[columns[k]] >= 0) matrix[place[columns[k]] * op->n + i] = values[k];
    PetscCall(MatRestoreRow(op->matrix, op->rows[i], &count, &columns, &values));
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, matrix, (PetscMPIInt)(op->n * op->n), MPIU_SCALAR, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A map's matrix on the rows that are solved for, n x n by columns [m/N]: displacements k substeps after forces, or, for level -1, at the
   end of the controller step for forces that rise linearly over it */
PetscErrorCode InterfaceOperatorAssemble(InterfaceOperator op, InterfaceMap map, PetscInt level, PetscScalar matrix[])
{
  PetscFunctionBegin;
  PetscCheck(op->dense, PetscObjectComm((PetscObject)op->contact), PETSC_ERR_ARG_WRONGSTATE,
             "The interface is too large for dense matrices");
  PetscCall(PetscArrayzero(matrix, op->n * op->n));
  if (op->matrix) PetscCall(AssembleFromMatrix(op, matrix));
  for (PetscInt b = 0; b < op->contact->n_bodies && !op->matrix; b++)
    if (op->has_rows[b]) PetscCall(AddBody(op, map, b, level, matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All levels of a map, unless they are there */
static PetscErrorCode MakeMatrices(InterfaceOperator op, InterfaceMap map)
{
  const PetscInt square = op->n * op->n, size = op->levels * square;

  PetscFunctionBegin;
  if (op->assembled[map]) PetscFunctionReturn(PETSC_SUCCESS);
  if (size > op->sizes[map]) {
    PetscCall(PetscFree(op->matrices[map]));
    op->sizes[map] = PetscMax(size, 2 * op->sizes[map]);
    PetscCall(PetscMalloc1(op->sizes[map], &op->matrices[map]));
  }
  for (PetscInt k = 0; k < op->levels; k++)
    PetscCall(InterfaceOperatorAssemble(op, map, op->levels == 1 ? -1 : k, op->matrices[map] + k * square));
  op->assembled[map] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
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

/* Lists the places of the rows that are in, those with a diagonal of 0 or more, group by group, and tells the factor how many each has */
static PetscErrorCode ListPlaces(InterfaceOperator op, const PetscScalar diagonal[])
{
  PetscInt *next = op->body_rows, *in = op->body_places; /* work space that is free here */
  PetscInt  begin = 0;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < op->n_groups; g++) in[g] = 0;
  for (PetscInt i = 0; i < op->n; i++) in[op->group[i]] += PetscRealPart(diagonal[i]) >= 0;
  for (PetscInt g = 0; g < op->n_groups; g++) {
    next[g] = begin;
    begin += in[g];
  }
  op->n_in = begin;
  for (PetscInt i = 0; i < op->n; i++)
    if (PetscRealPart(diagonal[i]) >= 0) op->places[next[op->group[i]]++] = i;
  PetscCall(DenseFactorResize(&op->factor, op->n_in, op->contact->rows.n_all));
  PetscCall(DenseFactorSetBlocks(&op->factor, op->n_groups, in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From now on S is solved on the rows of this rank that are `in` (NULL: all that are to be solved for), with `diagonal` (NULL: zero) added
   to its own: the compliance of springs between both sides */
static PetscErrorCode Factor(InterfaceOperator op, const PetscBool in[], const PetscReal diagonal[])
{
  PetscScalar *listed = op->listed[1], *S; /* the first may be what is solved for */
  PetscBool    singular;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < op->contact->rows.n; i++)
    op->diagonal[i] = op->marks[i] != INTERFACE_SOLVED || (in && !in[i]) ? -1 : diagonal ? diagonal[i] : 0;
  op->factored = PETSC_TRUE;
  InterfaceDirectForget(op->direct);
  if (!op->dense) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeMatrices(op, INTERFACE_GAP));
  S = op->matrices[INTERFACE_GAP];
  PetscCall(InterfaceOperatorGather(op, op->diagonal, listed));
  PetscCall(ListPlaces(op, listed));
  for (PetscInt j = 0; j < op->n_in; j++)
    for (PetscInt i = 0; i < op->n_in; i++)
      op->factor.values[j * op->n_in + i] = S[op->places[j] * op->n + op->places[i]] + (i == j ? listed[op->places[i]] : 0);
  PetscCall(DenseFactorCompute(&op->factor, &singular));
  PetscCheck(!singular, PetscObjectComm((PetscObject)op->contact), PETSC_ERR_MAT_LU_ZRPVT,
             "The matrix of the contact forces is singular: contact rows are not independent, and constrain each other, or the "
             "bodies differ in stiffness by more than numbers have digits (check units, thickness and modulus)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscCall(DenseFactorSolve(&op->factor, op->grouped));
  PetscCall(PetscArrayzero(x, op->n));
  for (PetscInt k = 0; k < op->n_in; k++) x[op->places[k]] = op->grouped[k];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += scale M x on the rows that are solved for */
PetscErrorCode InterfaceOperatorMultiplyListed(InterfaceOperator op, InterfaceMap map, PetscInt level, PetscReal scale,
                                               const PetscScalar x[], PetscScalar y[])
{
  PetscFunctionBegin;
  PetscCall(MakeMatrices(op, map));
  PetscCall(DenseMultiplyAdd(op->n, op->n, op->matrices[map] + level * op->n * op->n, scale, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Values on the rows that are solved for, back on this rank's rows; zero on others */
static void Scatter(InterfaceOperator op, const PetscScalar all[], PetscScalar mine[])
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
    PetscBool solved = PETSC_FALSE;

    if (!op->factored) PetscCall(InterfaceOperatorFactor(op, NULL, NULL));
    if (InterfaceIsDirect(op)) PetscCall(InterfaceDirectSolve(op, x, y, &solved));
    if (!solved) PetscCall(InterfaceOperatorIterate(op, x, y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(InterfaceOperatorGather(op, x, op->listed[0]));
  PetscCall(InterfaceOperatorSolveListed(op, op->listed[0]));
  Scatter(op, op->listed[0], y);
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
  if (op->dense) {
    PetscCall(InterfaceOperatorGather(op, x, op->listed[0]));
    PetscCall(PetscArrayzero(op->listed[1], op->n));
    PetscCall(InterfaceOperatorMultiplyListed(op, map, 0, 1, op->listed[0], op->listed[1]));
    Scatter(op, op->listed[1], y);
  } else {
    const PetscScalar *moved;
    PetscScalar       *force;

    if (!op->unknown) PetscCall(InterfaceOperatorCreateVecs(op));
    PetscCall(VecGetArrayWrite(op->unknown, &force));
    PetscCall(PetscArraycpy(force, x, op->contact->rows.n));
    PetscCall(VecRestoreArrayWrite(op->unknown, &force));
    PetscCall(InterfaceOperatorApply(op, map, op->unknown, op->rhs));
    PetscCall(VecGetArrayRead(op->rhs, &moved));
    PetscCall(PetscArraycpy(y, moved, op->contact->rows.n));
    PetscCall(VecRestoreArrayRead(op->rhs, &moved));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint. What the bodies' compliance knows they load themselves; a sparse S is the caller's to set again. */
PetscErrorCode InterfaceOperatorVisit(InterfaceOperator op, Checkpoint checkpoint)
{
  PetscInt        sizes[] = {op->levels, op->n, op->n_known, op->n_in};
  PetscBool       flags[] = {op->dense, op->factored};
  PetscLogDouble  flops[] = {op->product_flops, op->spent, op->dense_flops};
  const PetscInt  mine    = op->contact->rows.n;
  const PetscBool loads   = CheckpointLoads(checkpoint);

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "interface operator", PETSC_STATIC_ARRAY_LENGTH(sizes), sizes));
  PetscCall(CheckpointVisitBools(checkpoint, "dense", PETSC_STATIC_ARRAY_LENGTH(flags), flags));
  PetscCall(CheckpointVisitReals(checkpoint, "flops", PETSC_STATIC_ARRAY_LENGTH(flops), flops));
  if (loads) {
    PetscCall(InterfaceOperatorMakeRoom(op, sizes[2]));
    op->levels        = sizes[0];
    op->n             = sizes[1];
    op->n_known       = sizes[2];
    op->n_in          = sizes[3];
    op->dense         = flags[0];
    op->factored      = flags[1];
    op->product_flops = flops[0];
    op->spent         = flops[1];
    op->dense_flops   = flops[2];
  }
  PetscCall(CheckpointVisitInts(checkpoint, "rows", op->n_known, op->rows));
  if (loads) PetscCall(InterfaceOperatorFindGroups(op));
  PetscCall(CheckpointVisitInts(checkpoint, "places", op->n_in, op->places));
  PetscCall(CheckpointVisitBytes(checkpoint, "marks", (size_t)mine * sizeof(*op->marks), op->marks));
  PetscCall(CheckpointVisitReals(checkpoint, "diagonal", mine, op->diagonal));
  PetscCall(CheckpointVisitBools(checkpoint, "assembled", INTERFACE_MAPS, op->assembled));
  for (PetscInt m = 0; m < INTERFACE_MAPS; m++) {
    const PetscInt size = op->assembled[m] ? op->levels * op->n * op->n : 0;

    if (loads && size > op->sizes[m]) {
      PetscCall(PetscFree(op->matrices[m]));
      PetscCall(PetscMalloc1(size, &op->matrices[m]));
      op->sizes[m] = size;
    }
    PetscCall(CheckpointVisitReals(checkpoint, "map", size, op->matrices[m]));
  }
  PetscCall(DenseFactorVisit(&op->factor, op->contact->rows.n_all, checkpoint));
  PetscCall(InterfaceDirectVisit(op, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}
