/*
   Penalty method. The contact force on row i at the end of a controller step is

     lambda_i = <multiplier_i - tau A_i gap_i - c A_i (gap_i - last gap_i) / dt>,   <x> = max(x, 0)

   with a spring tau, a damper c, or both; the multiplier is zero but for the augmented Lagrangian. During the step the force goes
   linearly from its last value to this one. The outer SNES solves F(lambda) = lambda - <...> = 0 with both bodies under forces; its
   Jacobian is I + (tau + c / dt) A S on the rows that push, with the interface compliance S of all bodies (forceproblem.c). Tied rows
   are held by springs that pull as well.

   With explicit bodies and mass on the contact nodes the gap does not depend on the force at the end of the step: the second
   evaluation, which finds this out, only adds the change of force to the end state.
*/
#include "penaltyimpl.h"
#include <checkpoint/checkpoint.h>
#include <sys/petsccompat.h>
#include <stddef.h>
#include <sys/units.h>

/* Relative tolerance on contact forces, for which the method itself leaves 1e-3 and more of penetration */
#define FORCE_RTOL 1e-9

static PetscErrorCode ContactSetFromOptions_Penalty(Contact contact)
{
  Penalty  *penalty = (Penalty *)contact->data;
  PetscBool set;

  PetscFunctionBegin;
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP_RATE) PetscCall(PenaltyReadParameter(contact));
  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP) PetscFunctionReturn(PETSC_SUCCESS);
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_penalty_damping", "Damping of the gap rate [N s/m in 1-D, N s/m^3 else]", "ContactPenaltySetDamping",
                             penalty->damping, &penalty->damping, &set));
  PetscOptionsEnd();
  PetscCheck(!set || penalty->damping > 0, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_penalty_damping %g must be positive", (double)penalty->damping);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force that springs and dampers want on row i at its gap as it is; negative where they would pull */
static PetscReal WantedForce(Contact contact, PetscInt i)
{
  const Penalty  *penalty = (const Penalty *)contact->data;
  const PetscReal spring  = penalty->multiplier[i] - penalty->spring[i] * contact->end.gap[i];

  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP) return spring;
  if (!penalty->forces.touching[i]) return 0;
  return spring - penalty->damper[i] * (contact->end.gap[i] - contact->start.gap[i]) / penalty->step;
}

/* Energy of the spring of a row [J] */
static PetscReal StoredEnergy(Contact contact, PetscInt i, PetscReal gap)
{
  const Penalty *penalty = (const Penalty *)contact->data;

  return contact->rows.tied[i] || gap < 0 ? 0.5 * penalty->spring[i] * PetscSqr(gap) : 0;
}

/* What springs and dampers make of the round-off in gap i, a sum of three lengths that were rounded themselves: no iteration
   gets below */
static PetscReal RoundOff(Contact contact, PetscInt i)
{
  const Penalty     *penalty = (const Penalty *)contact->data;
  const ContactPair *pair    = &contact->pairs[contact->rows.pair[i]];
  const PetscScalar *start   = penalty->start[pair->body[0]]; /* displacements */

  if (!penalty->pushing[i]) return 0;
  return 4 * PETSC_MACHINE_EPSILON * penalty->stiffness[i] *
         (PetscAbsReal(start[i - pair->shift[0]]) + PetscAbsReal(contact->rows.initial_gap[i]));
}

/* Advances all bodies under the forces x, and compares these with what springs and dampers ask for */
static PetscErrorCode ComputeResidual(SNES snes, Vec X, Vec F, void *ctx)
{
  Contact            contact = (Contact)ctx;
  Penalty           *penalty = (Penalty *)contact->data;
  const PetscScalar *x;
  PetscScalar       *f;
  PetscReal          sums[3] = {0, 0, 0};

  PetscFunctionBegin;
  (void)snes;
  PetscCall(VecGetArrayRead(X, &x));
  PetscCall(ForcesIntegrate(contact, &penalty->forces, x, 1));
  if (ContactFailed(contact)) {
    PetscCall(VecRestoreArrayRead(X, &x));
    PetscCall(ContactRejectResidual(F));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecGetArrayWrite(F, &f));
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const PetscReal wanted = WantedForce(contact, i);

    penalty->pushing[i] = (PetscBool)(contact->rows.tied[i] || wanted > 0);
    f[i]                = x[i] - (penalty->pushing[i] || PetscIsInfOrNanReal(wanted) ? wanted : 0);
    sums[0] += PetscSqr(f[i]);
    sums[1] += PetscSqr(x[i]);
    sums[2] += PetscSqr(RoundOff(contact, i));
  }
  PetscCall(VecRestoreArrayWrite(F, &f));
  PetscCall(VecRestoreArrayRead(X, &x));
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  penalty->residual  = PetscSqrtReal(sums[0]);
  penalty->magnitude = PetscSqrtReal(sums[1]);
  penalty->round_off = PetscSqrtReal(sums[2]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nothing to assemble: the step is that of the force problem */
static PetscErrorCode ComputeJacobian(SNES snes, Vec X, Mat J, Mat P, void *ctx)
{
  Contact  contact = (Contact)ctx;
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  (void)snes;
  (void)J;
  (void)P;
  PetscCall(ForceProblemUpdate(contact, &penalty->problem, penalty->pushing, X));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyNewton(PC pc, Vec F, Vec Y)
{
  Contact contact;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &contact));
  PetscCall(ForceProblemSolve(contact, &((Penalty *)contact->data)->problem, F, Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                      SNESConvergedReason *reason, void *ctx)
{
  const Penalty *penalty = (const Penalty *)((Contact)ctx)->data;

  PetscFunctionBegin;
  (void)snes;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (penalty->residual <= penalty->atol || penalty->residual <= penalty->round_off ||
           (penalty->residual <= penalty->rtol * penalty->magnitude && (it || !penalty->again)))
    *reason = SNES_CONVERGED_FNORM_ABS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Steps with friction have springs across the normals too, and forces that follow from the compliance of the interface */
PetscErrorCode PenaltyStepByFriction(Contact contact)
{
  const Penalty               *penalty = (const Penalty *)contact->data;
  const ContactFrictionSprings springs = {.penalty      = penalty->penalty,
                                          .scale        = penalty->scale,
                                          .getparameter = PenaltyGetPairParameter,
                                          .tolerance    = penalty->augmentation_max_it ? penalty->augmentation_tolerance : 0,
                                          .max_it       = penalty->augmentation_max_it};

  PetscFunctionBegin;
  PetscCall(ContactStepByFriction(contact, &springs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PenaltySetUp(Contact contact)
{
  Penalty       *penalty = (Penalty *)contact->data;
  const PetscInt n       = contact->rows.n;
  PetscBool      line_search;

  PetscFunctionBegin;
  if (ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) {
    PetscCall(PenaltyStepByFriction(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(contact->options.constraint == CONTACT_CONSTRAINT_GAP || penalty->damping > 0, PetscObjectComm((PetscObject)contact),
             PETSC_ERR_USER_INPUT,
             "-contact_constraint %s with -contact_type penalty needs -contact_penalty_damping, in N s/m in one dimension; the impedance "
             "of a bar, sqrt(E rho) times its area, is its scale",
             ContactConstraints[contact->options.constraint]);
  penalty->springs = (PetscBool)(contact->options.constraint != CONTACT_CONSTRAINT_GAP_RATE);
  PetscCall(ForcesGetStep(contact, &penalty->step));
  PetscCall(PetscCalloc6(n, &penalty->multiplier, n, &penalty->pushing, n, &penalty->spring, n, &penalty->damper, n, &penalty->stiffness,
                         3 * n, &penalty->work));
  PetscCall(PenaltySetUpSprings(contact));
  PetscCall(OuterSolverCreate(contact, "penalty_", n, ComputeResidual, ComputeJacobian, &penalty->outer));
  PetscCall(OuterSolverSetNewton(contact, &penalty->outer, ComputeJacobian, ApplyNewton));
  PetscCall(OuterSolverSetFromOptions(contact, &penalty->outer, CONTACT_FORCE_TOLERANCE * contact->scale.force, FORCE_RTOL,
                                      OUTER_MAX_ITERATIONS));
  PetscCall(SNESGetTolerances(penalty->outer.snes, &penalty->atol, &penalty->rtol, NULL, NULL, NULL));
  PetscCall(PetscObjectTypeCompare((PetscObject)penalty->outer.snes, SNESNEWTONLS, &penalty->may_damp));
  PetscCall(PetscOptionsHasName(NULL, "penalty_", "-snes_linesearch_type", &line_search));
  if (line_search) penalty->may_damp = PETSC_FALSE;
  PetscCall(SNESSetConvergenceTest(penalty->outer.snes, TestConvergence, contact, NULL));
  PetscCall(ForcesCreate(contact, &penalty->forces));
  PetscCall(PetscMalloc1(contact->n_bodies, &penalty->start));
  for (PetscInt b = 0; b < contact->n_bodies; b++) PetscCall(TraceGetLevel(contact->traces[b].displacement, 0, &penalty->start[b]));
  PetscCall(ForceProblemCreate(contact, penalty->stiffness, &penalty->problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other areas, other springs, and a compliance that bodies have forgotten */
PetscErrorCode PenaltyRowsChanged(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(PenaltySetUpSprings(contact));
  penalty->problem.stale = PETSC_TRUE;
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) penalty->problems[k].stale = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A compliance that bodies have forgotten */
PetscErrorCode PenaltyStepBack(Contact contact)
{
  PetscFunctionBegin;
  ((Penalty *)contact->data)->problem.stale = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Another controller step: other dampers, and another compliance. The force problem of each level is kept apart. */
PetscErrorCode PenaltySetStepLevel(Contact contact, PetscInt level, PetscBool goes_on)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  penalty->step = contact->step;
  for (PetscInt i = 0; i < contact->rows.n; i++) penalty->stiffness[i] = penalty->spring[i] + penalty->damper[i] / penalty->step;
  penalty->problems[penalty->level] = penalty->problem;
  penalty->problem                  = penalty->problems[level];
  penalty->level                    = level;
  PetscCall(PetscMemzero(&penalty->problems[level], sizeof(penalty->problems[level])));
  if (!penalty->problem.S) PetscCall(ForceProblemCreate(contact, penalty->stiffness, &penalty->problem));
  else if (!goes_on) PetscCall(ForceProblemForget(contact, &penalty->problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckConverged(Contact contact)
{
  Penalty            *penalty = (Penalty *)contact->data;
  SNESConvergedReason reason;
  PetscReal           time;

  PetscFunctionBegin;
  PetscCall(SNESGetConvergedReason(penalty->outer.snes, &reason));
  if (reason > 0 || ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ForcesGetTime(contact, &time));
  for (PetscInt p = 0; reason == SNES_DIVERGED_NAN && p < contact->n_pairs; p++) {
    ContactPairState state;

    PetscCall(ContactGetPairState(contact, p, &state));
    if (PetscIsInfOrNanReal(state.gap))
      PetscCall(StepFailureSet(
          &contact->attempt.failure, STEP_DIVERGED_NAN, PETSC_ERR_FP,
          "The contact force between the bodies '%s' is not a number in the step that ends at time %.9g s; is a velocity, a time step "
          "or -contact_penalty too large?",
          contact->pairs[p].name, (double)time));
  }
  PetscCall(StepFailureSet(
      &contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
      "The penalty iteration did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
      " evaluations the contact force is off by %g%s (%s). Raise -penalty_snes_max_it, loosen -penalty_snes_rtol, or choose a smaller "
      "-contact_penalty (or -contact_penalty_scale) or -time_step",
      (double)time, contact->counts.sweeps, (double)penalty->residual, UnitsOf((PetscObject)contact, UNIT_FORCE),
      SNESConvergedReasons[reason]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces as they are become the first iterate */
static PetscErrorCode TakeForces(Contact contact)
{
  Penalty     *penalty = (Penalty *)contact->data;
  PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(penalty->outer.x, &x));
  PetscCall(PetscArraycpy(x, contact->end.force, contact->rows.n));
  PetscCall(VecRestoreArrayWrite(penalty->outer.x, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The outer iteration from the forces as they are. Newton's full steps may go round between the same sets of rows that push where a long
   step opens and closes many; from the same start, steps that make the residual least along them do not. */
static PetscErrorCode Iterate(Contact contact)
{
  Penalty            *penalty = (Penalty *)contact->data;
  SNESConvergedReason reason;
  SNESLineSearch      line_search;

  PetscFunctionBegin;
  PetscCall(SNESSolve(penalty->outer.snes, NULL, penalty->outer.x));
  PetscCall(SNESGetConvergedReason(penalty->outer.snes, &reason));
  if (reason != SNES_DIVERGED_MAX_IT || !penalty->may_damp || ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TakeForces(contact));
  PetscCall(SNESGetLineSearch(penalty->outer.snes, &line_search));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_LEAST_RESIDUAL));
  PetscCall(SNESSolve(penalty->outer.snes, NULL, penalty->outer.x));
  PetscCall(SNESLineSearchSetType(line_search, LINESEARCH_FULL_STEP));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces of springs and dampers, from the forces as they are as first iterate */
PetscErrorCode PenaltySolve(Contact contact)
{
  Penalty           *penalty = (Penalty *)contact->data;
  PetscBool          changed = PETSC_TRUE;
  const PetscScalar *force;

  PetscFunctionBegin;
  PetscCall(TakeForces(contact));
  while (changed) {
    PetscCall(Iterate(contact));
    PetscCall(CheckConverged(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(VecGetArrayRead(penalty->outer.x, &force));
    PetscCall(PetscArraycpy(contact->end.force, force, contact->rows.n));
    PetscCall(VecRestoreArrayRead(penalty->outer.x, &force));
    changed = PETSC_FALSE;
    if (contact->options.constraint != CONTACT_CONSTRAINT_GAP)
      PetscCall(ForcesTouch(contact, &penalty->forces, contact->end.force, &changed));
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) contact->end.active[i] = (PetscBool)(contact->rows.tied[i] || contact->end.force[i] > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactStep_Penalty(Contact contact)
{
  Penalty  *penalty = (Penalty *)contact->data;
  PetscBool in_contact;
  PetscReal energy = 0;

  PetscFunctionBegin;
  contact->resultants.penalty_energy = 0;
  PetscCall(ForcesBeginStep(contact, &penalty->forces, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(contact->end.force, contact->start.force, contact->rows.n));
  PetscCall(PenaltySolve(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++)
    energy += 0.5 * penalty->spring[i] * PetscSqr(contact->rows.tied[i] ? contact->end.gap[i] : PetscMin(contact->end.gap[i], 0));
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  contact->resultants.penalty_energy = energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContactView_Penalty(Contact contact, PetscViewer viewer)
{
  const Penalty *penalty = (const Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(PenaltyViewParameter(contact, viewer));
  if (penalty->damping > 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  damping %g%s\n", (double)penalty->damping,
                                     UnitsOf((PetscObject)contact, contact->dim == 1 ? UNIT_DASHPOT : UNIT_DASHPOT_ON_AREA)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* State for a checkpoint: the force problem of each level of cut steps that there has been, and the springs as the rows have them */
PetscErrorCode PenaltyVisit(Contact contact, Checkpoint checkpoint)
{
  Penalty       *penalty = (Penalty *)contact->data;
  const PetscInt n       = contact->rows.n;
  PetscInt       present = penalty->level;

  PetscFunctionBegin;
  PetscCall(CheckpointVisitInts(checkpoint, "level", 1, &present));
  penalty->step = contact->step;
  PetscCall(CheckpointVisitReals(checkpoint, "spring", n, penalty->spring));
  PetscCall(CheckpointVisitReals(checkpoint, "damper", n, penalty->damper));
  PetscCall(CheckpointVisitReals(checkpoint, "stiffness", n, penalty->stiffness));
  PetscCall(CheckpointVisitReals(checkpoint, "multiplier", n, penalty->multiplier));
  PetscCall(CheckpointVisitBools(checkpoint, "pushing", n, penalty->pushing));
  PetscCall(ForcesVisit(contact, &penalty->forces, checkpoint));
  PetscCall(CheckpointVisitVec(checkpoint, "outer", penalty->outer.x));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) {
    ForceProblem *problem = k == penalty->level ? &penalty->problem : &penalty->problems[k];
    PetscBool     exists  = (PetscBool)(problem->S != NULL);

    PetscCall(CheckpointVisitBools(checkpoint, "level exists", 1, &exists));
    if (!exists) continue;
    if (!problem->S) PetscCall(ForceProblemCreate(contact, penalty->stiffness, problem));
    PetscCall(ForceProblemVisit(contact, problem, checkpoint));
  }
  if (present == penalty->level) PetscFunctionReturn(PETSC_SUCCESS);
  penalty->problems[penalty->level] = penalty->problem;
  penalty->problem                  = penalty->problems[present];
  penalty->level                    = present;
  PetscCall(PetscMemzero(&penalty->problems[present], sizeof(penalty->problems[present])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Springs and dampers follow from the rows as they are, and forces are those of contact itself */
PetscBool PenaltyMayReplaceRows(Contact contact)
{
  (void)contact;
  return PETSC_TRUE;
}

/* All but the options */
PetscErrorCode PenaltyReset(Contact contact)
{
  Penalty *penalty = (Penalty *)contact->data;

  PetscFunctionBegin;
  PetscCall(OuterSolverDestroy(&penalty->outer));
  PetscCall(ForcesDestroy(&penalty->forces));
  PetscCall(ForceProblemDestroy(&penalty->problem));
  for (PetscInt k = 0; k <= STEP_MAX_CUTS; k++) PetscCall(ForceProblemDestroy(&penalty->problems[k]));
  PetscCall(PetscFree(penalty->start));
  PetscCall(PetscFree6(penalty->multiplier, penalty->pushing, penalty->spring, penalty->damper, penalty->stiffness, penalty->work));
  PetscCall(PetscMemzero((char *)penalty + offsetof(Penalty, outer), sizeof(*penalty) - offsetof(Penalty, outer)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PenaltyDestroy(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(PenaltyReset(contact));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*MC
   CONTACT_PENALTY - contact forces in proportion to the penetration, or to its rate

   Options Database Keys:
+  -contact_penalty tau                                          - penalty parameter [N/m^3; N/m in one dimension]
.  -contact_penalty_scale s                                      - where tau is not given: as many times the stiffness of an element of each
                                                                   side, one behind the other; 10 for massless contact nodes, 1 for others
.  -contact_constraint (gap|gap_rate|both)                       - springs, dampers in their place, or both
.  -contact_penalty_damping c                                    - damping [N s/m^3; N s/m in one dimension], required by dampers
.  -penalty_snes_type (newtonls|anderson|nrichardson|ngmres|qn)  - the outer iteration on the contact forces
-  -penalty_snes_rtol, -penalty_snes_atol, -penalty_snes_max_it  - its tolerances on the force (1e-9; 1e-17 of E A of the softest element,
                                                                   in N) and limit (50)

   Level: beginner

   Notes:
   Implicit or explicit by the integrators of the bodies. The energy in the springs is reported beside that of the bodies; what
   dampers take is lost from these.

   The gap rate is the change of the gap over a controller step; dampers push on rows that were in contact or penetrate in a free
   trial. Without springs nothing brings penetration back: it grows while the bodies push.

.seealso: `ContactSetType()`, `CONTACT_SCHWARZ`, `CONTACT_LAGRANGE`, `CONTACT_AUGMENTED_LAGRANGIAN`
M*/
PetscErrorCode ContactCreate_Penalty(Contact contact)
{
  Penalty *penalty;

  PetscFunctionBegin;
  PetscCall(PetscNew(&penalty));
  contact->data                = penalty;
  contact->ops->setfromoptions = ContactSetFromOptions_Penalty;
  contact->ops->setup          = PenaltySetUp;
  contact->ops->step           = ContactStep_Penalty;
  contact->ops->stored         = StoredEnergy;
  contact->ops->rowschanged    = PenaltyRowsChanged;
  contact->ops->stepback       = PenaltyStepBack;
  contact->ops->steplevel      = PenaltySetStepLevel;
  contact->ops->view           = ContactView_Penalty;
  contact->ops->visit          = PenaltyVisit;
  contact->ops->mayreplacerows = PenaltyMayReplaceRows;
  contact->ops->reset          = PenaltyReset;
  contact->ops->destroy        = PenaltyDestroy;
  PetscFunctionReturn(PETSC_SUCCESS);
}
