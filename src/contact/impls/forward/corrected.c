/* Lagrange multipliers at the end of each controller step, for bodies whose gap answers to the force there: the contact step with the rule
   `linear`, whatever mass contact nodes have. With gap(lambda) the gaps after integrating all bodies under forces that go linearly from
   their last values to lambda,

     gap(lambda) >= 0,   lambda >= 0,   lambda . gap(lambda) = 0.

   Around the step there are impulses that end the rate of closed gaps (-contact_constraint both), and the contact-stabilised Newmark method
   (Deuflhard, Krause, Ertel 2008). */
#include "forwardimpl.h"
#include <impakt/private/bodyforces.h>

/* What changes states beside the forces of the step */
typedef struct {
  Complementarity impulses;
  PetscBool       stabilized; /* else velocities are corrected */
  ContactRule     rule;       /* of the contact-stabilised method: that of the step, with forces as the integrators take them */
} Corrections;

/* Contact-stabilised, by the trapezoidal rule: with accelerations without contact forces at the start of a step and this many times the
   force at its end, u_1 and v_1 have the whole contact force of the end of the step */
#define TIMES 2

static Corrections *CorrectionsOf(Contact contact)
{
  return (Corrections *)((ContactStepper *)contact->data)->method;
}

static PetscErrorCode BeginStabilized(Contact contact, ContactStepper *stepper, const ContactPair *pair)
{
  PetscFunctionBegin;
  PetscCall((*ContactRuleLinear.begin)(contact, stepper, pair));
  for (PetscInt i = pair->begin; i < pair->end; i++) contact->end.force[i] *= TIMES;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EndStabilized(Contact contact, ContactStepper *stepper, const ContactPair *pair)
{
  PetscFunctionBegin;
  (void)stepper;
  for (PetscInt i = pair->begin; i < pair->end; i++) contact->end.force[i] /= TIMES;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(Contact contact)
{
  Corrections *corrections = CorrectionsOf(contact);

  PetscFunctionBegin;
  if (corrections->stabilized) PetscCall(LagrangeProjectPrediction(contact, &corrections->impulses));
  if (!ContactFailed(contact)) PetscCall(ContactStepperStep(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Corrections at the end of the step: velocities without gap rate; accelerations without contact forces (contact-stabilised) */
static PetscErrorCode Accept(Contact contact)
{
  const PetscReal parts[]     = {0, 0, 1};
  Corrections    *corrections = CorrectionsOf(contact);
  PetscBool       in_contact;

  PetscFunctionBegin;
  PetscCall(ContactStepperAccept(contact));
  if (!corrections->stabilized) {
    PetscCall(LagrangeCloseRate(contact, PETSC_FALSE, &corrections->impulses));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ContactAny(contact, PETSC_FALSE, &in_contact));
  if (!in_contact) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < contact->rows.n; i++) corrections->impulses.forces[i] = -TIMES * contact->end.force[i];
  PetscCall(ComplementarityApply(contact, &corrections->impulses, BODY_AT_END, parts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RowsChanged(Contact contact)
{
  PetscFunctionBegin;
  PetscCall(ContactStepperRowsChanged(contact));
  PetscCall(ComplementaritySetCompliance(contact, &CorrectionsOf(contact)->impulses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Contact contact)
{
  Corrections *corrections = CorrectionsOf(contact);

  PetscFunctionBegin;
  PetscCall(ComplementarityDestroy(&corrections->impulses));
  PetscCall(PetscFree(corrections));
  PetscCall(ContactStepperDestroy(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckStabilized(Contact contact)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)contact);

  PetscFunctionBegin;
  PetscCheck(
      contact->options.constraint == CONTACT_CONSTRAINT_GAP, comm, PETSC_ERR_USER_INPUT,
      "-contact_stabilization contact_stabilized closes the gap by a projection of its own; leave -contact_constraint at gap, not %s",
      ContactConstraints[contact->options.constraint]);
  for (PetscInt b = 0; b < contact->n_bodies; b++) {
    const char *name = ((PetscObject)contact->bodies[b])->name;
    PetscReal   alpha_m, alpha_f, gamma, beta;
    PetscInt    substeps;
    TS          ts;

    PetscCheck(
        !BodyDoes(contact->bodies[b], BodyIsExplicit), comm, PETSC_ERR_USER_INPUT,
        "-contact_stabilization contact_stabilized works with implicit bodies only, and body '%s' is explicit; give it -%s_ts_type alpha2",
        name, name);
    PetscCheck(!BodyDoes(contact->bodies[b], BodyIsRedistributed), comm, PETSC_ERR_USER_INPUT,
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step with impulses around it, where options ask for them */
static PetscErrorCode SetUpCorrected(Contact contact, PetscBool stabilized)
{
  ContactStepper *stepper = (ContactStepper *)contact->data;
  Corrections    *corrections;

  PetscFunctionBegin;
  if (stabilized) PetscCall(CheckStabilized(contact));
  PetscCall(PetscNew(&corrections));
  corrections->stabilized = stabilized;
  if (stabilized) {
    corrections->rule            = ContactRuleLinear;
    corrections->rule.name       = "contact-stabilised";
    corrections->rule.begin      = BeginStabilized;
    corrections->rule.end        = EndStabilized;
    stepper->asked               = &corrections->rule;
    contact->attempt.moves_start = PETSC_TRUE;
  }
  stepper->method       = corrections;
  contact->ops->destroy = Destroy;
  PetscCall(ContactStepperSetUp(contact));
  contact->ops->step        = Step;
  contact->ops->accept      = Accept;
  contact->ops->rowschanged = RowsChanged;
  PetscCall(LagrangeSetUpImpulses(contact, stabilized ? "-contact_stabilization contact_stabilized" : "-contact_constraint both",
                                  &corrections->impulses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LagrangeSetUpImplicit(Contact contact)
{
  const PetscBool is_stabilized = (PetscBool)(contact->options.stabilization == CONTACT_STABILIZATION_CONTACT_STABILIZED);

  PetscFunctionBegin;
  PetscCall(StepperCheckFriction(contact));
  if (!ContactAnyPairHas(contact, CONTACT_LAW_FRICTION)) PetscCall(StepperCheckBodies(contact));
  PetscCall(ContactRefuseUnstable(
      contact,
      (PetscBool)(ContactHasMass(contact, PETSC_TRUE) && contact->options.constraint == CONTACT_CONSTRAINT_GAP &&
                  contact->options.stabilization == CONTACT_STABILIZATION_NONE),
      "-contact_type lagrange: where the contact nodes of both sides have mass, multipliers at the end of the step swing and gain energy; "
      "set "
      "-<body>_mass_redistribute true, or choose -contact_stabilization contact_stabilized, or -contact_type schwarz"));
  PetscCheck(!ContactAllPairsTie(contact), PetscObjectComm((PetscObject)contact), PETSC_ERR_SUP,
             "-contact_law tied with -contact_type lagrange is for bodies that are all explicit, with mass on their contact nodes and "
             "without substeps: with others the multipliers only push; choose -contact_type schwarz or penalty");
  if (is_stabilized || contact->options.constraint == CONTACT_CONSTRAINT_BOTH) PetscCall(SetUpCorrected(contact, is_stabilized));
  else PetscCall(ContactStepperSetUp(contact));
  PetscFunctionReturn(PETSC_SUCCESS);
}
