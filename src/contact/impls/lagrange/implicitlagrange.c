/*
   Lagrange multipliers at the end of each controller step, for bodies whose gap answers to the force there. With gap(lambda) the
   gaps after integrating all bodies under forces that go linearly from their last values to lambda,

     gap(lambda) >= 0,   lambda >= 0,   lambda . gap(lambda) = 0,

   an outer SNES for variational inequalities on F(lambda) = gap(lambda) with 0 as lower bound; its Jacobian is the interface
   compliance of all bodies, which is constant.
*/
#include "lagrangeimpl.h"
#include <checkpoint/checkpoint.h>
#include <contact/compliance/forces.h>
#include <contact/compliance/interfaceoperator.h>
#include <contact/compliance/outersolver.h>
#include <sys/petsccompat.h>

/* Relative to the largest compliance: pivots below are round-off */
#define ZERO_PIVOT (100 * PETSC_MACHINE_EPSILON)

typedef struct {
  OuterSolver       outer;
  PetscReal         atol, rtol; /* on the gap [m], and relative to the displacement of the contact nodes */
  Forces            forces;
  InterfaceOperator S;
  InterfaceMark    *marks;      /* all rows are solved for */
  PetscScalar      *compliance; /* S, all rows by all rows, by columns [m/N], times `scale` */
  PetscBool         have_jacobian, scaled_in_place;
  PetscReal         scale; /* of the forces at the end of the step, as the integrator takes them */
  /* for the rate beside the gap, and for the contact-stabilised prediction */
  Complementarity impulses;
  PetscBool       close_rate, stabilized;
  PetscReal       step;                /* [s] */
  PetscReal       mismatch, magnitude; /* [m] */
} ImplicitLagrange;

/* How far complementarity is missed, in metres */
static PetscErrorCode MeasureMismatch(Contact contact, const PetscScalar x[], const PetscScalar f[])
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscReal         sums[2]  = {0, 0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscInt row = contact->rows.begin + i;
    PetscReal      mismatch;
    PetscScalar   *start;

    mismatch = x[i] > 0 ? PetscAbsReal(f[i]) : PetscMax(-f[i], -x[i] * lagrange->compliance[row * (contact->rows.n_all + 1)]);
    PetscCall(TraceGetLevel(contact->traces[contact->pairs[contact->rows.pair[i]].body[0]].displacement, 0, &start));
    sums[0] += PetscSqr(PetscMax(mismatch, 0));
    sums[1] += PetscSqr(start[i]);
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
static PetscErrorCode SetUpOuter(Contact contact)
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

static PetscErrorCode CheckConverged(Contact contact)
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
      " evaluations the contact constraint is missed by %g m (%s). Raise -lagrange_snes_max_it, loosen -lagrange_snes_atol, or choose "
      "a smaller -time_step",
      (double)time, contact->counts.sweeps, (double)lagrange->mismatch, SNESConvergedReasons[reason]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solution. The semismooth iteration may leave forces that pull, within the tolerance: these are taken out. */
static PetscErrorCode TakeForces(Contact contact)
{
  ImplicitLagrange  *lagrange = (ImplicitLagrange *)contact->data;
  const PetscScalar *force;
  int                pulls = 0;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(lagrange->outer.x, &force));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    pulls |= force[i] < 0;
    contact->end.force[i] = PetscMax(force[i], 0);
  }
  PetscCall(VecRestoreArrayRead(lagrange->outer.x, &force));
  PetscCall(ContactOr(contact, &pulls));
  if (pulls) PetscCall(ForcesIntegrate(contact, &lagrange->forces, contact->end.force, lagrange->scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscBool         in_contact, changed = PETSC_TRUE;
  PetscScalar      *x;

  PetscFunctionBegin;
  PetscCall(ForcesBeginStep(contact, &lagrange->forces, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  if (lagrange->stabilized) PetscCall(LagrangeProjectPrediction(contact, lagrange->step, &lagrange->impulses));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayWrite(lagrange->outer.x, &x));
  PetscCall(PetscArraycpy(x, contact->start.force, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(lagrange->outer.x, &x));
  while (changed) {
    PetscCall(SNESSolve(lagrange->outer.snes, NULL, lagrange->outer.x));
    PetscCall(CheckConverged(contact));
    if (!ContactFailed(contact)) PetscCall(TakeForces(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    changed = PETSC_FALSE;
    if (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE)
      PetscCall(ForcesTouch(contact, &lagrange->forces, contact->end.force, &changed));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = (PetscBool)(contact->end.force[i] > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Corrections of the states at the end of the step: velocities without gap rate; and accelerations without contact forces, from
   which the contact-stabilised method starts its next step */
static PetscErrorCode ContactAccept_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  PetscBool         in_contact;

  PetscFunctionBegin;
  if (lagrange->close_rate) PetscCall(LagrangeCloseRate(contact, PETSC_FALSE, &lagrange->impulses));
  if (!lagrange->stabilized) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) lagrange->impulses.forces[i] = -lagrange->scale * contact->end.force[i];
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscCall(ComplementarityGetBodyForces(contact, b, &lagrange->impulses, lagrange->impulses.mine));
    PetscCall(BodyAddAcceleration(contact->bodies[b], lagrange->impulses.mine));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_ImplicitLagrange(Contact contact, PetscViewer viewer)
{
  const ImplicitLagrange *lagrange = (const ImplicitLagrange *)contact->data;
  SNESType                type;

  PetscFunctionBegin;
  PetscCall(SNESGetType(lagrange->outer.snes, &type));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  outer iteration %s on the forces at the end of the step, tolerances %g m and %g relative\n",
                                   type, (double)lagrange->atol, (double)lagrange->rtol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactDestroy_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(OuterSolverDestroy(&lagrange->outer));
  PetscCall(ForcesDestroy(&lagrange->forces));
  if (lagrange->close_rate || lagrange->stabilized) PetscCall(ComplementarityDestroy(&lagrange->impulses));
  PetscCall(InterfaceOperatorDestroy(&lagrange->S));
  PetscCall(PetscFree2(lagrange->compliance, lagrange->marks));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The contact-stabilised Newmark method (Deuflhard, Krause, Ertel 2008) by the trapezoidal rule: with accelerations without contact
   forces at the start of a step and twice the force at its end, u_1 and v_1 have the whole contact force of the end of the step. */
static PetscErrorCode SetUpStabilized(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;
  MPI_Comm          comm     = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCheck(
      contact->options.constraint == CONTACT_CONSTRAINT_GAP, comm, PETSC_ERR_USER_INPUT,
      "-contact_stabilization contact_stabilized closes the gap by a projection of its own; leave -contact_constraint at gap, not %s",
      ContactConstraints[contact->options.constraint]);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const char *name = ((PetscObject)contact->bodies[b])->name;
    PetscBool   is_explicit, massless;
    PetscReal   alpha_m, alpha_f, gamma, beta;
    PetscInt    substeps;
    TS          ts;

    PetscCall(BodyIsExplicit(contact->bodies[b], &is_explicit));
    PetscCheck(
        !is_explicit, comm, PETSC_ERR_USER_INPUT,
        "-contact_stabilization contact_stabilized works with implicit bodies only, and body '%s' is explicit; give it -%s_ts_type alpha2",
        name, name);
    PetscCall(BodyIsRedistributed(contact->bodies[b], &massless));
    PetscCheck(!massless, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized projects in the norm of the mass, and the contact nodes of body '%s' have none, "
               "so that they do not chatter either; set -%s_mass_redistribute false, or leave the stabilization at none",
               name, name);
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCheck(substeps == 1, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized needs one step for all bodies, and body '%s' makes %" PetscInt_FMT
               " substeps; set -%s_ts_time_step to -time_step",
               name, substeps, name);
    PetscCall(BodyGetTS(contact->bodies[b], &ts));
    PetscCall(TSAlpha2GetParams(ts, &alpha_m, &alpha_f, &gamma, &beta));
    PetscCheck(alpha_m == 1 && alpha_f == 1 && gamma == 0.5 && beta == 0.25, comm, PETSC_ERR_USER_INPUT,
               "-contact_stabilization contact_stabilized is made for the trapezoidal rule, and body '%s' has alpha_m %g, alpha_f %g, "
               "gamma %g, beta %g; leave -%s_ts_alpha_... at their defaults",
               name, (double)alpha_m, (double)alpha_f, (double)gamma, (double)beta, name);
  }
  lagrange->scale              = 2;
  lagrange->stabilized         = PETSC_TRUE;
  contact->attempt.moves_start = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComputeCompliance(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(InterfaceOperatorSetRows(lagrange->S, lagrange->marks, 1));
  PetscCall(InterfaceOperatorAssemble(lagrange->S, INTERFACE_GAP, -1, lagrange->compliance));
  for (PetscInt i = 0; i < contact->rows.n_all * contact->rows.n_all; i++) lagrange->compliance[i] *= lagrange->scale;
  lagrange->have_jacobian = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactRowsChanged_ImplicitLagrange(Contact contact)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  PetscCall(ComputeCompliance(contact));
  if (lagrange->close_rate || lagrange->stabilized)
    PetscCall(ComplementaritySetCompliance(contact, BodyComputeInverseMass, &lagrange->impulses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Another controller step, and so another compliance */
static PetscErrorCode SetStepLevel(Contact contact, PetscInt level, PetscBool goes_on)
{
  PetscFunctionBegin;
  (void)level;
  (void)goes_on;
  ((ImplicitLagrange *)contact->data)->step = contact->step;
  PetscCall(ComputeCompliance(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactVisit_ImplicitLagrange(Contact contact, Checkpoint checkpoint)
{
  ImplicitLagrange *lagrange = (ImplicitLagrange *)contact->data;

  PetscFunctionBegin;
  if (CheckpointLoads(checkpoint)) {
    lagrange->step          = contact->step;
    lagrange->have_jacobian = PETSC_FALSE;
    if (lagrange->close_rate || lagrange->stabilized)
      PetscCall(ComplementaritySetCompliance(contact, BodyComputeInverseMass, &lagrange->impulses));
  }
  PetscCall(CheckpointVisitReals(checkpoint, "compliance", contact->rows.n_all * contact->rows.n_all, lagrange->compliance));
  PetscCall(InterfaceOperatorVisit(lagrange->S, checkpoint));
  PetscCall(ForcesVisit(contact, &lagrange->forces, checkpoint));
  PetscCall(CheckpointVisitVec(checkpoint, "outer", lagrange->outer.x));
  if (lagrange->close_rate || lagrange->stabilized) PetscCall(ComplementarityVisit(contact, &lagrange->impulses, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LagrangeSetUpImplicit(Contact contact)
{
  /* SNESVI wants all of S as a matrix: dense whatever its size, which ForcesCheckDense() bounds; nothing is iterated for */
  const InterfaceSettings settings = {.prefix = "lagrange_", .dense_limit = contact->rows.n_all, .few = contact->rows.n_all};
  ImplicitLagrange       *lagrange;
  PetscBool               has_mass;

  PetscFunctionBegin;
  PetscCall(ForcesCheckBodies(contact, "lagrange"));
  PetscCall(ForcesCheckDense(contact, "lagrange"));
  PetscCall(ContactHasMass(contact, PETSC_TRUE, &has_mass));
  PetscCall(ContactRefuseUnstable(
      contact,
      (PetscBool)(has_mass && contact->options.constraint == CONTACT_CONSTRAINT_GAP &&
                  contact->options.stabilization == CONTACT_STABILIZATION_NONE),
      "-contact_type lagrange: where the contact nodes of both sides have mass, multipliers at the end of the step swing and gain energy; "
      "set "
      "-<body>_mass_redistribute true, or choose -contact_stabilization contact_stabilized, or -contact_type schwarz"));
  PetscCheck(contact->options.law != CONTACT_LAW_TIED, PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_law tied with -contact_type lagrange is for bodies that are all explicit, with mass on their contact nodes and "
             "without substeps: with others the multipliers only push; choose -contact_type schwarz or penalty");
  PetscCall(PetscNew(&lagrange));
  contact->data             = lagrange;
  contact->ops->step        = ContactStep_ImplicitLagrange;
  contact->ops->stored      = ContactStoresNothing;
  contact->ops->view        = ContactView_ImplicitLagrange;
  contact->ops->rowschanged = ContactRowsChanged_ImplicitLagrange;
  contact->ops->steplevel   = SetStepLevel;
  contact->ops->visit       = ContactVisit_ImplicitLagrange;
  contact->ops->destroy     = ContactDestroy_ImplicitLagrange;
  lagrange->scale           = 1;
  PetscCall(ForcesGetStep(contact, &lagrange->step));
  PetscCall(ForcesCreate(contact, &lagrange->forces));
  PetscCall(InterfaceOperatorCreate(contact, &settings, &lagrange->S));
  PetscCall(PetscCalloc2(contact->rows.n_all * contact->rows.n_all, &lagrange->compliance, contact->rows.n, &lagrange->marks));
  for (PetscInt i = 0; i < contact->rows.n; i++) lagrange->marks[i] = INTERFACE_SOLVED;
  if (contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED) PetscCall(SetUpStabilized(contact));
  if (contact->options.constraint == CONTACT_CONSTRAINT_BOTH) {
    PetscCall(LagrangeSetUpImpulses(contact, "-contact_constraint both", &lagrange->impulses));
    lagrange->close_rate = PETSC_TRUE;
  } else if (lagrange->stabilized)
    PetscCall(LagrangeSetUpImpulses(contact, "-contact_stabilization contact_stabilized", &lagrange->impulses));
  if (lagrange->close_rate || lagrange->stabilized) contact->ops->accept = ContactAccept_ImplicitLagrange;
  PetscCall(ComputeCompliance(contact));
  PetscCall(SetUpOuter(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
