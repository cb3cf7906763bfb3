/*
   Penalty method. The contact force on row i at the end of a controller step is lambda_i = tau A_i <-gap_i>; during the step it
   goes linearly from its last value to this one. The outer SNES solves F(lambda) = lambda - tau A <-gap(lambda)> = 0 with both
   bodies under forces; its Jacobian is I + tau A W on penetrating rows, with the interface compliance W of all bodies.

   With explicit bodies and mass on the contact nodes the gap does not depend on the force at the end of the step: the second
   evaluation, which finds this out, only adds the change of force to the end state.
*/
#include "forces.h"
#include "../outersolver.h"
#include <sys/petsccompat.h>

typedef struct {
  OuterSolver  outer;
  PetscReal    penalty;    /* N/m for each unit of area [N/m in one dimension] */
  PetscReal    atol, rtol; /* on the force [N], and relative to it */
  Trace        force;      /* of all rows over the controller step */
  PetscBool   *penetrating;
  PetscBool   *jacobian_penetrating; /* the set that the Jacobian belongs to */
  PetscBool    have_jacobian;
  PetscScalar *compliance; /* all rows by all rows, by columns [m/N] */
  PetscReal    residual, magnitude;
} Penalty;

static PetscErrorCode ContactSetFromOptions_Penalty(Contact contact)
{
  Penalty  *penalty = (Penalty *)contact->data;
  PetscBool set;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_penalty", "Penalty parameter [N/m in 1-D, N/m^3 else]", "", penalty->penalty, &penalty->penalty, &set));
  PetscOptionsEnd();
  PetscCheck(set, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_type penalty needs -contact_penalty, in N/m in one dimension");
  PetscCheck(penalty->penalty > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_penalty %g must be positive", (double)penalty->penalty);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Advances all bodies under the forces x, and compares these with what the penetration asks for */
static PetscErrorCode ComputeResidual(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  Penalty           *penalty = (Penalty *)contact->data;
  const PetscScalar *x;
  PetscScalar       *f;
  PetscReal          sums[2] = {0, 0};

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(ForcesIntegrate(contact, penalty->force, x, 1));
  PetscCall(VecGetArrayWrite(F, &f));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    penalty->penetrating[i] = (PetscBool)(contact->gap[i] < 0);
    f[i]                    = x[i] - (penalty->penetrating[i] ? -penalty->penalty * contact->area[i] * contact->gap[i] : 0);
    sums[0] += PetscSqr(f[i]);
    sums[1] += PetscSqr(x[i]);
  }
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  if (contact->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  penalty->residual  = PetscSqrtReal(sums[0]);
  penalty->magnitude = PetscSqrtReal(sums[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  Contact  contact = (Contact)ctx;
  Penalty *penalty = (Penalty *)contact->data;
  int      differs = 0;

  PetscFunctionBegin;
  (void)snes;
  (void)X;
  (void)P;
  for (PetscInt i = 0; i < contact->n_rows; i++) differs |= penalty->jacobian_penetrating[i] != penalty->penetrating[i];
  PetscCall(ContactOr(contact, &differs));
  if (penalty->have_jacobian && !differs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(penalty->jacobian_penetrating, penalty->penetrating, contact->n_rows));
  penalty->have_jacobian = PETSC_TRUE;
  for (PetscInt local = 0; local < contact->n_rows; local++) {
    const PetscInt i = contact->row_begin + local;

    for (PetscInt j = 0; j < contact->n_all_rows; j++) {
      const PetscScalar value = (i == j ? 1 : 0) + (penalty->penetrating[local] ? penalty->penalty * contact->area[local] * penalty->compliance[j * contact->n_all_rows + i] : 0);

      PetscCall(MatSetValue(J, i, j, value, INSERT_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm, SNESConvergedReason *reason, void *ctx)
{
  const Penalty *penalty = (const Penalty *)((Contact)ctx)->data;

  PetscFunctionBegin;
  (void)snes;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (penalty->residual <= penalty->atol || penalty->residual <= penalty->rtol * penalty->magnitude) *reason = SNES_CONVERGED_FNORM_ABS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The spring alone, between the masses of explicit bodies, must be stable: tau A dt^2 B M^{-1} B^T < 4 */
static PetscErrorCode CheckStability(Contact contact)
{
  Penalty   *penalty = (Penalty *)contact->data;
  PetscReal *compliance, worst = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(contact->n_rows, &compliance));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscBool    is_explicit, massless;
    PetscScalar *forward;

    PetscCall(BodyIsExplicit(contact->bodies[b], &is_explicit));
    PetscCall(BodyIsRedistributed(contact->bodies[b], &massless));
    if (!is_explicit || massless) continue;
    PetscCall(BodyComputeForwardCompliance(contact->bodies[b], &forward));
    for (PetscInt i = 0; i < contact->n_rows; i++) compliance[i] += forward[(contact->row_begin + i) * (contact->n_all_rows + 1)];
    PetscCall(PetscFree(forward));
  }
  for (PetscInt i = 0; i < contact->n_rows; i++) worst = PetscMax(worst, compliance[i] * contact->area[i]);
  PetscCall(PetscFree(compliance));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  PetscCheck(penalty->penalty * worst < 4, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT, "-contact_penalty %g is too stiff for the explicit steps: above %.4g the contact springs are unstable; choose a smaller one, or smaller time steps", (double)penalty->penalty, (double)(4 / worst));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactSetUp_Penalty(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(CheckStability(contact));
  PetscCall(OuterSolverCreate(contact, "penalty_", contact->n_rows, ComputeResidual, ComputeJacobian, &penalty->outer));
  PetscCall(OuterSolverSetFromOptions(contact, &penalty->outer, 1e-14, 1e-9, 50));
  PetscCall(SNESGetTolerances(penalty->outer.snes, &penalty->atol, &penalty->rtol, NULL, NULL, NULL));
  PetscCall(SNESSetConvergenceTest(penalty->outer.snes, TestConvergence, contact, NULL));
  PetscCall(TraceCreate(contact->n_rows, 1, &penalty->force));
  PetscCall(PetscCalloc3(contact->n_rows, &penalty->penetrating, contact->n_rows, &penalty->jacobian_penetrating, contact->n_all_rows * contact->n_all_rows, &penalty->compliance));
  PetscCall(ForcesComputeCompliance(contact, penalty->compliance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckConverged(Contact contact)
{
  Penalty            *penalty = (Penalty *)contact->data;
  SNESConvergedReason reason;
  PetscReal           time;

  PetscFunctionBegin;
  PetscCall(SNESGetConvergedReason(penalty->outer.snes, &reason));
  if (reason > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ForcesGetTime(contact, &time));
  for (PetscInt p = 0; reason == SNES_DIVERGED_NAN && p < contact->n_pairs; p++) {
    ContactPairState state;

    PetscCall(ContactGetPairState(contact, p, &state));
    PetscCheck(!PetscIsInfOrNanReal(state.gap * penalty->penalty), PetscObjectComm((PetscObject)contact), PETSC_ERR_FP, "The contact force between the bodies '%s' is not a number in the step that ends at time %.9g s; is a velocity, a time step or -contact_penalty too large?", contact->pairs[p].name, (double)time);
  }
  SETERRQ(PetscObjectComm((PetscObject)contact), PETSC_ERR_NOT_CONVERGED, "The penalty iteration did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT " evaluations the contact force is off by %g N (%s). Raise -penalty_snes_max_it, loosen -penalty_snes_rtol, or choose a smaller -contact_penalty or -time_step", (double)time, contact->counts_made.sweeps, (double)penalty->residual, SNESConvergedReasons[reason]);
}

static PetscErrorCode ContactStep_Penalty(Contact contact)
{
  Penalty     *penalty = (Penalty *)contact->data;
  PetscBool    in_contact;
  PetscScalar *x;
  PetscReal    energy = 0;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(contact->active, contact->saved_active, contact->n_rows));
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  contact->penalty_energy = 0;
  if (!in_contact) {
    PetscCall(ContactIntegrateFree(contact, &in_contact));
    if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactSetConditions(contact, CONDITIONS_FORCES));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(BodyPrepareSweeps(contact->bodies[b]));
  PetscCall(VecGetArrayWrite(penalty->outer.x, &x));
  for (PetscInt i = 0; i < contact->n_rows; i++) x[i] = contact->saved_force[i];
  PetscCall(VecRestoreArrayWrite(penalty->outer.x, &x));
  PetscCall(SNESSolve(penalty->outer.snes, NULL, penalty->outer.x));
  PetscCall(CheckConverged(contact));
  PetscCall(VecGetArray(penalty->outer.x, &x));
  for (PetscInt i = 0; i < contact->n_rows; i++) {
    contact->force[i]  = x[i];
    contact->active[i] = (PetscBool)(x[i] > 0);
    energy += 0.5 * PetscSqr(x[i]) / (penalty->penalty * contact->area[i]);
  }
  PetscCall(VecRestoreArray(penalty->outer.x, &x));
  if (contact->size > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  contact->penalty_energy = energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_Penalty(Contact contact, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  penalty parameter %g\n", (double)((const Penalty *)contact->data)->penalty));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_Penalty(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(OuterSolverDestroy(&penalty->outer));
  PetscCall(TraceDestroy(&penalty->force));
  PetscCall(PetscFree3(penalty->penetrating, penalty->jacobian_penetrating, penalty->compliance));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_PENALTY - contact forces in proportion to the penetration

   Options Database Keys:
+  -contact_penalty tau                                          - penalty parameter [N/m in one dimension], required
.  -penalty_snes_type (newtonls|anderson|nrichardson|ngmres|qn)  - the outer iteration on the contact forces
-  -penalty_snes_rtol, -penalty_snes_atol, -penalty_snes_max_it  - its tolerances on the force (1e-9, 1e-14 N) and limit (50)

   Level: beginner

   Note:
   Implicit or explicit by the integrators of the bodies. The energy in the springs is reported beside that of the bodies.

.seealso: `ContactSetType()`, `CONTACT_SCHWARZ`, `CONTACT_LAGRANGE`
M*/
PetscErrorCode ContactCreate_Penalty(Contact contact)
{
  Penalty *penalty;

  PetscFunctionBegin;
  PetscCall(PetscNew(&penalty));
  contact->data                = penalty;
  contact->ops->setfromoptions = ContactSetFromOptions_Penalty;
  contact->ops->setup          = ContactSetUp_Penalty;
  contact->ops->step           = ContactStep_Penalty;
  contact->ops->view           = ContactView_Penalty;
  contact->ops->destroy        = ContactDestroy_Penalty;
  PetscFunctionReturn(PETSC_SUCCESS);
}
