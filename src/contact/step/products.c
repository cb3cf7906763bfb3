/* S as products, where it would have many entries: linear bodies that answer by their massless layers alone take one solution with the
   factors of these for each product, and columns of S are not found one by one. Newton's method for the law of rows goes with products, and
   is preconditioned by a sparse matrix near S: that of layers each of whose displacements moves alone, as nodes with mass do, since how a
   layer answers to a force falls to a tenth within one element. */
#include "stepimpl.h"
#include <impakt/private/bodyforces.h>

#define FEW_PRODUCTS 500 /* rows up to which S is dense, whose factors take little then */
#define SMALL 1e-6 /* entries of a matrix near S left out, in parts of the diagonal: of soft bodies' they may be all of a stiff one's */

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

/* ContactStepperCreateShell - S as products alone */
PetscErrorCode ContactStepperCreateShell(ContactStepper *stepper, Mat *S)
{
  const PetscInt n = stepper->problem.n;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, stepper, S));
  PetscCall(MatShellSetOperation(*S, MATOP_MULT, (void (*)(void))Multiply));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* S as products, and a sparse matrix near it */
PetscErrorCode ContactStepperCreateProducts(ContactStepper *stepper, Mat *S, Mat *near)
{
  Vec scale;

  PetscFunctionBegin;
  PetscCall(ContactStepperCreateShell(stepper, S));
  PetscCall(MatDuplicate(stepper->assembly.product, MAT_COPY_VALUES, near));
  PetscCall(MatCreateVecs(*near, &scale, NULL));
  PetscCall(MatGetDiagonal(*near, scale));
  PetscCall(VecSqrtAbs(scale));
  PetscCall(VecReciprocal(scale));
  PetscCall(MatDiagonalScale(*near, scale, scale));
  PetscCall(MatFilter(*near, SMALL, PETSC_TRUE, PETSC_TRUE));
  PetscCall(VecReciprocal(scale));
  PetscCall(MatDiagonalScale(*near, scale, scale));
  PetscCall(VecDestroy(&scale));
  PetscCall(MatSetOption(*near, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE)); /* rows that are held have no entries */
  for (PetscInt k = 0; k < stepper->problem.n; k++) PetscCall(MatSetValue(*near, k, k, 0, ADD_VALUES));
  PetscCall(MatAssemblyBegin(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*near, MAT_FINAL_ASSEMBLY));
  PetscCall(ContactStepperAddSprings(stepper, *near));
  PetscCall(LawProblemMatchTrace(*S, *near));
  PetscFunctionReturn(PETSC_SUCCESS);
}
