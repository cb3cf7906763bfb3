/* How stiff the springs and dampers of the penalty method are, and whether explicit steps stand them. */
#include "forwardimpl.h"
#include <sys/units.h>
#include <impakt/private/bodymass.h>
#include <impakt/private/bodymesh.h>

/* Penalty parameter relative to that of an element on each side, one behind the other. Two plane strain blocks that meet at 100 m/s
   (explicit at their stable steps, lumped mass), scale: largest penetration in elements, energy gained, contact force's scatter to mean:
     massless contact nodes  1: 0.25, 8e-4, 5 %   10: 0.03, 2e-4, 6 %   30: 0.01, 2e-4, 6 %
     with mass               1: 0.3, 5e-3, 6 %    2: 0.25, 7e-3, 18 %   3: chatters, gains 5 %; implicit ones chatter at 10 */
#define MASSLESS_SCALE 10
#define MASS_SCALE     1

/* -contact_penalty, or how stiff springs are to be beside the elements */
PetscErrorCode PenaltyReadParameter(Contact contact)
{
  StepperPenalty *penalty = PenaltyOf(contact);
  MPI_Comm        comm    = PetscObjectComm((PetscObject)contact);
  PetscBool       set, scaled = PETSC_FALSE;

  PetscFunctionBegin;
  PetscObjectOptionsBegin((PetscObject)contact);
  PetscCall(PetscOptionsReal("-contact_penalty", "Penalty parameter [N/m in 1-D, N/m^3 else]", "ContactSetFromOptions", penalty->parameter,
                             &penalty->parameter, &set));
  if (!set)
    PetscCall(PetscOptionsReal("-contact_penalty_scale", "Penalty parameter relative to the stiffness of the elements",
                               "ContactSetFromOptions", penalty->scale, &penalty->scale, &scaled));
  PetscOptionsEnd();
  PetscCheck(!set || penalty->parameter > 0, comm, PETSC_ERR_USER_INPUT, "-contact_penalty %g must be positive",
             (double)penalty->parameter);
  PetscCheck(!scaled || penalty->scale > 0, comm, PETSC_ERR_USER_INPUT, "-contact_penalty_scale %g must be positive",
             (double)penalty->scale);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The penalty parameter of a pair: as given, or, where that is 0, from an element on each side, one behind the other, and a scale, as given
   or, where that is 0, by the mass of the contact nodes. Dampers in place of springs leave none. */
static PetscErrorCode GetPairParameter(Contact contact, const ContactPair *pair, PetscReal *parameter, PetscReal *scale)
{
  const StepperPenalty *penalty      = PenaltyOf(contact);
  PetscReal             flexibility  = 0;
  PetscBool             all_massless = PETSC_TRUE;

  PetscFunctionBegin;
  *parameter = contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE ? 0 : penalty->parameter;
  *scale     = penalty->scale;
  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE || penalty->parameter > 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
    const Body body      = contact->bodies[pair->body[side]];
    PetscReal  stiffness = 0;

    if (BodyDoes(body, BodyIsRigid)) continue;
    PetscCall(BodyGetScale(body, BODY_ELEMENT_STIFFNESS, &stiffness));
    if (!BodyDoes(body, BodyIsRedistributed)) all_massless = PETSC_FALSE;
    flexibility += 1 / stiffness;
  }
  if (!(*scale > 0)) *scale = all_massless ? MASSLESS_SCALE : MASS_SCALE;
  *parameter = *scale / flexibility;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Displacement after a step for a force at its start, of the explicit nodes with mass, times the stiffness, the largest over all rows:
   of springs over a substep, of dampers over the controller step as if it were one */
static PetscErrorCode GetForwardCompliance(Contact contact, PetscReal worst[2])
{
  const ContactStepper *stepper = (const ContactStepper *)contact->data;
  PetscReal            *compliance[2], *bound;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(contact->rows.n, &compliance[0], contact->rows.n, &compliance[1], contact->rows.n, &bound));
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    PetscInt substeps;

    if (!BodyDoes(contact->bodies[b], BodyIsExplicit) || BodyDoes(contact->bodies[b], BodyIsRedistributed)) continue;
    PetscCall(BodyGetSubsteps(contact->bodies[b], &substeps));
    PetscCall(BodyBoundInverseMass(contact->bodies[b], bound));
    for (PetscInt k = 0; k < contact->body_rows[b].n; k++) {
      const PetscInt i = contact->body_rows[b].rows[k];

      compliance[0][i] += PetscSqr(contact->step / substeps) * bound[k];
      compliance[1][i] += PetscSqr(contact->step) * bound[k];
    }
  }
  worst[0] = worst[1] = 0;
  for (PetscInt i = 0; i < contact->rows.n; i++) {
    PetscReal spring, damper;

    ContactStepperGetSpring(contact, stepper, i, &spring, &damper);
    worst[0] = PetscMax(worst[0], compliance[0][i] * spring);
    worst[1] = PetscMax(worst[1], compliance[1][i] * damper);
  }
  PetscCall(PetscFree3(compliance[0], compliance[1], bound));
  PetscCall(ContactReduce(contact, 2, MPIU_REAL, MPIU_MAX, worst));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Spring and damper alone, between the masses of explicit bodies, must be stable: k C + 2 c C / dt < 4, C = dt^2 B M^{-1} B^T */
static PetscErrorCode CheckStability(Contact contact)
{
  const StepperPenalty *penalty = PenaltyOf(contact);
  MPI_Comm              comm    = PetscObjectComm((PetscObject)contact);
  const PetscBool       given   = (PetscBool)(penalty->parameter > 0);
  const PetscReal       value   = given ? penalty->parameter : penalty->scale > 0 ? penalty->scale : MASS_SCALE;
  PetscReal             worst[2], spring, damper;

  PetscFunctionBegin;
  PetscCall(GetForwardCompliance(contact, worst));
  spring = worst[0];
  damper = 2 * worst[1] / contact->step;
  PetscCheck(spring < 4, comm, PETSC_ERR_USER_INPUT,
             "-contact_penalty%s %g is too stiff for the explicit steps: above %.4g the contact springs are unstable; choose a smaller "
             "one, or smaller time steps",
             given ? "" : "_scale", (double)value, (double)(4 / spring * value));
  PetscCheck(spring + damper < 4, comm, PETSC_ERR_USER_INPUT,
             "-contact_penalty_damping %g is too much for the explicit steps: above %.4g the contact dampers are unstable; choose a "
             "smaller one, or smaller time steps",
             (double)penalty->damping, (double)((4 - spring) / damper * penalty->damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Springs of all pairs, and whether explicit steps stand them on the rows as these are */
PetscErrorCode PenaltySetUpSprings(Contact contact)
{
  ContactStepper *stepper = (ContactStepper *)contact->data;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscReal scale;

    PetscCall(GetPairParameter(contact, &contact->pairs[p], &stepper->springs.stiffness[p], &scale));
  }
  PetscCall(CheckStability(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PenaltyViewParameter(Contact contact, PetscViewer viewer)
{
  const StepperPenalty *penalty = PenaltyOf(contact);
  const char           *unit, *across = ContactAnyPairHas(contact, CONTACT_LAW_FRICTION) ? ", along the normals and across them" : "";

  PetscFunctionBegin;
  unit = UnitsOf((PetscObject)contact, contact->dim == 1 ? UNIT_STIFFNESS : UNIT_STIFFNESS_ON_AREA);
  if (contact->options.constraint == CONTACT_CONSTRAINT_GAP_RATE || penalty->parameter > 0) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "  penalty parameter %g%s%s\n", (double)penalty->parameter, unit, across));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    PetscReal parameter, scale;

    PetscCall(GetPairParameter(contact, &contact->pairs[p], &parameter, &scale));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  penalty parameter of %s %g%s, %g times the stiffness of the elements%s\n",
                                     contact->pairs[p].name, (double)parameter, unit, (double)scale, across));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
