/* The rows of S, and whether its matrices are dense on them. */
#include "interfaceimpl.h"

/* Groups from which on small dense blocks are preferred to sparse factors of all, which rows that come and go would have made again */
#define MANY_GROUPS 8

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

/* Adds those of the listed rows from `begin` to `end` - 1 that concern a body to the `n` that body_rows has: their numbers among the rows
   of the body, and into body_places their places in the list. Each part of the list ascends. */
PetscErrorCode InterfaceOperatorListBodyRows(InterfaceOperator op, PetscInt b, PetscInt begin, PetscInt end, PetscInt *n)
{
  const ContactBodyRows *of = &op->contact->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt k = op->body_begin[b]; k < op->body_begin[b + 1]; k++) {
    const PetscInt place = op->of_body[k];

    if (place < begin || place >= end) continue;
    PetscCall(PetscFindInt(op->rows[place], of->n_all, of->all, &op->body_rows[*n]));
    op->body_places[(*n)++] = place;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of those that are solved for, then of those that are known */
static PetscErrorCode ListKnownRows(InterfaceOperator op, PetscInt b, PetscInt *n)
{
  PetscFunctionBegin;
  *n = 0;
  PetscCall(InterfaceOperatorListBodyRows(op, b, 0, op->n, n));
  PetscCall(InterfaceOperatorListBodyRows(op, b, op->n, op->n_known, n));
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
    PetscCall(ListKnownRows(op, b, &n));
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
  const PetscInt size     = op->n_known * op->levels;
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
  if (InterfaceIsDirect(op) && op->n_groups < MANY_GROUPS && !op->is_sparse) {
    op->dense = PETSC_FALSE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt b = 0; b < op->contact->n_bodies; b++) {
    PetscInt n;

    PetscCall(BodyGetSubsteps(op->contact->bodies[b], &n));
    if (n > 1) substeps = PETSC_TRUE;
  }
  if (substeps) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CountFlops(op, &op->product_flops, &op->dense_flops));
  op->dense = (PetscBool)(op->dense_flops <= op->settings.at_once * op->product_flops || op->spent >= op->dense_flops);
  if (InterfaceIsDirect(op) && !op->dense) op->dense_flops = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the rows of the problem: `marks` of this rank's rows. Where matrices are dense, the bodies get to know the rows that are solved for
   or known, those too that answer to their forces in later substeps alone; else nothing but the marks is kept. Collective. */
PetscErrorCode InterfaceOperatorSetRows(InterfaceOperator op, const InterfaceMark marks[], PetscInt levels)
{
  Contact  contact  = op->contact;
  PetscInt count[3] = {0, 0, 0}, next[3];

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
  for (PetscInt i = 0; i < contact->rows.n_all; i++) count[contact->ranks.all_active[i]]++;
  op->n       = count[INTERFACE_SOLVED];
  op->n_known = op->n + count[INTERFACE_KNOWN];
  PetscCall(InterfaceOperatorMakeRoom(op, op->n_known));
  next[INTERFACE_SOLVED] = 0;
  next[INTERFACE_KNOWN]  = op->n;
  for (PetscInt i = 0; i < contact->rows.n_all; i++)
    if (contact->ranks.all_active[i]) op->rows[next[contact->ranks.all_active[i]]++] = i;
  PetscCall(InterfaceOperatorFindGroups(op));
  PetscCall(ChooseDense(op));
  if (!op->dense || op->matrix) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < contact->n_bodies && contact->ranks.size > 1; b++) {
    PetscInt n;

    PetscCall(ListKnownRows(op, b, &n));
    if (n) PetscCall(BodyPrepareCompliance(contact->bodies[b], n, op->body_rows));
  }
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt n;

    PetscCall(ListKnownRows(op, b, &n));
    contact->work.words[b].n = 0;
    if (n) PetscCall(BodyProposeCompliance(contact->bodies[b], n, op->body_rows, &contact->work.words[b]));
  }
  PetscCall(ContactTellWords(contact, contact->work.words));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyTakeCompliance(contact->bodies[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether iterations have cost as much by now as dense matrices of these rows would: then it is time to set the rows again */
PetscBool InterfaceOperatorWantsDense(InterfaceOperator op)
{
  return (PetscBool)(!op->dense && op->dense_flops > 0 && op->spent >= op->dense_flops);
}
