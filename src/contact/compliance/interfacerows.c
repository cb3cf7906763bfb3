/* The rows of S, and whether its matrices are dense on them. */
#include "interfaceimpl.h"

/* Factors of S are sparse where it has so many times more places than entries, and dense factors would take so many operations */
#define SPARSE_PART 8
#define CHEAP_FLOPS 1e6

/* Where nothing is iterated for here: n^3 operations of dense LU factors are as fast as so many products. Steps with friction take some ten
   products for each factorization, and sparse factors make fewer operations in a second than dense ones. */
#define PRODUCTS_OF_FACTORS 50

/* Room for n listed rows */
PetscErrorCode InterfaceOperatorMakeRoom(InterfaceOperator op, PetscInt n)
{
  PetscFunctionBegin;
  if (n <= op->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree6(op->rows, op->body_rows, op->body_places, op->places, op->listed[0], op->listed[1]));
  PetscCall(PetscFree5(op->group, op->group_rows, op->grouped, op->gathered, op->of_body));
  op->room = PetscMax(n, PetscMin(2 * op->room, op->contact->rows.n_all));
  PetscCall(PetscMalloc6(op->room, &op->rows, op->room, &op->body_rows, op->room, &op->body_places, op->room, &op->places, op->room,
                         &op->listed[0], op->room, &op->listed[1]));
  PetscCall(PetscMalloc5(op->room, &op->group, op->room, &op->group_rows, op->room, &op->grouped, 2 * op->room, &op->gathered, 2 * op->room,
                         &op->of_body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The listed rows that concern a body: into body_rows their numbers among the rows of the body, and into body_places their places in the
   list, which ascend */
PetscErrorCode InterfaceOperatorListBodyRows(InterfaceOperator op, PetscInt b, PetscInt *n)
{
  const ContactBodyRows *of = &op->contact->body_rows[b];

  PetscFunctionBegin;
  *n = 0;
  for (PetscInt k = op->body_begin[b]; k < op->body_begin[b + 1]; k++) {
    PetscCall(PetscFindInt(op->rows[op->of_body[k]], of->n_all, of->all, &op->body_rows[*n]));
    op->body_places[(*n)++] = op->of_body[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Entries of S, those on the diagonal twice */
static PetscLogDouble CountEntries(InterfaceOperator op)
{
  PetscLogDouble entries = 0;

  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    const PetscInt *places, n = InterfaceBlockPlaces(op, b, &places);

    entries += (PetscLogDouble)n * n;
  }
  return entries;
}

/* Whether factors of S are to be sparse: where bodies are many, and dense factors of their groups would not be cheap */
static PetscBool IsSparse(InterfaceOperator op)
{
  PetscLogDouble dense = 0, square = 0;

  if (!op->settings.sparse || op->levels > 1 || op->matrix) return PETSC_FALSE;
  for (PetscInt g = 0; g < op->n_groups; g++) {
    dense += DenseFactorFlops(op->group_rows[g]);
    square += PetscSqr((PetscLogDouble)op->group_rows[g]);
  }
  return (PetscBool)(dense > CHEAP_FLOPS && square > SPARSE_PART * CountEntries(op));
}

/* Operations that one product with S takes, and those that it takes to have a dense matrix, its columns and its factors, in its place */
static PetscErrorCode CountFlops(InterfaceOperator op, PetscLogDouble *product, PetscLogDouble *dense)
{
  PetscFunctionBegin;
  *product = 0;
  *dense   = 0;
  if (op->is_sparse) *dense = SparseFactorFlops(op->n, CountEntries(op));
  for (PetscInt g = 0; g < op->n_groups && !op->is_sparse; g++) *dense += DenseFactorFlops(op->group_rows[g]);
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    PetscLogDouble apply, extend;
    PetscInt       n;

    if (!op->has_rows[b]) continue;
    PetscCall(InterfaceOperatorListBodyRows(op, b, &n));
    PetscCall(BodyGetComplianceFlops(op->contact->bodies[b], n, op->body_rows, &apply, &extend));
    if (op->feels[b]) *product += apply;
    *dense += extend;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether matrices are to be dense: where they are small or cost little, and else, without sparse factors, once iterations have cost as
   much, which with an unknown number of steps to come is never more than twice as dear as the better of the two. Where bodies make substeps
   a product is not all of S, and iterations take more sweeps: there matrices are dense up to the limit. */
static PetscErrorCode ChooseDense(InterfaceOperator op)
{
  const PetscInt size     = op->n * op->levels;
  PetscBool      substeps = PETSC_FALSE;

  PetscFunctionBegin;
  op->dense_flops = 0;
  op->is_sparse   = IsSparse(op);
  op->dense       = (PetscBool)(size <= op->settings.dense_limit || op->is_sparse);
  if (op->settings.products && op->dense && size > op->settings.few) {
    PetscCall(CountFlops(op, &op->product_flops, &op->dense_flops));
    op->dense       = (PetscBool)(PRODUCTS_OF_FACTORS * op->product_flops > (PetscLogDouble)size * size * size);
    op->dense_flops = 0;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!op->dense || size <= op->settings.few || op->matrix) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    PetscInt n;

    PetscCall(BodyGetSubsteps(op->contact->bodies[b], &n));
    if (n > 1) substeps = PETSC_TRUE;
  }
  if (substeps) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CountFlops(op, &op->product_flops, &op->dense_flops));
  op->dense = (PetscBool)(op->spent >= op->dense_flops);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the rows of the problem: `marks` of this rank's rows. Where matrices are dense, the bodies get to know the rows that are solved
   for, those too that answer to their forces in later substeps alone; else nothing but the marks is kept. Collective. */
PetscErrorCode InterfaceOperatorSetRows(InterfaceOperator op, const InterfaceMark marks[], PetscInt levels)
{
  Contact contact = op->contact;

  PetscFunctionBegin;
  op->levels    = levels;
  op->factored  = PETSC_FALSE;
  op->assembled = PETSC_FALSE;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    op->marks[i]                  = marks[i];
    contact->ranks.mine_active[i] = (int)marks[i];
  }
  PetscCallMPI(MPI_Allgatherv(contact->ranks.mine_active, (PetscMPIInt)contact->rows.n, MPI_INT, contact->ranks.all_active,
                              contact->ranks.counts, contact->ranks.offsets, MPI_INT, PetscObjectComm((PetscObject)contact)));
  op->n = 0;
  for (PetscInt i = 0; i < contact->rows.n_all; i++) op->n += contact->ranks.all_active[i] == INTERFACE_SOLVED;
  PetscCall(InterfaceOperatorMakeRoom(op, op->n));
  for (PetscInt i = 0, k = 0; i < contact->rows.n_all; i++)
    if (contact->ranks.all_active[i] == INTERFACE_SOLVED) op->rows[k++] = i;
  PetscCall(InterfaceOperatorFindGroups(op));
  PetscCall(ChooseDense(op));
  if (!op->dense || op->matrix) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies && contact->ranks.size > 1; b++) {
    PetscInt n;

    PetscCall(InterfaceOperatorListBodyRows(op, b, &n));
    if (n) PetscCall(BodyPrepareCompliance(contact->bodies[b], n, op->body_rows));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt n;

    PetscCall(InterfaceOperatorListBodyRows(op, b, &n));
    contact->work.words[b].n = 0;
    if (n) PetscCall(BodyProposeCompliance(contact->bodies[b], n, op->body_rows, &contact->work.words[b]));
  }
  PetscCall(ContactTellWords(contact, contact->work.words));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyTakeCompliance(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
