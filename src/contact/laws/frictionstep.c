/*
   A controller step with friction, for all methods that close gaps by forces at the end of the step. The forces on the rows of nodes that
   may touch are the unknowns. All bodies are integrated under a guess of them; with the compliance S of the interface the forces follow for
   which the law holds at the end of the step; and the bodies are integrated under these. For linear bodies that is the step. For others S
   is not exact, and both are repeated until what rows open by is what S has told.
*/
#include "frictionstep.h"
#include <contact/compliance/augmentation.h>
#include <sys/units.h>

/* Rows up to which S is a matrix, and up to which it is so whatever products with it cost */
#define DENSE_LIMIT 2000
#define DENSE_ROWS  300
/* Integrations of all bodies in a step */
#define MOST_SWEEPS FRICTION_SECANTS
/* Round-off of what rows open by, in parts of the displacements that this is the difference of */
#define ROUND_OFF 1e-14
/* By how many times that may the forces that have been found miss the law */
#define RESIDUAL_MOST 100

/* Marks the rows of nodes that penetrate as some that may touch; whether there are any that were not marked. Collective. */
static PetscErrorCode MarkPenetrating(Contact contact, PetscBool *any)
{
  FrictionStep *step  = (FrictionStep *)contact->data;
  int           found = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    if (step->marks[i] != INTERFACE_LEFT_OUT || contact->end.gap[i] >= -contact->options.tolerance) continue;
    for (PetscInt k = 0; k < contact->dim; k++) step->marks[i + k] = INTERFACE_SOLVED;
    found = 1;
  }
  PetscCall(ContactOr(contact, &found));
  *any = (PetscBool)(found > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the rows of nodes that have a force */
static void MarkForces(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  for (PetscInt i = 0; i < contact->rows.n; i += contact->dim)
    for (PetscInt k = 0; k < contact->dim && contact->end.force[i] != 0; k++) step->marks[i + k] = INTERFACE_SOLVED;
}

/* Integrates all bodies under the forces; gaps and slips */
static PetscErrorCode Integrate(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  PetscCall(ForcesIntegrate(contact, &step->forces, contact->end.force, 1));
  if (!ContactFailed(contact)) PetscCall(FrictionComputeSlips(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By how much gaps and slips of the bodies differ from what S has told with the forces found, and what is round-off of them [m]; the same
   on every rank. `opened` of the problem are those of the bodies afterwards, and `base` the forces. */
static PetscErrorCode Compare(Contact contact, PetscReal *mismatch, PetscReal *round_off)
{
  FrictionStep    *step    = (FrictionStep *)contact->data;
  FrictionProblem *problem = &step->problem;
  PetscReal        largest = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < problem->n; i++) problem->change[i] = problem->force[i] - problem->base[i];
  PetscCall(FrictionProblemMultiply(problem, problem->change, problem->told));
  PetscCall(FrictionGatherOpened(contact, problem->answer));
  *mismatch = 0;
  for (PetscInt i = 0; i < problem->n; i++) {
    const PetscScalar opened  = problem->answer[i];
    const PetscReal   differs = PetscAbsScalar(opened - (problem->opened[i] + problem->told[i]));

    *mismatch = differs > *mismatch || PetscIsInfOrNanReal(differs) ? differs : *mismatch;
    problem->answer[i] -= problem->opened[i];
    problem->opened[i] = opened;
    problem->base[i]   = problem->force[i];
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++)
    for (PetscInt side = 0; side < 2; side++) {
      const ContactPair *pair  = &contact->pairs[p];
      const Trace        trace = contact->traces[pair->body[side]].displacement;
      PetscScalar       *end;
      PetscInt           levels;

      PetscCall(TraceGetSizes(trace, NULL, &levels));
      PetscCall(TraceGetLevel(trace, levels, &end));
      for (PetscInt i = pair->begin; i < pair->end; i++) largest = PetscMax(largest, PetscAbsScalar(end[i - pair->shift[side]]));
    }
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
  *round_off = ROUND_OFF * largest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Notes that the step has failed */
static PetscErrorCode Fail(Contact contact, PetscBool solved, PetscReal mismatch)
{
  PetscReal time;

  PetscFunctionBegin;
  PetscCall(ForcesGetTime(contact, &time));
  if (!solved)
    PetscCall(
        StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_ACTIVE_SET, PETSC_ERR_NOT_CONVERGED,
                       "No forces were found for which -contact_law %s holds in the step that ends at time %.9g s. Large coefficients of "
                       "friction may have no solution or more than one; choose a smaller -time_step or coefficient",
                       contact->friction.name, (double)time));
  else if (PetscIsInfOrNanReal(mismatch))
    PetscCall(
        StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_NAN, PETSC_ERR_FP,
                       "A contact gap or force is not a number in the step that ends at time %.9g s; is a velocity or a time step too "
                       "large?",
                       (double)time));
  else
    PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                             "The forces of friction did not settle in the step that ends at time %.9g s: after %" PetscInt_FMT
                             " sweeps gaps and slips are missed by %g%s. Choose a smaller -time_step",
                             (double)time, contact->counts.sweeps, (double)mismatch, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces of the listed rows for which the law holds, as far as S tells */
static PetscErrorCode Solve(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;
  PetscBool     solved, by_nodes;

  PetscFunctionBegin;
  PetscCall(FrictionSolverSolve(step->solver, &step->problem, &solved, &by_nodes));
  contact->counts.inner_iterations += FrictionSolverGetIterations(step->solver);
  if (by_nodes) contact->counts.set_cycles++;
  if (!solved) PetscCall(FrictionProblemKeepForces(&step->problem, step->atol, &solved));
  if (!solved) PetscCall(Fail(contact, PETSC_FALSE, 0));
  PetscCall(FrictionTakeForces(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Forces for which the law holds, and the bodies under these, with multipliers as they are */
static PetscErrorCode Settle(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;
  PetscBool     more;
  PetscReal     mismatch = 0, round_off = 0;

  PetscFunctionBegin;
  PetscCall(MarkPenetrating(contact, &more));
  PetscCall(FrictionStartProblem(contact));
  for (PetscInt sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    PetscCall(Solve(contact));
    if (!ContactFailed(contact)) PetscCall(Integrate(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(Compare(contact, &mismatch, &round_off));
    PetscCall(PetscInfo(contact, "friction: after sweep %" PetscInt_FMT " gaps and slips differ by %g m from what was told\n",
                        contact->counts.sweeps, (double)mismatch));
    PetscCall(MarkPenetrating(contact, &more));
    if (PetscIsInfOrNanReal(mismatch)) break;
    if (more) {
      contact->counts.set_changes++;
      PetscCall(FrictionStartProblem(contact));
    } else if (mismatch <= PetscMax(step->atol, round_off)) {
      const PetscReal residual = FrictionProblemGetResidual(&step->problem, step->problem.opened);

      /* what solves the problem is checked by the law itself */
      if (residual > RESIDUAL_MOST * PetscMax(step->atol, round_off)) PetscCall(Fail(contact, PETSC_FALSE, 0));
      contact->counts.friction_residual = PetscMax(contact->counts.friction_residual, residual);
      PetscFunctionReturn(PETSC_SUCCESS);
    } else FrictionLearn(&step->problem);
  }
  PetscCall(Fail(contact, PETSC_TRUE, mismatch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces that have been found become multipliers, until springs hardly give any more */
static PetscErrorCode Augment(Contact contact)
{
  FrictionStep *step         = (FrictionStep *)contact->data;
  Augmentation  augmentation = {.last = step->change};
  PetscReal     worst, time;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(augmentation.last, contact->rows.n));
  for (PetscInt k = 0; k < step->springs.max_it; k++) {
    worst = 0;
    for (PetscInt i = 0; i < contact->rows.n; i++) worst = PetscMax(worst, PetscAbsReal(FrictionGive(contact, i)));
    if (contact->ranks.size > 1)
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)contact)));
    if (worst <= step->springs.tolerance) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(AugmentationTakeForces(contact, &augmentation, step->multiplier));
    PetscCall(FrictionComputeSlips(contact));
    PetscCall(Settle(contact));
    if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ForcesGetTime(contact, &time));
  PetscCall(StepFailureSet(&contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
                           "The augmented Lagrangian did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
                           " augmentations gaps and slips are off by %g%s. Raise -contact_penalty or -contact_augmentation_max_it, or "
                           "loosen -contact_augmentation_tolerance",
                           (double)time, step->springs.max_it, (double)worst, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;
  PetscBool     in_contact, ambiguous = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(step->marks, contact->rows.n));
  PetscCall(PetscArrayzero(contact->friction.slides, contact->rows.n));
  contact->resultants.penalty_energy = 0;
  PetscCall(ForcesBeginStep(contact, &step->forces, &in_contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!in_contact) {
    PetscCall(ContactComputeSlips(contact));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    /* the guess; where the step is made again that is what it has ended with before */
    if (!contact->energy.again) contact->end.force[i] = contact->start.force[i];
    if (contact->start.active[i]) step->marks[i] = INTERFACE_SOLVED;
    /* springs along normals without multipliers push by how deep they are; those across them go on from where they are */
    step->multiplier[i] = step->springs.max_it || ContactRowRubs(contact, i) ? contact->start.force[i] : 0;
  }
  if (contact->energy.again) MarkForces(contact);
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (in_contact) PetscCall(Integrate(contact));
  else PetscCall(FrictionComputeSlips(contact)); /* of the free trial */
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Settle(contact));
  if (!ContactFailed(contact) && step->springs.max_it) PetscCall(Augment(contact));
  if (ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!contact->energy.again) PetscCall(FrictionProblemIsAmbiguous(&step->problem, &ambiguous));
  if (!contact->energy.again && ambiguous) contact->counts.ambiguous_steps++;
  PetscCall(ContactSumStored(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode View(Contact contact, PetscViewer viewer)
{
  const FrictionStep *step = (const FrictionStep *)contact->data;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  contact forces at the end of the step from the compliance of the interface, to %g%s\n",
                                   (double)step->atol, UnitsOf((PetscObject)contact, UNIT_LENGTH)));
  if (step->has_springs) PetscCall(FrictionViewSprings(contact, viewer));
  if (contact->friction.law.view) PetscCall((*contact->friction.law.view)(contact, contact->friction.law.data, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Some rows have new entries */
static PetscErrorCode RowsChanged(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) step->compliance[i] = -1;
  PetscCall(FrictionSetUpSprings(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All that has to do with the rows there are */
static PetscErrorCode Reset(Contact contact)
{
  FrictionStep *step = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  PetscCall(ForcesDestroy(&step->forces));
  PetscCall(InterfaceOperatorDestroy(&step->S));
  PetscCall(FrictionSolverDestroy(&step->solver));
  PetscCall(FrictionProblemDestroy(&step->problem));
  PetscCall(FrictionDestroyProducts(contact));
  PetscCall(PetscFree5(step->marks, step->mine, step->flexibility, step->multiplier, step->change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same for the rows that there are now */
static PetscErrorCode SetUp(Contact contact)
{
  const PetscInt          limit    = contact->options.friction_dense;
  const InterfaceSettings settings = {.dense_limit  = limit < 0 ? DENSE_LIMIT : limit,
                                      .few          = limit < 0 ? DENSE_ROWS : limit,
                                      .products     = PETSC_TRUE,
                                      .precondition = PETSC_TRUE};
  FrictionStep           *step     = (FrictionStep *)contact->data;

  PetscFunctionBegin;
  if (contact->friction.law.setup) PetscCall((*contact->friction.law.setup)(contact, contact->friction.law.data));
  step->problem = (FrictionProblem){.dim = contact->dim, .still = step->atol};
  PetscCall(ForcesCreate(contact, &step->forces));
  PetscCall(InterfaceOperatorCreate(contact, &settings, &step->S));
  PetscCall(FrictionSolverCreate(&step->solver));
  PetscCall(PetscCalloc5(contact->rows.n, &step->marks, contact->rows.n, &step->mine, contact->rows.n, &step->flexibility, contact->rows.n,
                         &step->multiplier, contact->rows.n, &step->change));
  PetscCall(FrictionCreateProducts(contact));
  PetscCall(RowsChanged(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(Reset(contact));
  PetscCall(PetscFree(contact->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What friction needs of bodies and options */
static PetscErrorCode Check(Contact contact)
{
  MPI_Comm  comm = PetscObjectComm((PetscObject)contact);
  PetscBool has_mass;

  PetscFunctionBegin;
  PetscCheck(contact->dim > 1, comm, PETSC_ERR_SUP, "-contact_law %s: bars of one dimension cannot slide; choose frictionless",
             contact->friction.name);
  PetscCall(ContactHasMass(contact, PETSC_FALSE, &has_mass));
  PetscCheck(!has_mass, comm, PETSC_ERR_SUP,
             "-contact_law %s needs massless contact nodes with -contact_type %s: with mass the forces of friction ring from step to step; "
             "leave -<body>_mass_redistribute at true, or choose -contact_type schwarz",
             contact->friction.name, ((PetscObject)contact)->type_name);
  PetscCheck(contact->options.constraint == CONTACT_CONSTRAINT_GAP, comm, PETSC_ERR_SUP,
             "-contact_law %s closes gaps; leave -contact_constraint at gap", contact->friction.name);
  PetscCheck(contact->options.stabilization == CONTACT_STABILIZATION_NONE, comm, PETSC_ERR_SUP,
             "-contact_law %s has massless contact nodes, which do not chatter; leave -contact_stabilization at none",
             contact->friction.name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes controller steps with friction: takes the place of a method that would close gaps by the same forces without it, or hold them by
   springs (`NULL`: there are none) */
PetscErrorCode ContactStepByFriction(Contact contact, const ContactFrictionSprings *springs)
{
  const ContactFrictionSprings given = springs ? *springs : (ContactFrictionSprings){0};
  FrictionStep                *step;

  PetscFunctionBegin;
  PetscTryTypeMethod(contact, destroy);
  PetscCall(PetscMemzero(contact->ops, sizeof(*contact->ops)));
  contact->data = NULL;
  PetscCall(Check(contact));
  PetscCall(PetscNew(&step));
  contact->friction.steps   = PETSC_TRUE;
  contact->data             = step;
  contact->ops->step        = Step;
  contact->ops->stored      = springs && !given.max_it ? FrictionStoredEnergy : ContactStoresNothing;
  contact->ops->view        = View;
  contact->ops->setup       = SetUp;
  contact->ops->reset       = Reset;
  contact->ops->destroy     = Destroy;
  contact->ops->visit       = FrictionVisit;
  contact->ops->rowschanged = RowsChanged;
  step->atol                = CONTACT_POSITION_TOLERANCE * contact->scale.length;
  step->springs             = given;
  step->has_springs         = (PetscBool)(springs != NULL);
  PetscCall(SetUp(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
