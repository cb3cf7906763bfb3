/* Forces or impulses on ties that give both sides one acceleration or one velocity. */
#include "inversemass.h"
#include <impakt/private/bodymass.h>

/* Of the rates, relative: near round-off, since what is left drifts */
#define TOLERANCE 1e-15
/* Dependent rows, as where four blocks meet at a node, leave round-off: what may be left then, and iterations at most */
#define WORST          1e-10
#define MAX_ITERATIONS 2000

/* y = C x by the bodies, one solution with the mass of each; x is zero on rows that take no part, as what is solved for is */
static PetscErrorCode MultiplyByBodies(Mat shell, Vec x, Vec y)
{
  InverseMass       *inverse;
  Contact            contact;
  const PetscScalar *force;
  PetscScalar       *sum;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &inverse));
  contact = inverse->contact;
  PetscCall(VecGetArrayRead(x, &force));
  PetscCall(VecGetArray(y, &sum));
  PetscCall(PetscArrayzero(sum, contact->rows.n));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    ContactTakeRows(contact, b, force, inverse->work[0]);
    PetscCall(BodyMultiplyInverseMass(contact->bodies[b], inverse->work[0], inverse->work[1]));
    ContactAddRows(contact, b, inverse->work[1], sum);
  }
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (!inverse->takes_part[i]) sum[i] = force[i];
  PetscCall(VecRestoreArray(y, &sum));
  PetscCall(VecRestoreArrayRead(x, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* InverseMassAssemble - B M^{-1} B^T of all bodies, of all rows */
PetscErrorCode InverseMassAssemble(Contact contact, PetscBool lumped, Mat *C)
{
  PetscFunctionBegin;
  PetscCall(ContactCreateRowMatrix(contact, C));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Mat part;

    PetscCall(BodyComputeInverseMass(contact->bodies[b], lumped, &part));
    PetscCall(ContactAddBodyMatrix(contact, b, part, *C));
    PetscCall(MatDestroy(&part));
  }
  PetscCall(MatAssemblyBegin(*C, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*C, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ones on the diagonal of the rows that take no part, in place of all that they have */
static PetscErrorCode LeaveOutOthers(Contact contact, const InverseMass *inverse, Mat C)
{
  PetscInt *others, n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(contact->rows.n, &others));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (!inverse->takes_part[i]) others[n++] = contact->rows.begin + i;
  PetscCall(MatSetOption(C, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(MatZeroRowsColumns(C, n, others, 1, NULL, NULL));
  PetscCall(PetscFree(others));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For the ties as they are now. Tied rows of pairs that keep their mass take part, but those whose nodes are massless on both sides, since
   they have other rows too. */
PetscErrorCode InverseMassCreate(Contact contact, InverseMassType type, InverseMass *inverse)
{
  const PetscInt     n = contact->rows.n;
  const PetscScalar *diagonal;
  Mat                C, lumped;
  PC                 pc;

  PetscFunctionBegin;
  inverse->contact = contact;
  inverse->lumped  = (PetscBool)(type == INVERSE_MASS_LUMPED);
  PetscCall(PetscMalloc3(n, &inverse->takes_part, n, &inverse->work[0], n, &inverse->work[1]));
  PetscCall(InverseMassAssemble(contact, PETSC_TRUE, &lumped));
  PetscCall(MatCreateVecs(lumped, &inverse->solution, &inverse->rhs));
  PetscCall(MatGetDiagonal(lumped, inverse->rhs));
  PetscCall(VecGetArrayRead(inverse->rhs, &diagonal));
  for (PetscInt i = 0; i < n; i++)
    inverse->takes_part[i] = (PetscBool)(contact->rows.tied[i] && contact->pairs[contact->rows.pair[i]].keeps_mass &&
                                         PetscRealPart(diagonal[i]) > 0);
  PetscCall(VecRestoreArrayRead(inverse->rhs, &diagonal));
  PetscCall(LeaveOutOthers(contact, inverse, lumped));
  if (type == INVERSE_MASS_ONCE) {
    PetscCall(MatCreateShell(PetscObjectComm((PetscObject)contact), n, n, contact->rows.n_all, contact->rows.n_all, inverse, &C));
    PetscCall(MatShellSetOperation(C, MATOP_MULT, (void (*)(void))MultiplyByBodies));
    PetscCall(MatSetOption(C, MAT_SYMMETRIC, PETSC_TRUE));
  } else if (type == INVERSE_MASS_ASSEMBLED) {
    PetscCall(InverseMassAssemble(contact, PETSC_FALSE, &C));
    PetscCall(LeaveOutOthers(contact, inverse, C));
  } else {
    C = lumped;
    PetscCall(PetscObjectReference((PetscObject)C));
  }
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)contact), &inverse->ksp));
  PetscCall(KSPSetOperators(inverse->ksp, C, lumped));
  PetscCall(KSPSetType(inverse->ksp, KSPCG));
  PetscCall(KSPSetNormType(inverse->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(inverse->ksp, TOLERANCE, 0, PETSC_CURRENT, MAX_ITERATIONS));
  PetscCall(KSPGetPC(inverse->ksp, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetUp(inverse->ksp));
  PetscCall(MatDestroy(&C));
  PetscCall(MatDestroy(&lumped));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces after which rates of the gaps are zero that are `rates` without them: C force = -rates; zero on rows that take no part */
PetscErrorCode InverseMassSolve(Contact contact, InverseMass *inverse, const PetscScalar rates[], PetscScalar force[])
{
  KSPConvergedReason reason;
  const PetscScalar *solution;
  PetscScalar       *rhs;
  PetscReal          left, size;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(inverse->rhs, &rhs));
  for (PetscInt i = 0; i < contact->rows.n; i++) rhs[i] = inverse->takes_part[i] ? -rates[i] : 0;
  PetscCall(VecRestoreArrayWrite(inverse->rhs, &rhs));
  PetscCall(KSPSolve(inverse->ksp, inverse->rhs, inverse->solution));
  PetscCall(KSPGetConvergedReason(inverse->ksp, &reason));
  PetscCall(KSPGetResidualNorm(inverse->ksp, &left));
  PetscCall(VecNorm(inverse->rhs, NORM_2, &size));
  PetscCheck(reason >= 0 || left <= WORST * size, PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED,
             "The forces of the ties were not found: %s, with %g of the rates left; are nodes tied to each other in a circle? Set "
             "-<body>_mass_redistribute true, so that tied nodes have no mass",
             KSPConvergedReasons[reason], (double)(left / size));
  PetscCall(VecGetArrayRead(inverse->solution, &solution));
  for (PetscInt i = 0; i < contact->rows.n; i++) force[i] = inverse->takes_part[i] ? solution[i] : 0;
  PetscCall(VecRestoreArrayRead(inverse->solution, &solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives both sides of ties one velocity and one acceleration at the start or the end of a controller step. `change`: per row, the impulses
   [N s], then forces [N] that this takes; zero on rows that take no part */
PetscErrorCode InverseMassAlign(Contact contact, InverseMass *inverse, BodyStepSide when, PetscScalar *const change[2])
{
  PetscFunctionBegin;
  for (PetscInt order = 1; order <= 2; order++) {
    const PetscReal    parts[] = {0, order == 1, order == 2};
    PetscScalar *const rates   = change[order - 1];

    PetscCall(ContactComputeRates(contact, order, (PetscBool)(when == BODY_AT_END), rates));
    PetscCall(InverseMassSolve(contact, inverse, rates, rates));
    for (PetscInt b = 0; b < contact->n_bodies; b++) {
      ContactTakeRows(contact, b, rates, inverse->work[0]);
      PetscCall(BodyAddImpulses(contact->bodies[b], when, inverse->lumped, parts, inverse->work[0]));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InverseMassDestroy(InverseMass *inverse)
{
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&inverse->ksp));
  PetscCall(VecDestroy(&inverse->rhs));
  PetscCall(VecDestroy(&inverse->solution));
  PetscCall(PetscFree3(inverse->takes_part, inverse->work[0], inverse->work[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
