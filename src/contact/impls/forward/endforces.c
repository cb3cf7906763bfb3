/* What methods that close gaps by the force at the end of a step need of bodies. */
#include "forwardimpl.h"

/* StepperCheckBodies - the gap of a pair must answer to the force at the end of the step: explicit nodes with mass do not feel it before
   the next one (and several substeps of theirs feel it less than the force at the start, so that the forces would oscillate and grow) */
PetscErrorCode StepperCheckBodies(Contact contact)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const ContactPair *pair    = &contact->pairs[p];
    PetscBool          answers = PETSC_FALSE;
    const char        *name    = ((PetscObject)contact->bodies[pair->body[0]])->name;

    for (PetscInt side = 0; side < (pair->obstacle ? 1 : 2); side++) {
      const Body body = contact->bodies[pair->body[side]];

      answers = (PetscBool)(answers || !BodyDoes(body, BodyIsExplicit) || BodyDoes(body, BodyIsRedistributed));
    }
    PetscCheck(
        answers, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
        "-contact_type %s closes the gap of %s by the contact force at the end of the step, which does not move explicit contact nodes "
        "with mass before the next step; set -%s_mass_redistribute true, give it -%s_ts_type alpha2, or use -contact_type lagrange "
        "with all bodies explicit, with mass, and with -time_step as their -<body>_ts_time_step",
        ((PetscObject)contact)->type_name, pair->name, name, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StepperCheckFriction - what friction needs of bodies and options */
PetscErrorCode StepperCheckFriction(Contact contact)
{
  PetscFunctionBegin;
  if (ContactHasMass(contact, PETSC_FALSE))
    PetscCall(ContactRefuseFriction(contact,
                                    "it needs massless contact nodes with this -contact_type: with mass the forces of friction ring "
                                    "from step to step; leave -<body>_mass_redistribute at true, or choose -contact_type schwarz"));
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP)
    PetscCall(ContactRefuseFriction(contact, "friction closes gaps; leave -contact_constraint at gap"));
  if (contact->options.stabilization != CONTACT_STABILIZATION_NONE)
    PetscCall(ContactRefuseFriction(contact, "massless contact nodes do not chatter; leave -contact_stabilization at none"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
