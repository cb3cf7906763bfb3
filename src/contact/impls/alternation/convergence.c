/* When the outer iteration has converged. */
#include "alternationimpl.h"
#include <sys/petsccompat.h>
#include <sys/units.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodysweeps.h>

/* Forces of this rank's rows at the end of the controller step, from the bodies' traces [N] */
PetscErrorCode AlternationGetForces(Contact contact, PetscScalar force[])
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair     = &contact->pairs[p];
    const Trace        reaction = contact->traces[DirichletBody(pair)].reaction;
    PetscScalar       *end;
    PetscInt           levels;

    PetscCall(TraceGetSizes(reaction, NULL, &levels));
    PetscCall(TraceGetLevel(reaction, levels, &end));
    for (PetscInt i = pair->begin; i < pair->end; i++) force[i] = contact->end.active[i] ? end[i - DirichletShift(pair)] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nodes with mass take the velocity of their partner as it was after the sweep before, which the residual does not see: how far what
   the Dirichlet side of row i was given is from what its partner has now, in terms of displacement [m] */
static PetscErrorCode MeasureLag(Contact contact, PetscInt i, PetscReal *lag)
{
  const Alternation *alternation = (const Alternation *)contact->data;
  const ContactPair *pair        = &contact->pairs[contact->rows.pair[i]];
  const Body         body        = contact->bodies[DirichletBody(pair)];
  const Trace        given = contact->traces[DirichletBody(pair)].velocity_in, has = contact->traces[NeumannBody(pair)].velocity;
  PetscInt           given_levels, has_levels;
  PetscScalar       *from, *to;

  PetscFunctionBegin;
  *lag = 0;
  if (!BodyDoes(body, BodyPrescribesMass) || alternation->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN ||
      alternation->kinematic[SideIndex(contact, contact->rows.pair[i])])
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(TraceGetSizes(given, NULL, &given_levels));
  PetscCall(TraceGetSizes(has, NULL, &has_levels));
  PetscCall(TraceGetLevel(given, given_levels, &to));
  PetscCall(TraceGetLevel(has, has_levels, &from));
  *lag = PetscAbsScalar(to[i - DirichletShift(pair)] + from[i - NeumannShift(pair)]) * alternation->controller_step / has_levels;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The distance between both sides of the active rows that one more plain sweep would close [m] */
static PetscErrorCode MeasureMismatch(Contact contact, const PetscScalar f[], PetscReal *change, PetscReal *position)
{
  Alternation *alternation = (Alternation *)contact->data;
  PetscReal    sums[2]     = {0, 0};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    const ContactPair *pair  = &contact->pairs[contact->rows.pair[i]];
    const PetscBool    robin = (PetscBool)(alternation->transmission != SCHWARZ_TRANSMISSION_DIRICHLET_NEUMANN);
    const PetscReal    scale = robin ? 1 / (2 * alternation->weight[i]) : 1; /* metres for a unit of the residual */
    PetscScalar       *start;
    PetscReal          lag;

    if (!contact->end.active[i]) continue;
    PetscCall(MeasureLag(contact, i, &lag));
    sums[0] += PetscSqr(lag);
    for (PetscInt k = 0; k < alternation->room[contact->rows.pair[i]]; k++) sums[0] += PetscSqr(scale * f[alternation->offset[i] + k]);
    PetscCall(TraceGetLevel(contact->traces[DirichletBody(pair)].displacement, 0, &start));
    sums[1] += PetscSqr(start[i - DirichletShift(pair)]);
  }
  PetscCall(ContactReduce(contact, 2, MPIU_REAL, MPIU_SUM, sums));
  *change   = PetscSqrtReal(sums[0]);
  *position = PetscSqrtReal(sums[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the change of position with the tolerances, and notes the worst one */
PetscErrorCode AlternationMeasureChange(Contact contact, const PetscScalar f[])
{
  Alternation *alternation = (Alternation *)contact->data;

  PetscFunctionBegin;
  alternation->converged = PETSC_TRUE;
  alternation->change    = -1;
  for (PetscInt k = 0; k < (alternation->by_mismatch ? 1 : contact->n_bodies); k++) {
    PetscReal change, position;

    if (alternation->by_mismatch) PetscCall(MeasureMismatch(contact, f, &change, &position));
    else PetscCall(BodyGetPositionChange(contact->bodies[k], &change, &position));
    if (!(change <= alternation->atol || change <= alternation->rtol * position)) alternation->converged = PETSC_FALSE;
    alternation->change = PetscMax(alternation->change, change);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops on the change of position that the last sweep brought, as the paper does; the norm of F serves for NaN only */
PetscErrorCode AlternationTestConvergence(SNES snes, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal fnorm,
                                          SNESConvergedReason *reason, void *ctx)
{
  const Alternation *alternation = (const Alternation *)((Contact)ctx)->data;

  PetscFunctionBegin;
  (void)snes;
  (void)it;
  (void)xnorm;
  (void)gnorm;
  *reason = SNES_CONVERGED_ITERATING;
  if (PetscIsInfOrNanReal(fnorm)) *reason = SNES_DIVERGED_NAN;
  else if (alternation->converged) *reason = SNES_CONVERGED_FNORM_ABS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the iteration did not converge, the step has failed, or is counted */
PetscErrorCode AlternationCheckConverged(Contact contact)
{
  Alternation        *alternation = (Alternation *)contact->data;
  SNESConvergedReason reason;
  PetscReal           time;

  PetscFunctionBegin;
  PetscCall(SNESGetConvergedReason(alternation->snes, &reason));
  if (reason > 0 || ContactFailed(contact)) PetscFunctionReturn(PETSC_SUCCESS);
  if (contact->options.unconverged == SCHWARZ_UNCONVERGED_ACCEPT && reason != SNES_DIVERGED_NAN && !contact->attempt.may_cut) {
    contact->counts.unconverged_steps++;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactGetTime(contact, &time));
  PetscCall(StepFailureSet(
      &contact->attempt.failure, STEP_DIVERGED_OUTER, PETSC_ERR_NOT_CONVERGED,
      "The Schwarz iteration did not converge in the step that ends at time %.9g s: after %" PetscInt_FMT
      " sweeps the change of position is %g%s (%s; absolute tolerance %g%s, relative %g). Raise -schwarz_snes_max_it, loosen "
      "-schwarz_snes_atol, choose another -schwarz_snes_type, or take it as it is with -schwarz_unconverged accept",
      (double)time, contact->counts.sweeps, (double)alternation->change, UnitsOf((PetscObject)contact, UNIT_LENGTH),
      SNESConvergedReasons[reason], (double)alternation->atol, UnitsOf((PetscObject)contact, UNIT_LENGTH), (double)alternation->rtol));
  PetscFunctionReturn(PETSC_SUCCESS);
}
