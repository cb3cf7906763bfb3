/* What methods that close gaps by the force at the end of a step need of bodies. */
#include "forwardimpl.h"

static PetscErrorCode CheckBeforeObstacle(Contact contact, const ContactPair *pair, const char type[])
{
  const Body         body = contact->bodies[pair->body[0]];
  const char        *name = ((PetscObject)body)->name;
  BodyStepProperties properties;

  PetscFunctionBegin;
  PetscCall(BodyGetStepProperties(body, &properties));
  PetscCheck(properties.feels_end_force, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
             "-contact_type %s closes the gap by the contact force at the end of the step, which does not move the explicit contact nodes "
             "with mass of '%s' before the next step; set -%s_mass_redistribute true, give it -%s_ts_type alpha2, or use -contact_type "
             "lagrange with all bodies explicit, with mass and without substeps",
             type, name, name, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StepperCheckBodies - the gap of a pair must answer to the force at the end of the step: explicit nodes with mass do not feel it before
   the next one (and several substeps of theirs feel it less than the force at the start, so that the forces would oscillate and grow) */
PetscErrorCode StepperCheckBodies(Contact contact)
{
  const char *type = ((PetscObject)contact)->type_name;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < contact->n_pairs; p++) {
    const char *name[2];
    PetscBool   answers = PETSC_FALSE;
    PetscInt    substeps[2];

    if (contact->pairs[p].obstacle) {
      PetscCall(CheckBeforeObstacle(contact, &contact->pairs[p], type));
      continue;
    }
    for (PetscInt side = 0; side < 2; side++) {
      const Body body = contact->bodies[contact->pairs[p].body[side]];
      PetscBool  is_explicit, massless;

      PetscCall(BodyIsExplicit(body, &is_explicit));
      PetscCall(BodyIsRedistributed(body, &massless));
      PetscCall(BodyGetSubsteps(body, &substeps[side]));
      name[side] = ((PetscObject)body)->name;
      if (!is_explicit || massless) answers = PETSC_TRUE;
    }
    PetscCheck(answers, PetscObjectComm((PetscObject)contact), PETSC_ERR_USER_INPUT,
               "-contact_type %s closes the gap by the contact force at the end of the step, which does not move explicit contact nodes "
               "with mass before the next step, and both '%s' (%" PetscInt_FMT " substeps) and '%s' (%" PetscInt_FMT
               " substeps) have such; set -%s_mass_redistribute true, give one of them -%s_ts_type alpha2, or use -contact_type lagrange "
               "with one step for all bodies, explicit and with mass (-%s_ts_time_step and -%s_ts_time_step equal to -time_step)",
               type, name[0], substeps[0], name[1], substeps[1], name[0], name[0], name[0], name[1]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* StepperCheckFriction - what friction needs of bodies and options */
PetscErrorCode StepperCheckFriction(Contact contact)
{
  PetscBool has_mass;

  PetscFunctionBegin;
  PetscCall(ContactHasMass(contact, PETSC_FALSE, &has_mass));
  if (has_mass)
    PetscCall(ContactRefuseFriction(contact,
                                    "it needs massless contact nodes with this -contact_type: with mass the forces of friction ring "
                                    "from step to step; leave -<body>_mass_redistribute at true, or choose -contact_type schwarz"));
  if (contact->options.constraint != CONTACT_CONSTRAINT_GAP)
    PetscCall(ContactRefuseFriction(contact, "friction closes gaps; leave -contact_constraint at gap"));
  if (contact->options.stabilization != CONTACT_STABILIZATION_NONE)
    PetscCall(ContactRefuseFriction(contact, "massless contact nodes do not chatter; leave -contact_stabilization at none"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
