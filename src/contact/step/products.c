/*
   S as products, where it would have many entries: linear bodies that answer by their massless layers alone take one solution with the
   factors of these for each product, and columns of S are not found one by one. Newton's method for the law of rows goes with products, and
   is preconditioned by a sparse matrix near S. How a layer answers to a force falls to a tenth within one element and to 2 10^-4 within
   four, since the rest of the body holds it: so products with vectors whose entries are far apart have many columns of S at once, but for
   what is far from the rows. That is Curtis, Powell and Reid's way to a Jacobian, by the colours of a graph.

   Source: A. R. Curtis, M. J. D. Powell, J. K. Reid, On the estimation of sparse Jacobian matrices, Journal of the Institute of Mathematics
   and its Applications 13 (1974).
*/
#include "stepimpl.h"

#define FEW_PRODUCTS 500 /* rows up to which S is dense, whose factors take little then */
#define REACH        1   /* elements beyond those at the rows where a matrix near S has entries */

/* Whether S is products: of many rows, whose bodies tell them exactly and cheaply */
PetscErrorCode ContactStepperChooseProducts(Contact contact, ContactStepper *stepper)
{
  PetscBool products = (PetscBool)(stepper->problem.n > FEW_PRODUCTS && !stepper->forms);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && products; b++) {
    PetscBool exact;
    Mat       K;

    if (!stepper->assembly.of_body[b].n) continue;
    PetscCall(BodyGetLayerMatrices(contact->bodies[b], &K, NULL));
    PetscCall(BodyComplianceIsExact(contact->bodies[b], &exact));
    products = (PetscBool)(K && exact && stepper->rules[b]->shape == BODY_FORCE_LINEAR);
  }
  stepper->products = products;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds how the rows of a body go under forces on them, of this rank */
static PetscErrorCode AddBody(Contact contact, StepperEntries *entries, PetscInt b, const PetscReal force[], PetscReal way[])
{
  const ContactBodyRows *of = &contact->body_rows[b];
  const PetscScalar     *moved;
  PetscScalar           *on_body;

  PetscFunctionBegin;
  if (!entries->force) {
    PetscCall(MatCreateVecs(contact->interfaces[b], NULL, &entries->force));
    PetscCall(VecDuplicate(entries->force, &entries->way));
  }
  PetscCall(VecGetArrayWrite(entries->force, &on_body));
  for (PetscInt k = 0; k < of->n; k++) on_body[k] = ContactSign(&contact->pairs[contact->rows.pair[of->rows[k]]], b) * force[of->rows[k]];
  PetscCall(VecRestoreArrayWrite(entries->force, &on_body));
  PetscCall(BodyApplyCompliance(contact->bodies[b], entries->force, entries->way));
  PetscCall(VecGetArrayRead(entries->way, &moved));
  for (PetscInt k = 0; k < of->n; k++)
    way[of->rows[k]] += ContactSign(&contact->pairs[contact->rows.pair[of->rows[k]]], b) * PetscRealPart(moved[k]);
  PetscCall(VecRestoreArrayRead(entries->way, &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = S x, the same on every rank. Collective over those of the bodies. */
static PetscErrorCode Multiply(Mat S, Vec x, Vec y)
{
  Contact            contact;
  ContactStepper    *stepper;
  PetscReal         *force, *way;
  const PetscScalar *in;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(S, &contact));
  stepper = (ContactStepper *)contact->data;
  force   = stepper->before;
  way     = stepper->mine;
  PetscCall(PetscArrayzero(force, contact->rows.n));
  PetscCall(PetscArrayzero(way, contact->rows.n));
  PetscCall(VecGetArrayRead(x, &in));
  for (PetscInt k = 0; k < stepper->problem.n; k++) {
    const PetscInt i = stepper->rows[k] - contact->rows.begin;

    if (i >= 0 && i < contact->rows.n) force[i] = PetscRealPart(in[k]);
  }
  PetscCall(VecRestoreArrayRead(x, &in));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (stepper->assembly.of_body[b].n) PetscCall(AddBody(contact, &stepper->assembly.of_body[b], b, force, way));
  PetscCall(VecGetArrayWrite(y, &out));
  PetscCall(ContactStepperGather(contact, stepper, way, out));
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The last product is of the changes of forces that come next: bodies need not find again how they answer */
PetscErrorCode ContactStepperTellProducts(Contact contact, const ContactStepper *stepper)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && stepper->products; b++)
    if (stepper->assembly.of_body[b].n && !stepper->done[stepper->group[b]])
      PetscCall(BodyExpectApplied(contact->bodies[b], stepper->assembly.of_body[b].force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Entries at the rows of a body whose elements are near each other: where B K^REACH B^T has some */
static PetscErrorCode AddPattern(Contact contact, const StepperEntries *entries, PetscInt b, Mat near)
{
  Mat K, B, product, transpose, next, *rows;
  IS  touching;

  PetscFunctionBegin;
  PetscCall(BodyGetLayerMatrices(contact->bodies[b], &K, &B));
  PetscCall(MatTranspose(B, MAT_INITIAL_MATRIX, &transpose));
  PetscCall(PetscObjectReference((PetscObject)B));
  product = B;
  for (PetscInt k = 0; k <= REACH; k++) {
    PetscCall(MatMatMult(product, k < REACH ? K : transpose, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &next));
    PetscCall(MatDestroy(&product));
    product = next;
  }
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, entries->n, entries->rows, PETSC_USE_POINTER, &touching));
  PetscCall(MatCreateSubMatrices(product, 1, &touching, &touching, MAT_INITIAL_MATRIX, &rows));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscInt *columns;
    PetscInt        n;

    PetscCall(MatGetRow(rows[0], k, &n, &columns, NULL));
    for (PetscInt e = 0; e < n; e++) PetscCall(MatSetValue(near, entries->places[k], entries->places[columns[e]], 0, INSERT_VALUES));
    PetscCall(MatRestoreRow(rows[0], k, &n, &columns, NULL));
  }
  PetscCall(MatDestroySubMatrices(1, &rows));
  PetscCall(ISDestroy(&touching));
  PetscCall(MatDestroy(&product));
  PetscCall(MatDestroy(&transpose));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of a matrix near S in a symmetric pattern: columns that have no row in common are found by one product */
static PetscErrorCode FindValues(Mat S, Mat near)
{
  MatColoring     graph;
  ISColoring      coloring;
  IS             *colours;
  PetscInt        n_colours, n;
  const PetscInt *begin, *columns;
  PetscScalar    *values;
  PetscBool       done;
  Vec             x, y;

  PetscFunctionBegin;
  PetscCall(MatColoringCreate(near, &graph));
  PetscCall(MatColoringSetType(graph, MATCOLORINGSL));
  PetscCall(MatColoringApply(graph, &coloring));
  PetscCall(MatColoringDestroy(&graph));
  PetscCall(ISColoringGetIS(coloring, PETSC_USE_POINTER, &n_colours, &colours));
  PetscCall(MatCreateVecs(near, &x, &y));
  PetscCall(MatGetRowIJ(near, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  PetscCall(MatSeqAIJGetArray(near, &values));
  for (PetscInt c = 0; c < n_colours; c++) {
    const PetscInt    *list;
    const PetscScalar *answer;
    PetscInt           size;

    PetscCall(ISGetLocalSize(colours[c], &size));
    PetscCall(ISGetIndices(colours[c], &list));
    PetscCall(VecZeroEntries(x));
    for (PetscInt k = 0; k < size; k++) PetscCall(VecSetValue(x, list[k], 1, INSERT_VALUES));
    PetscCall(MatMult(S, x, y));
    PetscCall(VecGetArrayRead(y, &answer));
    for (PetscInt k = 0; k < size; k++)
      for (PetscInt e = begin[list[k]]; e < begin[list[k] + 1]; e++) values[e] = answer[columns[e]];
    PetscCall(VecRestoreArrayRead(y, &answer));
    PetscCall(ISRestoreIndices(colours[c], &list));
  }
  PetscCall(PetscInfo(S, "a matrix near S by %" PetscInt_FMT " products for %" PetscInt_FMT " rows\n", n_colours, n));
  PetscCall(MatSeqAIJRestoreArray(near, &values));
  PetscCall(MatRestoreRowIJ(near, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(ISColoringRestoreIS(coloring, PETSC_USE_POINTER, &colours));
  PetscCall(ISColoringDestroy(&coloring));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S as products, and a sparse matrix near it. No body needs secants, as one does whose nodes answer alone. */
PetscErrorCode ContactStepperCreateProducts(Contact contact, ContactStepper *stepper, Mat *S, Mat *near)
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, contact, S));
  PetscCall(MatShellSetOperation(*S, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatCreate(PETSC_COMM_SELF, near));
  PetscCall(MatSetSizes(*near, n, n, n, n));
  PetscCall(MatSetType(*near, MATSEQAIJ));
  PetscCall(MatSetUp(*near));
  for (PetscInt k = 0; k < n; k++) PetscCall(MatSetValue(*near, k, k, 0, INSERT_VALUES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    stepper->assembly.of_body[b].alone = PETSC_TRUE;
    if (stepper->assembly.of_body[b].n) PetscCall(AddPattern(contact, &stepper->assembly.of_body[b], b, *near));
  }
  PetscCall(MatAssemblyBegin(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(FindValues(*S, *near));
  PetscFunctionReturn(PETSC_SUCCESS);
}
