/* The outer iteration on implicit Lagrange multipliers: a SNES for variational inequalities, with complementarity measured in metres. */
#include "lagrangeimpl.h"
#include <sys/petsccompat.h>
#include <sys/units.h>

/* Relative to the largest compliance: pivots below are round-off */
#define ZERO_PIVOT (100 * PETSC_MACHINE_EPSILON)

/* How far complementarity is missed, in metres */
static PetscErrorCode MeasureMismatch(Contact contact, const PetscScalar x[], const PetscScalar f[])
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscReal         sums[2]  = {0, 0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const ContactPair *pair = &contact->pairs[contact->rows.pair[i]];
    const PetscInt     row  = contact->rows.begin + i;
    PetscReal          mismatch;
    PetscScalar       *start;

    mismatch = x[i] > 0 ? PetscAbsReal(f[i]) : PetscMax(-f[i], -x[i] * lagrange->compliance[row * (contact->rows.n_all + 1)]);
    PetscCall(TraceGetLevel(contact->traces[pair->body[0]].displacement, 0, &start));
    sums[0] += PetscSqr(PetscMax(mismatch, 0));
    sums[1] += PetscSqr(start[i - pair->shift[0]]);
    if (PetscIsInfOrNanReal(f[i])) sums[0] = f[i];
  }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  lagrange->mismatch  = PetscSqrtReal(sums[0]);
  lagrange->magnitude = PetscSqrtReal(sums[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeResidual(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact  = (Contact)ctx;
  ImplicitLagrange  *lagrange = (ImplicitLagrange *)contact->data;
  const PetscScalar *x;
  PetscScalar       *f;

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(ForcesIntegrate(contact, &lagrange->forces, x, lagrange->scale));
  if (ContactFailed(contact)) {
    PetscCall(VecRestoreArrayRead(X, &x));
    PetscCall(ContactRejectResidual(F));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(F, &f));
  for (PetscInt i = 0; i < contact->rows.n; i++)
    f[i] = contact->end.gap[i] -
           (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE && lagrange->forces.touching[i] ? contact->start.gap[i] : 0);
  PetscCall(MeasureMismatch(contact, x, f));
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  Contact           contact  = (Contact)ctx;
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)P;
  if (lagrange->have_jacobian && !lagrange->scaled_in_place) PetscFunctionReturn(PETSC_SUCCESS);
  lagrange->have_jacobian = PETSC_TRUE;
  for (PetscInt i = contact->rows.begin; i < contact->rows.begin + contact->rows.n; i++)
    for (PetscInt j = 0; j < contact->rows.n_all; j++)
      PetscCall(MatSetValue(J, i, j, lagrange->compliance[j * contact->rows.n_all + i], INSERT_VALUES));
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  const ImplicitLagrange *lagrange = (const ImplicitLagrange *)((Contact)ctx)->data;

  PetscFunctionBegin;
  (void)snes;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm) || PetscIsInfOrNanReal(lagrange->mismatch)) *reason = SNES_DIVERGED_NAN;
  else if (lagrange->mismatch <= lagrange->atol || lagrange->mismatch <= lagrange->rtol * lagrange->magnitude)
    *reason = SNES_CONVERGED_FNORM_ABS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc takes a pivot below 2e-14 for zero, whatever its unit. Here that is a part of the largest compliance. */
static PetscErrorCode SetZeroPivot(Contact contact, SNES snes)
{
  const ImplicitLagrange *lagrange = (const ImplicitLagrange *)contact->data;
  PetscReal               largest  = 0;
  KSP                     ksp;
  PC                      pc;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n_all; i++)
    largest = PetscMax(largest, PetscAbsScalar(lagrange->compliance[i * (contact->rows.n_all + 1)]));
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  if (contact->ranks.size > 1) { /* a copy of the matrix on each rank, see OuterSolverCreate() */
    PetscCall(PCRedundantGetKSP(pc, &ksp));
    PetscCall(KSPGetPC(ksp, &pc));
  }
  PetscCall(PCFactorSetZeroPivot(pc, ZERO_PIVOT * largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Type, bounds, tolerances. A force counts as zero only where it is zero: it has been put there by the projection onto the bound. */
PetscErrorCode LagrangeSetUpOuter(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  SNES              snes;
  SNESLineSearch    line_search;
  Vec               lower, upper;
  PetscBool         reduced, semismooth, tolerance_set;
  char              type[64] = SNESVINEWTONRSLS;

  PetscFunctionBegin;
  PetscCall(OuterSolverCreate(contact, "lagrange_", contact->rows.n, ComputeResidual, ComputeJacobian, &lagrange->outer));
  snes = lagrange->outer.snes;
  PetscCall(SetZeroPivot(contact, snes));
  PetscCall(PetscOptionsGetString(NULL, "lagrange_", "-snes_type", type, sizeof(type), NULL));
  PetscCall(PetscStrcmp(type, SNESVINEWTONRSLS, &reduced));
  PetscCall(PetscStrcmp(type, SNESVINEWTONSSLS, &semismooth));
  PetscCheck(reduced || semismooth, PetscObjectComm((PetscObject)contact), PETSC_ERR_ARG_UNKNOWN_TYPE,
             "Unknown -lagrange_snes_type '%s'; known: vinewtonrsls, vinewtonssls", type);
  lagrange->scaled_in_place = semismooth;
  PetscCall(SNESSetType(snes, type));
  if (reduced) {
    PetscCall(SNESGetLineSearch(snes, &line_search));
    PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  }
  PetscCall(SNESSetTolerances(snes, CONTACT_POSITION_TOLERANCE * contact->scale.length, OUTER_POSITION_RTOL, 0, OUTER_MAX_ITERATIONS,
                              OUTER_MAX_EVALUATIONS));
  PetscCall(PetscOptionsHasName(NULL, "lagrange_", "-snes_vi_zero_tolerance", &tolerance_set));
  if (!tolerance_set) PetscCall(PetscOptionsSetValue(NULL, "-lagrange_snes_vi_zero_tolerance", "0"));
  PetscCall(SNESSetFromOptions(snes));
  if (!tolerance_set) PetscCall(PetscOptionsClearValue(NULL, "-lagrange_snes_vi_zero_tolerance"));
  PetscCall(SNESGetTolerances(snes, &lagrange->atol, &lagrange->rtol, NULL, NULL, NULL));
  PetscCall(SNESSetConvergenceTest(snes, TestConvergence, contact, NULL));
  PetscCall(VecDuplicate(lagrange->outer.x, &lower));
  PetscCall(VecDuplicate(lagrange->outer.x, &upper));
  PetscCall(VecSet(lower, 0));
  PetscCall(VecSet(upper, PETSC_INFINITY));
  PetscCall(SNESVISetVariableBounds(snes, lower, upper));
  PetscCall(VecDestroy(&lower));
  PetscCall(VecDestroy(&upper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes an iteration that did not converge as the failure of the step */
PetscErrorCode LagrangeCheckConverged(Contact contact)
{
  ImplicitLagrange   *lagrange = (ImplicitLagrange *)contact->data;
  SNESConvergedReason reason;
  PetscReal           time;

  PetscFunctionBegin;
  PetscCall(SNESGetConvergedReason(lagrange->outer.snes, &reason));
  if (reason > 0 || ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ForcesGetTime(contact, &time));
  if (reason == SNES_DIVERGED_NAN)
    PetscCall(StepFailureSet(
        &contact->attempt.failure, STEP_DIVERGED_NAN, PETSC_ERR_FP,
        "A contact gap or force is not a number in the step that ends at time %.9g s; is a velocity or a time step too large?",
        (double)time));
  PetscCall(StepFailureSet(
      &contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
      "The iteration on the Lagrange multipliers did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
      " evaluations the contact constraint is missed by %g%s (%s). Raise -lagrange_snes_max_it, loosen -lagrange_snes_atol, or choose "
      "a smaller -time_step",
      (double)time, contact->counts.sweeps, (double)lagrange->mismatch, UnitsOf((PetscObject)contact, UNIT_LENGTH),
      SNESConvergedReasons[reason]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
