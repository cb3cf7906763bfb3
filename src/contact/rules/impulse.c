/* The rule `impulse`, for contact nodes with mass. The force of a row is the same throughout the step. A row whose node carried a force in
   the step before is closed where its gap does not change; one that joins, whose gap would be closed in the middle of the step, where its
   gap changes by half of the way that its closing rate would make. So what closed rows do to the bodies, force times change of the gap, is
   never positive, whatever the bodies do inside the step. Rows are laid where bodies will be in the middle of the step.

   Velocity-level contact: V. Acary, ZAMM 96 (2016) 585-603; here on increments of gaps, so that substeps of any integrator may lie
   between. */
#include <contact/step/stepimpl.h>
#include <impakt/private/bodyforces.h>

#define MOST_LOSS 1.1 /* of a row that joins, in parts of the kinetic energy of its node */
/* How deep rows may end inside their partner that stay open by their rates: as deep as these would bring them, at most by DEEP, and by
   GRAZES beside that [parts of the smallest contact element] */
#define DEEP   0.25
#define GRAZES 1e-3

/* A node that touched first in the last step has lost its rate along the normal. If it is bonded now, it loses that across as well, as rows
   do that join: it sticks where half of its way in the step leads. */
static void Bond(Contact contact, PetscInt i, PetscReal way)
{
  contact->rows.initial_gap[i] -= way + contact->start.gap[i];
  contact->start.gap[i] = -way;
}

/* Whether an open row would be closed in the middle of the step. Gaps of round-off touch, or bodies at rest would lack a first force. */
static PetscBool Closes(Contact contact, const ContactStepper *stepper, PetscInt first)
{
  return (PetscBool)(contact->rows.opposite[first] &&
                     contact->start.gap[first] + 0.5 * contact->step * stepper->rate[first] <= stepper->problem.resolution);
}

static PetscErrorCode Begin(Contact contact, ContactStepper *stepper, const ContactPair *pair)
{
  const PetscReal half = 0.5 * contact->step;

  PetscFunctionBegin;
  for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components) {
    const PetscInt  first   = contact->rows.near[k];
    const PetscBool tied    = contact->rows.tied[first];
    const PetscBool carried = (PetscBool)(tied || (contact->start.active[first] && contact->start.force[first] > 0));
    const PetscBool touches = (PetscBool)(carried || Closes(contact, stepper, first));

    if (!touches && !stepper->touches[first]) continue; /* as it was in the last step */
    for (PetscInt i = first; i < first + pair->components; i++) {
      const PetscReal way = half * (i == first ? PetscMin(stepper->rate[i], 0) : stepper->rate[i]);

      stepper->touches[i] = touches;
      stepper->joins[i]   = (PetscBool)(touches && !carried);
      stepper->lets[i]    = carried ? 0 : way;
      if (tied && stepper->joined[i] && ContactStepperLaw(contact, stepper, i)->reads == ROW_LAW_READS_END)
        Bond(contact, i, half * stepper->rate[i]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Load(Contact contact, ContactStepper *stepper, PetscInt b)
{
  const ContactBodyRows *of = &contact->body_rows[b];

  PetscFunctionBegin;
  for (PetscInt j = 0; j < of->n_acting; j++) {
    const PetscInt k = of->acting[j], i = of->rows[k];

    stepper->mine[k]   = contact->end.force[i];
    stepper->before[k] = stepper->last[i];
  }
  PetscCall(BodySetConstantForces(contact->bodies[b], of->n_acting, of->acting, stepper->mine, stepper->before, stepper->none));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row that joins takes the kinetic energy of its node, 1/2 m w^2 with m = dt^2/(2 S_ii), by its way q = 1/2 dt |w|. Where forces press
   its node on the partner beside that, they would lose theirs times q too. Then it moves by a part of q, the largest with which it takes at
   most c times as much as alone: with S_ii lambda = (2 + f - part) q that is part (2 + f - part) = c, f what forces press with. */
static PetscReal Limit(Contact contact, const ContactStepper *stepper, PetscInt i, PetscReal by_force)
{
  const PetscReal whole = 0.5 * contact->step * PetscMax(-stepper->rate[i], 0), way = -stepper->lets[i];
  const PetscReal pressed = by_force / whole + way / whole; /* 2 + f */

  if (!stepper->joins[i] || !(whole > 0) || way > whole) return -way;
  if (pressed <= 1 + MOST_LOSS) return -whole;
  return -2 * MOST_LOSS * whole / (pressed + PetscSqrtReal(PetscSqr(pressed) - 4 * MOST_LOSS));
}

/* Rows that stay open by their rates at the start join as well, and the step is made again, where they end deeper inside their partner than
   rows that join may: forces press them in within the step. They move as others that join do, so that rows which have just opened keep
   their gap; those which begin far away come as near as they may be deep. */
static PetscErrorCode More(Contact contact, ContactStepper *stepper, const ContactPair *pair, PetscBool *more)
{
  PetscReal size;

  PetscFunctionBegin;
  PetscCall(ContactGetLeastElement(contact, pair->body, &size));
  for (PetscInt k = pair->near_begin; k < pair->near_end; k += pair->components) {
    const PetscInt first = contact->rows.near[k];
    PetscReal      most;

    if (contact->end.gap[first] >= 0 || stepper->touches[first] || !contact->rows.opposite[first]) continue;
    most = PetscMin(PetscAbsReal(contact->step * stepper->rate[first]), DEEP * size) + GRAZES * size;
    if (contact->end.gap[first] >= -most) continue;
    for (PetscInt i = first; i < first + pair->components; i++) {
      stepper->touches[i] = stepper->joins[i] = PETSC_TRUE;
      stepper->lets[i]                        = 0.5 * contact->step * stepper->rate[i];
    }
    stepper->lets[first] = PetscMin(PetscMin(stepper->lets[first], 0), most - contact->start.gap[first]);
    *more                = PETSC_TRUE;
  }
  if (*more) PetscCall(PetscInfo(contact, "rule impulse: rows of %s that end inside their partner join\n", pair->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the step begins with is what it ends with, for all that takes the mean of both */
static PetscErrorCode End(Contact contact, ContactStepper *stepper, const ContactPair *pair)
{
  PetscFunctionBegin;
  contact->energy.changed = PETSC_TRUE;
  for (PetscInt k = pair->acts_begin; k < pair->acts_end; k++) {
    const PetscInt i = contact->rows.acting[k];

    contact->energy.last_force[i] = stepper->last[i];
    contact->start.force[i]       = contact->end.force[i];
    if (!stepper->touches[i]) continue;
    if (!ContactRowRubs(contact, i))
      stepper->closed.loss -= contact->end.force[i] * (contact->end.gap[i] - contact->start.gap[i]) +
                              ContactStepperTaken(contact, stepper, i);
    stepper->closed.force += PetscAbsReal(contact->end.force[i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const ContactRule ContactRuleImpulse = {
    .name  = "impulse",
    .takes = "contact takes the kinetic energy of the contact nodes that hit, which have mass; finer elements lose less, "
             "and in thick bodies massless contact nodes (-<body>_mass_redistribute true)",
    .ahead = 0.5,
    .begin = Begin,
    .load  = Load,
    .shape = BODY_FORCE_CONSTANT,
    .limit = Limit,
    .more  = More,
    .end   = End};
