/* S as products, where it would have many entries: linear bodies that answer by their massless layers alone take one solution with the
   factors of these for each product, and columns of S are not found one by one. Newton's method for the law of rows goes with products, and
   is preconditioned by a sparse matrix near S. How a layer answers to a force falls to a tenth within one element, since the rest of the
   body holds it. So a polynomial of degree one in the stiffness K of the layer is near its inverse, and takes no solutions: with D the
   diagonal of K, it is the one whose product with D^{-1} K is nearest to one on an interval of eigenvalues, which is Chebyshev's.

   Sources: O. G. Johnson, C. A. Micchelli, G. Paul, Polynomial preconditioners for conjugate gradient calculations, SIAM Journal on
   Numerical Analysis 20 (1983) 362-376. */
#include "stepimpl.h"
#include <impakt/private/bodyforces.h>

#define FEW_PRODUCTS 500 /* rows up to which S is dense, whose factors take little then */
#define SPREAD       6   /* eigenvalues of D^{-1} K that count: from the largest down to that part of it; 4 and 10 take 5 % more products */
#define SMALL        0.03 /* entries of a matrix near S left out, in parts of the diagonal; 0.002 saves 2 % of the products */

/* Whether S is products: of many rows, whose bodies tell them exactly and cheaply */
PetscErrorCode ContactStepperChooseProducts(Contact contact, ContactStepper *stepper)
{
  PetscBool products = (PetscBool)(stepper->problem.n > FEW_PRODUCTS && !stepper->forms);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < contact->n_bodies && products; b++) {
    BodyStepProperties properties;
    Mat                K;

    if (!stepper->assembly.of_body[b].n) continue;
    PetscCall(BodyGetLayerMatrices(contact->bodies[b], &K, NULL));
    PetscCall(BodyGetStepProperties(contact->bodies[b], &properties));
    products = (PetscBool)(K && properties.affine && stepper->rules[b]->shape == BODY_FORCE_LINEAR);
  }
  stepper->products = products;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds how the rows of a body go under forces on them, of this rank */
static PetscErrorCode AddBody(const ContactStepper *stepper, PetscInt b, const PetscReal force[], PetscReal way[])
{
  Contact            contact = stepper->contact;
  StepperEntries    *entries = &stepper->assembly.of_body[b];
  const PetscScalar *moved;
  PetscScalar       *on_body;

  PetscFunctionBegin;
  if (!entries->force) {
    PetscCall(MatCreateVecs(contact->interfaces[b], NULL, &entries->force));
    PetscCall(VecDuplicate(entries->force, &entries->way));
  }
  PetscCall(VecGetArrayWrite(entries->force, &on_body));
  ContactTakeRows(contact, b, force, on_body);
  PetscCall(VecRestoreArrayWrite(entries->force, &on_body));
  PetscCall((*stepper->answer)(contact->bodies[b], entries->force, entries->way));
  PetscCall(VecGetArrayRead(entries->way, &moved));
  ContactAddRows(contact, b, moved, way);
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
  PetscCall(MatShellGetContext(S, &stepper));
  contact = stepper->contact;
  force   = stepper->before;
  way     = stepper->mine;
  PetscCall(PetscArrayzero(force, contact->rows.n));
  PetscCall(PetscArrayzero(way, contact->rows.n));
  PetscCall(VecGetArrayRead(x, &in));
  ContactPickRows(contact, stepper->problem.n, stepper->rows, in, force);
  PetscCall(VecRestoreArrayRead(x, &in));
  for (PetscInt b = 0; b < contact->n_bodies; b++)
    if (stepper->assembly.of_body[b].n) PetscCall(AddBody(stepper, b, force, way));
  PetscCall(VecGetArrayWrite(y, &out));
  PetscCall(ContactStepperGather(contact, stepper, way, out));
  PetscCall(VecGetArrayRead(x, &in));
  for (PetscInt k = 0; k < stepper->problem.n && stepper->penalty.any; k++) out[k] += stepper->springs.softness[k] * in[k];
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B M B^T, M = s D^{-1} (2 c D - K) D^{-1} near K^{-1}: 1 - M K is the Chebyshev polynomial of degree two in D^{-1} K on the interval of
   eigenvalues, with the middle c and half of the width w, where it is one at zero: s = 2 / (2 c^2 - w^2). The largest eigenvalue is at most
   the largest sum of a row of |D^{-1} K|. */
static PetscErrorCode MultiplyNear(Body body, Mat *product)
{
  const PetscReal spread = 1 / (PetscReal)SPREAD;
  PetscReal       largest, middle, width, scale;
  Mat             K, B, near, transpose;
  Vec             diagonal, inverse, sums;

  PetscFunctionBegin;
  PetscCall(BodyGetLayerMatrices(body, &K, &B));
  PetscCall(MatCreateVecs(K, &diagonal, &inverse));
  PetscCall(MatGetDiagonal(K, diagonal));
  PetscCall(VecCopy(diagonal, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(VecDuplicate(inverse, &sums));
  PetscCall(MatGetRowSumAbs(K, sums));
  PetscCall(VecPointwiseMult(sums, sums, inverse));
  PetscCall(VecMax(sums, NULL, &largest));
  middle = largest * (1 + spread) / 2;
  width  = largest * (1 - spread) / 2;
  scale  = 2 / (2 * middle * middle - width * width);
  PetscCall(MatDuplicate(K, MAT_COPY_VALUES, &near));
  PetscCall(MatScale(near, -scale));
  PetscCall(VecScale(diagonal, 2 * middle * scale));
  PetscCall(MatDiagonalSet(near, diagonal, ADD_VALUES));
  PetscCall(MatTranspose(B, MAT_INITIAL_MATRIX, &transpose));
  PetscCall(MatDiagonalScale(transpose, inverse, NULL));
  PetscCall(MatPtAP(near, transpose, MAT_INITIAL_MATRIX, PETSC_DETERMINE, product));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(VecDestroy(&inverse));
  PetscCall(VecDestroy(&sums));
  PetscCall(MatDestroy(&near));
  PetscCall(MatDestroy(&transpose));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of a body in a matrix near S, but for small entries */
static PetscErrorCode AddNear(Contact contact, ContactStepper *stepper, PetscInt b, Mat near)
{
  const StepperEntries *entries = &stepper->assembly.of_body[b];
  PetscInt             *places;
  const PetscScalar    *diagonal;
  Mat                   product, *rows;
  Vec                   d;
  IS                    touching;

  PetscFunctionBegin;
  PetscCall(MultiplyNear(contact->bodies[b], &product));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, entries->n, entries->rows, PETSC_USE_POINTER, &touching));
  PetscCall(MatCreateSubMatrices(product, 1, &touching, &touching, MAT_INITIAL_MATRIX, &rows));
  PetscCall(MatCreateVecs(rows[0], &d, NULL));
  PetscCall(MatGetDiagonal(rows[0], d));
  PetscCall(VecGetArrayRead(d, &diagonal));
  PetscCall(PetscMalloc1(entries->n, &places));
  for (PetscInt k = 0; k < entries->n; k++) {
    const PetscInt     place = entries->places[k], *columns;
    const PetscScalar *values;
    PetscInt           n;

    PetscCall(MatGetRow(rows[0], k, &n, &columns, &values));
    for (PetscInt e = 0; e < n; e++) {
      const PetscReal least = SMALL * PetscSqrtReal(PetscRealPart(diagonal[k] * diagonal[columns[e]]));

      places[e] = PetscAbsScalar(values[e]) > least ? entries->places[columns[e]] : -1; /* PETSc leaves those out */
    }
    PetscCall(MatSetValues(near, 1, &place, n, places, values, ADD_VALUES));
    PetscCall(MatRestoreRow(rows[0], k, &n, &columns, &values));
  }
  PetscCall(PetscFree(places));
  PetscCall(VecRestoreArrayRead(d, &diagonal));
  PetscCall(VecDestroy(&d));
  PetscCall(MatDestroySubMatrices(1, &rows));
  PetscCall(ISDestroy(&touching));
  PetscCall(MatDestroy(&product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ContactStepperCreateShell - S as products alone */
PetscErrorCode ContactStepperCreateShell(ContactStepper *stepper, Mat *S)
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, stepper, S));
  PetscCall(MatShellSetOperation(*S, MATOP_MULT, (void (*)(void))Multiply));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S as products, and a sparse matrix near it. No body needs secants, as one does whose nodes answer alone. */
PetscErrorCode ContactStepperCreateProducts(Contact contact, ContactStepper *stepper, Mat *S, Mat *near)
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  PetscCall(ContactStepperCreateShell(stepper, S));
  PetscCall(MatCreate(PETSC_COMM_SELF, near));
  PetscCall(MatSetSizes(*near, n, n, n, n));
  PetscCall(MatSetType(*near, MATSEQAIJ));
  PetscCall(MatSetUp(*near));
  for (PetscInt k = 0; k < n; k++) PetscCall(MatSetValue(*near, k, k, 0, ADD_VALUES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    stepper->assembly.of_body[b].alone = PETSC_TRUE;
    if (stepper->assembly.of_body[b].n) PetscCall(AddNear(contact, stepper, b, *near));
  }
  PetscCall(MatAssemblyBegin(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(ContactStepperAddSprings(stepper, *near));
  PetscCall(LawProblemMatchTrace(*S, *near));
  PetscFunctionReturn(PETSC_SUCCESS);
}
