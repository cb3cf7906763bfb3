/*
   The rule `impulse`, for contact nodes with mass. The force of a row is the same throughout the step. A row whose node carried a force in
   the step before is closed where its gap does not change; one that joins, whose gap would be closed in the middle of the step, where its
   gap changes by half of the way that its closing rate would make. So what closed rows do to the bodies, force times change of the gap, is
   never positive, whatever the bodies do inside the step. Rows are laid where bodies will be in the middle of the step.

   Velocity-level contact: V. Acary, ZAMM 96 (2016) 585-603; here on increments of gaps, so that substeps of any integrator may lie between.
*/
#include <contact/step/stepimpl.h>

#define PRESSED 1e-3 /* forces that press a joining node by less than this part of what stops it are left alone */

/* Where bodies will be in the middle of the step, if their nodes go on as they do */
static PetscErrorCode Place(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  (void)stepper;
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    Vec u, v;

    PetscCall(BodyGetSolution(contact->bodies[b], &u, &v, NULL));
    if (!contact->ends[b]) PetscCall(VecDuplicate(u, &contact->ends[b]));
    PetscCall(VecWAXPY(contact->ends[b], 0.5 * contact->step, v, u));
  }
  contact->at_ends = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(Contact contact, ContactStepper *stepper)
{
  const PetscReal half = 0.5 * contact->step;

  PetscFunctionBegin;
  PetscCall(ContactStepperComputeRates(contact, stepper->rate));
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair = &contact->pairs[p];

    for (PetscInt first = pair->begin; first < pair->end; first += pair->components) {
      const PetscBool tied    = contact->rows.tied[first];
      const PetscBool carried = (PetscBool)(tied || (contact->start.active[first] && contact->start.force[first] > 0));
      const PetscReal middle  = contact->start.gap[first] + half * stepper->rate[first];
      const PetscBool touches = (PetscBool)(carried || (contact->rows.opposite[first] && middle <= 0));

      for (PetscInt i = first; i < first + pair->components; i++) {
        const PetscReal way = half * (i == first ? PetscMin(stepper->rate[i], 0) : stepper->rate[i]);

        stepper->touches[i]   = touches;
        stepper->joins[i]     = (PetscBool)(touches && !carried);
        stepper->lets[i]      = carried ? 0 : way;
        contact->end.force[i] = carried && (tied || !stepper->joined[i]) ? contact->start.force[i] : 0;
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Load(Contact contact, ContactStepper *stepper, PetscInt b)
{
  const ContactBodyRows *of = &contact->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < of->n; k++) {
    const PetscInt  i    = of->rows[k];
    const PetscReal sign = ContactSign(&contact->pairs[contact->rows.pair[i]], b);

    stepper->mine[k]   = sign * contact->end.force[i];
    stepper->before[k] = sign * stepper->last[i];
  }
  PetscCall(BodySetConstantForces(contact->bodies[b], stepper->mine, stepper->before, stepper->none));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row that joins takes the kinetic energy of its node, 1/2 m w^2 with m = dt^2/(2 S_ii), by its way q = 1/2 dt |w|. Where forces press
   its node on the partner beside that, they would lose theirs times q too. Then it moves by a part of q, the largest with which it takes no
   more: with S_ii lambda = (2 + f - part) q that is part (2 + f - part) = 1, f what forces press with. */
static PetscErrorCode Limit(Contact contact, ContactStepper *stepper, const PetscScalar lets[])
{
  LawProblem *problem = &stepper->problem;
  PetscBool   any     = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt node = 0; node < problem->n_nodes; node++) {
    const PetscInt  k = problem->begin[node], i = stepper->rows[k] - contact->rows.begin;
    const PetscReal q = -PetscRealPart(lets[k]), pressed = problem->diagonal[k] * PetscRealPart(problem->force[k]) / q + 1;
    PetscReal       part;

    if (!(q > 0) || pressed <= 2 + PRESSED) continue;
    part = 2 / (pressed + PetscSqrtReal(PetscSqr(pressed) - 4));
    problem->read[k] -= (1 - part) * q;
    if (i >= 0 && i < contact->rows.n) stepper->lets[i] *= part;
    any = PETSC_TRUE;
  }
  if (any) PetscCall(LawProblemSolve(problem));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What contact takes of the energy in the step, friction apart */
static PetscErrorCode SumLoss(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  stepper->step_loss = 0;
  for (PetscInt i = 0; i < contact->rows.n; i++)
    if (stepper->touches[i] && !ContactRowRubs(contact, i))
      stepper->step_loss -= contact->end.force[i] * (contact->end.gap[i] - contact->start.gap[i]);
  if (contact->ranks.size > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &stepper->step_loss, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)contact)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the step begins with is what it ends with, for all that takes the mean of both. Nobody else sums up what friction takes where the
   energy is not limited. */
static PetscErrorCode End(Contact contact, ContactStepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(contact->energy.last_force, stepper->last, contact->rows.n));
  PetscCall(PetscArraycpy(contact->start.force, contact->end.force, contact->rows.n));
  contact->energy.changed = PETSC_TRUE;
  PetscCall(SumLoss(contact, stepper));
  PetscCall(ContactComputeFrictionLoss(contact, contact->start.force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const ContactRule ContactRuleImpulse = {
    .name  = "impulse",
    .takes = "contact takes the kinetic energy of the contact nodes that hit, which have mass; massless contact nodes "
             "(-<body>_mass_redistribute, the default) and finer elements lose less",
    .place = Place,
    .begin = Begin,
    .load  = Load,
    .shape = BODY_FORCE_CONSTANT,
    .limit = Limit,
    .end   = End};
